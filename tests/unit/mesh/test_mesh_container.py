"""The structured mesh: where its cells and lines lie, what it weighs, how it resists rotation; quality of cells."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mesh.cells import areas_and_centroids, quadrature, signed_areas
from mesh.container import ContainerMesh, build_container_mesh
from mesh.elevation import Elevation, corner_angles, require_quality, scaled_jacobian
from mesh.errors import MeshQualityError
from mesh.files import require_tiling
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section
from mesh.region import Region

STACK = ContainerGeometry(width=1.1, height=1.0, depth=1.2, boxes=4, wall=0.008)
BLOCK = ContainerGeometry(width=1.1, height=1.0, depth=1.1, boxes=4, section=Section.SOLID)
FILL = MassFill(mass=2500.0, centroid_height=0.5)
QUAD = np.array([[0, 1, 2, 3]])


def block(element_size: float = 0.25) -> ContainerMesh:
    return build_container_mesh(BLOCK, FILL, element_size=element_size)


def distorted_block() -> ContainerMesh:
    """The block with its inner points moved at random: same shape, same density, other cells."""
    mesh = block()
    points = mesh.points.copy()
    inside = (np.abs(points[:, 0]) < 0.549) & (points[:, 1] > 0.001) & (points[:, 1] < 3.999)
    points[inside] += np.random.default_rng(1).uniform(-0.06, 0.06, (inside.sum(), 2))
    return replace(mesh, elevation=Elevation(points, mesh.quads))


@pytest.mark.parametrize("mesh", [block(1.0), block(), distorted_block()])
def test_homogeneous_block_has_the_inertia_of_a_rectangle(mesh):
    # m (a^2 + c^2)/12 about its centre, exact for cells of any shape.
    assert mesh.mass == pytest.approx(10000.0, rel=1e-13)
    assert mesh.centroid == pytest.approx((0.0, 2.0), abs=1e-13)
    assert mesh.inertia == pytest.approx(10000.0 * (1.1**2 + 4.0**2) / 12.0, rel=1e-13)


def test_quadrature_integrates_quadratics_over_any_quadrilateral():
    # Green's theorem on the corners of an irregular quadrilateral: integral of x^2 = sum over edges of
    # int x^3/3 dz = dz (x0^3 + x0^2 x1 + x0 x1^2 + x1^3)/12.
    points = np.array([[0.1, -0.2], [1.3, 0.1], [1.1, 1.7], [-0.4, 0.9]])
    start, stop = points, np.roll(points, -1, axis=0)
    x0, x1 = start[:, 0], stop[:, 0]
    exact = ((stop - start)[:, 1] * (x0**3 + x0**2 * x1 + x0 * x1**2 + x1**3) / 12.0).sum()
    positions, weights = quadrature(points, QUAD)
    assert (weights * positions[..., 0] ** 2).sum() == pytest.approx(exact, rel=1e-14)
    area, centroid = areas_and_centroids(points, QUAD)
    assert area == pytest.approx(signed_areas(points, QUAD), rel=1e-14)
    moment = ((stop - start)[:, 1] * (x0**2 + x0 * x1 + x1**2) / 6.0).sum()
    assert centroid[0, 0] == pytest.approx(moment / area[0], rel=1e-14)


@pytest.mark.parametrize("geometry", [STACK, BLOCK])
@pytest.mark.parametrize("foot", [None, 0.15, 0.55])
def test_cells_are_counter_clockwise_rectangles_that_tile_the_container(geometry, foot):
    mesh = build_container_mesh(geometry, FILL, element_size=0.1, foot=foot)
    areas = signed_areas(mesh.points, mesh.quads)
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(1.1 * 4.0, rel=1e-13)
    assert scaled_jacobian(mesh.points, mesh.quads) == pytest.approx(np.ones(len(areas)), abs=1e-12)
    require_tiling(mesh.points, mesh.quads, 1.1, 4.0)


def test_ring_of_every_box_has_the_thickness_of_the_wall_and_the_depth_of_the_container():
    mesh = build_container_mesh(STACK, FILL, element_size=0.1)
    area = signed_areas(mesh.points, mesh.quads)
    wall = mesh.region == Region.WALL
    assert area[wall].sum() == pytest.approx(4 * (1.1 * 1.0 - 1.084 * 0.984), rel=1e-12)
    assert (mesh.thickness[wall] == 1.2).all()
    assert (mesh.thickness[~wall] == 0.016).all()
    assert mesh.areal_density[wall] == pytest.approx(np.full(wall.sum(), 7850.0 * 1.2), rel=1e-15)


def test_mesh_is_symmetric_to_the_last_bit():
    mesh = build_container_mesh(STACK, FILL, element_size=0.1, foot=0.13)
    mirrored = mesh.points * [-1.0, 1.0]
    assert {tuple(point) for point in mirrored} == {tuple(point) for point in mesh.points}


@pytest.mark.parametrize("foot", [0.15, 0.05, 0.0079, 0.008, 0.3, 0.5499])
def test_feet_end_on_a_base_point(foot):
    mesh = build_container_mesh(STACK, FILL, element_size=0.1, foot=foot)
    left, right = mesh.elevation.foot_widths(foot)
    assert left == pytest.approx(right, rel=1e-12)
    assert left == pytest.approx(foot, rel=1.0 / 8.0)
    assert np.isclose(mesh.points[mesh.base_points, 0] + 0.55, left, rtol=1e-12, atol=0.0).any()


def parallelogram(angle_degrees: float, length: float = 1.0, side: float = 1.0) -> np.ndarray:
    """Corner angle at the origin, `length` along x, `side` up the slope."""
    up = side * np.array([math.cos(math.radians(angle_degrees)), math.sin(math.radians(angle_degrees))])
    return np.array([[0.0, 0.0], [length, 0.0], [length + up[0], up[1]], up])


@given(length=st.floats(1e-3, 1e3), side=st.floats(2e-6, 1e3), turn=st.floats(0.0, 2.0 * math.pi))
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
