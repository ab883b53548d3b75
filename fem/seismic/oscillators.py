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
from fem.seismic.action import DAMPING_RATIO

LEAST_SAMPLES = 16  #: of a period, at least: a peak midway between samples is 1 - cos(pi/16) = 1.9 % too low
AT_ONCE = 4  #: steps for which the state of an oscillator is read and written once


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
            rows.append([*(square * coefficient for coefficient in numerator), *denominator[1:]])
        groups.append(_Group(members, count, np.ascontiguousarray(np.array(rows).T)))
    return tuple(groups)


def pseudo_accelerations(step: float, acceleration: FloatArray, periods: FloatArray) -> FloatArray:
    """Largest pseudo-accelerations at the samples, 5 % damping, shape (k,) [m/s2].

    Args:
        step: between samples [s]; acceleration: (n,) [m/s2]; periods: (k,) [s].
    """
    accelerations = np.empty(periods.size)
    for members, parts, coefficients in _groups(step, tuple(periods.tolist())):
        forces = np.zeros(2 + math.ceil(parts * acceleration.size / AT_ONCE) * AT_ONCE)
        work = np.zeros((3, coefficients.shape[1]))
        _largest(acceleration, parts, coefficients, forces, work[0], work[1], work[2])
        accelerations[members] = work[2]
    return accelerations


def _largest_of(
    acceleration: FloatArray,
    parts: int,
    coefficients: FloatArray,
    forces: FloatArray,
    last: FloatArray,
    last_but_one: FloatArray,
    largest: FloatArray,
) -> None:
    """Step all oscillators through a motion, which rises from zero in the step before its first sample.

    `last`, `last_but_one` and `largest` (m,) begin as zeros; `largest` ends as the largest responses. `forces` begins
    as zeros, too: the forcing at all steps, after two zeros and as many as make the steps a multiple of `AT_ONCE`.
    """
    # Unpacked at once, the rows would not be known to be contiguous, and the loop would take three times as long.
    now, one_before, two_before = coefficients[0], coefficients[1], coefficients[2]
    decay_one, decay_two = coefficients[3], coefficients[4]
    first = forces.size - parts * acceleration.size
    for part in range(parts):
        share, begin = (part + 1) / parts, 0.0
        for sample in range(acceleration.size):
            forces[first + part + parts * sample] = begin + share * (acceleration[sample] - begin)
            begin = acceleration[sample]
    for i in range(2, forces.size, AT_ONCE):
        f0, f1, f2, f3 = forces[i - 2], forces[i - 1], forces[i], forces[i + 1]
        f4, f5 = forces[i + 2], forces[i + 3]
        for k in range(last.size):
            a, b, c, d, e = now[k], one_before[k], two_before[k], decay_one[k], decay_two[k]
            r0, r1, most = last_but_one[k], last[k], largest[k]
            r2 = a * f2 + b * f1 + c * f0 - d * r1 - e * r0
            r3 = a * f3 + b * f2 + c * f1 - d * r2 - e * r1
            r4 = a * f4 + b * f3 + c * f2 - d * r3 - e * r2
            r5 = a * f5 + b * f4 + c * f3 - d * r4 - e * r3
            for response in (r2, r3, r4, r5):
                size = abs(response)
                most = size if size > most else most
            last_but_one[k], last[k], largest[k] = r4, r5, most


_largest = compiled(_largest_of, sources=(Path(__file__),))
