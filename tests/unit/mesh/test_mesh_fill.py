"""Weight and centroid height of the filled box, met by the cells themselves."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mesh.container import build_container_mesh, with_mass_beside
from mesh.errors import MeshError
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section
from mesh.region import Region

BOX = ContainerGeometry(width=1.1, height=1.0, depth=1.1, wall=0.008)


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


@pytest.mark.parametrize("distance", [0.011, -0.03])
def test_a_mass_beside_the_axis_moves_the_centre_by_the_distance_and_nothing_else(distance):
    mesh = build_container_mesh(BOX, MassFill(mass=2500.0, centroid_height=0.45), element_size=0.1)
    moved = with_mass_beside(mesh, distance)
    assert moved.centroid == pytest.approx((distance, mesh.centroid[1]), rel=1e-12)
    assert moved.mass == pytest.approx(mesh.mass, rel=1e-12)
    with pytest.raises(MeshError, match=r"cannot lie 0.4 m beside the axis"):
        with_mass_beside(mesh, 0.4)
