"""The contact nodes of a case's container, and their penalty."""

import math
from dataclasses import dataclass

from contact.interface.penalty import STIFFEST, choose_normal_penalty
from contact.interface.support import Support, cambered, choose_support
from fem.case.case import Case, CaseError
from fem.model.floor import pivot_share, slab_penalty
from fem.model.geometry import base_positions, build_container
from fem.model.static_checks import distance_beside, slenderness_angle
from fem.runtime.arrays import FloatArray
from mesh.container import ContainerMesh

LEAST_POINTS = 5  #: of a base that rolls: fewer are a polygon of two or three sides
#: of a casting at most: the cost of a step grows with their square; 41 turn a stack 3 % further, see README.md


def build_support(case: Case, mesh: ContainerMesh) -> Support:
    """The base nodes that can touch the floor, each with its share of the base.

    Raises:
        CaseError: the feet do not fit the mesh, or a cambered base has too few points to roll.
        MeshError: no mesh line ends a foot.
    """
    chosen, x = case.support, base_positions(mesh, case.solver.order)
    feet = (0.0, 0.0) if case.foot is None else mesh.elevation.foot_widths(case.foot)
    kind = "flat" if case.rolls else chosen.kind
    try:
        level = choose_support(
            kind,
            x,
            depth=case.container.depth_m,
            order=case.solver.order,
            feet=feet,
        )
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


@dataclass(frozen=True, kw_only=True)
class Rolling:
    """Small rocking on a base that is cambered from edge to edge: it rolls on an arc."""

    radius: float  #: of the base, b^2/(2 d) [m]
    time: float  #: by which the resultant is ahead of the place that touches, of the damping ratio [s]

    @classmethod
    def of(cls, case: Case, mesh: ContainerMesh) -> "Rolling | None":
        """That of a case; None where the base does not roll.

        A body on an arc of radius R swings with I theta'' + M g (R - z_c) theta = 0, I about the place that touches.
        A resultant that is ahead by the time tau adds M g R tau theta', so a damping ratio zeta of these small swings
        is tau = 2 zeta (R - z_c)/(R omega).

        Raises:
            CaseError: the base is so round that the container does not stand on it.
        """
        support, height = case.support, mesh.centroid[1]
        if not case.rolls:
            return None
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
        lead = 2.0 * support.rocking_damping_ratio * (radius - height) / (radius * frequency)
        return cls(radius=radius, time=lead)


def _rolling_penalty(case: Case, mesh: ContainerMesh) -> float:
    """Normal penalty with which the load of a cambered base passes evenly from point to point [Pa/m]."""
    support, weight = build_support(case, mesh), mesh.mass * case.gravity_m_s2
    return weight * float((1.0 / support.sinking).sum()) / (float(support.length.sum()) * support.depth)


def normal_penalty(case: Case, mesh: ContainerMesh) -> float:
    """Normal penalty of the case; a slab has its own, "auto" chooses it for the mesh [Pa/m].

    The rigid floor of a row is one: "auto" is the largest that any of its containers would have alone.
    """
    if case.floor.is_slab:
        softest = slab_penalty(case, mesh)
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
