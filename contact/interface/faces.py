"""Corners on faces: the contact points of boxes that stand on one another, from the corners of the boxes.

A contact point is a corner on a face. A face is the floor, or the straight line between two corners of the box above or
below. N boxes have 4 N corners - bottom left, bottom right, top left, top right of each, from the floor up - and
4 N - 2 contact points: the two lower corners of the lowest box on the floor; then in each joint the left corner of the
upper box on the face below and the left corner of the lower box on the face above, and so both right corners.

A point of a joint has the coordinates x along the face, of the upper box relative to the lower one, and the gap. The
force (tangential, normal) acts on the upper box. That on the face goes to its two corners by the lever rule; a pair of
normal forces there balances the moment of friction across the gap. Forces are those of virtual work on x and gap: they
are in equilibrium exactly, and their power is that of the point.

The weight of a point, a factor of its stiffness, falls from 1 to 0 where its corner leaves the face: linearly from
`EDGE` of the face inside the end to as much outside. Two corners that face each other have a half each, and where the
one has left, the other carries all. A point of no weight is open, by the length of its face.
"""

from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.interface.workspace import Contact, Workspace
from contact.jit import compiled
from contact.structs import struct

EDGE = 1e-3  #: half of the length over which a corner leaves a face, over the shorter of the two faces of the joint
CORNERS = 4  #: of a box
BOTTOM_LEFT, BOTTOM_RIGHT, TOP_LEFT, TOP_RIGHT = range(CORNERS)
#: corners of a contact point: the one on the face, and the left and right end of the face
TOUCHING, LEFT, RIGHT = 0, 1, 2


@struct
class Faces(NamedTuple):
    """The contact points of N boxes, n = 4 N - 2, and scratch."""

    corner: IntArray  #: (n, 3) TOUCHING, LEFT and RIGHT corner of a point; of the floor's points all the same
    side: FloatArray  #: (n,) 1: a corner of the upper box on the face below; -1: of the lower box on the face above
    length: FloatArray  #: (n,) of the face, undeformed [m]
    origin: (
        FloatArray  #: (n,) coordinate of its left end, so that corners that face each other have the same [m]
    )
    edge: FloatArray  #: (n,) half of the length over which the weight falls [m]
    normal_stiffness: FloatArray  #: (n,) at full weight [N/m]
    tangential_stiffness: FloatArray  #: (n,)
    weight: FloatArray  #: (n,) in this step
    #: scratch, of the linearisation about positions of the corners
    gradient: FloatArray  #: (n, 2, 3, 2) derivatives of x and gap by x and z of the point's three corners
    moved: (
        FloatArray  #: (2 n, 2, 8) displacement of the corners of lower and upper box under a unit force [m/N]
    )


def points_of_joint(joint: int) -> slice:
    """The contact points of a joint."""
    return slice(0, 2) if joint == 0 else slice(4 * joint - 2, 4 * joint + 2)


def make_faces(corner: FloatArray, normal_stiffness: FloatArray, tangential_stiffness: FloatArray) -> Faces:
    """The contact points of boxes.

    Args:
        corner: (4 N, 2) corners of the undeformed stack [m].
        normal_stiffness, tangential_stiffness: (4 N - 2,) springs of the points at full weight [N/m].
    """
    boxes = len(corner) // CORNERS
    places = [[BOTTOM_LEFT] * 3, [BOTTOM_RIGHT] * 3]
    side, length, origin, edge = [1.0, 1.0], [1.0, 1.0], [0.0, 0.0], [0.0, 0.0]
    for upper in range(1, boxes):
        below, above = CORNERS * (upper - 1), CORNERS * upper
        top = [below + TOP_LEFT, below + TOP_RIGHT]
        bottom = [above + BOTTOM_LEFT, above + BOTTOM_RIGHT]
        of_top, of_bottom = (float(np.linalg.norm(corner[b] - corner[a])) for a, b in (top, bottom))
        for end in range(2):
            places += [[bottom[end], *top], [top[end], *bottom]]
            side += [1.0, -1.0]
            length += [of_top, of_bottom]
            origin += [0.0, (of_top + of_bottom) * end]
            edge += 2 * [EDGE * min(of_top, of_bottom)]
    n = len(places)
    return Faces(
        corner=np.array(places),
        side=np.array(side),
        length=np.array(length),
        origin=np.array(origin),
        edge=np.array(edge),
        normal_stiffness=np.array(normal_stiffness, dtype=float),
        tangential_stiffness=np.array(tangential_stiffness, dtype=float),
        weight=np.ones(n),
        gradient=np.zeros((n, 2, 3, 2)),
        moved=np.zeros((2 * n, 2, 2 * CORNERS)),
    )


@compiled(inline=True)
def place_on_face(faces: Faces, i: int, corner: FloatArray) -> tuple[float, float, float, float, float]:
    """Place of a point on its face.

    Returns:
        The share of the face to its left; the gap [m]; direction of the face, x and z; its length [m].
    """
    touching, left, right = faces.corner[i, TOUCHING], faces.corner[i, LEFT], faces.corner[i, RIGHT]
    along_x, along_z = corner[right, 0] - corner[left, 0], corner[right, 1] - corner[left, 1]
    x, z = corner[touching, 0] - corner[left, 0], corner[touching, 1] - corner[left, 1]
    length = np.sqrt(along_x * along_x + along_z * along_z)
    along_x, along_z = along_x / length, along_z / length
    share = (x * along_x + z * along_z) / length
    return share, faces.side[i] * (z * along_x - x * along_z), along_x, along_z, length


@compiled(inline=True)
def place_points(faces: Faces, corner: FloatArray, point: FloatArray) -> None:
    """Contact points (n, 2) from the corners (4 N, 2), both relative to the floor [m]."""
    for i in range(2):
        point[i, 0], point[i, 1] = corner[i, 0], corner[i, 1]
    for i in range(2, faces.weight.size):
        share, gap, _, _, _ = place_on_face(faces, i, corner)
        point[i, 0] = faces.origin[i] + faces.side[i] * share * faces.length[i]
        point[i, 1] = gap


@compiled(inline=True)
def open_unweighted(faces: Faces, point: FloatArray) -> None:
    """Open the points of no weight."""
    for i in range(2, faces.weight.size):
        if faces.weight[i] == 0.0:
            point[i, 1] = faces.length[i]


@compiled(inline=True)
def weigh_points(faces: Faces, corner: FloatArray, point: FloatArray, contact: Contact) -> None:
    """Weights of the points (n, 2) where the corners (4 N, 2) are at the beginning of a step, and their stiffness.

    A corner that comes from beside the face deeper below it than the edge is wide is not on it.
    """
    for i in range(2, faces.weight.size):
        share, gap, _, _, _ = place_on_face(faces, i, corner)
        inside = min(share, 1.0 - share) * faces.length[i] / faces.edge[i]
        weight = min(max(0.5 + 0.5 * inside, 0.0), 1.0)
        if gap < -faces.edge[i] and point[i, 1] == faces.length[i]:
            weight = 0.0
        faces.weight[i] = weight
        contact.normal_stiffness[i] = weight * faces.normal_stiffness[i]
        contact.tangential_stiffness[i] = weight * faces.tangential_stiffness[i]


@compiled(inline=True)
def linearise_points(faces: Faces, corner: FloatArray, point: FloatArray) -> None:
    """Contact points (n, 2) of the corners (4 N, 2), and their derivatives in `faces.gradient`."""
    place_points(faces, corner, point)
    for i in range(2):
        faces.gradient[i, 0, 0, 0], faces.gradient[i, 1, 0, 1] = 1.0, 1.0
    for i in range(2, faces.weight.size):
        share, gap, along_x, along_z, length = place_on_face(faces, i, corner)
        stretch, leaning = faces.side[i] * faces.length[i] / length, gap * faces.side[i] / length
        gradient = faces.gradient[i]
        for k in range(3):
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
            for k in range(3 if i > 1 else 1):
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
    """Free positions, free velocities and compliance of the contact points, from those of the corners.

    Linearised about the positions `corners.point`, with `faces.gradient` of the same. Points of no weight get none.

    Args:
        faces: the contact points.
        corners: the corners: free, free_velocity, and the compliance of each box, diagonal blocks (8, 8).
        work: of the points; free holds their place at `corners.point`, and is written with free_velocity and
            compliance.
    """
    n = work.free.shape[0]
    for i in range(n):
        for a in range(2):
            moved, speed = 0.0, 0.0
            for k in range(3 if i > 1 else 1):
                c = faces.corner[i, k]
                for d in range(2):
                    by = faces.gradient[i, a, k, d]
                    moved += by * (corners.free[c, d] - corners.point[c, d])
                    speed += by * corners.free_velocity[c, d]
            work.free[i, a] += moved
            work.free_velocity[i, a] = speed
    for i in range(n):
        if i > 1 and faces.weight[i] == 0.0:  # it never carries a force
            for b in range(2 * n):
                for a in range(2):
                    work.compliance[2 * i + a, b], work.compliance[b, 2 * i + a] = 0.0, 0.0
            continue
        upper = (i + 2) // 4
        for a in range(2):
            for b in range(2 * CORNERS):
                faces.moved[2 * i + a, 0, b], faces.moved[2 * i + a, 1, b] = 0.0, 0.0
            for k in range(3 if i > 1 else 1):
                c = faces.corner[i, k]
                which = 1 if c >= CORNERS * upper else 0
                first = 2 * CORNERS * (upper - 1 + which)
                for d in range(2):
                    by, column = faces.gradient[i, a, k, d], 2 * c + d
                    if by != 0.0:
                        for b in range(2 * CORNERS):
                            faces.moved[2 * i + a, which, b] += by * corners.compliance[first + b, column]
    for i in range(n):
        if i > 1 and faces.weight[i] == 0.0:
            continue
        joint = (i + 2) // 4
        for j in range(i, min(n, 4 * joint + 6)):
            if j > 1 and faces.weight[j] == 0.0:
                continue
            apart = (j + 2) // 4 - joint  # 0: the same joint, 1: the next
            for a in range(2):
                for b in range(2):
                    total = 0.0
                    for k in range(3 if i > 1 else 1):
                        c = faces.corner[i, k]
                        which = 1 if c >= CORNERS * joint else 0
                        if which >= apart:  # the box below the joint of j is the one above that of i
                            local = 2 * (c - CORNERS * (joint - 1 + which))
                            for d in range(2):
                                total += (
                                    faces.gradient[i, a, k, d]
                                    * faces.moved[2 * j + b, which - apart, local + d]
                                )
                    work.compliance[2 * i + a, 2 * j + b] = total
                    work.compliance[2 * j + b, 2 * i + a] = total
