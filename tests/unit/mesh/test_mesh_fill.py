"""Weight and centroid height of the filled box, met by the cells themselves."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mesh.container import build_container_mesh
from mesh.errors import MeshError
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section
from mesh.region import Region

BOX = ContainerGeometry(width=1.1, height=1.0, depth=1.1, wall=0.008)
BLOCK = ContainerGeometry(width=1.1, height=1.0, depth=1.1, section=Section.SOLID)


@pytest.mark.parametrize("name", ["mass", "centroid_height", "wall_density"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_values_must_be_positive_and_finite(name, value):
    with pytest.raises(MeshError, match=rf"fill {name} must be positive and finite, got {value}"):
        MassFill(**({"mass": 2500.0, "centroid_height": 0.5} | {name: value}))


@given(
    width=st.floats(0.2, 20.0),
    height=st.floats(0.2, 20.0),
    wall_share=st.floats(1e-4, 0.2),
    filling=st.floats(0.01, 100.0),
    position=st.floats(0.0, 1.0),
    boxes=st.integers(1, 4),
    cells=st.floats(0.5, 12.0),
)
def test_shell_meets_mass_and_centroid_for_every_fill_in_reach(
    width, height, wall_share, filling, position, boxes, cells
):
    depth = width
    wall = wall_share * min(width, height)
    geometry = ContainerGeometry(width=width, height=height, depth=depth, boxes=boxes, wall=wall)
    room = (width - 2 * wall) * (height - 2 * wall)
    steel = 7850.0 * ((width * height - room) * depth + room * 2 * wall)
    size = min(width, height) / cells
    # The fill's own centroid lies between the middles of the lowest and of the highest row.
    rows = max(1, round((height - 2 * wall) / size))
    row = (height - 2 * wall) / rows
    centroid_of_fill = wall + 0.5 * row + position * (height - 2 * wall - row)
    mass = (1.0 + filling) * steel
    centroid = (0.5 * height + filling * centroid_of_fill) / (1.0 + filling)
    mesh = build_container_mesh(geometry, MassFill(mass=mass, centroid_height=centroid), element_size=size)
    assert mesh.mass == pytest.approx(boxes * mass, rel=1e-9)
    assert mesh.centroid[1] == pytest.approx(centroid + 0.5 * (boxes - 1) * height, rel=1e-9)
    assert abs(mesh.centroid[0]) < 1e-9 * width
    assert mesh.areal_density.min() > 0.0


@given(
    height=st.floats(0.1, 20.0),
    position=st.floats(1.0 / 3.0, 2.0 / 3.0),
    boxes=st.integers(1, 4),
    rows=st.integers(2, 12),
)
def test_solid_meets_mass_and_centroid_within_the_middle_third(height, position, boxes, rows):
    geometry = ContainerGeometry(width=1.0, height=height, depth=1.0, boxes=boxes, section=Section.SOLID)
    fill = MassFill(mass=1234.5, centroid_height=position * height)
    mesh = build_container_mesh(geometry, fill, element_size=height / rows)
    assert mesh.mass == pytest.approx(boxes * 1234.5, rel=1e-9)
    assert mesh.centroid[1] == pytest.approx((position + 0.5 * (boxes - 1)) * height, rel=1e-9)
    assert mesh.areal_density.min() >= 0.0


def test_central_solid_is_homogeneous():
    mesh = build_container_mesh(BLOCK, MassFill(mass=2500.0, centroid_height=0.5), element_size=0.1)
    assert mesh.areal_density == pytest.approx(np.full(110, 2500.0 / 1.1), rel=1e-15)


def test_central_fill_fills_the_whole_room_evenly():
    mesh = build_container_mesh(BOX, MassFill(mass=2500.0, centroid_height=0.5), element_size=0.1)
    interior = mesh.areal_density[mesh.region == Region.FILL]
    steel = 7850.0 * ((1.1 - 1.084 * 0.984) * 1.1 + 1.084 * 0.984 * 0.016)
    assert interior == pytest.approx(
        np.full(110, 7850.0 * 0.016 + (2500.0 - steel) / (1.084 * 0.984)), rel=1e-12
    )
    assert not (mesh.region == Region.SHEET).any()


@pytest.mark.parametrize(("centroid", "filled_end"), [(0.4, "floor"), (0.6, "lid")])
def test_low_fill_stands_on_the_floor_and_high_fill_hangs_from_the_lid(centroid, filled_end):
    mesh = build_container_mesh(BOX, MassFill(mass=2500.0, centroid_height=centroid), element_size=0.1)
    heights = mesh.points[mesh.quads, 1].mean(axis=1)
    filled, empty = heights[mesh.region == Region.FILL], heights[mesh.region == Region.SHEET]
    assert empty.size > 0
    assert filled.max() < empty.min() if filled_end == "floor" else filled.min() > empty.max()
    # Empty room weighs what the sheets weigh; one row at most is partly filled.
    assert mesh.areal_density[mesh.region == Region.SHEET] == pytest.approx(7850.0 * 0.016)
    assert len(np.unique(mesh.areal_density[mesh.region == Region.FILL].round(6))) <= 2


def test_level_of_a_low_fill_is_that_of_statics():
    # Fill from the inner floor t up to L has its centroid at (t + L)/2. Spreading the fill over the cut row,
    # of height h, raises that by at most h^2/(8 (L - t)), so the level lies lower by at most twice as much.
    steel = 7850.0 * ((1.1 - 1.084 * 0.984) * 1.1 + 1.084 * 0.984 * 0.016)
    fill_centroid = (2500.0 * 0.4 - steel * 0.5) / (2500.0 - steel)
    level = 2.0 * fill_centroid - 0.008
    mesh = build_container_mesh(BOX, MassFill(mass=2500.0, centroid_height=0.4), element_size=0.01)
    column = mesh.region == Region.FILL
    extra = mesh.areal_density[column] - 7850.0 * 0.016
    heights = np.ptp(mesh.points[mesh.quads[column], 1], axis=1)
    widths = np.ptp(mesh.points[mesh.quads[column], 0], axis=1)
    filled_height = (extra * heights * widths).sum() / (extra.max() * 1.084)
    assert filled_height == pytest.approx(level - 0.008, abs=0.01**2 / (4.0 * (level - 0.008)))


def test_walls_heavier_than_the_box_are_refused_with_their_mass():
    with pytest.raises(MeshError, match=r"walls of one box weigh 421.897 kg .*more than .* 400 kg"):
        build_container_mesh(BOX, MassFill(mass=400.0, centroid_height=0.5), element_size=0.1)


def test_a_box_of_walls_alone_stands_at_the_centroid_of_its_walls():
    steel = 7850.0 * ((1.1 - 1.084 * 0.984) * 1.1 + 1.084 * 0.984 * 0.016)
    mesh = build_container_mesh(BOX, MassFill(mass=steel, centroid_height=0.5), element_size=0.1)
    assert mesh.mass == pytest.approx(steel, rel=1e-9)
    assert not (mesh.region == Region.FILL).any()
    with pytest.raises(MeshError, match=r"centroid is theirs, 0.5 m, got 0.4 m"):
        build_container_mesh(BOX, MassFill(mass=steel, centroid_height=0.4), element_size=0.1)


@pytest.mark.parametrize("centroid", [0.1, 0.9])
def test_centroid_out_of_reach_is_refused_with_the_range(centroid):
    with pytest.raises(MeshError, match=r"between 0.131926 and 0.868074 m"):
        build_container_mesh(BOX, MassFill(mass=2500.0, centroid_height=centroid), element_size=0.1)
    # The range named is met: statics of walls and one full row of 98.4 mm, then just inside of it.
    steel = 421.89723
    row = (2500.0 - steel) * (0.008 + 0.0492)
    assert (steel * 0.5 + row) / 2500.0 == pytest.approx(0.131926, abs=1e-6)
    for inside in (0.13193, 0.86807):
        mesh = build_container_mesh(BOX, MassFill(mass=2500.0, centroid_height=inside), element_size=0.1)
        assert mesh.centroid[1] == pytest.approx(inside, rel=1e-9)


@pytest.mark.parametrize("geometry", [BOX, BLOCK])
@pytest.mark.parametrize("centroid", [1.0, 5.0])
def test_centroid_outside_the_box_is_refused(geometry, centroid):
    with pytest.raises(MeshError, match=r"not inside a box of height 1.0 m"):
        build_container_mesh(geometry, MassFill(mass=2500.0, centroid_height=centroid), element_size=0.1)


@pytest.mark.parametrize("centroid", [0.33, 0.67])
def test_solid_centroid_outside_the_middle_third_is_refused_with_the_range(centroid):
    with pytest.raises(MeshError, match=r"between 0.333333 and 0.666667 m"):
        build_container_mesh(BLOCK, MassFill(mass=2500.0, centroid_height=centroid), element_size=0.1)


def test_solid_of_one_row_cannot_be_graded_and_says_so():
    with pytest.raises(MeshError, match=r"rows of this mesh are too tall .* at most 0.5 m"):
        build_container_mesh(BLOCK, MassFill(mass=2500.0, centroid_height=0.4), element_size=1.0)
