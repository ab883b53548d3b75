"""The rigid slider: closed forms against the event-driven integration, and both against known numbers."""

import math

import numpy as np
import pytest
from closed_forms_sliding import never_stops_ratio, pulse_slip, steady_stroke
from floors import rectangular_pulse, sine_floor
from rigid_slider import RigidSlider, simulate_sliding

GRAVITY = 9.81
AMPLITUDE, FREQUENCY = 0.1, 10.0
PERIOD = 2.0 * math.pi / FREQUENCY
FLOOR = sine_floor(amplitude=AMPLITUDE, angular_frequency=FREQUENCY)


def slider(kappa, static_ratio):
    mu_kinetic = kappa * AMPLITUDE * FREQUENCY**2 / GRAVITY
    return RigidSlider(mu_static=static_ratio * mu_kinetic, mu_kinetic=mu_kinetic, gravity=GRAVITY)


@pytest.mark.parametrize(("static_ratio", "limit"), [(1.0, 0.53703), (2.0, 0.39322)])
def test_limit_of_sliding_without_stops(static_ratio, limit):
    assert never_stops_ratio(static_ratio) == pytest.approx(limit, abs=5e-6)
    for factor, stops in ((0.99, False), (1.01, True)):
        motion = simulate_sliding(slider(factor * limit, static_ratio), FLOOR, duration=50.0 * PERIOD)
        late = [i for i in motion.intervals if i.start > 40.0 * PERIOD]
        assert any(interval.direction == 0 for interval in late) is stops


@pytest.mark.parametrize(
    ("kappa", "static_ratio"),
    [(0.2, 1.0), (0.35, 2.0), (0.45, 2.0), (0.7, 1.3), (0.9, 2.0)]
    + [pytest.param(0.05, ratio, marks=pytest.mark.slow) for ratio in (1.0, 1.3, 2.0)],
)
def test_steady_strokes(kappa, static_ratio):
    stroke = steady_stroke(friction_ratio=kappa, static_ratio=static_ratio)
    cycles = 250 if kappa < 0.1 else 60  # without stops the start is forgotten slowly
    motion = simulate_sliding(slider(kappa, static_ratio), FLOOR, duration=cycles * PERIOD)
    steady = motion.peak_to_peak((cycles - 1) * PERIOD, cycles * PERIOD)
    assert steady / AMPLITUDE == pytest.approx(stroke, abs=1e-8)
    assert (stroke == 0.0) is (kappa * static_ratio >= 1.0)


def test_seed_box_on_a_shaking_floor():
    # A = 0.05, Omega = 10, mu 0.4/0.2 (computed, independent): steady peak to peak 78.745 mm, largest in
    # all 79.144, +19.893 at 10 periods.
    body = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=GRAVITY)
    floor = sine_floor(amplitude=0.05, angular_frequency=10.0)
    motion = simulate_sliding(body, floor, duration=40.0 * PERIOD)
    assert motion.peak_to_peak(39.0 * PERIOD, 40.0 * PERIOD) == pytest.approx(78.745e-3, abs=5e-7)
    assert motion.largest_slip == pytest.approx(79.144e-3, abs=5e-7)
    assert motion.peak_to_peak(0.0, 40.0 * PERIOD) == pytest.approx(79.144e-3, abs=5e-7)
    assert motion.at(np.array([10.0 * PERIOD]))[0][0] == pytest.approx(19.893e-3, abs=5e-7)


@pytest.mark.parametrize("peak", [3.0, 8.0, -8.0])
@pytest.mark.parametrize("mu_kinetic", [0.2, 0.4])
def test_rectangular_pulse_one_way(peak, mu_kinetic):
    expected = pulse_slip(peak=peak, duration=0.3, mu_static=0.4, mu_kinetic=mu_kinetic, gravity=GRAVITY)
    body = RigidSlider(mu_static=0.4, mu_kinetic=mu_kinetic, gravity=GRAVITY)
    motion = simulate_sliding(body, rectangular_pulse(peak=peak, duration=0.3), duration=5.0)
    assert motion.residual_slip == pytest.approx(expected, rel=1e-11)
    if peak == 8.0:  # V^2/(2 mu g) (1 - mu g/a0)
        limit = mu_kinetic * GRAVITY
        assert expected == pytest.approx(-(2.4**2) / (2.0 * limit) * (1.0 - limit / 8.0), rel=1e-14)
    if peak == 3.0:
        assert expected == 0.0
