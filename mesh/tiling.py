"""Check that cells tile the elevation of a container: no gap, crack, overlap or hanging point.

In a mesh without cracks every inner edge belongs to two cells, and the edges of only one cell are on the sides of
the box. Then, by Green's theorem, there is no overlap if the areas add up to the area of the box.
"""

import numpy as np

from mesh.cells import FloatArray, IntArray, signed_areas
from mesh.errors import MeshError

#: Relative tolerance on the dimensions and the area of a mesh from a file.
TOLERANCE = 1e-6


def place_on_floor(points: FloatArray, width: float, height: float) -> FloatArray:
    """Points (n, 2) shifted to z = 0 and centred on x = 0; points on a side are moved exactly onto it [m].

    Raises:
        MeshError: the points do not fill a box of `width` and `height`.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.array([width, height])
    if not (np.abs(high - low - size) <= TOLERANCE * size).all():
        raise MeshError(
            f"the mesh is {high[0] - low[0]:.9g} m wide and {high[1] - low[1]:.9g} m high, "
            f"the container {width:.9g} m and {height:.9g} m (all boxes); mesh files are read in m"
        )
    placed = points - [0.5 * (low[0] + high[0]), low[1]]
    for axis, sides in ((0, (-0.5 * width, 0.5 * width)), (1, (0.0, height))):
        for side in sides:
            placed[np.abs(placed[:, axis] - side) <= TOLERANCE * size[axis], axis] = side
    return placed


def require_tiling(points: FloatArray, quads: IntArray, width: float, height: float) -> None:
    """Refuse counter-clockwise cells that do not tile the box placed by `place_on_floor`.

    Raises:
        MeshError: an edge of more than two cells, an inner edge of only one, areas that do not add up.
    """
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    pairs, counts = np.unique(edges, axis=0, return_counts=True)
    if counts.max() > 2:
        raise MeshError(
            f"{int(counts.max())} cells share the edge {_where(points, pairs[np.argmax(counts)])}"
        )
    free = pairs[counts == 1]
    start, stop = points[free[:, 0]], points[free[:, 1]]
    on_side = np.zeros(len(free), dtype=bool)
    for axis, sides in ((0, (-0.5 * width, 0.5 * width)), (1, (0.0, height))):
        for side in sides:
            on_side |= (start[:, axis] == side) & (stop[:, axis] == side)
    if not on_side.all():
        raise MeshError(
            f"the edge {_where(points, free[np.argmin(on_side)])} is inside the container but belongs to "
            f"one cell only ({int(np.sum(~on_side))} such edges): merge coincident points, remove hanging "
            "ones, close gaps"
        )
    area = float(signed_areas(points, quads).sum())
    if not abs(area - width * height) <= TOLERANCE * width * height:
        raise MeshError(
            f"the cells cover {area:.9g} m2 of an elevation of {width * height:.9g} m2: they overlap"
        )


def _where(points: FloatArray, edge: IntArray) -> str:
    (x0, z0), (x1, z1) = points[edge]
    return f"from x = {x0:.6g} m, z = {z0:.6g} m to x = {x1:.6g} m, z = {z1:.6g} m"
