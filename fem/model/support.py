"""The contact nodes of a case's container, and their penalty."""

from contact.interface.penalty import choose_normal_penalty
from contact.interface.support import Support, choose_support
from fem.case.case import Case, CaseError
from fem.model.floor import slab_penalty
from fem.model.geometry import base_positions
from fem.model.static_checks import distance_beside, slenderness_angle
from mesh.container import ContainerMesh


def build_support(case: Case, mesh: ContainerMesh) -> Support:
    """The base nodes that can touch the floor, each with its share of the base.

    Raises:
        CaseError: the feet do not fit the mesh.
        MeshError: no mesh line ends a foot.
    """
    feet = (0.0, 0.0) if case.support.foot is None else mesh.foot_widths(case.support.foot)
    try:
        return choose_support(
            case.support.kind,
            base_positions(mesh, case.solver.order),
            depth=case.container.depth_m,
            order=case.solver.order,
            feet=feet,
        )
    except ValueError as error:
        raise CaseError(str(error)) from error


def normal_penalty(case: Case, mesh: ContainerMesh) -> float:
    """Normal penalty of the case; a slab has its own, "auto" chooses it for the mesh [Pa/m]."""
    return slab_penalty(case, mesh) if case.floor.is_slab else steel_penalty(case, mesh)


def steel_penalty(case: Case, mesh: ContainerMesh) -> float:
    """Normal penalty of a rigid floor, and of the faces between loose boxes on any floor [Pa/m]."""
    given = case.contact.normal_penalty_Pa_m
    if given != "auto":
        return given
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
        foot=case.support.foot or 0.0,
    )
