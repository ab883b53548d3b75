"""Edges of a container: its outline as pairs of nodes, and points on its sides, which other bodies touch."""

import numpy as np
from numpy.typing import NDArray

from fem.runtime.arrays import FloatArray, IntArray

#: nodes along the sides of a cell, by its number of nodes in the order of VTK
SIDES = {4: ((0, 1), (1, 2), (2, 3), (3, 0)), 9: ((0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0))}


def outline_edges(cells: IntArray, kind: NDArray[np.integer]) -> IntArray:
    """Pairs of neighbouring nodes (k, 2) on sides that belong to one cell, or to cells of different kinds.

    `cells`: nodes of each in the order of VTK, (m, 4 or 9); `kind`: of each, such as its box, (m,).
    """
    sides = cells[:, SIDES[cells.shape[1]]].reshape(-1, len(SIDES[cells.shape[1]][0]))
    ends = np.sort(sides[:, [0, -1]], axis=1)
    _, first, inverse, count = np.unique(
        ends, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    kinds = np.repeat(kind, 4)
    least, most = np.full(len(first), np.iinfo(np.int64).max), np.full(len(first), np.iinfo(np.int64).min)
    np.minimum.at(least, inverse, kinds)
    np.maximum.at(most, inverse, kinds)
    drawn = sides[first[(count == 1) | (least != most)]]
    return np.concatenate([drawn[:, i : i + 2] for i in range(drawn.shape[1] - 1)])


def chained(edges: IntArray) -> list[list[int]]:
    """The same edges as a few long lines through the nodes, each edge once."""
    neighbours: dict[int, list[int]] = {}
    for start, end in edges.tolist():
        neighbours.setdefault(start, []).append(end)
        neighbours.setdefault(end, []).append(start)
    lines = []
    # Start at the ends of open lines, so that none is split.
    for node in sorted(neighbours, key=lambda node: len(neighbours[node]) % 2, reverse=True):
        while neighbours[node]:
            line = [node]
            while neighbours[line[-1]]:
                step = neighbours[line[-1]].pop()
                neighbours[step].remove(line[-1])
                line.append(step)
            lines.append(line)
    return lines


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
