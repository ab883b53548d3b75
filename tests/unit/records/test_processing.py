"""Processing of a component: trim, scale, baselines that are exact for the straight lines between samples."""

import math

import numpy as np
import pytest
from floors import integrated

from fem.records.processing import Processing, baseline_change, motion_of, processed
from fem.records.record import Component

RNG = np.random.default_rng(7)
TIMES = np.sort(RNG.uniform(0.4, 9.0, 40))
VALUES = RNG.normal(size=40)


def component(values=VALUES, times=TIMES, **options):
    return Component(times=times, readings=values, **options)


def made(values=VALUES, times=TIMES, quantity="acceleration", **options):
    return processed(component(values, times, quantity=quantity), Processing(**options))


def ends_of(found):
    """Displacement and velocity at the end, by an independent integration from rest."""
    return integrated(found.times, found.values)


def test_mean_ends_at_rest():
    x, v = ends_of(made(VALUES + 0.3, baseline="mean"))
    assert v == pytest.approx(0.0, abs=1e-13)
    assert abs(x) > 1e-3  # it does not bring it back: that is what `linear` is for


def test_mean_is_that_over_time_not_over_samples():
    found = made(np.array([1.0, 3.0, 1.0]), np.array([0.0, 1.0, 2.0]), baseline="mean")
    assert np.abs(found.values).max() == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("baseline", ["linear", "zero-end"])
def test_linear_and_zero_end_bring_the_floor_to_rest_where_it_began(baseline):
    ends = ends_of(made(VALUES + 0.3 - 0.2 * TIMES, baseline=baseline))
    assert ends == pytest.approx([0.0, 0.0], abs=1e-12)


def test_linear_is_the_least_squares_line():
    residual = made(baseline="linear").values
    fine = np.linspace(TIMES[0], TIMES[-1], 200_001)

    def squares(offset: float, slope: float) -> float:
        return float(np.sum((np.interp(fine, TIMES, residual) + offset + slope * (fine - fine.mean())) ** 2))

    best = squares(0.0, 0.0)
    for offset, slope in ((1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3)):
        assert squares(offset, slope) > best


def test_zero_end_is_exact_for_long_records_and_removes_a_drift():
    """60 s of a decaying noise with a linear drift: what is left at the end is the rounding of the sums."""
    times = np.arange(0.0, 60.0, 0.005)
    noise = RNG.normal(size=times.size) * np.exp(-0.5 * ((times - 15.0) / 6.0) ** 2)
    drifting = noise + 0.05 - 0.002 * times
    x, v, a = motion_of(made(drifting, times, baseline="zero-end"))
    assert abs(v[-1]) < 1e-10 and abs(x[-1]) < 1e-9
    still = motion_of(made(noise, times, baseline="zero-end"))[0]
    assert np.abs(x - still).max() < 1e-6  # the polynomial takes all of the drift
    assert np.abs(a - noise).max() < 0.2
    raw = motion_of(component(drifting, times))[0]
    assert abs(raw[-1]) > 10.0


def test_zero_end_fits_the_displacement_best_among_those_that_meet_its_ends():
    """A bump of displacement that ends at rest leaves less of the fit, whatever its sign."""
    times = np.linspace(0.0, 10.0, 2001)
    values = np.sin(1.3 * times) + 0.1 * times
    correction = values - made(values, times, baseline="zero-end").values
    x = motion_of(component(values, times))[0]

    def left(extra: float) -> float:
        tau = times / 10.0  # t^4 (1 - t)^2: zero with its slope at both ends
        bump = 12.0 * tau**2 - 40.0 * tau**3 + 30.0 * tau**4
        fit = motion_of(component(correction + extra * bump, times))[0]
        return float(np.sum((x - fit) ** 2))

    assert left(0.0) < min(left(1e-3), left(-1e-3))


def test_a_trimmed_part_begins_at_zero_and_is_interpolated_at_its_ends():
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    values = np.array([0.0, 1.0, 3.0, -1.0, 0.0])
    found = made(values, times, start=0.5, end=2.25)
    assert found.times.tolist() == [0.0, 0.5, 1.5, 1.75]
    assert found.values.tolist() == [0.5, 1.0, 3.0, 2.0]
    assert made(values, times, start=1.0, end=99.0).times.tolist() == [0.0, 1.0, 2.0, 3.0]
    moved = made(values, times, quantity="displacement", start=0.5, end=3.5)
    assert moved.values.tolist() == [1.0, 3.0, -1.0] and moved.times.tolist() == [0.5, 1.5, 2.5]


def test_scales_are_a_factor_and_a_peak_behind_the_baseline():
    assert made(scale=-2.0).values == pytest.approx(-2.0 * VALUES)
    found = made(VALUES + 5.0, baseline="mean", peak=3.5)
    assert np.abs(found.values).max() == pytest.approx(3.5, rel=1e-14)
    assert ends_of(found)[1] == pytest.approx(0.0, abs=1e-12)
    moved = made(quantity="displacement", peak=2.0)
    assert np.abs(motion_of(moved)[2]).max() == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"start": 9.5}, "nothing is left of it: its times are"),
        ({"start": 3.0, "end": 2.0}, "nothing is left"), ({"baseline": "cubic"}, "unknown baseline 'cubic'"),
        ({"quantity": "displacement", "baseline": "mean"}, "corrects accelerations"),
        ({"quantity": "velocity"}, "velocities do not move a floor"),
        ({"scale": math.nan}, "scale must be finite"), ({"values": np.zeros(40), "peak": 1.0}, "all zero"),
    ],
)  # fmt: skip
def test_what_cannot_be_done_is_refused(options, words):
    with pytest.raises(ValueError, match=words):
        made(**options)


PULSE_TIMES = np.arange(0.0, 5.005, 0.01)


def pulse(drift=0.0):
    """One cycle of a sine of 3.4 m/s2 and 0.8 s: 3.4 * 0.8 / pi = 0.866 m/s, a displacement stays."""
    moving = np.where(PULSE_TIMES < 0.8, 3.4 * np.sin(2.0 * np.pi * PULSE_TIMES / 0.8), 0.0)
    return component(moving + drift, PULSE_TIMES)


def test_what_a_baseline_takes_from_a_pulse_is_told_with_both_values():
    change = baseline_change(pulse(), Processing(baseline="zero-end"))
    used = motion_of(processed(pulse(), Processing(baseline="zero-end")))
    assert change.velocities == pytest.approx((3.4 * 0.8 / np.pi, np.abs(used[1]).max()), rel=1e-3)
    assert change.accelerations == pytest.approx((3.4, np.abs(used[2]).max()), rel=1e-3)
    assert change.is_said and change.is_doubtful
    assert "from 0.865 m/s with 'mean'" in change.in_words
    halved = baseline_change(pulse(), Processing(baseline="zero-end", peak=0.5 * change.accelerations[1]))
    assert halved.velocities == pytest.approx([0.5 * one for one in change.velocities])


def test_a_drift_is_no_part_of_the_velocity_that_a_baseline_changes():
    drift = 0.02  # 0.1 m/s at the end, a ninth of the largest velocity
    change = baseline_change(pulse(drift), Processing(baseline="mean"))
    assert not change.is_said and change.velocities[0] == pytest.approx(0.865, abs=0.02)
    assert baseline_change(pulse(), Processing()) is None
