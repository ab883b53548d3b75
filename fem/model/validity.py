"""Refuses a model that is not valid or too large: sinking, crushing, too little memory.

The contact springs and the material are idealisations of small deformations.
"""

import math
import os

from fem.case.case import Case, CaseError
from fem.model.floor import LEAST_BEARING, pivot_inset, post_strength, slab_of
from fem.model.support import normal_penalty
from mesh.container import ContainerMesh

LARGEST_SINKING = 0.1  #: of the container under its weight, over the smaller of width and height
#: Stretch at which the nominal stress (s^3 - s) E/2 of St. Venant-Kirchhoff material has its minimum. Compressed
#: further it carries less, flat it carries nothing, and inverted it comes to rest.
LEAST_STRETCH = 1.0 / math.sqrt(3.0)
#: Memory, measured on stacks of 2000 to 10,000 cells. A node: matrices, factors and work space. Columns as long as
#: the unknowns: for each elastic mode and each contact degree of freedom (loads, responses, attachment modes).
BYTES_OF_A_NODE, COLUMNS_OF_A_MODE, COLUMNS_OF_A_CONTACT = 10e3, 5, 6
MEMORY_SHARE = 0.8  #: of the machine's memory that may be used


def require_stiff_contact(case: Case, mesh: ContainerMesh, stiffness: float) -> None:
    """Refuse, as a CaseError, contact springs of the whole base [N/m] into which the container would sink deep."""
    weight, size = mesh.mass * case.gravity_m_s2, min(mesh.width, mesh.height)
    if weight <= LARGEST_SINKING * size * stiffness:
        return
    depth = f"by {weight / stiffness:.3g} m" if stiffness > 0.0 else "without limit"
    sinks = (
        f"the container would sink in {depth} under its weight alone; the limit is {LARGEST_SINKING:g} of its smaller "
        f"dimension, {size:g} m"
    )
    if case.floor.is_slab:
        stiff = f"[floor] youngs_modulus_Pa = {case.floor.youngs_modulus_Pa:g} Pa"
        raise CaseError(f"{stiff}: {sinks}; take a stiffer floor or a larger corner_patch_m")
    chosen = (
        '"auto" follows container.youngs_modulus_Pa'
        if case.contact.normal_penalty_Pa_m == "auto"
        else '"auto" chooses it'
    )
    raise CaseError(
        f"[contact] normal_penalty_Pa_m = {normal_penalty(case, mesh):.3g} Pa/m: {sinks}; {chosen}"
    )


def require_bearing(case: Case, mesh: ContainerMesh, at_rest: tuple[float, float] = (0.0, 1.0)) -> None:
    """Refuse, as a CaseError, a slab into which the container would sink at once, or where one side lifts off.

    `at_rest`: force of the point of the base that is used most, and what it bears [N]. Also a full model whose corners
    turn inside the edges, where it has no nodes.
    """
    if not case.floor.is_slab:
        return
    slab = slab_of(case, mesh.mass)
    inset = pivot_inset(case, mesh)
    if inset > 0.0 and case.support.kind == "corners" and case.solver.model == "full":
        raise CaseError(
            f'[solver] model = "full": on this floor a corner turns {1e3 * inset:.3g} mm inside its edge, and the '
            'full model bears where its nodes are; take "reduced" or "rigid", or feet of the length of the patch'
        )
    (force, bears), lifted = at_rest, LEAST_BEARING * mesh.mass * case.gravity_m_s2
    use = max(force / bears, lifted / slab.cap)
    if use <= 1.0:
        return
    carries = (
        f"a corner must carry {1e-3 * lifted:.4g} kN, {LEAST_BEARING:g} times the weight where the other one lifts "
        f"off, and has {1e-3 * slab.cap:.4g} kN on its patch of {slab.patch[0]:g} x {slab.patch[1]:g} m: the container "
        "would sink in at once"
    )
    if lifted <= slab.cap:
        carries = (
            f"at rest one point of the base must carry {1e-3 * force:.4g} kN and bears {1e-3 * bears:.4g} kN: the "
            "container would sink in there at once"
        )
    if slab.yields_first:
        post = post_strength(case)
        if post is not None:
            given = "post_m" if case.container.corner_post_N is None else "corner_post_N"
            raise CaseError(f"[container] {given}: {carries}, because its posts yield at {post:g} N each")
        raise CaseError(f"[container] wall_m = {case.stack[0].wall:g} m: {carries}, because its wall yields")
    raise CaseError(
        f"[floor] bearing_strength_Pa = {case.floor.bearing_strength_Pa:g} Pa: {carries}; the least patch has "
        f"{use * slab.area:.3g} m2, this one {slab.area:.3g} m2: give corner_patch_m all that bears, or spread the load"
    )


def require_stiff_corner(case: Case, *, width: float, depth: float, stored: float) -> None:
    """Refuse, as a CaseError, a tilted start whose springs store more than the energy to overturn the container.

    On a flat base one corner has only the stiffness of the length of base beside it: a soft container can sink in by
    many widths, and the springs, not the container, would decide the motion. `width`, and `depth` of the corner [m];
    `stored`: energy of the springs over that to overturn.
    """
    if case.initial.rotation_rad == 0.0 or stored <= 1.0:
        return
    raise CaseError(
        f"[initial] rotation_rad = {case.initial.rotation_rad:g} rad: the corner that carries the weight would sink in "
        f"by {depth:.3g} m ({depth / width:.2g} of the width), and its spring would store {stored:.2g} times the "
        "energy to overturn the container, and throw it; increase contact.normal_penalty_Pa_m (if it is "
        '"auto", it follows container.youngs_modulus_Pa), or choose support.kind = "corners", whose two corners carry '
        "the stiffness of the whole base"
    )


def require_stiff_container(case: Case, compression: float) -> None:
    """Refuse, as a CaseError, a container that its weight compresses beyond what its material can carry."""
    if compression < 1.0 - LEAST_STRETCH:
        return
    raise CaseError(
        f"[container] youngs_modulus_Pa = {case.container.youngs_modulus_Pa:g} Pa: its own weight would compress the "
        f"container by {100.0 * compression:.0f} % where it is strained most; beyond "
        f"{100.0 * (1.0 - LEAST_STRETCH):.0f} % such a material gives way; choose a stiffer material, thicker walls, "
        'or solver.model = "rigid"'
    )


def required_memory(case: Case, nodes: int, contact_nodes: int) -> float:
    """Memory for matrices, modes and responses of a container with so many nodes and contact nodes [bytes]."""
    modes = case.solver.elastic_modes if case.solver.model == "reduced" else 0
    columns = COLUMNS_OF_A_MODE * modes + COLUMNS_OF_A_CONTACT * 2 * contact_nodes
    return nodes * (BYTES_OF_A_NODE + 16.0 * columns)


def require_memory(case: Case, nodes: int, contact_nodes: int) -> None:
    """Refuse, as a CaseError, a container that does not fit into this machine's memory."""
    required, present = required_memory(case, nodes, contact_nodes), _machine_memory()
    if required > MEMORY_SHARE * present:
        raise CaseError(
            f"[solver] element_size_m = {case.solver.element_size_m:g} m gives {nodes} nodes, {contact_nodes} of them "
            f"in contact, which need about {required / 1e9:.3g} GB; this machine has {present / 1e9:.3g} GB: use "
            'larger elements, order = 1, fewer elastic_modes, or support.kind = "corners"'
        )


def runs_in_memory(count: int, bytes_each: float) -> int:
    """How many of `count` runs fit into this machine's memory at a time; at least one."""
    return int(min(count, max(1.0, MEMORY_SHARE * _machine_memory() // bytes_each)))


def _machine_memory() -> float:
    """Physical memory [bytes]; infinite where the system does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return math.inf
