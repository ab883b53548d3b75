"""Base motion from samples: an accelerogram, or displacements of the floor.

Between samples the acceleration is linear, so velocity and displacement are its exact integrals (a quadratic
and a cubic) and no integration rule adds a drift. Outside the table the acceleration is zero. An
acceleration table starts at rest: displacement and velocity are zero up to its first time. A displacement
table is read as the natural cubic spline through its samples, whose acceleration is linear between them too
and zero at both ends; before and after, the floor keeps its velocity.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import solve_banded

from contact.arrays import FloatArray
from contact.motion.kernel import PIECEWISE, FloorMotion, as_floor_motion, floor_history

# About ten samples resolve a period; faster motion is not in the table.
SPACINGS_PER_PERIOD = 10.0


@dataclass(frozen=True, kw_only=True, eq=False)  # arrays have no single truth value
class TableMotion:
    """Samples of the floor's acceleration or displacement at increasing times.

    `baseline` removes the drift of an acceleration table: `mean` subtracts its mean over time, so that the floor ends
    at rest; `linear` subtracts the straight line fitted by least squares (to the interpolated acceleration, not to the
    samples), so that the floor ends at rest where it began: the fit makes final velocity and displacement zero.

    Raises:
        ValueError: fewer than two samples, lengths that differ, times or values that are not finite, times
            that decrease or repeat, an unknown quantity or baseline, or one for a displacement table.
    """

    times: FloatArray  #: increasing, shape (n,) [s]
    values: FloatArray  #: shape (n,) [m/s2] or [m]
    quantity: Literal["acceleration", "displacement"] = "acceleration"
    baseline: Literal["none", "mean", "linear"] = "none"

    def __post_init__(self) -> None:
        # Copies: the caller's arrays may change, the compiled data must not.
        times, values = (np.array(a, dtype=np.float64) for a in (self.times, self.values))
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)
        _check_samples(times, values)
        if self.quantity not in ("acceleration", "displacement"):
            raise ValueError(
                f"motion table: unknown quantity {self.quantity!r}; known: acceleration, displacement"
            )
        if self.baseline not in ("none", "mean", "linear"):
            raise ValueError(f"motion table: unknown baseline {self.baseline!r}; known: none, mean, linear")
        if self.quantity == "displacement" and self.baseline != "none":
            raise ValueError(
                f"motion table: baseline {self.baseline!r} corrects accelerations; displacements take 'none'"
            )

    @property
    def accelerations(self) -> FloatArray:
        """Acceleration at the samples after the baseline correction, shape (n,) [m/s2]."""
        if self.quantity == "displacement":
            return _spline_accelerations(self.times, self.values)
        return self.values - _baseline(self.times, self.values, self.baseline)

    @property
    def peak_acceleration(self) -> float:
        """Largest |acceleration| [m/s2]: at a sample, since it is linear between them."""
        return float(np.max(np.abs(self.accelerations)))

    @property
    def break_times(self) -> FloatArray:
        """First and last time of the table where later than 0, shape (0 to 2,) [s]; within, nothing jumps."""
        ends = self.times[[0, -1]]
        return ends[ends > 0.0]

    @property
    def time_scale(self) -> float:
        """Shortest period that the samples resolve: ten times their median spacing [s]."""
        return SPACINGS_PER_PERIOD * float(np.median(np.diff(self.times)))

    def compiled(self) -> FloorMotion:
        """Data for `floor_motion`: displacement, velocity, acceleration, jerk from each sample on."""
        steps, a = np.diff(self.times), self.accelerations
        jerk = np.append(np.diff(a) / steps, 0.0)
        if self.quantity == "displacement":
            x, mean = self.values, np.diff(self.values) / steps
            v = mean - steps * (2.0 * a[:-1] + a[1:]) / 6.0
            v = np.append(v, mean[-1] + steps[-1] * a[-2] / 6.0)
        else:
            v = _summed(0.5 * (a[:-1] + a[1:]) * steps)
            x = _summed(steps * (v[:-1] + steps * (2.0 * a[:-1] + a[1:]) / 6.0))
        rows = np.column_stack([x, v, a, jerk])
        before, after = rows[:1].copy(), rows[-1:].copy()
        before[0, 2:] = after[0, 2:] = 0.0
        return as_floor_motion(
            PIECEWISE, breaks=self.times, coefficients=np.concatenate([before, rows[:-1], after])
        )

    def evaluate(self, times: FloatArray) -> FloatArray:
        """Displacement, velocity, acceleration at the times [s], shape (3, n_times)."""
        return floor_history(self.compiled(), times)


def _spline_accelerations(times: FloatArray, displacements: FloatArray) -> FloatArray:
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


def _check_samples(times: FloatArray, values: FloatArray) -> None:
    if times.ndim != 1 or times.shape != values.shape:
        raise ValueError(
            f"motion table: times {times.shape} and values {values.shape} must be two columns of one length"
        )
    if times.size < 2:
        raise ValueError(f"motion table: two samples or more are needed, got {times.size}")
    for name, column, unit in (("time", times, " s"), ("value", values, "")):
        if not np.isfinite(column).all():
            row = int(np.flatnonzero(~np.isfinite(column))[0])
            raise ValueError(
                f"motion table: {name} of sample {row + 1} is not a finite number ({column[row]}{unit})"
            )
    steps = np.diff(times)
    if (steps < 0.0).any():
        row = int(np.flatnonzero(steps < 0.0)[0])
        raise ValueError(
            f"motion table: times must increase, but sample {row + 2} ({times[row + 1]} s) is earlier than "
            f"sample {row + 1} ({times[row]} s); sort the table"
        )
    if (steps == 0.0).any():
        row = int(np.flatnonzero(steps == 0.0)[0])
        raise ValueError(
            f"motion table: time {times[row]} s occurs twice (samples {row + 1} and {row + 2}); keep one"
        )


def _summed(increments: FloatArray) -> FloatArray:
    return np.concatenate([[0.0], np.cumsum(increments)])


def _baseline(times: FloatArray, a: FloatArray, kind: str) -> FloatArray:
    """Baseline to subtract from a piecewise linear acceleration, at its samples, shape (n,) [m/s2].

    Least squares over time of the linear interpolant: with s in [-1, 1] over the table, the fit is
    m_0/2 + 3 m_1/2 s, where m_0 and m_1 are the exact integrals of a and a s (Legendre polynomials).
    """
    if kind == "none":
        return np.zeros_like(a)
    s = (times - 0.5 * (times[0] + times[-1])) / (0.5 * (times[-1] - times[0]))
    steps = np.diff(s)
    m_0 = math.fsum(0.5 * steps * (a[:-1] + a[1:]))
    if kind == "mean":
        return np.full_like(a, 0.5 * m_0)
    # Simpson's rule is exact for the product of two linear functions.
    middle = (a[:-1] + a[1:]) * (s[:-1] + s[1:])
    m_1 = math.fsum(steps / 6.0 * (a[:-1] * s[:-1] + middle + a[1:] * s[1:]))
    return 0.5 * m_0 + 1.5 * m_1 * s
