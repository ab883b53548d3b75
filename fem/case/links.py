"""Stops and ties of a container: tables [[stop]] and [[tie]], of which a case may have several, and their rules.

A stop is a wall or a kerb that moves with the floor and stands beside a point of a side; a tie runs from such a point
down to the floor below it, or level to a wall of that side. Both hold nothing until their gap or slack is used up. In a
row a stop stands at its end, and a tie holds the container of the case.
"""

from typing import Annotated, Any, Literal

from pydantic import Field

from fem.case import quantities as q
from fem.case.neighbours import NeighbourTable, StruckTable, outermost, top_of
from fem.case.problem import Rule, either
from fem.case.table import CaseTable, case_key


class StopTable(StruckTable):
    """A wall or kerb that moves with the floor, beside the container or, in a row, beside the last one of its side."""

    height_m: Annotated[float, q.LINK_HEIGHT] = case_key(
        "of the point that meets it; at a joint of loose boxes that of the lower box", example=0.1
    )
    strength_N: Annotated[float, q.LINK_FORCE] | None = case_key(
        "force at which it breaks, for good; default: it does not", None, example=5e5
    )

    rules = (either("stop.restitution", "damping_ratio"),)

    @property
    def slack(self) -> float:
        """What is used up before it holds [m]."""
        return self.gap_m


class TieTable(CaseTable):
    """A strap from a point of a side of the container; it pulls, and always in one direction.

    Straight down to the floor, or level to a wall that stands on that side and moves with the floor.
    """

    from_: Literal["left", "right"] = Field(
        alias="from", description="side of the container from which it runs", examples=["left"]
    )
    height_m: Annotated[float, q.LINK_HEIGHT] = case_key(
        "of its point; at a joint of loose boxes that of the lower box", example=0.5
    )
    to: Literal["floor", "wall"] = case_key('"floor": straight down | "wall": level, on that side', "floor")
    slack_m: Annotated[float, q.GAP] = case_key("how far its point moves away before it holds", 0.0)
    stiffness_N_m: Annotated[float, q.LINK_STIFFNESS] = case_key("of the strap", example=1e6)
    strength_N: Annotated[float, q.LINK_FORCE] | None = case_key(
        "force at which it breaks, for good; default: it does not", None, example=5e4
    )

    @property
    def side(self) -> str:
        """The side from which it runs."""
        return self.from_

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
    """Which container of a row has the point of a link: the last one on the side of a stop; 0: that of the case."""
    return outermost(case, link.side) if isinstance(link, StopTable) else 0


def _above(name: str) -> Rule:
    """No link is above the container that it holds."""

    def too_high(case: Any) -> str:
        for one in getattr(case, name, ()):
            number = holder_of(case, one)
            top = top_of(case, number)
            if one.height_m > top * (1.0 + 1e-9):
                which = f"neighbour {number}" if number else "the container"
                return (
                    f"must be at most the height of {which}, {top:g} m, got {one.height_m:g} m; "
                    "above it there is nothing to hold"
                )
        return ""

    return Rule(f"{name}.height_m", lambda case: not too_high(case), too_high)


LINK_RULES = (
    _above("stop"),
    _above("tie"),
    Rule(
        "tie.to",
        lambda case: (
            not any(one.to == "wall" and outermost(case, one.side) for one in getattr(case, "tie", ()))
        ),
        'must be "floor" on a side with a [[neighbour]], which stands before the wall',
    ),
    Rule(
        "container.mesh_file",
        lambda case: case.container.mesh_file is None or not links_of_case(case),
        "cannot stand beside [[stop]] or [[tie]]: the sides of a mesh are not known",
    ),
)
