"""Stops and ties of a container: tables [[stop]] and [[tie]], of which a case may have several, and their rules.

A stop is a wall or a kerb that moves with the floor and stands beside a point of a side; a tie runs from such a point
down to the floor below it, or level to a wall of that side. Both hold nothing until their gap or slack is used up. In a
row a stop stands at its end, and a tie holds the container of the case or a neighbour.
"""

from functools import partial
from operator import attrgetter
from typing import Annotated, Any, Literal

from pydantic import Field, Strict

from fem.case.tables import quantities as q
from fem.case.tables.neighbours import NeighbourTable, StruckTable, beside_of, outermost, top_of
from fem.case.tables.problem import Rule, left_out, refused
from fem.case.tables.table import CaseTable, case_key, optional_key


class StopTable(StruckTable):
    """A wall or kerb that moves with the floor, beside the container or, in a row, beside the last one of its side."""

    height_m: Annotated[float, q.LINK_HEIGHT] = case_key(
        "of the point that meets it; at a joint of loose boxes that of the lower box", example=0.1
    )
    strength_N: Annotated[float, q.LINK_FORCE] | None = optional_key(
        "force at which it breaks, for good; default: it does not", 5e5
    )

    @property
    def slack(self) -> float:
        """What is used up before it holds [m]."""
        return self.gap_m


class TieTable(CaseTable):
    """A strap from a point of a side of the container, or of a neighbour; it pulls.

    Straight down to the floor, or level to a wall that stands on that side and moves with the floor, it pulls always in
    one direction.
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
    to: Literal["floor", "wall"] = case_key('"floor": straight down | "wall": level, on that side', "floor")
    slack_m: Annotated[float, q.GAP] = case_key("how far its point moves away before it holds", 0.0)
    stiffness_N_m: Annotated[float, q.LINK_STIFFNESS] = case_key("of the strap", example=1e6)
    damping_ratio: Annotated[float, q.CONTACT_DAMPING] = case_key(
        "c/(2 sqrt(k m)), m the mass that it holds", 0.0
    )
    strength_N: Annotated[float, q.LINK_FORCE] | None = optional_key(
        "force at which it breaks, for good; default: it does not", 5e4
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


def held_above(case: Any) -> bool:
    """Whether something may push the container above its lowest box: its joint forces do not follow from its motion."""
    box = case.container
    return bool(case.neighbour) or any(
        link.height_m > ((box.box or (box,))[0].height_m or box.height_m) * (1.0 + 1e-9)
        for link in case.links
    )


def holder_of(case: Any, link: Any) -> int:
    """Which container of a row has the point of a link, 0: that of the case; of a stop the last one on its side."""
    return outermost(case, link.side) if isinstance(link, StopTable) else link.neighbour or 0


def name_of(number: int) -> str:
    """A container of a row in words."""
    return f"neighbour {number}" if number else "the container"


def _held(case: Any, name: str) -> list[Any]:
    """Stops or ties of a case whose container is there."""
    return [link for link in getattr(case, name) if holder_of(case, link) <= len(case.neighbour)]


def _too_high(case: Any, name: str) -> str:
    """Why a stop or a tie is above the container that it holds; empty where none is."""
    for link in _held(case, name):
        number = holder_of(case, link)
        top = top_of(case, number)
        if link.height_m > top * (1.0 + 1e-9):
            return (
                f"must be at most the height of {name_of(number)}, {top:g} m, got {link.height_m:g} m; "
                "above it there is nothing to hold"
            )
    return ""


def _before_the_wall(case: Any) -> str:
    """Why there is no wall to which a tie could run."""
    for tie in _held(case, "tie"):
        number = holder_of(case, tie)
        before = beside_of(case, number, tie.side)
        if tie.to == "wall" and before is not None:
            return (
                f'must be "floor" on the {tie.side} of {name_of(number)}: {name_of(before)} stands before the wall '
                "there"
            )
    return ""


LINK_RULES = (
    Rule(
        "tie.neighbour",
        lambda case: len(_held(case, "tie")) == len(case.tie),
        lambda case: f"must be the number of a [[neighbour]]; the case has {len(case.neighbour)}",
    ),
    refused("stop.height_m", partial(_too_high, name="stop")),
    refused("tie.height_m", partial(_too_high, name="tie")),
    refused("tie.to", _before_the_wall),
    *left_out(
        attrgetter("links"),
        {"container.mesh_file": "cannot stand beside [[stop]] or [[tie]]: the sides of a mesh are not known"},
    ),
)
