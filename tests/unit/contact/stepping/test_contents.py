"""The filter of the acceleration of the contents against scipy, and in runs."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import scipy.signal
from case_rows import run_cases
from runs import run

from contact.stepping.contents import ACCELERATION, begin_contents, filter_contents
from fem.case.case import load_case

CUTOFF, END = 2.0 * math.pi * 33.0, 0.3
AT_REST = (0.0, 0.0)  # the floor
Motion = tuple[Callable[[np.ndarray], np.ndarray], Callable[[np.ndarray], np.ndarray]]
SMOOTH: Motion = (lambda t: -np.cos(40.0 * t) / 40.0, lambda t: np.sin(40.0 * t))
#: 1 Ns on 1 kg at 0.1003 s, within a step
IMPULSE: Motion = (lambda t: np.maximum(0.0, t - 0.1003), lambda t: np.where(t >= 0.1003, 1.0, 0.0))


def uneven(step: float) -> np.ndarray:
    """Instants of steps that vary by 30 % about a size [s]."""
    steps = step * np.random.default_rng(1).uniform(0.7, 1.3, int(1.4 * END / step))
    times = np.concatenate([[0.0], np.cumsum(steps)])
    return times[times <= END]


def filtered(motion: Motion, times: np.ndarray) -> tuple[np.ndarray, float]:
    """Filtered acceleration at the instants, and the largest one."""
    contents, largest, found = np.zeros((8, 2)), 0.0, [0.0]
    monitor = np.column_stack([motion[0](times), 0.0 * times, motion[1](times), 0.0 * times])
    begin_contents(contents, monitor[:1], AT_REST)
    for k, step in enumerate(np.diff(times)):
        largest = filter_contents(contents, monitor[k + 1 : k + 2], AT_REST, step, CUTOFF, largest)
        found.append(contents[ACCELERATION, 0])
    return np.array(found), largest


@cache
def dense_response(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Instants, and the acceleration there by a Butterworth filter of scipy."""
    dense = np.linspace(0.0, END, 300_001)
    numerator, denominator = scipy.signal.butter(2, CUTOFF, analog=True)
    differentiated = (np.append(numerator, 0.0), denominator)
    return dense, scipy.signal.lsim(differentiated, motion[1](dense) - motion[1](dense[:1]), dense)[1]


def by_scipy(motion: Motion, times: np.ndarray) -> tuple[np.ndarray, float]:
    """The filtered acceleration at the instants, and the largest one, by scipy."""
    dense, found = dense_response(motion)
    return np.interp(times, dense, found), float(np.abs(found[dense <= times[-1]]).max())


@pytest.mark.parametrize(
    ("motion", "step", "within"),
    [(SMOOTH, 5e-3, 1e-2), (SMOOTH, 1.5e-3, 1e-4), (IMPULSE, 1.5e-3, 1e-2), (IMPULSE, 1e-4, 1e-3)],
)
def test_the_filter_is_butterworths_of_second_order(motion: Motion, step: float, within: float) -> None:
    times = uneven(step)
    found, largest = filtered(motion, times)
    expected, peak = by_scipy(motion, times)
    assert found == pytest.approx(expected, abs=within * peak)
    assert largest == pytest.approx(peak, rel=max(within, 2e-3))


@pytest.mark.parametrize("model", ["rigid", pytest.param("reduced", marks=pytest.mark.slow)])
def test_the_acceleration_does_not_depend_on_the_intervals_of_the_output(model: str) -> None:
    case = load_case("rocking", (f"solver.model={model}", "solver.duration_s=1.5", "output.fields_s=0"))
    found = [
        float(run(case, {"output.history_s": interval}).track.max_acceleration) for interval in (2e-2, 1e-3)
    ]
    assert found[0] == found[1] > 10.0
    finer = run(case, {"solver.energy_tolerance": 0.1})
    assert float(finer.track.max_acceleration) == pytest.approx(found[0], rel=1e-2)
    (row,) = run_cases([case], jobs=1)  # without a history: the same number
    assert row["max_acceleration_m_s2"] == found[0]


def test_a_lower_cut_off_gives_less() -> None:
    case = load_case("rocking", ("solver.model=rigid", "solver.duration_s=1.5"))
    found = [
        run(case, {"output.contents_filter_Hz": cutoff}).track.max_acceleration
        for cutoff in (10.0, 33.0, 100.0)
    ]
    assert found[0] < found[1] < found[2]
