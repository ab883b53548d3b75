"""Stops and ties of a container: tables [[stop]] and [[tie]], of which a case may have several, and their rules.

A stop is a wall or a kerb that moves with the floor and stands beside a point of a side; a tie runs from such a point
down to the floor below it, level to a wall of that side, or to a point of the container that faces it in a row. Both
hold nothing until their gap or slack is used up. In a row a stop stands at its end, and a tie holds the container of
the case or a neighbour.
"""

import math
from typing import Annotated, Any, Literal

from pydantic import Field, Strict

from fem.case.tables import quantities as q
from fem.case.tables.neighbours import NeighbourTable, StruckTable, beside_of, gap_beside, outermost, top_of
from fem.case.tables.problem import Rule, either, refused
from fem.case.tables.table import CaseTable, case_key, optional_key


class StopTable(StruckTable):
    """A wall or kerb that moves with the floor, beside the container or, in a row, beside the last one of its side."""

    height_m: Annotated[float, q.LINK_HEIGHT] = case_key(
        "of the point that meets it; at a joint of loose boxes that of the lower box", example=0.1
    )
    strength_N: Annotated[float, q.LINK_FORCE] | None = optional_key(
        "force at which it breaks, for good; default: it does not", 5e5
    )

    rules = (either("stop.restitution", "damping_ratio"),)

    @property
    def slack(self) -> float:
        """What is used up before it holds [m]."""
        return self.gap_m


LEAST_LENGTH = 1e-3  #: of a tie between containers, which has no direction without one [m]


class TieTable(CaseTable):
    """A strap from a point of a side of the container, or of a neighbour; it pulls.

    Straight down to the floor, or level to a wall that stands on that side and moves with the floor, it pulls always in
    one direction; to the container that faces that side, from end to end, wherever these move.
    """

    from_: Literal["left", "right"] = Field(
        alias="from", description="side of the container from which it runs", examples=["left"]
    )
    neighbour: Annotated[int, Strict(), q.NEIGHBOUR] | None = optional_key(
        "number of the [[neighbour]] that it holds; default: the container", 1
    )
    height_m: Annotated[float, q.LINK_HEIGHT] = case_key(
        "of its point; at a joint of loose boxes that of the lower box", example=0.5
    )
    to: Literal["floor", "wall", "neighbour"] = case_key(
        '"floor": straight down | "wall": level, on that side | "neighbour": to what faces that side in a row',
        "floor",
    )
    to_height_m: Annotated[float, q.LINK_HEIGHT] | None = optional_key(
        'of its point on what faces that side, with to = "neighbour"; default: height_m', 0.5
    )
    slack_m: Annotated[float, q.GAP] = case_key("how far its point moves away before it holds", 0.0)
    stiffness_N_m: Annotated[float, q.LINK_STIFFNESS] = case_key("of the strap", example=1e6)
    damping_ratio: Annotated[float, q.CONTACT_DAMPING] = case_key(
        "c/(2 sqrt(k m)), m the mass that it holds, of two containers the reduced one", 0.0
    )
    strength_N: Annotated[float, q.LINK_FORCE] | None = optional_key(
        "force at which it breaks, for good; default: it does not", 5e4
    )

    rules = (
        Rule(
            "tie.to_height_m",
            lambda tie: tie.to_height_m is None or tie.to == "neighbour",
            'is the height of a point of a neighbour; it needs to = "neighbour"',
        ),
    )

    @property
    def side(self) -> str:
        """The side from which it runs."""
        return self.from_

    @property
    def other_height(self) -> float:
        """Height of its point on what faces its side [m]."""
        return self.height_m if self.to_height_m is None else self.to_height_m

    @property
    def slack(self) -> float:
        """What is used up before it holds [m]."""
        return self.slack_m


#: tables of which a case may have several
ROWS: dict[str, type[CaseTable]] = {"stop": StopTable, "tie": TieTable, "neighbour": NeighbourTable}
MOST_ROWS = 20


def links_of_case(case: Any) -> tuple[Any, ...]:
    """Stops and ties of a case, in this order; those that could be read."""
    return (*getattr(case, "stop", ()), *getattr(case, "tie", ()))


def held_above(case: Any) -> bool:
    """Whether something may push the container above its lowest box: its joint forces do not follow from its motion."""
    links = links_of_case(case)
    if getattr(case, "neighbour", ()):
        return True
    if not links:
        return False
    first = case.container.height_m if case.container.box is None else case.container.box[0].height_m
    lowest = case.container.height_m if first is None else first
    return any(link.height_m > lowest * (1.0 + 1e-9) for link in links)


def holder_of(case: Any, link: Any) -> int:
    """Which container of a row has the point of a link, 0: that of the case; of a stop the last one on its side."""
    return outermost(case, link.side) if isinstance(link, StopTable) else link.neighbour or 0


def faced_by(case: Any, link: Any) -> int | None:
    """The container of a row to which a link runs; None where it does not run to one."""
    if isinstance(link, StopTable) or link.to != "neighbour":
        return None
    return beside_of(case, holder_of(case, link), link.side)


def name_of(number: int) -> str:
    """A container of a row in words."""
    return f"neighbour {number}" if number else "the container"


def _held(case: Any, name: str) -> list[Any]:
    """Stops or ties of a case whose container is there."""
    return [
        link
        for link in getattr(case, name, ())
        if holder_of(case, link) <= len(getattr(case, "neighbour", ()))
    ]


def _above(name: str) -> Rule:
    """No link is above the container that it holds."""

    def too_high(case: Any) -> str:
        for link in _held(case, name):
            number = holder_of(case, link)
            top = top_of(case, number)
            if link.height_m > top * (1.0 + 1e-9):
                return _above_it(number, top, link.height_m)
        return ""

    return refused(f"{name}.height_m", too_high)


def _above_it(number: int, top: float, height: float) -> str:
    return (
        f"must be at most the height of {name_of(number)}, {top:g} m, got {height:g} m; "
        "above it there is nothing to hold"
    )


def _too_high_there(case: Any) -> str:
    """Why a tie ends above what it runs to."""
    for tie in _held(case, "tie"):
        number = faced_by(case, tie)
        if number is not None and tie.other_height > (top := top_of(case, number)) * (1.0 + 1e-9):
            return _above_it(number, top, tie.other_height)
    return ""


def _ends_nowhere(case: Any) -> str:
    """Why there is nothing to which a tie could run."""
    for tie in _held(case, "tie"):
        number = holder_of(case, tie)
        beside = beside_of(case, number, tie.side)
        if tie.to == "wall" and beside is not None:
            return (
                f'must be "floor" or "neighbour" on the {tie.side} of {name_of(number)}: {name_of(beside)} stands '
                "before the wall there"
            )
        if tie.to == "neighbour" and beside is None:
            return f'= "neighbour" runs to nothing: on the {tie.side} of {name_of(number)} stands no [[neighbour]]'
    return ""


def _without_length(case: Any) -> str:
    """Why a tie between two containers has no direction."""
    for tie in _held(case, "tie"):
        number = holder_of(case, tie)
        other = faced_by(case, tie)
        if other is not None:
            length = math.hypot(gap_beside(case, number, other), tie.other_height - tie.height_m)
            if length < LEAST_LENGTH:
                return (
                    f"must be further from height_m over a gap so narrow: the tie is {1e3 * length:g} mm long, and "
                    "without a length of 1 mm it has no direction"
                )
    return ""


LINK_RULES = (
    Rule(
        "tie.neighbour",
        lambda case: len(_held(case, "tie")) == len(case.tie),
        lambda case: f"must be the number of a [[neighbour]]; the case has {len(case.neighbour)}",
    ),
    _above("stop"),
    _above("tie"),
    refused("tie.to", _ends_nowhere),
    refused("tie.to_height_m", _too_high_there),
    refused("tie.to_height_m", _without_length),
    Rule(
        "container.mesh_file",
        lambda case: case.container.mesh_file is None or not links_of_case(case),
        "cannot stand beside [[stop]] or [[tie]]: the sides of a mesh are not known",
    ),
)
