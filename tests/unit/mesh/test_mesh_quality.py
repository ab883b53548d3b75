"""Scaled Jacobian of quadrilaterals with known angles, and what is refused with which figures."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mesh.elevation import corner_angles, require_quality, scaled_jacobian
from mesh.errors import MeshQualityError

QUAD = np.array([[0, 1, 2, 3]])


def parallelogram(angle_degrees: float, length: float = 1.0, side: float = 1.0) -> np.ndarray:
    """Corner angle at the origin, `length` along x, `side` up the slope."""
    up = side * np.array([math.cos(math.radians(angle_degrees)), math.sin(math.radians(angle_degrees))])
    return np.array([[0.0, 0.0], [length, 0.0], [length + up[0], up[1]], up])


@given(
    length=st.floats(1e-3, 1e3),
    side=st.floats(2e-6, 1e3),
    turn=st.floats(0.0, 2.0 * math.pi),
)
def test_rectangle_scores_one_however_thin_and_however_turned(length, side, turn):
    c, s = math.cos(turn), math.sin(turn)
    points = parallelogram(90.0, length, side) @ np.array([[c, s], [-s, c]])
    # Rounding of the corners' positions, seen from the shorter side.
    rounding = 1e-14 * max(length, side) / min(length, side)
    assert scaled_jacobian(points, QUAD)[0] == pytest.approx(1.0, abs=max(1e-12, rounding**2, rounding))


@given(angle=st.floats(5.0, 175.0), length=st.floats(0.01, 10.0), scale=st.sampled_from([1e-6, 1.0, 1e6]))
def test_parallelogram_scores_the_sine_of_its_angle_at_any_size(angle, length, scale):
    # Knupp (2000): the cross product of unit edge vectors.
    points = scale * parallelogram(angle, length)
    assert scaled_jacobian(points, QUAD)[0] == pytest.approx(math.sin(math.radians(angle)), rel=1e-9)
    assert corner_angles(points, QUAD)[0] == pytest.approx([angle, 180 - angle, angle, 180 - angle], rel=1e-9)


def test_worst_corner_counts():
    # A right trapezium: 90, 90, 135 and 45 degrees.
    points = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert scaled_jacobian(points, QUAD)[0] == pytest.approx(math.sqrt(0.5), rel=1e-15)
    assert sorted(corner_angles(points, QUAD)[0]) == pytest.approx([45.0, 90.0, 90.0, 135.0])


@pytest.mark.parametrize(
    "points",
    [
        [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]],  # two corners coincide
        [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]],  # on a line
        [[0.5, 0.5]] * 4,  # a point
        [[0.0, 0.0], [1.0, 0.0], [0.5 + 1e-10, 0.866], [0.5, 0.866]],  # a triangle but for rounding
        [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]],  # a bow tie
        [[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]],  # a corner that points inwards
    ],
)
def test_cells_without_area_folded_or_with_an_inward_corner_are_refused(points):
    with pytest.raises(MeshQualityError, match="inverted, folded or without area"):
        require_quality(np.array(points), QUAD)
