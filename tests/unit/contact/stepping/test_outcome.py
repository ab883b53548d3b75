"""A run for its outcome alone: the same bytes as slice by slice with samples."""

import numba
import numpy as np
import pytest

from contact.stepping.integrator import OVERTURNED, REACHED
from contact.stepping.outcome import advance_compiled, run_to_end
from fem.case.case import load_case
from fem.model.container import discretise
from fem.model.model import build_model

LOOSE = ("container.joints=loose", "container.boxes=3")
VERTICAL = ("vertical.kind=harmonic", "vertical.amplitude_m=0.01", "vertical.angular_frequency_rad_s=12")
DURATION = 2.5
PEAK, RATE = "motion.peak_acceleration_m_s2", "motion.angular_frequency_rad_s"
SLAB = {"floor.kind": "slab", "floor.preset": "concrete C25/30", "floor.corner_patch_m": [0.008, 1.1]}
MOTIONS = (
    ({PEAK: 4.0, RATE: 6.928}, REACHED),
    ({PEAK: 8.0, RATE: 2.0, "contact.mu_static": 0.9}, OVERTURNED),
    ({PEAK: 4.0, "contact.mu_static": 0.3}, REACHED),
    ({"contact.damping_ratio": 0.5, "contact.normal_penalty_Pa_m": 2e9}, REACHED),
    ({"motion.start": "rest"}, REACHED),
    (SLAB, REACHED),
    ({"floor.slope_percent": 2.0}, REACHED),
)


@pytest.fixture(scope="module")
def model_of():
    overrides = ["solver.model=rigid", "output.fields_s=0", f"solver.duration_s={DURATION}"]
    case = load_case("seed_stack_plateau", [*overrides, "contact.mu_kinetic=0.2"])
    container = discretise(case)
    return lambda values: build_model(case.with_values(values), container)


def step_in_slices(model):
    clock = model.run.clock[0]
    clock.attempt_limit = 200_000
    while clock.time < DURATION:
        status = advance_compiled(model.body, model.run, DURATION)
        clock.samples_drained = clock.samples
        if status != REACHED:
            return status
        assert clock.steps + clock.rejected < clock.attempt_limit, "it makes no progress"
    return REACHED


@pytest.mark.parametrize(("values", "status"), MOTIONS)
def test_an_outcome_is_that_of_the_run(model_of, values, status):
    found, expected = model_of(values), model_of(values)
    assert run_to_end(found.body, found.run, DURATION).status == step_in_slices(expected) == status
    assert found.run.old.numbers.tobytes() == expected.run.old.numbers.tobytes()
    assert found.run.ledger.tobytes() == expected.run.ledger.tobytes()
    for name in found.run.track.dtype.names:
        assert np.array_equal(found.run.track[name], expected.run.track[name], equal_nan=True), name
    for name in ("steps", "rejected", "time"):
        assert found.run.clock[name][0] == expected.run.clock[name][0]


@pytest.mark.parametrize("model", ["rigid", pytest.param("reduced", marks=pytest.mark.slow)])
def test_instances_of_a_class_have_fields_of_one_type(model):
    """So a run for its outcome is called by class."""
    cases = [
        load_case(name, [f"solver.model={model}", *more])
        for name, more in (
            ("seed_stack_plateau", ()),
            ("seed_box", ("contact.friction=regularised", "output.fields_s=0")),
            ("rocking", ("support.kind=flat", *VERTICAL)),
            ("overturning", ("floor.kind=rigid", "floor.slope_percent=1")),
            ("seed_stack", LOOSE),
        )
    ]
    types = {}
    for case in cases:
        built = build_model(case)
        for one in (built.run, built.body):
            fields = numba.typeof(one).fields
            assert types.setdefault(type(one), fields) == fields
        assert run_to_end(built.body, built.run, 0.01).status == REACHED
