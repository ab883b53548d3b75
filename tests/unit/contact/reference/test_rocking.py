"""Rigid blocks alone: constants, rocking, sliding, and a floor that moves up and down, where gravity is g + a_v."""

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
STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
ANGLE = STACK.slenderness_angle
HALF = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)
TIMES = np.linspace(0.0, 4.0, 201)
SHAKING = sine_floor(amplitude=0.1, angular_frequency=8.0)


def test_seed_paper_box_and_stack():
    # p = sqrt(3g/(4R)), e = 1 - 1.5 sin^2 al with g = 9.81 for 1.1 x 1.0 m and four of them stacked.
    box = RigidBlock.homogeneous(width=1.1, height=1.0)
    assert box.frequency_parameter == pytest.approx(3.14617, abs=5e-6)
    assert STACK.frequency_parameter == pytest.approx(1.88337, abs=5e-6)
    assert box.housner_restitution == pytest.approx(0.17873, abs=5e-6)
    assert STACK.housner_restitution == pytest.approx(0.89454, abs=5e-6)
    assert STACK.uplift_acceleration == pytest.approx(9.81 * 1.1 / 4.0, rel=1e-14)


def test_restitution_keeps_angular_momentum_about_the_new_corner():
    # I_O w+ = (I_G + M (H^2 - B^2)) w-: moment of momentum of a body that turned about the old corner.
    block = RigidBlock(half_width=0.4, centroid_height=1.1, gravity=9.81, inertia_ratio=1.6)
    inertia = 1.6 * block.radius**2
    central = inertia - block.radius**2
    assert block.housner_restitution == pytest.approx((central + 1.1**2 - 0.4**2) / inertia, rel=1e-14)


def test_overturning_energy_keeps_its_digits_for_a_needle():
    block = RigidBlock(half_width=1e-6, centroid_height=1.0, gravity=10.0)
    assert block.overturning_energy == pytest.approx(10.0 * 0.5e-12, rel=1e-10)


def test_endless_impacts_end_in_rest_at_the_sum_of_their_times():
    # slender: quarter periods fall like e^n, so that the impacts accumulate at a finite time.
    motion = simulate_rocking(STACK, still_floor(), duration=30.0, rotation=0.5 * ANGLE)
    last = motion.impacts[-1]
    assert motion.outcome is PlanarMode.ROCK
    assert last.velocity_after == 0.0
    assert motion.end == 30.0
    rotation, velocity = motion.at(np.array([last.time, 30.0]))
    assert rotation.tolist() == velocity.tolist() == [0.0, 0.0]
    finer = simulate_rocking(STACK, still_floor(), duration=30.0, rotation=0.5 * ANGLE, rest_energy=1e-14)
    assert finer.impacts[-1].time == pytest.approx(last.time, abs=1e-4)
    assert len(finer.impacts) > len(motion.impacts)


def test_a_block_that_came_to_rest_is_lifted_again():
    floor = half_sine_pulse(peak=4.0, duration=0.3, delay=15.0)
    motion = simulate_rocking(STACK, floor, duration=16.0, rotation=0.5 * ANGLE)
    quiet = motion.at(np.array([14.9]))[0][0]
    lift = 15.0 + 0.3 / math.pi * math.asin(STACK.uplift_acceleration / 4.0)
    assert quiet == 0.0
    assert motion.uplifts == pytest.approx([lift], abs=1e-12)


def test_no_rest_while_the_floor_keeps_the_block_tilted():
    # 1.2 g tan al holds on: after every impact the block is lifted anew, toward the same side.
    peak = 1.2 * STACK.uplift_acceleration
    floor = rectangular_pulse(peak=-peak, duration=9.0)
    motion = simulate_rocking(STACK, floor, duration=3.0, rotation=-0.1, restitution=0.0)
    assert motion.impacts[0].velocity_after == 0.0
    assert motion.uplifts[0] == motion.impacts[0].time
    assert motion.at(np.array([motion.uplifts[0] + 0.1]))[0][0] > 0.0


def test_uplift_that_lasts_an_instant_is_not_missed():
    frequency = 6.928
    amplitude = (1.0 + 1e-7) * STACK.uplift_acceleration / frequency**2
    floor = sine_floor(amplitude=amplitude, angular_frequency=frequency)
    motion = simulate_rocking(STACK, floor, duration=1.0)
    first = math.asin(1.0 / (1.0 + 1e-7)) / frequency
    assert motion.uplifts[0] == pytest.approx(first, abs=1e-9)
    assert motion.outcome is PlanarMode.ROCK


def test_squat_block_lies_down_at_its_first_impact():
    # 1.5 sin^2 al > 1: Housner's restitution is negative, the block cannot rock on.
    squat = RigidBlock.homogeneous(width=2.0, height=1.0)
    motion = simulate_rocking(squat, still_floor(), duration=2.0, rotation=0.2)
    assert squat.housner_restitution < 0.0
    assert motion.restitution == 0.0
    assert len(motion.impacts) == 1


def test_a_push_stops_after_the_distance_that_friction_allows():
    motion = simulate_sliding(HALF, still_floor(), duration=2.0, slip_velocity=1.5)
    assert motion.largest_slip == pytest.approx(1.5**2 / (2.0 * 0.2 * GRAVITY), rel=1e-12)
    assert motion.intervals[0].end == pytest.approx(1.5 / (0.2 * GRAVITY), rel=1e-12)
    assert [interval.direction for interval in motion.intervals] == [1, 0]


def test_sticking_holds_between_kinetic_and_static_limit_but_sliding_goes_on_there():
    # 0.3 g lies between mu_k g and mu_s g: at rest it sticks, pushed the same way it accelerates.
    floor = rectangular_pulse(peak=-0.3 * GRAVITY, duration=5.0)
    assert simulate_sliding(HALF, floor, duration=5.0).largest_slip == 0.0
    pushed = simulate_sliding(HALF, floor, duration=1.0, slip_velocity=0.1)
    assert pushed.at(np.array([1.0]))[1][0] == pytest.approx(0.1 + 0.1 * GRAVITY, rel=1e-12)


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
