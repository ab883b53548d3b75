"""Tables of base motion: exact integrals, baselines, splines, and what is refused."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from contact.motion.base_motion import TableMotion

RNG = np.random.default_rng(7)
TIMES = np.sort(RNG.uniform(0.4, 9.0, 40))
VALUES = RNG.normal(size=40)


def integrated(motion: TableMotion, until: float) -> np.ndarray:
    """Displacement and velocity at `until` by an independent integration from rest, knot by knot."""
    a, state = motion.accelerations, np.zeros(2)
    for i in range(motion.times.size - 1):
        low, high = motion.times[i], min(motion.times[i + 1], until)
        if high <= low:
            break

        def rates(t, y):
            return [y[1], np.interp(t, motion.times, a)]

        state = solve_ivp(rates, (low, high), state, rtol=1e-12, atol=1e-14, method="DOP853").y[:, -1]
    return state


@pytest.mark.parametrize("until", [3.21, 8.5])
def test_displacement_and_velocity_are_exact_integrals_of_the_acceleration(until):
    motion = TableMotion(times=TIMES, values=VALUES)
    x, v, a = motion.evaluate(np.array([until]))[:, 0]
    assert [x, v] == pytest.approx(integrated(motion, until), rel=1e-10, abs=1e-12)
    assert a == pytest.approx(np.interp(until, TIMES, motion.accelerations), rel=1e-12)


@pytest.mark.parametrize(
    "times",
    [
        TIMES,
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
    motion = TableMotion(times=TIMES, values=VALUES)
    assert (motion.evaluate(np.array([0.0, TIMES[0] - 1e-12])) == 0.0).all()
    end, later = motion.evaluate(np.array([TIMES[-1], TIMES[-1] + 3.0])).T
    assert end[2] == later[2] == 0.0
    assert later[:2] == pytest.approx([end[0] + 3.0 * end[1], end[1]], rel=1e-14)


@pytest.mark.parametrize("count", [2, 3, 40])
def test_a_displacement_table_is_the_natural_spline(count):
    times, values = TIMES[:count], VALUES[:count]
    motion = TableMotion(times=times, values=values, quantity="displacement")
    spline = CubicSpline(times, values, bc_type="natural")
    within = np.linspace(times[0], times[-1], 201)
    for order, row in enumerate(motion.evaluate(within)):
        largest = np.abs(spline(within, order)).max()
        assert row == pytest.approx(spline(within, order), rel=1e-9, abs=1e-9 * largest)
