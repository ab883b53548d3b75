"""Two rigid blocks, one on the other, that rock without sliding: the reference for the patterns of a loose stack.

Rotations are those of the two blocks against the floor, positive toward +x; the state is (rotation of the lower block,
its rate, rotation of the upper block, its rate). A side tells how an interface stands: +1 open and turning on its right
end, -1 on its left end, 0 closed. The interface between the blocks is the part of their faces that they share, so that
its ends are corners of the narrower block. Frame of the floor: its acceleration is a body force, and gravity g + a_v.

Lagrange's equations with exact geometry: r_1 and r_P from the foot to the lower mass centre and to the end P of the
joint, r_2 from P to the upper mass centre, B = r_P . r_2, B' = dB/d(rotation of the upper block):

    (I_1 + m_1 r_1^2 + m_2 r_P^2) th_1'' + m_2 B th_2'' + m_2 B' th_2'^2 = Q_1
                 m_2 B th_1'' + (I_2 + m_2 r_2^2) th_2'' - m_2 B' th_1'^2 = Q_2

Between events they are integrated to 1e-12. An interface opens when a normal force that holds it closed becomes
negative. When an interface closes the impact is plastic, everywhere at once: of the footings on which the stack may go
on, that one follows whose impulses push and whose interfaces do not close further. It is unique, being the projection
of the velocities before the impact on those that are admissible, in the metric of the kinetic energy (Moreau 1988);
likewise the accelerations at an opening (Gauss). A stack both of whose ends would leave an interface is outside the
model.

Psycharis, Dynamic behaviour of rocking two-block assemblies, Earthquake Engng Struct. Dyn. 19 (1990) 555; Spanos,
Roussis, Politopoulos, Dynamic analysis of stacked rigid blocks, Soil Dyn. Earthquake Engng 21 (2001) 559.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import NamedTuple, Self

import numpy as np

from contact.arrays import FloatArray
from contact.reference.event_driven import MAX_EVENTS, REST_ENERGY, EventError, Guard, Piece, flow, sample
from contact.reference.floor_acceleration import Acceleration, FloorAcceleration

ROUNDING = 1e-9  #: share of a force, impulse or rate that counts as none


class Pattern(Enum):
    """How a stack of two blocks moves."""

    REST = "rest"
    AS_ONE = "as one"
    UPPER_ALONE = "upper alone"
    SAME_WAY = "both the same way"
    OPPOSITE_WAYS = "opposite ways"


class Footing(NamedTuple):
    """The ends on which the blocks turn; 0: the interface is closed."""

    base: int  #: of the lower block on the floor
    joint: int  #: of the upper block on the lower one

    @property
    def pattern(self) -> Pattern:
        """The pattern of motion."""
        if not self.base:
            return Pattern.UPPER_ALONE if self.joint else Pattern.REST
        if not self.joint:
            return Pattern.AS_ONE
        return Pattern.SAME_WAY if self.joint == self.base else Pattern.OPPOSITE_WAYS


class Normals(NamedTuple):
    """Normal forces or impulses at the ends of the interfaces, compression positive [N] or [Ns]."""

    base_left: float
    base_right: float
    joint_left: float
    joint_right: float


Vector = complex  #: x + i z


def dot(one: Vector, other: Vector) -> float:
    """The scalar product."""
    return one.real * other.real + one.imag * other.imag


def turned(vector: Vector, rotation: float) -> Vector:
    """The vector turned toward +x by an angle [rad]."""
    return vector * complex(math.cos(rotation), -math.sin(rotation))


def swept(arm: Vector) -> Vector:
    """Velocity of the tip of an arm that turns toward +x at 1 rad/s."""
    return complex(arm.imag, -arm.real)


@dataclass(frozen=True, kw_only=True)
class StackedBlock:
    """A rigid block of a stack; every quantity is positive."""

    half_width: float  #: [m]
    height: float  #: [m]
    mass: float  #: [kg]
    centroid_height: float  #: of the mass centre above its base [m]
    inertia: float  #: about the mass centre [kg m2]

    @classmethod
    def homogeneous(cls, *, width: float, height: float, mass: float) -> Self:
        """A homogeneous rectangle [m, kg]."""
        inertia = mass * (width**2 + height**2) / 12.0
        return cls(
            half_width=0.5 * width, height=height, mass=mass, centroid_height=0.5 * height, inertia=inertia
        )


@dataclass(frozen=True, kw_only=True)
class TwoBlockStack:
    """Two blocks on a floor that they cannot slide on, the upper mass centre over the face that they share."""

    lower: StackedBlock
    upper: StackedBlock
    gravity: float  #: [m/s2]
    offset: float = 0.0  #: of the axis of the upper block from that of the lower one, along x [m]

    def joint_end(self, side: int) -> float:
        """Distance of an end of the joint from the axis of the lower block, along x [m]."""
        return side * min(self.lower.half_width, self.upper.half_width + side * self.offset)

    @property
    def mass(self) -> float:
        """Of both [kg]."""
        return self.lower.mass + self.upper.mass

    def force(self, floor: Acceleration) -> Vector:
        """Body force per mass in the frame of the floor [m/s2]."""
        return complex(-floor.x, -self.gravity - floor.z)

    @property
    def least_rate(self) -> float:
        """Rate of the upper block about an end of the joint with a share of the energy that tips it over [rad/s]."""
        upper = self.upper
        arm = min(abs(self.joint_end(side) - self.offset) for side in (1, -1))
        radius = math.hypot(arm, upper.centroid_height)
        tipping = upper.mass * self.gravity * (radius - upper.centroid_height)
        return math.sqrt(2.0 * REST_ENERGY * tipping / (upper.inertia + upper.mass * radius**2))


class Geometry(NamedTuple):
    """Vectors of a pose with the ends on which the blocks turn [m]."""

    foot: Vector  #: from the middle of the base at rest
    lower: Vector  #: from the foot to the lower mass centre
    joint: Vector  #: from the foot to the end of the joint
    upper: Vector  #: from there to the upper mass centre


class Motion(NamedTuple):
    """Velocities, or accelerations, of the two bodies."""

    lower: Vector  #: of the lower mass centre
    lower_spin: float
    upper: Vector
    upper_spin: float


def geometry(stack: TwoBlockStack, footing: Footing, state: FloatArray) -> Geometry:
    """The vectors of a pose; a closed interface is measured from its right end."""
    side, rotation, upper = footing.base or 1, float(state[0]), float(state[2])
    foot = side * stack.lower.half_width
    end = stack.joint_end(footing.joint or 1)
    return Geometry(
        foot=complex(foot, 0.0),
        lower=turned(complex(-foot, stack.lower.centroid_height), rotation),
        joint=turned(complex(end - foot, stack.lower.height), rotation),
        upper=turned(complex(stack.offset - end, stack.upper.centroid_height), upper),
    )


def velocities(stack: TwoBlockStack, footing: Footing, state: FloatArray) -> Motion:
    """Velocities of the mass centres relative to the floor, and the rates of rotation."""
    here, rate, upper = geometry(stack, footing, state), float(state[1]), float(state[3])
    return Motion(rate * swept(here.lower), rate, rate * swept(here.joint) + upper * swept(here.upper), upper)


def angular_accelerations(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, floor: Acceleration
) -> tuple[float, float]:
    """Angular accelerations of the lower and the upper block [rad/s2]."""
    here, force = geometry(stack, footing, state), stack.force(floor)
    first, second = stack.lower.mass, stack.upper.mass
    bend = second * dot(here.joint, swept(here.upper))
    lower = first * dot(swept(here.lower), force) + second * dot(swept(here.joint), force)
    upper = second * dot(swept(here.upper), force)
    loads = lower - bend * float(state[3]) ** 2, upper + bend * float(state[1]) ** 2
    return _solved(stack, footing, here, loads)


def normals(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, change: Motion, force: Vector
) -> Normals:
    """Forces that change the motion so, from the momentum of each block, normal to the face of the lower one.

    `change`: accelerations relative to the floor, or for impulses jumps of the velocities; `force`: body force per
    mass, zero for impulses. Of an open interface only the end on which it turns carries anything.
    """
    here, first, second = geometry(stack, footing, state), stack.lower, stack.upper
    on_upper, on_lower = second.mass * (change.upper - force), first.mass * (change.lower - force)
    centre, top = here.foot + here.lower, here.foot + here.joint + here.upper

    def about(x: float, height: float, both: bool) -> float:
        """Moment needed about a point of the lower block."""
        point = centre + turned(complex(x, height - first.centroid_height), float(state[0]))
        moment = second.inertia * change.upper_spin + dot(swept(top - point), on_upper)
        if both:
            moment += first.inertia * change.lower_spin + dot(swept(centre - point), on_lower)
        return moment

    width = stack.joint_end(1) - stack.joint_end(-1)
    return Normals(
        *(side * about(side * first.half_width, 0.0, True) / (2.0 * first.half_width) for side in (1, -1)),
        *(side * about(stack.joint_end(side), first.height, False) / width for side in (1, -1)),
    )


def contact_normals(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, floor: Acceleration
) -> tuple[Normals, tuple[float, float]]:
    """Normal forces at the ends of the interfaces [N], and the angular accelerations [rad/s2]."""
    here, angular = geometry(stack, footing, state), angular_accelerations(stack, footing, state, floor)

    def of(arm: Vector, spin: float, turning: float) -> Vector:
        return turning * swept(arm) - spin**2 * arm

    rate, upper = float(state[1]), float(state[3])
    change = Motion(
        of(here.lower, rate, angular[0]),
        angular[0],
        of(here.joint, rate, angular[0]) + of(here.upper, upper, angular[1]),
        angular[1],
    )
    return normals(stack, footing, state, change, stack.force(floor)), angular


def rates_after_impact(
    stack: TwoBlockStack, before: Motion, footing: Footing, state: FloatArray
) -> tuple[float, float]:
    """Rates of rotation on another footing after a plastic impact [rad/s].

    Conserved are the angular momenta that no impulse on this footing changes: of both blocks about the foot, of the
    upper block about the end of the joint; the first alone where the joint is closed, the second alone where the
    lower block lies on the floor.
    """
    here, second = geometry(stack, footing, state), stack.upper.mass
    momenta = (
        stack.lower.inertia * before.lower_spin
        + stack.lower.mass * dot(swept(here.lower), before.lower)
        + second * dot(swept(here.joint), before.upper),
        stack.upper.inertia * before.upper_spin + second * dot(swept(here.upper), before.upper),
    )
    return _solved(stack, footing, here, momenta)


def energy(stack: TwoBlockStack, footing: Footing, state: FloatArray) -> float:
    """Kinetic energy relative to the floor plus potential energy above rest [J]."""
    here, moving = geometry(stack, footing, state), velocities(stack, footing, state)
    first, second = stack.lower, stack.upper
    kinetic = first.mass * dot(moving.lower, moving.lower) + second.mass * dot(moving.upper, moving.upper)
    kinetic += first.inertia * moving.lower_spin**2 + second.inertia * moving.upper_spin**2
    rise = first.mass * (here.lower.imag - first.centroid_height)
    rise += second.mass * (here.joint.imag + here.upper.imag - first.height - second.centroid_height)
    return 0.5 * kinetic + stack.gravity * rise


def _solved(
    stack: TwoBlockStack, footing: Footing, here: Geometry, loads: tuple[float, float]
) -> tuple[float, float]:
    """Angular accelerations under generalised forces, or rates of momenta, that a footing allows."""
    first, second = stack.lower, stack.upper
    lower = (
        first.inertia + first.mass * dot(here.lower, here.lower) + second.mass * dot(here.joint, here.joint)
    )
    upper = second.inertia + second.mass * dot(here.upper, here.upper)
    coupling = second.mass * dot(here.joint, here.upper)
    if footing.base and footing.joint:
        determinant = lower * upper - coupling**2
        return (
            (upper * loads[0] - coupling * loads[1]) / determinant,
            (lower * loads[1] - coupling * loads[0]) / determinant,
        )
    if footing.base:
        both = (loads[0] + loads[1]) / (lower + 2.0 * coupling + upper)
        return both, both
    return 0.0, loads[1] / upper if footing.joint else 0.0


@dataclass(frozen=True, kw_only=True)
class TwoBlockMotion:
    """Motion of a stack of two blocks."""

    stack: TwoBlockStack
    impacts: tuple[float, ...]  #: when an interface closes [s]
    pieces: tuple[Piece, ...]
    footings: tuple[Footing, ...]  #: numbered by the regimes of the pieces

    @property
    def patterns(self) -> tuple[Pattern, ...]:
        """Those that it moved in, in order, without repetition."""
        seen = dict.fromkeys(footing.pattern for footing in self.footings)
        return tuple(pattern for pattern in seen if pattern is not Pattern.REST)

    def at(self, times: FloatArray) -> FloatArray:
        """States at given times, shape (n, 4), nan after the end; at an event that after it."""
        return sample(self.pieces, np.asarray(times, dtype=float), 4)[0]


def simulate_two_blocks(
    stack: TwoBlockStack,
    floor: FloorAcceleration,
    *,
    duration: float,
    state: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
) -> TwoBlockMotion:
    """Follow the stack until a block has turned by 90 degrees, it leaves the model, or the duration is over [s].

    At the start an interface is open where its angle, or its rate, is not zero. Raises EventError after 100 000 events.
    """
    values, time = np.array(state, dtype=float), 0.0
    frequency = math.sqrt(stack.gravity / (stack.lower.height + stack.upper.height))
    pieces: list[Piece] = []
    footings: list[Footing] = []
    impacts: list[float] = []
    footing = select(stack, values, floor.just_after(0.0))

    def rate(state: FloatArray, acceleration: Acceleration) -> FloatArray:
        lower, upper = angular_accelerations(stack, footings[-1], state, acceleration)
        return np.array([state[1], lower, state[3], upper])

    for _ in range(MAX_EVENTS):
        if footing is None:  # it leaves an interface
            break
        footings.append(footing)
        first = 0.01 / frequency  # well inside the hop of an interface that has just opened
        pull = rate(values, floor.just_after(time))
        for side, angle, speed, bend in (
            (footing.base, values[0], values[1], pull[1]),
            (footing.joint, values[2] - values[0], values[3] - values[1], pull[3] - pull[1]),
        ):
            if side and side * angle <= 0.0 and side * speed > 0.0 and side * bend < 0.0:
                first = min(first, 0.5 * abs(speed / bend))
        passage = flow(
            rate=None if footing.pattern is Pattern.REST else rate,
            guards=list(_guards(stack, footing)),
            state=values,
            start=time,
            end=duration,
            floor=floor,
            scale=np.array([0.1, 0.1 * frequency, 0.1, 0.1 * frequency]),
            regime=len(footings) - 1,
            first_step=first,
        )
        pieces.extend(passage.pieces)
        time, values = passage.time, passage.state.copy()
        if passage.event is None or passage.event in ("overturned", "leaves"):
            break
        acceleration = floor.just_after(time)
        if passage.event != "opens":
            # the angle of an interface that closes is exactly zero; a joint that was closed stays so
            if passage.event == "base":
                values[2] = values[2] - values[0] if footing.joint else 0.0
                values[0] = 0.0
            else:
                values[2] = values[0]
            rates = impact(stack, footing, values, acceleration)
            if rates is None:
                break
            values[1], values[3] = rates
            impacts.append(time)
        footing = select(stack, values, acceleration)
    else:
        raise EventError(f"t = {time:.6g} s: {MAX_EVENTS} events of two blocks")
    return TwoBlockMotion(stack=stack, impacts=tuple(impacts), pieces=tuple(pieces), footings=tuple(footings))


def select(stack: TwoBlockStack, state: FloatArray, floor: Acceleration) -> Footing | None:
    """The footing of a stack with given rotations and rates; None: it would leave an interface.

    An open interface, or one that opens, keeps its side. Of one that is at rest the accelerations decide.
    """
    bend, opening = float(state[2] - state[0]), float(state[3] - state[1])
    least = -ROUNDING * stack.gravity / stack.lower.height  # exactly zero at an opening, but for rounding
    for footing, at_rest in _footings(_sides(state[0], state[1]), _sides(bend, opening)):
        normal, angular = contact_normals(stack, footing, state, floor)
        if _opens(footing, angular, at_rest, least) and min(carried(footing, normal)) >= 0.0:
            return footing
    return None


def impact(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, floor: Acceleration
) -> tuple[float, float] | None:
    """Rates after a plastic impact [rad/s], None where it would throw a block off an interface.

    `footing` and `state` are those before it, the angle of the interface that has closed exactly zero; `floor` is the
    acceleration after it. The rates are those on the footing whose impulses push and whose closed interfaces do not
    close further; an interface that would then open more slowly than `least_rate` stays closed, where it can.
    """
    before = velocities(stack, footing, state)
    speed = max(abs(before.lower_spin), abs(before.upper_spin))
    for other, shut in _footings(_sides(state[0]), _sides(state[2] - state[0])):
        rates = rates_after_impact(stack, before, other, state)
        after = state.copy()
        after[1], after[3] = rates
        now = velocities(stack, other, after)
        jump = Motion(
            now.lower - before.lower,
            now.lower_spin - before.lower_spin,
            now.upper - before.upper,
            now.upper_spin - before.upper_spin,
        )
        impulses = carried(other, normals(stack, other, state, jump, 0j))
        pushes = min(impulses) >= -ROUNDING * speed * stack.mass * stack.lower.height
        if _opens(other, rates, shut, -ROUNDING * speed) and pushes:
            break
    else:
        return None
    least = stack.least_rate
    turns = (float(state[0]), rates[0]), (float(state[2] - state[0]), rates[1] - rates[0])
    held = Footing(*(_sides(angle, rate if abs(rate) >= least else 0.0)[0] for angle, rate in turns))
    trial = state.copy()
    trial[1], trial[3] = slow = rates_after_impact(stack, before, held, state)
    return slow if select(stack, trial, floor) == held else rates


def carried(footing: Footing, normal: Normals) -> list[float]:
    """The normal forces on which a footing relies: both ends where closed, the one it turns on where open."""
    base, joint = [normal.base_left, normal.base_right], [normal.joint_left, normal.joint_right]
    chosen = {0: slice(0, 2), -1: slice(0, 1), 1: slice(1, 2)}
    return [*base[chosen[footing.base]], *joint[chosen[footing.joint]]]


def _sides(angle: float, rate: float = 0.0) -> tuple[int, ...]:
    """The sides on which an interface may stand: that on which it is open, or any."""
    side = int(np.sign(angle)) or int(np.sign(rate))
    return (side,) if side else (0, 1, -1)


def _footings(base: tuple[int, ...], joint: tuple[int, ...]) -> Iterator[tuple[Footing, tuple[bool, bool]]]:
    """Those that a stack may take, with what of both interfaces is undecided."""
    undecided = len(base) > 1, len(joint) > 1
    return ((Footing(foot, end), undecided) for foot in base for end in joint)


def _opens(
    footing: Footing, turning: tuple[float, float], undecided: tuple[bool, bool], least: float
) -> bool:
    """Whether no interface that was closed turns into the other block."""
    bends = footing.base * turning[0], footing.joint * (turning[1] - turning[0])
    return all(bend >= least for bend, closed in zip(bends, undecided, strict=True) if closed)


def _guards(stack: TwoBlockStack, footing: Footing) -> Iterator[Guard]:
    def push(chosen: Callable[[Normals], float], state: FloatArray, acceleration: Acceleration) -> float:
        return chosen(contact_normals(stack, footing, state, acceleration)[0])

    ends: tuple[tuple[int, Callable[[Normals], float], Callable[[Normals], float]], ...] = (
        (footing.base, lambda n: n.base_right, lambda n: n.base_left),
        (footing.joint, lambda n: n.joint_right, lambda n: n.joint_left),
    )
    for side, right, left in ends:
        if side == 0:
            yield Guard(name="opens", margin=partial(push, right))
            yield Guard(name="opens", margin=partial(push, left))
        else:
            yield Guard(name="leaves", margin=partial(push, right if side == 1 else left))
    if footing.base:
        yield Guard(name="base", margin=lambda state, a: footing.base * float(state[0]))
    if footing.joint:
        yield Guard(name="joint", margin=lambda state, a: footing.joint * float(state[2] - state[0]))
    yield Guard(name="overturned", margin=lambda state, a: 0.5 * math.pi - float(abs(state[[0, 2]]).max()))
