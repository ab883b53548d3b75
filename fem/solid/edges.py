"""Outline of a container as pairs of nodes: its outer edges, and those between cells of different kinds."""

import numpy as np
from numpy.typing import NDArray

from fem.runtime.arrays import IntArray

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
