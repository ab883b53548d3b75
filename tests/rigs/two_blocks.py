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


class Vector(NamedTuple):
    """A vector in the plane."""

    x: float
    z: float

    def plus(self, other: "Vector") -> "Vector":
        """The sum."""
        return Vector(self.x + other.x, self.z + other.z)

    def minus(self, other: "Vector") -> "Vector":
        """The difference."""
        return Vector(self.x - other.x, self.z - other.z)

    def times(self, factor: float) -> "Vector":
        """The multiple."""
        return Vector(factor * self.x, factor * self.z)

    def dot(self, other: "Vector") -> float:
        """The scalar product."""
        return self.x * other.x + self.z * other.z

    def turned(self, rotation: float) -> "Vector":
        """Turned toward +x by an angle [rad]."""
        cosine, sine = math.cos(rotation), math.sin(rotation)
        return Vector(cosine * self.x + sine * self.z, -sine * self.x + cosine * self.z)

    @property
    def swept(self) -> "Vector":
        """Velocity of its tip when it turns toward +x at 1 rad/s."""
        return Vector(self.z, -self.x)

    def moment(self, force: "Vector") -> float:
        """Moment of a force at its tip, positive where it turns toward +x."""
        return self.z * force.x - self.x * force.z


@dataclass(frozen=True, kw_only=True)
class StackedBlock:
    """A rigid block of a stack.

    Raises:
        ValueError: a quantity that is not positive and finite.
    """

    half_width: float  #: [m]
    height: float  #: [m]
    mass: float  #: [kg]
    centroid_height: float  #: of the mass centre above its base [m]
    inertia: float  #: about the mass centre [kg m2]

    def __post_init__(self) -> None:
        for name in ("half_width", "height", "mass", "centroid_height", "inertia"):
            value = getattr(self, name)
            if not 0.0 < value < math.inf:  # also refuses nan
                raise ValueError(f"stacked block {name} must be positive and finite, got {value}")

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
    """Two blocks, one on the other, on a floor that they cannot slide on.

    Raises:
        ValueError: the mass centre of the upper block is not over the face that the blocks share, or gravity is not
            positive.
    """

    lower: StackedBlock
    upper: StackedBlock
    gravity: float  #: [m/s2]
    offset: float = 0.0  #: of the axis of the upper block from that of the lower one, along x [m]

    def __post_init__(self) -> None:
        if not 0.0 < self.gravity < math.inf:
            raise ValueError(f"two blocks: gravity must be positive and finite, got {self.gravity} m/s2")
        if not self.joint_end(-1) < self.offset < self.joint_end(1):
            raise ValueError(
                f"two blocks: offset {self.offset} m puts the upper mass centre beyond the lower block"
            )

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
            self.lower.minus(other.lower),
            self.lower_spin - other.lower_spin,
            self.upper.minus(other.upper),
            self.upper_spin - other.upper_spin,
        )


def geometry(stack: TwoBlockStack, footing: Footing, state: FloatArray) -> Geometry:
    """The vectors of a pose; a closed interface is measured from its right end."""
    side, rotation, upper = footing.base or 1, float(state[0]), float(state[2])
    foot = side * stack.lower.half_width
    end = stack.joint_end(footing.joint or 1)
    return Geometry(
        foot=Vector(foot, 0.0),
        lower=Vector(-foot, stack.lower.centroid_height).turned(rotation),
        joint=Vector(end - foot, stack.lower.height).turned(rotation),
        upper=Vector(stack.offset - end, stack.upper.centroid_height).turned(upper),
    )


def velocities(stack: TwoBlockStack, footing: Footing, state: FloatArray) -> Motion:
    """Velocities of the mass centres relative to the floor, and the rates of rotation."""
    here, rate, upper = geometry(stack, footing, state), float(state[1]), float(state[3])
    return Motion(
        here.lower.swept.times(rate),
        rate,
        here.joint.swept.times(rate).plus(here.upper.swept.times(upper)),
        upper,
    )


def angular_accelerations(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, floor: Acceleration
) -> tuple[float, float]:
    """Angular accelerations of the lower and the upper block [rad/s2]."""
    here = geometry(stack, footing, state)
    force = Vector(-floor.x, -stack.gravity - floor.z)  # per mass
    first, second = stack.lower.mass, stack.upper.mass
    bend = second * here.joint.dot(here.upper.swept)
    loads = (
        first * here.lower.swept.dot(force)
        + second * here.joint.swept.dot(force)
        - bend * float(state[3]) ** 2,
        second * here.upper.swept.dot(force) + bend * float(state[1]) ** 2,
    )
    return _solved(stack, footing, here, loads)


def accelerations(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, angular: tuple[float, float]
) -> Motion:
    """Accelerations relative to the floor, of given angular ones."""
    here, rate, upper = geometry(stack, footing, state), float(state[1]), float(state[3])

    def of(arm: Vector, spin: float, turning: float) -> Vector:
        return arm.swept.times(turning).minus(arm.times(spin**2))

    return Motion(
        of(here.lower, rate, angular[0]),
        angular[0],
        of(here.joint, rate, angular[0]).plus(of(here.upper, upper, angular[1])),
        angular[1],
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
    on_upper = change.upper.minus(force).times(second.mass)
    on_lower = change.lower.minus(force).times(first.mass)
    centre = here.foot.plus(here.lower)
    top = here.foot.plus(here.joint).plus(here.upper)

    def about(x: float, height: float, both: bool) -> float:
        """Moment needed about a point of the lower block."""
        point = centre.plus(Vector(x, height - first.centroid_height).turned(float(state[0])))
        moment = second.inertia * change.upper_spin + top.minus(point).moment(on_upper)
        if both:
            moment += first.inertia * change.lower_spin + centre.minus(point).moment(on_lower)
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
    force = Vector(-floor.x, -stack.gravity - floor.z)
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
        + stack.lower.mass * here.lower.swept.dot(before.lower)
        + second * here.joint.swept.dot(before.upper),
        stack.upper.inertia * before.upper_spin + second * here.upper.swept.dot(before.upper),
    )
    return _solved(stack, footing, here, momenta)


def energy(stack: TwoBlockStack, footing: Footing, state: FloatArray) -> float:
    """Kinetic energy relative to the floor plus potential energy above rest [J]."""
    here, moving = geometry(stack, footing, state), velocities(stack, footing, state)
    first, second = stack.lower, stack.upper
    kinetic = first.mass * moving.lower.dot(moving.lower) + second.mass * moving.upper.dot(moving.upper)
    kinetic += first.inertia * moving.lower_spin**2 + second.inertia * moving.upper_spin**2
    rise = first.mass * (here.lower.z - first.centroid_height)
    rise += second.mass * (here.joint.z + here.upper.z - first.height - second.centroid_height)
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
    lower = first.inertia + first.mass * here.lower.dot(here.lower) + second.mass * here.joint.dot(here.joint)
    upper = second.inertia + second.mass * here.upper.dot(here.upper)
    coupling = second.mass * here.joint.dot(here.upper)
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
