"""The references on a floor that moves up and down: gravity in its frame is g + a_v."""

import math

import numpy as np
import pytest
from floors import half_sine_pulse, rectangular_pulse, sine_floor, still_floor
from rigid_slider import RigidSlider, simulate_sliding

from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.planar_block import PlanarBlock, PlanarMode, simulate_planar_block
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking

GRAVITY = 9.81
TIMES = np.linspace(0.0, 4.0, 201)
SHAKING = sine_floor(amplitude=0.1, angular_frequency=8.0)


def stack(gravity):
    return RigidBlock.homogeneous(width=1.1, height=4.0, gravity=gravity)


def rocked(gravity, floor):
    return np.asarray(simulate_rocking(stack(gravity), floor, duration=4.0).at(TIMES)[0])


def slid(gravity, floor):
    slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=gravity)
    return simulate_sliding(slider, floor, duration=4.0).at(TIMES)[0]


def rocked_and_slid(gravity, floor):
    block = PlanarBlock(body=stack(gravity), mu_static=0.32, mu_kinetic=0.288)
    motion = simulate_planar_block(block, floor, duration=4.0)
    assert motion.outcome is PlanarMode.SLIDE_ROCK
    return np.stack([motion.at(TIMES).rotation, motion.at(TIMES).slip])


@pytest.mark.parametrize("vertical", [-4.0, 3.0])
@pytest.mark.parametrize(("moves", "within"), [(rocked, 1e-9), (slid, 1e-11), (rocked_and_slid, 1e-8)])
def test_a_constant_vertical_acceleration_is_another_gravity(moves, within, vertical):
    lifted = SHAKING.with_vertical(FloorAcceleration(function=lambda t: vertical, longest_step=math.inf))
    heavier = moves(GRAVITY + vertical, SHAKING)
    assert moves(GRAVITY, lifted) == pytest.approx(heavier, abs=within, nan_ok=True)
    assert np.nanmax(np.abs(heavier)) > 0.01


def test_a_slider_loses_what_friction_takes_of_a_changing_weight():
    # v' = -mu (g + a_v): with one sine pulse upward the velocity falls by mu (g T + 2 peak L/pi).
    floor = still_floor().with_vertical(half_sine_pulse(peak=5.0, duration=0.3, delay=0.1))
    slider = RigidSlider(mu_static=0.25, mu_kinetic=0.25, gravity=GRAVITY)
    motion = simulate_sliding(slider, floor, duration=0.5, slip_velocity=3.0)
    velocity = float(motion.at(np.array([0.5]))[1][0])
    assert velocity == pytest.approx(3.0 - 0.25 * (GRAVITY * 0.5 + 5.0 * 0.6 / math.pi), rel=1e-11)


@pytest.mark.parametrize("push", [0.0, 1.0])
@pytest.mark.parametrize("slip_velocity", [0.0, 0.5])
def test_a_floor_that_falls_faster_than_the_block_leaves_it(push, slip_velocity):
    fall = rectangular_pulse(peak=-1.01 * GRAVITY, duration=1.0, delay=0.1)
    floor = rectangular_pulse(peak=push, duration=2.0).with_vertical(fall)
    block = PlanarBlock(body=RigidBlock.homogeneous(width=1.1, height=1.0), mu_static=0.4, mu_kinetic=0.4)
    motion = simulate_planar_block(block, floor, duration=1.0, slip_velocity=slip_velocity)
    assert motion.outcome is PlanarMode.OUTSIDE
    assert motion.end == pytest.approx(0.1, abs=1e-12)
    slider = RigidSlider(mu_static=0.4, mu_kinetic=0.4, gravity=GRAVITY)
    assert simulate_sliding(slider, floor, duration=1.0, slip_velocity=slip_velocity).end == motion.end
    rocking = simulate_rocking(block.body, floor, duration=1.0)
    assert rocking.outcome is PlanarMode.OUTSIDE
    assert rocking.end == motion.end
