"""The planar block: its equations against Newton and Euler, its motions against rocking and sliding alone."""

import math

import numpy as np
import pytest
from floors import sine_floor, still_floor
from hypothesis import given
from hypothesis import strategies as st
from rigid_slider import RigidSlider, simulate_sliding

from contact.reference.floor_acceleration import Acceleration
from contact.reference.planar_block import (
    PlanarBlock,
    PlanarMode,
    centroidal_ratio,
    corner_impact,
    rock,
    simulate_planar_block,
    slide_rock,
)
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking

STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
BOX = RigidBlock.homogeneous(width=1.1, height=1.0)
ODD = RigidBlock(half_width=0.5, centroid_height=0.8, gravity=9.81, inertia_ratio=1.25)


def energy(block, side, state):
    """Kinetic energy relative to the floor plus potential energy above rest, per mass [J/kg]."""
    _, slip_velocity, tilt, tilt_rate = (float(value) for value in np.asarray(state))
    lean = block.slenderness_angle - tilt
    horizontal = slip_velocity + side * block.radius * math.cos(lean) * tilt_rate
    vertical = block.radius * math.sin(lean) * tilt_rate
    kinetic = 0.5 * (horizontal**2 + vertical**2 + tilt_rate**2 / centroidal_ratio(block))
    return kinetic + block.gravity * (block.radius * math.cos(lean) - block.centroid_height)


def test_with_friction_to_spare_it_is_the_rocking_block():
    floor = sine_floor(amplitude=0.1, angular_frequency=8.0)
    rough = PlanarBlock(body=STACK, mu_static=5.0, mu_kinetic=5.0)
    planar = simulate_planar_block(rough, floor, duration=8.0)
    rocking = simulate_rocking(STACK, floor, duration=8.0)
    times = np.linspace(0.0, 8.0, 201)
    assert planar.outcome is PlanarMode.ROCK
    assert len(planar.impacts) == len(rocking.impacts) > 10
    assert planar.at(times).rotation == pytest.approx(rocking.at(times)[0], abs=1e-10)
    assert planar.at(times).slip.tolist() == [0.0] * 201


def test_a_squat_block_is_the_slider():
    floor = sine_floor(amplitude=0.05, angular_frequency=10.0)
    planar = simulate_planar_block(PlanarBlock(body=BOX, mu_static=0.4, mu_kinetic=0.2), floor, duration=5.0)
    slider = simulate_sliding(RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=9.81), floor, duration=5.0)
    times = np.linspace(0.0, 5.0, 201)
    assert planar.outcome is PlanarMode.SLIDE
    assert planar.largest_rotation == 0.0
    assert planar.at(times).slip == pytest.approx(slider.at(times)[0], abs=1e-12)


def test_free_rocking_slides_at_the_impact_when_friction_is_below_the_need():
    # 0.2024 for the stack; the energy never grows, whatever slides.
    block = PlanarBlock(body=STACK, mu_static=0.2, mu_kinetic=0.2)
    motion = simulate_planar_block(block, still_floor(), duration=3.0, rotation=0.02)
    assert motion.impacts[0].slides
    assert motion.outcome is PlanarMode.SLIDE_ROCK
    levels = [
        energy(STACK, motion.states[piece.regime].side, piece.interpolant(t))
        for piece in motion.pieces
        for t in (piece.start, piece.end)
    ]
    # velocities are integrated to 1e-12 a step, energy to a few times that
    assert np.diff(levels).max() <= 1e-11 * levels[0]
    assert levels[-1] < 0.5 * levels[0]


def test_endless_impacts_end_in_rest_or_in_sliding():
    stack = PlanarBlock(body=STACK, mu_static=0.4, mu_kinetic=0.4)
    still = simulate_planar_block(stack, still_floor(), duration=20.0, rotation=0.1)
    assert still.states[-1].mode is PlanarMode.REST
    # pushed along on slippery ground, it stops rocking before it stops sliding
    slippery = PlanarBlock(body=BOX, mu_static=0.1, mu_kinetic=0.1)
    pushed = simulate_planar_block(slippery, still_floor(), duration=5.0, rotation=0.02, slip_velocity=2.0)
    names = [state.mode for state in pushed.states]
    assert names[-2:] == [PlanarMode.SLIDE, PlanarMode.REST]


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
@pytest.mark.parametrize("direction", [0, 1, -1])  # of sliding; 0: it rocks alone
@pytest.mark.parametrize(("tilt", "rate", "floor"), MOTIONS)
def test_rocking_and_sliding_obey_newton_euler_and_coulomb(block, side, direction, tilt, rate, floor):
    contact = rock(block, side, tilt, rate, floor)
    if direction:
        contact = slide_rock(block, side, tilt, rate, floor, mu_kinetic=0.35, direction=direction)
        assert contact.friction == pytest.approx(-direction * 0.35 * contact.normal, rel=1e-14)
    left = newton_euler_residual(block, side, tilt, rate, floor, contact)
    assert left == pytest.approx([0.0] * 3, abs=1e-5)


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
