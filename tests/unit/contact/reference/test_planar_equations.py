"""The equations of the planar block against Newton and Euler written down a second time."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact.reference.floor_acceleration import Acceleration
from contact.reference.planar_equations import corner_impact, energy, rock, slide_rock
from contact.reference.rigid_block import RigidBlock

STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
ODD = RigidBlock(half_width=0.5, centroid_height=0.8, gravity=9.81, inertia_ratio=1.25)


#: tilt, its rate, and the floor's acceleration along x and upward
MOTIONS = [
    (0.0, 0.0, Acceleration(4.0)),
    (0.1, 0.6, Acceleration(-3.0, 2.5)),
    (0.7, -1.1, Acceleration(2.0, -4.0)),
]


def centroid(block, side, slip, tilt):
    """Position of the centroid and rotation of a block whose corner has slipped, from plain geometry."""
    corner = np.array([slip + side * block.half_width, 0.0])
    upright = np.array([-side * block.half_width, block.centroid_height])
    turn = side * tilt  # clockwise
    rotation = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    return corner + rotation @ upright


def newton_euler_residual(block, side, tilt, rate, floor, contact):
    """Forces and moment that are left over; the centroid's acceleration by differences of its path."""
    h = 1e-4

    def place(t):
        slip = 0.5 * contact.slip_acceleration * t * t
        return centroid(block, side, slip, tilt + rate * t + 0.5 * contact.tilt_acceleration * t * t)

    acceleration = (place(h) - 2.0 * place(0.0) + place(-h)) / h**2
    corner = np.array([side * block.half_width, 0.0]) - place(0.0)
    force = np.array([contact.friction, contact.normal])
    clockwise = corner[1] * force[0] - corner[0] * force[1]
    inertia = (block.inertia_ratio - 1.0) * block.radius**2
    return [
        acceleration[0] + floor.x - force[0],
        acceleration[1] + block.gravity + floor.z - force[1],
        inertia * side * contact.tilt_acceleration - clockwise,
    ]


@pytest.mark.parametrize("block", [STACK, ODD])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("tilt", "rate", "floor"), MOTIONS)
def test_rocking_obeys_newton_and_euler(block, side, tilt, rate, floor):
    contact = rock(block, side, tilt, rate, floor)
    assert newton_euler_residual(block, side, tilt, rate, floor, contact) == pytest.approx(
        [0.0] * 3, abs=1e-5
    )


@pytest.mark.parametrize("block", [STACK, ODD])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(("tilt", "rate", "floor"), MOTIONS)
def test_slide_rocking_obeys_newton_euler_and_coulomb(block, side, direction, tilt, rate, floor):
    contact = slide_rock(block, side, tilt, rate, floor, mu_kinetic=0.35, direction=direction)
    assert newton_euler_residual(block, side, tilt, rate, floor, contact) == pytest.approx(
        [0.0] * 3, abs=1e-5
    )
    assert contact.friction == pytest.approx(-direction * 0.35 * contact.normal, rel=1e-14)


def test_slide_rocking_with_the_friction_that_rocking_needs_does_not_slide():
    needed = rock(STACK, 1, 0.05, 0.2, Acceleration(-3.0))
    mu = abs(needed.friction) / needed.normal
    direction = -int(math.copysign(1.0, needed.friction))
    sliding = slide_rock(STACK, 1, 0.05, 0.2, Acceleration(-3.0), mu_kinetic=mu, direction=direction)
    assert sliding.slip_acceleration == pytest.approx(0.0, abs=1e-13)
    assert sliding.tilt_acceleration == pytest.approx(needed.tilt_acceleration, rel=1e-13)


def test_painleve_is_reported_and_begins_at_four_thirds():
    # homogeneous: 1 + 3 sin^2 - 3 mu sin cos vanishes first at tan(lean) = 1/2, mu = 4/3.
    block = RigidBlock.homogeneous(width=1.0, height=2.0)
    below = slide_rock(block, 1, 0.0, 0.0, Acceleration(-20.0), mu_kinetic=1.33, direction=1)
    above = slide_rock(block, 1, 0.0, 0.0, Acceleration(-20.0), mu_kinetic=1.34, direction=1)
    assert below.normal > 0.0
    assert math.isnan(above.normal)


@pytest.mark.parametrize("side", [1, -1])
def test_an_impact_with_enough_friction_is_housners(side):
    impact = corner_impact(STACK, side, 0.0, -0.7, mu_static=0.21, mu_kinetic=0.0)
    assert impact is not None
    assert not impact.slides
    assert impact.tilt_rate == pytest.approx(0.7 * STACK.housner_restitution, rel=1e-13)


@given(
    half_width=st.floats(0.05, 3.0),
    inertia_ratio=st.floats(1.05, 1.9),
    side=st.sampled_from([1, -1]),
    slip_velocity=st.one_of(st.just(0.0), st.floats(-2.0, 2.0)),
    mu_static=st.floats(0.0, 1.2),
    share=st.floats(0.0, 1.0),
)
def test_no_impact_gains_energy_or_pulls(half_width, inertia_ratio, side, slip_velocity, mu_static, share):
    block = RigidBlock(half_width=half_width, centroid_height=1.0, gravity=9.81, inertia_ratio=inertia_ratio)
    mu_kinetic = share * mu_static
    impact = corner_impact(block, side, slip_velocity, -0.8, mu_static=mu_static, mu_kinetic=mu_kinetic)
    if impact is None:
        return
    before = energy(block, side, np.array([0.0, slip_velocity, 0.0, -0.8]))
    after = energy(block, -side, np.array([0.0, impact.slip_velocity, 0.0, impact.tilt_rate]))
    assert after <= before * (1.0 + 1e-12)
    assert impact.normal_impulse > 0.0
    assert impact.tilt_rate >= 0.0
    limit = max(mu_static, mu_kinetic) * impact.normal_impulse
    assert abs(impact.friction_impulse) <= limit * (1.0 + 1e-12) + 1e-15
    if impact.slides:  # friction opposes the sliding it leaves
        assert impact.friction_impulse * impact.slip_velocity <= 0.0


@given(half_width=st.floats(0.05, 0.65), slip_velocity=st.floats(-1.0, 1.0), mu=st.floats(0.0, 1.2))
def test_an_impact_balances_momentum(half_width, slip_velocity, mu):
    block = RigidBlock(half_width=half_width, centroid_height=1.0, gravity=9.81)
    impact = corner_impact(block, 1, slip_velocity, -0.8, mu_static=mu, mu_kinetic=mu)
    assert impact is not None
    if impact.tilt_rate == 0.0:  # both corners took part: the point of action is between them
        return
    horizontal = slip_velocity - 0.8, impact.slip_velocity - impact.tilt_rate
    vertical = -half_width * 0.8, half_width * impact.tilt_rate
    spin = -0.8, -impact.tilt_rate
    inertia = block.radius**2 / 3.0
    assert horizontal[1] - horizontal[0] == pytest.approx(impact.friction_impulse, abs=1e-12)
    assert vertical[1] - vertical[0] == pytest.approx(impact.normal_impulse, abs=1e-12)
    # new corner at (-B, -1) from the centroid, clockwise moment rz px - rx pz
    moment = -1.0 * impact.friction_impulse + half_width * impact.normal_impulse
    assert inertia * (spin[1] - spin[0]) == pytest.approx(moment, abs=1e-12)


def test_a_block_that_slides_into_an_impact_has_the_kinetic_coefficient():
    # The impact needs 0.2024: within mu_static for a corner at rest, beyond mu_kinetic for one that slides.
    for slip_velocity, slides in ((0.0, False), (1e-9, True), (-1e-9, True)):
        impact = corner_impact(STACK, 1, slip_velocity, -0.7, mu_static=0.25, mu_kinetic=0.15)
        assert impact is not None
        assert impact.slides is slides
