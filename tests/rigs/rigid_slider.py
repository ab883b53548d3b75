"""The rigid slider: Coulomb friction with distinct coefficients and true sticking, event-driven.

A body that does not rotate on a floor with acceleration a_g, in the frame of the floor. It sticks while
|a_g| <= mu_s g; it slides with slip'' = -a_g - mu_k g sign(slip'); where the slip velocity vanishes it sticks
again if it can. On a floor that moves up and down g is g + a_v; one that falls with more than g leaves the body, and
the motion ends there. Slip is positive toward +x. The law is set-valued: no creep, no regularisation.
Den Hartog, Trans. ASME APM-53-9 (1931); Westermo and Udwadia, Earthquake Engng Struct. Dyn. 11 (1983).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray
from contact.reference.event_driven import MAX_EVENTS, EventError, Guard, Piece, flow, sample
from contact.reference.floor_acceleration import Acceleration, FloorAcceleration


@dataclass(frozen=True, kw_only=True)
class RigidSlider:
    """Friction between a sliding body and the floor."""

    mu_static: float  #: [-]
    mu_kinetic: float  #: [-]
    gravity: float  #: [m/s2]


class SlipInterval(NamedTuple):
    """An interval in which the body sticks, or slides in one direction."""

    start: float  #: [s]
    end: float  #: [s]
    direction: int  #: +1 and -1: slides toward +x and -x; 0: sticks


@dataclass(frozen=True, kw_only=True)
class SlidingMotion:
    """Motion of a slider."""

    intervals: tuple[SlipInterval, ...]
    end: float  #: duration asked for, or when it left the floor [s]
    pieces: tuple[Piece, ...]

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Slip [m] and slip velocity [m/s] at given times, nan after the end."""
        states, _ = sample(self.pieces, np.asarray(times, dtype=float), 2)
        return states[:, 0], states[:, 1]

    @property
    def largest_slip(self) -> float:
        """Largest |slip| [m]."""
        return float(np.abs(self._extremes(0.0, self.end)).max())

    def peak_to_peak(self, start: float, end: float) -> float:
        """Largest minus smallest slip between two times [m]; over the last period: the steady one."""
        return float(np.ptp(self._extremes(start, end)))

    def _extremes(self, start: float, end: float) -> FloatArray:
        turns = [t for i in self.intervals for t in (i.start, i.end) if start < t < end]
        return self.at(np.array([start, *turns, end]))[0]


def simulate_sliding(
    slider: RigidSlider, floor: FloorAcceleration, *, duration: float, slip_velocity: float = 0.0
) -> SlidingMotion:
    """Integrate the motion of a slider that starts at slip 0.

    `slip_velocity`: body minus floor at the start [m/s]; a body at rest on a floor that starts with velocity v has -v.
    """
    pieces: list[Piece] = []
    intervals: list[SlipInterval] = []
    scale = np.array([1e-2, 1e-2])
    time, state = 0.0, np.array([0.0, slip_velocity])
    direction = int(np.sign(slip_velocity))
    for _ in range(MAX_EVENTS):

        def slides(state: FloatArray, acceleration: Acceleration, way: int = direction) -> FloatArray:
            friction = -way * slider.mu_kinetic * (slider.gravity + acceleration.z)
            return np.array([state[1], friction - acceleration.x])

        passage = flow(
            rate=slides if direction else None,
            guards=_guards(slider, direction),
            state=state,
            start=time,
            end=duration,
            floor=floor,
            scale=scale,
            regime=direction + 1,
        )
        pieces.extend(passage.pieces)
        if passage.time > time:
            intervals.append(SlipInterval(time, passage.time, direction))
        time, state = passage.time, passage.state
        if passage.event in (None, "leaves the floor"):
            break
        if passage.event == "breaks loose":
            direction = -int(np.sign(floor.just_after(time).x))
        else:
            state = np.array([state[0], 0.0])
            direction = 0  # the next interval checks at once whether it sticks
    else:
        raise EventError(f"t = {time:.6g} s: {MAX_EVENTS} changes between sticking and sliding")
    return SlidingMotion(intervals=tuple(intervals), end=time, pieces=tuple(pieces))


def _guards(slider: RigidSlider, direction: int) -> tuple[Guard, ...]:
    leaves = Guard(name="leaves the floor", margin=lambda state, a: slider.gravity + a.z)
    if direction == 0:

        def holds(state: FloatArray, acceleration: Acceleration) -> float:
            return slider.mu_static * (slider.gravity + acceleration.z) - abs(acceleration.x)

        return (leaves, Guard(name="breaks loose", margin=holds))
    return (leaves, Guard(name="stops", margin=lambda state, a: direction * float(state[1])))
