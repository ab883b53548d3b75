"""Meshes from files: what is read back, what is refused and by which name."""

import meshio
import numpy as np
import pytest
from mesh_writer import write_container_mesh

from mesh.container import ContainerMesh, build_container_mesh
from mesh.errors import MeshError, MeshQualityError
from mesh.files import read_container_mesh
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section
from mesh.region import Region

STACK = ContainerGeometry(width=1.1, height=1.0, depth=1.1, boxes=2, wall=0.008)
BLOCK = ContainerGeometry(width=1.1, height=1.0, depth=1.1, boxes=2, section=Section.SOLID)
FILL = MassFill(mass=2500.0, centroid_height=0.5)
SUFFIXES = [".msh", ".vtu", ".vtk", ".inp"]


def stack(fill: MassFill = FILL) -> ContainerMesh:
    return build_container_mesh(STACK, fill, element_size=0.2)


def block(element_size: float = 0.25) -> ContainerMesh:
    return build_container_mesh(BLOCK, FILL, element_size=element_size)


def written(path, mesh, *, points=None, cells=None, tags="region", region=None, **mesh_arguments):
    """A file with the cells of `mesh`, changed as a test needs it; points with two or three columns."""
    points = mesh.points if points is None else points
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    cells = [("quad", mesh.quads)] if cells is None else cells
    if tags is not None:
        mesh_arguments["cell_data"] = {tags: [mesh.region if region is None else region]}
    meshio.write_points_cells(path, points, cells, **mesh_arguments)
    return path


def refused(path, reason, geometry=STACK, error=MeshError):
    """Reading the file ends with this reason, which names the file."""
    with pytest.raises(error, match=reason) as caught:
        read_container_mesh(path, geometry, FILL)
    assert str(caught.value).startswith(f"mesh file {path}: ")


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(("geometry", "centroid"), [(STACK, 0.5), (STACK, 0.42), (STACK, 0.58), (BLOCK, 0.4)])
def test_a_mesh_comes_back_as_it_was_written(tmp_path, suffix, geometry, centroid):
    fill = MassFill(mass=2500.0, centroid_height=centroid)
    mesh = build_container_mesh(geometry, fill, element_size=0.2)
    write_container_mesh(tmp_path / f"mesh{suffix}", mesh)
    again = read_container_mesh(tmp_path / f"mesh{suffix}", geometry, fill)
    assert again.points == pytest.approx(mesh.points, abs=1e-15)
    for name in ("quads", "region", "thickness"):
        assert (getattr(again, name) == getattr(mesh, name)).all()
    assert again.areal_density == pytest.approx(mesh.areal_density, rel=1e-9)
    assert again.mass == pytest.approx(5000.0, rel=1e-9)
    assert again.centroid[1] == pytest.approx(0.5 + centroid, rel=1e-9)


GROUPS = {"wall": 42, "sheet": 7, "fill": 13}  # numbers are arbitrary: only names count


def gmsh_4_text(mesh: ContainerMesh) -> str:
    """The mesh as Gmsh 4.1 writes it (its manual, MSH file format): a surface a region, one curve."""
    regions = [region for region in Region if (mesh.region == region).any()]
    base = mesh.base_points + 1
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(1 + len(regions))]
    lines += ['1 99 "base"', *(f'2 {GROUPS[each.name.lower()]} "{each.name.lower()}"' for each in regions)]
    lines += ["$EndPhysicalNames", "$Entities", f"0 1 {len(regions)} 0", "1 0 0 0 1 0 0 1 99 0"]
    lines += [f"{each + 1} 0 0 0 1 2 0 1 {GROUPS[each.name.lower()]} 0" for each in regions]
    count = len(mesh.points)
    lines += ["$EndEntities", "$Nodes", f"1 {count} 1 {count}", f"2 1 0 {count}"]
    lines += [*map(str, range(1, count + 1)), *(f"{x!r} {z!r} 0" for x, z in mesh.points.tolist())]
    total = len(base) - 1 + len(mesh.quads)
    lines += ["$EndNodes", "$Elements", f"{1 + len(regions)} {total} 1 {total}", f"1 1 1 {len(base) - 1}"]
    lines += [f"{n + 1} {base[n]} {base[n + 1]}" for n in range(len(base) - 1)]
    number = len(base)
    for each in regions:
        quads = mesh.quads[mesh.region == each] + 1
        lines.append(f"2 {each + 1} 3 {len(quads)}")
        for quad in quads:
            lines.append(f"{number} " + " ".join(map(str, quad)))
            number += 1
    return "\n".join([*lines, "$EndElements", ""])


def test_gmsh_4_physical_groups_are_read_by_name(tmp_path):
    fill = MassFill(mass=2500.0, centroid_height=0.42)
    mesh = stack(fill)
    (tmp_path / "mesh.msh").write_text(gmsh_4_text(mesh))
    again = read_container_mesh(tmp_path / "mesh.msh", STACK, fill)
    assert np.bincount(again.region).tolist() == np.bincount(mesh.region).tolist()
    assert again.inertia == pytest.approx(mesh.inertia, rel=1e-9)


@pytest.mark.parametrize("columns", [(0, 1), (0, 2), (1, 2)])
def test_elevation_may_lie_in_the_x_y_or_the_x_z_plane_anywhere(tmp_path, columns):
    mesh = stack()
    points = np.full((len(mesh.points), 3), 3.0)
    points[:, columns] += mesh.points
    path = written(tmp_path / "mesh.vtu", mesh, points=points)
    if columns == (1, 2):
        refused(path, r"not in the x-y or the x-z plane: it measures 0 x 1.1 x 2 m")
    else:
        again = read_container_mesh(path, STACK, FILL)
        assert again.points == pytest.approx(mesh.points, abs=1e-14)


@pytest.mark.parametrize("kind", ["quad8", "quad9"])
@pytest.mark.parametrize("bulge", [0.0, 0.05])
def test_corners_of_straight_quadratic_cells_are_taken_and_curved_ones_refused(tmp_path, kind, bulge):
    mesh = block(0.2)
    corners = mesh.points[mesh.quads]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    middles[3, 0, 1] += bulge * 0.2
    extra = np.concatenate([middles, corners.mean(axis=1, keepdims=True)], axis=1)[:, : int(kind[-1]) - 4]
    points = np.concatenate([mesh.points, extra.reshape(-1, 2)])
    numbers = len(mesh.points) + np.arange(extra.shape[0] * extra.shape[1]).reshape(extra.shape[:2])
    cells = [(kind, np.concatenate([mesh.quads, numbers], axis=1))]
    path = written(tmp_path / "mesh.vtu", mesh, points=points, cells=cells)
    if bulge:
        refused(path, "has curved sides", BLOCK)
    else:
        again = read_container_mesh(path, BLOCK, FILL)
        assert (len(again.points), again.quads.shape) == (len(mesh.points), mesh.quads.shape)


@pytest.mark.parametrize(
    ("tags", "region", "reason"),
    [
        ("material", None, r"no cell is tagged with a region \(wall, sheet, fill\); found field material"),
        ("region", 7, r"no cell is tagged .*; found region 7 \(98 cells\)"),
        ("region", 3, r"tagged solid do not belong to this section \(wall, sheet, fill\)"),
        ("wall-sheet-fil", None, r"are in no region.*fil \(\d+ cells\).*did you mean fill by fil\?"),
        ("wall", None, r"cell field wall must be 0 or 1"),
    ],
)
def test_wrong_tags_are_refused_by_name(tmp_path, tags, region, reason):
    mesh = stack()
    region = None if region is None else np.full(len(mesh.quads), region)
    refused(written(tmp_path / "mesh.vtu", mesh, tags=tags, region=region), reason)


@pytest.mark.parametrize(("kind", "count"), [("triangle", 3), ("triangle6", 6), ("hexahedron", 8)])
def test_other_cells_are_refused_by_name(tmp_path, kind, count):
    mesh = stack()
    cells = [("quad", mesh.quads), (kind, [list(range(count))])]
    refused(
        written(tmp_path / "mesh.vtu", mesh, tags=None, cells=cells),
        rf"cells of type {kind}: only quadrilaterals",
    )


@pytest.mark.parametrize(("factor", "accepted"), [(1000.0, False), (1.0 + 2e-6, False), (1.0 + 5e-7, True)])
def test_dimensions_must_be_those_of_the_geometry_and_both_are_named(tmp_path, factor, accepted):
    mesh = stack()
    path = written(tmp_path / "mesh.vtu", mesh, points=factor * mesh.points)
    if accepted:
        again = read_container_mesh(path, STACK, FILL)
        assert (again.width, again.height) == (1.1, 2.0)
    else:
        refused(path, rf"mesh is {1.1 * factor:.9g} m wide .*the container 1.1 m and 2 m")


def test_cracks_hanging_points_overlaps_and_holes_are_refused(tmp_path):
    mesh, path = block(), tmp_path / "mesh.vtu"
    inner = int(np.flatnonzero((np.abs(mesh.points[:, 0]) < 0.5) & (mesh.points[:, 1] == 1.0))[0])
    cracked = mesh.quads.copy()
    neighbour = int(np.flatnonzero((cracked == inner).any(axis=1))[0])
    cracked[neighbour] = np.where(cracked[neighbour] == inner, len(mesh.points), cracked[neighbour])
    written(path, mesh, points=np.vstack([mesh.points, mesh.points[inner]]), cells=[("quad", cracked)])
    refused(path, r"is inside the container but belongs to one cell only", BLOCK)

    every = np.arange(len(mesh.quads))
    for kept, reason in (
        (np.delete(every, 10), r"belongs to one cell only"),
        (np.append(every, 10), r"3 cells share the edge from x = "),
    ):
        written(path, mesh, cells=[("quad", mesh.quads[kept])], region=mesh.region[kept])
        refused(path, reason, BLOCK)

    two_layers = np.concatenate([mesh.quads, mesh.quads + len(mesh.points)])
    points, region = np.tile(mesh.points, (2, 1)), np.tile(mesh.region, 2)
    written(path, mesh, points=points, cells=[("quad", two_layers)], region=region)
    refused(path, r"cover 4.4 m2 of an elevation of 2.2 m2: they overlap", BLOCK)


def test_distorted_cells_and_positions_that_are_no_numbers_are_refused(tmp_path):
    mesh = block()
    inner = int(np.flatnonzero((np.abs(mesh.points[:, 0]) < 0.5) & (mesh.points[:, 1] == 1.0))[0])
    for place, error, reason in (
        (mesh.points[inner] + 0.3, MeshQualityError, r"cell \d+ at x = .*scaled Jacobian .*corner angles"),
        (np.nan, MeshError, f"point {inner} has no finite position"),
    ):
        points = mesh.points.copy()
        points[inner] = place
        refused(written(tmp_path / "mesh.vtu", mesh, points=points), reason, BLOCK, error)


@pytest.mark.parametrize("suffix", [".pkl", ".npz", ".npy", ".xdmf", ".h5m", ".py", ""])
def test_formats_that_are_more_than_numbers_are_refused(tmp_path, suffix):
    (tmp_path / f"mesh{suffix}").write_text("$MeshFormat")
    refused(tmp_path / f"mesh{suffix}", r"is not read; known are .msh \(Gmsh\), .vtu")


@pytest.mark.parametrize(
    ("size", "reason"), [(0, "0 bytes; 1 to 100"), (101, "101 bytes; 1 to 100 are read")]
)
def test_an_empty_file_and_one_that_is_too_large_are_refused_unread(tmp_path, monkeypatch, size, reason):
    monkeypatch.setattr("mesh.files.MOST_BYTES", 100)
    (tmp_path / "mesh.msh").write_bytes(bytes(size))
    refused(tmp_path / "mesh.msh", reason)
