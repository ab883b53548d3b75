"""Meshes of stacks of boxes that differ: shared nodes where bolted, none where loose; from files, too."""

import meshio
import numpy as np
import pytest

from mesh.errors import MeshError
from mesh.files import read_stack_mesh
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section
from mesh.stack import StackedBox, box_mesh, build_bolted_mesh, build_loose_mesh


def box(width=1.1, height=1.0, mass=2500.0, axis=0.0, bottom=0.0, wall=None):
    """A box with its mass centre at half its height."""
    section = Section.SOLID if wall is None else Section.SHELL
    return StackedBox(
        geometry=ContainerGeometry(width=width, height=height, depth=1.1, section=section, wall=wall),
        fill=MassFill(mass=mass, centroid_height=0.5 * height),
        axis=axis,
        bottom=bottom,
    )


UNEQUAL = (box(mass=4000.0), box(0.8, 0.6, 800.0, axis=0.1, bottom=1.0), box(1.3, 0.5, 500.0, -0.05, 1.6))
SHELLS = (box(wall=0.02), box(0.8, 0.6, 900.0, axis=0.1, bottom=1.0, wall=0.01))


def faces(mesh, number, height):
    """x of the nodes of a box at a height, rising."""
    nodes = np.unique(mesh.quads[mesh.box == number])
    return np.sort(mesh.points[nodes[np.abs(mesh.points[nodes, 1] - height) < 1e-9], 0])


@pytest.mark.parametrize("boxes", [UNEQUAL, SHELLS])
@pytest.mark.parametrize("build", [build_bolted_mesh, build_loose_mesh])
def test_mass_and_mass_centre_are_those_of_the_boxes(boxes, build):
    mesh = build(boxes, element_size=0.2)
    mass = sum(one.fill.mass for one in boxes)
    x = sum(one.fill.mass * one.axis for one in boxes) / mass
    z = sum(one.fill.mass * (one.bottom + one.fill.centroid_height) for one in boxes) / mass
    assert mesh.mass == pytest.approx(mass, rel=1e-12)
    assert mesh.centroid == pytest.approx((x, z), abs=1e-12)
    assert mesh.width == pytest.approx(1.1, rel=1e-14)
    area = sum(one.geometry.width * one.geometry.height for one in boxes)
    corners = mesh.points[mesh.quads]
    assert np.sum(np.ptp(corners[..., 0], axis=1) * np.ptp(corners[..., 1], axis=1)) == pytest.approx(area)


@pytest.mark.parametrize("boxes", [UNEQUAL, SHELLS])
def test_bolted_boxes_share_all_nodes_of_the_face_between_them(boxes):
    mesh = build_bolted_mesh(boxes, element_size=0.2)
    for number, upper in enumerate(boxes[1:]):
        below = np.unique(mesh.quads[mesh.box == number])
        above = np.unique(mesh.quads[mesh.box == number + 1])
        left = max(boxes[number].sides[0], upper.sides[0])
        right = min(boxes[number].sides[1], upper.sides[1])
        x = mesh.points[np.intersect1d(below, above), 0]
        for own in (faces(mesh, number, upper.bottom), faces(mesh, number + 1, upper.bottom)):
            assert np.sort(x) == pytest.approx(own[(own > left - 1e-9) & (own < right + 1e-9)])
        assert (x.min(), x.max()) == pytest.approx((left, right))
    assert len(np.unique(mesh.points.round(9), axis=0)) == len(mesh.points)


def test_loose_boxes_share_no_node_and_equal_boxes_are_alike():
    pair = (box(wall=0.02), box(bottom=1.0, wall=0.02))
    mesh = build_loose_mesh(pair, element_size=0.2)
    first, second = (np.unique(mesh.quads[mesh.box == number]) for number in (0, 1))
    assert np.intersect1d(first, second).size == 0
    lower, upper = box_mesh(mesh, 0), box_mesh(mesh, 1)
    assert (lower.quads == upper.quads).all()
    assert upper.points == pytest.approx(lower.points, abs=1e-15)
    assert (lower.areal_density == upper.areal_density).all()


def written(path, mesh, *, region=3):
    """A mesh as a VTU file, with the number of a region."""
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    data = {"region": [np.full(len(mesh.quads), region)]} if region else {}
    meshio.Mesh(points, [("quad", mesh.quads)], cell_data=data).write(path)
    return path


@pytest.mark.parametrize("loose", [False, True])
def test_a_stack_read_from_a_file_is_the_stack_written(tmp_path, loose):
    built = (build_loose_mesh if loose else build_bolted_mesh)(UNEQUAL, element_size=0.2)
    read = read_stack_mesh(written(tmp_path / "stack.vtu", built), UNEQUAL, loose=loose)
    assert (len(read.points), len(read.quads)) == (len(built.points), len(built.quads))
    assert read.mass == pytest.approx(built.mass)
    assert read.centroid == pytest.approx(built.centroid)
    assert (read.box == built.box).all()


@pytest.mark.parametrize(
    ("loose", "apart", "boxes", "expected"),
    [
        (True, False, UNEQUAL, r"boxes 1 and 2 share 5 nodes, but loose boxes may not: give each box points and lines"),
        (False, True, UNEQUAL, r"boxes 1 and 2 do not share the nodes of the face between them: merge"),
        (False, False, (*UNEQUAL[:2], box(1.3, 0.5, 500.0, 0.0, 1.6)), r"the axis of box 3 is -0.05 m beside"),
        (False, False, (*UNEQUAL[:2], box(1.2, 0.5, 500.0, -0.05, 1.6)), r"the mesh is 1.3 m wide and 0.5 m high"),
        (False, False, (*UNEQUAL[:2], box(1.3, 0.4, 500.0, -0.05, 1.6)), r"cells lie in two boxes or above them"),
        (False, False, (*UNEQUAL, box(bottom=2.1)), r"box 4 has no cells, the case has 4 boxes"),
    ],
)  # fmt: skip
def test_a_file_that_is_not_the_stack_is_refused_in_words(tmp_path, loose, apart, boxes, expected):
    mesh = (build_loose_mesh if apart else build_bolted_mesh)(UNEQUAL, element_size=0.2)
    path = tmp_path / "stack.vtu"
    with pytest.raises(MeshError, match=expected):
        read_stack_mesh(written(path, mesh), boxes, loose=loose)
    with pytest.raises(MeshError, match=r"boxes that differ, or that stand loose, need regions"):
        read_stack_mesh(written(path, mesh, region=None), boxes, loose=loose)
