"""The mesh of a container, with thickness and density of its cells.

A mesh built here puts its lines on the faces of the walls and on the edges of the feet, so thickness and density are
constant in every cell.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from mesh.cells import FloatArray, IntArray, areas_and_centroids
from mesh.elevation import Elevation
from mesh.errors import MeshError
from mesh.fill import BoxCells, MassFill, cell_thickness, distribute_mass
from mesh.geometry import ContainerGeometry, Section
from mesh.grid import column_segments, require_affordable, row_segments
from mesh.region import Region

#: elevations of structured meshes that are kept, those used last
KEPT = 8


@dataclass(frozen=True, kw_only=True, eq=False)
class ContainerMesh:
    """A container in elevation with its mass; its arrays are read-only.

    Raises MeshError for arrays that do not fit together, values that are not finite, a thickness that is
    not positive, a negative density, no mass.
    """

    elevation: Elevation
    region: IntArray  #: (m,) values of Region
    box: IntArray  #: (m,) box of the stack, from the floor up, from 0
    thickness: FloatArray  #: (m,) of the stiff material, out of the plane [m]
    areal_density: FloatArray  #: (m,) mass per area of elevation [kg/m2]

    def __post_init__(self) -> None:
        for name in ("thickness", "areal_density"):
            self._own(name, np.array(getattr(self, name), dtype=np.float64))
        for name in ("region", "box"):
            self._own(name, np.array(getattr(self, name), dtype=np.int64))
        self._require_cell_data()

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

    @property
    def points(self) -> FloatArray:
        """Positions [x, z], (n, 2) [m]."""
        return self.elevation.points

    @property
    def quads(self) -> IntArray:
        """Corners of the cells, counter-clockwise, (m, 4)."""
        return self.elevation.quads

    @property
    def width(self) -> float:
        """Width of the base, between its corners [m]."""
        return self.elevation.width

    @property
    def height(self) -> float:
        """Largest extent along z, all boxes [m]."""
        return self.elevation.height

    @property
    def base_points(self) -> IntArray:
        """Indices of the points on the floor, from left to right; the first and the last are the corners."""
        return self.elevation.base_points

    @cached_property
    def mass(self) -> float:
        """Mass of the container with its fill [kg]."""
        return float((self.elevation.quadrature[1] * self.areal_density[:, None]).sum())

    @cached_property
    def centroid(self) -> tuple[float, float]:
        """Centre of mass (x, z) [m]."""
        positions, weights = self.elevation.quadrature
        x, z = np.einsum("m,mg,mgd->d", self.areal_density, weights, positions) / self.mass
        return float(x), float(z)

    @cached_property
    def inertia(self) -> float:
        """Moment of inertia about the centre of mass, rotation in the plane [kg m2]."""
        positions, weights = self.elevation.quadrature
        arms = ((positions - np.array(self.centroid)) ** 2).sum(axis=2)
        return float(np.einsum("m,mg,mg->", self.areal_density, weights, arms))


def with_mass_beside(mesh: ContainerMesh, distance: float) -> ContainerMesh:
    """The mesh with the mass centre of every box moved by a distance along x [m].

    The density of each box gets a linear part along x, so that its mass stays, and the height of its
    centre where its mass is symmetric about its axis.

    Raises:
        MeshError: so far that a density would be negative; a box of one column of elements.
    """
    area, centre = mesh.elevation.areas_and_centroids
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
    elevation, cells = _structured(geometry, element_size, foot, bears)
    density, region = distribute_mass(geometry, fill, cells)
    return ContainerMesh(
        elevation=elevation,
        region=np.tile(region, geometry.boxes),
        box=np.repeat(np.arange(geometry.boxes), len(region)),
        thickness=np.tile(cells.thickness, geometry.boxes),
        areal_density=np.tile(density, geometry.boxes),
    )


@lru_cache(maxsize=KEPT)
def _structured(
    geometry: ContainerGeometry, element_size: float, foot: float | None, bears: bool
) -> tuple[Elevation, BoxCells]:
    """A structured mesh and the cells of its lowest box, before it is filled; containers of other mass share it."""
    columns = column_segments(geometry, element_size, foot)
    rows = row_segments(geometry, element_size, bears=bears)
    require_affordable(geometry, columns, rows)

    x = columns.lines()
    x = 0.5 * (x - x[::-1])  # symmetric to the last bit
    box_z = rows.lines()
    z = np.concatenate([box_z[:-1] + box * geometry.height for box in range(geometry.boxes)])
    z = np.append(z, geometry.total_height)
    points = np.column_stack([np.tile(x, len(z)), np.repeat(z, len(x))])
    quads = grid_quads(columns.count, rows.count * geometry.boxes)
    box_quads = quads[: rows.count * columns.count]
    region = ring_regions(geometry, columns.lines(), box_z)
    return Elevation(points, quads), box_cells(geometry, points, box_quads, region)


def box_cells(geometry: ContainerGeometry, points: FloatArray, quads: IntArray, region: IntArray) -> BoxCells:
    """The cells of one box, a grid with points from its axis and its floor, before it is filled."""
    area, centroid = areas_and_centroids(points, quads)
    thickness, depth = cell_thickness(geometry, region, centroid[:, 0]), np.ones(len(region))
    if geometry.round:  # the chords of its circle; its wall is what lies between two of them
        sides = points[quads[:, 0], 0], points[quads[:, 1], 0]
        wall = geometry.wall or 0.0
        thickness, depth = geometry.chords(*sides), geometry.chords(*sides, inside=wall) / geometry.width
        if geometry.wall is not None:
            thickness = np.where(region == Region.WALL, thickness, thickness - geometry.width * depth)
    return BoxCells(
        region=region,
        thickness=thickness,
        depth=depth,
        area=area,
        centroid=centroid[:, 1],
        bottom=points[quads[:, 0], 1],
        top=points[quads[:, 2], 1],
    )


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
