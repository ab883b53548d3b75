"""Mesh lines of a structured container.

There are always lines at the faces of the walls and posts and at the edges of the feet; between them the spacing is
even and as near to the element size as whole cells permit.
"""

import math
from dataclasses import dataclass

import numpy as np

from mesh.cells import FloatArray
from mesh.errors import MeshError
from mesh.geometry import ContainerGeometry

#: Meshes with more cells are refused before memory is allocated.
MOST_CELLS = 2_000_000

#: A foot line nearer than this share of the wall (or of a cell, at the middle) is moved onto the other
#: line: a column that thin would refine nothing and only stiffen the numbers.
MERGE_SHARE = 0.1

#: Columns of a cylinder at least: its moment of inertia is then within 0.5 % of that of the circle.
ROUND_COLUMNS = 24

#: Narrowest foot, as a share of the width.
LEAST_FOOT = 1e-3


@dataclass(frozen=True, kw_only=True)
class Segments:
    """Consecutive intervals of a coordinate, each divided evenly."""

    lengths: tuple[float, ...]  #: [m]
    counts: tuple[int, ...]  #: cells in each

    @property
    def count(self) -> int:
        """Cells in all segments."""
        return sum(self.counts)

    def lines(self) -> FloatArray:
        """Mesh lines from 0 to the sum of the lengths, shape (count + 1,) [m]."""
        return self.lines_from(np.concatenate(([0.0], np.cumsum(self.lengths))))

    def lines_from(self, ends: FloatArray) -> FloatArray:
        """Mesh lines where the ends of the segments are given, shape (count + 1,) [m]."""
        inner = [
            np.linspace(start, stop, count + 1)[:-1]
            for start, stop, count in zip(ends[:-1], ends[1:], self.counts, strict=True)
        ]
        return np.concatenate([*inner, ends[-1:]])


def segments_between(ends: FloatArray, element_size: float) -> Segments:
    """The intervals between rising lines, each divided evenly."""
    lengths = np.diff(ends).tolist()
    return Segments(lengths=tuple(lengths), counts=tuple(_cells(length, element_size) for length in lengths))


def column_segments(geometry: ContainerGeometry, element_size: float, foot: float | None = None) -> Segments:
    """Columns of the container from its left to its right side, symmetric."""
    distances = {geometry.wall} if geometry.wall is not None else set()
    if geometry.post is not None:
        distances.update(geometry.post.lines)
    if foot is not None:
        distances.add(foot_line(geometry, element_size, foot))
    return _mirrored(sorted(distances), geometry.width, column_size(geometry, element_size))


def column_size(geometry: ContainerGeometry, element_size: float) -> float:
    """Length of the cells along x [m]: of a cylinder, whose depth differs from column to column, at most a 24th."""
    return min(element_size, geometry.width / ROUND_COLUMNS) if geometry.round else element_size


def row_segments(geometry: ContainerGeometry, element_size: float, *, bears: bool = False) -> Segments:
    """Rows of one box from its floor to its lid, symmetric.

    Where a shell bears along its base, its sheets spread the forces just above the bottom plate: rows of a quarter and
    of half the element size there halve the error of the stress and more.
    """
    wall, height = geometry.wall, geometry.height
    if wall is None:
        return _mirrored([], height, element_size)
    if not bears or height - 2.0 * wall < 2.0 * element_size:
        return _mirrored([wall], height, element_size)
    fine = wall + 0.25 * element_size, wall + 0.75 * element_size
    return segments_between(np.array([0.0, wall, *fine, height - wall, height]), element_size)


def foot_line(geometry: ContainerGeometry, element_size: float, foot: float) -> float:
    """Distance from each corner of the mesh line that ends the foot [m].

    It is `foot`, unless a face of the wall or the middle of the base is so near that the column between them
    would be too thin (`MERGE_SHARE`): then it is that line.

    Raises:
        MeshError: a foot that is not positive, wider than half the base, or narrower than a thousandth of it.
    """
    half = 0.5 * geometry.width
    if not 0.0 < foot <= half * (1.0 + 1e-12):
        raise MeshError(f"foot must be above 0 and at most half the width, {half} m, got {foot} m")
    if foot < LEAST_FOOT * geometry.width:
        raise MeshError(
            f"a foot of {foot} m is less than {LEAST_FOOT:g} of the width {geometry.width} m; "
            "use support kind corners"
        )
    wall = geometry.wall
    if wall is not None and abs(foot - wall) < MERGE_SHARE * min(wall, element_size):
        return wall
    if 2.0 * (half - foot) < MERGE_SHARE * min(element_size, geometry.width):
        return half
    return foot


def require_affordable(geometry: ContainerGeometry, columns: Segments, rows: Segments) -> None:
    """Refuse a mesh of more than `MOST_CELLS` cells, giving its number."""
    cells = columns.count * rows.count * geometry.boxes
    if cells > MOST_CELLS:
        raise MeshError(
            f"the mesh would have {cells} cells ({columns.count} columns, {rows.count} rows a box, "
            f"{geometry.boxes} boxes); at most {MOST_CELLS} are allowed: take a larger element size"
        )


def _mirrored(distances: list[float], total: float, element_size: float) -> Segments:
    """Segments between lines at `distances` from both ends of a side of length `total`."""
    half = [stop - start for start, stop in zip([0.0, *distances], distances, strict=False)]
    middle = total - 2.0 * sum(half)
    if distances and distances[-1] == 0.5 * total:
        lengths = [*half, *reversed(half)]
    else:
        lengths = [*half, middle, *reversed(half)]
    return Segments(lengths=tuple(lengths), counts=tuple(_cells(length, element_size) for length in lengths))


def _cells(length: float, element_size: float) -> int:
    if not (element_size > 0.0 and math.isfinite(element_size)):
        raise MeshError(f"element size must be positive and finite, got {element_size} m")
    share = length / element_size
    if share > MOST_CELLS:  # before rounding: a share may be infinite
        raise MeshError(
            f"an element size of {element_size} m would cut {length} m into {share:.3g} cells; "
            f"at most {MOST_CELLS} cells are allowed in all: take a larger element size"
        )
    return max(1, round(share))
