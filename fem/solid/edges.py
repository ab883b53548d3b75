"""Outline of a container as pairs of nodes: its outer edges and the joints between its boxes."""

import numpy as np

from fem.runtime.arrays import FloatArray, IntArray

#: nodes along the sides of a cell, by its number of nodes in the order of VTK
SIDES = {4: ((0, 1), (1, 2), (2, 3), (3, 0)), 9: ((0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0))}
AT_JOINT = 1e-4  #: of the height, within which a side lies on a joint


def outline_edges(points: FloatArray, cells: IntArray, boxes: int = 1) -> IntArray:
    """Pairs of neighbouring nodes on the outline.

    Args:
        points: undeformed positions of the nodes, shape (n, 2) [m].
        cells: nodes of each cell in the order of VTK, shape (m, 4 or 9).
        boxes: of equal height, one on the other.

    Returns:
        Shape (k, 2).
    """
    sides = cells[:, SIDES[cells.shape[1]]].reshape(-1, len(SIDES[cells.shape[1]][0]))
    ends = np.sort(sides[:, [0, -1]], axis=1)
    _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
    height = points[:, 1].max()
    joints = height * np.arange(1, boxes) / boxes
    distance = np.abs(points[sides, 1][:, :, None] - joints).max(axis=1).min(axis=1, initial=np.inf)
    drawn = sides[first[(count == 1) | (distance[first] < AT_JOINT * height)]]
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
