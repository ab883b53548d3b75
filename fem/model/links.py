"""Stops and ties of a case as contact points of its container, of its loose boxes or of its row, behind all others."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.interface.faces import SidePoint
from contact.interface.penalty import damping_ratio_of
from contact.interface.workspace import Contact
from contact.stepping.body import State
from contact.stepping.links import make_lines, place_links
from fem.case.case import Case
from fem.case.tables.links import StopTable, TieTable, holder_of
from fem.case.tables.neighbours import USUAL_DAMPING, StruckTable, top_of
from fem.model.link_places import box_at, direction_of, overlapped, side_of
from fem.runtime.arrays import FloatArray

OVERLAP = 1e-9  #: overlap at the start that is rounding [m]


def places_of_links(case: Case) -> FloatArray:
    """Points of the container to which the links belong, (k, 2), where it stands on x = 0 [m].

    Of a row from the axis of the container that each holds.
    """
    return np.array([(side_of(case, link), link.height_m) for link in case.links]).reshape(-1, 2)


def side_points(case: Case) -> tuple[SidePoint, ...]:
    """The points of links on the sides of loose boxes, or of the containers of a row, one for each link."""
    places = []
    for link in case.links:
        if case.container.is_loose:
            box = box_at(case, link.height_m)
            number, bottom, height = case.stack.index(box), box.bottom, box.height
        else:
            number = holder_of(case, link)
            bottom, height = 0.0, top_of(case, number)
        place = min((link.height_m - bottom) / height, 1.0)
        places.append(SidePoint(box=number, right=link.side == "right", place=place))
    return tuple(places)


def heights_of_links(case: Case, nodes: FloatArray) -> list[float]:
    """Heights of the points of the links [m]: as asked for, or of a full container those of its last contact nodes.

    `nodes`: (n, 2) contact nodes of the container.
    """
    if case.solver.model != "full" or case.container.is_loose:
        return [link.height_m for link in case.links]
    return [float(z) for z in nodes[len(nodes) - len(case.links) :, 1]]


def dashpot_of(link: StruckTable | TieTable, mass: float) -> float:
    """Dashpot over spring of what is struck by a mass [kg], or of a tie that holds it: [s]."""
    ratio = USUAL_DAMPING if link.damping_ratio is None else link.damping_ratio
    if isinstance(link, StruckTable) and link.restitution is not None:
        ratio = damping_ratio_of(link.restitution)
    return 2.0 * ratio * math.sqrt(mass / link.stiffness_N_m)


def with_links(case: Case, contact: Contact, masses: Sequence[float]) -> Contact:
    """The contact of a container, or a row, of these masses [kg] with the points of its links behind all others."""
    links = case.links
    if not links:
        return contact
    mu = [link.mu if isinstance(link, StopTable) else 0.0 for link in links]
    stiffness = [link.stiffness_N_m for link in links]
    return appended(
        contact,
        len(links),
        normal_stiffness=stiffness,
        tangential_stiffness=stiffness,
        cap=[math.inf if link.strength_N is None else link.strength_N for link in links],
        relaxation_time=[dashpot_of(link, masses[holder_of(case, link)]) for link in links],
        mu_static=mu,
        mu_kinetic=mu,
    )


def appended(contact: Contact, count: int, **given: ArrayLike) -> Contact:
    """A contact with so many further points; what is not given of them is 0, but for an infinite cap."""
    longer: dict[str, Any] = {}
    for name, own in contact._asdict().items():
        if isinstance(own, np.ndarray):
            value = given.get(name, math.inf if name == "cap" else 0.0)
            longer[name] = np.append(own, np.broadcast_to(value, count))
    return contact._replace(**longer)


def lines_at(case: Case, place: FloatArray, width: float) -> FloatArray | None:
    """The lines of the links of a case, (k, 5), whose points (k, 2) are at these places [m]; None where it has none.

    `width`: of the container, of a row of all together [m].
    """
    if not case.links:
        return None
    direction = np.array([direction_of(link) for link in case.links])
    box = None
    if case.bodies > 1:
        box = np.array([point.box for point in side_points(case)])
    return make_lines(direction, place, np.array([link.slack for link in case.links]), width, box)


def begin_links(case: Case, body: Any, state: State) -> None:
    """Measure the points of links, which are over the floor in this state, from their links; CaseError: an overlap."""
    line: FloatArray | None = getattr(body, "line", None)
    if line is None:
        return
    place_links(line, state.point)
    gaps = state.point[-len(line) :, 1]
    for number, gap in enumerate(gaps, 1):
        if gap < -OVERLAP:
            raise overlapped(case, number, -gap)
