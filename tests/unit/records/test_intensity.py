"""Measures of a motion against closed forms and another program."""

import math

import eqsig
import numpy as np
import pytest

from fem.records.intensity import intensity


def test_a_whole_sine():
    # a = sin(w t) over one period: v = (1 - cos w t)/w up to 2/w, x = T/w at its end; Arias: pi/(2 g) T/2.
    times = np.linspace(0.0, 2.0, 4001)
    found = intensity(times, np.sin(math.pi * times))
    assert found.peak_acceleration_m_s2 == pytest.approx(1.0)
    assert found.peak_velocity_m_s == pytest.approx(2.0 / math.pi, rel=1e-5)
    assert found.peak_displacement_m == pytest.approx(2.0 / math.pi, rel=1e-5)
    assert found.arias_m_s == pytest.approx(math.pi / (2.0 * 9.80665), rel=1e-5)


def test_a_constant_acceleration_is_significant_for_nine_tenths_of_its_time():
    found = intensity(np.array([3.0, 4.0, 13.0]), np.full(3, 2.0))
    assert found.significant_s == pytest.approx(9.0)
    assert found.arias_m_s == pytest.approx(math.pi / (2.0 * 9.80665) * 40.0)


def test_the_velocity_peaks_between_samples():
    # From 1 to -1 m/s2 over 1 s: the velocity peaks at 0.25 m/s in the middle, and is zero at both ends.
    found = intensity(np.array([0.0, 1.0]), np.array([1.0, -1.0]))
    assert found.peak_velocity_m_s == pytest.approx(0.25)


def test_no_motion_has_no_intensity():
    found = intensity(np.array([0.0, 1.0]), np.zeros(2))
    assert (found.arias_m_s, found.significant_s, found.peak_velocity_m_s) == (0.0, 0.0, 0.0)


def test_another_program_agrees():
    step, values = 0.01, np.random.default_rng(2).standard_normal(3001).cumsum() * 0.01
    values *= np.sin(np.linspace(0.0, math.pi, 3001))
    found = intensity(step * np.arange(3001), values)
    signal = eqsig.AccSignal(values, step)
    assert found.peak_velocity_m_s == pytest.approx(signal.pgv, rel=1e-3)
    assert found.peak_displacement_m == pytest.approx(signal.pgd, rel=1e-3)
    assert found.arias_m_s == pytest.approx(eqsig.im.calc_arias_intensity(signal)[-1], rel=1e-3)
    assert found.significant_s == pytest.approx(eqsig.im.calc_sig_dur(signal), abs=0.03)
