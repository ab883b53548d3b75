"""Many rows in one call: the same bytes as one run at a time, whatever the threads and the neighbours."""

import numpy as np
import pytest

from contact.stepping.batch import pack_rows, run_rows
from contact.stepping.integrator import FAILED, OVERTURNED, REACHED, advance_compiled
from fem.case.case import load_case
from fem.model.container import discretise
from fem.model.model import build_model

DURATION = 2.5
MOTIONS = (
    {"motion.peak_acceleration_m_s2": 4.0, "motion.angular_frequency_rad_s": 6.928},
    # overturns
    {"motion.peak_acceleration_m_s2": 8.0, "motion.angular_frequency_rad_s": 2.0, "contact.mu_static": 0.9},
    {"motion.peak_acceleration_m_s2": 4.0, "motion.angular_frequency_rad_s": 9.0, "contact.mu_static": 0.3},
    {"contact.damping_ratio": 0.5, "contact.normal_penalty_Pa_m": 2e9},
    {"motion.start": "rest"},
)


@pytest.fixture(scope="module")
def models():
    case = load_case(
        "seed_stack_plateau",
        [
            "solver.model=rigid",
            "output.fields_s=0",
            f"solver.duration_s={DURATION}",
            "contact.mu_kinetic=0.2",
        ],
    )
    container = discretise(case)
    return lambda: [build_model(case.with_values(values), container) for values in MOTIONS]


def run_alone(model):
    while model.run.clock[0].time < DURATION:
        status = advance_compiled(model.body, model.run, DURATION)
        model.run.clock[0].samples_gone = model.run.clock[0].samples
        if status != REACHED:
            return status
    return REACHED


def outcomes_of(models, threads, order=None):
    chosen = [models[i] for i in order] if order is not None else models
    runs = [model.run for model in chosen]
    rows = pack_rows(runs, [DURATION] * len(runs), [0.0] * len(runs))
    tracks = np.concatenate([run.track for run in runs])
    return run_rows(models[0].body, runs[0].scheme, rows, tracks, threads=threads)


def test_a_row_is_the_run_that_it_stands_for(models):
    outcomes = outcomes_of(models(), threads=1)
    for k, model in enumerate(models()):
        assert outcomes.status[k] == run_alone(model)
        assert outcomes.rotation[k] == model.run.old.pose[0]
        assert outcomes.ledger[k].tobytes() == model.run.ledger.tobytes()
        for name in (
            "max_rotation",
            "max_slip",
            "impacts",
            "first_uplift",
            "modes",
            "restitution_by_velocity",
        ):
            assert np.array_equal(outcomes.track[name][k], model.run.track[name][0], equal_nan=True), name
        for name in ("steps", "rejected", "time"):
            assert outcomes.clock[name][k] == model.run.clock[name][0]


def test_rows_do_not_depend_on_threads_or_neighbours(models):
    one = outcomes_of(models() * 4, threads=1)
    two = outcomes_of(models() * 4, threads=2)
    backwards = outcomes_of(models(), threads=1, order=[4, 3, 2, 1, 0])
    assert one.ledger.tobytes() == two.ledger.tobytes()
    assert one.rotation.tobytes() == two.rotation.tobytes()
    assert one.ledger[:5].tobytes() == backwards.ledger[::-1].tobytes()


def test_rows_tell_standing_from_overturned(models):
    status = outcomes_of(models(), threads=1).status
    assert status[1] == OVERTURNED
    assert FAILED not in status
    assert status[0] == REACHED
