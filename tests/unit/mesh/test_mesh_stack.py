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


def written(path, mesh, *, region="solid", merged=True):
    """A mesh as a VTU file, with regions; not merged, each box has its own points."""
    points, quads = mesh.points, mesh.quads
    if not merged:
        points = np.concatenate([points[np.unique(quads[mesh.box == k])] for k in np.unique(mesh.box)])
        parts, first = [], 0
        for k in np.unique(mesh.box):
            used, own = np.unique(quads[mesh.box == k], return_inverse=True)
            parts.append(own.reshape(-1, 4) + first)
            first += len(used)
        quads = np.concatenate(parts)
    data = {"region": [np.full(len(quads), 3)]} if region else {}
    meshio.Mesh(np.column_stack([points, np.zeros(len(points))]), [("quad", quads)], cell_data=data).write(
        path
    )
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
    ("loose", "how", "boxes", "expected"),
    [
        (True, {}, UNEQUAL, r"boxes 1 and 2 share 5 nodes, but loose boxes may not: give each box points and lines"),
        (False, {"merged": False}, UNEQUAL, r"boxes 1 and 2 do not share the nodes of the face between them: merge"),
        (False, {"region": ""}, UNEQUAL, r"boxes that differ, or that stand loose, need regions"),
        (False, {}, (*UNEQUAL[:2], box(1.3, 0.5, 500.0, 0.0, 1.6)), r"the axis of box 3 is -0.05 m beside"),
        (False, {}, (*UNEQUAL[:2], box(1.2, 0.5, 500.0, -0.05, 1.6)), r"the mesh is 1.3 m wide and 0.5 m high"),
        (False, {}, (*UNEQUAL[:2], box(1.3, 0.4, 500.0, -0.05, 1.6)), r"cells lie in two boxes or above them"),
        (False, {}, (*UNEQUAL, box(bottom=2.1)), r"box 4 has no cells, the case has 4 boxes"),
    ],
)  # fmt: skip
def test_a_file_that_is_not_the_stack_is_refused_in_words(tmp_path, loose, how, boxes, expected):
    path = written(tmp_path / "stack.vtu", build_bolted_mesh(UNEQUAL, element_size=0.2), **how)
    with pytest.raises(MeshError, match=expected):
        read_stack_mesh(path, boxes, loose=loose)
