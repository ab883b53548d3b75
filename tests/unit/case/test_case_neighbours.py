"""[[neighbour]] of a case file: reading, refusing, changing and writing it, the cases of a row, and their own files."""

import pickle

import pytest
from interrupted_runs import stored_run

import fem
from fem.case.case import CaseError, case_hash, load_case, to_toml
from fem.case.tables.neighbours import places_of
from fem.case.tables.unknown_inputs import ranges_of
from fem.cli.check import preview_of
from fem.model.container import discretise
from fem.model.model import build_model
from fem.study.containers import container_key
from fem.study.design import CaseMaker
from mesh.errors import MeshError

BESIDE = {"side": "right", "gap_m": 0.05, "stiffness_N_m": 1e8}
RIGID = load_case("rocking", ["solver.model=rigid"])


def test_a_neighbour_is_the_container_but_for_what_is_given():
    keys = {"width_m": 2.0, "boxes": 2, "mass_kg": 3000.0}
    pushed = RIGID.with_values({"initial.velocity_m_s": 0.5})
    own, equal, other = pushed.with_values({"neighbour": [BESIDE, {**BESIDE, **keys}]}).row
    assert case_hash(own) == case_hash(pushed)
    assert equal.container == own.container
    assert (other.container.width_m, other.mass) == (2.0, 6000.0)
    assert (own.container.eccentricity_m, other.container.eccentricity_m) == (0.0, 0.0)
    wide = {**BESIDE, "width_m": 2.2}
    aside = pushed.with_values({"container.eccentricity_m": 0.011, "neighbour": [wide, BESIDE]})
    shares = [one.container.eccentricity_m / one.container.width_m for one in aside.row]
    assert shares == pytest.approx([0.011 / pushed.container.width_m] * 3)
    assert other.container.height_m == own.container.height_m
    assert not equal.initial.is_pushed
    assert own.initial.is_pushed
    assert RIGID.row == ()


def test_cases_share_a_container_where_all_of_the_row_is_equal():
    row = RIGID.with_values({"neighbour": [BESIDE]})
    keys = [container_key(one) for one in (RIGID, row, row.with_values({"neighbour.gap_m": 0.2}))]
    assert len(set(keys)) == 3
    assert container_key(row.with_values({"contact.mu_static": 0.3})) == keys[1]


def test_neighbours_stand_outward_in_the_order_given():
    rows = [BESIDE, {**BESIDE, "side": "left", "gap_m": 0.1}, {**BESIDE, "gap_m": 0.2}]
    places = places_of(RIGID.with_values({"neighbour": rows}), [1.0, 2.0, 3.0, 4.0])
    assert places.x == pytest.approx((0.0, 1.55, -2.1, 4.75))
    assert places.pairs == ((0, 1), (2, 0), (1, 3))


def test_no_container_of_a_row_gains_at_an_impact_but_by_its_own_case():
    slender, height = {**BESIDE, "width_m": 0.4}, RIGID.container.total_height
    loss = 1.5 / (1.0 + (height / 0.4) ** 2)
    most = (1.0 - 0.3 * loss) / (1.0 - loss)
    ranges = {one.key: one.ends for one in ranges_of(RIGID.with_values({"neighbour": [slender]}), 1e9)}
    assert ranges["contact.restitution_over_housner"][1] == pytest.approx(most)
    stated = RIGID.with_values({"neighbour": [slender], "contact.restitution_over_housner": 1.05})
    for refuse in (build_model, lambda case: preview_of(case).numerics):
        with pytest.raises(CaseError, match="more than there was"):
            refuse(stated)


def test_a_mass_beside_the_axis_needs_two_columns_in_every_container_of_a_row():
    size = {"container.width_m": 4.0, "container.wall_m": None, "solver.element_size_m": 1.0}
    wide = RIGID.with_values(size)
    narrow = wide.with_values({"neighbour": [{**BESIDE, "width_m": 0.5}]})
    assert "container.eccentricity_m" in {one.key for one in ranges_of(wide, 1e9)}
    assert "container.eccentricity_m" not in {one.key for one in ranges_of(narrow, 1e9)}
    with pytest.raises(MeshError, match=r"\[\[neighbour\]\] 1, as a container: a box of one column"):
        discretise(narrow.with_values({"container.eccentricity_m": 0.01}))


ROW = """
[container]
width_m = 1.1
height_m = 1.0
boxes = 4
mass_kg = 2500.0
[contact]
mu_static = 0.4
[motion]
kind = "harmonic"
peak_acceleration_m_s2 = 4.0
frequency_Hz = 0.9
[solver]
model = "rigid"
duration_s = 2.0
[output]
fields_s = 0
figures = false
[[neighbour]]
case = "half.toml"
side = "right"
gap_m = 0.005
stiffness_N_m = 1e8
"""
HALF = """
[container]
width_m = 0.9
height_m = 1.0
boxes = 2
mass_kg = 1800.0
eccentricity_m = 0.01
[contact]
mu_static = 0.3
[uncertainty]
mu_static = [0.2, 0.3]
[motion]
kind = "none"
"""
SLAB = '[floor]\npreset = "concrete"\ncorner_patch_m = [0.1, 0.2]\n'
STOP = '[[stop]]\nside = "right"\nheight_m = 3.0\ngap_m = 0.1\nstiffness_N_m = 1e8\n'


def written(folder, row=ROW, half=HALF):
    folder.mkdir(exist_ok=True)
    (folder / "half.toml").write_text(half, encoding="utf-8")
    (folder / "row.toml").write_text(row, encoding="utf-8")
    return folder / "row.toml"


def test_a_neighbour_is_the_container_of_its_own_case_under_the_motion_of_the_row(tmp_path):
    case = load_case(written(tmp_path))
    own, half = case.row
    assert (own.mass, own.contact.mu_static, own.stack[-1].top) == (10000.0, 0.4, 4.0)
    assert (half.mass, half.contact.mu_static, half.stack[-1].top) == (3600.0, 0.3, 2.0)
    assert half.container == load_case(tmp_path / "half.toml").container
    assert half.motion == case.motion and half.solver == case.solver
    taller = case.with_values({"neighbour.boxes": 3})
    assert taller.row[1].stack[-1].top == 3.0 and taller.row[1].mass == 5400.0


def test_the_folder_of_results_repeats_a_row_to_the_same_bits_on_any_floor(tmp_path):
    row = written(tmp_path / "asked")
    base = load_case(written(tmp_path / "slab", ROW + SLAB, HALF + SLAB))
    for number, case in enumerate((load_case(row), base.with_values({"floor.slope_percent": 1.0}))):
        first = stored_run(case, tmp_path / f"a{number}", band=False, margin=False)
        again = load_case(first.folder / "resolved.toml")
        assert case_hash(again) == first.typed_result.case_hash and to_toml(again) == to_toml(first.case)
        run = fem.compute(again, band=False, margin=False)
        assert run.verdict == first.verdict and run.verdict.link_hits
        alone = load_case(first.folder / "half.toml")
        assert alone.floor.slope_percent == case.floor.slope_percent and alone.motion == case.motion
    assert base.with_values({"floor.corner_patch_m": [0.2, 0.2]}).row[1].floor.corner_patch_m == [0.1, 0.2]


def test_the_file_is_read_once_and_is_part_of_the_hash(tmp_path):
    case = load_case(written(tmp_path))
    before = case_hash(case)
    written(tmp_path, half=HALF.replace("0.9", "0.8"))
    later = load_case(tmp_path / "row.toml")
    assert case_hash(later) != before
    changed = CaseMaker(case)({"contact.mu_static": 0.35})
    for one in (case, case.replace({"motion.frequency_Hz": 1.0}), changed, pickle.loads(pickle.dumps(case))):
        assert one.row[1].container.width_m == 0.9
    assert container_key(case) != container_key(case.with_values({"neighbour.case": "free_rocking"}))


@pytest.mark.parametrize(
    ("row", "half", "reason"),
    [
        (ROW, HALF + SLAB, "stands on another floor"),
        (ROW, ROW, r"has \[\[neighbour\]\] of its own"),
        (ROW, HALF.replace("= 0.9", "= 900"), r"half.toml: \[container\] width_m .*millimetres"),
        (ROW, HALF + '[support]\nkind = "flat"\n', r'1, as a container: .*kind must be "corners"'),
        (ROW + STOP, HALF, r"\[stop\] height_m must be at most the height of neighbour 1, 2 m, got 3 m"),
    ],
)
def test_a_case_that_cannot_stand_there_is_refused_with_its_reason(tmp_path, row, half, reason):
    with pytest.raises(CaseError, match=reason):
        load_case(written(tmp_path, row, half))
