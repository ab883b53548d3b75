import math

import numpy as np
import pytest
from floors import half_sine_pulse, rectangular_pulse, sine_floor, still_floor

from contact.reference.planar_block import PlanarMode
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking

STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
ANGLE = STACK.slenderness_angle


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
    motion = simulate_rocking(
        STACK, rectangular_pulse(peak=-peak, duration=9.0), duration=3.0, rotation=-0.1, restitution=0.0
    )
    assert motion.impacts[0].velocity_after == 0.0
    assert motion.uplifts[0] == motion.impacts[0].time
    assert motion.at(np.array([motion.uplifts[0] + 0.1]))[0][0] > 0.0


def test_uplift_that_lasts_an_instant_is_not_missed():
    frequency = 6.928
    amplitude = (1.0 + 1e-7) * STACK.uplift_acceleration / frequency**2
    motion = simulate_rocking(
        STACK, sine_floor(amplitude=amplitude, angular_frequency=frequency), duration=1.0
    )
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
