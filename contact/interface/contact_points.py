"""The contact points of boxes on one another and of bodies beside one another, and those that stops and ties hold.

`contact.interface.faces` says what a point is, and moves it.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.interface.faces import CORNERS, LOWER, OF_A_POINT, UPPER, Faces

BOTTOM_LEFT, BOTTOM_RIGHT, TOP_LEFT, TOP_RIGHT = range(CORNERS)
EDGE = 1e-3  #: half of the length over which a corner leaves a face, over the shorter of the two faces of the joint
#: distance of the points of pairs from those on the floor and from each other, over a body's size
ASIDE = 64.0


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
    floor = [_on_floor(0, 0.0), _on_floor(0, 1.0)]
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
        _on_floor(b, end + (1.0 - 2.0 * end) * inset[b]) for b in range(len(inset)) for end in (0.0, 1.0)
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


def _on_floor(box: int, place: float) -> dict[str, Any]:
    """A point over the floor, at a place between the lower corners of a box."""
    return _between(box, BOTTOM_LEFT, BOTTOM_RIGHT, place)


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
