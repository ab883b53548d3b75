"""Where a container touches the floor, and how stiff the support is at each of these points.

`corners`: the two ends of the base; `feet`: every base point within a foot's length of an end; `flat`: all base
points. The spring of a point of a foot or of a flat base is the penalty times its tributary length (the integral of its
shape function, so that elements of first and second order reproduce a uniform pressure exactly); the spring of each
corner is half the penalty times the whole base.
"""

from dataclasses import dataclass

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

    def normal_stiffness(self, normal_penalty: float) -> FloatArray:
        """Spring of each point under a penalty in Pa/m, shape (n,) [N/m]."""
        return normal_penalty * self.length * self.depth


def tributary_lengths(x: FloatArray, order: int) -> FloatArray:
    """Integrals of the shape functions along a row of nodes (n,), sorted [m]; order 1 or 2.

    Raises:
        ValueError: the nodes do not form whole elements of that order.
    """
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
    """Select the supporting points among the base nodes at x (n,), sorted [m].

    `feet`: lengths of the left and the right foot in the mesh.

    Raises:
        ValueError: unknown kind, or feet that are missing, overlap, or do not end at a mesh line.
    """
    if kind not in KINDS:
        raise ValueError(f"[support] kind must be one of {', '.join(KINDS)}, got {kind!r}")
    width = float(x[-1] - x[0])
    if kind == "corners":
        return Support(
            kind=kind, index=np.array([0, x.size - 1]), length=np.full(2, 0.5 * width), depth=depth
        )
    if kind == "flat":
        return Support(kind=kind, index=np.arange(x.size), length=tributary_lengths(x, order), depth=depth)
    if not (min(feet) > 0.0 and sum(feet) < width):
        raise ValueError(
            f"[support] foot_m must be positive and below half the width, got {feet} m of {width} m"
        )
    near = 1e-9 * width
    left = np.flatnonzero(x <= x[0] + feet[0] + near)
    right = np.flatnonzero(x >= x[-1] - feet[1] - near)
    if (left.size - 1) % order or (right.size - 1) % order or min(left.size, right.size) < order + 1:
        raise ValueError(f"[support] foot_m: the feet of {feet} m do not end at a mesh line")
    return Support(
        kind=kind,
        index=np.concatenate([left, right]),
        length=np.concatenate([tributary_lengths(x[left], order), tributary_lengths(x[right], order)]),
        depth=depth,
    )
