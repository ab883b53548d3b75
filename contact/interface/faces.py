"""Corners on faces: the contact points of boxes that stand on one another, or beside one another, from their corners.

A contact point is a corner on a face. A face is the floor, or the straight line between two corners of the box above or
below. N boxes have 4 N corners - bottom left, bottom right, top left, top right of each, from the floor up - and
4 N - 2 contact points: the two lower corners of the lowest box on the floor; then in each joint the left corner of the
upper box on the face below and the left corner of the lower box on the face above, and so both right corners.

Bodies beside one another all stand on the floor, and where two face each other their sides are such a joint, turned by
90 degrees: "lower" is then the left body, "upper" the right one, and a face leads from its top to its bottom. Each
body's corners are in a frame of its own, so that nothing but the gaps depends on how far apart the bodies are.

A point of a joint has the coordinates x along the face, of the upper box relative to the lower one, and the gap. The
force (tangential, normal) acts on the upper box. That on the face goes to its two corners by the lever rule; a pair of
normal forces there balances the moment of friction across the gap. Forces are those of virtual work on x and gap: they
are in equilibrium exactly, and their power is that of the point.

Behind these may stand points of sides, which stops and ties hold (`contact.stepping.links`): like a point over the
floor each belongs to one box, and is between two of its corners.

The weight of a point, a factor of its stiffness, falls from 1 to 0 where its corner leaves the face: linearly from
`EDGE` of the face inside the end to as much outside. Two corners that face each other have a half each,
and where the one has left, the other carries all. A point of no weight is open, by the length of its face.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.interface.workspace import Contact, Workspace
from contact.jit import compiled, inlined
from contact.structs import struct

CORNERS = 4  #: of a box
#: corners of a contact point: the one on the face, and the left and right end of the face
TOUCHING, LEFT, RIGHT = 0, 1, 2
OF_A_POINT = 3  #: corners at most
LOWER, UPPER = 0, 1  #: boxes of a contact point
BOTTOM_LEFT, BOTTOM_RIGHT, TOP_LEFT, TOP_RIGHT = range(CORNERS)
EDGE = 1e-3  #: half of the length over which a corner leaves a face, over the shorter of the two faces of the joint
#: distance of the points of pairs from those on the floor and from each other, over a body's size
ASIDE = 64.0


@struct
class Faces(NamedTuple):
    """The contact points of N boxes, n, and scratch."""

    corner: IntArray  #: (n, 3) TOUCHING, LEFT and RIGHT corner of a point; a point of one box is between the latter
    bodies: IntArray  #: (n, 2) lower and upper box of a point; -1, and its box, of a point of one box
    parts: IntArray  #: (n,) how many of its corners move a point
    owner: IntArray  #: (n, 3) which box of a point each of its corners belongs to, LOWER or UPPER
    #: (n, n, 2) which box of the second point the LOWER or UPPER one of the first is; -1: none
    shared: IntArray
    reach: IntArray  #: (n,) behind the last point that shares a box with it
    place: FloatArray  #: (n,) of a point of one box, between its LEFT and RIGHT corner: 0 to 1
    apart: FloatArray  #: (n,) how much further along x the frame of the corner is than that of the face [m]
    side: FloatArray  #: (n,) 1: a corner of the upper box on the face below; -1: of the lower box on the face above
    length: FloatArray  #: (n,) of the face, undeformed [m]
    #: (n,) coordinate of its left end, so that corners that face each other have the same [m]
    origin: FloatArray
    edge: FloatArray  #: (n,) half of the length over which the weight falls [m]
    normal_stiffness: FloatArray  #: (n,) at full weight [N/m]
    tangential_stiffness: FloatArray  #: (n,)
    weight: FloatArray  #: (n,) in this step
    #: scratch, of the linearisation about positions of the corners
    placed: FloatArray  #: (n, 2) the points at these positions
    gradient: FloatArray  #: (n, 2, 3, 2) derivatives of x and gap by x and z of the point's corners
    #: (2 n, 2, 8) displacement of the corners of lower and upper box under a unit force [m/N]
    moved: FloatArray


@inlined
def is_of_one_box(faces: Faces, i: int) -> bool:
    """Whether a contact point is one over the floor or held by a link, and not a corner on the face of a box."""
    return bool(faces.bodies[i, LOWER] < 0)


@compiled(inline=True)
def place_on_face(faces: Faces, i: int, corner: FloatArray) -> tuple[float, float, float, float, float]:
    """Share of the face to the left of a point; the gap [m]; direction of the face, x and z; its length [m]."""
    touching, left, right = faces.corner[i, TOUCHING], faces.corner[i, LEFT], faces.corner[i, RIGHT]
    along_x, along_z = corner[right, 0] - corner[left, 0], corner[right, 1] - corner[left, 1]
    x, z = corner[touching, 0] - corner[left, 0] + faces.apart[i], corner[touching, 1] - corner[left, 1]
    length = np.sqrt(along_x * along_x + along_z * along_z)
    along_x, along_z = along_x / length, along_z / length
    share = (x * along_x + z * along_z) / length
    return share, faces.side[i] * (z * along_x - x * along_z), along_x, along_z, length


@compiled(inline=True)
def place_points(faces: Faces, corner: FloatArray, point: FloatArray) -> None:
    """Contact points (n, 2) from the corners (4 N, 2), both relative to the floor [m]."""
    for i in range(faces.weight.size):
        if is_of_one_box(faces, i):
            left, right = faces.corner[i, LEFT], faces.corner[i, RIGHT]
            for k in range(2):
                point[i, k] = corner[left, k]
                if faces.parts[i] > 1:
                    point[i, k] += faces.place[i] * (corner[right, k] - corner[left, k])
            continue
        share, gap, _, _, _ = place_on_face(faces, i, corner)
        point[i, 0] = faces.origin[i] + faces.side[i] * share * faces.length[i]
        point[i, 1] = gap


@compiled(inline=True)
def weigh_points(faces: Faces, corner: FloatArray, point: FloatArray, contact: Contact) -> None:
    """Weights of the points (n, 2) where the corners (4 N, 2) are at the beginning of a step, and their stiffness.

    A corner that comes from beside the face deeper below it than the edge is wide is not on it. Another one takes over
    from other springs where it is: were it taken for open, the energy of its spring would come from nowhere.
    """
    for i in range(faces.weight.size):
        if is_of_one_box(faces, i):
            continue
        share, gap, _, _, _ = place_on_face(faces, i, corner)
        inside = min(share, 1.0 - share) * faces.length[i] / faces.edge[i]
        weight = min(max(0.5 + 0.5 * inside, 0.0), 1.0)
        if point[i, 1] == faces.length[i]:
            if gap < -faces.edge[i]:
                weight = 0.0
            elif weight > 0.0:
                point[i, 0] = faces.origin[i] + faces.side[i] * share * faces.length[i]
                point[i, 1] = gap
        faces.weight[i] = weight
        contact.normal_stiffness[i] = weight * faces.normal_stiffness[i]
        contact.tangential_stiffness[i] = weight * faces.tangential_stiffness[i]


@compiled(inline=True)
def linearise_points(faces: Faces, corner: FloatArray, point: FloatArray) -> None:
    """Contact points (n, 2) of the corners (4 N, 2), and their derivatives in `faces.gradient`."""
    place_points(faces, corner, point)
    for i in range(faces.weight.size):
        if is_of_one_box(faces, i):
            for k in range(2):
                if faces.parts[i] == 1:
                    faces.gradient[i, k, TOUCHING, k] = 1.0
                else:
                    faces.gradient[i, k, LEFT, k] = 1.0 - faces.place[i]
                    faces.gradient[i, k, RIGHT, k] = faces.place[i]
            continue
        share, gap, along_x, along_z, length = place_on_face(faces, i, corner)
        stretch, leaning = faces.side[i] * faces.length[i] / length, gap * faces.side[i] / length
        gradient = faces.gradient[i]
        for k in range(OF_A_POINT):
            part = 1.0 if k == TOUCHING else (share - 1.0 if k == LEFT else -share)
            turning = 0.0 if k == TOUCHING else (-leaning if k == LEFT else leaning)
            # along (x, z) the face, across it (-z, x)
            gradient[0, k, 0] = stretch * (part * along_x - turning * along_z)
            gradient[0, k, 1] = stretch * (part * along_z + turning * along_x)
            gradient[1, k, 0] = -faces.side[i] * part * along_z
            gradient[1, k, 1] = faces.side[i] * part * along_x


@compiled(inline=True)
def share_forces(faces: Faces, force: FloatArray, corner_force: FloatArray) -> None:
    """Forces on the corners (4 N, 2), x and z, from those of the contact points (n, 2) [N]."""
    for c in range(corner_force.shape[0]):
        corner_force[c, 0], corner_force[c, 1] = 0.0, 0.0
    for i in range(force.shape[0]):
        tangential, normal = force[i, 0], force[i, 1]
        if tangential != 0.0 or normal != 0.0:
            for k in range(faces.parts[i]):
                c = faces.corner[i, k]
                for d in range(2):
                    corner_force[c, d] += (
                        tangential * faces.gradient[i, 0, k, d] + normal * faces.gradient[i, 1, k, d]
                    )


@compiled(inline=True)
def move_corners(work: Workspace) -> None:
    """Corners under `work.force`, into `work.point`, from their free positions and the compliance of each box."""
    for box in range(work.free.shape[0] // CORNERS):
        first = 2 * CORNERS * box
        for a in range(2 * CORNERS):
            total = 0.0
            for b in range(2 * CORNERS):
                total += work.compliance[first + a, first + b] * work.force[CORNERS * box + b // 2, b % 2]
            c = CORNERS * box + a // 2
            work.point[c, a % 2] = work.free[c, a % 2] + total


@compiled(inline=True)
def condense_points(faces: Faces, corners: Workspace, work: Workspace) -> None:
    """Free positions, free velocities and compliance of the points in `work`, from those of the corners.

    Linearised about `corners.point`, with `faces.gradient` of the same; `work.free` holds the points there. Of the
    corners' compliance the diagonal blocks (8, 8) count. Points of no weight get none.
    """
    n = work.free.shape[0]
    for i in range(n):
        for a in range(2):
            moved, speed = 0.0, 0.0
            for k in range(faces.parts[i]):
                c = faces.corner[i, k]
                for d in range(2):
                    by = faces.gradient[i, a, k, d]
                    moved += by * (corners.free[c, d] - corners.point[c, d])
                    speed += by * corners.free_velocity[c, d]
            work.free[i, a] += moved
            work.free_velocity[i, a] = speed
    for i in range(n):
        if faces.weight[i] == 0.0:  # it never carries a force
            for b in range(2 * n):
                for a in range(2):
                    work.compliance[2 * i + a, b], work.compliance[b, 2 * i + a] = 0.0, 0.0
            continue
        for a in range(2):
            for b in range(2 * CORNERS):
                faces.moved[2 * i + a, 0, b], faces.moved[2 * i + a, 1, b] = 0.0, 0.0
            for k in range(faces.parts[i]):
                c, which = faces.corner[i, k], faces.owner[i, k]
                first = 2 * CORNERS * faces.bodies[i, which]
                for d in range(2):
                    by, column = faces.gradient[i, a, k, d], 2 * c + d
                    if by != 0.0:
                        for b in range(2 * CORNERS):
                            faces.moved[2 * i + a, which, b] += by * corners.compliance[first + b, column]
    for i in range(n):
        if faces.weight[i] == 0.0:
            continue
        for j in range(i, faces.reach[i]):
            if faces.weight[j] == 0.0:
                continue
            along, shear, lift, across = 0.0, 0.0, 0.0, 0.0
            for k in range(faces.parts[i]):
                which = faces.shared[i, j, faces.owner[i, k]]
                if which >= 0:
                    for d in range(2):
                        column = 2 * (faces.corner[i, k] % CORNERS) + d
                        tangential, normal = faces.gradient[i, 0, k, d], faces.gradient[i, 1, k, d]
                        by_tangential = faces.moved[2 * j, which, column]
                        by_normal = faces.moved[2 * j + 1, which, column]
                        along += tangential * by_tangential
                        shear += tangential * by_normal
                        lift += normal * by_tangential
                        across += normal * by_normal
            work.compliance[2 * i, 2 * j], work.compliance[2 * j, 2 * i] = along, along
            work.compliance[2 * i, 2 * j + 1], work.compliance[2 * j + 1, 2 * i] = shear, shear
            work.compliance[2 * i + 1, 2 * j], work.compliance[2 * j, 2 * i + 1] = lift, lift
            work.compliance[2 * i + 1, 2 * j + 1], work.compliance[2 * j + 1, 2 * i + 1] = across, across


class SidePoint(NamedTuple):
    """A point on a side of a box."""

    box: int
    right: bool  #: it is on the right side
    place: float  #: from the foot of the side to its top: 0 to 1


def points_of_joint(joint: int) -> slice:
    """The contact points of a joint."""
    return slice(0, 2) if joint == 0 else slice(4 * joint - 2, 4 * joint + 2)


def make_faces(
    corner: FloatArray,
    normal_stiffness: FloatArray,
    tangential_stiffness: FloatArray,
    held: Sequence[SidePoint] = (),
) -> Faces:
    """The contact points of boxes that stand on one another, with corners (4 N, 2) in the undeformed stack [m].

    `normal_stiffness`, `tangential_stiffness`: (4 N - 2 + k,) at full weight [N/m]; `held`: k points of sides.
    """
    boxes = len(corner) // CORNERS
    joints = [
        _joint(
            corner,
            [CORNERS * (upper - 1) + TOP_LEFT, CORNERS * (upper - 1) + TOP_RIGHT],
            [CORNERS * upper + BOTTOM_LEFT, CORNERS * upper + BOTTOM_RIGHT],
        )
        for upper in range(1, boxes)
    ]
    floor = [_between(0, BOTTOM_LEFT, BOTTOM_RIGHT, end) for end in (0.0, 1.0)]
    return _faces([*floor, *joints, *_links(held)], normal_stiffness, tangential_stiffness)


def make_row(
    corner: FloatArray,
    pairs: IntArray,
    distance: FloatArray,
    inset: FloatArray,
    normal_stiffness: FloatArray,
    tangential_stiffness: FloatArray,
    held: Sequence[SidePoint] = (),
) -> Faces:
    """The contact points of bodies beside one another: two of each on the floor, then four of each pair.

    Args:
        corner: (4 N, 2) corners of the undeformed bodies, each in its own frame [m].
        pairs: (g, 2) left and right body of those that face each other.
        distance: (g,) how much further to the right the frame of the right one is [m].
        inset: (N,) of the points over the floor from the sides, over the width of the base.
        normal_stiffness, tangential_stiffness: (2 N + 4 g + k,) at full weight [N/m]; held: k points of sides.
    """
    floor = [
        _between(b, BOTTOM_LEFT, BOTTOM_RIGHT, end + (1.0 - 2.0 * end) * inset[b])
        for b in range(len(inset))
        for end in (0.0, 1.0)
    ]
    joints = []
    for number, ((left, right), along) in enumerate(zip(pairs, distance, strict=True), 1):
        face = [CORNERS * left + TOP_RIGHT, CORNERS * left + BOTTOM_RIGHT]
        other = [CORNERS * right + TOP_LEFT, CORNERS * right + BOTTOM_LEFT]
        own = _joint(corner, face, other, apart=along)
        # points across their faces are told from those on the floor and of other pairs by it
        own["origin"] = [end + number * ASIDE * float(np.abs(corner).max()) for end in own["origin"]]
        joints.append(own)
    return _faces([*floor, *joints, *_links(held)], normal_stiffness, tangential_stiffness)


def _links(held: Sequence[SidePoint]) -> list[dict[str, Any]]:
    """Points of sides, each between foot and top of its side."""
    return [
        _between(
            point.box, *((BOTTOM_RIGHT, TOP_RIGHT) if point.right else (BOTTOM_LEFT, TOP_LEFT)), point.place
        )
        for point in held
    ]


def _between(box: int, first: int, last: int, place: float) -> dict[str, Any]:
    """A point of one box, at a place from the first to the last of two of its corners."""
    at_corner = place in (0.0, 1.0)
    left, right = CORNERS * box + first, CORNERS * box + last
    nearest = left if place < 0.5 else right
    return {
        "corner": [[nearest] * OF_A_POINT if at_corner else [nearest, left, right]],
        "bodies": [(-1, box)],
        "parts": [1 if at_corner else OF_A_POINT],
        "place": [0.0 if at_corner else place],
        "apart": [0.0],
        "side": [1.0],
        "length": [1.0],
        "origin": [0.0],
        "edge": [0.0],
    }


def _joint(corner: FloatArray, face: list[int], other: list[int], apart: float = 0.0) -> dict[str, Any]:
    """The four points of two faces: that of the lower box and that of the upper one, by their corners."""
    of_face, of_other = (float(np.linalg.norm(corner[b] - corner[a])) for a, b in (face, other))
    return {
        "corner": [ends for end in range(2) for ends in ([other[end], *face], [face[end], *other])],
        "bodies": 4 * [[face[0] // CORNERS, other[0] // CORNERS]],
        "parts": 4 * [OF_A_POINT],
        "place": 4 * [0.0],
        "apart": 2 * [apart, -apart],
        "side": 2 * [1.0, -1.0],
        "length": 2 * [of_face, of_other],
        "origin": [start for end in range(2) for start in (0.0, (of_face + of_other) * end)],
        "edge": 4 * [EDGE * min(of_face, of_other)],
    }


def _faces(
    parts: list[dict[str, Any]], normal_stiffness: FloatArray, tangential_stiffness: FloatArray
) -> Faces:
    arrays: Any = {name: np.array([row for part in parts for row in part[name]]) for name in parts[0]}
    bodies, n = arrays["bodies"], len(arrays["side"])
    same = (bodies[:, None, :, None] == bodies[None, :, None, :]) & (bodies >= 0)[:, None, :, None]
    return Faces(
        **arrays,
        owner=np.where(arrays["corner"] // CORNERS == bodies[:, [UPPER]], UPPER, LOWER),
        shared=np.where(same[..., UPPER], UPPER, np.where(same[..., LOWER], LOWER, -1)),
        reach=n - np.argmax(same.any(axis=(2, 3))[:, ::-1], axis=1),
        normal_stiffness=np.array(normal_stiffness, dtype=float),
        tangential_stiffness=np.array(tangential_stiffness, dtype=float),
        weight=np.ones(n),
        placed=np.zeros((n, 2)),
        gradient=np.zeros((n, 2, OF_A_POINT, 2)),
        moved=np.zeros((2 * n, 2, 2 * CORNERS)),
    )
