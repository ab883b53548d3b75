"""Floor accelerations for the analytic references, with the instants of jumps and kinks.

Positive toward +x, and upward. The references use the frame of the floor, so they need the accelerations only: in that
frame gravity is g + a_v, with a_v the vertical acceleration. The velocity at the start is the initial slip velocity of
the block.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple


class Acceleration(NamedTuple):
    """Acceleration of the floor at an instant."""

    x: float  #: positive toward +x [m/s2]
    z: float = 0.0  #: positive upward [m/s2]


def _still(time: float) -> float:
    return 0.0


@dataclass(frozen=True, kw_only=True)
class FloorSegment:
    """An interval without a break inside; at its ends the acceleration is the one-sided limit."""

    start: float  #: [s]
    end: float  #: [s]
    first: float  #: earliest time at which the function is evaluated [s]
    last: float  #: latest time at which the function is evaluated [s]
    function: Callable[[float], float]
    vertical: Callable[[float], float] = _still

    def acceleration(self, time: float) -> Acceleration:
        """Floor acceleration at a time of the segment, ends included [m/s2]."""
        inside = min(max(time, self.first), self.last)
        return Acceleration(float(self.function(inside)), float(self.vertical(inside)))


@dataclass(frozen=True, kw_only=True)
class FloorAcceleration:
    """A floor acceleration as a function of time, smooth between its breaks; ValueError where these do not increase."""

    function: Callable[[float], float]  #: time [s] -> acceleration, positive toward +x [m/s2]
    break_times: tuple[float, ...] = ()  #: increasing instants of jumps and kinks [s]
    longest_step: float  #: an eighth of a period; inf if piecewise linear [s]
    vertical: Callable[[float], float] = _still  #: time [s] -> acceleration, positive upward [m/s2]

    def __post_init__(self) -> None:
        if not all(math.isfinite(t) for t in self.break_times):
            raise ValueError("floor acceleration: break times must be finite [s]")
        for earlier, later in pairwise(self.break_times):
            if not later > earlier:
                raise ValueError(f"floor acceleration: break times must increase, got {earlier} s, {later} s")
        if not self.longest_step > 0.0:
            raise ValueError(f"floor acceleration: longest_step must be positive, got {self.longest_step} s")

    def with_vertical(self, vertical: "FloorAcceleration") -> "FloorAcceleration":
        """This motion along x together with another one, positive upward."""
        return replace(
            self,
            vertical=vertical.function,
            break_times=tuple(sorted({*self.break_times, *vertical.break_times})),
            longest_step=min(self.longest_step, vertical.longest_step),
        )

    def on_slope(self, downhill: float) -> "FloorAcceleration":
        """This motion along a slope, for a block with the gravity toward it; `downhill`: gravity along it [m/s2].

        In the frame of the floor, gravity downhill (> 0: toward +x) is an acceleration of the floor uphill.
        """
        level = self.function
        return replace(self, function=lambda time: level(time) - downhill)

    def segments(self, start: float, end: float) -> Iterator[FloorSegment]:
        """The intervals between breaks from start to end [s]."""
        inner = [t for t in self.break_times if start < t < end]
        breaks = set(self.break_times)
        for left, right in pairwise([start, *inner, end]):
            # a few rounding errors inside, so that a pulse given as `start <= t < end` is evaluated on the right side
            nudge = 1e-14 * max(abs(left), abs(right), right - left)
            first = left + nudge if left in breaks else left
            last = right - nudge if right in breaks else right
            yield FloorSegment(
                start=left,
                end=right,
                first=first,
                last=last,
                function=self.function,
                vertical=self.vertical,
            )

    def just_after(self, time: float) -> Acceleration:
        """Acceleration immediately after a time, the limit from the right at a break [m/s2]."""
        later = next((t for t in self.break_times if t > time), math.inf)
        segment = next(self.segments(time, min(later, time + 1.0)))
        return segment.acceleration(time)
