"""Stops and ties as cells in the fields of a run, behind those of the containers."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contact.stepping.state import RunState
from fem.assessment.drawn_links import DrawnLink, drawn_links, held_nodes
from fem.model.model import Model
from fem.results.fields import STOP, TIE, FrameFields
from fem.runtime.arrays import FloatArray

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
        links = drawn_links(self._case, _broken(run, len(self._case.links)))
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


def _broken(run: RunState, count: int) -> Sequence[float]:
    return [float(link.broken_at) for link in run.links[len(run.links) - count :]]
