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


def stack(gravity=GRAVITY):
    return RigidBlock.homogeneous(width=1.1, height=4.0, gravity=gravity)


def planar(gravity=GRAVITY, mu=0.32):
    return PlanarBlock(body=stack(gravity), mu_static=mu, mu_kinetic=0.9 * mu)


def constant(acceleration):
    """A constant vertical acceleration, in addition to the horizontal one."""
    return SHAKING.with_vertical(FloorAcceleration(function=lambda t: acceleration, longest_step=math.inf))


@pytest.mark.parametrize("vertical", [-4.0, 3.0])
class TestAConstantVerticalAccelerationIsAnotherGravity:
    def test_of_the_rocking_block(self, vertical):
        heavier = simulate_rocking(stack(GRAVITY + vertical), SHAKING, duration=4.0)
        moved = simulate_rocking(stack(), constant(vertical), duration=4.0)
        assert len(moved.impacts) == len(heavier.impacts)
        assert moved.at(TIMES)[0] == pytest.approx(heavier.at(TIMES)[0], abs=1e-9, nan_ok=True)
        assert heavier.largest_rotation > 0.01

    def test_of_the_slider(self, vertical):
        heavier = simulate_sliding(
            RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY + vertical), SHAKING, duration=4.0
        )
        slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)
        moved = simulate_sliding(slider, constant(vertical), duration=4.0)
        assert moved.at(TIMES)[0] == pytest.approx(heavier.at(TIMES)[0], abs=1e-11)
        assert heavier.largest_slip > 0.01

    def test_of_the_block_that_slides_and_rocks(self, vertical):
        heavier = simulate_planar_block(planar(GRAVITY + vertical), SHAKING, duration=4.0)
        moved = simulate_planar_block(planar(), constant(vertical), duration=4.0)
        assert moved.outcome is heavier.outcome is PlanarMode.SLIDE_ROCK
        assert heavier.largest_rotation > 0.02
        assert moved.at(TIMES).rotation == pytest.approx(heavier.at(TIMES).rotation, abs=1e-8, nan_ok=True)
        assert moved.at(TIMES).slip == pytest.approx(heavier.at(TIMES).slip, abs=1e-8, nan_ok=True)


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
