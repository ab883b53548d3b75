"""Meshes from files; the only module of this package that loads meshio, when a file is read.

Read are Gmsh (.msh, 2.2 to 4.1), VTU, legacy VTK and Abaqus (.inp) meshes of quadrilaterals in a plane:
x in the first column, z in the second (the third the same everywhere), or z in the third (the second the
same everywhere). Lengths in m. Of quadrilaterals with 8 or 9 nodes the corners are taken, if their sides
are straight; the order of the elements is chosen where the mesh is used.
"""

import contextlib
import importlib
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from mesh.cells import FloatArray, IntArray, signed_areas
from mesh.container import ContainerMesh
from mesh.elevation import Elevation
from mesh.errors import MeshError
from mesh.fill import BoxCells, MassFill, cell_thickness, distribute_mass
from mesh.geometry import ContainerGeometry, Section
from mesh.grid import MOST_CELLS
from mesh.quality import require_positions
from mesh.region import Region
from mesh.stack import StackedBox, joined, placed_apart, require_apart
from mesh.tags import CellTags, cell_regions
from mesh.tiling import TOLERANCE, place_on_floor, require_tiling

if TYPE_CHECKING:
    import meshio

#: Cell types with four corners first, and types of points and lines that are ignored.
QUADS = ("quad", "quad8", "quad9")
BYSTANDERS = ("vertex", "line", "line3")

#: Largest distance of a mid-side node from the middle of its side, as a share of the side.
STRAIGHT_SHARE = 1e-3

#: formats with plain numbers (no pickles, no links to other files): names, and modules of the readers
FORMATS = {".msh": "Gmsh", ".vtu": "VTU", ".vtk": "legacy VTK", ".inp": "Abaqus"}
_READERS = {".msh": "meshio.gmsh", ".vtu": "meshio.vtu", ".vtk": "meshio.vtk", ".inp": "meshio.abaqus"}

MOST_BYTES = 400_000_000  #: of a file; two million cells in ASCII take about this much


def read_container_mesh(path: Path | str, geometry: ContainerGeometry, fill: MassFill) -> ContainerMesh:
    """Mesh of a container from a file, placed on the floor and filled.

    Cells must be tagged with the regions wall, sheet and fill (shell; sheet may be absent) or solid, see
    `mesh.tags`. They must tile the boxes of the geometry to 1e-6. The mass of each box less that of its walls is
    distributed over its fill cells as in `mesh.fill`; fill cells above the level become sheet.

    Raises:
        MeshError: a file that is refused or not readable, other cells than quadrilaterals, tags or dimensions
            that do not fit, cells that do not tile the box or lie in two boxes, mass out of reach.
        MeshQualityError: distorted cells.
    """
    path = Path(path)
    _require_file(path)
    try:
        return _container(*_parse(path), geometry, fill)
    except MeshError as error:
        raise type(error)(f"mesh file {path}: {error}") from error


def read_stack_mesh(path: Path | str, boxes: Sequence[StackedBox], *, loose: bool) -> ContainerMesh:
    """Mesh of boxes that differ, or of boxes without bolts, from a file; regions and fill as `read_container_mesh`.

    The cells of each box must tile it, where the lowest box stands in the middle. Bolted boxes must share the nodes of
    the face between them, loose ones none.

    Raises:
        MeshError: as `read_container_mesh`; boxes in other places; nodes that are shared or not as they must be.
    """
    path = Path(path)
    _require_file(path)
    try:
        points, quads, tags = _parse(path)
        points = _plane(points)
        _require_regions(tags, boxes)
        meshes, used = [], []
        for cells, box in zip(_cells_of_boxes(points, quads, boxes), boxes, strict=True):
            used.append(np.unique(quads[cells]))
            meshes.append(_container(points, quads[cells], tags.of(cells), box.geometry, box.fill))
        _require_places(points, used, boxes)
        return placed_apart(boxes, require_apart(meshes, used)) if loose else joined(boxes, meshes, used)
    except MeshError as error:
        raise type(error)(f"mesh file {path}: {error}") from error


def _require_regions(tags: CellTags, boxes: Sequence[StackedBox]) -> None:
    try:
        cell_regions(tags, _allowed(boxes[0].geometry))
    except MeshError as error:
        raise MeshError(
            "boxes that differ, or that stand loose, need regions, which say what are the walls of each box and "
            f"what carries its fill: {error}"
        ) from error


def _cells_of_boxes(points: FloatArray, quads: IntArray, boxes: Sequence[StackedBox]) -> list[IntArray]:
    """Numbers of the cells of each box, by their heights."""
    heights = points[quads, 1] - points[np.unique(quads), 1].min()
    lines = np.array([box.bottom for box in boxes] + [boxes[-1].bottom + boxes[-1].geometry.height])
    number = np.clip(np.searchsorted(lines, heights.mean(axis=1)) - 1, 0, len(boxes) - 1)
    slack = TOLERANCE * lines[-1]
    astride = (heights.min(axis=1) < lines[number] - slack) | (
        heights.max(axis=1) > lines[number + 1] + slack
    )
    if astride.any():
        raise MeshError(
            f"{int(astride.sum())} cells lie in two boxes or above them, the first at z = "
            f"{heights[np.argmax(astride)].mean():.4g} m: put mesh lines at z = "
            f"{', '.join(f'{line:g}' for line in lines[1:])} m"
        )
    cells = [np.flatnonzero(number == k) for k in range(len(boxes))]
    for k, own in enumerate(cells, 1):
        if not own.size:
            raise MeshError(f"box {k} has no cells, the case has {len(boxes)} boxes")
    return cells


def _require_places(points: FloatArray, used: Sequence[IntArray], boxes: Sequence[StackedBox]) -> None:
    """Refuse boxes that do not stand where the case has them."""
    middles = [0.5 * (points[nodes, 0].min() + points[nodes, 0].max()) for nodes in used]
    for number, (middle, box) in enumerate(zip(middles, boxes, strict=True), 1):
        if abs(middle - middles[0] - box.axis) > TOLERANCE * box.geometry.width:
            raise MeshError(
                f"the axis of box {number} is {middle - middles[0]:.9g} m beside that of the lowest, "
                f"in the case {box.axis:.9g} m; change its offset_m, or the mesh"
            )


def _require_file(path: Path) -> None:
    """Refuse what is no mesh file by its suffix, or too large to be read."""
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        known = ", ".join(f"{each} ({name})" for each, name in FORMATS.items())
        raise MeshError(
            f"mesh file {path}: format {suffix or 'without suffix'} is not read; known are {known}"
        )
    if not path.is_file():
        raise MeshError(f"mesh file {path}: no such file")
    if (
        not 0 < (size := path.stat().st_size) <= MOST_BYTES
    ):  # files of the kernel have no size, and may never end
        raise MeshError(f"mesh file {path}: {size} bytes; 1 to {MOST_BYTES} are read; take larger elements")


def _parse(path: Path) -> tuple[FloatArray, IntArray, CellTags]:
    """Points (n, 2 or 3) [m], corners (m, 4) and tags; every error of a reader becomes a MeshError."""
    chatter = io.StringIO()
    suffix = path.suffix.lower()
    reader = importlib.import_module(_READERS[suffix])
    try:
        with contextlib.redirect_stdout(chatter), contextlib.redirect_stderr(chatter):
            mesh = reader.read(str(path))
        return _checked(mesh)
    except MeshError:
        raise
    # Parsers of damaged files raise any exception, one of them SystemExit.
    except (Exception, SystemExit) as error:
        reason = " ".join(f"{type(error).__name__} {error}".split())[:200]
        raise MeshError(f"not readable as {FORMATS[suffix]} ({reason}); is it complete?") from error


def _checked(mesh: "meshio.Mesh") -> tuple[FloatArray, IntArray, CellTags]:
    others = sorted({block.type for block in mesh.cells if block.type not in (*QUADS, *BYSTANDERS)})
    if others:
        raise MeshError(
            f"cells of type {', '.join(others)}: only quadrilaterals are read; recombine the mesh"
        )
    chosen = [number for number, block in enumerate(mesh.cells) if block.type in QUADS]
    blocks = [np.asarray(mesh.cells[number].data, dtype=np.int64) for number in chosen]
    count = sum(len(block) for block in blocks)
    if not 0 < count <= MOST_CELLS:
        raise MeshError(f"{count} quadrilaterals; 1 to {MOST_CELLS} are read")
    points = np.asarray(mesh.points, dtype=np.float64)
    quads = np.concatenate([block[:, :4] for block in blocks])
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise MeshError(f"points have shape {points.shape}, 2 or 3 columns are read")
    low, high = min(int(block.min()) for block in blocks), max(int(block.max()) for block in blocks)
    if low < 0 or high >= len(points):
        raise MeshError(f"cells name points {low} to {high}, the file has 0 to {len(points) - 1}")
    for block in blocks:
        _require_straight_sides(points, block)
    data = {name: np.concatenate([values[n] for n in chosen]) for name, values in mesh.cell_data.items()}
    tags = CellTags(
        count=count,
        sets=_memberships(mesh, chosen),
        data={name: field for name, field in data.items() if field.ndim == 1 and field.dtype.kind in "biuf"},
        physical_names={
            int(entry[0]): name
            for name, entry in mesh.field_data.items()
            if np.shape(entry) == (2,) and int(entry[1]) == 2
        },
    )
    return points, quads, tags


def _container(
    points: FloatArray, quads: IntArray, tags: CellTags, geometry: ContainerGeometry, fill: MassFill
) -> ContainerMesh:
    used, numbers = np.unique(quads, return_inverse=True)
    quads = numbers.reshape(quads.shape).astype(np.int64)
    points = place_on_floor(_plane(points[used]), geometry.width, geometry.total_height)
    clockwise = signed_areas(points, quads) < 0.0
    quads[clockwise] = quads[clockwise, ::-1]
    elevation = Elevation(points, quads)
    require_tiling(points, quads, geometry.width, geometry.total_height)

    region = cell_regions(tags, _allowed(geometry))
    thickness = cell_thickness(geometry, region, elevation.areas_and_centroids[1][:, 0])
    density, region, box = _fill_boxes(elevation, region, thickness, geometry, fill)
    return ContainerMesh(
        elevation=elevation, region=region, box=box, thickness=thickness, areal_density=density
    )


def _allowed(geometry: ContainerGeometry) -> tuple[Region, ...]:
    solid = geometry.section is Section.SOLID
    return (Region.SOLID,) if solid else (Region.WALL, Region.SHEET, Region.FILL)


def _memberships(raw: "meshio.Mesh", chosen: list[int]) -> dict[str, npt.NDArray[np.bool_]]:
    """Named sets of the file, as one flag per quadrilateral."""
    sets = {}
    for name, members in raw.cell_sets.items():
        if name.startswith("gmsh:") or len(members) != len(raw.cells):
            continue
        flags = [np.zeros(len(raw.cells[number].data), dtype=bool) for number in chosen]
        for flag, number in zip(flags, chosen, strict=True):
            if members[number] is not None:
                flag[np.asarray(members[number], dtype=np.int64)] = True
        sets[name] = np.concatenate(flags)
    return sets


def _require_straight_sides(points: FloatArray, cells: IntArray) -> None:
    if cells.shape[1] < 8:
        return
    corners, middles = points[cells[:, :4]], points[cells[:, 4:8]]
    ends = np.roll(corners, -1, axis=1)
    offset = np.linalg.norm(middles - 0.5 * (corners + ends), axis=2)
    length = np.linalg.norm(ends - corners, axis=2)
    if not (offset <= STRAIGHT_SHARE * length).all():
        worst = cells[np.argmax((offset - STRAIGHT_SHARE * length).max(axis=1)), :4]
        raise MeshError(
            f"the cell with corners {worst.tolist()} has curved sides; only straight ones are read"
        )


def _plane(points: FloatArray) -> FloatArray:
    """x and z (n, 2) of finite points with two or three columns."""
    require_positions(points)
    if points.shape[1] == 2:
        return points
    extent = np.ptp(points, axis=0)
    flat = extent <= TOLERANCE * extent.max()
    if flat[2]:
        return points[:, [0, 1]]
    if flat[1]:
        return points[:, [0, 2]]
    raise MeshError(
        f"the mesh is not in the x-y or the x-z plane: it measures {extent[0]:.4g} x {extent[1]:.4g} x "
        f"{extent[2]:.4g} m along x, y, z"
    )


def _fill_boxes(
    elevation: Elevation,
    region: IntArray,
    thickness: FloatArray,
    geometry: ContainerGeometry,
    fill: MassFill,
) -> tuple[FloatArray, IntArray, IntArray]:
    """Areal density, region and box of all cells, box by box."""
    area, centroid = elevation.areas_and_centroids
    corner_heights = elevation.points[elevation.quads, 1]
    bottom, top = corner_heights.min(axis=1), corner_heights.max(axis=1)
    box = np.clip((centroid[:, 1] / geometry.height).astype(np.int64), 0, geometry.boxes - 1)
    slack = TOLERANCE * geometry.height
    astride = (bottom < box * geometry.height - slack) | (top > (box + 1) * geometry.height + slack)
    if astride.any():
        x, z = centroid[np.argmax(astride)]
        raise MeshError(
            f"{int(astride.sum())} cells lie in two boxes, the first at x = {x:.4g} m, z = {z:.4g} m: "
            f"put mesh lines at every {geometry.height} m"
        )
    density = np.empty(len(region))
    region = region.copy()
    for number in range(geometry.boxes):
        cells = np.flatnonzero(box == number)
        floor = number * geometry.height
        density[cells], region[cells] = distribute_mass(
            geometry,
            fill,
            BoxCells(
                region=region[cells],
                thickness=thickness[cells],
                depth=np.ones(len(cells)),
                area=area[cells],
                centroid=centroid[cells, 1] - floor,
                bottom=bottom[cells] - floor,
                top=top[cells] - floor,
            ),
        )
    return density, region, box
