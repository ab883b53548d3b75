"""The mesh of a container, with thickness and density of its cells.

A mesh built here has lines at the faces of the walls and posts and at the edges of the feet, so thickness and density
are constant in every cell; between them the spacing is even and as near to the element size as whole cells permit.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from mesh.cells import FloatArray, IntArray, areas_and_centroids
from mesh.elevation import Elevation
from mesh.errors import MeshError
from mesh.fill import BoxCells, MassFill, cell_thickness, distribute_mass
from mesh.geometry import ContainerGeometry, Section
from mesh.region import Region

#: elevations of structured meshes that are kept, those used last
KEPT = 8

#: Meshes with more cells are refused before memory is allocated.
MOST_CELLS = 2_000_000

#: A foot line nearer than this share of the wall (or of a cell, at the middle) is moved onto the other
#: line: a column that thin would refine nothing and only stiffen the numbers.
MERGE_SHARE = 0.1

#: Columns of a cylinder at least: its moment of inertia is then within 0.5 % of that of the circle.
ROUND_COLUMNS = 24

#: Narrowest foot, as a share of the width.
LEAST_FOOT = 1e-3


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
        for name, kind in (
            ("region", np.int64), ("box", np.int64), ("thickness", np.float64), ("areal_density", np.float64),
        ):  # fmt: skip
            array = np.array(getattr(self, name), dtype=kind)
            if array.shape != (len(self.quads),):
                raise MeshError(
                    f"{name} must have one value a cell, shape ({len(self.quads)},), got {array.shape}"
                )
            array.setflags(write=False)
            object.__setattr__(self, name, array)
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
        MeshError: more than `MOST_CELLS` cells, a foot that does not fit, a mass or a
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
    count = columns.count * rows.count * geometry.boxes
    if count > MOST_CELLS:
        raise MeshError(
            f"the mesh would have {count} cells ({columns.count} columns, {rows.count} rows a box, "
            f"{geometry.boxes} boxes); at most {MOST_CELLS} are allowed: take a larger element size"
        )
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
    wall, in_wall = geometry.wall or 0.0, []
    for lines, total in ((z, geometry.height), (x, geometry.width)):
        middle = 0.5 * (lines[:-1] + lines[1:])
        in_wall.append((middle < wall) | (middle > total - wall))
    ring = in_wall[0][:, None] | in_wall[1][None, :]
    return np.where(ring, Region.WALL, Region.FILL).astype(np.int64).ravel()


def grid_quads(columns: int, rows: int) -> IntArray:
    """Corners of the cells of a grid, row by row from below, counter-clockwise from lower left."""
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    return np.column_stack([first, first + 1, first + columns + 2, first + columns + 1]).astype(np.int64)


@dataclass(frozen=True, kw_only=True)
class Segments:
    """Consecutive intervals of a coordinate, each divided evenly."""

    lengths: tuple[float, ...]  #: [m]
    counts: tuple[int, ...]  #: cells in each

    @property
    def count(self) -> int:
        """Cells in all segments."""
        return sum(self.counts)

    def lines(self, ends: FloatArray | None = None) -> FloatArray:
        """Mesh lines between the ends of the segments, from 0 to the sum of the lengths, shape (count + 1,) [m]."""
        if ends is None:
            ends = np.concatenate(([0.0], np.cumsum(self.lengths)))
        inner = [
            np.linspace(start, stop, count + 1)[:-1]
            for start, stop, count in zip(ends[:-1], ends[1:], self.counts, strict=True)
        ]
        return np.concatenate([*inner, ends[-1:]])


def segments_between(ends: FloatArray, element_size: float) -> Segments:
    """The intervals between rising lines, each divided evenly."""
    return _divided(np.diff(ends).tolist(), element_size)


def column_segments(geometry: ContainerGeometry, element_size: float, foot: float | None = None) -> Segments:
    """Columns of the container from its left to its right side, symmetric."""
    distances = {geometry.wall} if geometry.wall is not None else set()
    if geometry.post is not None:
        distances.update(geometry.post.lines)
    if foot is not None:
        distances.add(foot_line(geometry, element_size, foot))
    return _mirrored(sorted(distances), geometry.width, column_size(geometry, element_size))


def column_size(geometry: ContainerGeometry, element_size: float) -> float:
    """Length of the cells along x [m]: of a cylinder, whose depth differs from column to column, at most a 24th."""
    return min(element_size, geometry.width / ROUND_COLUMNS) if geometry.round else element_size


def row_segments(geometry: ContainerGeometry, element_size: float, *, bears: bool = False) -> Segments:
    """Rows of one box from its floor to its lid, symmetric.

    Where a shell bears along its base, its sheets spread the forces just above the bottom plate: rows of a quarter and
    of half the element size there halve the error of the stress and more.
    """
    wall, height = geometry.wall, geometry.height
    if wall is None:
        return _mirrored([], height, element_size)
    if not bears or height - 2.0 * wall < 2.0 * element_size:
        return _mirrored([wall], height, element_size)
    fine = wall + 0.25 * element_size, wall + 0.75 * element_size
    return segments_between(np.array([0.0, wall, *fine, height - wall, height]), element_size)


def foot_line(geometry: ContainerGeometry, element_size: float, foot: float) -> float:
    """Distance from each corner of the mesh line that ends the foot [m].

    It is `foot`, unless a face of the wall or the middle of the base is so near that the column between them
    would be too thin (`MERGE_SHARE`): then it is that line.
    """
    half = 0.5 * geometry.width
    if not 0.0 < foot <= half * (1.0 + 1e-12):
        raise MeshError(f"foot must be above 0 and at most half the width, {half} m, got {foot} m")
    if foot < LEAST_FOOT * geometry.width:
        raise MeshError(
            f"a foot of {foot} m is less than {LEAST_FOOT:g} of the width {geometry.width} m; "
            "use support kind corners"
        )
    wall = geometry.wall
    if wall is not None and abs(foot - wall) < MERGE_SHARE * min(wall, element_size):
        return wall
    if 2.0 * (half - foot) < MERGE_SHARE * min(element_size, geometry.width):
        return half
    return foot


def _mirrored(distances: list[float], total: float, element_size: float) -> Segments:
    """Segments between lines at `distances` from both ends of a side of length `total`."""
    half = [stop - start for start, stop in zip([0.0, *distances], distances, strict=False)]
    middle = total - 2.0 * sum(half)
    between = [] if distances and distances[-1] == 0.5 * total else [middle]
    return _divided([*half, *between, *reversed(half)], element_size)


def _divided(lengths: list[float], element_size: float) -> Segments:
    if not (element_size > 0.0 and math.isfinite(element_size)):
        raise MeshError(f"element size must be positive and finite, got {element_size} m")
    counts = []
    for length in lengths:
        share = length / element_size
        if share > MOST_CELLS:  # before rounding: a share may be infinite
            raise MeshError(
                f"an element size of {element_size} m would cut {length} m into {share:.3g} cells; "
                f"at most {MOST_CELLS} cells are allowed in all: take a larger element size"
            )
        counts.append(max(1, round(share)))
    return Segments(lengths=tuple(lengths), counts=tuple(counts))
