"""The rigid block that rocks on its corners without sliding: the reference for the rigid limit.

Large rotation, any floor acceleration, impacts by restitution; between impacts the equation of motion is
integrated to 1e-12 and impacts, uplift and overturning are located to rounding. Rotation is positive
toward +x (about the right corner); a floor that accelerates toward +x tilts the block toward -x:

    rotation'' = -p^2 [(1 + a_v/g) sin(s al - rotation) + (a_g/g) cos(s al - rotation)],   s = sign of the rotation.

A floor that falls with more than g leaves the block, and the motion ends there.

Housner, BSSA 53 (1963); Yim, Chopra, Penzien, Earthquake Engng Struct. Dyn. 8 (1980).
"""

import math
from dataclasses import dataclass

import numpy as np

from contact.arrays import FloatArray
from contact.reference.event_driven import (
    MAX_EVENTS,
    REST_ENERGY,
    EventError,
    Guard,
    Piece,
    Rate,
    flow,
    sample,
    turning_point,
)
from contact.reference.floor_acceleration import Acceleration, FloorAcceleration
from contact.reference.planar_block import PlanarImpact, PlanarMode
from contact.reference.rigid_block import RigidBlock


@dataclass(frozen=True, kw_only=True)
class RockingPeak:
    """A turning point away from the vertical; the start of a motion is none."""

    time: float  #: [s]
    rotation: float  #: positive toward +x [rad]


@dataclass(frozen=True, kw_only=True)
class RockingMotion:
    """Motion of a block that cannot slide."""

    restitution: float  #: used at every impact [-]
    outcome: PlanarMode
    impacts: tuple[PlanarImpact, ...]
    peaks: tuple[RockingPeak, ...]
    uplifts: tuple[float, ...]  #: instants at which the block left the rest on its base [s]
    end: float  #: duration asked for, or earlier: overturned, left the floor, stopped at the first impact [s]
    overturned_at: float | None  #: rotation of 90 degrees reached [s]
    largest_rotation: float  #: largest |rotation| [rad]
    pieces: tuple[Piece, ...]

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Rotation [rad] and angular velocity [rad/s] at given times, nan after the end.

        At an impact the velocity after it is given.
        """
        states, sides = sample(self.pieces, np.asarray(times, dtype=float), 2)
        sign = np.where(sides < 0, 0, sides - 1)  # regimes are numbered 0, 1, 2 for s = -1, 0, +1
        return sign * states[:, 0], sign * states[:, 1]


def simulate_rocking(
    block: RigidBlock,
    floor: FloorAcceleration,
    *,
    duration: float,
    rotation: float = 0.0,
    angular_velocity: float = 0.0,
    restitution: float | None = None,
    rest_energy: float = REST_ENERGY,
    stop_at_impact: bool = False,
) -> RockingMotion:
    """Follow the block until it has overturned (90 degrees) or the duration [s] is over.

    Args:
        rotation: at the start, positive about the right corner [rad].
        angular_velocity: at the start; at rotation 0 its sign chooses the corner [rad/s].
        restitution: ratio of angular velocities at impact, 0 to 1; None: Housner's, and 0 where his is
            negative (the block then comes to lie on its base).
        rest_energy: an impact that leaves less than this share of the overturning energy ends in rest, where rest is
            possible: the impacts of free rocking would otherwise accumulate (Zeno).
        stop_at_impact: end at the first impact, to look at a first swing alone.

    Raises:
        ValueError: restitution outside 0 to 1, a start beyond 90 degrees, a duration that is not positive.
        EventError: more than 100 000 impacts and uplifts.
    """
    used = max(block.housner_restitution, 0.0) if restitution is None else restitution
    if not 0.0 < duration < math.inf:
        raise ValueError(f"rocking: duration must be positive and finite, got {duration} s")
    if not abs(rotation) < 0.5 * math.pi:
        raise ValueError(f"rocking: the start must lie below 90 degrees, got {rotation} rad")
    if not 0.0 <= used <= 1.0:
        raise ValueError(f"rocking: restitution must lie between 0 and 1, got {used}")
    scale = np.array([block.slenderness_angle, block.slenderness_angle * block.frequency_parameter])
    inertia = block.inertia_ratio * block.radius**2
    least_velocity = math.sqrt(2.0 * rest_energy * block.overturning_energy / inertia)
    pieces: list[Piece] = []
    impacts: list[PlanarImpact] = []
    uplifts: list[float] = []
    overturned_at = None
    left = False

    time, side = 0.0, int(np.sign(rotation)) or int(np.sign(angular_velocity))
    state = side * np.array([rotation, angular_velocity])  # angle from the base, and its rate
    for _ in range(MAX_EVENTS):
        passage = flow(
            rate=_rate(block, side) if side else None,
            guards=_guards(block, side),
            state=state,
            start=time,
            end=duration,
            floor=floor,
            scale=scale,
            regime=side + 1,
            first_step=_first_step(block, side, state, floor.just_after(time)),
        )
        pieces.extend(passage.pieces)
        time, state = passage.time, passage.state
        if passage.event is None:
            break
        if passage.event == "overturned":
            overturned_at = time
            break
        if passage.event == "leaves the floor":
            left = True
            break
        acceleration = floor.just_after(time)
        if passage.event == "uplift":
            uplifts.append(time)
            side, state = -int(np.sign(acceleration.x)), np.zeros(2)
            continue
        before = float(state[1])
        after = -used * before
        stays = after < least_velocity and _rest_margin(block, acceleration) >= 0.0
        after = 0.0 if stays else after
        impacts.append(PlanarImpact(time=time, velocity_before=side * before, velocity_after=-side * after))
        if stop_at_impact:
            break
        side = 0 if after == 0.0 else -side  # the rest looks at once whether it holds
        state = np.array([0.0, after])
    else:
        raise EventError(f"t = {time:.6g} s: {MAX_EVENTS} impacts and uplifts; try a larger rest_energy")

    turns = ((piece.regime - 1, turning_point(piece, component=1)) for piece in pieces)
    peaks = tuple(
        RockingPeak(time=turn[0], rotation=side * float(turn[1][0]))
        for side, turn in turns
        if turn is not None
    )
    ends = [abs(float(piece.interpolant(t)[0])) for piece in pieces for t in (piece.start, piece.end)]
    largest = max([*ends, *(abs(peak.rotation) for peak in peaks)])
    moved = bool(impacts or uplifts or rotation or angular_velocity)
    if overturned_at is not None:
        outcome = PlanarMode.OVERTURNED
    elif left:
        outcome = PlanarMode.OUTSIDE
    else:
        outcome = PlanarMode.ROCK if moved else PlanarMode.REST
    return RockingMotion(
        restitution=used,
        outcome=outcome,
        impacts=tuple(impacts),
        peaks=peaks,
        uplifts=tuple(uplifts),
        end=time,
        overturned_at=overturned_at,
        largest_rotation=largest,
        pieces=tuple(pieces),
    )


def _rate(block: RigidBlock, side: int) -> Rate:
    squared, slenderness, gravity = block.frequency_parameter**2, block.slenderness_angle, block.gravity

    def rate(state: FloatArray, acceleration: Acceleration) -> FloatArray:
        lean = slenderness - state[0]
        weight = 1.0 + acceleration.z / gravity
        pull = weight * math.sin(lean) + side * acceleration.x / gravity * math.cos(lean)
        return np.array([state[1], -squared * pull])

    return rate


def _rest_margin(block: RigidBlock, acceleration: Acceleration) -> float:
    """Margin of the floor acceleration for rest on the whole base [m/s2]."""
    return block.uplift_acceleration * (1.0 + acceleration.z / block.gravity) - abs(acceleration.x)


def _guards(block: RigidBlock, side: int) -> tuple[Guard, ...]:
    leaves = Guard(name="leaves the floor", margin=lambda state, a: block.gravity + a.z)
    if side == 0:
        return (leaves, Guard(name="uplift", margin=lambda state, a: _rest_margin(block, a)))
    return (
        leaves,
        Guard(name="impact", margin=lambda state, a: float(state[0])),
        Guard(name="overturned", margin=lambda state, a: 0.5 * math.pi - float(state[0])),
    )


def _first_step(block: RigidBlock, side: int, state: FloatArray, acceleration: Acceleration) -> float | None:
    """A step well inside the hop that follows an impact [s]."""
    if side == 0 or state[0] > 0.0:
        return None
    fall = abs(_rate(block, side)(state, acceleration)[1])
    longest = 0.01 / block.frequency_parameter
    return min(longest, 0.5 * state[1] / fall) if fall > 0.0 and state[1] > 0.0 else longest
