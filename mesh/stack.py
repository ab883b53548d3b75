"""Meshes of stacks whose boxes differ, of boxes that stand on one another without bolts, and of containers in a row.

Bolted boxes share the nodes of the face between them: the sides, wall faces and feet of every box are mesh lines of all
boxes that they cross. Boxes without bolts have meshes of their own, and share no node.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mesh.cells import FloatArray, IntArray
from mesh.container import (
    MOST_CELLS,
    ContainerMesh,
    box_cells,
    build_container_mesh,
    column_segments,
    column_size,
    grid_quads,
    ring_regions,
    row_segments,
    segments_between,
)
from mesh.elevation import Elevation
from mesh.errors import MeshError
from mesh.fill import MassFill, distribute_mass
from mesh.geometry import ContainerGeometry

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


@dataclass(frozen=True, kw_only=True, eq=False)
class MeshArrays:
    """What the assembly needs of a mesh; it has no mass, base or quality."""

    points: FloatArray  #: (n, 2) [m]
    quads: IntArray  #: (m, 4), counter-clockwise
    region: IntArray  #: (m,)
    box: IntArray  #: (m,)
    thickness: FloatArray  #: (m,) [m]
    areal_density: FloatArray  #: (m,) [kg/m2]


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
    meshes = [
        build_container_mesh(box.geometry, box.fill, element_size=element_size, foot=None if number else foot)
        for number, box in enumerate(boxes)
    ]
    return placed_apart(boxes, meshes)


def placed_apart(boxes: Sequence[StackedBox], meshes: Sequence[ContainerMesh]) -> ContainerMesh:
    """Meshes of single boxes, each standing on z = 0 and centred on x = 0, moved to their places as one mesh."""
    arrays = _side_by_side(meshes, [(box.axis, box.bottom) for box in boxes])
    return ContainerMesh(
        elevation=Elevation(arrays.points, arrays.quads),
        region=arrays.region,
        box=arrays.box,
        thickness=arrays.thickness,
        areal_density=arrays.areal_density,
    )


def mesh_of_row(meshes: Sequence[ContainerMesh], x: Sequence[float]) -> MeshArrays:
    """The meshes of containers in a row as one, with their axes at x [m]."""
    return _side_by_side(meshes, [(at, 0.0) for at in x])


def _side_by_side(meshes: Sequence[ContainerMesh], places: Sequence[tuple[float, float]]) -> MeshArrays:
    """All meshes in their order, moved to their places [m]."""
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    boxes = np.cumsum([0, *(1 + mesh.box.max() for mesh in meshes)])
    return MeshArrays(
        points=np.concatenate(
            [mesh.points + np.array(place) for mesh, place in zip(meshes, places, strict=True)]
        ),
        quads=np.concatenate([mesh.quads + start for mesh, start in zip(meshes, starts[:-1], strict=True)]),
        region=np.concatenate([mesh.region for mesh in meshes]),
        box=np.concatenate([mesh.box + first for mesh, first in zip(meshes, boxes[:-1], strict=True)]),
        thickness=np.concatenate([mesh.thickness for mesh in meshes]),
        areal_density=np.concatenate([mesh.areal_density for mesh in meshes]),
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
        MeshError: more than `MOST_CELLS` cells, a foot that does not fit, boxes that share no face, a mass or a
            centroid that cannot be met.
    """
    near = SAME_LINE * min(box.geometry.width for box in boxes)
    # lines that all boxes must have; of those that fall together that of the lower box
    ends: list[float] = []
    for number, box in enumerate(boxes):
        own = column_segments(box.geometry, element_size, None if number else foot)
        left, right = box.sides
        for line in (*(left + np.cumsum([0.0, *own.lengths[:-1]])), right):
            if all(abs(line - other) > near for other in ends):
                ends.append(float(line))
    ends.sort()
    columns = segments_between(np.array(ends), column_size(boxes[0].geometry, element_size))
    x = columns.lines(np.array(ends))
    rows = [row_segments(box.geometry, element_size, bears=bears and box.bottom == 0.0) for box in boxes]
    spans = [np.searchsorted(x, np.array(box.sides) - near) for box in boxes]
    count = sum(int(stop - start) * row.count for (start, stop), row in zip(spans, rows, strict=True))
    if count > MOST_CELLS:
        raise MeshError(
            f"the mesh would have {count} cells; at most {MOST_CELLS} are allowed: take a larger element size"
        )
    for lower, upper in pairwise(spans):
        if not max(lower[0], upper[0]) < min(lower[1], upper[1]):
            raise MeshError("two boxes that stand on one another share no face")
    quads, data, z, first_row = [], [], [np.zeros(1)], 0
    all_quads = grid_quads(columns.count, sum(row.count for row in rows)).reshape(-1, columns.count, 4)
    for box, row, (start, stop) in zip(boxes, rows, spans, strict=True):
        own_x, own_z = x[start : stop + 1] - box.axis, row.lines()
        points = np.column_stack([np.tile(own_x, len(own_z)), np.repeat(own_z, len(own_x))])
        region = ring_regions(box.geometry, own_x + 0.5 * box.geometry.width, own_z)
        cells = box_cells(box.geometry, points, grid_quads(len(own_x) - 1, len(own_z) - 1), region)
        density, region = distribute_mass(box.geometry, box.fill, cells)
        data.append((region, cells.thickness, density))
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
