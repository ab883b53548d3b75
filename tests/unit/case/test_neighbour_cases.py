"""[[neighbour]] case = "..." of a case file: another container from its own file, or a shipped case."""

import pickle

import pytest

import fem
from fem.case.case import CaseError, case_hash, load_case, to_toml
from fem.run.run import RunOptions, run_case
from fem.study.containers import container_key
from fem.study.design import CaseMaker

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
        first = run_case(
            case,
            case_text=case.text,
            folder=tmp_path / f"a{number}",
            options=RunOptions(band=False, margin=False),
        )
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
        (
            ROW + '[[stop]]\nside = "right"\nheight_m = 3.0\ngap_m = 0.1\nstiffness_N_m = 1e8\n',
            HALF,
            r"\[stop\] height_m must be at most the height of neighbour 1, 2 m, got 3 m",
        ),
    ],
)
def test_a_case_that_cannot_stand_there_is_refused_with_its_reason(tmp_path, row, half, reason):
    with pytest.raises(CaseError, match=reason):
        load_case(written(tmp_path, row, half))
