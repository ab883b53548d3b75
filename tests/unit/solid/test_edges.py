"""The outline of a container, as edges between nodes and as lines through them."""

from itertools import pairwise

import numpy as np
import pytest

from fem.solid.edges import chained, outline_edges

QUADS9 = np.array([[0, 2, 8, 6, 1, 5, 7, 3, 4]])


def test_the_outline_is_the_outer_edges_and_the_joints():
    # Two boxes of one cell each, one on the other.
    points = np.array([[x, z] for z in (0.0, 0.5, 1.0, 1.5, 2.0) for x in (0.0, 0.5, 1.0)])
    cells = np.concatenate([QUADS9, QUADS9 + 6])
    edges = outline_edges(cells, np.array([0, 1]))
    lengths = np.linalg.norm(np.diff(points[edges], axis=1)[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(2.0 + 4.0 + 1.0)
    assert np.linalg.norm(
        np.diff(points[outline_edges(cells, np.zeros(2, dtype=int))], axis=1)[:, 0], axis=1
    ).sum() == pytest.approx(6.0)
    lines = chained(edges)
    drawn = sorted(tuple(sorted(pair)) for line in lines for pair in pairwise(line))
    assert drawn == sorted(tuple(sorted(pair)) for pair in edges.tolist())
    assert len(lines) <= 2
