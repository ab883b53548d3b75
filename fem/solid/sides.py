"""Points on the sides of a container that other bodies touch, by the nodes there."""

import numpy as np

from fem.runtime.arrays import FloatArray, IntArray


def nodes_at(points: FloatArray, nodes: FloatArray) -> IntArray:
    """The nodes of a structured mesh, of all (n, 2), that are nearest to points on its sides (k, 2), shape (k,)."""
    nearest = [side[np.argmin(np.abs(nodes[side, 1] - z))] for side, z in _sides(points, nodes)]
    return np.array(nearest, dtype=np.int64)


def shapes_at(points: FloatArray, nodes: FloatArray, shapes: FloatArray) -> FloatArray:
    """Shapes of modes (m, n, 2) at points on the sides (k, 2), (m, k, 2): linear between the nodes (n, 2) of a side."""
    values = np.empty((len(shapes), len(points), 2))
    for k, (side, z) in enumerate(_sides(points, nodes)):
        above = min(max(int(np.searchsorted(nodes[side, 1], z)), 1), side.size - 1)
        low, high = side[above - 1], side[above]
        share = (z - nodes[low, 1]) / (nodes[high, 1] - nodes[low, 1])
        values[:, k] = (1.0 - share) * shapes[:, low] + share * shapes[:, high]
    return values


def _sides(points: FloatArray, nodes: FloatArray) -> list[tuple[IntArray, float]]:
    """For each point the nodes, of all (n, 2), on the side where it is, from below; and its height [m]."""
    sides = []
    for x, z in points:
        on_side = np.flatnonzero(np.abs(nodes[:, 0] - x) <= 1e-9 * np.ptp(nodes[:, 0]))
        sides.append((on_side[np.argsort(nodes[on_side, 1])], float(z)))
    return sides
