"""What a mesh would take in memory, told before it is taken.

Measured on stacks of two thousand to ten thousand cells: matrices, factors and their making, 9 kB a node; each elastic
mode five columns as long as the unknowns, each contact degree of freedom six (loads, answers, attachment modes).
"""

import os

from fem.case.case import Case, CaseError
from fem.solid.nodal_body import FACTOR_MEMORY

BYTES_OF_A_NODE = 10e3
COLUMNS_OF_A_MODE, COLUMNS_OF_A_CONTACT = 5, 6
#: of the full model: its matrix while it is factored, and the fewest factors that are kept
BYTES_OF_A_FULL_NODE = 35e3
SHARE = 0.8  #: of the machine's memory that one container may take


def required_memory(case: Case, nodes: int, contact_nodes: int) -> float:
    """Memory for matrices, modes and responses of a container [bytes].

    Args:
        case: model and elastic modes count.
        nodes: of the elements; contact_nodes: of these may touch the floor.
    """
    modes = case.solver.elastic_modes if case.solver.model == "reduced" else 0
    columns = COLUMNS_OF_A_MODE * modes + COLUMNS_OF_A_CONTACT * 2 * contact_nodes
    return nodes * (BYTES_OF_A_NODE + 16.0 * columns)


def require_memory(case: Case, nodes: int, contact_nodes: int) -> None:
    """Refuse a container that this machine could not hold.

    Raises:
        CaseError: with what it would take and what there is.
    """
    wanted, there = required_memory(case, nodes, contact_nodes), _machine_memory()
    if there is None or wanted <= SHARE * there:
        return
    raise CaseError(
        f"[solver] element_size_m = {case.solver.element_size_m:g} m makes {nodes} nodes, {contact_nodes} of them "
        f"in contact, which would take about {wanted / 1e9:.3g} GB; this machine has {there / 1e9:.3g} GB: take larger "
        'elements, order = 1, fewer elastic_modes, or support kind = "corners"'
    )


def fitting_full_bodies(wanted: int, nodes: int) -> int:
    """How many of so many runs of the full model this machine holds side by side; at least one.

    Args:
        wanted: runs.
        nodes: of the elements of each.
    """
    there = _machine_memory()
    if there is None:
        return wanted
    return min(wanted, max(1, int(SHARE * there / (FACTOR_MEMORY + BYTES_OF_A_FULL_NODE * nodes))))


def _machine_memory() -> float | None:
    """Physical memory [bytes]; None where the system does not tell."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return None
