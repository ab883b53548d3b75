"""The slab of a case as springs: what bears under one corner of the elevation, how stiff it is, where it crushes.

Each corner of the elevation stands on a patch of the floor. Where a case gives none, it is what touches: the end of the
wall (wall x depth), a foot (its length x depth), half of a flat base. The points of a foot and of a flat base share
stiffness and cap by their tributary lengths; a flat base is one patch with both halves. The cap of a corner is the
bearing strength times the area of its patch; a steel shell that stands on its wall bears no more than yields the wall.

As a corner sinks in, more of the container bears: the patch grows along x with the depth, and with it the cap. A corner
that has sunk in too far is destroyed: beyond that this law says nothing.
"""

import math
from dataclasses import dataclass

from contact.interface.penalty import contact_frequency, relaxation_time
from fem.case.case import Case, CaseError
from fem.model.half_space import HalfSpace
from fem.model.static_checks import StaticChecks
from fem.results.run_result import FloorNumbers
from mesh.container import ContainerMesh

YIELD_STRENGTH = 235e6  #: [Pa], S235, EN 1993-1-1 Table 3.1
STEEL_MODULUS = 1.5e11  #: [Pa], from which a shell is taken for steel
DEEPEST = 0.01  #: indentation up to which the law of a corner holds [m]
WHOLE_DEPTH = 0.99  #: share of the depth of the container from which a patch is its whole edge
#: of the weight: a corner that lifts the other one carries all of it, and more at a landing
LEAST_BEARING = 1.2
HIT_RATIO = 0.2  #: rotation over the slenderness angle from which a typical impact is reckoned
#: least damping ratio of a slab for which the case gives none. Waves into the floor alone (0.004 for the edge of a wall
#: on concrete) let a corner ring after each hit: ten times the steps of a rigid container and the same motion, because
#: crushing takes the energy, not the dashpot (`rocking`: restitution 0.867 and 0.866, rotation ratio 0.385 and 0.391)
LEAST_DAMPING_RATIO = 0.3


@dataclass(frozen=True, kw_only=True)
class Slab:
    """What a slab is under one corner of the elevation."""

    patch: tuple[float, float]  #: that bears, along x and out of plane [m]
    normal_stiffness: float  #: [N/m]
    tangential_stiffness: float  #: along x [N/m]
    relaxation_time: float  #: dashpot over spring [s]
    widening: float  #: growth of the patch along x over the depth of the indentation [-]
    bearing_capacity: float  #: strength of the floor times the area of the patch [N]
    steel_capacity: float | None  #: at which the corner of a steel shell yields [N]; None of another corner

    @property
    def area(self) -> float:
        """Of the patch [m2]."""
        return self.patch[0] * self.patch[1]

    @property
    def cap(self) -> float:
        """Largest normal force of the corner before it has sunk in [N]."""
        return min(self.bearing_capacity, self.steel_capacity or self.bearing_capacity)

    @property
    def cap_growth(self) -> float:
        """Growth of the cap with the indentation, over the cap: strength of the floor times that of the patch [1/m]."""
        return self.widening * self.bearing_capacity / (self.patch[0] * self.cap)

    @property
    def deepest(self) -> float:
        """Indentation beyond which the corner is destroyed: a side of the patch, and `DEEPEST` at most [m]."""
        along = self.patch[0] / (1.0 - self.widening) if self.widening < 1.0 else math.inf
        return min(DEEPEST, along, self.patch[1])

    @property
    def yields_first(self) -> bool:
        """Whether the corner of the container gives way before the floor."""
        return self.cap < self.bearing_capacity


def is_steel_shell(case: Case) -> bool:
    """Whether the yield strength of S235 says something of the container."""
    return case.container.section == "shell" and case.container.youngs_modulus_Pa > STEEL_MODULUS


def steel_capacity(case: Case) -> float | None:
    """Force at which the wall over one corner yields, yield strength x wall x depth of the patch [N].

    Where a container has corner posts, that of the two above the castings of a corner. None where no wall of steel
    carries a corner: solid blocks, feet, a flat base.
    """
    wall, post = case.stack[0].wall, case.container.corner_post_N
    if post is not None:
        return 2.0 * post
    if not is_steel_shell(case) or wall is None or case.support.kind != "corners":
        return None
    return YIELD_STRENGTH * wall * corner_patch(case)[1]


def corner_patch(case: Case) -> tuple[float, float]:
    """What bears under one corner of the elevation, along x and out of plane [m]."""
    if case.floor.corner_patch_m is not None:
        return case.floor.corner_patch_m[0], case.floor.corner_patch_m[1]
    if case.support.casting_m is not None:
        return case.support.casting_m[0], 2.0 * case.support.casting_m[1]
    lowest = case.stack[0]
    touching = {"corners": lowest.wall, "feet": case.support.foot, "flat": 0.5 * lowest.width}
    along = touching[case.support.kind]
    if along is None:  # a solid block on corners: excluded by a rule where the floor is a slab
        raise CaseError("[floor] corner_patch_m is missing: a solid block has no wall")
    return along, case.container.depth_m


def slab_of(case: Case, mass: float) -> Slab:
    """The slab of a case under a container of this mass [kg].

    Raises:
        CaseError: the floor is no slab.
    """
    floor = case.floor
    if floor.youngs_modulus_Pa is None or floor.poisson_ratio is None or floor.bearing_strength_Pa is None:
        raise CaseError('[floor] kind = "slab" is needed')
    below = HalfSpace(youngs_modulus=floor.youngs_modulus_Pa, poisson_ratio=floor.poisson_ratio)
    along, out_of_plane = corner_patch(case)
    halves = 2 if case.support.kind == "flat" else 1
    normal = below.vertical_stiffness(halves * along, out_of_plane) / halves
    ratio, waves = case.contact_damping_ratio, 0.0
    if ratio is None and floor.density is not None:
        waves = below.vertical_dashpot(along * out_of_plane, floor.density) / normal
    least = relaxation_time(LEAST_DAMPING_RATIO if ratio is None else ratio, mass, 2.0 * normal)
    return Slab(
        patch=(along, out_of_plane),
        widening=_widening(case, out_of_plane),
        normal_stiffness=normal,
        tangential_stiffness=below.horizontal_stiffness(halves * along, out_of_plane) / halves,
        relaxation_time=max(least, waves),
        bearing_capacity=floor.bearing_strength_Pa * along * out_of_plane,
        steel_capacity=steel_capacity(case),
    )


def _widening(case: Case, out_of_plane: float) -> float:
    """Growth of the patch of a corner along x over the depth of its indentation [-].

    An edge over the whole depth is a wedge between wall and base. The rocking container stands on it, turned by at most
    its slenderness angle, and where the edge has sunk in by d, the base bears over d/tan of that angle: height over
    width for a mass centre in the middle. Beside a casting the frame clears the floor; what it heaps up before it has
    about the slope 1. Feet and a flat base have no edge that grows.
    """
    if case.support.kind != "corners":
        return 0.0
    if out_of_plane < WHOLE_DEPTH * case.container.depth_m:
        return 1.0
    return sum(box.height for box in case.stack) / case.stack[0].width


def slab_penalty(case: Case, mesh: ContainerMesh) -> float:
    """Normal stiffness of the slab over the area of the base that the support divides among its points [Pa/m]."""
    length = mesh.width if case.support.foot is None else sum(mesh.foot_widths(case.support.foot))
    return 2.0 * slab_of(case, mesh.mass).normal_stiffness / (length * case.container.depth_m)


@dataclass(frozen=True, kw_only=True)
class Hit:
    """An impact of one corner, of a rigid container that fell back from a rotation."""

    closing_speed: float  #: of the corner [m/s]
    plastic_work: float  #: that the corner or the floor takes [J]
    crushing: float  #: permanent indentation of an intact corner [m]


def hit_from(ratio: float, static: StaticChecks, slab: Slab, width: float) -> Hit:
    """The impact after a rotation of so much of the slenderness angle, released at rest.

    The energy M g R (cos(al - theta) - cos al) is that of the turn about one corner; Housner's impact, in which the
    other corner does not rebound, takes 1 - e^2 of it, as a corner that crushes does.
    """
    angle = static.slenderness_angle
    energy = static.weight * static.radius * (math.cos(angle * (1.0 - ratio)) - math.cos(angle))
    inertia = static.weight * static.radius / static.frequency_parameter**2
    lost = energy * (1.0 - max(static.housner_restitution, 0.0) ** 2)
    work = plastic_work(math.sqrt(2.0 * slab.normal_stiffness * lost), slab.cap, slab.normal_stiffness)
    speed = width * math.sqrt(2.0 * energy / inertia)
    share = work / slab.cap
    crushing = (
        2.0 * share / (1.0 + math.sqrt(1.0 + 2.0 * slab.cap_growth * share))
    )  # work = cap d (1 + growth d/2)
    return Hit(closing_speed=speed, plastic_work=work, crushing=crushing)


def floor_result(case: Case, mesh: ContainerMesh, static: StaticChecks) -> FloorNumbers | None:
    """What the floor of a case amounts to; None where it is rigid and level."""
    floor = case.floor
    if not floor.is_slab:
        slope = floor.slope_percent
        return FloorNumbers(kind=floor.kind, slope_percent=slope) if slope else None
    slab = slab_of(case, mesh.mass)
    hit = hit_from(HIT_RATIO, static, slab, mesh.width)
    return FloorNumbers(
        kind=floor.kind,
        slope_percent=floor.slope_percent,
        preset=floor.preset,
        youngs_modulus_Pa=floor.youngs_modulus_Pa,
        poisson_ratio=floor.poisson_ratio,
        bearing_strength_Pa=floor.bearing_strength_Pa,
        corner_patch_m=slab.patch,
        corner_stiffness_N_m=slab.normal_stiffness,
        corner_tangential_stiffness_N_m=slab.tangential_stiffness,
        contact_frequency_Hz=contact_frequency(mesh.mass, 2.0 * slab.normal_stiffness),
        damping_ratio=slab.relaxation_time / relaxation_time(1.0, mesh.mass, 2.0 * slab.normal_stiffness),
        static_indentation_m=0.5 * static.weight / slab.normal_stiffness,
        corner_cap_N=slab.cap,
        bearing_capacity_N=slab.bearing_capacity,
        steel_capacity_N=slab.steel_capacity,
        governs="container" if slab.yields_first else "floor",
        cap_over_weight=slab.cap / static.weight,
        hit_rotation_ratio=HIT_RATIO,
        closing_speed_m_s=hit.closing_speed,
        crushing_per_hit_m=hit.crushing,
        crushing_per_hit_J=hit.plastic_work,
    )


def plastic_work(force: float, capacity: float, stiffness: float) -> float:
    """Work that a rigid-plastic corner takes where an elastic one reaches this force [J]: (F^2 - F_c^2)/(2 k).

    The spring below has stored F^2/(2 k) when the corner stands still; a corner that gives way at F_c leaves
    F_c^2/(2 k) in the spring and takes the rest (energy of an elastoplastic spring, as in Biggs, Introduction to
    Structural Dynamics, 1964, ch. 2).

    Args:
        force: of the elastic corner [N].
        capacity: F_c, at which the corner gives way [N].
        stiffness: k, of the floor under the corner [N/m].
    """
    return max(force**2 - capacity**2, 0.0) / (2.0 * stiffness)
