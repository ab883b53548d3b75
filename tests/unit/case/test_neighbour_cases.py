"""[[neighbour]] case = "..." of a case file: another container from its own file, or a shipped case."""

import pickle

import pytest

import fem
from fem.case.case import CaseError, case_hash, load_case, to_toml
from fem.results.kinds import RUN
from fem.results.run_files import copy_data_files, require_free_names
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


def test_a_shipped_case_stands_beside_and_is_kept(tmp_path):
    case = load_case(written(tmp_path, ROW.replace("half.toml", "free_rocking")))
    assert case.row[1].mass == load_case("free_rocking").mass
    copy_data_files(case, tmp_path)
    (tmp_path / "row.toml").write_text(to_toml(case), encoding="utf-8")
    assert case_hash(load_case(tmp_path / "row.toml")) == case_hash(case)


def test_results_beside_the_case_leave_the_users_file_alone(tmp_path):
    copy_data_files(load_case(written(tmp_path)), tmp_path)
    assert (tmp_path / "half.toml").read_text(encoding="utf-8") == HALF


@pytest.mark.parametrize(
    ("row", "half", "reason"),
    [
        (
            ROW.replace("half", "haf"),
            HALF,
            r"\[neighbour\] case 'haf.toml' is no file in .* and no shipped case",
        ),
        (ROW.replace("half.toml", "../half.toml"), HALF, "must name a file in the folder of the case file"),
        (ROW, HALF + SLAB, "stands on another floor"),
        (ROW, "gravity_m_s2 = 10.0\n" + HALF, "stands on another floor"),
        (ROW, HALF + "[floor]\nslope_percent = 1.0\n", "stands on another floor"),
        (ROW, ROW, r"has \[\[neighbour\]\] of its own"),
        (
            ROW,
            HALF + '[[tie]]\nfrom = "left"\nheight_m = 1.0\nstiffness_N_m = 1e6\n',
            r"has \[\[tie\]\] of its own",
        ),
        (
            ROW,
            HALF.replace("width_m = 0.9", "width_m = 900"),
            r"half.toml: \[container\] width_m .*millimetres",
        ),
        (
            ROW,
            HALF.replace("boxes = 2", 'boxes = 2\njoints = "loose"'),
            r'1, as a container: .*must be "bolted"',
        ),
        (ROW, HALF + '[support]\nkind = "flat"\n', r'1, as a container: .*kind must be "corners"'),
        (
            ROW + '[[stop]]\nside = "right"\nheight_m = 3.0\ngap_m = 0.1\nstiffness_N_m = 1e8\n',
            HALF,
            r"\[stop\] height_m must be at most the height of neighbour 1, 2 m, got 3 m",
        ),
        (ROW, "[axes]\n", "this is a sweep file"),
        (ROW, "a = 1,1", "not a TOML file"),
    ],
)
def test_a_case_that_cannot_stand_there_is_refused_with_its_reason(tmp_path, row, half, reason):
    with pytest.raises(CaseError, match=reason):
        load_case(written(tmp_path, row, half))


def test_a_link_out_of_the_folder_is_refused_unless_the_user_allows_it(tmp_path):
    row = written(tmp_path / "in")
    (tmp_path / "in" / "half.toml").rename(tmp_path / "half.toml")
    (tmp_path / "in" / "half.toml").symlink_to(tmp_path / "half.toml")
    with pytest.raises(CaseError, match="leads out of the folder"):
        load_case(row)
    assert load_case(row, allow_outside=True).row[1].mass == 3600.0
    named = load_case(row, ["neighbour.case=../half.toml"])
    assert named.resolved()["neighbour"][0]["case"] == "data/half.toml" and list(named.texts) == [
        "data/half.toml"
    ]


def test_two_files_of_one_name_are_refused(tmp_path):
    for name in ("a", "b"):
        written(tmp_path / name)
    two = ROW + ROW.partition("[[neighbour]]")[1] + ROW.partition("[[neighbour]]")[2]
    row = written(
        tmp_path / "in", two.replace("half.toml", "../a/half.toml", 1).replace('"half', '"../b/half')
    )
    with pytest.raises(CaseError, match="two files of one name"):
        _ = load_case(row, allow_outside=True).texts


def test_a_neighbour_named_like_a_result_is_refused(tmp_path):
    (tmp_path / "run.json").write_text(HALF, encoding="utf-8")
    case = load_case(written(tmp_path, ROW.replace("half.toml", "run.json")))
    with pytest.raises(CaseError, match=r"\[neighbour\] case is named 'run.json', like a result"):
        require_free_names(case, RUN)
