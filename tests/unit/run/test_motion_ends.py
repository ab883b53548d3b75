"""When a run ends: at rest after its motion, or at a given time; and what is said of a motion that it cuts short."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from cases import TABLE, named_case
from interrupted_runs import stored_run
from runs import finish, pulse

from contact.motion.base_motion import NoMotion, PulseMotion
from fem.__main__ import main
from fem.case.case import CaseError, load_case, read_case
from fem.cli.check import preview_of
from fem.model.model import build_model
from fem.model.motion import build_motion, build_motions, motion_result
from fem.results.level import Level, level_of, sure_in_words
from fem.results.reader import open_run
from fem.run.compute import compute
from fem.run.described import part_covered
from fem.run.summary import own_motion_name
from fem.study.runner import run_model

FREE = {"solver.model": "rigid", "solver.duration_s": "auto", "contact.mu_kinetic": 0.4}
FREE |= {"output.fields_s": 0.0, "output.figures": False}
#: a record of 4 s at 100 Hz whose peak of 1.75 g comes after 3 s
RECORD = np.column_stack([np.arange(401) / 100.0, np.where(np.arange(401) == 300, 1.75, 0.0)])
TABLE_CASE = f"""{TABLE}
[solver]
model = "rigid"
element_size_m = 0.5
[output]
fields_s = 0.0
figures = false
"""


def record_case(folder: Path, rows: np.ndarray = RECORD, more: str = ""):
    """The case of a record, in a folder, with lines of [solver] added."""
    np.savetxt(folder / "floor.csv", rows, delimiter=",")
    (folder / "case.toml").write_text(TABLE_CASE.replace("[output]", f"{more}\n[output]"))
    return load_case(folder / "case.toml")


@pytest.mark.parametrize(
    ("name", "shape", "peak", "outcome"),
    [
        ("seed_stack", "sine", 2.0, "rest"),
        ("seed_stack", "sine", 4.0, "rock"),
        ("seed_box", "rectangular", 6.0, "slide"),  # the floor goes on at 4.8 m/s
    ],
)
def test_a_pulse_run_ends_at_rest_before_its_cap(name, shape, peak, outcome):
    # a rigid floor: on one that crushes the stack rests with a tilt, one corner deeper than the other
    model = build_model(named_case(name, FREE | pulse(peak, 0.8, shape) | {"floor.kind": "rigid"}))
    done = finish(model)
    end, resting = float(done.model.run.clock.time[0]), float(done.model.run.clock.rest_since[0])
    assert done.outcome == outcome and end < 0.5 * model.duration
    assert end - resting == pytest.approx(1.0 / model.static.frequency_parameter, abs=0.06)
    tail = done.history["time_s"] >= resting
    assert np.abs(done.history["rotation_rad"][tail]).max() < 1e-3 * model.static.slenderness_angle
    # in 5 s more it would still do nothing
    longer = finish(build_model(model.case.with_values({"solver.duration_s": end + 5.0})))
    assert abs(float(longer.model.run.joints.slip[0] - model.run.joints.slip[0])) < 1e-6


def test_a_run_and_a_batch_end_at_the_same_instant_with_the_same_bits():
    case = named_case("seed_stack", FREE | pulse(4.0, 0.8, "sine"))
    one, other = build_model(case.with_values({"output.fields_s": 0.0007})), build_model(case)
    finish(one)
    row = run_model(other)
    assert one.run.clock.time[0] == other.run.clock.time[0] < one.duration
    assert row["residual_slip_m"] == one.run.joints.slip[0]


def test_free_motion_ends_with_a_fall_or_at_the_cap():
    fallen = finish(build_model(named_case("seed_stack", FREE | pulse(6.0, 0.8, "sine"))))
    assert fallen.status == "overturned" and float(fallen.model.run.clock.time[0]) < 5.0
    smooth = pulse(3.0, 0.8) | {"contact.mu_static": 0.0, "contact.mu_kinetic": 0.0}
    sliding = finish(build_model(named_case("seed_box", FREE | smooth)))
    assert float(sliding.model.run.clock.time[0]) == pytest.approx(60.8)
    assert sliding.model.run.clock.rest_since[0] == math.inf


@pytest.mark.parametrize("compute", [finish, run_model])
def test_the_floor_that_is_left_at_speed_gives_the_contents_no_jerk(compute):
    # Beyond its slenderness angle at 1.5 s; the floor, then at 2.7 m/s, is the frame of what follows.
    keys = {"solver.model": "rigid", "solver.duration_s": 1.5, "output.fields_s": 0.0}
    model = build_model(named_case("overturning", keys))
    compute(model)
    assert float(model.run.clock.time[0]) > 1.9 and float(model.run.track.max_acceleration[0]) < 30.0


def test_the_resolved_case_of_a_pulse_gives_the_same_run(tmp_path):
    case = named_case("seed_box", FREE | pulse(6.0, 0.8, "sine") | {"contact.mu_kinetic": 0.2})
    first = stored_run(case, tmp_path / "first", band=False, margin=False)
    again = load_case(tmp_path / "first" / "resolved.toml")
    assert again.solver.duration_s == "auto" and again.solver.step_s != "auto"
    second = stored_run(again, tmp_path / "second", band=False, margin=False)
    assert first.history.samples.tobytes() == second.history.samples.tobytes()
    assert first.typed_result.verdict.at_rest_s == second.typed_result.verdict.at_rest_s
    assert first.typed_result.case_hash == second.typed_result.case_hash


def test_a_record_cut_short_says_so_in_its_first_line(tmp_path, monkeypatch):
    record_case(tmp_path, more="duration_s = 2.0")
    monkeypatch.chdir(tmp_path)
    assert main(["run", "case.toml", "--out", "cut", "-q", "--no-band"]) == 0
    line = (tmp_path / "cut" / "summary.txt").read_text().replace("\n", " ")
    document = json.loads((tmp_path / "cut" / "run.json").read_text())
    assert document["verdict"]["first_line"] in line and "1.75 g" in line
    motion = document["motion"]
    assert (motion["duration_s"], motion["step_s"], motion["samples"]) == (4.0, pytest.approx(0.01), 401)
    assert motion["covered"] == pytest.approx(0.5)
    assert motion["peak_acceleration_m_s2"] == pytest.approx(1.75 * 9.80665)
    assert open_run(tmp_path / "cut").typed_result.motion.peak_in_run_m_s2 == 0.0


def test_a_record_of_negative_times_is_covered_from_zero_on(tmp_path):
    case = record_case(tmp_path, RECORD - [1.0, 0.0])
    found = motion_result(case, *build_motions(case))
    assert found.covered == pytest.approx(0.75)
    assert part_covered(found) == "3 of 4 s, from 1 s of it on"
    with pytest.raises(CaseError, match="its times end at -1 s, and the run begins at t = 0; shift them"):
        build_motion(record_case(tmp_path, RECORD - [5.0, 0.0]))


def test_a_record_too_long_for_its_samples_is_refused_when_it_is_read(tmp_path):
    times = 0.1 * np.arange(40_001)
    rows = np.column_stack([times, np.cos(times)])
    case = record_case(tmp_path, rows).with_values({"output.history_s": 5e-5})
    with pytest.raises(CaseError, match=r"8.12e\+07 samples of duration_s = 4060 s"):
        build_model(case)


@pytest.mark.parametrize("shape", ["rectangular", "half-sine", "sine"])
def test_peaks_of_a_pulse_are_its_integrals(shape):
    values = {"motion.shape": shape, "motion.delay_s": 0.3, "solver.duration_s": 5.0}
    case = read_case(named_case("pulse").text).with_values(values)
    found = preview_of(case).motion
    motion = build_motion(case)
    assert isinstance(motion, PulseMotion)
    x, v, a = np.abs(motion.evaluate(np.linspace(0.0, 0.8, 20_001))).max(axis=1)
    assert found.peak_acceleration_m_s2 == pytest.approx(a, rel=1e-6)
    assert found.peak_velocity_m_s == pytest.approx(v, rel=1e-6)
    assert found.peak_displacement_m == pytest.approx(x, rel=1e-6)
    # the same by evaluation, where the run covers a part of it
    part = motion_result(case.with_values({"solver.duration_s": 0.35}), motion, NoMotion())
    assert part.covered == pytest.approx(0.35 / 0.8)
    assert part.peak_velocity_m_s == pytest.approx(v, rel=1e-4)
    assert part.peak_displacement_m == pytest.approx(x, rel=1e-4)


def test_a_run_that_ends_in_mid_swing_says_so_and_is_not_sure():
    """Half-sine of 7 m/s2 on a box of 0.6 m by 2 m: turned by 70 % of the angle after 0.6 s, it falls after 2 s."""
    box = {"container.width_m": 0.6, "container.height_m": 2.0, "contact.mu_static": 0.6} | FREE
    shaken = {"motion.kind": "pulse", "motion.shape": "half-sine", "motion.pulse_s": 0.4}
    shaken |= {"motion.peak_acceleration_m_s2": 7.0, "contact.mu_kinetic": 0.6, "container.mass_kg": 400.0}
    case = named_case("least", box | shaken)
    whole, cut = (
        compute(case.with_values({"solver.duration_s": until}), band=True, margin=False)
        for until in ("auto", 0.6)
    )
    assert (whole.verdict.outcome, cut.verdict.outcome) == ("overturned", "rock")
    at_end = abs(cut.history["rotation_rad"][-1]) / cut.slenderness_angle
    assert cut.verdict.still_turned == pytest.approx(at_end, rel=1e-3) and at_end > 0.5
    assert "until its run ends, still rocking" in cut.verdict.first_line
    assert sure_in_words(cut.typed_result) == "stands until its run ends"
    assert any(warning.startswith("the run ends while") for warning in cut.typed_result.warnings)
    assert whole.verdict.still_turned is None


def test_a_run_that_ends_while_the_container_slides_says_so():
    """Friction of 0.2 takes a box from 1 m/s to rest in 0.51 s."""
    pushed = {
        "initial.velocity_m_s": 1.0,
        "contact.mu_static": 0.2,
        "contact.mu_kinetic": 0.2,
        "motion.kind": "none",
    }
    case = named_case("least", {"container.width_m": 2.0, "container.height_m": 1.0} | FREE | pushed)
    until = {0.2: 1.0 - 0.2 * 0.2 * 9.81, 2.0: None}
    for duration, speed in until.items():
        run = compute(case.with_values({"solver.duration_s": duration}), band=False, margin=False)
        assert run.verdict.still_sliding_m_s == (speed and pytest.approx(speed, rel=0.02))
        assert ("until its run ends, still sliding" in run.verdict.first_line) is bool(speed)
        assert level_of(run.typed_result) == (Level.CUT if speed else Level.STANDS)


@pytest.mark.parametrize(("duration", "said"), [(0.3, "0.33 periods, 0.3 s"), (6.0, "")])
def test_a_harmonic_motion_of_few_periods_is_no_motion_without_end(duration, said):
    case = load_case("seed_stack_plateau", [f"solver.duration_s={duration}", "solver.model=rigid"])
    assert part_covered(motion_result(case, *build_motions(case))) == said


def test_the_static_rule_on_a_slope_is_headed_by_the_peak_along_the_floor():
    """A horizontal peak of 2 m/s2 on 25 per cent has 2 cos(atan 0.25) = 1.940 m/s2 along the floor."""
    slope = {"floor.slope_percent": 25.0, "motion.peak_acceleration_m_s2": 2.0, "solver.duration_s": 2.0}
    harmonic = {"motion.kind": "harmonic", "motion.frequency_Hz": 1.0, "contact.mu_static": 0.4}
    run = compute(named_case("least", FREE | harmonic | slope), band=False, margin=False)
    name = own_motion_name(run.typed_result.static, run.typed_result.motion)
    assert name.startswith("own peak, 1.94 m/s2 and 2.38 m/s2 downhill")
    assert np.abs(run.history["base_acceleration_m_s2"]).max() == pytest.approx(1.940, abs=1e-3)


@pytest.mark.parametrize(
    ("changes", "said"),
    [(["height_m=2"], True), (["height_m=2", "centroid_m=1.2"], False), (["width_m=2"], False), ([], False)],
)
def test_a_mass_centre_that_stays_where_the_height_is_set_is_told_of_before_the_run(changes, said):
    """The file states 0.5 m for boxes of 1 m."""
    case = load_case("seed_stack", [f"container.{change}" for change in changes])
    assert any("mass centre stays at 0.5 m" in note for note in preview_of(case).notes) is said
