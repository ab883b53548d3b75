"""A flat drop on springs and dashpots that do not pull, against its integration in time."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contact.reference.closed_forms_drop import damped_drop_restitution, drop_force


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.1, 0.2, 0.5, 0.999, 1.0, 1.001, 2.0])
def test_rebound_from_a_bed_that_does_not_pull(zeta):
    # x'' = -2 zeta x' - x, from x = 0 at unit speed, until the force k x + c v vanishes.
    def force(t, y):
        return y[0] + 2.0 * zeta * y[1]

    force.terminal, force.direction = True, -1.0
    solution = solve_ivp(
        lambda t, y: [y[1], -y[0] - 2.0 * zeta * y[1]],
        (0.0, 50.0),
        [0.0, 1.0],
        events=force,
        rtol=1e-11,
        atol=1e-13,
        method="DOP853",
        first_step=1e-6,
    )
    assert -solution.y_events[0][0][1] == pytest.approx(damped_drop_restitution(zeta), rel=1e-8)


@pytest.mark.parametrize(("zeta", "ratio"), [(0.05, 0.859), (0.1, 0.744), (0.2, 0.572), (0.5, 0.298)])
def test_rebound_of_the_reference(zeta, ratio):
    root = math.sqrt(1.0 - zeta**2)
    printed = math.exp(-zeta / root * (math.pi - math.atan2(2.0 * zeta * root, 1.0 - 2.0 * zeta**2)))
    assert damped_drop_restitution(zeta) == pytest.approx(printed, rel=1e-13)
    assert damped_drop_restitution(zeta) == pytest.approx(ratio, abs=5e-4)


def test_rebound_passes_smoothly_through_critical_damping():
    values = [damped_drop_restitution(1.0 + step) for step in (-2e-8, -5e-9, 5e-9, 2e-8)]
    assert values == pytest.approx([math.exp(-2.0)] * 4, rel=1e-7)


def test_largest_force_of_a_flat_drop():
    mass, stiffness, speed, gravity = 2500.0, 4e7, 0.3, 9.81
    solution = solve_ivp(
        lambda t, y: [y[1], gravity - stiffness / mass * y[0]],
        (0.0, 0.05),
        [0.0, speed],
        rtol=1e-11,
        atol=1e-13,
        dense_output=True,
    )
    largest = stiffness * solution.sol(np.linspace(0.0, 0.05, 100001))[0].max()
    assert largest == pytest.approx(
        drop_force(mass=mass, stiffness=stiffness, speed=speed, gravity=gravity), rel=1e-7
    )


def test_negative_damping_is_refused():
    with pytest.raises(ValueError, match="damping_ratio"):
        damped_drop_restitution(-0.1)
