"""Equations of two rigid blocks, one on the other, that rock without sliding.

Rotations are those of the two blocks against the floor, positive toward +x; the state is (rotation of the lower block,
its rate, rotation of the upper block, its rate). A side tells how an interface stands: +1 open and turning on its right
end, -1 on its left end, 0 closed. The interface between the blocks is the part of their faces that they share, so that
its ends are corners of the narrower block. Frame of the floor: its acceleration is a body force, and gravity g + a_v.

Lagrange's equations with exact geometry: r_1 and r_P from the foot to the lower mass centre and to the end P of the
joint, r_2 from P to the upper mass centre, B = r_P . r_2, B' = dB/d(rotation of the upper block):

    (I_1 + m_1 r_1^2 + m_2 r_P^2) th_1'' + m_2 B th_2'' + m_2 B' th_2'^2 = Q_1
                 m_2 B th_1'' + (I_2 + m_2 r_2^2) th_2'' - m_2 B' th_1'^2 = Q_2

Psycharis, Dynamic behaviour of rocking two-block assemblies, Earthquake Engng Struct. Dyn. 19 (1990) 555; Spanos,
Roussis, Politopoulos, Dynamic analysis of stacked rigid blocks, Soil Dyn. Earthquake Engng 21 (2001) 559.
"""

import math
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Self

from contact.arrays import FloatArray
from contact.reference.floor_acceleration import Acceleration


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
        return cls(
            half_width=0.5 * width,
            height=height,
            mass=mass,
            centroid_height=0.5 * height,
            inertia=mass * (width**2 + height**2) / 12.0,
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

    def minus(self, other: "Motion") -> "Motion":
        """The change from another one."""
        return Motion(
            self.lower - other.lower,
            self.lower_spin - other.lower_spin,
            self.upper - other.upper,
            self.upper_spin - other.upper_spin,
        )


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
    joint = rate * swept(here.joint)
    return Motion(rate * swept(here.lower), rate, joint + upper * swept(here.upper), upper)


def angular_accelerations(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, floor: Acceleration
) -> tuple[float, float]:
    """Angular accelerations of the lower and the upper block [rad/s2]."""
    here = geometry(stack, footing, state)
    force = complex(-floor.x, -stack.gravity - floor.z)  # per mass
    first, second = stack.lower.mass, stack.upper.mass
    bend = second * dot(here.joint, swept(here.upper))
    lower = first * dot(swept(here.lower), force) + second * dot(swept(here.joint), force)
    upper = second * dot(swept(here.upper), force)
    loads = lower - bend * float(state[3]) ** 2, upper + bend * float(state[1]) ** 2
    return _solved(stack, footing, here, loads)


def accelerations(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, angular: tuple[float, float]
) -> Motion:
    """Accelerations relative to the floor, of given angular ones."""
    here, rate, upper = geometry(stack, footing, state), float(state[1]), float(state[3])

    def of(arm: Vector, spin: float, turning: float) -> Vector:
        return turning * swept(arm) - spin**2 * arm

    joint = of(here.joint, rate, angular[0])
    return Motion(
        of(here.lower, rate, angular[0]), angular[0], joint + of(here.upper, upper, angular[1]), angular[1]
    )


def normals(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, change: Motion, force: Vector
) -> Normals:
    """Forces that change the motion so, from the momentum of each block.

    Args:
        change: accelerations relative to the floor; or, for impulses, jumps of the velocities.
        force: body force per mass; zero for impulses.

    Normal to the face of the lower block. Of an open interface only the end on which it turns carries anything.
    """
    here = geometry(stack, footing, state)
    first, second = stack.lower, stack.upper
    on_upper, on_lower = second.mass * (change.upper - force), first.mass * (change.lower - force)
    centre, top = here.foot + here.lower, here.foot + here.joint + here.upper

    def about(x: float, height: float, both: bool) -> float:
        """Moment needed about a point of the lower block."""
        point = centre + turned(complex(x, height - first.centroid_height), float(state[0]))
        moment = second.inertia * change.upper_spin + dot(swept(top - point), on_upper)
        if both:
            moment += first.inertia * change.lower_spin + dot(swept(centre - point), on_lower)
        return moment

    base = [side * about(side * first.half_width, 0.0, True) for side in (1, -1)]
    joint = [side * about(stack.joint_end(side), first.height, False) for side in (1, -1)]
    width = stack.joint_end(1) - stack.joint_end(-1)
    return Normals(
        base_left=base[0] / (2.0 * first.half_width),
        base_right=base[1] / (2.0 * first.half_width),
        joint_left=joint[0] / width,
        joint_right=joint[1] / width,
    )


def contact_normals(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, floor: Acceleration
) -> tuple[Normals, tuple[float, float]]:
    """Normal forces at the ends of the interfaces [N], and the angular accelerations [rad/s2]."""
    angular = angular_accelerations(stack, footing, state, floor)
    force = complex(-floor.x, -stack.gravity - floor.z)
    return normals(stack, footing, state, accelerations(stack, footing, state, angular), force), angular


def rates_after_impact(
    stack: TwoBlockStack, before: Motion, footing: Footing, state: FloatArray
) -> tuple[float, float]:
    """Rates of rotation on another footing after a plastic impact [rad/s].

    Conserved are the angular momenta that no impulse on this footing changes: of both blocks about the foot, of the
    upper block about the end of the joint; the first alone where the joint is closed, the second alone where the
    lower block lies on the floor.
    """
    here = geometry(stack, footing, state)
    second = stack.upper.mass
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


def carried(footing: Footing, normal: Normals) -> list[float]:
    """The normal forces on which a footing relies: both ends where closed, the one it turns on where open."""
    base, joint = [normal.base_left, normal.base_right], [normal.joint_left, normal.joint_right]
    chosen = {0: slice(0, 2), -1: slice(0, 1), 1: slice(1, 2)}
    return [*base[chosen[footing.base]], *joint[chosen[footing.joint]]]


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
