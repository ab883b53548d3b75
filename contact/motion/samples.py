"""Samples of the floor's motion between which its acceleration is linear: exact integrals, and the natural spline.

No kernel is loaded here: records are processed with the same sums that the compiled motion is made of.
"""

from typing import Literal

import numpy as np
from scipy.linalg import solve_banded

from contact.arrays import FloatArray


def sampled_motion(
    times: FloatArray, values: FloatArray, quantity: Literal["acceleration", "displacement"]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Displacement [m], velocity [m/s] and acceleration [m/s2] at the samples, each of shape (n,).

    Accelerations are integrated from rest; displacements are interpolated by a natural cubic spline.
    """
    steps = np.diff(times)
    if quantity == "displacement":
        a, mean = spline_accelerations(times, values), np.diff(values) / steps
        v = mean - steps * (2.0 * a[:-1] + a[1:]) / 6.0
        return values, np.append(v, mean[-1] + steps[-1] * a[-2] / 6.0), a
    v = _summed(0.5 * (values[:-1] + values[1:]) * steps)
    return _summed(steps * (v[:-1] + steps * (2.0 * values[:-1] + values[1:]) / 6.0)), v, values


def spline_accelerations(times: FloatArray, displacements: FloatArray) -> FloatArray:
    """Second derivative of the natural cubic spline at its samples (n,) [m/s2]: velocity has no jump there.

    Solved here, because loading scipy.interpolate takes as long as loading all else that a run needs of scipy.
    """
    a = np.zeros(times.size)
    steps = np.diff(times)
    if steps.size > 1:
        bands = np.zeros((3, steps.size - 1))  # above the diagonal, on it, below
        bands[0, 1:], bands[2, :-1] = steps[1:-1], steps[1:-1]
        bands[1] = 2.0 * (steps[:-1] + steps[1:])
        a[1:-1] = solve_banded((1, 1), bands, 6.0 * np.diff(np.diff(displacements) / steps))
    return a


def _summed(increments: FloatArray) -> FloatArray:
    return np.concatenate([[0.0], np.cumsum(increments)])
