"""Base motion: derivatives, ends, peaks, breaks against closed forms; tables against integrals and splines."""

import math

import numpy as np
import pytest
from floors import integrated
from scipy.interpolate import CubicSpline

from contact.motion.base_motion import (
    HarmonicMotion,
    NoMotion,
    PulseMotion,
    SumOfMotions,
    along_and_normal,
)
from contact.motion.table import TableMotion

OMEGA = 6.928
PERIOD = 2.0 * math.pi / OMEGA


def tapered(**changes) -> HarmonicMotion:
    plain = {"amplitude": 0.05, "angular_frequency": OMEGA, "duration": 20.0, "ramp_cycles": 2.0}
    return HarmonicMotion(**plain | changes)


MOTIONS = {
    "plain": tapered(ramp_cycles=0.0, phase=0.7),
    "tapered": tapered(phase=-1.1),
    "cycles": tapered(ramp_cycles=0.0, cycles=4.0),
    "tapered cycles": tapered(ramp_cycles=1.5, cycles=6.0, phase=2.0),
    "rectangular": PulseMotion(shape="rectangular", acceleration=3.0, pulse=0.7, delay=0.25),
    "half-sine": PulseMotion(shape="half-sine", acceleration=-2.0, pulse=0.9, delay=0.1),
    "sine": PulseMotion(shape="sine", acceleration=4.0, pulse=1.3),
}


def times_away_from_breaks(motion, until: float) -> np.ndarray:
    times = np.random.default_rng(1).uniform(0.0, until, 400)
    near = np.abs(times[:, None] - motion.break_times[None, :]) < 2e-3
    return times[~near.any(axis=1)]


@pytest.mark.parametrize("name", MOTIONS)
def test_velocity_and_acceleration_are_derivatives_of_the_displacement(name):
    motion = MOTIONS[name]
    times, step = times_away_from_breaks(motion, 21.0 if "cycles" not in name else 8.0), 1e-4
    _, v, a = motion.evaluate(times)
    x_minus, v_minus, _ = motion.evaluate(times - step)
    x_plus, v_plus, _ = motion.evaluate(times + step)
    # Error of the central difference: step^2/6 times the next-but-one derivative, A Omega^4 and its like.
    assert np.abs((x_plus - x_minus) / (2 * step) - v).max() < 1e-6
    assert np.abs((v_plus - v_minus) / (2 * step) - a).max() < 1e-6


@pytest.mark.parametrize("name", MOTIONS)
def test_displacement_and_velocity_never_jump_and_acceleration_only_at_breaks(name):
    motion = MOTIONS[name]
    for instant in motion.break_times:
        before, after = motion.evaluate(np.array([instant - 1e-9, instant + 1e-9])).T
        assert np.abs(before - after)[:2] == pytest.approx([0.0, 0.0], abs=1e-7)
    if "tapered" in name:  # a C2 window leaves no jump at all
        for instant in motion.break_times:
            before, after = motion.evaluate(np.array([instant - 1e-9, instant + 1e-9]))[2]
            assert after == pytest.approx(before, abs=1e-5)


def test_tapered_harmonic_starts_and_ends_at_rest_and_is_the_full_sine_between():
    motion = tapered()
    ends = motion.evaluate(np.array([0.0, 20.0, 25.0]))
    assert ends == pytest.approx(np.zeros((3, 3)), abs=1e-15)
    times = np.linspace(2 * PERIOD, 20.0 - 2 * PERIOD, 50)
    assert motion.evaluate(times)[0] == pytest.approx(0.05 * np.sin(OMEGA * times), abs=1e-15)


@pytest.mark.parametrize(
    ("phase", "cycles", "quarters"),
    [
        (0.0, 10.0, 41.0),
        (math.pi / 2, 10.0, 40.0),
        (math.pi, 3.0, 13.0),
        (-0.5 * math.pi, 1.0, 4.0),
        (0.0, 0.5, 3.0),
    ],
)
def test_drive_ends_at_the_first_zero_velocity_after_its_cycles_and_the_floor_stays(phase, cycles, quarters):
    motion = tapered(ramp_cycles=0.0, phase=phase, cycles=cycles)
    assert motion.end_time == pytest.approx(quarters * PERIOD / 4, rel=1e-12)
    x, v, a = motion.evaluate(motion.end_time + np.array([0.0, 1e-6, 5.0]))
    assert np.abs(x) == pytest.approx([0.05] * 3, rel=1e-12)
    assert (v == 0.0).all() and (a == 0.0).all()
    assert motion.evaluate(np.array([motion.end_time - 1e-9]))[1, 0] == pytest.approx(0.0, abs=1e-7)


def test_break_times_within_the_run():
    assert tapered(ramp_cycles=0.0).break_times.size == 0
    assert tapered().break_times == pytest.approx([2 * PERIOD, 20.0 - 2 * PERIOD, 20.0])
    assert tapered(ramp_cycles=0.0, cycles=1.0).break_times == pytest.approx([1.25 * PERIOD])
    assert tapered(cycles=100.0).break_times == pytest.approx([2 * PERIOD])  # the drive outlasts the run
    assert MOTIONS["sine"].break_times == pytest.approx([1.3])
    assert MOTIONS["rectangular"].break_times == pytest.approx([0.25, 0.95])


@pytest.mark.parametrize("ramp_cycles", [0.3, 1.0, 10.0])
@pytest.mark.parametrize("phase", [0.0, 0.9])
def test_peak_acceleration_includes_what_a_steep_ramp_adds(ramp_cycles, phase):
    motion = tapered(ramp_cycles=ramp_cycles, phase=phase)
    dense = np.abs(motion.evaluate(np.linspace(0.0, 20.0, 2_000_001))[2]).max()
    assert motion.peak_acceleration == pytest.approx(dense, rel=1e-8)
    assert motion.peak_acceleration >= dense * (1.0 - 1e-13)


@pytest.mark.parametrize(
    ("shape", "velocity", "displacement"),
    # End of the pulse, in units of a0 t0 and a0 t0^2: elementary integrals.
    [("rectangular", 1.0, 0.5), ("half-sine", 2 / math.pi, 1 / math.pi), ("sine", 0.0, 1 / (2 * math.pi))],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_pulse_leaves_the_floor_with_the_velocity_reached(shape, velocity, displacement, sign):
    motion = PulseMotion(shape=shape, acceleration=sign * 3.0, pulse=0.8, delay=0.5)
    x, v, a = motion.evaluate(np.array([0.0, 0.5, 1.3, 3.3]))
    v_end, x_end = sign * 3.0 * 0.8 * velocity, sign * 3.0 * 0.8**2 * displacement
    assert v == pytest.approx([0.0, 0.0, v_end, v_end], abs=1e-14)
    assert x == pytest.approx([0.0, 0.0, x_end, x_end + 2.0 * v_end], abs=1e-14)
    assert a[2] == a[3] == 0.0
    assert motion.peak_acceleration == 3.0 and motion.time_scale == 0.8


class TestMotionsOnASlope:
    """A horizontal and a vertical motion of any kinds, along a floor and normal to it."""

    MOTIONS = (
        HarmonicMotion(amplitude=0.05, angular_frequency=7.0, duration=4.0, phase=0.3, ramp_cycles=1.0),
        HarmonicMotion(amplitude=0.02, angular_frequency=11.0, duration=4.0, cycles=3.0),
        PulseMotion(shape="half-sine", acceleration=3.0, pulse=0.4, delay=0.2),
        PulseMotion(shape="rectangular", acceleration=-2.0, pulse=0.3),
        TableMotion(times=0.1 * np.arange(30), values=np.sin(np.arange(30.0))),
        TableMotion(times=0.5 + 0.07 * np.arange(40), values=np.cos(np.arange(40.0))),
        TableMotion(times=0.1 * np.arange(30), values=np.cos(np.arange(30.0))),
        TableMotion(
            times=0.1 * np.arange(30), values=0.01 * np.sin(np.arange(30.0)), quantity="displacement"
        ),
        NoMotion(),
    )
    TIMES = np.linspace(-0.5, 5.0, 1237)

    @pytest.mark.parametrize("slope", [0.05, -0.4])
    @pytest.mark.parametrize("one", range(len(MOTIONS)))
    def test_they_are_those_of_the_turned_axes(self, one, slope):
        horizontal, turn = self.MOTIONS[one], np.array([math.cos(slope), math.sin(slope)])
        for vertical in self.MOTIONS:
            along, normal = along_and_normal(horizontal, vertical, slope)
            x, z = horizontal.evaluate(self.TIMES), vertical.evaluate(self.TIMES)
            for found, wanted in ((along, x * turn[0] - z * turn[1]), (normal, x * turn[1] + z * turn[0])):
                np.testing.assert_allclose(found.evaluate(self.TIMES), wanted, rtol=0.0, atol=1e-9)

    def test_their_peak_is_that_of_the_sum(self):
        sums = [along_and_normal(a, b, 0.3)[0] for a, b in zip(self.MOTIONS, self.MOTIONS[1:], strict=False)]
        for motion in [found for found in sums if isinstance(found, SumOfMotions)]:
            found = np.abs(motion.evaluate(np.linspace(0.0, 3.0, 200_001))[2]).max()
            assert motion.peak_within(3.0) == pytest.approx(found, rel=1e-4)
            assert motion.peak_acceleration >= (1.0 - 1e-4) * found
            assert motion.span[0] <= min(motion.break_times)


RNG = np.random.default_rng(7)
TABLE_TIMES = np.sort(RNG.uniform(0.4, 9.0, 40))
TABLE_VALUES = RNG.normal(size=40)


@pytest.mark.parametrize("until", [3.21, 8.5])
def test_displacement_and_velocity_are_exact_integrals_of_the_acceleration(until):
    motion = TableMotion(times=TABLE_TIMES, values=TABLE_VALUES)
    x, v, a = motion.evaluate(np.array([until]))[:, 0]
    exact = integrated(motion.times, motion.accelerations, until)
    assert [x, v] == pytest.approx(exact, rel=1e-10, abs=1e-12)
    assert a == pytest.approx(np.interp(until, TABLE_TIMES, motion.accelerations), rel=1e-12)


@pytest.mark.parametrize(
    "times",
    [
        TABLE_TIMES,
        np.arange(0.0, 40.0, 0.005),
        np.cumsum(RNG.uniform(0.004, 0.006, 900)),
        np.array([0.0, 1e-9, 5.0]),
    ],
    ids=["at random", "even", "almost even", "far apart"],
)
def test_the_interval_of_any_time_is_found(times):
    values = RNG.normal(size=times.size)
    motion = TableMotion(times=times, values=values)
    inner = times[1:-1]
    asked = np.concatenate([RNG.uniform(times[0], times[-1], 500), inner, np.nextafter(inner, 0.0)])
    largest = np.abs(values).max()
    assert motion.evaluate(asked)[2] == pytest.approx(np.interp(asked, times, values), abs=1e-6 * largest)


def test_floor_is_at_rest_before_the_table_and_coasts_after_it():
    motion = TableMotion(times=TABLE_TIMES, values=TABLE_VALUES)
    assert (motion.evaluate(np.array([0.0, TABLE_TIMES[0] - 1e-12])) == 0.0).all()
    end, later = motion.evaluate(np.array([TABLE_TIMES[-1], TABLE_TIMES[-1] + 3.0])).T
    assert end[2] == later[2] == 0.0
    assert later[:2] == pytest.approx([end[0] + 3.0 * end[1], end[1]], rel=1e-14)


@pytest.mark.parametrize("count", [2, 3, 40])
def test_a_displacement_table_is_the_natural_spline(count):
    times, values = TABLE_TIMES[:count], TABLE_VALUES[:count]
    motion = TableMotion(times=times, values=values, quantity="displacement")
    spline = CubicSpline(times, values, bc_type="natural")
    within = np.linspace(times[0], times[-1], 201)
    for order, row in enumerate(motion.evaluate(within)):
        largest = np.abs(spline(within, order)).max()
        assert row == pytest.approx(spline(within, order), rel=1e-9, abs=1e-9 * largest)
