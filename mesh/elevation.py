"""The cells of a container in elevation.

x to the right, z up; the base stands on z = 0 and is centred on x = 0. Cells are bilinear quadrilaterals,
counter-clockwise; bolted boxes share the nodes between them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mesh.cells import FloatArray, IntArray, areas_and_centroids, quadrature
from mesh.errors import MeshError
from mesh.quality import require_quality

#: Points nearer to z = 0 than this share of the height are on the floor.
FLOOR_SHARE = 1e-9

#: Largest distance of the mesh line at the end of a foot from the given foot, as a share of the foot.
FOOT_SHARE = 0.125


@dataclass(frozen=True, eq=False)
class Elevation:
    """Points and cells of a container; its arrays are read-only. Containers of different mass share one.

    Raises MeshError for a base that is not on z = 0 or not centred on x = 0, and as
    `mesh.quality.require_quality`.
    """

    points: FloatArray  #: (n, 2) [x, z] [m]
    quads: IntArray  #: (m, 4) corners, counter-clockwise

    def __post_init__(self) -> None:
        for name, kind in (("points", np.float64), ("quads", np.int64)):
            array = np.array(getattr(self, name), dtype=kind)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        require_quality(self.points, self.quads)
        self._require_stance()

    def _require_stance(self) -> None:
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
        base = self.points[self.base_points, 0]
        left = _nearest_line(base - base[0], foot)
        right = _nearest_line(base[-1] - base, foot)
        return left, right


def _nearest_line(distances: FloatArray, foot: float) -> float:
    nearest = float(distances[np.argmin(np.abs(distances - foot))])
    if not abs(nearest - foot) <= FOOT_SHARE * foot:
        raise MeshError(
            f"no base point ends a foot of {foot} m: the nearest is {nearest:.6g} m from the corner; "
            "put a mesh line there, or change the foot"
        )
    return nearest
