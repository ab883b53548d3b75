"""Where a container touches the floor, and how stiff the support is at each of these points.

`corners`: the two ends of the base; `feet`: every base point within a foot's length of an end; `flat`: all base
points. The spring of a point of a foot or of a flat base is the penalty times its tributary length (the integral of its
shape function, so that elements of first and second order reproduce a uniform pressure exactly); the spring of each
corner is half the penalty times the whole base.

The base may be cambered: its edges stand higher than its middle, by a parabola. As it rolls, its load passes from point
to point; heights and springs of the points are such that under the weight the resultant then moves as on the parabola
itself (`cambered`).
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from contact.arrays import FloatArray, IntArray

KINDS = ("corners", "feet", "flat")


@dataclass(frozen=True, kw_only=True)
class Support:
    """The points of a base that may touch the floor, sorted by x."""

    kind: str
    index: IntArray  #: (n,) indices of the supporting points among the base points given
    length: FloatArray  #: (n,) share of the base of each [m]
    depth: float  #: of the container [m]
    camber: FloatArray  #: (n,) height above the lowest point of an upright base [m]
    #: (n,) of a cambered base: sinking of each point under the whole weight at which it rolls evenly [m]
    sinking: FloatArray

    def normal_stiffness(self, normal_penalty: float) -> FloatArray:
        """Spring of each point under a penalty in Pa/m, shape (n,) [N/m]."""
        return normal_penalty * self.length * self.depth


def tributary_lengths(x: FloatArray, order: int) -> FloatArray:
    """Integrals of the shape functions along a row of nodes (n,) [m]; ValueError: no whole elements of the order."""
    if (x.size - 1) % order or x.size < order + 1:
        raise ValueError(f"{x.size} base nodes do not form elements of order {order}")
    weights = np.array([[0.5, 0.5], [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]][order - 1])
    lengths = np.zeros(x.size)
    for first in range(0, x.size - 1, order):
        lengths[first : first + order + 1] += weights * (x[first + order] - x[first])
    return lengths


def choose_support(
    kind: str, x: FloatArray, *, depth: float, order: int, feet: tuple[float, float] = (0.0, 0.0)
) -> Support:
    """The supporting points among the base nodes at x (n,), sorted [m]; `feet`: lengths of the left and the right one.

    Raises:
        ValueError: unknown kind, or feet that are missing, overlap, or do not end at a mesh line.
    """
    if kind not in KINDS:
        raise ValueError(f"[support] kind must be one of {', '.join(KINDS)}, got {kind!r}")
    width = float(x[-1] - x[0])
    if kind == "corners":
        index, length = np.array([0, x.size - 1]), np.full(2, 0.5 * width)
    elif kind == "flat":
        index, length = np.arange(x.size), tributary_lengths(x, order)
    else:
        if not (min(feet) > 0.0 and sum(feet) < width):
            raise ValueError(
                f"[support] foot_m must be positive and below half the width, got {feet} m of {width} m"
            )
        near = 1e-9 * width
        left = np.flatnonzero(x <= x[0] + feet[0] + near)
        right = np.flatnonzero(x >= x[-1] - feet[1] - near)
        if (left.size - 1) % order or (right.size - 1) % order or min(left.size, right.size) < order + 1:
            raise ValueError(f"[support] foot_m: the feet of {feet} m do not end at a mesh line")
        index = np.concatenate([left, right])
        length = np.concatenate([tributary_lengths(x[foot], order) for foot in (left, right)])
    level = np.zeros(index.size)
    return Support(kind=kind, index=index, length=length, depth=depth, camber=level, sinking=level)


#: points nearer to the edge than this share of the usual distance are left out, where the base is cambered
LEAST_DISTANCE = 0.75
#: of the differences between springs and those of evenly spaced points, beside the error of the resultant
EVENNESS = 1e-6


def cambered(support: Support, x: FloatArray, camber: float) -> Support:
    """The support, feet or a flat base with points at x (n,), whose edges stand higher than its middle by `camber` [m].

    The base is z = d (x/b)^2, of curvature k = 2 d/b^2, and turned by theta it touches at theta/k. On springs it
    touches with two neighbours at a distance s. Where each of them sinks by c under the whole weight, its part of the
    load rises from 0 to all while the base turns by 2 c/s. With c = k s^2/2 that is the turn from one side of the
    polygon to the next, and the resultant is at theta/k throughout, whatever s is. Where distances differ, it is
    c + c' = k s^2 for each two neighbours, and the heights follow.
    """
    edge = float(x[-1])
    curvature = 2.0 * camber / edge**2
    usual = float(np.median(np.diff(x)))
    inside = edge - np.abs(x)
    kept = (inside <= 0.0) | (inside >= LEAST_DISTANCE * usual)  # none that crowd at the edge
    x, index = x[kept], support.index[kept]
    distance = np.diff(x)
    touching = distance < 2.0 * float(np.median(distance))  # not across the gap between feet
    pairs = np.flatnonzero(touching)
    system = np.zeros((pairs.size, x.size))
    system[np.arange(pairs.size), pairs] = system[np.arange(pairs.size), pairs + 1] = 1.0
    beside = np.where(touching, distance, np.median(distance)) ** 2
    usual_sinking = 0.25 * curvature * (np.append(beside[0], beside) + np.append(beside, beside[-1]))
    root = np.sqrt(EVENNESS)
    sinking = np.linalg.lstsq(
        np.vstack([system, root * np.eye(x.size)]),
        np.append(curvature * distance[pairs] ** 2, root * usual_sinking),
        rcond=None,
    )[0]
    sinking = np.maximum(0.5 * (sinking + sinking[::-1]), LEAST_DISTANCE**2 * 0.5 * usual_sinking)
    height = 0.5 * curvature * x**2
    for side in (1.0, -1.0):  # outwards from the innermost point
        order = np.flatnonzero(side * x >= 0.0)[:: int(side)]
        slope = curvature * side * x[order[0]]
        for here, there in pairwise(order):
            s, both = abs(x[there] - x[here]), sinking[here] + sinking[there]
            height[there] = height[here] + slope * s + sinking[here]
            slope += both / s
    share = 1.0 / sinking
    return replace(
        support,
        index=index,
        length=support.length.sum() / share.sum() * share,
        camber=height - height.min(),
        sinking=sinking,
    )
