"""Limits of the step size, and the end of a run without progress."""

import numpy as np
import pytest
from runs import pulse

import contact.stepping.control
from contact.stepping.integrator import FAILED
from contact.stepping.outcome import run_to_end
from fem.case.case import CaseError, load_case
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.simulation import run_without_history, simulate, stepping_failure

LATER = {"motion.delay_s": 0.5, "solver.duration_s": 4.0, "output.fields_s": 0.0}


def rigid(**changes):
    values = {"solver.model": "rigid"} | {key.replace("__", "."): value for key, value in changes.items()}
    return load_case("rocking").with_values(values)


def finished(case):
    model = build_model(case)
    ending = simulate(model, Recorder(model))
    return model, ending


def test_a_pulse_of_microseconds_is_met_and_does_not_set_the_step_of_the_whole_run():
    """A pulse of 20 us, 2e5 times shorter than the run."""
    length = 2e-5
    model, ending = finished(rigid().with_values(LATER | pulse(100.0, length, "half-sine")))
    assert ending.status == "completed", ending.error
    assert model.run.clock[0].steps < 20_000
    assert float(model.run.floor[0, 1]) == pytest.approx(100.0 * length * 2.0 / np.pi, rel=1e-12)
    assert model.run.clock[0].smallest_step <= length / 50.0


def test_a_short_pulse_rocks_the_container_as_small_steps_throughout_do():
    values = LATER | pulse(50.0, 0.04, "half-sine")
    auto, _ = finished(rigid().with_values(values))
    fine, _ = finished(rigid().with_values(values | {"solver.step_s": 0.04 * 0.02}))
    assert auto.run.clock[0].steps < 0.7 * fine.run.clock[0].steps
    rotation = fine.run.track[0].max_rotation
    assert rotation > 0.05 * fine.static.slenderness_angle
    assert auto.run.track[0].max_rotation == pytest.approx(rotation, rel=2e-3)


def test_the_faster_vertical_motion_sets_the_step():
    upward = {"vertical.kind": "harmonic", "vertical.amplitude_m": 1e-3, "vertical.frequency_Hz": 10.0}
    control = build_model(rigid().with_values(upward)).run.problem.control
    assert control.largest_step == pytest.approx(0.02 * 0.1)
    with pytest.raises(CaseError, match=r"step_s = 0\.02 s would step over the motion.* at most 0\.01 s"):
        build_model(rigid(solver__step_s=0.02).with_values(upward))


def test_steps_end_where_either_motion_jumps():
    kicked = LATER | pulse(2.0, 1.0)
    upward = {key.replace("motion", "vertical"): value for key, value in kicked.items()}
    upward["vertical.delay_s"] = 0.8
    breaks = build_model(rigid().with_values(kicked | upward)).run.problem.breaks
    assert {0.5, 0.8, 1.5, 1.8} <= set(breaks.round(12))


def test_no_step_is_made_for_a_motion_that_changes_twice_within_the_smallest():
    """A step of 1e-163 s was, over whose square the inertia is no number."""
    values = LATER | pulse(6.0, 0.4, "half-sine") | {"solver.duration_s": 1.0}
    at_once, _ = finished(rigid().with_values(values | {"motion.delay_s": 0.0}))
    model, ending = finished(rigid().with_values(values | {"motion.delay_s": 1e-162}))
    assert ending.status == "completed", ending.error
    assert model.run.problem.breaks.tolist() == at_once.run.problem.breaks.tolist()
    assert model.run.old.position == pytest.approx(at_once.run.old.position, rel=1e-9)


def test_a_loose_tolerance_saves_steps_of_a_rigid_container_and_keeps_its_motion():
    model, ending = finished(rigid())
    for tolerance in (10.0, 30.0):
        coarse, coarse_ending = finished(rigid(solver__energy_tolerance=tolerance))
        assert ending.status == coarse_ending.status == "completed"
        assert coarse.run.clock[0].steps < 0.75 * model.run.clock[0].steps
        rotation = model.run.track[0].max_rotation
        assert coarse.run.track[0].max_rotation == pytest.approx(rotation, rel=0.01)
        elastic = rigid(solver__energy_tolerance=tolerance, solver__model="reduced")
        assert not build_model(elastic).run.problem.control.eager


def test_eager_steps_on_a_record_are_longer_and_keep_its_motion():
    times = np.arange(0.0, 12.0, 0.01)
    cycle = 4.0 * np.sin(2.0 * np.pi * times) * (times < 1.0)
    record = rigid(solver__duration_s="auto").with_motion(times, cycle)
    exact, close = (build_model(record.with_values({"solver.energy_tolerance": t})) for t in (1.0, 10.0))
    verdicts = [run_without_history(model, None)[0] for model in (exact, close)]
    assert close.run.clock[0].steps < 0.6 * exact.run.clock[0].steps
    assert verdicts[0].rotation_ratio > 0.1
    assert verdicts[1].rotation_ratio == pytest.approx(verdicts[0].rotation_ratio, rel=2e-3)


def test_a_run_without_headway_fails_and_says_so(monkeypatch):
    for name, few in (("SPARE", 50.0), ("OF_ROCKING", 1.0), ("OF_STEP", 0.1)):
        monkeypatch.setattr(contact.stepping.control, f"ATTEMPTS_{name}", few)
    _, ending = finished(rigid())
    assert ending.status == "failed"
    assert ending.error is not None and "no progress:" in ending.error


def test_a_run_for_its_outcome_that_is_no_longer_finite_says_so():
    """A step of 1e-163 s, over whose square the inertia is not finite; neither is the residual then."""
    model = build_model(rigid(solver__duration_s=1.0))
    outcome = run_to_end(model.body, model.run.with_problem(breaks=np.array([1e-163, np.inf])), 1.0)
    assert outcome.status == FAILED
    residual = float(np.abs(model.run.work.law - model.run.work.force).max())
    assert not np.isfinite(residual)
    assert "trial solution is not finite" in stepping_failure(model, residual)


@pytest.mark.parametrize("name", ["seed_box", "seed_stack_plateau"])
def test_numbers_that_kernels_receive_are_plain(name):
    """Those of numpy make numba look up the types of a run in Python at each call."""

    def numbers(data):
        for value in data:
            if isinstance(value, tuple):
                yield from numbers(value)
            elif not isinstance(value, np.ndarray):
                yield value

    model = build_model(load_case(name, ["solver.model=rigid"]))
    assert {type(value) for value in numbers((model.body, model.run))} <= {float, int, bool}
