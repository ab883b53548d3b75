"""Container dimensions, mesh lines, and corner posts: square hollow sections at the four edges of a box."""

from dataclasses import replace

import numpy as np
import pytest

from mesh.cells import areas_and_centroids
from mesh.container import build_container_mesh, column_segments, foot_line
from mesh.errors import MeshError
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, CornerPost, Section

SHELL = {"width": 1.1, "height": 1.0, "depth": 1.1, "wall": 0.008}


def shell(**changes: object) -> ContainerGeometry:
    return ContainerGeometry(**(SHELL | changes))


def test_lines_stand_on_walls_and_feet_and_are_symmetric():
    lines = column_segments(shell(), 0.1, foot=0.15).lines()
    for place in (0.008, 0.15, 1.1 - 0.15, 1.1 - 0.008, 1.1):
        assert np.abs(lines - place).min() < 1e-15
    assert lines + lines[::-1] == pytest.approx(np.full(len(lines), 1.1), rel=1e-15)


@pytest.mark.parametrize("wall", [None, 0.002, 0.008, 0.1, 0.4])
def test_no_foot_makes_a_sliver(wall):
    # A sliver: a column thinner than a tenth of the wall beside it, or a thousandth of the width.
    geometry = shell(wall=wall) if wall else shell(wall=None, section=Section.SOLID)
    for foot in np.geomspace(1.1e-3, 0.55, 400):
        narrowest = np.diff(column_segments(geometry, 0.1, foot=foot).lines()).min()
        assert narrowest >= min(0.1 * (wall or foot), 1.1e-3) * (1.0 - 1e-9)
        assert abs(foot_line(geometry, 0.1, foot) - foot) <= foot / 8.0


def test_a_foot_ends_at_a_wall_or_the_middle_line_close_by():
    assert foot_line(shell(), 0.1, 0.0079) == 0.008
    assert column_segments(shell(), 0.1, 0.0079) == column_segments(shell(), 0.1)
    assert foot_line(shell(), 0.1, 0.5499) == 0.55
    assert column_segments(shell(), 0.1, 0.55).counts == (1, 5, 5, 1)


@pytest.mark.parametrize(
    ("foot", "reason"),
    [(0.0, "above 0"), (-0.1, "above 0"), (0.6, "half the width, 0.55 m"), (1e-4, "kind corners")],
)
def test_feet_that_do_not_fit_are_refused(foot, reason):
    with pytest.raises(MeshError, match=reason):
        foot_line(shell(), 0.1, foot)


POST = CornerPost(width=0.12, wall=0.006)
BARE = ContainerGeometry(width=1.1, height=1.0, depth=1.2, wall=0.008)
POSTED = replace(BARE, post=POST)
FILL = MassFill(mass=2500.0, centroid_height=0.45)


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
    bare, posted = (build_container_mesh(one, FILL, element_size=0.1) for one in (BARE, POSTED))
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
