"""Meshes of stacks whose boxes differ, and of boxes that stand on one another without bolts.

Bolted boxes share the nodes of the face between them: the sides, wall faces and feet of every box are mesh lines of all
boxes that they cross. Boxes without bolts have meshes of their own, and share no node.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mesh.cells import FloatArray, IntArray
from mesh.container import ContainerMesh, box_cells, build_container_mesh, grid_quads, ring_regions
from mesh.elevation import Elevation
from mesh.errors import MeshError
from mesh.fill import MassFill, distribute_mass
from mesh.geometry import ContainerGeometry
from mesh.grid import MOST_CELLS, Segments, column_segments, column_size, row_segments, segments_between

#: Sides nearer than this share of the narrowest box are one mesh line.
SAME_LINE = 1e-9


@dataclass(frozen=True, kw_only=True)
class StackedBox:
    """One box and its place in a stack."""

    geometry: ContainerGeometry  #: of this box alone
    fill: MassFill
    axis: float  #: x of its axis; 0 of the lowest box [m]
    bottom: float  #: above the floor [m]

    @property
    def sides(self) -> tuple[float, float]:
        """x of its left and right side [m]."""
        return self.axis - 0.5 * self.geometry.width, self.axis + 0.5 * self.geometry.width


def build_loose_mesh(
    boxes: Sequence[StackedBox], *, element_size: float, foot: float | None = None
) -> ContainerMesh:
    """Structured meshes of boxes that share no node, as one mesh; boxes that are equal have equal cells.

    Args:
        boxes: from the floor up.
        element_size: length of the cells between walls, rounded to whole cells [m].
        foot: width of a foot at each corner of the lowest box, for mesh lines at its edge [m].

    Raises:
        MeshError: as `build_container_mesh`.
    """
    return placed_apart(
        boxes,
        [
            build_container_mesh(
                box.geometry, box.fill, element_size=element_size, foot=None if number else foot
            )
            for number, box in enumerate(boxes)
        ],
    )


def placed_apart(boxes: Sequence[StackedBox], meshes: Sequence[ContainerMesh]) -> ContainerMesh:
    """Meshes of single boxes, each standing on z = 0 and centred on x = 0, moved to their places as one mesh."""
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    return ContainerMesh(
        elevation=Elevation(
            np.concatenate(
                [
                    mesh.points + np.array([box.axis, box.bottom])
                    for box, mesh in zip(boxes, meshes, strict=True)
                ]
            ),
            np.concatenate([mesh.quads + start for start, mesh in zip(starts, meshes, strict=False)]),
        ),
        region=np.concatenate([mesh.region for mesh in meshes]),
        box=np.repeat(np.arange(len(meshes)), [len(mesh.quads) for mesh in meshes]),
        thickness=np.concatenate([mesh.thickness for mesh in meshes]),
        areal_density=np.concatenate([mesh.areal_density for mesh in meshes]),
    )


def require_apart(meshes: Sequence[ContainerMesh], nodes: Sequence[IntArray]) -> Sequence[ContainerMesh]:
    """The meshes of loose boxes, whose points are these nodes of a file.

    Raises:
        MeshError: two of them share nodes.
    """
    for number, (lower, upper) in enumerate(pairwise(nodes), 1):
        shared = np.intersect1d(lower, upper)
        if shared.size:
            raise MeshError(
                f"boxes {number} and {number + 1} share {shared.size} nodes, but loose boxes may not: give each box "
                "points and lines of its own (Gmsh: no Coherence, BooleanFragments or merging of duplicate nodes; "
                'Abaqus: one part a box), or take joints = "bolted"'
            )
    return meshes


def joined(
    boxes: Sequence[StackedBox], meshes: Sequence[ContainerMesh], nodes: Sequence[IntArray]
) -> ContainerMesh:
    """The meshes of bolted boxes, whose points are these nodes of a file, as one mesh that has each node once.

    Raises:
        MeshError: two of them do not share the nodes of the face between them.
    """
    apart = placed_apart(boxes, meshes)
    for number in range(len(boxes) - 1):
        height = boxes[number + 1].bottom
        sides = boxes[number].sides, boxes[number + 1].sides
        left, right = max(side[0] for side in sides), min(side[1] for side in sides)
        faces = []
        for k in (number, number + 1):
            x, z = apart.points[np.unique(apart.quads[apart.box == k])].T
            near = _near(boxes) / SAME_LINE * 1e-6
            on_face = (np.abs(z - height) <= near) & (x >= left - near) & (x <= right + near)
            faces.append(nodes[k][on_face])
        if not np.array_equal(*faces):
            raise MeshError(
                f"boxes {number + 1} and {number + 2} do not share the nodes of the face between them: merge "
                f"coincident points, put mesh lines of both at x = {left:g} and {right:g} m, or take "
                'joints = "loose"'
            )
    _, first, merged = np.unique(np.concatenate(nodes), return_index=True, return_inverse=True)
    return ContainerMesh(
        elevation=Elevation(apart.points[first], merged[apart.quads]),
        region=apart.region,
        box=apart.box,
        thickness=apart.thickness,
        areal_density=apart.areal_density,
    )


def box_mesh(mesh: ContainerMesh, number: int) -> ContainerMesh:
    """One box of a mesh of boxes that share no node, standing on z = 0 and centred on x = 0."""
    cells = np.flatnonzero(mesh.box == number)
    used, quads = np.unique(mesh.quads[cells], return_inverse=True)
    points = mesh.points[used]
    low, high = points.min(axis=0), points.max(axis=0)
    return ContainerMesh(
        elevation=Elevation(points - [0.5 * (low[0] + high[0]), low[1]], quads.reshape(-1, 4)),
        region=mesh.region[cells],
        box=np.zeros(len(cells), dtype=np.int64),
        thickness=mesh.thickness[cells],
        areal_density=mesh.areal_density[cells],
    )


def build_bolted_mesh(
    boxes: Sequence[StackedBox], *, element_size: float, foot: float | None = None, bears: bool = False
) -> ContainerMesh:
    """Structured mesh of boxes that differ and share the nodes of the faces between them; arguments as above.

    Raises:
        MeshError: more than `mesh.grid.MOST_CELLS` cells, a foot that does not fit, boxes that share no face, a mass
            or a centroid that cannot be met.
    """
    ends = _lines_of_all(boxes, element_size, foot)
    columns = segments_between(ends, column_size(boxes[0].geometry, element_size))
    x = columns.lines_from(ends)
    rows = [row_segments(box.geometry, element_size, bears=bears and box.bottom == 0.0) for box in boxes]
    spans = [np.searchsorted(x, np.add(box.sides, _near(boxes) * np.array([-1.0, -1.0]))) for box in boxes]
    cells = sum(int(stop - start) * row.count for (start, stop), row in zip(spans, rows, strict=True))
    if cells > MOST_CELLS:
        raise MeshError(
            f"the mesh would have {cells} cells; at most {MOST_CELLS} are allowed: take a larger element size"
        )
    for lower, upper in pairwise(spans):
        if not max(lower[0], upper[0]) < min(lower[1], upper[1]):
            raise MeshError("two boxes that stand on one another share no face")
    quads, data, z, first_row = [], [], [np.zeros(1)], 0
    all_quads = grid_quads(columns.count, sum(row.count for row in rows)).reshape(-1, columns.count, 4)
    for box, row, (start, stop) in zip(boxes, rows, spans, strict=True):
        own_x, own_z = x[start : stop + 1], row.lines()
        data.append(_cells_of(box, own_x, own_z))
        quads.append(all_quads[first_row : first_row + row.count, start:stop].reshape(-1, 4))
        z.append(box.bottom + own_z[1:])
        first_row += row.count
    heights = np.concatenate(z)
    points = np.column_stack([np.tile(x, len(heights)), np.repeat(heights, len(x))])
    used, numbers = np.unique(np.concatenate(quads), return_inverse=True)
    region, thickness, density = (np.concatenate(parts) for parts in zip(*data, strict=True))
    return ContainerMesh(
        elevation=Elevation(points[used], numbers.reshape(-1, 4)),
        region=region,
        box=np.repeat(np.arange(len(boxes)), [len(part) for part in quads]),
        thickness=thickness,
        areal_density=density,
    )


def _cells_of(box: StackedBox, x: FloatArray, z: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Region, thickness and areal density of the cells of one box between its lines x and z (above its bottom)."""
    points = np.column_stack([np.tile(x - box.axis, len(z)), np.repeat(z, len(x))])
    quads = grid_quads(len(x) - 1, len(z) - 1)
    region = ring_regions(box.geometry, x - box.axis + 0.5 * box.geometry.width, z)
    cells = box_cells(box.geometry, points, quads, region)
    density, region = distribute_mass(box.geometry, box.fill, cells)
    return region, cells.thickness, density


def _near(boxes: Sequence[StackedBox]) -> float:
    return SAME_LINE * min(box.geometry.width for box in boxes)


def _lines_of_all(boxes: Sequence[StackedBox], element_size: float, foot: float | None) -> FloatArray:
    """x at which any box has a line that all must have, rising; lines that fall together are those of the lower box."""
    merged: list[float] = []
    for number, box in enumerate(boxes):
        own: Segments = column_segments(box.geometry, element_size, None if number else foot)
        left, right = box.sides
        lines = left + np.cumsum([0.0, *own.lengths[:-1]])
        for line in (*lines, right):
            if all(abs(line - other) > _near(boxes) for other in merged):
                merged.append(float(line))
    return np.array(sorted(merged))
