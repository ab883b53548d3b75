"""The contact nodes of a case's container, and their penalty.

Springs of a flat base on a half-space: stiffer near its edges, so that it resists tilting as the half-space does.

Under a rigid base the pressure of a half-space is largest at the edges. Springs shared evenly have 0.3 to 0.8 of its
rocking stiffness. Two intensities, one outside and one inside, meet the vertical and the rocking stiffness of the
source. No springs that push can resist tilting by more than all of them at the edges, three times the even ones: under
a base more than 1.5 times as deep as it is wide all are stiffer, so that the rocking stiffness, which decides about
uplift, is met, and the vertical one is more than that of the source: 1.09 and 1.45 times at 2 and 5 widths (NIST GCR
12-917-21, 2.2.3, has end zones and lets it grow, too). On a weak floor the edges would be crushed at rest: they have
less there.
"""

import math

import numpy as np

from contact.interface.penalty import STIFFEST, choose_normal_penalty
from contact.interface.support import Support, cambered, choose_support
from fem.case.case import Case, CaseError
from fem.model.floor import corner_patch, half_space_of, pivot_share, slab_of
from fem.model.geometry import base_positions, build_container
from fem.model.static_checks import distance_beside, slenderness_angle
from fem.runtime.arrays import FloatArray
from mesh.container import ContainerMesh

LARGEST = 2.9  #: rocking stiffness over that of even springs; 3 takes all of them to the edges
MOST_AT_REST = 0.5  #: of its strength that the floor carries at the edges at rest
WHOLE_WIDTH = 0.99  #: share of the width of the base from which two patches are all of it
LEAST_POINTS = 5  #: of a base that rolls: fewer are a polygon of two or three sides


def build_support(case: Case, mesh: ContainerMesh) -> Support:
    """The base nodes that can touch the floor, each with its share of the base; CaseError where they do not fit."""
    chosen, x = case.support, base_positions(mesh, case.solver.order)
    feet = (0.0, 0.0) if case.foot is None else mesh.elevation.foot_widths(case.foot)
    kind = "flat" if case.rolls else chosen.kind
    try:
        level = choose_support(kind, x, depth=case.container.depth_m, order=case.solver.order, feet=feet)
    except ValueError as error:
        raise CaseError(str(error)) from error
    if chosen.camber_m == 0.0:
        return level
    if case.rolls and level.index.size < LEAST_POINTS:
        raise CaseError(
            f"[solver] element_size_m = {case.solver.element_size_m:g} m: a cambered base of {level.index.size} points "
            f"does not roll; take at most {0.25 * float(x[-1] - x[0]):.2g} m"
        )
    return cambered(level, x[level.index], chosen.camber_m)


def rolling_of(case: Case, mesh: ContainerMesh) -> tuple[float, float]:
    """Radius b^2/(2 d) of a base that rolls on an arc [m], and the time by which the resultant is ahead [s].

    A body on an arc of radius R swings with I theta'' + M g (R - z_c) theta = 0, I about the place that touches. A
    resultant that is ahead by the time tau adds M g R tau theta', so a damping ratio zeta of these small swings is
    tau = 2 zeta (R - z_c)/(R omega). CaseError: the base is so round that the container does not stand on it.
    """
    support, height = case.support, mesh.centroid[1]
    width = case.effective_width * mesh.width
    radius = 0.125 * width**2 / support.camber_m
    if radius <= height:
        raise CaseError(
            f"[support] camber_m = {support.camber_m:g} m: the base is an arc of {radius:.3g} m under a mass "
            f"centre at {height:.3g} m, on which the container does not stand; it must be less than "
            f"{0.125 * width**2 / height:.3g} m"
        )
    inertia = mesh.inertia + mesh.mass * height**2
    frequency = math.sqrt(mesh.mass * case.gravity_m_s2 * (radius - height) / inertia)
    return radius, 2.0 * support.rocking_damping_ratio * (radius - height) / (radius * frequency)


def _rolling_penalty(case: Case, mesh: ContainerMesh) -> float:
    """Normal penalty with which the load of a cambered base passes evenly from point to point [Pa/m]."""
    support, weight = build_support(case, mesh), mesh.mass * case.gravity_m_s2
    return weight * float((1.0 / support.sinking).sum()) / (float(support.length.sum()) * support.depth)


def normal_penalty(case: Case, mesh: ContainerMesh) -> float:
    """Normal penalty of the case; a slab has its own, "auto" chooses it for the mesh [Pa/m].

    The rigid floor of a row is one: "auto" is the largest that any of its containers would have alone.
    """
    if case.floor.is_slab:
        length = mesh.width if case.foot is None else sum(mesh.elevation.foot_widths(case.foot))
        softest = 2.0 * slab_of(case, mesh.mass).normal_stiffness / (length * case.container.depth_m)
        return min(softest, _rolling_penalty(case, mesh)) if case.support.camber_m > 0.0 else softest
    if case.neighbour and case.contact.normal_penalty_Pa_m == "auto":
        return max(steel_penalty(alone, build_container(alone)) for alone in case.row)
    return steel_penalty(case, mesh)


def steel_penalty(case: Case, mesh: ContainerMesh) -> float:
    """Normal penalty of a rigid floor, and of the faces between loose boxes on any floor [Pa/m]."""
    given = case.contact.normal_penalty_Pa_m
    if given != "auto":
        return given
    if case.support.camber_m > 0.0:
        stiffest = STIFFEST * case.container.youngs_modulus_Pa / case.solver.element_size_m
        return min(_rolling_penalty(case, mesh), stiffest)
    return choose_normal_penalty(
        case.support.kind,
        weight=mesh.mass * case.gravity_m_s2,
        width=mesh.width,
        height=mesh.height,
        depth=case.container.depth_m,
        slenderness_angle=slenderness_angle(
            width=mesh.width - 2.0 * distance_beside(mesh), centroid=mesh.centroid[1]
        ),
        youngs_modulus=case.container.youngs_modulus_Pa,
        element_size=case.solver.element_size_m,
        foot=case.foot or 0.0,
    )


def base_points(case: Case, mesh: ContainerMesh, place: FloatArray, count: int) -> FloatArray:
    """Points of a container (n, 2), the first of which bear on the floor: corners where the container turns [m].

    Many points of one patch find by themselves which of them carry the container on a weak floor.
    """
    sharp = case.support.kind == "corners"
    share = pivot_share(case, mesh) if sharp else case.support.effective_width
    if share == 1.0:
        return place
    placed = place.copy()
    placed[:count, 0] = share * place[:count, 0]
    return placed


def edge_factors(case: Case, support: Support, x: FloatArray) -> FloatArray:
    """Factors (n,) on the springs of the points of a base at x (n,) [m], shared by their lengths."""
    if not case.floor.is_slab or case.support.kind != "flat" or case.support.camber_m > 0.0:
        return np.ones(x.size)
    (half_patch, across), below = corner_patch(case), half_space_of(case)
    along = 2.0 * half_patch
    if along < WHOLE_WIDTH * case.stack[0].width:
        return np.ones(x.size)
    # rocking stiffness of the half-space over that of springs shared evenly
    wanted = below.rocking_stiffness(along, across) / (
        below.vertical_stiffness(along, across) * along**2 / 12.0
    )
    ratio, half, lengths = min(wanted, LARGEST), 0.5 * float(x[-1] - x[0]), support.length
    # from farther out than the radius wanted, so that the inside pushes, too; a point may have a part of it, so that
    # its place does not depend on where the nodes are
    zone = half * (1.0 - math.sqrt(0.25 + 0.25 * ratio))
    ends = np.cumsum(lengths)
    left, right = (np.clip(zone - before, 0.0, lengths) for before in (ends - lengths, ends[-1] - ends))
    outside = (left + right) / lengths
    squares = ((x - x[0]) / half - 1.0) ** 2
    parts = lengths * np.array([1.0 - outside, outside])
    sums = np.array([parts.sum(axis=1), parts @ squares])
    inside, edge = np.linalg.solve(sums, lengths.sum() * np.array([1.0, ratio / 3.0]))
    # of edges that would be crushed at rest, only as much as they carry
    bearable = MOST_AT_REST * 2.0 * slab_of(case, case.mass).cap / (case.mass * case.gravity_m_s2)
    elastic = float(np.clip((bearable - 1.0) / (edge - 1.0), 0.0, 1.0))
    return 1.0 + elastic * (wanted / ratio * (inside + (edge - inside) * outside) - 1.0)
