"""Base motion from samples: an accelerogram, or displacements of the floor.

Between samples the acceleration is linear, so velocity and displacement are its exact integrals (a quadratic
and a cubic) and no integration rule adds a drift. Outside the table the acceleration is zero. An
acceleration table starts at rest: displacement and velocity are zero up to its first time. A displacement
table is read as the natural cubic spline through its samples, whose acceleration is linear between them too
and zero at both ends; before and after, the floor keeps its velocity.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from contact.arrays import FloatArray
from contact.motion.kernel import PIECEWISE, FloorMotion, as_floor_motion, floor_history
from contact.motion.samples import sampled_motion, spline_accelerations

# About ten samples resolve a period; faster motion is not in the table.
SPACINGS_PER_PERIOD = 10.0


@dataclass(frozen=True, kw_only=True, eq=False)  # arrays have no single truth value
class TableMotion:
    """Samples of the floor's acceleration or displacement at increasing times.

    Raises:
        ValueError: lengths that differ, fewer than two samples, or times that do not increase or are not finite.
    """

    times: FloatArray  #: increasing, shape (n,) [s]
    values: FloatArray  #: shape (n,) [m/s2] or [m]
    quantity: Literal["acceleration", "displacement"] = "acceleration"

    def __post_init__(self) -> None:
        # Copies: the caller's arrays may change, the compiled data must not.
        times, values = (np.array(a, dtype=np.float64) for a in (self.times, self.values))
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)
        if times.ndim != 1 or times.shape != values.shape or times.size < 2:
            raise ValueError(
                f"motion table: two samples or more are needed, got times {times.shape} and values {values.shape}"
            )
        if not (np.isfinite([times, values]).all() and (np.diff(times) > 0.0).all()):
            raise ValueError("motion table: times and values must be finite, and times must increase")
        if self.quantity not in ("acceleration", "displacement"):
            raise ValueError(
                f"motion table: unknown quantity {self.quantity!r}; known: acceleration, displacement"
            )

    @cached_property  # as what follows: the runs of a study share their motions
    def accelerations(self) -> FloatArray:
        """Acceleration at the samples, shape (n,) [m/s2]."""
        if self.quantity == "displacement":
            return spline_accelerations(self.times, self.values)
        return self.values

    @property
    def peak_acceleration(self) -> float:
        """Largest |acceleration| [m/s2]: at a sample, since it is linear between them."""
        return float(np.max(np.abs(self.accelerations)))

    @property
    def break_times(self) -> FloatArray:
        """First and last time of the table where later than 0, shape (0 to 2,) [s]; within, nothing jumps."""
        ends = self.times[[0, -1]]
        return ends[ends > 0.0]

    @cached_property
    def time_scale(self) -> float:
        """Shortest period that the samples resolve: ten times their median spacing [s]."""
        return SPACINGS_PER_PERIOD * float(np.median(np.diff(self.times)))

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of the table [s]."""
        return float(self.times[0]), float(self.times[-1])

    def peak_within(self, duration: float) -> float:
        """Largest |acceleration| from 0 to `duration`, the end of the run [m/s2]."""
        if duration not in self._peaks:
            instants = np.append(self.times, [0.0, duration])  # linear between samples
            inside = instants[(instants >= 0.0) & (instants <= duration)]
            self._peaks[duration] = float(np.abs(self.evaluate(inside)[2]).max())
        return self._peaks[duration]

    @cached_property
    def _peaks(self) -> dict[float, float]:
        """Those asked for, by duration."""
        return {}

    def compiled(self) -> FloorMotion:
        return self._compiled

    @cached_property
    def _compiled(self) -> FloorMotion:
        x, v, a = sampled_motion(self.times, self.values, self.quantity)
        jerk = np.append(np.diff(a) / np.diff(self.times), 0.0)
        rows = np.column_stack([x, v, a, jerk])
        before, after = rows[:1].copy(), rows[-1:].copy()
        before[0, 2:] = after[0, 2:] = 0.0
        return as_floor_motion(
            PIECEWISE, breaks=self.times, coefficients=np.concatenate([before, rows[:-1], after])
        )

    def evaluate(self, times: FloatArray) -> FloatArray:
        return floor_history(self.compiled(), times)
