import math

import numpy as np
import pytest
from first_swing import first_swing_threshold
from floors import half_sine_pulse, rectangular_pulse, sine_floor, still_floor

from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import RockingOutcome, simulate_rocking

STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
ANGLE = STACK.slenderness_angle


def test_endless_impacts_end_in_rest_at_the_sum_of_their_times():
    # slender: quarter periods fall like e^n, so that the impacts accumulate at a finite time.
    motion = simulate_rocking(STACK, still_floor(), duration=30.0, rotation=0.5 * ANGLE)
    last = motion.impacts[-1]
    assert motion.outcome is RockingOutcome.ROCK
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
    assert motion.outcome is RockingOutcome.ROCK


def test_a_start_beyond_the_balance_point_falls_to_ninety_degrees():
    motion = simulate_rocking(STACK, still_floor(), duration=20.0, rotation=-1.01 * ANGLE)
    assert motion.outcome is RockingOutcome.OVERTURNED
    assert motion.overturned_at == motion.end < 20.0
    assert motion.largest_rotation == pytest.approx(0.5 * math.pi, abs=1e-12)
    assert motion.at(np.array([motion.end]))[0][0] == pytest.approx(-0.5 * math.pi, abs=1e-12)
    assert np.isnan(motion.at(np.array([motion.end + 0.1]))[0][0])


def test_a_block_beyond_its_balance_point_can_be_brought_back():
    # At 1.05 al the moving floor catches it: being beyond the slenderness angle is not overturning.
    pull = rectangular_pulse(peak=1.0, duration=0.3)
    motion = simulate_rocking(STACK, pull, duration=5.0, rotation=1.05 * ANGLE)
    assert motion.outcome is RockingOutcome.ROCK
    assert motion.impacts


def test_squat_block_lies_down_at_its_first_impact():
    # 1.5 sin^2 al > 1: Housner's restitution is negative, the block cannot rock on.
    squat = RigidBlock.homogeneous(width=2.0, height=1.0)
    motion = simulate_rocking(squat, still_floor(), duration=2.0, rotation=0.2)
    assert squat.housner_restitution < 0.0
    assert motion.restitution == 0.0
    assert len(motion.impacts) == 1


def test_nonsense_is_refused():
    with pytest.raises(ValueError, match="restitution"):
        simulate_rocking(STACK, still_floor(), duration=1.0, restitution=1.1)
    with pytest.raises(ValueError, match="90 degrees"):
        simulate_rocking(STACK, still_floor(), duration=1.0, rotation=1.6)
    with pytest.raises(ValueError, match="duration"):
        simulate_rocking(STACK, still_floor(), duration=0.0)
    with pytest.raises(ValueError, match="no change"):
        first_swing_threshold(
            STACK, lambda peak: rectangular_pulse(peak=peak, duration=1.0), low=3.0, high=3.1, duration=20.0
        )
