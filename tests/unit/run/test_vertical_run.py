"""A run whose floor moves up and down: what its files, its words and its pages say of it."""

import math
from pathlib import Path

import numpy as np
import pytest
from interrupted_runs import stored_run
from runs import pulse

from fem import compute
from fem.case.case import load_case
from fem.model.model import build_model
from fem.report.animation import animation_of
from fem.run.summary import plain_summary

OMEGA, PHASE = 9.0, 0.5
VERTICAL = (
    *("vertical.kind=harmonic", "vertical.peak_acceleration_m_s2=3.0"),
    *(f"vertical.angular_frequency_rad_s={OMEGA}", f"vertical.phase_rad={PHASE}", "vertical.scale=-1"),
)
RIGID = (
    *("solver.model=rigid", "floor.kind=rigid", "solver.duration_s=1.5", "contact.mu_static=0.8"),
    "output.figures=false",
)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A short run of the stack under both motions, compared with the rigid block."""
    case = load_case("seed_stack_plateau", [*RIGID, *VERTICAL])
    return stored_run(case, tmp_path_factory.mktemp("vertical") / "run", band=False, check_rigid=True)


def test_the_history_has_the_motion_of_the_floor_upward(run):
    history, amplitude = run.history, -3.0 / OMEGA**2
    turn = OMEGA * history["time_s"] + PHASE
    for column, expected in (
        ("base_vertical_displacement_m", amplitude * np.sin(turn)),
        ("base_vertical_velocity_m_s", amplitude * OMEGA * np.cos(turn)),
        ("base_vertical_acceleration_m_s2", -amplitude * OMEGA**2 * np.sin(turn)),
    ):
        assert history[column] == pytest.approx(expected, abs=1e-12)
    assert history.joints == 3
    assert history.numbers[20:24] == (
        *("base_vertical_displacement_m", "base_vertical_velocity_m_s"),
        *("base_vertical_acceleration_m_s2", "joint_1_normal_N"),
    )
    weight = history["normal_force_N"][0] / (1.0 + history["base_vertical_acceleration_m_s2"][0] / 9.81)
    assert weight == pytest.approx(98100.0, rel=1e-6)


def test_the_static_rule_with_the_least_weight_stands_beside_the_other(run):
    static = run.typed_result.static
    assert static.own_motion_vertical.least_weight_N == pytest.approx(98100.0 * (1.0 - 3.0 / 9.81))
    for check in ("utilisation_sliding", "utilisation_overturning"):
        plain, upward = (getattr(one, check) for one in (static.own_motion, static.own_motion_vertical))
        assert upward == pytest.approx(plain / (1.0 - 3.0 / 9.81))


def test_frames_and_animation_move_with_the_floor(run):
    lifts = [run.fields.frame(k).floor_lift for k in range(0, len(run.fields), 5)]
    assert lifts == pytest.approx(-3.0 / OMEGA**2 * np.sin(OMEGA * run.fields.times[::5] + PHASE), abs=1e-7)
    shown = animation_of(build_model(run.case), run.fields)
    heights = [frame.centre[0, 1] - frame.floor[1] for frame in shown.frames[:3]]
    assert heights == pytest.approx([2.0] * 3, abs=1e-3)


def test_what_a_floor_without_vertical_motion_writes_stays(tmp_path):
    case = load_case("seed_stack_plateau", [*RIGID, "output.fields_s=0"])
    stored_run(case, tmp_path / "run", band=False)
    text = (tmp_path / "run" / "run.json").read_text()
    assert "vertical" not in text and "least_weight" not in text
    assert "vertical" not in (tmp_path / "run" / "history.csv").read_text().partition("\n")[0]
    assert "vertical" not in (tmp_path / "run" / "resolved.toml").read_text()


def test_a_run_on_two_motions_lasts_as_long_as_the_longer_one():
    later = pulse(1.0, 0.4, "sine") | {"motion.delay_s": 0.3}
    upward = {key.replace("motion", "vertical"): value for key, value in later.items()}
    free = {"solver.duration_s": "auto", "solver.model": "rigid"}
    case = load_case("seed_box").with_values(pulse(1.0, 0.5, "sine") | upward | free)
    model = build_model(case)
    assert model.rest_from == 0.7
    assert model.duration == 60.7
    assert math.isinf(build_model(case.with_values({"solver.duration_s": 2.0})).rest_from)


def test_a_container_that_leaves_its_floor_hops_and_its_verdict_is_tried():
    values = ["solver.model=rigid", "floor.kind=rigid", "motion.kind=none", "solver.duration_s=2"]
    strong = [
        *("vertical.kind=harmonic", "vertical.peak_acceleration_m_s2=15", "vertical.frequency_Hz=3"),
        "uncertainty.draws=0",
    ]
    run = compute(load_case("seed_stack_plateau", [*values, *strong]), margin=False)
    verdict, static = run.verdict, run.typed_result.static
    assert verdict.outcome == "hop" and "hop" in verdict.modes and verdict.max_uplift_m > 1e-3
    assert static.own_motion_vertical.utilisation_lifting == pytest.approx(15.0 / 9.81, rel=1e-6)
    assert verdict.band is not None
    summary = plain_summary(run.typed_result, folder=Path("run"))
    assert "lifts off" in summary and "hopped" in summary


def test_a_rest_under_a_strong_vertical_motion_is_not_sure_untried():
    values = ["solver.model=rigid", "floor.kind=rigid", "motion.kind=none", "solver.duration_s=1"]
    weak = ["vertical.kind=harmonic", "vertical.frequency_Hz=3", "uncertainty.draws=0"]
    for peak, tried in ((4.0, True), (1.0, False)):
        case = load_case("seed_stack_plateau", [*values, *weak, f"vertical.peak_acceleration_m_s2={peak}"])
        verdict = compute(case, margin=False).verdict
        assert (verdict.outcome, verdict.sure, verdict.band is not None) == ("rest", "sure", tried)
