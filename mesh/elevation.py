"""The cells of a container in elevation, and their quality for finite elements.

x to the right, z up; the base stands on z = 0 and is centred on x = 0. Cells are bilinear quadrilaterals,
counter-clockwise; bolted boxes share the nodes between them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mesh.cells import FloatArray, IntArray, areas_and_centroids, quadrature
from mesh.errors import MeshError, MeshQualityError

#: Points nearer to z = 0 than this share of the height are on the floor.
FLOOR_SHARE = 1e-9

#: Largest distance of the mesh line at the end of a foot from the given foot, as a share of the foot.
FOOT_SHARE = 0.125

#: Smallest scaled Jacobian accepted: corner angles between 11.5 and 168.5 degrees.
LEAST_SCALED_JACOBIAN = 0.2

#: Larger positions are refused [m]; squares and cubes of smaller ones are finite.
FARTHEST = 1e9

#: Smallest edge of a cell over its longest; a shorter edge is collapsed.
LEAST_EDGE_RATIO = 1e-9


@dataclass(frozen=True, eq=False)
class Elevation:
    """Points and cells of a container; its arrays are read-only. Containers of different mass share one.

    Raises MeshError for a base that is not on z = 0 or not centred on x = 0, and as `require_quality`.
    """

    points: FloatArray  #: (n, 2) [x, z] [m]
    quads: IntArray  #: (m, 4) corners, counter-clockwise

    def __post_init__(self) -> None:
        for name, kind in (("points", np.float64), ("quads", np.int64)):
            array = np.array(getattr(self, name), dtype=kind)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        require_quality(self.points, self.quads)
        lowest = self.points[:, 1].min()
        if abs(lowest) > FLOOR_SHARE * self.height:
            raise MeshError(f"the base must stand on z = 0, its lowest point is at z = {lowest} m")
        corners = self.points[self.base_points[[0, -1]], 0]
        if abs(corners.sum()) > FLOOR_SHARE * self.width or not corners[0] < corners[1]:
            raise MeshError(
                f"the base must be centred on x = 0, it reaches from x = {corners[0]} to {corners[1]} m"
            )

    @cached_property
    def width(self) -> float:
        """Width of the base, between its corners [m]."""
        return float(np.ptp(self.points[self.base_points, 0]))

    @cached_property
    def height(self) -> float:
        """Largest extent along z, all boxes [m]."""
        return float(np.ptp(self.points[:, 1]))

    @cached_property
    def quadrature(self) -> tuple[FloatArray, FloatArray]:
        """Gauss points (m, 4, 2) [m] and weights (m, 4) [m2] of every cell."""
        return quadrature(self.points, self.quads)

    @cached_property
    def areas_and_centroids(self) -> tuple[FloatArray, FloatArray]:
        """Area (m,) [m2] and centroid (m, 2) [m] of every cell."""
        return areas_and_centroids(self.points, self.quads)

    @cached_property
    def base_points(self) -> IntArray:
        """Indices of the points on the floor, from left to right; the first and the last are the corners."""
        on_floor = np.flatnonzero(np.abs(self.points[:, 1]) <= FLOOR_SHARE * self.height)
        return on_floor[np.argsort(self.points[on_floor, 0])]

    def foot_widths(self, foot: float) -> tuple[float, float]:
        """Widths of the left and the right foot in this mesh for a given foot [m].

        Each foot ends at the base point nearest to `foot` from its corner; it includes all base nodes up to there, for
        elements of any order.

        Raises:
            MeshError: no base point within an eighth of `foot` of its end.
        """
        base, widths = self.points[self.base_points, 0], []
        for distances in (base - base[0], base[-1] - base):
            nearest = float(distances[np.argmin(np.abs(distances - foot))])
            if not abs(nearest - foot) <= FOOT_SHARE * foot:
                raise MeshError(
                    f"no base point ends a foot of {foot} m: the nearest is {nearest:.6g} m from the corner; "
                    "put a mesh line there, or change the foot"
                )
            widths.append(nearest)
        return widths[0], widths[1]


def _corner_edges(points: FloatArray, quads: IntArray) -> tuple[FloatArray, FloatArray]:
    """Edges leaving every corner to the next and to the previous corner, each (m, 4, 2) [m]."""
    corners = points[quads]
    return np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners


def scaled_jacobian(points: FloatArray, quads: IntArray) -> FloatArray:
    """Scaled Jacobian (m,) in -1..1 of every cell; 1 for any rectangle, 0 for a collapsed edge, < 0 if clockwise.

    The smallest over the corners of the cross product of the two edges that meet there, divided by their lengths: the
    sine of the corner angle, negative for a corner that points inwards. The division by the lengths removes the
    anisotropy, so the ring of a container may be as thin as its steel. Knupp, SIAM J. Sci. Comput. 22 (2000); Verdict
    library (Sandia SAND2007-1751), quad scaled Jacobian.
    """
    ahead, behind = _corner_edges(points, quads)
    lengths = np.linalg.norm(ahead, axis=2)
    longest = lengths.max(axis=1, keepdims=True)
    # Lengths relative to the cell's longest edge: the products then neither under- nor overflow.
    scale = np.where(longest > 0.0, longest, 1.0)[..., None]
    ahead, behind = ahead / scale, behind / scale
    product = np.linalg.norm(ahead, axis=2) * np.linalg.norm(behind, axis=2)
    cross = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    sines = np.divide(cross, product, out=np.zeros_like(cross), where=product > 0.0)
    collapsed = (lengths <= LEAST_EDGE_RATIO * longest).any(axis=1)
    return np.where(collapsed, np.minimum(sines.min(axis=1), 0.0), sines.min(axis=1))


def corner_angles(points: FloatArray, quads: IntArray) -> FloatArray:
    """Interior angles (m, 4) of counter-clockwise cells, in order of their corners [degrees, 0..360]."""
    ahead, behind = _corner_edges(points, quads)
    cross = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    dot = np.einsum("mcd,mcd->mc", ahead, behind)
    return np.mod(np.degrees(np.arctan2(cross, dot)), 360.0)


def require_quality(points: FloatArray, quads: IntArray) -> None:
    """Refuse a mesh with a cell whose scaled Jacobian is below `LEAST_SCALED_JACOBIAN`.

    A MeshQualityError gives number, centre, corner angles and scaled Jacobian of the worst cell; a MeshError shapes,
    positions or corners that make no mesh.
    """
    if points.ndim != 2 or points.shape[1] != 2:
        raise MeshError(f"points must have shape (n, 2), got {points.shape}")
    if quads.ndim != 2 or quads.shape[1] != 4 or len(quads) == 0:
        raise MeshError(f"quads must have shape (m, 4) with at least one cell, got {quads.shape}")
    require_positions(points)
    if quads.min() < 0 or quads.max() >= len(points):
        raise MeshError(
            f"cells name points {quads.min()} to {quads.max()}, "
            f"but the mesh has points 0 to {len(points) - 1}"
        )
    quality = scaled_jacobian(points, quads)
    worst = int(np.argmin(quality))
    if quality[worst] >= LEAST_SCALED_JACOBIAN:
        return
    centre = points[quads[worst]].mean(axis=0)
    angles = ", ".join(f"{angle:.1f}" for angle in corner_angles(points, quads[worst : worst + 1])[0])
    below = int(np.sum(quality < LEAST_SCALED_JACOBIAN))
    fault = "inverted, folded or without area" if quality[worst] <= 0.0 else "too distorted"
    raise MeshQualityError(
        f"cell {worst} at x = {centre[0]:.4g} m, z = {centre[1]:.4g} m is {fault}: scaled Jacobian "
        f"{quality[worst]:.4g} (at least {LEAST_SCALED_JACOBIAN} needed), corner angles {angles} degrees; "
        f"{below} of {len(quads)} cells are below; move its corners or remesh there"
    )


def require_positions(points: FloatArray) -> None:
    """Refuse points (n, any) [m] not finite or beyond `FARTHEST`; raises MeshError naming the first."""
    placed = (np.abs(points) <= FARTHEST).all(axis=1)  # also refuses nan
    if not placed.all():
        first = int(np.argmin(placed))
        raise MeshError(
            f"point {first} has no finite position within {FARTHEST:g} m: {points[first].tolist()} m "
            f"({int(np.sum(~placed))} such points)"
        )
