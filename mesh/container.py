"""The mesh of a container, with thickness and density of its cells.

x to the right, z up; the base stands on z = 0 and is centred on x = 0. Cells are bilinear quadrilaterals,
counter-clockwise; bolted boxes share the nodes between them. A mesh built here puts its lines on the
faces of the walls and on the edges of the feet, so thickness and density are constant in every cell.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from mesh.cells import FloatArray, IntArray, areas_and_centroids, quadrature
from mesh.errors import MeshError
from mesh.fill import BoxCells, MassFill, cell_thickness, distribute_mass
from mesh.geometry import ContainerGeometry, Section
from mesh.grid import column_segments, require_affordable, row_segments
from mesh.quality import require_quality
from mesh.region import Region

#: Points nearer to z = 0 than this share of the height are on the floor.
FLOOR_SHARE = 1e-9

#: Largest distance of the mesh line at the end of a foot from the given foot, as a share of the foot.
FOOT_SHARE = 0.125


@dataclass(frozen=True, kw_only=True, eq=False)
class ContainerMesh:
    """Points, cells and mass of a container in elevation; its arrays are read-only.

    Raises MeshError for arrays that do not fit together, values that are not finite, a thickness that is
    not positive, a negative density, no mass, a base that is not on z = 0 or not centred on x = 0;
    MeshQualityError for distorted cells.
    """

    points: FloatArray  #: (n, 2) [x, z] [m]
    quads: IntArray  #: (m, 4) corners, counter-clockwise
    region: IntArray  #: (m,) values of Region
    box: IntArray  #: (m,) box of the stack, from the floor up, from 0
    thickness: FloatArray  #: (m,) of the stiff material, out of the plane [m]
    areal_density: FloatArray  #: (m,) mass per area of elevation [kg/m2]

    def __post_init__(self) -> None:
        for name in ("points", "thickness", "areal_density"):
            self._own(name, np.array(getattr(self, name), dtype=np.float64))
        for name in ("quads", "region", "box"):
            self._own(name, np.array(getattr(self, name), dtype=np.int64))
        require_quality(self.points, self.quads)
        self._require_cell_data()
        self._require_stance()

    def _own(self, name: str, array: npt.NDArray[np.generic]) -> None:
        array.setflags(write=False)
        object.__setattr__(self, name, array)

    def _require_cell_data(self) -> None:
        for name in ("region", "box", "thickness", "areal_density"):
            if getattr(self, name).shape != (len(self.quads),):
                raise MeshError(
                    f"{name} must have one value a cell, shape ({len(self.quads)},), "
                    f"got {getattr(self, name).shape}"
                )
        if not np.isin(self.region, list(Region)).all():
            raise MeshError(f"region must hold values of Region, got {np.unique(self.region).tolist()}")
        if not (np.isfinite(self.thickness).all() and (self.thickness > 0.0).all()):
            raise MeshError(f"thickness must be positive and finite, smallest is {self.thickness.min()} m")
        if not (np.isfinite(self.areal_density).all() and (self.areal_density >= 0.0).all()):
            raise MeshError(
                f"areal density must be finite and not negative, smallest is {self.areal_density.min()} kg/m2"
            )
        if not self.mass > 0.0:
            raise MeshError("the container has no mass")

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
    def mass(self) -> float:
        """Mass of the container with its fill [kg]."""
        return float((quadrature(self.points, self.quads)[1] * self.areal_density[:, None]).sum())

    @cached_property
    def centroid(self) -> tuple[float, float]:
        """Centre of mass (x, z) [m]."""
        positions, weights = quadrature(self.points, self.quads)
        x, z = np.einsum("m,mg,mgd->d", self.areal_density, weights, positions) / self.mass
        return float(x), float(z)

    @cached_property
    def inertia(self) -> float:
        """Moment of inertia about the centre of mass, rotation in the plane [kg m2]."""
        positions, weights = quadrature(self.points, self.quads)
        arms = ((positions - np.array(self.centroid)) ** 2).sum(axis=2)
        return float(np.einsum("m,mg,mg->", self.areal_density, weights, arms))

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


def with_mass_beside(mesh: ContainerMesh, distance: float) -> ContainerMesh:
    """The mesh with the mass centre of every box moved by a distance along x [m].

    The density of each box gets a linear part along x, so that its mass stays, and the height of its
    centre where its mass is symmetric about its axis.

    Raises:
        MeshError: so far that a density would be negative; a box of one column of elements.
    """
    area, centre = areas_and_centroids(mesh.points, mesh.quads)
    mass, factor = area * mesh.areal_density, np.ones(len(mesh.quads))
    for box in range(int(mesh.box.max()) + 1):
        own = mesh.box == box
        beside = centre[own, 0] - np.average(centre[own, 0], weights=mass[own])
        if np.abs(beside).max() <= 1e-9 * mesh.width:
            raise MeshError(
                "a box of one column of elements has its mass centre on its axis; take smaller elements"
            )
        factor[own] += distance * mass[own].sum() / np.sum(mass[own] * beside**2) * beside
    if factor.min() < 0.0:
        raise MeshError(f"the mass centre cannot lie {distance:g} m beside the axis of a box")
    return replace(mesh, areal_density=mesh.areal_density * factor)


def build_container_mesh(
    geometry: ContainerGeometry,
    fill: MassFill,
    *,
    element_size: float,
    foot: float | None = None,
    bears: bool = False,
) -> ContainerMesh:
    """Structured mesh of a container.

    Args:
        geometry: outer dimensions and section.
        fill: mass and centroid height of one box; every box is the same.
        element_size: length of the cells between walls, rounded to whole cells [m].
        foot: width of a foot at each corner, for mesh lines at its edge [m]; see `ContainerMesh.foot_widths`.
        bears: whether the base bears along its length, for finer rows above it.

    Raises:
        MeshError: more than `mesh.grid.MOST_CELLS` cells, a foot that does not fit, a mass or a
            centroid that cannot be met.
    """
    columns = column_segments(geometry, element_size, foot)
    rows = row_segments(geometry, element_size, bears=bears)
    require_affordable(geometry, columns, rows)

    x = columns.lines()
    x = 0.5 * (x - x[::-1])  # symmetric to the last bit
    box_z = rows.lines()
    z = np.concatenate([box_z[:-1] + box * geometry.height for box in range(geometry.boxes)])
    z = np.append(z, geometry.total_height)
    points = np.column_stack([np.tile(x, len(z)), np.repeat(z, len(x))])
    box_region = ring_regions(geometry, columns.lines(), box_z)

    quads = grid_quads(columns.count, rows.count * geometry.boxes)
    box_quads = quads[: rows.count * columns.count]
    box_region, thickness, density = filled_grid(geometry, fill, points, box_quads, box_region)
    return ContainerMesh(
        points=points,
        quads=quads,
        region=np.tile(box_region, geometry.boxes),
        box=np.repeat(np.arange(geometry.boxes), len(box_quads)),
        thickness=np.tile(thickness, geometry.boxes),
        areal_density=np.tile(density, geometry.boxes),
    )


def filled_grid(
    geometry: ContainerGeometry, fill: MassFill, points: FloatArray, quads: IntArray, region: IntArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Region, thickness and areal density of the cells of one box, a grid with points from its axis and its floor."""
    area, centroid = areas_and_centroids(points, quads)
    thickness = cell_thickness(geometry, region, centroid[:, 0])
    cells = BoxCells(
        region=region,
        thickness=thickness,
        area=area,
        centroid=centroid[:, 1],
        bottom=points[quads[:, 0], 1],
        top=points[quads[:, 2], 1],
    )
    density, region = distribute_mass(geometry, fill, cells)
    return region, thickness, density


def ring_regions(geometry: ContainerGeometry, x: FloatArray, z: FloatArray) -> IntArray:
    """Regions of the cells of one box, row by row from below, between its lines at x and z, both from 0 [m]."""
    if geometry.section is Section.SOLID:
        return np.full((len(x) - 1) * (len(z) - 1), Region.SOLID, dtype=np.int64)
    column_is_wall = _within_walls(geometry, x, geometry.width)
    row_is_wall = _within_walls(geometry, z, geometry.height)
    ring = row_is_wall[:, None] | column_is_wall[None, :]
    return np.where(ring, Region.WALL, Region.FILL).astype(np.int64).ravel()


def _within_walls(geometry: ContainerGeometry, lines: FloatArray, total: float) -> npt.NDArray[np.bool_]:
    middle = 0.5 * (lines[:-1] + lines[1:])
    wall = geometry.wall or 0.0
    return (middle < wall) | (middle > total - wall)


def grid_quads(columns: int, rows: int) -> IntArray:
    """Corners of the cells of a grid, row by row from below, counter-clockwise from lower left."""
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    return np.column_stack([first, first + 1, first + columns + 2, first + columns + 1]).astype(np.int64)
