"""Corner posts in the mesh: square hollow sections at the four edges of a box."""

from dataclasses import replace

import numpy as np
import pytest

from mesh.cells import areas_and_centroids
from mesh.container import ContainerMesh, build_container_mesh
from mesh.errors import MeshError
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, CornerPost, Section

POST = CornerPost(width=0.12, wall=0.006)
BARE = ContainerGeometry(width=1.1, height=1.0, depth=1.2, wall=0.008)
POSTED = replace(BARE, post=POST)
FILL = MassFill(mass=2500.0, centroid_height=0.45)


def built(geometry: ContainerGeometry) -> ContainerMesh:
    return build_container_mesh(geometry, FILL, element_size=0.1)


@pytest.mark.parametrize("wall", [0.006, 0.02, 0.06])
def test_a_post_in_the_plane_has_area_and_second_moment_of_its_section(wall):
    post = CornerPost(width=0.12, wall=wall)
    inner = 0.12 - 2.0 * wall
    distance = (np.arange(12000) + 0.5) * 1e-5
    thickness = post.thickness(distance)  # of two posts
    assert thickness.sum() * 1e-5 == pytest.approx(2.0 * (0.12**2 - inner**2), rel=1e-6)
    second = (thickness * (distance - 0.06) ** 2).sum() * 1e-5
    assert second == pytest.approx(2.0 * (0.12**4 - inner**4) / 12.0, rel=1e-6)
    assert post.thickness(np.array([0.121])) == 0.0


def test_posts_add_their_section_to_every_row_and_their_steel_to_the_walls():
    bare, posted = built(BARE), built(POSTED)
    sections = [
        (areas_and_centroids(one.points, one.quads)[0] * one.thickness).sum() / BARE.height
        for one in (bare, posted)
    ]
    area = POST.width**2 - (POST.width - 2.0 * POST.wall) ** 2
    assert sections[1] - sections[0] == pytest.approx(4.0 * area, rel=1e-9)
    assert posted.mass == pytest.approx(2500.0, rel=1e-12)
    assert posted.centroid == pytest.approx((0.0, 0.45), abs=1e-9)
    walls = 7850.0 * sections[1] * BARE.height
    with pytest.raises(MeshError, match="walls and posts of one box weigh"):
        build_container_mesh(POSTED, MassFill(mass=0.99 * walls, centroid_height=0.5), element_size=0.1)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"width": 0.24}, "two posts of 0.12 m leave no room in a width of 0.24 m"),
        ({"depth": 0.2}, "leave no room in a depth"),
        ({"section": Section.SOLID, "wall": None}, "a solid section has no posts"),
    ],
)
def test_posts_without_room_are_refused(changes, says):
    with pytest.raises(MeshError, match=says):
        replace(POSTED, **changes)
