"""The records of a case: which component moves the floor which way, what belongs together, what is refused."""

import numpy as np
import pytest
import record_files as files
from cases import BLOCK
from record_files import STEP, G, synthetic_motion

from fem.__main__ import main
from fem.case.case import CaseError, load_case
from fem.case.recorded import recorded_motion

FIRST, SECOND, THIRD = synthetic_motion(801)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """The files of one station, beside a case."""
    for name, text in {
        "case.toml": BLOCK,
        "h.at2": files.peer(FIRST / G),
        "v.at2": files.peer(THIRD / G, "UP"),
        "short.at2": files.peer(THIRD[:700] / G, "UP"),
        "slow.at2": files.peer(THIRD / G, "UP").replace(".0050", ".0100"),
        "one.at2": files.peer(FIRST / G, "BOX"),
        "pair.csv": files.columns([FIRST, THIRD], heading="t [s],H [m/s2],V [m/s2]"),
        "station.v2": files.csmip_v2(
            [(100.0 * FIRST, "90 Deg"), (100.0 * SECOND, "360 Deg"), (100.0 * THIRD, "Up")]
        ),
        "secret.txt": "root:secret:0:0\n",
        "bare.csv": files.columns([FIRST]),
    }.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def moved(motion, *changes, table="motion"):
    vertical = ("vertical.kind=table",) if table == "vertical" else ()
    case = load_case("case.toml", (*vertical, *changes), motion=motion)
    return recorded_motion(case, table).motion


@pytest.mark.parametrize(
    ("motion", "changes", "horizontal"),
    [
        ("h.at2", ("vertical.file=v.at2",), FIRST),
        ("pair.csv", (), FIRST),
        ("station.v2#1", (), FIRST),
        ("station.v2#2", (), SECOND),
        ("station.v2#360 Deg", (), SECOND),
        ("h.at2", ("vertical.file=station.v2",), FIRST),
    ],
)
def test_each_direction_takes_its_component(motion, changes, horizontal):
    assert moved(motion, *changes, table="motion").values == pytest.approx(horizontal, abs=2e-6)
    assert moved(motion, *changes, table="vertical").values == pytest.approx(THIRD, abs=2e-6)


def test_the_vertical_component_follows_what_is_common_to_both():
    changes = ("motion.start_s=1.0", "motion.end_s=3.0", "vertical.scale=-1")
    for vertical in ((), ("vertical.file=v.at2",)):
        found = moved("station.v2#1", *changes, *vertical, table="vertical")
        assert (found.times[0], found.times[-1]) == pytest.approx((0.0, 2.0))
        assert found.values == pytest.approx(-THIRD[200:601], abs=2e-6)
    both = moved("pair.csv", "motion.scale_to_m_s2=1.5", table="motion")
    assert np.abs(both.values).max() == pytest.approx(1.5)


@pytest.mark.parametrize(("peak", "noted"), [("0.32", True), ("0.04", False), ("0.6", False), ("3.2", False)])
def test_a_peak_that_looks_like_g_is_noted(peak, noted):
    case = load_case("case.toml", (f"motion.scale_to_m_s2={peak}",), motion="pair.csv")
    words = "motion.scale_to_m_s2: 0.32 m/s2 = 0.033 g; is it in g, 3.14 m/s2?"
    assert (words in recorded_motion(case, "motion").notes) is noted


@pytest.mark.parametrize(
    ("motion", "changes", "words"),
    [
        ("h.at2", ("vertical.kind=table",), r"\[vertical\] h.at2: no vertical component"),
        ("one.at2", ("vertical.kind=table",), "has one motion, which moves the floor along x already"),
        ("one.at2#1", ("vertical.kind=table", "vertical.file=one.at2#1"), "has one motion, which moves"),
        ("h.at2", ("vertical.kind=table", "vertical.file=slow.at2"), "0.005 and 0.01 s between samples"),
        ("h.at2", ("motion.start_s=5.0",), "nothing is left of it: its times are 0 to 4 s"),
        (".", (), "which is a folder"),
        ("bare.csv", ("motion.unit=ft/s2",), r"got the text 'ft/s2'(?! *;)"),
        ("secret.txt", (), "secret.txt: no numbers were found"),
    ],
)  # fmt: skip
def test_what_cannot_move_the_floor_is_refused_with_exit_code_2(motion, changes, words, capsys):
    table = "vertical" if "vertical.kind=table" in changes else "motion"
    with pytest.raises(CaseError, match=words):
        moved(motion, *changes, table=table)
    options = [word for change in changes for word in ("--set", change)]
    assert main(["check", "case.toml", "--motion", motion, *options]) == 2
    said = capsys.readouterr().err
    assert f"[{table}]" in said and "root:" not in said


def test_components_of_one_recording_are_cut_to_what_they_share():
    # real sets have 2676, 2671 and 2300 samples, or 7999 and 7998
    keys = ("vertical.kind=table", "vertical.file=short.at2")
    both = [moved("h.at2", *keys, table=table) for table in ("motion", "vertical")]
    assert [motion.times.size for motion in both] == [700, 700]
    assert both[0].values == pytest.approx(FIRST[:700], abs=2e-6)
    case = load_case("case.toml", keys, motion="h.at2")
    note = "h.at2, short.at2 have 801, 700 samples: they are cut to the 700 that all have"
    assert note in recorded_motion(case, "motion").notes and note in recorded_motion(case, "vertical").notes
    # what the keys take of both is compared, not what the files hold
    ended = load_case("case.toml", (*keys, "motion.end_s=3.0", "vertical.end_s=3.0"), motion="h.at2")
    assert not any("samples" in note for note in recorded_motion(ended, "motion").notes)
    assert recorded_motion(ended, "vertical").motion.times[-1] == 3.0
    late = load_case("case.toml", (*keys, "vertical.start_s=0.5"), motion="h.at2")
    assert recorded_motion(late, "vertical").motion.times.size == 600


def test_components_that_were_not_sampled_together_are_refused(folder):
    (folder / "brief.at2").write_text(files.peer(THIRD[:300] / G, "UP"))
    rows = "".join(f"{0.0123 + STEP * k:.4f},{v:.6f}\n" for k, v in enumerate(THIRD))
    (folder / "late.csv").write_text(f"t [s],UP [m/s2]\n{rows}")
    for name, words in (("brief.at2", "801 and 300 samples"), ("late.csv", r"up to 0\.0123 s apart in time")):
        with pytest.raises(CaseError, match=f"do not belong together: .*{words}"):
            moved("h.at2", "vertical.kind=table", f"vertical.file={name}", table="vertical")


@pytest.mark.parametrize("missing", [1, 100])
def test_a_gap_is_refused_with_its_times_and_bridged_where_that_is_asked(folder, missing):
    lines = files.columns([FIRST, THIRD]).splitlines(keepends=True)
    (folder / "gap.csv").write_text("".join(lines[:200] + lines[200 + missing :]))
    words = rf"gap.csv: no samples between 0.995 and {1 + STEP * missing:g} s"
    for table in ("motion", "vertical"):
        with pytest.raises(CaseError, match=rf"\[{table}\] {words}"):
            moved("gap.csv", "motion.unit=m/s2", table=table)
        found = moved("gap.csv", "motion.unit=m/s2", "motion.gaps=bridge", table=table)
        assert found.times.size == FIRST.size - missing
