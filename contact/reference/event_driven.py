"""Event-driven integration: smooth motion between the instants at which its equations change.

A regime (resting, rocking about a corner, sliding) has a rate and guards. A guard is a margin that is
positive while the regime lasts. The motion is integrated until the first margin falls below zero, and the
instant is found to rounding on the interpolant of the step. Between two events and between two breaks of the
floor acceleration the right-hand side is smooth, so that the eighth-order Runge-Kutta formula of Dormand
and Prince (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.5) keeps its order.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from contact.arrays import FloatArray
from contact.reference.floor_acceleration import Acceleration, FloorAcceleration, FloorSegment

Rate = Callable[[FloatArray, Acceleration], FloatArray]  #: state, floor acceleration -> time derivative
Margin = Callable[[FloatArray, Acceleration], float]  #: state, floor acceleration -> positive while it holds
Interpolant = Callable[[float | FloatArray], FloatArray]  #: time -> state, times in the last axis

RELATIVE_TOLERANCE = 1e-12
MAX_EVENTS = 100_000  #: of a motion
#: share of the overturning energy: an impact that leaves less in a rotation ends it, where it can; it would otherwise
#: end only after infinitely many impacts
REST_ENERGY = 1e-10
SAMPLES_PER_STEP = 8  #: sub-intervals of a step at which margins are evaluated


class EventError(RuntimeError):
    """The event-driven integration failed."""


@dataclass(frozen=True, kw_only=True)
class Guard:
    """Condition that ends a regime."""

    name: str
    margin: Margin


@dataclass(frozen=True, kw_only=True)
class Piece:
    """One accepted step, cut off at the event that ended it."""

    start: float  #: [s]
    end: float  #: [s]
    regime: int  #: the regime it belongs to, as the caller numbers them
    interpolant: Interpolant


@dataclass(frozen=True, kw_only=True)
class Passage:
    """The motion through one regime."""

    pieces: tuple[Piece, ...]
    time: float  #: of the event, or the end asked for [s]
    state: FloatArray  #: at that time
    event: str | None  #: name of the guard that fell, None if the end was reached


def flow(
    *,
    rate: Rate | None,
    guards: Sequence[Guard],
    state: FloatArray,
    start: float,
    end: float,
    floor: FloorAcceleration,
    scale: FloatArray,
    regime: int,
    first_step: float | None = None,
) -> Passage:
    """Follow one regime until a guard falls or the end is reached.

    Args:
        rate: right-hand side; None for a body at rest, whose state (n,) does not change.
        guards: what ends the regime.
        scale: size of each component of the state (n,); errors are kept at 1e-12 of the larger of 1 % of this and
            the component itself.
        regime: kept with every piece.
        first_step: guess of the first step [s]; a short one keeps brief hops from being stepped over.

    Raises:
        EventError: the step size fell to rounding.
    """
    pieces: list[Piece] = []
    for segment in floor.segments(start, end):
        if rate is None or segment.start > start:  # the acceleration may have jumped across a limit
            here = segment.acceleration(segment.start)
            for guard in guards:
                if guard.margin(state, here) < 0.0:
                    return Passage(pieces=tuple(pieces), time=segment.start, state=state, event=guard.name)
        if rate is None:
            steps = _rest(state, segment, floor)
        else:
            steps = _steps(rate, state, segment, floor, scale, first_step)
        for step_start, step_end, interpolant in steps:
            crossing = first_crossing(guards, interpolant, segment.acceleration, step_start, step_end)
            time = step_end if crossing is None else crossing[0]
            pieces.append(Piece(start=step_start, end=time, regime=regime, interpolant=interpolant))
            state = interpolant(time)
            if crossing is not None:
                return Passage(pieces=tuple(pieces), time=time, state=state, event=crossing[1])
        first_step = None
    return Passage(pieces=tuple(pieces), time=end, state=state, event=None)


def first_crossing(
    guards: Sequence[Guard],
    interpolant: Interpolant,
    acceleration: Callable[[float], Acceleration],
    start: float,
    end: float,
) -> tuple[float, str] | None:
    """The first instant after `start` at which a margin has fallen below zero, on its far side, and whose.

    Margins are sampled inside the step, and a dip between samples is looked into, so that a limit which is
    exceeded for a moment only is not missed.
    """
    earliest: tuple[float, str] | None = None
    times = np.linspace(start, end, SAMPLES_PER_STEP + 1)
    states = np.asarray(interpolant(times)).T
    accelerations = [acceleration(float(t)) for t in times]
    for guard in guards:

        def value(time: float, guard: Guard = guard) -> float:
            return guard.margin(interpolant(time), acceleration(time))

        sampled = np.array([guard.margin(y, a) for y, a in zip(states, accelerations, strict=True)])
        bracket = _bracket(value, times, sampled)
        if bracket is None:
            continue
        time = _far_side(value, *bracket)
        if earliest is None or time < earliest[0]:
            earliest = time, guard.name
    return earliest


def sample(pieces: Sequence[Piece], times: FloatArray, size: int) -> tuple[FloatArray, NDArray[np.int64]]:
    """States (n, size) and regimes (n,) at given times; nan and -1 where the motion had not begun or had ended.

    At an event the state after it is given, at the end the last one.
    """
    states = np.full((times.size, size), np.nan)
    regimes = np.full(times.size, -1, dtype=np.int64)
    starts = np.array([piece.start for piece in pieces])
    index = np.searchsorted(starts, times, side="right") - 1
    for number in np.unique(index):
        if number < 0:
            continue
        piece = pieces[int(number)]
        chosen = (index == number) & (times <= piece.end)
        states[chosen] = np.asarray(piece.interpolant(times[chosen])).T
        regimes[chosen] = piece.regime
    return states, regimes


def turning_point(piece: Piece, *, component: int) -> tuple[float, FloatArray] | None:
    """Time [s] and state at which this component of the state falls through zero within a piece, or None."""

    def rate(time: float) -> float:
        return float(piece.interpolant(time)[component])

    if not rate(piece.start) > 0.0 >= rate(piece.end):
        return None
    time = float(brentq(rate, piece.start, piece.end, xtol=1e-15))
    return time, piece.interpolant(time)


def _steps(
    rate: Rate,
    state: FloatArray,
    segment: FloorSegment,
    floor: FloorAcceleration,
    scale: FloatArray,
    first_step: float | None,
) -> Iterator[tuple[float, float, Interpolant]]:
    solver = DOP853(
        lambda t, y: rate(y, segment.acceleration(t)),
        segment.start,
        state,
        segment.end,
        rtol=RELATIVE_TOLERANCE,
        atol=1e-2 * RELATIVE_TOLERANCE * scale,
        max_step=floor.longest_step,
        first_step=None if first_step is None else min(first_step, segment.end - segment.start),
    )
    while solver.status == "running":
        message = solver.step()
        if solver.status == "failed":
            raise EventError(f"t = {solver.t:.6g} s: {message}; state {solver.y}")
        yield solver.t_old, solver.t, solver.dense_output()


def _rest(
    state: FloatArray, segment: FloorSegment, floor: FloorAcceleration
) -> Iterator[tuple[float, float, Interpolant]]:
    def interpolant(time: float | FloatArray) -> FloatArray:
        return np.multiply.outer(state, np.ones_like(time))

    count = (
        1 if math.isinf(floor.longest_step) else math.ceil((segment.end - segment.start) / floor.longest_step)
    )
    times = np.linspace(segment.start, segment.end, max(count, 1) + 1)
    for start, end in pairwise(times.tolist()):
        yield start, end, interpolant


def _bracket(
    value: Callable[[float], float], times: FloatArray, sampled: FloatArray
) -> tuple[float, float] | None:
    """Two times, the margin not negative at the first and negative at the second, or None."""
    dips = _dips(sampled)
    for k in range(1, times.size):
        if sampled[k - 1] >= 0.0 and k in dips:
            lowest = minimize_scalar(
                value,
                bounds=(times[k - 1], times[k]),
                method="bounded",
                options={"xatol": 1e-12 * (times[k] - times[k - 1])},
            )
            if lowest.fun < 0.0:
                return times[k - 1], float(lowest.x)
        if sampled[k] < 0.0:
            if k == 1 and sampled[0] <= 0.0:
                return _after_start(value, times[0], times[1])
            return (times[k - 1], times[k]) if sampled[k - 1] >= 0.0 else None
    return None


def _dips(sampled: FloatArray) -> set[int]:
    """Sub-intervals in which the parabola through three samples has a minimum near or below zero."""
    dips: set[int] = set()
    for k in range(1, sampled.size - 1):
        before, here, after = sampled[k - 1 : k + 2]
        bend = before - 2.0 * here + after
        if bend <= 0.0 or here < 0.0:
            continue
        vertex = -0.5 * (after - before) / bend
        lowest = here - (after - before) ** 2 / (8.0 * bend)
        if abs(vertex) <= 1.0 and lowest < 0.1 * bend:
            dips.add(k if vertex < 0.0 else k + 1)
    if sampled[0] <= 0.0:  # a margin that starts from zero and rises has no dip there
        dips.discard(1)
    return dips


def _after_start(value: Callable[[float], float], start: float, end: float) -> tuple[float, float]:
    """Bracket for a margin that starts at zero and is negative at `end`: a hop shorter than a sample."""
    upper = end
    for _ in range(60):
        middle = start + 0.5 * (upper - start)
        if value(middle) > 0.0:
            return middle, upper
        upper = middle
    return start, start


def _far_side(value: Callable[[float], float], left: float, right: float) -> float:
    """The crossing, moved on by roundings until the margin is negative."""
    if not right > left:
        return right
    root = float(brentq(value, left, right, xtol=1e-300, rtol=4.0 * np.finfo(float).eps))
    time, shift = root, math.ulp(root)
    while value(time) >= 0.0 and time < right:
        time = min(root + shift, right)
        shift *= 2.0
    return time
