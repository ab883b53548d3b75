"""Mesh files for the tests of `mesh.files`."""

import tempfile
from functools import cache
from pathlib import Path

import meshio
import numpy as np

from mesh.container import ContainerMesh, build_container_mesh
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section
from mesh.region import Region


def write_container_mesh(path: Path, mesh: ContainerMesh) -> None:
    """Write a mesh with its regions, in the format of the suffix; x and z in the first two columns."""
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    present = [region for region in Region if (mesh.region == region).any()]
    written = meshio.Mesh(points, [("quad", mesh.quads)])
    match path.suffix.lower():
        case ".msh":
            # Physical groups count from 1; 0 means none.
            written.field_data = {region.name.lower(): np.array([region + 1, 2]) for region in present}
            written.cell_data = {"gmsh:physical": [mesh.region + 1], "gmsh:geometrical": [mesh.region + 1]}
            meshio.gmsh.write(path, written, fmt_version="2.2", binary=False, float_fmt=".17g")
        case ".inp":
            written.cell_sets = {
                region.name.lower(): [np.flatnonzero(mesh.region == region)] for region in present
            }
            meshio.abaqus.write(path, written)
        case ".vtu" | ".vtk":
            written.cell_data = {
                "region": [mesh.region],
                "thickness": [mesh.thickness],
                "areal_density": [mesh.areal_density],
            }
            if path.suffix.lower() == ".vtu":
                meshio.vtu.write(path, written, compression=None)
            else:
                meshio.vtk.write(path, written)
        case _:
            raise ValueError(path.suffix)


@cache
def mesh_of(suffix: str, *, shell: bool) -> bytes:
    """A mesh file of a stack of two boxes."""
    geometry = ContainerGeometry(
        width=1.1, height=1.0, depth=1.1, boxes=2, section=Section.SHELL if shell else Section.SOLID,
        wall=0.02 if shell else None,
    )  # fmt: skip
    mesh = build_container_mesh(geometry, MassFill(mass=2500.0, centroid_height=0.5), element_size=0.5)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mesh{suffix}"
        write_container_mesh(path, mesh)
        return path.read_bytes()
