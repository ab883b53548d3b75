"""The reduced model between its limits: towards the full one with its modes, towards the rigid one with stiffness."""

from functools import cache

import numpy as np
import pytest
from container_runs import SHELL, SOLID, Finished, difference, run, stack

#: of the solid stack on corners at the default penalty [Pa/m]: held, so that only the container changes
PENALTY = 4.577e9
MODULI = (1e11, 1e12, 1e13)


@cache
def shell_with(modes: int) -> Finished:
    return run(stack(**SHELL, solver__elastic_modes=modes, solver__duration_s=1.3))


@cache
def solid_with(modulus: float, penalty: float) -> Finished:
    """Rigid for an infinite modulus; steps small enough that the stepping does not show in the differences."""
    elastic = {} if np.isinf(modulus) else {"container.youngs_modulus_Pa": modulus}
    case = stack(
        **SOLID,
        solver__duration_s=1.3,
        solver__step_s=2e-4,
        solver__model="rigid" if np.isinf(modulus) else "reduced",
        contact__normal_penalty_Pa_m=penalty,
    )
    return run(case.with_values(elastic))


def test_motion_converges_with_the_number_of_modes() -> None:
    # Attachment modes carry the local deformation under the corners whatever the number, so none at all is near.
    full = run(stack(**SHELL, solver__model="full", solver__duration_s=1.3))
    errors = {modes: difference(shell_with(modes), full) for modes in (0, 2, 5, 20, 40)}
    assert errors[0] <= 0.01
    assert errors[5] <= 1e-3
    assert errors[20] <= 3e-4
    assert errors[40] <= 3e-4
    assert errors[0] > 2.0 * errors[2] > 4.0 * errors[5]


def test_velocity_ratio_does_not_depend_on_the_number_of_modes_beyond_five() -> None:
    ratios = [shell_with(modes).velocity_ratio for modes in (5, 10, 20, 40, 80)]
    assert np.ptp(ratios) < 1e-3


def test_rigid_is_the_limit_of_reduced_before_the_first_impact() -> None:
    # On one corner the container bends and shears under its own weight: a deflection of the order 1/E.
    rigid = solid_with(np.inf, PENALTY)
    apart = [difference(solid_with(modulus, PENALTY), rigid, until=0.7) for modulus in MODULI]
    order = np.polyfit(np.log(MODULI), np.log(apart), 1)[0]
    assert order == pytest.approx(-1.0, abs=0.02)
    assert apart[0] < 1e-5


def test_rigid_is_the_limit_of_reduced_through_an_impact() -> None:
    # A softer floor takes the frequency ratio to f1/f_c = 11, 34, 107. Through a damped impact the difference falls
    # more slowly than 1/E, near 1/sqrt(E): the frequency ratio is what counts.
    rigid = solid_with(np.inf, 0.1 * PENALTY)
    apart = [difference(solid_with(modulus, 0.1 * PENALTY), rigid) for modulus in MODULI]
    assert apart[0] < 3e-3
    assert apart[1] < 1e-3
    assert apart[2] < 3e-4
    assert np.polyfit(np.log(MODULI), np.log(apart), 1)[0] < -0.4


def test_rigid_and_stiff_solid_lose_what_housner_says() -> None:
    # e = 1 - 1.5 sin^2(slenderness angle) = 0.89454; with f1/f_c = 34 within the limits asked of both models.
    rigid, stiff = solid_with(np.inf, PENALTY), solid_with(1e13, PENALTY)
    assert rigid.velocity_ratio == pytest.approx(0.89454, abs=0.005)
    assert stiff.velocity_ratio == pytest.approx(0.89454, abs=0.01)
    assert rigid.first_impact == pytest.approx(0.700737, rel=3e-3)
    assert stiff.first_impact == pytest.approx(0.700737, rel=3e-3)
