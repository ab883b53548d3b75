"""Mass of a box: its steel and its fill.

The fill is mass without stiffness. In a shell it fills the space between the sheets homogeneously, from the floor up
to a level; or, if the given centroid is higher than that of the full space, from the lid down to a level. A cell cut by
the level carries the share of the fill below the level, spread over the cell. So every cell has one areal density
[kg per m2 of elevation], and the cells together have the given mass and centroid. In a solid the density is linear in
height. Heights are measured from the floor of the box. Statics of composite areas.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mesh.cells import FloatArray, IntArray
from mesh.errors import MeshError
from mesh.geometry import ContainerGeometry, Section
from mesh.region import Region

#: Relative mass below which the fill counts as zero.
ROUNDING = 1e-12


@dataclass(frozen=True, kw_only=True)
class MassFill:
    """Mass and centroid height of one box with its fill.

    Raises MeshError for a value that is not positive and finite.
    """

    mass: float  #: of one box with its fill [kg]
    centroid_height: float  #: of one box with its fill, above the box's floor [m]
    wall_density: float = 7850.0  #: of the steel, shell only; EN 1991-1-1:2002 Table A.4 [kg/m3]

    def __post_init__(self) -> None:
        for name, unit in (("mass", "kg"), ("centroid_height", "m"), ("wall_density", "kg/m3")):
            value = getattr(self, name)
            if not (value > 0.0 and math.isfinite(value)):
                raise MeshError(f"fill {name} must be positive and finite, got {value} {unit}")


@dataclass(frozen=True, kw_only=True)
class BoxCells:
    """The cells of one box; heights above the floor of the box."""

    region: IntArray  #: (m,) values of Region; FILL marks the cells that may carry fill
    thickness: FloatArray  #: (m,) of the material out of the plane [m]
    area: FloatArray  #: (m,) [m2]
    centroid: FloatArray  #: (m,) heights of the centroids [m]
    bottom: FloatArray  #: (m,) lowest points [m]
    top: FloatArray  #: (m,) highest points [m]
    #: (m,) depth of what fills them, or of a solid, over the largest one: 1 of a prism [-]
    depth: FloatArray


def cell_thickness(geometry: ContainerGeometry, region: IntArray, x: FloatArray) -> FloatArray:
    """Thickness of the material out of the plane (m,): the depth, or both sheets together, and the posts [m].

    `x` is that of the cells' centroids, from the axis of the box [m].
    """
    if geometry.wall is None:
        return np.full(len(region), geometry.depth)
    plates = np.where(region == Region.WALL, geometry.depth, 2.0 * geometry.wall)
    if geometry.post is None:
        return plates
    return plates + geometry.post.thickness(0.5 * geometry.width - np.abs(x))


def distribute_mass(
    geometry: ContainerGeometry, fill: MassFill, cells: BoxCells
) -> tuple[FloatArray, IntArray]:
    """Areal density (m,) [kg/m2] and region (m,) of the cells of one box.

    A cell that could carry fill but lies beyond the level comes back as SHEET. Mass and centroid height of the cells
    together are those of `fill`, to rounding.

    Raises:
        MeshError: walls heavier than the box; a centroid out of reach, with the range in reach.
    """
    if not fill.centroid_height < geometry.height:
        raise MeshError(
            f"centroid height {fill.centroid_height} m is not inside a box of height {geometry.height} m"
        )
    if geometry.section is Section.SOLID:
        return _solid_density(geometry, fill, cells), cells.region.copy()
    return _shell_density(geometry, fill, cells)


def _solid_density(geometry: ContainerGeometry, fill: MassFill, cells: BoxCells) -> FloatArray:
    """Density linear in height, taken at the cells' centroids: rho_0 + rho_1 (z - z_mid)."""
    low, high = geometry.height / 3.0, 2.0 * geometry.height / 3.0
    slack = ROUNDING * geometry.height
    if not low - slack <= fill.centroid_height <= high + slack:
        raise MeshError(
            f"a solid box of height {geometry.height} m has its centroid between {low:.6g} and {high:.6g} m "
            f"(density linear in height and nowhere negative), got {fill.centroid_height} m; "
            "use section shell"
        )
    volume = cells.area * cells.depth  # over the largest depth
    total_area = volume.sum()
    arm = cells.centroid - volume @ cells.centroid / total_area
    offset = fill.mass * fill.centroid_height - fill.mass * (volume @ cells.centroid) / total_area
    if abs(offset) <= ROUNDING * fill.mass * geometry.height:
        return fill.mass / total_area * cells.depth
    second_moment = volume @ arm**2
    if second_moment > ROUNDING * total_area * geometry.height**2:
        density = fill.mass / total_area + offset / second_moment * arm
        # Never so for even rows, but a low row beside tall ones can fall below zero.
        if density.min() >= 0.0:
            return density * cells.depth
    raise MeshError(
        f"the rows of this mesh are too tall to put the centroid at {fill.centroid_height} m in a solid "
        f"box of {geometry.height} m; take smaller elements, of at most {0.5 * geometry.height:.6g} m"
    )


def _shell_density(
    geometry: ContainerGeometry, fill: MassFill, cells: BoxCells
) -> tuple[FloatArray, IntArray]:
    density = fill.wall_density * cells.thickness
    wall_masses = density * cells.area
    wall_mass = float(wall_masses.sum())
    fill_mass = fill.mass - wall_mass
    if fill_mass < -ROUNDING * fill.mass:
        raise MeshError(
            f"the walls{' and posts' if geometry.post else ''} of one box weigh {wall_mass:.6g} kg (wall "
            f"{geometry.wall} m, {fill.wall_density:g} kg/m3), more than the box with its fill, {fill.mass:.6g} kg; "
            "check weight, wall and depth"
        )
    wall_moment = float(wall_masses @ cells.centroid)
    room = np.flatnonzero(cells.region == Region.FILL)
    if fill_mass <= ROUNDING * fill.mass:
        centroid = wall_moment / wall_mass
        if abs(fill.centroid_height - centroid) > 1e-9 * geometry.height:
            raise MeshError(
                f"the walls weigh as much as the box, so its centroid is theirs, {centroid:.6g} m, "
                f"got {fill.centroid_height} m"
            )
        room = room[:0]
    elif room.size == 0:
        raise MeshError(
            f"the walls of one box weigh {wall_mass:.6g} of {fill.mass:.6g} kg, but no cell can carry the "
            "rest: tag the cells with fill as fill"
        )
    region = np.where(cells.region == Region.FILL, Region.SHEET, cells.region)
    if room.size:
        share = _fill_shares(fill, wall_moment, fill_mass, cells, room)
        depth = cells.depth[room]
        density[room] += fill_mass / ((cells.area[room] * depth) @ share) * share * depth
        region[room[share > 0.0]] = Region.FILL
    return density, region


def _fill_shares(
    fill: MassFill, wall_moment: float, fill_mass: float, cells: BoxCells, room: npt.NDArray[np.intp]
) -> FloatArray:
    """Share (len(room),) of every cell in `room` that is filled, so that the box meets its centroid."""
    area, centroid = cells.area[room] * cells.depth[room], cells.centroid[room]
    bottom, top = cells.bottom[room], cells.top[room]
    target = (fill.mass * fill.centroid_height - wall_moment) / fill_mass
    full = float(area @ centroid / area.sum())
    extent = float(top.max() - bottom.min())
    # What rounding of the two moments can do to the target centroid of the fill.
    rounding = ROUNDING * extent * max(1.0, fill.mass / fill_mass)
    if abs(target - full) <= rounding:
        return np.ones(len(room))
    lowest = _shares_below(float(top.min()), bottom, top)
    highest = _shares_below(float(-bottom.max()), -top, -bottom)
    reach = [float((area * share) @ centroid / (area @ share)) for share in (lowest, highest)]
    if not reach[0] - rounding <= target <= reach[1] + rounding:
        low, high = ((wall_moment + fill_mass * height) / fill.mass for height in reach)
        raise MeshError(
            f"centroid height {fill.centroid_height} m is out of reach: with walls of "
            f"{fill.mass - fill_mass:.6g} kg and fill of {fill_mass:.6g} kg the box can have it between "
            f"{low:.6g} and {high:.6g} m; smaller elements reach a little further"
        )
    if target < full:
        return _shares_to_level(target, area, centroid, bottom, top)
    return _shares_to_level(-target, area, -centroid, -top, -bottom)


def _shares_below(level: float, bottom: FloatArray, top: FloatArray) -> FloatArray:
    """Share of the height of every cell that lies below a level (m,) [-]."""
    return np.clip((level - bottom) / (top - bottom), 0.0, 1.0)


def _shares_to_level(
    target: float, area: FloatArray, centroid: FloatArray, bottom: FloatArray, top: FloatArray
) -> FloatArray:
    """Shares (m,) for which the fill below one level has its centroid at `target`; bisection to rounding.

    With rows the centroid rises with the level; below the top of the lowest row it stays at that
    row's middle, since what a cut cell carries is spread over the cell.
    """
    low, high = float(top.min()), float(top.max())
    while low < (middle := 0.5 * (low + high)) < high:
        share = _shares_below(middle, bottom, top)
        if (area * share) @ (centroid - target) < 0.0:
            low = middle
        else:
            high = middle
    return _shares_below(high, bottom, top)
