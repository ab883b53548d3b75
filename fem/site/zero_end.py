"""Baseline of a sampled acceleration: velocity and displacement end at zero.

Subtracted is the polynomial of degree 5 whose displacement fits that of the motion best (least squares over the
samples) among those that end with its velocity and displacement. Both are integrated as a run does it, linear between
samples, so that the floor ends at rest where it began to the rounding of the sums.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fem.runtime.arrays import FloatArray

#: of the acceleration subtracted: displacements of t^2 to t^7
DEGREE = 5


class _Fit(NamedTuple):
    """The least squares of one length: coefficients = of_displacement x + of_ends (d, v) at the end."""

    shapes: FloatArray  #: (n, 6)
    of_displacement: FloatArray  #: (6, n)
    of_ends: FloatArray  #: (6, 2)


def without_drift(acceleration: FloatArray) -> FloatArray:
    """The acceleration (n,) without its baseline."""
    fit = _fit(acceleration.size)
    velocity, displacement = _integrals(acceleration)
    ends = np.array([displacement[-1], velocity[-1]])
    return acceleration - fit.shapes @ (fit.of_displacement @ displacement + fit.of_ends @ ends)


def residuals(step: float, acceleration: FloatArray) -> tuple[float, float]:
    """Velocity [m/s] and displacement [m] at the last sample."""
    velocity, displacement = _integrals(acceleration)
    return float(velocity[-1]) * step, float(displacement[-1]) * step**2


@lru_cache(maxsize=8)
def _fit(count: int) -> _Fit:
    shapes = np.asarray(
        np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, count), DEGREE), dtype=np.float64
    )
    pairs = [_integrals(shape) for shape in shapes.T]
    moved = np.array([displacement for _, displacement in pairs]).T
    ends = np.array([[displacement[-1], velocity[-1]] for velocity, displacement in pairs]).T
    size = np.array([count**2, count], dtype=float)[:, None]
    meets = np.linalg.pinv(ends / size) / size.T
    free = np.linalg.svd(ends / size)[2][2:].T  # what changes nothing at the end
    best = free @ np.linalg.pinv(moved @ free)
    return _Fit(shapes, best, meets - best @ (moved @ meets))


def _integrals(acceleration: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Velocity and displacement at the samples (n,), in units of the step."""
    before, after = acceleration[:-1], acceleration[1:]
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * (before + after))])
    return velocity, np.concatenate([[0.0], np.cumsum(velocity[:-1] + (2.0 * before + after) / 6.0)])
