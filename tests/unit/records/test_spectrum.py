"""Response spectra and measures of a motion: exact for straight lines between samples, whatever the step."""

import math

import eqsig
import numpy as np
import pyrotd
import pytest

from fem.records.intensity import intensity
from fem.records.spectrum import log_spaced_periods, oscillator_response, response_spectrum

PERIODS = np.array([0.04, 0.1, 0.37, 1.0, 3.0])


def noise(count: int = 2001, seed: int = 1) -> np.ndarray:
    """Samples of one random motion, with an envelope [m/s2]."""
    samples = np.random.default_rng(seed).standard_normal(count)
    return np.convolve(samples, np.ones(5) / 5.0, "same") * np.sin(np.linspace(0.0, math.pi, count))


@pytest.mark.parametrize("damping_ratio", [0.0, 0.05, 0.10])
@pytest.mark.parametrize("step", [0.005, 0.02])
def test_a_step_doubles_less_what_damping_takes(step, damping_ratio):
    # codes.md 3.2: a0 (1 + exp(-z pi/sqrt(1 - z^2))) at every period: 1.854468 a0 at 5 %, 1.729248 a0 at 10 %.
    found = response_spectrum(step, np.full(2001, 2.0), PERIODS, damping_ratio)
    exact = 1.0 + math.exp(-damping_ratio * math.pi / math.sqrt(1.0 - damping_ratio**2))
    assert found == pytest.approx(2.0 * exact, rel=5e-5)
    if damping_ratio == 0.05:
        assert exact == pytest.approx(1.854468, abs=5e-7)


def test_a_sine_ends_in_its_steady_state():
    # Displacement of the steady state: a/w^2 / sqrt((1 - r^2)^2 + (2 z r)^2), r the ratio of frequencies.
    step, drive, period, damping_ratio = 0.002, 0.8, 0.5, 0.05
    times = np.arange(0.0, 60.0, step)
    found = oscillator_response(step, np.sin(2.0 * math.pi / drive * times), period, damping_ratio)
    ratio, rate = period / drive, 2.0 * math.pi / period
    size = 1.0 / rate**2 / math.hypot(1.0 - ratio**2, 2.0 * damping_ratio * ratio)
    last = found.displacement_m[times > 40.0]
    assert np.abs(last).max() == pytest.approx(size, rel=1e-4)
    drive_rate = 2.0 * math.pi / drive
    assert np.abs(found.velocity_m_s[times > 40.0]).max() == pytest.approx(size * drive_rate, rel=1e-4)


def test_the_equation_of_motion_holds_at_the_samples():
    found = oscillator_response(0.01, noise(), 0.6)
    rate = 2.0 * math.pi / 0.6
    spring = rate**2 * found.displacement_m + 2.0 * 0.05 * rate * found.velocity_m_s
    assert found.acceleration_m_s2 == pytest.approx(-spring, abs=1e-12)
    relative = found.acceleration_m_s2 - noise()
    # within h^2 w^2/12 of their size: 0.1 %, more where it bends
    trapezia = 0.5 * (relative[1:] + relative[:-1]) * 0.01
    assert np.diff(found.velocity_m_s) == pytest.approx(trapezia, abs=2e-3 * np.abs(trapezia).max())


@pytest.mark.parametrize("parts", [2, 5])
def test_a_denser_sampling_of_the_same_lines_changes_nothing(parts):
    values = noise()
    dense = np.interp(np.arange(2000 * parts + 1) / parts, np.arange(2001), values)
    periods = log_spaced_periods(0.01)
    coarse, fine = response_spectrum(0.01, values, periods), response_spectrum(0.01 / parts, dense, periods)
    assert fine == pytest.approx(coarse, rel=6e-4)


def test_free_vibration_after_the_end_counts():
    # Half a sine of 0.1 s under an oscillator of 1 s: the largest displacement comes long after the pulse.
    step = 0.001
    pulse = np.sin(math.pi * np.arange(101) / 100.0)
    periods = np.array([0.3, 1.0, 2.0])
    alone = response_spectrum(step, pulse, periods)
    padded = response_spectrum(step, np.append(pulse, np.zeros(3000)), periods)
    assert alone == pytest.approx(padded, rel=1e-4)


def test_limits_at_short_and_long_periods():
    # A stiff oscillator follows the floor; a soft one stays where it is.
    step = 0.005
    times = np.arange(0.0, 10.0 + step / 2.0, step)
    values = np.sin(2.0 * math.pi * times) * np.sin(math.pi * times / 10.0) ** 2
    found = response_spectrum(step, values, np.array([0.01, 2000.0]))
    assert found[0] == pytest.approx(np.abs(values).max(), rel=2e-3)
    velocity = np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * step))
    floor = np.append(0.0, np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * step))
    assert found[1] * (2000.0 / (2.0 * math.pi)) ** 2 == pytest.approx(np.abs(floor).max(), rel=1e-2)


def test_two_other_programs_agree():
    # Both take the peak of samples: dense enough to lose 1 - cos(pi/60) = 0.14 % at most, at the shortest period.
    step, parts, values = 0.01, 10, noise()
    periods = np.geomspace(0.06, 4.0, 30)
    found = response_spectrum(step, values, periods)
    dense = np.interp(np.arange(2000 * parts + 1) / parts, np.arange(2001), values)
    signal = eqsig.AccSignal(dense, step / parts)
    signal.generate_response_spectrum(response_times=periods)
    assert found * (periods / (2.0 * math.pi)) ** 2 == pytest.approx(signal.s_d, rel=1.5e-3)
    # In the frequency domain; a motion band-limited by five samples, with silence behind it for the free vibration.
    quiet = np.append(values, np.zeros(20_000))
    other = pyrotd.calc_spec_accels(step, quiet, 1.0 / periods, 0.05, osc_type="psa").spec_accel
    long = periods > 0.2
    assert found[long] == pytest.approx(other[long], rel=0.01)


@pytest.mark.parametrize(
    ("step", "values", "period", "damping_ratio", "told"),
    [
        (0.01, np.ones(9), 0.0199, 0.05, r"0\.0199 s is out .*: samples 0\.01 s .* periods from 0\.02 s"),
        (0.01, np.ones(9), math.nan, 0.05, "a period of nan s"),
        (0.0, np.ones(9), 1.0, 0.05, "the step between samples must be positive"),
        (0.01, np.ones(9), 1.0, 1.0, r"damping ratio must lie in \[0, 1\), got 1\.0"),
        (0.01, np.array([0.0, math.nan]), 1.0, 0.05, "sample 2 is not a finite number"),
    ],
)
def test_what_cannot_be_asked(step, values, period, damping_ratio, told):
    with pytest.raises(ValueError, match=told):
        response_spectrum(step, values, np.array([period]), damping_ratio)


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


def test_another_program_has_the_same_measures():
    step, values = 0.01, np.random.default_rng(2).standard_normal(3001).cumsum() * 0.01
    values *= np.sin(np.linspace(0.0, math.pi, 3001))
    found = intensity(step * np.arange(3001), values)
    signal = eqsig.AccSignal(values, step)
    assert found.peak_velocity_m_s == pytest.approx(signal.pgv, rel=1e-3)
    assert found.peak_displacement_m == pytest.approx(signal.pgd, rel=1e-3)
    assert found.arias_m_s == pytest.approx(eqsig.im.calc_arias_intensity(signal)[-1], rel=1e-3)
    assert found.significant_s == pytest.approx(eqsig.im.calc_sig_dur(signal), abs=0.03)
