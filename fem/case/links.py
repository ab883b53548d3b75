"""Stops and ties of a container: tables [[stop]] and [[tie]], of which a case may have several, and their rules.

A stop is a wall or a kerb that moves with the floor and stands beside a point of a side; a tie runs from such a point
down to the floor below it. Both hold nothing until their gap or slack is used up.
"""

from typing import Annotated, Any, Literal

from pydantic import Field

from fem.case import quantities as q
from fem.case.boxes import boxes_of
from fem.case.neighbours import NeighbourTable
from fem.case.problem import Rule, either
from fem.case.table import CaseTable, case_key

USUAL_STOP_DAMPING = 2.0  #: damping ratio of a stop that says nothing: it does not bounce


class StopTable(CaseTable):
    """A wall or kerb beside the container, which moves with the floor."""

    side: Literal["left", "right"] = case_key("of the container at which it stands", example="right")
    height_m: Annotated[float, q.LINK_HEIGHT] = case_key("of the point that it meets", example=0.1)
    gap_m: Annotated[float, q.GAP] = case_key("between container and stop at rest; a wedge: 0", example=0.05)
    stiffness_N_m: Annotated[float, q.LINK_STIFFNESS] = case_key(  # noqa: N815
        "of the stop at that point", example=1e8
    )
    damping_ratio: Annotated[float, q.CONTACT_DAMPING] | None = case_key(
        "c/(2 sqrt(k m)), the whole mass m on its stiffness k; default: 2", None, example=0.5
    )
    restitution: Annotated[float, q.STOP_RESTITUTION] | None = case_key(
        "in place of damping_ratio: of the whole mass that runs against it without turning", None, example=0.5
    )
    strength_N: Annotated[float, q.LINK_FORCE] | None = case_key(  # noqa: N815
        "force at which it breaks, for good; default: it does not", None, example=5e5
    )
    mu: Annotated[float, q.FRICTION] = case_key("of friction along its face", 0.0)

    rules = (either("stop.restitution", "damping_ratio"),)

    @property
    def slack(self) -> float:
        """What is used up before it holds [m]."""
        return self.gap_m


class TieTable(CaseTable):
    """A strap from a point of a side straight down to the floor; it pulls, and stays vertical."""

    from_: Literal["left", "right"] = Field(
        alias="from", description="side of the container from which it runs", examples=["left"]
    )
    height_m: Annotated[float, q.LINK_HEIGHT] = case_key("of its point", example=0.5)
    slack_m: Annotated[float, q.GAP] = case_key("how far its point rises before it holds", 0.0)
    stiffness_N_m: Annotated[float, q.LINK_STIFFNESS] = case_key("of the strap", example=1e6)  # noqa: N815
    strength_N: Annotated[float, q.LINK_FORCE] | None = case_key(  # noqa: N815
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
    return any(one.height_m > lowest * (1.0 + 1e-9) for one in links)


def _of_links(place: str, holds: Any, reason: Any) -> Rule:
    return Rule(place, lambda case: not links_of_case(case) or holds(case), reason)


def _above(name: str) -> Rule:
    """No link is above the stack."""

    def too_high(case: Any) -> list[Any]:
        top = boxes_of(case.container, case.gravity_m_s2)[-1].top
        return [one for one in getattr(case, name, ()) if one.height_m > top * (1.0 + 1e-9)]

    return Rule(
        f"{name}.height_m",
        lambda case: not too_high(case),
        lambda case: (
            f"must be at most the height of the container, "
            f"{boxes_of(case.container, case.gravity_m_s2)[-1].top:g} m, got {too_high(case)[0].height_m:g} m; "
            "above it there is nothing to hold"
        ),
    )


LINK_RULES = (
    _above("stop"),
    _above("tie"),
    _of_links(
        "container.joints",
        lambda case: case.container.joints == "bolted",
        'must be "bolted" with [[stop]] or [[tie]]: loose boxes have no points for them yet',
    ),
    _of_links(
        "container.mesh_file",
        lambda case: case.container.mesh_file is None,
        "cannot stand beside [[stop]] or [[tie]]: the sides of a mesh are not known",
    ),
)
