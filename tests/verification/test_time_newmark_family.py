"""The Newmark family on one elastic mode in free flight, against the theory of its authors.

The rigid part of the block floats in the air without gravity; what is tested is the compiled stepper itself,
with its change of steps, and not a copy of its formulas.
"""

import math

import numpy as np
import pytest
from block_on_floor import GRAVITY, Block, Rig, rig

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
SCHEMES = SECOND_ORDER | {"damped Newmark": newmark(0.3025, 0.6)}
FREQUENCY, DAMPING = 20.0, 0.02  #: of the oscillator [rad/s], [-]
START, START_RATE = 0.3, -2.0


def in_the_air(height: float) -> Stance:
    return Stance(
        centre=(0.0, 10.0 + height),
        rotation=0.0,
        velocity=(0.0, 0.0),
        angular_velocity=0.0,
        force=np.zeros((2, 2)),
    )


def oscillator(
    scheme: Scheme, step: float, *, frequency: float = FREQUENCY, damping: float = DAMPING, breaks=None
) -> Rig:
    block = Block(gravity=0.0)
    return rig(
        block,
        stance=in_the_air(block.height),
        scheme=scheme,
        largest_step=step,
        fixed_step=True,
        sampled=1e3,
        breaks=breaks,
        shape=np.zeros((2, 2, 1)),
        frequencies=np.array([frequency]),
        damping_ratios=np.array([damping]),
        amplitudes=np.array([START]),
        rates=np.array([START_RATE]),
    )


def oscillator_error(scheme: Scheme, step: float, breaks=None) -> float:
    """Distance in the phase plane from the exact damped oscillation, after 1 s or just beyond."""
    run = oscillator(scheme, step, breaks=breaks).advance(1.0)
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


def test_numerical_damping_by_gamma_costs_newmark_its_second_order():
    errors = [oscillator_error(SCHEMES["damped Newmark"], h) for h in STEPS]
    assert observed_order(STEPS, errors) == pytest.approx(1.0, abs=0.05)


def amplification(scheme: Scheme, sampled_frequency: float, damping: float) -> np.ndarray:
    """What one step does to (q, h q', h^2 q''), taken from the stepper; argument omega h [rad]."""
    step = 1e-3
    columns = []
    for start in np.eye(3):
        one = oscillator(scheme, step, frequency=sampled_frequency / step, damping=damping)
        old, body = one.run.old, one.body
        old.position[3], old.velocity[3], old.acceleration[3] = start / step ** np.arange(3)
        old.damping[3] = body.damping[0] * old.velocity[3]
        old.internal[3] = old.damping[3] + body.stiffness[0] * old.position[3]
        one.advance(0.5 * step)
        assert one.time == step
        end = np.array([old.position[3], old.velocity[3], old.acceleration[3]])
        columns.append(end * step ** np.arange(3))
    return np.column_stack(columns)


def characteristic_polynomial(scheme: Scheme, sampled_frequency: float, damping: float) -> np.ndarray:
    """Of the averaged equation and Newmark's formulas with velocity and displacement eliminated.

    ((1-a_m) z + a_m)(z-1)^2 + ((1-a_f) z + a_f)[W^2 N(z) + 2 zeta W (1-gamma+gamma z)(z-1)] = 0,
    N(z) = beta z^2 + (1/2 + gamma - 2 beta) z + 1/2 - gamma + beta, W = omega h.
    """
    beta, gamma, alpha_m, alpha_f = scheme
    jump = [1.0, -1.0]
    inertia = np.polymul([1.0 - alpha_m, alpha_m], np.polymul(jump, jump))
    spring = sampled_frequency**2 * np.array([beta, 0.5 + gamma - 2.0 * beta, 0.5 - gamma + beta])
    dashpot = 2.0 * damping * sampled_frequency * np.polymul([gamma, 1.0 - gamma], jump)
    polynomial = np.polyadd(inertia, np.polymul([1.0 - alpha_f, alpha_f], np.polyadd(spring, dashpot)))
    return polynomial / polynomial[0]


@pytest.mark.parametrize("damping", [0.0, 0.3])
@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_a_step_amplifies_as_the_published_scheme_does(scheme, damping):
    for sampled in 10.0 ** np.arange(-2.0, 5.0, 0.5):
        matrix = amplification(scheme, sampled, damping)
        expected = characteristic_polynomial(scheme, sampled, damping)
        assert np.poly(matrix) == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


def test_gravity_alone_is_integrated_exactly():
    # Newmark's formulas are exact for a constant acceleration.
    run = rig(Block(), stance=in_the_air(4.0), largest_step=7e-3, fixed_step=True, sampled=1e3).advance(1.0)
    assert run.run.old.position[1] == pytest.approx(14.0 - 0.5 * GRAVITY * run.time**2, rel=1e-13)
    assert run.run.old.velocity[1] == pytest.approx(-GRAVITY * run.time, rel=1e-13)
