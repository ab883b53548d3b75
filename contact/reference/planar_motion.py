"""Result of a planar block: modes, changes of state, impacts, and samples of its motion.

Rotation and slip are positive toward +x; slip is that of the loaded corners over the floor, so that rocking
alone does not slip.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from contact.arrays import FloatArray
from contact.reference.event_driven import Piece, sample


class PlanarMode(Enum):
    """Mode of a planar block at an instant, or the reason for which the integration ends."""

    REST, SLIDE, ROCK, SLIDE_ROCK = "rest", "slide", "rock", "slide-rock"
    OVERTURNED = "overturned"
    OUTSIDE = "outside the model"  #: it left the floor, or contact forces are not unique


@dataclass(frozen=True, kw_only=True)
class PlanarState:
    """A mode with its corner and direction of sliding."""

    mode: PlanarMode
    side: int = 0  #: +1 right corner, -1 left, 0 the base lies on the floor
    direction: int = 0  #: sign of the slip velocity; 0: sticks


@dataclass(frozen=True, kw_only=True)
class PlanarTransition:
    """A state is entered."""

    time: float  #: [s]
    state: PlanarState
    reason: str  #: the event that led to it


@dataclass(frozen=True, kw_only=True)
class PlanarImpact:
    """A corner meets the floor."""

    time: float  #: [s]
    velocity_before: float  #: angular velocity, positive toward +x [rad/s]
    velocity_after: float  #: [rad/s]
    slip_velocity_before: float  #: [m/s]
    slides: bool  #: the friction impulse stood at its limit


@dataclass(frozen=True, kw_only=True)
class PlanarMotion:
    """Motion of a planar block."""

    transitions: tuple[PlanarTransition, ...]
    impacts: tuple[PlanarImpact, ...]
    peaks: tuple[tuple[float, float], ...]  #: turning points: time [s], rotation [rad]
    end: float  #: duration asked for, or when it overturned or left the model [s]
    largest_rotation: float  #: largest |rotation| [rad]
    pieces: tuple[Piece, ...]
    states: tuple[PlanarState, ...]  #: numbered by the regimes of the pieces

    @property
    def modes(self) -> frozenset[PlanarMode]:
        """Every mode seen."""
        return frozenset(transition.state.mode for transition in self.transitions)

    @property
    def outcome(self) -> PlanarMode:
        """Overturned or outside the model if it ended so, else the most general mode."""
        last = self.transitions[-1].state.mode
        if last in (PlanarMode.OVERTURNED, PlanarMode.OUTSIDE):
            return last
        if PlanarMode.SLIDE_ROCK in self.modes or {PlanarMode.SLIDE, PlanarMode.ROCK} <= self.modes:
            return PlanarMode.SLIDE_ROCK
        return next((m for m in (PlanarMode.SLIDE, PlanarMode.ROCK) if m in self.modes), PlanarMode.REST)

    @property
    def first_motion(self) -> PlanarMode:
        """The first mode that is not rest; rest if there is none."""
        modes = (transition.state.mode for transition in self.transitions)
        return next((mode for mode in modes if mode is not PlanarMode.REST), PlanarMode.REST)

    def at(self, times: FloatArray) -> "PlanarHistory":
        """The motion at given times, nan and None after the end."""
        values, regimes = sample(self.pieces, np.asarray(times, dtype=float), 4)
        sides = np.array([*(state.side for state in self.states), 0])[regimes]
        modes = [self.states[number].mode if number >= 0 else None for number in regimes]
        return PlanarHistory(
            rotation=sides * values[:, 2],
            angular_velocity=sides * values[:, 3],
            slip=values[:, 0],
            slip_velocity=values[:, 1],
            modes=tuple(modes),
        )


@dataclass(frozen=True, kw_only=True)
class PlanarHistory:
    """Samples of a planar motion; every array has the shape of the times asked for."""

    rotation: FloatArray  #: [rad]
    angular_velocity: FloatArray  #: [rad/s]
    slip: FloatArray  #: [m]
    slip_velocity: FloatArray  #: [m/s]
    modes: tuple[PlanarMode | None, ...]
