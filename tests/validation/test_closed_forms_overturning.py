"""Overturning in the first swing: closed forms against bisection on the event-driven motion."""

import math

import numpy as np
import pytest

from contact.reference.closed_forms_overturning import (
    half_sine_threshold_slender,
    one_sine_threshold_slender,
    rectangular_pulse_duration,
    rectangular_pulse_duration_slender,
    sustained_sine_threshold_slender,
    velocity_step_threshold,
    velocity_step_threshold_slender,
)
from contact.reference.closed_forms_rocking import kick_angular_velocity
from contact.reference.floor_acceleration import (
    half_sine_pulse,
    one_sine_pulse,
    rectangular_pulse,
    sine_floor,
    still_floor,
)
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import RockingOutcome, first_swing_threshold, simulate_rocking

STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
BOX = RigidBlock.homogeneous(width=1.1, height=1.0)
NEEDLE = RigidBlock.homogeneous(width=1e-3, height=1.0)


def sustained(block, w):
    omega = w * block.frequency_parameter
    return lambda peak: sine_floor(amplitude=peak / omega**2, angular_frequency=omega)


def half(block, w):
    return lambda peak: half_sine_pulse(peak=-peak, duration=math.pi / (w * block.frequency_parameter))


def one(block, w):
    return lambda peak: one_sine_pulse(peak=-peak, duration=2.0 * math.pi / (w * block.frequency_parameter))


@pytest.mark.parametrize("w", [0.5, 1.0, 3.0, 6.0])
@pytest.mark.parametrize(
    ("motion", "form"),
    [
        (sustained, sustained_sine_threshold_slender),
        (half, half_sine_threshold_slender),
        (one, one_sine_threshold_slender),
    ],
)
def test_slender_thresholds_are_those_of_a_needle(motion, form, w):
    ratio = form(w)
    threshold = first_swing_threshold(
        NEEDLE,
        motion(NEEDLE, w),
        low=0.9 * ratio * NEEDLE.uplift_acceleration,
        high=1.2 * ratio * NEEDLE.uplift_acceleration,
        duration=60.0 / NEEDLE.frequency_parameter,
        relative_tolerance=1e-7,
    )
    assert threshold / NEEDLE.uplift_acceleration == pytest.approx(ratio, rel=3e-6)


@pytest.mark.parametrize(("w", "exact"), [(1.0, 1.41347), (6.0, 6.21218)])
def test_exact_first_swing_thresholds_of_the_stack(w, exact):
    # A Omega^2/(g tan al) by an independent integration; slender: 1.41421 and 6.08276.
    unit = STACK.uplift_acceleration
    threshold = first_swing_threshold(
        STACK, sustained(STACK, w), low=1.3 * unit, high=7.0 * unit, duration=20.0, relative_tolerance=1e-7
    )
    assert threshold / unit == pytest.approx(exact, abs=5e-6)
    assert threshold / unit == pytest.approx(sustained_sine_threshold_slender(w), rel=0.025)


def test_below_the_seed_papers_bound_on_the_amplitude_the_stack_overturns():
    # "A <= a/2 is conservative": at the seed's frequency A = 0.39 a/2 is enough to overturn.
    floor = sine_floor(amplitude=0.39 * 0.55, angular_frequency=6.928)
    assert simulate_rocking(STACK, floor, duration=20.0).outcome is RockingOutcome.OVERTURNED


@pytest.mark.parametrize("block", [STACK, BOX])
@pytest.mark.parametrize("ratio", [1.001, 1.2, 2.0, 20.0])
def test_rectangular_pulse_of_just_the_critical_duration(block, ratio):
    peak = ratio * block.uplift_acceleration
    critical = rectangular_pulse_duration(block, peak)
    outcomes = [
        simulate_rocking(
            block,
            rectangular_pulse(peak=peak, duration=factor * critical),
            duration=60.0,
            stop_at_impact=True,
        ).outcome
        for factor in (1.0 - 1e-8, 1.0 + 1e-8)
    ]
    assert outcomes == [RockingOutcome.ROCK, RockingOutcome.OVERTURNED]


@pytest.mark.parametrize("block", [STACK, BOX])
def test_velocity_step_of_just_the_critical_size(block):
    critical = velocity_step_threshold(block)
    outcomes = [
        simulate_rocking(
            block,
            still_floor(),
            duration=60.0,
            angular_velocity=kick_angular_velocity(block, factor * critical),
            stop_at_impact=True,
        ).outcome
        for factor in (1.0 - 1e-9, 1.0 + 1e-9)
    ]
    assert outcomes == [RockingOutcome.ROCK, RockingOutcome.OVERTURNED]


def test_velocity_step_is_the_limit_of_short_pulses():
    peak = 1e5 * STACK.uplift_acceleration
    velocity = peak * rectangular_pulse_duration(STACK, peak)
    assert velocity == pytest.approx(velocity_step_threshold(STACK), rel=1e-4)


def test_slender_pulse_forms_are_the_limit_of_the_exact_ones():
    errors = []
    for width in (0.2, 0.1, 0.05):
        block = RigidBlock.homogeneous(width=width, height=1.0)
        peak = 2.0 * block.gravity * block.slenderness_angle
        durations = rectangular_pulse_duration_slender(block, peak) / rectangular_pulse_duration(block, peak)
        steps = velocity_step_threshold_slender(block) / velocity_step_threshold(block)
        errors.append([abs(durations - 1.0), abs(steps - 1.0)])
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders == pytest.approx(np.full((2, 2), 2.0), abs=0.05)


@pytest.mark.parametrize("ratio", [1.05, 2.0, 7.0])
def test_rectangular_pulse_is_housners_formula(ratio):
    # Housner (1963): cosh(p t) = 1 + 1/(2 k (k - 1)), k = a/(g al)
    peak = ratio * STACK.gravity * STACK.slenderness_angle
    duration = rectangular_pulse_duration_slender(STACK, peak)
    expected = 1.0 + 1.0 / (2.0 * ratio * (ratio - 1.0))
    assert math.cosh(STACK.frequency_parameter * duration) == pytest.approx(expected, rel=1e-12)


def test_pulses_need_more_than_the_sine_that_goes_on_or_less_as_they_end():
    # the half-sine spares the block the reversal, the one-sine ends after it
    for w in (1.0, 3.0, 6.0):
        assert half_sine_threshold_slender(w) < sustained_sine_threshold_slender(w)
        assert one_sine_threshold_slender(w) > sustained_sine_threshold_slender(w)


def test_pulses_that_do_not_lift_the_block_are_refused():
    with pytest.raises(ValueError, match="does not lift"):
        rectangular_pulse_duration(STACK, 2.6)
    with pytest.raises(ValueError, match="does not lift"):
        rectangular_pulse_duration_slender(STACK, 2.6)
    with pytest.raises(ValueError, match="frequency_ratio"):
        half_sine_threshold_slender(0.0)
