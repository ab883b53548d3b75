"""Stops and ties of a case as contact points of its container, behind those of the base."""

import math
from typing import Any

import numpy as np

from contact.interface.penalty import damping_ratio_of
from contact.interface.workspace import Contact
from contact.stepping.body import State
from contact.stepping.links import APART, make_lines, place_links
from fem.case.case import Case, CaseError
from fem.case.links import USUAL_STOP_DAMPING, StopTable, TieTable
from fem.model.tied_capacity import side_of
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.sides import nodes_at, shapes_at

OVERLAP = 1e-9  #: overlap at the start that is rounding [m]


def places_of_links(case: Case) -> FloatArray:
    """Points of the container to which the links belong, (k, 2), where it stands on x = 0 [m]."""
    return np.array([(side_of(case, one), one.height_m) for one in case.links]).reshape(-1, 2)


def nodes_of_links(case: Case, nodes: FloatArray) -> IntArray:
    """The nodes of a structured mesh, of all (n, 2), that are nearest to the points of the links, (k,)."""
    return nodes_at(places_of_links(case), nodes)


def shapes_at_links(case: Case, nodes: FloatArray, shapes: FloatArray) -> FloatArray:
    """Shapes of modes (m, n, 2) at the points of the links, (m, k, 2): linear between the nodes of the side, (n, 2)."""
    return shapes_at(places_of_links(case), nodes, shapes)


def heights_of_links(case: Case, nodes: FloatArray) -> list[float]:
    """Heights of the points of the links [m]: as asked for, or of a full model those of its last contact nodes.

    `nodes`: (n, 2) contact nodes of the container.
    """
    if case.solver.model != "full":
        return [one.height_m for one in case.links]
    return [float(z) for z in nodes[len(nodes) - len(case.links) :, 1]]


def direction_of(link: StopTable | TieTable) -> tuple[float, float]:
    """Direction in which the point of a link may go: away from a stop, down from a tie."""
    if isinstance(link, TieTable):
        return 0.0, -1.0
    return (1.0, 0.0) if link.side == "left" else (-1.0, 0.0)


def relaxation_of(link: StopTable | TieTable, mass: float) -> float:
    """Dashpot over spring of a link [s]; a tie has no dashpot."""
    if isinstance(link, TieTable):
        return 0.0
    ratio = USUAL_STOP_DAMPING if link.damping_ratio is None else link.damping_ratio
    if link.restitution is not None:
        ratio = damping_ratio_of(link.restitution)
    return 2.0 * ratio * math.sqrt(mass / link.stiffness_N_m)


def with_links(case: Case, contact: Contact, mass: float) -> Contact:
    """The contact of a container of this mass [kg] with the points of its links behind those of the floor."""
    links = case.links
    if not links:
        return contact
    mu = [one.mu if isinstance(one, StopTable) else 0.0 for one in links]
    stiffness = [one.stiffness_N_m for one in links]
    nothing = [0.0] * len(links)
    added: dict[str, Any] = {
        "normal_stiffness": stiffness,
        "tangential_stiffness": stiffness,
        "cap": [math.inf if one.strength_N is None else one.strength_N for one in links],
        "cap_growth": nothing,
        "relaxation_time": [relaxation_of(one, mass) for one in links],
        "mu_static": mu,
        "mu_kinetic": mu,
        "weakening": nothing,
        "camber": nothing,
    }
    return contact._replace(
        resolution=contact.resolution * (1.0 + APART * len(links)),
        **{name: np.append(getattr(contact, name), given) for name, given in added.items()},  # type: ignore[arg-type]
    )


def lines_at(case: Case, place: FloatArray, width: float) -> FloatArray | None:
    """The lines of the links of a case, (k, 4); None where it has none.

    Args:
        case: its links.
        place: (k, 2) of their points where the container stands on x = 0 [m].
        width: of the container [m].
    """
    if not case.links:
        return None
    direction = np.array([direction_of(one) for one in case.links])
    return make_lines(direction, place, np.array([one.slack for one in case.links]), width)


def begin_links(case: Case, body: Any, state: State) -> None:
    """Measure the points of links from their links, in a state whose points are over the floor.

    Raises:
        CaseError: a link is overlapped at the start.
    """
    line: FloatArray | None = getattr(body, "line", None)
    if line is None:
        return
    place_links(line, state.point)
    gaps = state.point[-len(line) :, 1]
    for number, (link, gap) in enumerate(zip(case.links, gaps, strict=True), 1):
        if gap < -OVERLAP:
            own = number if isinstance(link, StopTable) else number - len(case.stop)
            name, key = ("stop", "gap_m") if isinstance(link, StopTable) else ("tie", "slack_m")
            raise CaseError(
                f"[{name}] {name} {own}: {key} = {link.slack:g} m is overlapped by {-gap:.3g} m at the start, as the "
                "container stands in its initial rotation; take a wider one, or another [initial]"
            )
