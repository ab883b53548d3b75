"""Scaled Jacobian of quadrilaterals with known angles, and what is refused with which figures."""

import math
from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mesh.errors import MeshError, MeshQualityError
from mesh.quality import corner_angles, require_quality, scaled_jacobian

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


def test_refusal_names_the_worst_cell_with_its_figures():
    good = parallelogram(90.0)
    bad = parallelogram(8.0) + np.array([5.0, 3.0])
    worse = parallelogram(5.0) + np.array([10.0, 3.0])
    points = np.concatenate([good, bad, worse])
    quads = np.arange(12).reshape(3, 4)
    with pytest.raises(MeshQualityError) as caught:
        require_quality(points, quads)
    message = str(caught.value)
    centre = worse.mean(axis=0)
    assert message.startswith(f"cell 2 at x = {centre[0]:.4g} m, z = {centre[1]:.4g} m is too distorted")
    assert f"{math.sin(math.radians(5.0)):.4g} (at least 0.2 needed)" in message
    assert "corner angles 5.0, 175.0, 5.0, 175.0 degrees" in message
    assert "2 of 3 cells are below" in message


@pytest.mark.parametrize(("angle", "accepted"), [(11.6, True), (11.5, False)])
def test_threshold_is_the_sine_of_eleven_and_a_half_degrees(angle, accepted):
    # asin 0.2 = 11.537 degrees.
    with nullcontext() if accepted else pytest.raises(MeshQualityError):
        require_quality(parallelogram(angle), QUAD)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e300])
def test_positions_that_are_no_numbers_are_refused(value):
    points = parallelogram(90.0)
    points[2, 1] = value
    with pytest.raises(MeshError, match="point 2 has no finite position"):
        require_quality(points, QUAD)


@pytest.mark.parametrize(
    ("points", "quads", "reason"),
    [
        (np.zeros((4, 3)), QUAD, r"points must have shape \(n, 2\), got \(4, 3\)"),
        (np.zeros((4, 2)), QUAD[:, :3], r"quads must have shape \(m, 4\)"),
        (np.zeros((4, 2)), QUAD[:0], "at least one cell"),
        (np.zeros((4, 2)), QUAD + 1, "points 1 to 4, but the mesh has points 0 to 3"),
        (np.zeros((4, 2)), QUAD - 1, "points -1 to 2"),
    ],
)
def test_arrays_that_are_no_mesh_are_refused(points, quads, reason):
    with pytest.raises(MeshError, match=reason):
        require_quality(points, quads)
