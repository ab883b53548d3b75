"""Initiation and overturning in the first swing: closed forms against the event-driven motion."""

import math
from collections import Counter

import closed_forms_overturning
import numpy as np
import pytest
from first_swing import first_swing_threshold
from floors import half_sine_pulse, one_sine_pulse, rectangular_pulse, sine_floor, still_floor
from verification.overturning import initiation_grid

from contact.reference.floor_acceleration import Acceleration
from contact.reference.planar_block import PlanarBlock, PlanarMode, rock, simulate_planar_block
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking

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


@pytest.mark.parametrize("w", [0.5, 3.0])
@pytest.mark.parametrize(
    ("motion", "form"),
    [
        (sustained, closed_forms_overturning.sustained_sine_threshold_slender),
        (half, closed_forms_overturning.half_sine_threshold_slender),
        (one, closed_forms_overturning.one_sine_threshold_slender),
    ],
)
def test_slender_thresholds_are_those_of_a_needle(motion, form, w):
    ratio = form(w)
    threshold = first_swing_threshold(
        NEEDLE,
        motion(NEEDLE, w),
        low=0.999 * ratio * NEEDLE.uplift_acceleration,  # it raises where one of these is on the other side
        high=1.001 * ratio * NEEDLE.uplift_acceleration,
        duration=60.0 / NEEDLE.frequency_parameter,
        relative_tolerance=1e-7,
    )
    assert threshold / NEEDLE.uplift_acceleration == pytest.approx(ratio, rel=3e-6)


@pytest.mark.parametrize(("w", "exact"), [(1.0, 1.41347), pytest.param(6.0, 6.21218, marks=pytest.mark.slow)])
def test_exact_first_swing_thresholds_of_the_stack(w, exact):
    # A Omega^2/(g tan al) by an independent integration; slender: 1.41421 and 6.08276.
    unit = STACK.uplift_acceleration
    threshold = first_swing_threshold(
        STACK, sustained(STACK, w), low=1.3 * unit, high=7.0 * unit, duration=20.0, relative_tolerance=1e-7
    )
    assert threshold / unit == pytest.approx(exact, abs=5e-6)
    assert threshold / unit == pytest.approx(
        closed_forms_overturning.sustained_sine_threshold_slender(w), rel=0.025
    )


@pytest.mark.parametrize("block", [STACK, BOX])
@pytest.mark.parametrize("ratio", [1.001, 1.2, 2.0, 20.0])
def test_rectangular_pulse_of_just_the_critical_duration(block, ratio):
    peak = ratio * block.uplift_acceleration
    critical = closed_forms_overturning.rectangular_pulse_duration(block, peak)
    outcomes = [
        simulate_rocking(
            block,
            rectangular_pulse(peak=peak, duration=factor * critical),
            duration=60.0,
            stop_at_impact=True,
        ).outcome
        for factor in (1.0 - 1e-8, 1.0 + 1e-8)
    ]
    assert outcomes == [PlanarMode.ROCK, PlanarMode.OVERTURNED]


@pytest.mark.parametrize("block", [STACK, BOX])
def test_velocity_step_of_just_the_critical_size(block):
    critical = closed_forms_overturning.velocity_step_threshold(block)
    inertia = block.inertia_ratio * block.radius**2  # about the corner, per mass
    outcomes = [
        simulate_rocking(
            block,
            still_floor(),
            duration=60.0,
            angular_velocity=-factor * critical * block.centroid_height / inertia,
            stop_at_impact=True,
        ).outcome
        for factor in (1.0 - 1e-9, 1.0 + 1e-9)
    ]
    assert outcomes == [PlanarMode.ROCK, PlanarMode.OVERTURNED]


GRAVITY = 9.81


@pytest.mark.parametrize("slenderness", [0.8, 1.0, 1.5, 3.64, 8.0])
@pytest.mark.parametrize("surplus", [1.0, 1.2, 2.0, 5.0])
def test_friction_to_begin_rocking_is_that_of_the_equations_of_motion(slenderness, surplus):
    ratio = surplus / slenderness
    block = RigidBlock.homogeneous(width=1.0, height=slenderness)
    contact = rock(block, 1, 0.0, 0.0, Acceleration(-ratio * GRAVITY))
    assert abs(contact.friction) / contact.normal == pytest.approx(
        closed_forms_overturning.rocking_friction(ratio, slenderness), rel=1e-12
    )


MOVED = {
    PlanarMode.REST: (False, False),
    PlanarMode.SLIDE: (True, False),
    PlanarMode.ROCK: (False, True),
    PlanarMode.SLIDE_ROCK: (True, True),
}  #: slides, rotates


def test_initiation_modes_on_a_grid():
    # Shenton (1996), with mu_k below mu_s; every mode occurs.
    seen = Counter()
    for lam, ratio, mu_static, mu_kinetic in initiation_grid():
        expected = closed_forms_overturning.initiation_mode(
            acceleration_ratio=ratio, slenderness=lam, mu_static=mu_static, mu_kinetic=mu_kinetic
        )
        body = RigidBlock.homogeneous(width=1.0, height=lam)
        block = PlanarBlock(body=body, mu_static=mu_static, mu_kinetic=mu_kinetic)
        for sign in (1.0, -1.0):
            floor = rectangular_pulse(peak=sign * ratio * GRAVITY, duration=0.1, delay=0.05)
            motion = simulate_planar_block(block, floor, duration=0.06)
            end = motion.at(np.array([0.06]))
            modes = (transition.state.mode for transition in motion.transitions)
            first = next((mode for mode in modes if mode is not PlanarMode.REST), PlanarMode.REST)
            assert first is expected, (lam, ratio, mu_static, mu_kinetic)
            assert (-sign * end.slip[0] > 0.0, -sign * end.rotation[0] > 0.0) == MOVED[expected]
        seen[expected] += 1
    assert seen.total() >= 75
    assert min(seen[mode] for mode in MOVED) >= 4


def test_stack_with_finite_friction_at_0_1_m_and_8_rad_s():
    # Largest rotation 0.100303 rad (the second turning point; the first is 0.0355) and slip 81.1 mm at 2.5 s
    # (computed independently), mu 0.3 both.
    block = PlanarBlock(body=STACK, mu_static=0.3, mu_kinetic=0.3)
    motion = simulate_planar_block(block, sine_floor(amplitude=0.1, angular_frequency=8.0), duration=2.5)
    assert motion.largest_rotation == pytest.approx(0.100303, abs=5e-7)
    assert motion.at(np.linspace(0.0, 2.5, 100_001)).rotation.min() == pytest.approx(-0.100303, abs=5e-7)
    assert motion.at(np.array([2.5])).slip[0] == pytest.approx(81.1e-3, abs=5e-5)
    assert motion.outcome is PlanarMode.SLIDE_ROCK
