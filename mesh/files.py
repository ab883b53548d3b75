"""Meshes from files; the only module of this package that loads meshio, when a file is read.

Read are Gmsh (.msh, 2.2 to 4.1), VTU, legacy VTK and Abaqus (.inp) meshes of quadrilaterals in a plane:
x in the first column, z in the second (the third the same everywhere), or z in the third (the second the
same everywhere). Lengths in m. Of quadrilaterals with 8 or 9 nodes the corners are taken, if their sides
are straight; the order of the elements is chosen where the mesh is used.

Cells must tile the container: no gap, crack, overlap or hanging point. In a mesh without cracks every inner edge
belongs to two cells, and the edges of only one cell are on the sides of the box. Then, by Green's theorem, there is no
overlap if the areas add up to the area of the box.
"""

import contextlib
import importlib
import io
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mesh.cells import FloatArray, IntArray, signed_areas
from mesh.container import MOST_CELLS, ContainerMesh
from mesh.elevation import Elevation, require_positions
from mesh.errors import MeshError
from mesh.fill import BoxCells, MassFill, cell_thickness, distribute_mass
from mesh.geometry import ContainerGeometry, Section
from mesh.region import Region
from mesh.stack import StackedBox, placed_apart
from mesh.tags import CellTags, cell_regions

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

#: Relative tolerance on the dimensions and the area of a mesh from a file.
TOLERANCE = 1e-6
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
    try:
        points, quads, tags = _parse(path)
        points = _plane(points)
        try:
            cell_regions(tags, _allowed(boxes[0].geometry))
        except MeshError as error:
            raise MeshError(
                "boxes that differ, or that stand loose, need regions, which say what are the walls of each box and "
                f"what carries its fill: {error}"
            ) from error
        meshes, used = [], []
        for cells, box in zip(_cells_of_boxes(points, quads, boxes), boxes, strict=True):
            used.append(np.unique(quads[cells]))
            meshes.append(_container(points, quads[cells], tags.of(cells), box.geometry, box.fill))
        middles = [0.5 * (points[nodes, 0].min() + points[nodes, 0].max()) for nodes in used]
        for number, (middle, box) in enumerate(zip(middles, boxes, strict=True), 1):
            if abs(middle - middles[0] - box.axis) > TOLERANCE * box.geometry.width:
                raise MeshError(
                    f"the axis of box {number} is {middle - middles[0]:.9g} m beside that of the lowest, "
                    f"in the case {box.axis:.9g} m; change its offset_m, or the mesh"
                )
        for number, (lower, upper) in enumerate(pairwise(used), 1):
            if loose and (shared := np.intersect1d(lower, upper)).size:
                raise MeshError(
                    f"boxes {number} and {number + 1} share {shared.size} nodes, but loose boxes may not: give each "
                    "box points and lines of its own (Gmsh: no Coherence, BooleanFragments or merging of duplicate "
                    'nodes; Abaqus: one part a box), or take joints = "bolted"'
                )
        apart = placed_apart(boxes, meshes)
        return apart if loose else _joined(boxes, apart, used)
    except MeshError as error:
        raise type(error)(f"mesh file {path}: {error}") from error


def _joined(boxes: Sequence[StackedBox], apart: ContainerMesh, nodes: Sequence[IntArray]) -> ContainerMesh:
    """The mesh of bolted boxes, whose points are these nodes of the file, with each node once."""
    near = TOLERANCE * min(box.geometry.width for box in boxes)
    for number, (lower, upper) in enumerate(pairwise(boxes)):
        left, right = max(lower.sides[0], upper.sides[0]), min(lower.sides[1], upper.sides[1])
        faces = []
        for k in (number, number + 1):
            x, z = apart.points[np.unique(apart.quads[apart.box == k])].T
            on_face = (np.abs(z - upper.bottom) <= near) & (x >= left - near) & (x <= right + near)
            faces.append(nodes[k][on_face])
        if not np.array_equal(*faces):
            raise MeshError(
                f"boxes {number + 1} and {number + 2} do not share the nodes of the face between them: merge "
                f"coincident points, put mesh lines of both at x = {left:g} and {right:g} m, or take "
                'joints = "loose"'
            )
    _, first, merged = np.unique(np.concatenate(nodes), return_index=True, return_inverse=True)
    return replace(apart, elevation=Elevation(apart.points[first], merged[apart.quads]))


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


def _parse(path: Path) -> tuple[FloatArray, IntArray, CellTags]:
    """Points (n, 2 or 3) [m], corners (m, 4) and tags; every error of a reader becomes a MeshError."""
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        known = ", ".join(f"{each} ({name})" for each, name in FORMATS.items())
        raise MeshError(f"format {suffix or 'without suffix'} is not read; known are {known}")
    if not path.is_file():
        raise MeshError("no such file")
    size = path.stat().st_size
    if not 0 < size <= MOST_BYTES:  # files of the kernel have no size, and may never end
        raise MeshError(f"{size} bytes; 1 to {MOST_BYTES} are read; take larger elements")
    chatter = io.StringIO()
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
        if block.shape[1] < 8:
            continue
        corners, middles = points[block[:, :4]], points[block[:, 4:8]]
        ends = np.roll(corners, -1, axis=1)
        offset = np.linalg.norm(middles - 0.5 * (corners + ends), axis=2)
        length = np.linalg.norm(ends - corners, axis=2)
        if not (offset <= STRAIGHT_SHARE * length).all():
            worst = block[np.argmax((offset - STRAIGHT_SHARE * length).max(axis=1)), :4]
            raise MeshError(
                f"the cell with corners {worst.tolist()} has curved sides; only straight ones are read"
            )
    data = {name: np.concatenate([values[n] for n in chosen]) for name, values in mesh.cell_data.items()}
    sets = {}  # one flag a quadrilateral
    for name, members in mesh.cell_sets.items():
        if name.startswith("gmsh:") or len(members) != len(mesh.cells):
            continue
        flags = [np.zeros(len(mesh.cells[number].data), dtype=bool) for number in chosen]
        for flag, number in zip(flags, chosen, strict=True):
            if members[number] is not None:
                flag[np.asarray(members[number], dtype=np.int64)] = True
        sets[name] = np.concatenate(flags)
    tags = CellTags(
        count=count,
        sets=sets,
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
    points = _placed_on_floor(_plane(points[used]), geometry.width, geometry.total_height)
    clockwise = signed_areas(points, quads) < 0.0
    quads[clockwise] = quads[clockwise, ::-1]
    elevation = Elevation(points, quads)
    require_tiling(points, quads, geometry.width, geometry.total_height)

    region = cell_regions(tags, _allowed(geometry))
    area, centroid = elevation.areas_and_centroids
    thickness = cell_thickness(geometry, region, centroid[:, 0])
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
    return ContainerMesh(
        elevation=elevation, region=region, box=box, thickness=thickness, areal_density=density
    )


def _allowed(geometry: ContainerGeometry) -> tuple[Region, ...]:
    solid = geometry.section is Section.SOLID
    return (Region.SOLID,) if solid else (Region.WALL, Region.SHEET, Region.FILL)


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


def _placed_on_floor(points: FloatArray, width: float, height: float) -> FloatArray:
    """Points (n, 2) shifted to z = 0 and centred on x = 0; points on a side are moved exactly onto it [m]."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.array([width, height])
    if not (np.abs(high - low - size) <= TOLERANCE * size).all():
        raise MeshError(
            f"the mesh is {high[0] - low[0]:.9g} m wide and {high[1] - low[1]:.9g} m high, "
            f"the container {width:.9g} m and {height:.9g} m (all boxes); mesh files are read in m"
        )
    placed = points - [0.5 * (low[0] + high[0]), low[1]]
    for axis, sides in ((0, (-0.5 * width, 0.5 * width)), (1, (0.0, height))):
        for side in sides:
            placed[np.abs(placed[:, axis] - side) <= TOLERANCE * size[axis], axis] = side
    return placed


def require_tiling(points: FloatArray, quads: IntArray, width: float, height: float) -> None:
    """Refuse counter-clockwise cells that do not tile a box on the floor, centred on x = 0.

    Raises:
        MeshError: an edge of more than two cells, an inner edge of only one, areas that do not add up.
    """
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    pairs, counts = np.unique(edges, axis=0, return_counts=True)
    if counts.max() > 2:
        raise MeshError(
            f"{int(counts.max())} cells share the edge {_where(points, pairs[np.argmax(counts)])}"
        )
    free = pairs[counts == 1]
    start, stop = points[free[:, 0]], points[free[:, 1]]
    on_side = np.zeros(len(free), dtype=bool)
    for axis, sides in ((0, (-0.5 * width, 0.5 * width)), (1, (0.0, height))):
        for side in sides:
            on_side |= (start[:, axis] == side) & (stop[:, axis] == side)
    if not on_side.all():
        raise MeshError(
            f"the edge {_where(points, free[np.argmin(on_side)])} is inside the container but belongs to "
            f"one cell only ({int(np.sum(~on_side))} such edges): merge coincident points, remove hanging "
            "ones, close gaps"
        )
    area = float(signed_areas(points, quads).sum())
    if not abs(area - width * height) <= TOLERANCE * width * height:
        raise MeshError(
            f"the cells cover {area:.9g} m2 of an elevation of {width * height:.9g} m2: they overlap"
        )


def _where(points: FloatArray, edge: IntArray) -> str:
    (x0, z0), (x1, z1) = points[edge]
    return f"from x = {x0:.6g} m, z = {z0:.6g} m to x = {x1:.6g} m, z = {z1:.6g} m"
