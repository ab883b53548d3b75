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

from contact.interface.penalty import relaxation_time
from fem.case.case import Case, CaseError
from mesh.container import ContainerMesh

YIELD_STRENGTH = 235e6  #: [Pa], S235, EN 1993-1-1 Table 3.1
POST_YIELD_STRENGTH = 355e6  #: of a hollow section [Pa], S355, EN 1993-1-1 Table 3.1
STEEL_MODULUS = 1.5e11  #: [Pa], from which a shell is taken for steel
DEEPEST = 0.01  #: indentation up to which the law of a corner holds [m]
WHOLE_DEPTH = 0.99  #: share of the depth of the container from which a patch is its whole edge
#: of the weight: a corner that lifts the other one carries all of it, and more at a landing
LEAST_BEARING = 1.2
#: weights that the floor under a corner carries: below the first its pivot is where the weight is carried, from the
#: second on at the edge, and between the two in proportion, unless the pivot is `SEEN` inside the edge
WEAK, FIRM = 4.0, 5.0
SEEN = 0.005  #: of the width: a block that turns half as far inside its edge rocks 1 to 2 % more
#: least damping ratio of a slab for which the case gives none. Waves into the floor alone (0.004 for the edge of a wall
#: on concrete) let a corner ring after each hit: ten times the steps of a rigid container and the same motion, because
#: crushing takes the energy, not the dashpot (`rocking`: restitution 0.867 and 0.866, rotation ratio 0.385 and 0.391)
LEAST_DAMPING_RATIO = 0.3


@dataclass(frozen=True, kw_only=True)
class HalfSpace:
    """An elastic half-space under a rigid rectangular patch: homogeneous, and deep and wide against the patch.

    Static stiffness after Pais and Kausel, "Approximate formulas for dynamic stiffnesses of rigid foundations", Soil
    Dyn. Earthq. Eng. 7 (1988) 213; dashpot after Gazetas, Foundation Engineering Handbook (1991), ch. 15.

    Validity: against a rigid ellipse of the same area and proportions (exact; Johnson, Contact Mechanics, 1985, 3.5)
    the vertical stiffness is 4 % high for a square, within 5 % up to sides of 1:20, and 18 % low at 1:138, an edge of
    8 mm x 1.1 m. A slab of finite thickness is softer by its bending; two patches apart are stiffer than one of their
    area.
    """

    youngs_modulus: float  #: [Pa]
    poisson_ratio: float

    @property
    def shear_modulus(self) -> float:
        """G = E/(2 (1 + nu)) [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))

    def vertical_stiffness(self, length: float, width: float) -> float:
        """Of a patch with these sides [m]: G B/(1 - nu) (3.1 (L/B)^0.75 + 1.6), L >= B half the sides [N/m]."""
        half_long, half_short = _halves(length, width)
        shape = 3.1 * (half_long / half_short) ** 0.75 + 1.6
        return self.shear_modulus * half_short / (1.0 - self.poisson_ratio) * shape

    def horizontal_stiffness(self, along: float, across: float) -> float:
        """Of a patch moved along its first side [N/m]; the sides in m.

        G B/(2 - nu) (6.8 (L/B)^0.65 + 2.4) along the longer side, .. + 0.8 L/B + 1.6) along the shorter one.
        """
        half_long, half_short = _halves(along, across)
        ratio = half_long / half_short
        shape = 6.8 * ratio**0.65 + (2.4 if along >= across else 0.8 * ratio + 1.6)
        return self.shear_modulus * half_short / (2.0 - self.poisson_ratio) * shape

    def rocking_stiffness(self, along: float, across: float) -> float:
        """Of a patch turned in the plane of its first side [Nm/rad]; the sides in m.

        G B^3/(1 - nu) (3.73 (L/B)^2.4 + 0.27) along the longer side, .. 3.2 L/B + 0.8) along the shorter one.
        """
        half_long, half_short = _halves(along, across)
        ratio = half_long / half_short
        shape = 3.73 * ratio**2.4 + 0.27 if along >= across else 3.2 * ratio + 0.8
        return self.shear_modulus * half_short**3 / (1.0 - self.poisson_ratio) * shape

    def vertical_dashpot(self, area: float, density: float) -> float:
        """Waves that a patch [m2] sends down, rho V_La A, V_La = 3.4 V_s/(pi (1 - nu)) Lysmer's velocity [N s/m].

        The limit of high frequencies, and a lower bound for elongated patches at low ones (Gazetas, Fig. 15.18).
        """
        shear_velocity = math.sqrt(self.shear_modulus / density)
        return density * 3.4 * shear_velocity / (math.pi * (1.0 - self.poisson_ratio)) * area


def _halves(along: float, across: float) -> tuple[float, float]:
    """Half the longer and half the shorter side [m]."""
    return 0.5 * max(along, across), 0.5 * min(along, across)


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


def post_strength(case: Case) -> float | None:
    """Force at which one post yields [N]: as given, or that of its section of S355 on a casting; None where none bears.

    The area of a square hollow section with rounded corners, EN 10210-2 Annex A: 4 t (b - t) - (4 - pi) 1.25 t^2.
    """
    given, section = case.container.corner_post_N, case.container.post_section
    if given is not None or section is None or case.support.casting_m is None:
        return given
    width, wall = section
    return POST_YIELD_STRENGTH * (4.0 * wall * (width - wall) - (4.0 - math.pi) * 1.25 * wall**2)


def steel_capacity(case: Case) -> float | None:
    """Force at which the wall over one corner yields, yield strength x wall x depth of the patch [N].

    Where a container has corner posts, that of the two above the castings of a corner. None where no wall of steel
    carries a corner: solid blocks, feet, a flat base.
    """
    wall, post = case.stack[0].wall, post_strength(case)
    if post is not None and case.support.kind == "corners":
        return 2.0 * post
    if not is_steel_shell(case) or wall is None or case.support.kind != "corners":
        return None
    if case.container.is_round and case.floor.corner_patch_m is None:
        return None  # how much of a round edge bears is not known
    return YIELD_STRENGTH * wall * corner_patch(case)[1]


def corner_patch(case: Case) -> tuple[float, float]:
    """What bears under one corner of the elevation, along x and out of plane [m]."""
    if case.floor.corner_patch_m is not None:
        return case.floor.corner_patch_m[0], case.floor.corner_patch_m[1]
    if case.support.casting_m is not None:
        return case.support.casting_m[0], 2.0 * case.support.casting_m[1]
    lowest = case.stack[0]
    touching = {"corners": lowest.wall, "feet": case.support.foot_m, "flat": 0.5 * lowest.width}
    along = touching[case.support.kind]
    if along is None:  # a solid block on corners: excluded by a rule where the floor is a slab
        raise CaseError("[floor] corner_patch_m is missing: a solid block has no wall")
    return along, case.container.depth_m


def half_space_of(case: Case) -> HalfSpace:
    """What is under the container; CaseError: the floor is no slab."""
    floor = case.floor
    if floor.youngs_modulus_Pa is None or floor.poisson_ratio is None:
        raise CaseError('[floor] kind = "slab" is needed')
    return HalfSpace(youngs_modulus=floor.youngs_modulus_Pa, poisson_ratio=floor.poisson_ratio)


def slab_of(case: Case, mass: float) -> Slab:
    """The slab of a case under a container of this mass [kg]; CaseError: the floor is no slab."""
    floor, below = case.floor, half_space_of(case)
    if floor.bearing_strength_Pa is None:
        raise CaseError('[floor] kind = "slab" is needed')
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
    width for a mass centre in the middle. Beside a narrower patch the frame clears the floor; what it heaps up before
    it has about the slope 1. Feet and a flat base have no edge that grows.
    """
    if case.support.kind != "corners":
        return 0.0
    if out_of_plane < WHOLE_DEPTH * case.container.depth_m:
        return 1.0
    return sum(box.height for box in case.stack) / case.stack[0].width


def pivot_inset(case: Case, mesh: ContainerMesh) -> float:
    """How far inside the edge of what touches a corner turns that carries the weight alone [m]; 0 on a rigid floor.

    The floor is plastic under so much of the patch as carries the weight at its strength, from the edge inward: c W/F
    of the patch c along x that bears F, and all of it where F is less than the weight W (refused elsewhere). The
    resultant is in the middle of it. Where the patch grows with the indentation, its strength a length stays. Gajan and
    Kutter, J. Geotech. Geoenviron. Eng. 134 (2008) 1129, of footings that rock: the moment is W B/2 (1 - A_c/A), A_c
    the area that carries the weight. A firm floor turns the container about the edge itself: what that neglects, less
    than `SEEN` of the width, is a sixth of the range of the effective width.
    """
    if not case.floor.is_slab:
        return 0.0
    slab = slab_of(case, mesh.mass)
    times = slab.bearing_capacity / (mesh.mass * case.gravity_m_s2)
    inset = 0.5 * slab.patch[0] / max(times, 1.0)
    share = max((FIRM - times) / (FIRM - WEAK), 2.0 * inset / (SEEN * mesh.width) - 1.0)
    if case.solver.model == "full" and share < 1.0:  # it bears where its nodes are
        return 0.0
    return inset * min(max(share, 0.0), 1.0)


def pivot_share(case: Case, mesh: ContainerMesh) -> float:
    """Width between the points about which a container turns, over that of its base [-].

    Castings and worn edges stand inside its sides, and a weak floor carries it inside the edge of what touches.
    CaseError: the mass centre is not between these points.
    """
    inset, beside = pivot_inset(case, mesh), abs(mesh.centroid[0])
    share = case.effective_width - 2.0 * inset / mesh.width
    half = 0.5 * share * mesh.width
    if beside < half:
        return share
    cause, inside = f"[support] effective_width = {case.support.effective_width:g}", "inside its sides"
    if inset > 0.0:
        cause = f"[floor] bearing_strength_Pa = {case.floor.bearing_strength_Pa:g} Pa"
        inside = f"{1e3 * inset:.3g} mm inside the edge of what touches"
    raise CaseError(
        f"{cause}: the container turns {inside}, {half:.3g} m from the middle of its base, and its mass centre "
        f"is {beside:.3g} m beside the middle: it would fall over at once; make offset_m smaller, or "
        "what bears wider or stronger"
    )
