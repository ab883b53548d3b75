"""Contact points from corners: their places, derivatives, forces and weights."""

import numpy as np
import pytest
from block_on_floor import contact_of

from contact.arrays import FloatArray
from contact.interface.faces import (
    Faces,
    condense_points,
    linearise_points,
    make_faces,
    place_points,
    share_forces,
    weigh_points,
)
from contact.interface.workspace import Contact, make_workspace

SIZES = [(1.1, 1.0), (0.9, 1.2), (1.3, 0.7)]  #: width and height of the boxes, from the floor up [m]
SPRING = 2e9  # N/m


def undeformed(sizes=SIZES) -> FloatArray:
    """Corners (4 N, 2) of boxes on one axis [m]."""
    corners, z = [], 0.0
    for width, height in sizes:
        corners += [[x, z + h] for h in (0.0, height) for x in (-0.5 * width, 0.5 * width)]
        z += height
    return np.array(corners)


def moved_apart(seed: int) -> FloatArray:
    """The boxes turned, shifted and strained."""
    draw = np.random.default_rng(seed)
    corners = undeformed().reshape(-1, 4, 2)
    for box in corners:
        angle, centre = draw.uniform(-0.3, 0.3), box.mean(axis=0)
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        box[:] = centre + draw.uniform(-0.1, 0.1, 2) + (box - centre) @ turn.T
        box += draw.normal(scale=1e-3, size=box.shape)
    return corners.reshape(-1, 2)


def faces_of(corners: FloatArray) -> Faces:
    springs = np.full(len(corners) - 2, SPRING)
    return make_faces(corners, springs, 0.5 * springs)


def contact_at(faces: Faces) -> Contact:
    return contact_of(np.zeros(faces.weight.size), force_scale=1.0, mu=1.0)


def placed(faces: Faces, corners: FloatArray) -> FloatArray:
    point = np.zeros((faces.weight.size, 2))
    place_points(faces, corners, point)
    return point


@pytest.mark.parametrize("seed", range(5))
def test_contact_points_move_as_their_derivatives_say(seed):
    faces, corners = faces_of(undeformed()), moved_apart(seed)
    push = np.random.default_rng(seed + 100).normal(size=corners.shape)
    step = 1e-6
    linearise_points(faces, corners, np.zeros((faces.weight.size, 2)))
    expected = (placed(faces, corners + step * push) - placed(faces, corners - step * push)) / (2.0 * step)
    for i, (corner, gradient) in enumerate(zip(faces.corner, faces.gradient, strict=True)):
        count = 3 if i > 1 else 1
        found = np.einsum("akd,kd->a", gradient[:, :count], push[corner[:count]])
        assert found == pytest.approx(expected[i], abs=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_the_compliance_of_the_points_is_how_they_move_under_forces(seed):
    faces, corners = faces_of(undeformed()), moved_apart(seed)
    draw = np.random.default_rng(seed)
    n, boxes = faces.weight.size, len(SIZES)
    under, work = make_workspace(4 * boxes), make_workspace(n)
    for b in range(boxes):
        local = draw.normal(size=(8, 8))
        under.compliance[8 * b : 8 * b + 8, 8 * b : 8 * b + 8] = 1e-7 * local @ local.T
    under.free[:] = corners + draw.normal(scale=1e-5, size=corners.shape)
    under.free_velocity[:] = draw.normal(size=corners.shape)
    under.point[:] = corners
    linearise_points(faces, corners, work.free)
    condense_points(faces, under, work)
    for index in range(2 * n):
        force = np.zeros(2 * n)
        force[index] = 1.0
        share_forces(faces, force.reshape(n, 2), under.force)
        motion = under.compliance @ under.force.ravel()
        moved = motion.reshape(-1, 2)
        change = placed(faces, corners + moved) - placed(faces, corners - moved)
        assert work.compliance[:, index] == pytest.approx(0.5 * change.ravel(), rel=1e-5, abs=1e-11)
    drift = 1e-7 * under.free_velocity
    rates = (placed(faces, corners + drift) - placed(faces, corners - drift)) / 2e-7
    assert work.free_velocity == pytest.approx(rates, abs=1e-6)
    assert work.free == pytest.approx(placed(faces, under.free), abs=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_forces_of_a_joint_are_in_equilibrium_and_work_on_the_motion_of_the_point(seed):
    faces, corners = faces_of(undeformed()), moved_apart(seed)
    draw = np.random.default_rng(seed)
    force = np.zeros((faces.weight.size, 2))
    force[2:] = draw.normal(size=(faces.weight.size - 2, 2))  # the floor's own are not those of a pair
    linearise_points(faces, corners, np.zeros((faces.weight.size, 2)))
    shared = np.zeros_like(corners)
    share_forces(faces, force, shared)
    assert shared.sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert float(np.sum(corners[:, 1] * shared[:, 0] - corners[:, 0] * shared[:, 1])) == pytest.approx(
        0.0,
        abs=2e-2,  # the boxes are strained by a thousandth, which a moment does not know
    )
    push, step = draw.normal(size=corners.shape), 1e-6
    rate = (placed(faces, corners + step * push) - placed(faces, corners - step * push)) / (2.0 * step)
    assert np.sum(force * rate) == pytest.approx(float(np.sum(shared * push)), abs=1e-7)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 1.0])
def test_a_corner_loads_the_ends_of_its_face_by_the_lever_rule(share):
    corners = undeformed([(1.0, 1.0), (0.4, 1.0)])
    corners[4:, 0] += share - 0.5 + 0.2  # the left corner of the upper box at this share of the face
    faces = faces_of(undeformed([(1.0, 1.0), (0.4, 1.0)]))
    linearise_points(faces, corners, np.zeros((6, 2)))
    force, shared = np.zeros((6, 2)), np.zeros((8, 2))
    force[2] = -30.0, 100.0
    share_forces(faces, force, shared)
    assert shared[4] == pytest.approx([-30.0, 100.0])
    assert shared[2] == pytest.approx([30.0 * (1.0 - share), -100.0 * (1.0 - share)])
    assert shared[3] == pytest.approx([30.0 * share, -100.0 * share])


def test_forces_do_not_jump_where_corners_pass_the_edge_of_a_face():
    """A box pushed across an equal one by 2e-3 of the width, pressed in by a constant depth and lean."""
    width, depth, lean = 1.1, 3e-5, 1e-5
    start = undeformed([(width, 1.0), (width, 1.0)])
    faces = faces_of(start)
    contact, n = contact_at(faces), faces.weight.size
    offsets = np.linspace(-2e-3, 2e-3, 801) * width
    totals, moments, weights = [], [], []
    for offset in offsets:
        corners = start.copy()
        corners[4:] += [offset, -depth]
        corners[4:, 1] += lean * (corners[4:, 0] - offset)
        point = placed(faces, corners)
        weigh_points(faces, corners, np.zeros((n, 2)), contact)
        force = contact.normal_stiffness * np.maximum(0.0, -point[:, 1])
        weights.append(faces.weight[2:].copy())
        totals.append(force[2:].sum())
        moments.append(force[2:] @ (point[:, 0] - offset)[2:])
    weight = np.array(weights)
    assert weight[:, :2].sum(axis=1) == pytest.approx(1.0) and weight[:, 2:].sum(axis=1) == pytest.approx(1.0)
    assert {0.0, 1.0} <= set(weight.ravel().tolist())
    assert weight[400] == pytest.approx(0.5)  # corner on corner
    assert totals == pytest.approx(np.full(801, 2.0 * SPRING * depth), rel=1e-3)
    assert np.abs(np.diff(totals)).max() < 1e-5 * 2.0 * SPRING * depth
    assert np.abs(np.diff(moments)).max() < 1e-5 * np.abs(moments).max()


def test_a_corner_is_on_a_face_where_it_was_there_or_slides_onto_it():
    start = undeformed([(1.0, 1.0), (1.0, 1.0)])
    faces = faces_of(start)
    contact, deep, slid = contact_at(faces), start.copy(), start.copy()
    deep[4:] += [0.3, -0.01]  # the left corner on the face, far too deep
    slid[4:] += [0.3, -1e-5]
    weigh_points(
        faces, deep, np.full((6, 2), 1.0), contact
    )  # gaps of the length of the face: all were off theirs
    assert faces.weight[2] == 0.0
    weigh_points(faces, deep, np.zeros((6, 2)), contact)
    assert faces.weight[2] == 1.0  # it was on the face before
    points = np.full((6, 2), 1.0)
    weigh_points(faces, slid, points, contact)  # it takes over where it is
    assert points[2] == pytest.approx([0.3 + faces.origin[2], -1e-5], abs=1e-12)
    assert faces.weight[4] == 0.0 and points[4, 1] == 1.0  # the right one is beside it
