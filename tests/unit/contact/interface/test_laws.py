"""Laws of one contact point: what they promise, and each tangent against a central difference."""

import math
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from contact.interface import laws
from fem.case.tables.container_tables import ContactTable

STIFFNESS, DAMPING, STEP = 2.7e9, 1.1e7, 1e-3
DECADES = 10.0 ** np.arange(-9.0, -1.0)


def central_difference(function, at: float) -> float:
    """First derivative, step 1e-4 of the argument: error of second order, far above rounding."""
    delta = 1e-4 * abs(at)
    return (function(at + delta) - function(at - delta)) / (2.0 * delta)


def normal(penetration: float, rate: float) -> tuple[float, float, float]:
    return laws.normal_force(penetration, rate, STIFFNESS, DAMPING, math.inf, STEP)


@pytest.mark.parametrize("penetration", DECADES)
@pytest.mark.parametrize("share", [-0.2, -0.01, 0.03, 0.5, 0.97, 1.03, 2.0, 50.0])
def test_normal_tangents_are_derivatives(penetration, share):
    rate = share * penetration / STEP  # share 1 divides the touching point from the one long closed
    force, by_penetration, by_rate = normal(penetration, rate)
    assert force > 0.0
    difference = central_difference(lambda p: normal(p, rate)[0], penetration)
    assert by_penetration == pytest.approx(difference, rel=1e-8)
    difference = central_difference(lambda v: normal(penetration, v)[0], rate)
    assert by_rate == pytest.approx(difference, rel=1e-8, abs=1e-6 * DAMPING)


@given(st.floats(-1e-2, 1e-2), st.floats(-10.0, 10.0), st.floats(1e-7, 1e-1))
def test_the_floor_never_pulls(penetration, rate, step):
    force, by_penetration, by_rate = laws.normal_force(penetration, rate, STIFFNESS, DAMPING, math.inf, step)
    assert force >= 0.0
    if penetration <= 0.0 or STIFFNESS * penetration + DAMPING * rate <= 0.0:
        assert (force, by_penetration, by_rate) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("share", [0.01, 0.5, 0.99, 1.01, 2.0, 100.0])
@given(st.floats(-1e-2, 1e-2), st.floats(-10.0, 10.0))
def test_a_floor_that_crushes_bears_the_cap_and_no_more(share, penetration, rate):
    elastic = normal(penetration, rate)
    cap = share * elastic[0] if elastic[0] > 0.0 else share
    capped = laws.normal_force(penetration, rate, STIFFNESS, DAMPING, cap, STEP)
    assert capped == (elastic if elastic[0] < cap else (cap, 0.0, 0.0))


@pytest.mark.parametrize("rate", [-2.0, 2.0, 20.0])  # leaving, entering, and within its first step
def test_the_cap_bounds_the_spring_and_the_dashpot_together(rate):
    spring, whole = STIFFNESS * 1e-2, normal(1e-2, rate)[0]
    cap = (spring + whole) / 2.0
    assert (
        laws.normal_force(1e-2, rate, STIFFNESS, DAMPING, cap, STEP)[0] == min(whole, cap) != min(spring, cap)
    )


@pytest.mark.parametrize("penetration", DECADES)
def test_the_force_is_continuous_where_the_dashpot_takes_over(penetration):
    rate = penetration / STEP
    below, above = normal(penetration, rate * (1.0 - 1e-12))[0], normal(penetration, rate * (1.0 + 1e-12))[0]
    assert below == pytest.approx(above, rel=1e-11)


@given(st.floats(-1e6, 1e6), st.floats(0.0, 1e6))
def test_return_mapping_stays_in_the_cone_and_moves_no_admissible_force(trial, limit):
    force, by_trial, by_limit = laws.stick_friction(trial, limit)
    assert abs(force) <= limit
    if abs(trial) <= limit:
        assert (force, by_trial, by_limit) == (trial, 1.0, 0.0)
    else:
        assert (force, by_trial, by_limit) == (math.copysign(limit, trial), 0.0, math.copysign(1.0, trial))


@pytest.mark.parametrize("limit", 10.0 ** np.arange(-3.0, 7.0))
@pytest.mark.parametrize("share", [-30.0, -1.01, -0.99, -1e-3, 1e-3, 0.99, 1.01, 30.0])
def test_return_mapping_tangents_are_derivatives(limit, share):
    trial = share * limit
    _, by_trial, by_limit = laws.stick_friction(trial, limit)
    assert by_trial == pytest.approx(
        central_difference(lambda t: laws.stick_friction(t, limit)[0], trial), abs=1e-9
    )
    assert by_limit == pytest.approx(
        central_difference(lambda m: laws.stick_friction(trial, m)[0], limit), abs=1e-9
    )


@pytest.mark.parametrize("steps", [1e-3, 0.1, 1.0, 5.0])
@pytest.mark.parametrize("stick", [-3e-6, 0.0, 7e-6])
def test_a_sliding_element_relaxes_like_its_differential_equation(steps, stick):
    force, stiffness, relaxation = 5e3, 2e9, 6e-3
    step = steps * relaxation

    def rate(_: float, s: np.ndarray) -> np.ndarray:
        return (force - stiffness * s) / (stiffness * relaxation)  # k s + c s' = F, c = k relaxation

    exact = solve_ivp(rate, (0.0, step), [stick], method="DOP853", rtol=1e-12, atol=1e-20).y[0, -1]
    assert laws.relaxed_stick(stick, force, stiffness, relaxation, step) == pytest.approx(exact, rel=1e-9)


def test_a_relaxed_element_ends_at_its_static_elongation():
    assert laws.relaxed_stick(1e-5, 5e3, 2e9, 6e-3, 10.0) == pytest.approx(5e3 / 2e9, rel=1e-14)
    assert laws.relaxed_stick(1e-5, 5e3, 2e9, 0.0, 1e-9) == 5e3 / 2e9  # no dashpot: at once


def sliding(normal_load: float, velocity: float, mu_static: float = 0.4) -> tuple[float, float, float]:
    return laws.regularised_friction(normal_load, velocity, mu_static, 0.2, 1e-3)


@pytest.mark.parametrize("mu_static", [0.2, 0.4])
@pytest.mark.parametrize("speed", 10.0 ** np.arange(-8.0, 0.6, 0.5))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_regularised_friction_tangents_are_derivatives(mu_static, speed, sign):
    load, velocity = 3e4, sign * speed
    _, by_normal, by_velocity = sliding(load, velocity, mu_static)
    difference = central_difference(lambda v: sliding(load, v, mu_static)[0], velocity)
    assert by_velocity == pytest.approx(difference, rel=1e-5, abs=1e-10 * load / speed)
    difference = central_difference(lambda n: sliding(n, velocity, mu_static)[0], load)
    assert by_normal == pytest.approx(difference, rel=1e-9)


@given(st.floats(0.0, 1e6), st.floats(-100.0, 100.0))
def test_regularised_friction_opposes_the_slip_within_static_friction(load, velocity):
    force = sliding(load, velocity)[0]
    assert force * velocity <= 0.0
    assert abs(force) <= 0.4 * load * (1.0 + 1e-15)


def test_friction_weakens_linearly_over_its_distance_and_stays_weak():
    assert laws.weakened_mu(0.4, 0.2, 1e-4, 0.0) == 0.4
    assert laws.weakened_mu(0.4, 0.2, 1e-4, 2.5e-5) == pytest.approx(0.35, rel=1e-14)
    assert laws.weakened_mu(0.4, 0.2, 1e-4, 1e-4) == 0.2
    assert laws.weakened_mu(0.4, 0.2, 1e-4, 1.0) == 0.2


def test_friction_falls_with_the_slip_velocity_from_static_to_kinetic():
    assert laws.stribeck_mu(0.4, 0.2, 0.3, 0.0) == 0.4
    assert laws.stribeck_mu(0.4, 0.2, 0.3, 0.3) == pytest.approx(0.2 + 0.2 / math.e, rel=1e-14)
    assert laws.stribeck_mu(0.4, 0.2, 0.3, -3.0) == pytest.approx(0.2, rel=1e-12)


def test_every_law_of_a_case_has_a_code_of_its_own_and_sticks_or_creeps():
    names = get_args(ContactTable.model_fields["friction"].annotation)
    assert set(laws.FRICTION_LAWS) == set(names)
    assert len(set(laws.FRICTION_LAWS.values())) == len(names)
    table = ContactTable(mu_static=0.4, mu_kinetic=0.4, damping_ratio=2.0)
    for name in names:
        assert table.model_copy(update={"friction": name}).sticks == (name == "elastic-stick")
