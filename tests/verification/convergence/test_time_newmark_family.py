"""The Newmark family on one elastic mode in free flight, against the theory of its authors.

The rigid part of the block floats in the air without gravity; what is tested is the compiled stepper itself,
with its change of steps, and not a copy of its formulas.
"""

import math

import numpy as np
import pytest
from block_on_floor import Block, rig

from contact.interface.equilibrium import Stance
from contact.stepping.scheme import Scheme, generalised_alpha, newmark

SECOND_ORDER = {
    "rho 0": generalised_alpha(0.0),
    "rho 0.3": generalised_alpha(0.3),
    "rho 0.5": generalised_alpha(0.5),
    "rho 0.8": generalised_alpha(0.8),
    "rho 1": generalised_alpha(1.0),
    "average acceleration": newmark(0.25, 0.5),
}
FREQUENCY, DAMPING = 20.0, 0.02  #: of the oscillator [rad/s], [-]
START, START_RATE = 0.3, -2.0


THROWN = Stance(
    centre=(0.0, 14.0), rotation=0.1, velocity=(1.5, 4.0), angular_velocity=0.7, force=np.zeros((2, 2))
)


def oscillator_error(scheme: Scheme, step: float, breaks=None) -> float:
    """Distance in the phase plane from the exact damped oscillation, after 1 s or just beyond."""
    run = rig(
        Block(gravity=0.0),
        stance=THROWN,
        scheme=scheme,
        largest_step=step,
        fixed_step=True,
        sampled=1e3,
        breaks=breaks,
        shape=np.zeros((2, 2, 1)),
        frequencies=np.array([FREQUENCY]),
        damping_ratios=np.array([DAMPING]),
        amplitudes=np.array([START]),
        rates=np.array([START_RATE]),
    ).advance(1.0)
    damped = FREQUENCY * math.sqrt(1.0 - DAMPING**2)
    decay = -DAMPING * FREQUENCY + 1j * damped  # q = Re(c exp(decay t))
    c = START - 1j * (START_RATE + DAMPING * FREQUENCY * START) / damped
    q = c * np.exp(decay * run.time)
    found = run.run.old
    return math.hypot(found.position[3] - q.real, (found.velocity[3] - (decay * q).real) / FREQUENCY)


def observed_order(steps: np.ndarray, errors: list[float]) -> float:
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


STEPS = 4e-3 / 2.0 ** np.arange(4)


@pytest.mark.parametrize("scheme", SECOND_ORDER.values(), ids=SECOND_ORDER)
def test_steps_that_change_all_the_time_keep_the_second_order(scheme):
    # The scheme's acceleration lags; were it not shifted when the step changes, the order would fall to one.
    errors = []
    for h in STEPS:
        pattern = np.tile([0.9, 0.3, 0.5, 0.7], round(1.0 / (2.4 * h)) + 4)
        errors.append(oscillator_error(scheme, h, breaks=np.cumsum(pattern) * h))
    assert observed_order(STEPS, errors) == pytest.approx(2.0, abs=0.1)
