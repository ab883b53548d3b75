"""Closed forms of the slider and the rocking block against the event-driven motion, and both against known numbers.

What a row of `verification` holds the program to is not repeated here.
"""

import math
from collections import Counter

import closed_forms as overturning
import numpy as np
import pytest
from closed_forms import first_swing_threshold, peak_after_impacts, quarter_period, steady_stroke
from floors import half_sine_pulse, one_sine_pulse, rectangular_pulse, sine_floor, still_floor
from rigid_slider import RigidSlider, simulate_sliding
from verification.overturning import initiation_grid

from contact.reference.planar_block import PlanarBlock, PlanarMode, simulate_planar_block
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking

GRAVITY = 9.81
STACK = RigidBlock.homogeneous(width=1.1, height=4.0)
NEEDLE = RigidBlock.homogeneous(width=1e-3, height=1.0)
ODD = RigidBlock(half_width=0.3, centroid_height=1.4, gravity=3.7, inertia_ratio=1.15)
PERIOD = 2.0 * math.pi / 10.0  #: of the sliders' floors [s]


def sustained(block, w):
    omega = w * block.frequency_parameter
    return lambda peak: sine_floor(amplitude=peak / omega**2, angular_frequency=omega)


def half(block, w):
    return lambda peak: half_sine_pulse(peak=-peak, duration=math.pi / (w * block.frequency_parameter))


def one(block, w):
    return lambda peak: one_sine_pulse(peak=-peak, duration=2.0 * math.pi / (w * block.frequency_parameter))


@pytest.mark.parametrize(
    ("block", "motion", "w", "exact", "within"),
    [
        (NEEDLE, sustained, 3.0, overturning.sustained_sine_threshold_slender(3.0), 1e-5),
        (NEEDLE, half, 0.5, overturning.half_sine_threshold_slender(0.5), 5e-6),
        (NEEDLE, one, 3.0, overturning.one_sine_threshold_slender(3.0), 1e-5),
        # by an independent integration; slender: 1.41421 and 6.08276
        (STACK, sustained, 1.0, 1.41347, 5e-6),
        pytest.param(STACK, sustained, 6.0, 6.21218, 5e-6, marks=pytest.mark.slow),
    ],
)
def test_acceleration_over_that_of_uplift_that_overturns_in_the_first_swing(block, motion, w, exact, within):
    unit = block.uplift_acceleration
    threshold = first_swing_threshold(
        block,
        motion(block, w),
        low=0.99 * exact * unit,  # it raises where one of these is on the other side
        high=1.01 * exact * unit,
        duration=60.0 / block.frequency_parameter,
        relative_tolerance=1e-7,
    )
    assert threshold / unit == pytest.approx(exact, abs=within)


def test_initiation_modes_on_a_grid():
    # Shenton (1996), with mu_k below mu_s; every mode occurs.
    seen = Counter()
    for lam, ratio, mu_static, mu_kinetic in initiation_grid():
        expected = overturning.initiation_mode(
            acceleration_ratio=ratio, slenderness=lam, mu_static=mu_static, mu_kinetic=mu_kinetic
        )
        body = RigidBlock.homogeneous(width=1.0, height=lam)
        block = PlanarBlock(body=body, mu_static=mu_static, mu_kinetic=mu_kinetic)
        for sign in (1.0, -1.0):
            floor = rectangular_pulse(peak=sign * ratio * GRAVITY, duration=0.1, delay=0.05)
            motion = simulate_planar_block(block, floor, duration=0.06)
            end = motion.at(np.array([0.06]))
            modes = (state.mode for state in motion.states)
            first = next((mode for mode in modes if mode is not PlanarMode.REST), PlanarMode.REST)
            assert first is expected, (lam, ratio, mu_static, mu_kinetic)
            slides = expected in (PlanarMode.SLIDE, PlanarMode.SLIDE_ROCK)
            rotates = expected in (PlanarMode.ROCK, PlanarMode.SLIDE_ROCK)
            assert (-sign * end.slip[0] > 0.0, -sign * end.rotation[0] > 0.0) == (slides, rotates)
        seen[expected] += 1
    assert seen.total() >= 75 and len(seen) == 4 and min(seen.values()) >= 4


def test_stack_with_finite_friction_at_0_1_m_and_8_rad_s():
    # Largest rotation 0.100303 rad (the second turning point; the first is 0.0355) and slip 81.1 mm at 2.5 s
    # (computed independently), mu 0.3 both.
    block = PlanarBlock(body=STACK, mu_static=0.3, mu_kinetic=0.3)
    motion = simulate_planar_block(block, sine_floor(amplitude=0.1, angular_frequency=8.0), duration=2.5)
    assert motion.largest_rotation == pytest.approx(0.100303, abs=5e-7)
    assert motion.at(np.array([2.5])).slip[0] == pytest.approx(81.1e-3, abs=5e-5)
    assert motion.outcome is PlanarMode.SLIDE_ROCK


@pytest.mark.parametrize(("restitution", "ratio"), [(0.85, 0.38), (None, 0.399), (0.96, 0.43)])
def test_stack_under_the_plateau_value_rocks_and_stands(restitution, ratio):
    # Largest rotation in 8 s 0.399 al, 0.38 to 0.43 for e 0.85 to 0.96 (computed, independent).
    plateau = sine_floor(amplitude=4.0 / 6.928**2, angular_frequency=6.928)
    motion = simulate_rocking(STACK, plateau, duration=8.0, restitution=restitution)
    tolerance = 5e-4 if restitution is None else 5e-3
    assert motion.largest_rotation / STACK.slenderness_angle == pytest.approx(ratio, abs=tolerance)
    assert motion.overturned_at is None


@pytest.mark.parametrize("block", [STACK, ODD])
def test_peaks_and_impact_times_of_free_rocking(block):
    start = 0.8 * block.slenderness_angle
    motion = simulate_rocking(block, still_floor(), duration=30.0, rotation=start)
    restitution, time, before = block.housner_restitution, 0.0, start
    for n in range(1, 13):
        expected = peak_after_impacts(block, start, n, restitution)
        assert abs(motion.peaks[n - 1].rotation) == pytest.approx(expected, rel=1e-9)
        time += quarter_period(block, start) if n == 1 else 2.0 * quarter_period(block, before)
        assert motion.impacts[n - 1].time == pytest.approx(time, rel=1e-10)
        before = expected


@pytest.mark.parametrize(
    ("kappa", "static_ratio"),
    [(0.2, 1.0), (0.35, 2.0), (0.45, 2.0), (0.7, 1.3), (0.9, 2.0)]
    + [pytest.param(0.05, ratio, marks=pytest.mark.slow) for ratio in (1.0, 2.0)],
)
def test_steady_strokes(kappa, static_ratio):
    stroke = steady_stroke(friction_ratio=kappa, static_ratio=static_ratio)
    cycles = 250 if kappa < 0.1 else 60  # without stops the start is forgotten slowly
    mu_kinetic = kappa * 0.1 * 10.0**2 / GRAVITY
    slider = RigidSlider(mu_static=static_ratio * mu_kinetic, mu_kinetic=mu_kinetic, gravity=GRAVITY)
    floor = sine_floor(amplitude=0.1, angular_frequency=10.0)
    motion = simulate_sliding(slider, floor, duration=cycles * PERIOD)
    steady = motion.peak_to_peak((cycles - 1) * PERIOD, cycles * PERIOD)
    assert steady / 0.1 == pytest.approx(stroke, abs=1e-8)
    assert (stroke == 0.0) is (kappa * static_ratio >= 1.0)


def test_seed_box_on_a_shaking_floor():
    # A = 0.05, Omega = 10, mu 0.4/0.2 (computed, independent): steady peak to peak 78.745 mm, largest in
    # all 79.144, +19.893 at 10 periods.
    body = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)
    floor = sine_floor(amplitude=0.05, angular_frequency=10.0)
    motion = simulate_sliding(body, floor, duration=40.0 * PERIOD)
    assert motion.peak_to_peak(39.0 * PERIOD, 40.0 * PERIOD) == pytest.approx(78.745e-3, abs=5e-7)
    assert motion.largest_slip == pytest.approx(79.144e-3, abs=5e-7)
    assert motion.at(np.array([10.0 * PERIOD]))[0][0] == pytest.approx(19.893e-3, abs=5e-7)
