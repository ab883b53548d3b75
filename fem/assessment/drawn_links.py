"""Stops and ties as they are drawn: a wall that stands on the floor, a line from a point of a side to its other end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem.case.case import Case
from fem.case.tables.links import StopTable, faced_by, holder_of
from fem.case.tables.neighbours import gap_beside, places_of
from fem.model.tied_capacity import side_of
from fem.runtime.arrays import FloatArray, IntArray

WALL = 0.03  #: thickness of a stop over the height of the container
TO_WALL = 0.15  #: length of a tie to a wall over that height
REACH = 1.0  #: gap over that height beyond which a stop is out of the picture
INWARD = 1e-6  #: how far inside its side the end of a tie is sought, where containers touch [m]


@dataclass(frozen=True, kw_only=True)
class DrawnLink:
    """A stop or a tie on the floor at rest, x from the axis of the container of the case."""

    x: float  #: of the face of a stop, or of the point of a tie [m]
    outer: float  #: of the other end of a stop, or of the anchor of a tie [m]
    height: float  #: of its point [m]
    anchor: float | None = None  #: height of the anchor of a tie [m]
    outward: float  #: along x, 1 or -1
    joins: bool = False  #: its anchor is on another container, and moves with that
    until: float = math.inf  #: when it broke [s]

    @property
    def is_tie(self) -> bool:
        """Whether it pulls."""
        return self.anchor is not None


def drawn_links(case: Case, broken_s: Sequence[float] = ()) -> tuple[DrawnLink, ...]:
    """The stops and ties of a case, but for stops that are far away.

    Args:
        case: its links.
        broken_s: when each broke; empty: none did [s].
    """
    row, tallest = case.row, case.stack[-1].top
    axes = places_of(case, [alone.stack[0].width for alone in row]).x if row else (0.0,)
    drawn = []
    for link, until in zip(case.links, broken_s or [math.inf] * len(case.links), strict=True):
        side = axes[holder_of(case, link)] + side_of(case, link)
        outward = -1.0 if link.side == "left" else 1.0
        if not isinstance(link, StopTable):
            outer, anchor, other = side, 0.0, faced_by(case, link)
            if other is not None:
                outer = side + outward * gap_beside(case, holder_of(case, link), other)
                anchor = link.other_height
            elif link.to == "wall":
                outer, anchor = side + outward * TO_WALL * tallest, link.height_m
            drawn.append(
                DrawnLink(
                    x=side,
                    outer=outer,
                    height=link.height_m,
                    anchor=anchor,
                    outward=outward,
                    joins=other is not None,
                    until=until,
                )
            )
        elif link.gap_m <= REACH * tallest:
            x, thick = side + outward * link.gap_m, outward * WALL * tallest
            height = max(link.height_m, abs(thick))
            drawn.append(DrawnLink(x=x, outer=x + thick, height=height, outward=outward, until=until))
    return tuple(drawn)


def held_nodes(links: Sequence[DrawnLink], nodes: FloatArray) -> IntArray:
    """The nodes nearest to the ends of each link, (k, 2): to its point, and to its anchor on another container or -1.

    `nodes`: of the undeformed containers, (n, 2) [m].
    """

    def nearest(x: float, height: float) -> int:
        return int(np.hypot(*(nodes - (x, height)).T).argmin())

    ends = [
        (
            nearest(link.x - link.outward * INWARD, link.height),
            nearest(link.outer + link.outward * INWARD, link.anchor or 0.0) if link.joins else -1,
        )
        for link in links
    ]
    return np.array(ends, dtype=np.int64).reshape(-1, 2)
