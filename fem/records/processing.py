"""Trim, scale and correct the baseline of a component, and integrate it: linear between samples, as the run takes it.

First the component is trimmed, then scaled by a factor, then its baseline is removed, then it is scaled to a peak.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from contact.motion.samples import sampled_motion
from fem.records.record import Component, RecordError
from fem.runtime.arrays import FloatArray

Baseline = Literal["none", "mean", "linear", "zero-end"]
BASELINES: tuple[Baseline, ...] = get_args(Baseline)
#: changes of a peak by a baseline, over the peak: what is reported (two), and what is refused
SAID_ACCELERATION, SAID_VELOCITY, DOUBTFUL = 0.01, 0.03, 0.2
DEGREE = 5  #: of the acceleration that `zero-end` subtracts: displacements of t^2 to t^7


@dataclass(frozen=True, kw_only=True)
class Processing:
    """What is done to a component before it moves the floor.

    `mean` subtracts the mean over time of the acceleration, so that the floor ends at rest; `linear` the straight line
    fitted by least squares (to the interpolated acceleration, not to the samples), so that the floor ends at rest
    where it began: the fit makes final velocity and displacement zero. `zero-end`: `ZeroEnd`.
    """

    start: float | None = None  #: of the part to take; it becomes t = 0 [s]
    end: float | None = None  #: of the part to take, in the times of the file [s]
    scale: float = 1.0  #: factor
    peak: float | None = None  #: that the largest |acceleration| is scaled to, behind the baseline [m/s2]
    baseline: Baseline = "none"


@dataclass(frozen=True, kw_only=True)
class BaselineChange:
    """Peaks of a motion without its baseline and with it.

    A velocity left at the end of a record is a drift, no motion of the ground. So the velocity is compared with that
    of the motion that `mean` brings to rest: of the two, a pulse is in both and a drift in neither.
    """

    baseline: Baseline
    accelerations: tuple[float, float]  #: largest |a|, of the record and with the baseline removed [m/s2]
    velocities: tuple[float, float]  #: largest |v|, with `mean` and with the baseline removed [m/s]

    @property
    def is_said(self) -> bool:
        """Whether it is large enough to be reported."""
        return _share(self.accelerations) > SAID_ACCELERATION or _share(self.velocities) > SAID_VELOCITY

    @property
    def is_doubtful(self) -> bool:
        """Whether it is so large that it is refused unless allowed."""
        return max(_share(self.accelerations), _share(self.velocities)) > DOUBTFUL

    @property
    def in_words(self) -> str:
        """What it changes, with both values."""
        before, after = self.accelerations
        words = f"{self.baseline!r} changes the peak acceleration from {before:.3g} to {after:.3g} m/s2"
        words += _per_cent(self.accelerations)
        if self.baseline == "mean":
            return words
        before, after = self.velocities
        return (
            f"{words}, and the peak velocity from {before:.3g} m/s with 'mean', which only brings the floor to rest "
            f"and keeps pulses, to {after:.3g} m/s{_per_cent(self.velocities)}"
        )


def trimmed(component: Component, start: float | None, end: float | None) -> Component:
    """The part of a component from `start`, which becomes t = 0, to `end`, in the times of its file [s].

    Accelerations are interpolated at its ends, displacements are not. RecordError: nothing is left of it.
    """
    times, readings = component.times, component.readings
    if start is None and end is None:
        return component
    low = times[0] if start is None else max(start, times[0])
    high = times[-1] if end is None else min(end, times[-1])
    inside = (times >= low) & (times <= high)
    if component.quantity == "acceleration" and low < high:
        ends = np.array([low, high])
        instants = np.unique(np.concatenate([times[inside], ends]))
        readings, times = np.interp(instants, times, readings), instants
    else:
        times, readings = times[inside], readings[inside]
    if times.size < 2:
        raise RecordError(
            f"from start_s to end_s nothing is left of it: its times are {component.times[0]:g} to "
            f"{component.times[-1]:g} s"
        )
    return replace(component, times=times - (start or 0.0), readings=readings)


def processed(component: Component, processing: Processing) -> Component:
    """The component as the floor follows it, in SI. RecordError: nothing remains of it, or a key does not fit."""
    if component.quantity == "velocity":
        raise RecordError("velocities do not move a floor; accelerations or displacements are needed")
    if not math.isfinite(processing.scale):
        raise RecordError(f"scale must be finite, got {processing.scale}")
    if component.quantity == "displacement" and processing.baseline != "none":
        raise RecordError(
            f"baseline {processing.baseline!r} corrects accelerations; displacements take 'none'"
        )
    part = trimmed(component, processing.start, processing.end)
    times, values = part.times, part.readings * (component.factor * processing.scale)
    if component.quantity == "acceleration":
        values = values - _baseline(times, values, processing.baseline)
    if processing.peak is not None:
        largest = float(np.abs(sampled_motion(times, values, component.quantity)[2]).max())
        if largest == 0.0:
            raise RecordError("its accelerations are all zero, so they cannot be scaled to a peak")
        values = values * (processing.peak / largest)
    return replace(part, readings=values, factor=1.0)


def baseline_change(component: Component, processing: Processing) -> BaselineChange | None:
    """What the baseline changes, in the scale of the motion used; None without one. Errors as `processed`."""
    if processing.baseline == "none":
        return None
    plain, level, made = (
        motion_of(processed(component, replace(processing, baseline=baseline, peak=None)))
        for baseline in ("none", "mean", processing.baseline)
    )
    (_, record), (still, _), (velocity, acceleration) = (
        (float(np.abs(v).max()), float(np.abs(a).max())) for _, v, a in (plain, level, made)
    )
    factor = 1.0 if processing.peak is None else abs(processing.peak) / acceleration
    return BaselineChange(
        baseline=processing.baseline,
        accelerations=(factor * record, factor * acceleration),
        velocities=(factor * still, factor * velocity),
    )


def stated_baseline(
    name: str, component: Component, processing: Processing, *, allowed: bool, way_out: str
) -> str | None:
    """What the baseline changes, in words; None where that is too little to be reported.

    RecordError, with the record and the way out: it changes a peak by more than a fifth and is not allowed.
    """
    change = baseline_change(component, processing)
    if change is None or not change.is_said:
        return None
    if change.is_doubtful and not allowed:
        raise RecordError(
            f"{name}: baseline {change.in_words}; a change above {100.0 * DOUBTFUL:.2g} % is refused; {way_out}"
        )
    return change.in_words


def motion_of(component: Component) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Displacement [m], velocity [m/s] and acceleration [m/s2] of the floor at the samples, each of shape (n,)."""
    if component.quantity == "velocity":
        raise RecordError("velocities do not move a floor; accelerations or displacements are needed")
    return sampled_motion(component.times, component.values, component.quantity)


def _baseline(times: FloatArray, a: FloatArray, kind: Baseline) -> FloatArray:
    """Baseline to subtract from a piecewise linear acceleration, at its samples, shape (n,) [m/s2].

    Least squares over time of the linear interpolant: with s in [-1, 1] over the table, the fit is
    m_0/2 + 3 m_1/2 s, where m_0 and m_1 are the exact integrals of a and a s (Legendre polynomials).
    """
    if kind not in BASELINES:
        raise RecordError(f"unknown baseline {kind!r}; known: {', '.join(BASELINES)}")
    if kind == "none":
        return np.zeros_like(a)
    if kind == "zero-end":
        return ZeroEnd(times=times).baseline(a)
    s = (times - 0.5 * (times[0] + times[-1])) / (0.5 * (times[-1] - times[0]))
    steps = np.diff(s)
    m_0 = math.fsum(0.5 * steps * (a[:-1] + a[1:]))
    if kind == "mean":
        return np.full_like(a, 0.5 * m_0)
    # Simpson's rule is exact for the product of two linear functions.
    middle = (a[:-1] + a[1:]) * (s[:-1] + s[1:])
    m_1 = math.fsum(steps / 6.0 * (a[:-1] * s[:-1] + middle + a[1:] * s[1:]))
    return 0.5 * m_0 + 1.5 * m_1 * s


@dataclass(frozen=True, kw_only=True, eq=False)
class ZeroEnd:
    """Baselines that bring the floor to rest where it began, of all motions with the same times.

    Subtracted is the polynomial of degree 5 whose displacement fits that of the motion best (least squares over time)
    among those that end with its velocity and displacement. Every polynomial is interpolated linearly between samples
    and integrated as the motion is, so that both end at zero to the rounding of these sums, whatever the interval.
    """

    times: FloatArray  #: rising, shape (n,) [s]

    def baseline(self, acceleration: FloatArray) -> FloatArray:
        """What to subtract from an acceleration (n,), shape (n,) [m/s2]."""
        (shapes, of_displacement, of_ends), length = self._fit, float(self.times[-1] - self.times[0])
        x, v, _ = sampled_motion(self.times, acceleration, "acceleration")
        ends = np.array([x[-1] / length**2, v[-1] / length])
        return np.asarray(shapes @ (of_displacement @ x + of_ends @ ends))

    @cached_property
    def _fit(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Polynomials at the samples (n, 6), and their coefficients as linear functions of displacements (6, n), and of
        displacement and velocity at the end over the length squared and the length (6, 2)."""
        times, length = self.times, float(self.times[-1] - self.times[0])
        s = (times - 0.5 * (times[0] + times[-1])) / (0.5 * length)
        shapes = np.asarray(np.polynomial.legendre.legvander(s, DEGREE), dtype=np.float64)
        integrals = [sampled_motion(times, shape, "acceleration")[:2] for shape in shapes.T]
        ends = np.array([[x[-1] / length**2, v[-1] / length] for x, v in integrals]).T
        # What meets the constraints, and of all that changes nothing about them, the best fit.
        meets, free = np.linalg.pinv(ends), np.linalg.svd(ends)[2][2:].T
        steps = np.diff(times)
        weights = np.sqrt(0.5 * (np.append(steps, 0.0) + np.append(0.0, steps)))
        moved = np.array([x for x, _ in integrals]).T * weights[:, None]
        best = free @ np.linalg.pinv(moved @ free)
        return shapes, best * weights, meets - best @ (moved @ meets)


def _share(peaks: tuple[float, float]) -> float:
    """Change of a peak over its first value."""
    before, after = peaks
    return abs(after / before - 1.0) if before else 0.0


def _per_cent(peaks: tuple[float, float]) -> str:
    before, after = peaks
    return f" ({100.0 * (after / before - 1.0):+.2g} %)" if before else ""
