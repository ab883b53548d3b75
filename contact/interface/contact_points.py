"""The contact points of boxes on one another and of bodies beside one another, and those that stops and ties hold.

`contact.interface.faces` says what a point is, and moves it.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.interface.faces import CORNERS, ENDS, LOWER, RIGHT, UPPER, Faces

BOTTOM_LEFT, BOTTOM_RIGHT, TOP_LEFT, TOP_RIGHT = range(CORNERS)
EDGE = 1e-3  #: half of the length over which a corner leaves a face, over the shorter of the two faces of the joint
#: distance of the points of pairs from those on the floor and from each other, over a body's size
ASIDE = 64.0


class SidePoint(NamedTuple):
    """A point on a side of a box."""

    box: int
    right: bool  #: it is on the right side
    place: float  #: from the foot of the side to its top: 0 to 1


class Between(NamedTuple):
    """What is between a point on a side of a box and one on a side of another: a tie."""

    of: SidePoint
    to: SidePoint
    slack: float  #: what its ends may move apart before it holds [m]


Held = SidePoint | Between


def points_of_joint(joint: int) -> slice:
    """The contact points of a joint."""
    return slice(0, 2) if joint == 0 else slice(4 * joint - 2, 4 * joint + 2)


def make_faces(
    corner: FloatArray,
    normal_stiffness: FloatArray,
    tangential_stiffness: FloatArray,
    held: Sequence[Held] = (),
) -> Faces:
    """The contact points of boxes that stand on one another.

    Args:
        corner: (4 N, 2) corners of the undeformed stack [m].
        normal_stiffness, tangential_stiffness: (4 N - 2 + k,) springs of the points at full weight [N/m].
        held: the k points of sides that come last.
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
    return _faces([*floor, *joints, *_links(held, {})], normal_stiffness, tangential_stiffness)


def make_row(
    corner: FloatArray,
    pairs: IntArray,
    distance: FloatArray,
    inset: FloatArray,
    normal_stiffness: FloatArray,
    tangential_stiffness: FloatArray,
    held: Sequence[Held] = (),
) -> Faces:
    """The contact points of bodies beside one another: two of each on the floor, then four of each pair.

    Args:
        corner: (4 N, 2) corners of the undeformed bodies, each in its own frame [m].
        pairs: (g, 2) left and right body of those that face each other.
        distance: (g,) how much further to the right the frame of the right one is [m].
        inset: (N,) of the points over the floor from the sides, over the width of the base.
        normal_stiffness, tangential_stiffness: (2 N + 4 g + k,) springs of the points at full weight [N/m].
        held: the k points of sides, or ties between bodies that face each other, that come last.
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
    further = {(left, right): along for (left, right), along in zip(pairs, distance, strict=True)}
    return _faces([*floor, *joints, *_links(held, further)], normal_stiffness, tangential_stiffness)


def _on_floor(box: int, place: float) -> dict[str, Any]:
    """A point over the floor, at a place between the lower corners of a box."""
    return _between(box, BOTTOM_LEFT, BOTTOM_RIGHT, place)


def _ends_of(point: SidePoint) -> tuple[int, int]:
    """Foot and top of the side of a point, among the corners of its box."""
    foot, top = (BOTTOM_RIGHT, TOP_RIGHT) if point.right else (BOTTOM_LEFT, TOP_LEFT)
    return foot, top


def _links(held: Sequence[Held], further: dict[tuple[int, int], float]) -> list[dict[str, Any]]:
    """Points of sides, and ties.

    Args:
        held: they.
        further: how much further to the right the frame of the right one of two bodies is than that of the left [m].
    """
    return [
        _between(link.box, *_ends_of(link), link.place)
        if isinstance(link, SidePoint)
        else _between_sides(link, further)
        for link in held
    ]


def _between_sides(tie: Between, further: dict[tuple[int, int], float]) -> dict[str, Any]:
    forth, back = (tie.of.box, tie.to.box), (tie.to.box, tie.of.box)
    return _point(
        corner=[CORNERS * end.box + corner for end in (tie.of, tie.to) for corner in _ends_of(end)],
        bodies=forth,
        parts=ENDS,
        place=(tie.of.place, tie.to.place),
        apart=further[forth] if forth in further else -further[back],
        length=tie.slack,
    )


def _between(box: int, first: int, last: int, place: float) -> dict[str, Any]:
    """A point of one box, at a place from the first to the last of two of its corners."""
    at_corner = place in (0.0, 1.0)
    left, right = CORNERS * box + first, CORNERS * box + last
    nearest = left if place < 0.5 else right
    return _point(
        corner=[nearest] * ENDS if at_corner else [nearest, left, right, right],
        bodies=(-1, box),
        parts=1 if at_corner else 3,
        place=(0.0 if at_corner else place, 0.0),
    )


def _point(
    *,
    corner: list[int],
    bodies: tuple[int, int],
    parts: int,
    place: tuple[float, float],
    apart: float = 0.0,
    length: float = 1.0,
) -> dict[str, Any]:
    """A point that is on no face."""
    return {
        "corner": [corner],
        "bodies": [bodies],
        "parts": [parts],
        "place": [place],
        "apart": [apart],
        "side": [1.0],
        "length": [length],
        "origin": [0.0],
        "edge": [0.0],
    }


def _joint(corner: FloatArray, face: list[int], other: list[int], apart: float = 0.0) -> dict[str, Any]:
    """The four points of two faces: that of the lower box and that of the upper one, by their corners."""
    of_face, of_other = (float(np.linalg.norm(corner[b] - corner[a])) for a, b in (face, other))
    return {
        "corner": [
            [*ends, ends[RIGHT]] for end in range(2) for ends in ([other[end], *face], [face[end], *other])
        ],
        "bodies": 4 * [[face[0] // CORNERS, other[0] // CORNERS]],
        "parts": 4 * [3],
        "place": 4 * [(0.0, 0.0)],
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
        gradient=np.zeros((n, 2, ENDS, 2)),
        moved=np.zeros((2 * n, 2, 2 * CORNERS)),
    )
