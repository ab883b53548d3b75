"""Stops and ties as they are drawn: a wall that stands on the floor, a line from a point of a side to its other end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem.case.case import Case
from fem.case.tables.links import StopTable, holder_of
from fem.case.tables.neighbours import places_of
from fem.model.link_places import side_of
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
            outer, anchor = side, 0.0
            if link.to == "wall":
                outer, anchor = side + outward * TO_WALL * tallest, link.height_m
            drawn.append(
                DrawnLink(
                    x=side,
                    outer=outer,
                    height=link.height_m,
                    anchor=anchor,
                    outward=outward,
                    until=until,
                )
            )
        elif link.gap_m <= REACH * tallest:
            x, thick = side + outward * link.gap_m, outward * WALL * tallest
            height = max(link.height_m, abs(thick))
            drawn.append(DrawnLink(x=x, outer=x + thick, height=height, outward=outward, until=until))
    return tuple(drawn)


def held_nodes(links: Sequence[DrawnLink], nodes: FloatArray) -> IntArray:
    """The node nearest to the point of each link, (k,); `nodes`: of the undeformed containers, (n, 2) [m]."""
    points = ((link.x - link.outward * INWARD, link.height) for link in links)
    return np.array([np.hypot(*(nodes - point).T).argmin() for point in points], dtype=np.int64)
