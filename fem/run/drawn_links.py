"""Stops and ties as they are drawn, and as cells in the fields of a run, behind those of the containers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact.stepping.state import RunState
from fem.case.case import Case
from fem.case.tables.links import StopTable, holder_of
from fem.case.tables.neighbours import places_of
from fem.model.link_places import side_of
from fem.model.model import Model
from fem.results.fields import STOP, TIE, FrameFields
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
    """The stops and ties of a case, but for stops that are far away; when each broke, if any did [s]."""
    row, tallest = case.row, case.stack[-1].top
    axes = places_of(case, [alone.stack[0].width for alone in row]).x if row else (0.0,)
    drawn = []
    for link, until in zip(case.links, broken_s or [math.inf] * len(case.links), strict=True):
        side = axes[holder_of(case, link)] + side_of(case, link)
        outward = -1.0 if link.side == "left" else 1.0
        anchor: float | None = None
        if isinstance(link, StopTable):
            if link.gap_m > REACH * tallest:
                continue
            x, thick = side + outward * link.gap_m, outward * WALL * tallest
            outer, height = x + thick, max(link.height_m, abs(thick))
        else:
            x, outer, height, anchor = side, side, link.height_m, 0.0
            if link.to == "wall":
                outer, anchor = side + outward * TO_WALL * tallest, height
        drawn.append(DrawnLink(x=x, outer=outer, height=height, anchor=anchor, outward=outward, until=until))
    return tuple(drawn)


def held_nodes(links: Sequence[DrawnLink], nodes: FloatArray) -> IntArray:
    """The node nearest to the point of each link, (k,); `nodes`: of the undeformed containers, (n, 2) [m]."""
    points = ((link.x - link.outward * INWARD, link.height) for link in links)
    return np.array([np.hypot(*(nodes - point).T).argmin() for point in points], dtype=np.int64)


#: nodes of a cell on the unit square, in the order of VTK; a bilinear cell has the first four
SQUARE = np.array(
    [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5), (0.5, 0.5)], dtype=float
)
STRAP = 0.005  #: width of a tie over its length


class LinkCells:
    """The mesh of the fields of a run, and their values on its links; without links those of the containers."""

    def __init__(self, model: Model) -> None:
        self._case, elements = model.case, model.container.elements
        links = drawn_links(self._case)
        square = SQUARE[: elements.cells.shape[1]]
        self._held, self._count = held_nodes(links, elements.nodes), len(square)
        #: share of the motion of its point, of each node; the rest is that of its other end
        self._share = np.array([square[:, 1] * link.is_tie for link in links]).reshape(-1, 1)
        behind = len(elements.nodes) + np.arange(self._share.size).reshape(-1, self._count)
        self.mesh: dict[str, Any] = {
            "points": np.concatenate([elements.nodes, *(_nodes(link, square) for link in links)]),
            "cells": np.concatenate([elements.cells, behind]),
            "region": np.append(
                elements.region.astype(np.int64), [TIE if link.is_tie else STOP for link in links]
            ),
            "box": np.append(1 + elements.box.astype(np.int64), [0] * len(links)),
        }

    def added_to(self, frame: FrameFields, run: RunState) -> FrameFields:
        """A frame of the containers with its links; what is broken has shrunk to a point."""
        if not self._share.size:
            return frame
        broken = [float(link.broken_at) for link in run.links[len(run.links) - len(self._case.links) :]]
        links = drawn_links(self._case, broken)
        held, nothing = np.repeat(self._held, self._count), np.zeros(self._share.size)
        far_end = np.array((frame.floor_displacement, frame.floor_lift))
        moved = far_end + self._share * (frame.displacement[held] - far_end)
        first = len(frame.displacement)
        for k, link in enumerate(links):
            if link.until <= frame.time:
                own = slice(k * self._count, (k + 1) * self._count)
                moved[own] = far_end + ((link.outer, link.anchor or 0.0) - self.mesh["points"][first:][own])
        return replace(
            frame,
            displacement=np.concatenate([frame.displacement, moved]),
            velocity=np.concatenate([frame.velocity, np.zeros_like(moved)]),
            von_mises=None if frame.von_mises is None else np.append(frame.von_mises, nothing),
            contact_pressure=np.append(frame.contact_pressure, nothing),
        )


def _nodes(link: DrawnLink, square: FloatArray) -> FloatArray:
    """Nodes of a cell at rest; of a tie from its anchor, along the second axis of the square, to its point."""
    if link.anchor is None:
        return (min(link.x, link.outer), 0.0) + np.array((abs(link.outer - link.x), link.height)) * square
    along = np.array((link.x - link.outer, link.height - link.anchor))
    across = STRAP * along[::-1] * (1.0, -1.0)
    moved: FloatArray = (link.outer, link.anchor) + square[:, 1:] * along + (square[:, :1] - 0.5) * across
    return moved
