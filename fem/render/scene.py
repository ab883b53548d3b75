"""Meshes of a picture of a run: body, outline, floor, arrows; and the view that encloses them.

The elevation lies in the x-y plane; z, toward the eye, decides what covers what. Lengths in m.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pyvista

from fem.results.fields import STOP, Frame, spatial
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.edges import chained, outline_edges

#: the bilinear quads that a cell is drawn as, by its number of nodes
PARTS = {4: ((0, 1, 2, 3),), 9: ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3))}
CONTENT, LEAST_WIDTH = (1200, 760), 720  #: of the picture [pixels]
TOP, BOTTOM, SIDE, BAR = 112, 16, 24, 110  #: margins: text above, below, at the sides, scale bar [pixels]
STRESSED = 0.995  #: quantile of a frame's stresses that ends the colour scale
SLAB_SHARE = 0.16  #: depth of the slab over the container's height or width


@dataclass(frozen=True, kw_only=True)
class View:
    """The region of the elevation that a scene shows, the same for all frames."""

    left: float  #: of all that moves [m]
    right: float
    top: float
    depth: float  #: of the slab [m]
    floor: tuple[float, float]  #: range of the floor's displacement [m]
    lowest: float = 0.0  #: place of the floor that moves down, at most 0 [m]

    @property
    def below(self) -> float:
        """What lies below the place of the floor at rest [m]."""
        return self.depth - self.lowest

    @property
    def pixels_per_metre(self) -> float:
        """Scale of the picture."""
        return min(CONTENT[0] / (self.right - self.left), CONTENT[1] / (self.top + self.below))

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture, even, as video wants them [pixels]."""
        width = (self.right - self.left) * self.pixels_per_metre + 2 * SIDE + BAR
        height = (self.top + self.below) * self.pixels_per_metre + TOP + BOTTOM
        return 2 * math.ceil(0.5 * max(width, LEAST_WIDTH)), 2 * math.ceil(0.5 * height)

    @property
    def edges(self) -> tuple[float, float, float, float]:
        """Left, right, lower and upper edge of the picture [m]."""
        (width, height), scale = self.size, self.pixels_per_metre
        spare = (width - 2 * SIDE - BAR) / scale - (self.right - self.left)
        left = self.left - 0.5 * spare - SIDE / scale
        low = -self.below - BOTTOM / scale
        return left, left + width / scale, low, low + height / scale


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameSummary:
    """Extent and magnitudes of all frames, needed before the first is drawn."""

    view: View
    pressed: IntArray  #: nodes that ever carry contact pressure
    usual_pressure: float  #: the median over the frames of the largest [Pa]
    usual_stress: float  #: the median over the frames of the stress quantile [Pa]; 0 without stresses


def summarise_frames(frames: Iterable[Frame]) -> FrameSummary:
    """Read every frame once, one at a time."""
    lowest, highest = np.full(2, np.inf), np.full(2, -np.inf)
    size, pressed = 0.0, np.zeros(0, dtype=bool)
    floors, lifts, pressures, stresses = [], [0.0], [], []
    for frame in frames:
        places = frame.points + frame.displacement
        lowest, highest = np.minimum(lowest, places.min(axis=0)), np.maximum(highest, places.max(axis=0))
        size = float(np.ptp(frame.points, axis=0).max())
        carries = frame.contact_pressure > 0.0
        pressed = carries | pressed if len(pressed) else carries
        floors.append(frame.floor_displacement)
        lifts.append(frame.floor_lift)
        pressures.append(float(frame.contact_pressure.max()))
        if frame.von_mises is not None:
            stresses.append(float(np.quantile(frame.von_mises, STRESSED)))
    return FrameSummary(
        view=View(
            left=float(lowest[0]),
            right=float(highest[0]),
            top=float(highest[1]) + 0.02 * size,
            depth=SLAB_SHARE * size,
            floor=(min(floors), max(floors)),
            lowest=min(lifts),
        ),
        pressed=np.flatnonzero(pressed),
        usual_pressure=float(np.median([pressure for pressure in pressures if pressure > 0.0] or [1.0])),
        usual_stress=float(np.median(stresses or [0.0])),
    )


def body_of(frame: Frame) -> pyvista.PolyData:
    """The cells of the containers of a frame as flat faces on its nodes."""
    return _faces(frame, frame.cells[frame.region < STOP])


def links_of(frame: Frame) -> pyvista.PolyData:
    """Stops and ties of a frame, likewise."""
    return _faces(frame, frame.of_links)


def _faces(frame: Frame, cells: IntArray) -> pyvista.PolyData:
    parts = cells[:, PARTS[cells.shape[1]]].reshape(-1, 4)
    return pyvista.PolyData(spatial(frame.points), np.column_stack([np.full(len(parts), 4), parts]).ravel())


def outline_of(frame: Frame) -> pyvista.PolyData:
    """Outer edges of the container, its stops and ties, and the joints of its boxes, as lines on its nodes."""
    lines = chained(outline_edges(frame.cells, frame.box))
    return pyvista.PolyData(
        spatial(frame.points), lines=np.concatenate([[len(line), *line] for line in lines])
    )


def slab_of(view: View) -> pyvista.PolyData:
    """The floor, down to below the picture wherever it moves."""
    left, right, low, high = view.edges
    low -= high - low
    corners = [[left, low, -3.0], [right, low, -3.0], [right, 0.0, -3.0], [left, 0.0, -3.0]]
    return pyvista.PolyData(np.array(corners), [4, 0, 1, 2, 3])


def surface_of(view: View) -> pyvista.PolyData:
    """The surface of the floor, as a line."""
    left, right, _, _ = view.edges
    return pyvista.PolyData(np.array([[left, 0.0, -2.0], [right, 0.0, -2.0]]), lines=[2, 0, 1])


def hatches_of(view: View) -> pyvista.PolyData:
    """Strokes below the surface of the floor, over all of it that ever comes into view."""
    left, right, _, _ = view.edges
    length = 0.5 * view.depth
    first = math.floor((left - view.floor[1]) / length)
    last = math.ceil((right - view.floor[0]) / length) + 1
    x = length * np.arange(first, last + 1)
    upper = np.column_stack([x, np.zeros(len(x)), np.full(len(x), -2.5)])
    lower = upper - (0.6 * length, 0.6 * length, 0.0)
    lines = np.column_stack([np.full(len(x), 2), np.arange(len(x)), np.arange(len(x)) + len(x)])
    return pyvista.PolyData(np.concatenate([upper, lower]), lines=lines.ravel())


def mark_of(view: View) -> pyvista.PolyData:
    """A mark on the floor at the initial middle of the base: its distance from the middle shows the slip."""
    size = 0.2 * view.depth
    points = [[0.0, 0.0, 1.5], [-0.6 * size, -size, 1.5], [0.6 * size, -size, 1.5]]
    return pyvista.PolyData(np.array(points), [3, 0, 1, 2])


def arrows(count: int) -> pyvista.PolyData:
    """So many arrows, without length until `arrow_points` places them."""
    corner = 7 * np.arange(count)[:, None]
    heads = np.column_stack([np.full(count, 3), corner + np.arange(3)])
    shafts = np.column_stack([np.full(count, 4), corner + np.arange(3, 7)])
    return pyvista.PolyData(np.zeros((7 * count, 3)), np.concatenate([heads.ravel(), shafts.ravel()]))


def arrow_points(tips: FloatArray, share: FloatArray, *, depth: float) -> FloatArray:
    """Corners of an arrow below each node, pointing up at it; without area where there is no pressure.

    Args:
        tips: positions of the nodes, shape (n, 3) [m].
        share: pressure over the usual one, shape (n,); lengths are proportional to it up to the depth.
        depth: of the slab [m].
    """
    length = depth * np.minimum(0.42 * share, 0.92)
    head = np.minimum(0.3 * depth, length)
    wide = 0.08 * depth * (length > 0.0)
    thin = 0.3 * wide
    x, tip, neck, tail = tips[:, 0], tips[:, 1], tips[:, 1] - head, tips[:, 1] - length
    head_corners = ((x, tip), (x - wide, neck), (x + wide, neck))
    shaft_corners = ((x - thin, neck), (x + thin, neck), (x + thin, tail), (x - thin, tail))
    front = np.full(len(x), 2.0)
    corners = [np.column_stack([across, up, front]) for across, up in (*head_corners, *shaft_corners)]
    return np.stack(corners, axis=1).reshape(-1, 3)
