"""Many oscillators under one motion, compiled: the spectrum inside the loops that shape motions.

The exact steps are those of `fem.records.spectrum`; peaks are taken at the samples, which are dense enough for every
oscillator that none is missed by more than 2 %. What is reported of a motion comes from `response_spectrum`, which
also finds the peaks between samples.
"""

import math
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from contact.jit import compiled
from fem.records.spectrum import exact_recursion
from fem.runtime.arrays import BoolArray, FloatArray
from fem.site.action import DAMPING_RATIO

#: of a period, at least: a peak midway between samples is 1 - cos(pi/16) = 1.9 % too low
LEAST_SAMPLES = 16


class _Group(NamedTuple):
    """Oscillators that share a step."""

    members: BoolArray  #: their places, as a mask (k,)
    parts: int  #: of the step between samples
    coefficients: FloatArray  #: (5, m): forcing now and one and two steps before, response one and two before


@lru_cache(maxsize=16)
def _groups(step: float, periods: tuple[float, ...]) -> tuple[_Group, ...]:
    parts = np.array([max(1, math.ceil(LEAST_SAMPLES * step / period)) for period in periods])
    parts[parts > 1] = parts.max()  # two steps are enough, and each of them a pass
    groups = []
    for count in sorted(set(parts.tolist())):
        members = parts == count
        rows = []
        for period in np.array(periods)[members].tolist():
            # Pseudo-acceleration, so displacement times the square of the rate.
            numerator, denominator = exact_recursion(step / count, period, DAMPING_RATIO)
            square = (2.0 * math.pi / period) ** 2
            rows.append([*(square * one for one in numerator), *denominator[1:]])
        groups.append(_Group(members, count, np.ascontiguousarray(np.array(rows).T)))
    return tuple(groups)


def pseudo_accelerations(step: float, acceleration: FloatArray, periods: FloatArray) -> FloatArray:
    """Largest pseudo-accelerations at the samples, 5 % damping, shape (k,) [m/s2].

    Args:
        step: between samples [s]; acceleration: (n,) [m/s2]; periods: (k,) [s].
    """
    found = np.empty(periods.size)
    for members, parts, coefficients in _groups(step, tuple(periods.tolist())):
        work = np.zeros((3, coefficients.shape[1]))
        _largest(acceleration, parts, coefficients, work[0], work[1], work[2])
        found[members] = work[2]
    return found


def _largest_of(
    acceleration: FloatArray,
    parts: int,
    coefficients: FloatArray,
    last: FloatArray,
    last_but_one: FloatArray,
    largest: FloatArray,
) -> None:
    """Step all oscillators through a motion, which rises from zero in the step before its first sample.

    `last`, `last_but_one` and `largest` (m,) begin as zeros; `largest` ends as the largest responses.
    """
    # Unpacked at once, the rows would not be known to be contiguous, and the loop would take three times as long.
    now, one_before, two_before = coefficients[0], coefficients[1], coefficients[2]
    decay_one, decay_two = coefficients[3], coefficients[4]
    forced, forced_before = 0.0, 0.0
    for sample in range(acceleration.size):
        begin = acceleration[sample - 1] if sample > 0 else 0.0
        for part in range(parts):
            force = begin + (part + 1) / parts * (acceleration[sample] - begin)
            for k in range(last.size):
                response = (
                    now[k] * force
                    + one_before[k] * forced
                    + two_before[k] * forced_before
                    - decay_one[k] * last[k]
                    - decay_two[k] * last_but_one[k]
                )
                last_but_one[k] = last[k]
                last[k] = response
                size = abs(response)
                largest[k] = size if size > largest[k] else largest[k]
            forced_before = forced
            forced = force


_largest = compiled(_largest_of, sources=(Path(__file__),))
