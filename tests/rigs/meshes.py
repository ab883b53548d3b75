"""Meshes of the checks: images of the unit square, a block with a graded base, a bar."""

from collections.abc import Callable

import numpy as np

from fem.runtime.arrays import FloatArray
from mesh.container import ContainerMesh, grid_quads
from mesh.elevation import Elevation
from mesh.region import Region
from mesh.stack import MeshArrays

Mapping = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]


def mapped_mesh(
    columns: int, rows: int, mapping: Mapping, *, thickness: float = 1.0, density: float = 1.0
) -> MeshArrays:
    """Quads on the image of the unit square under `mapping`(s, t), sizes in m; density in kg/m3."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, columns + 1), np.linspace(0.0, 1.0, rows + 1))
    quads = grid_quads(columns, rows)
    full = np.ones(len(quads))
    return MeshArrays(
        points=np.stack(mapping(s.ravel(), t.ravel()), axis=1),
        quads=quads,
        region=np.zeros(len(quads), dtype=np.int64),
        box=np.zeros(len(quads), dtype=np.int64),
        thickness=thickness * full,
        areal_density=density * thickness * full,
    )


def grid_mesh(x: FloatArray, z: FloatArray, *, depth: float, areal_density: float) -> ContainerMesh:
    """A solid block with mesh lines at x and z [m]; areal density in kg/m2 of the elevation."""
    quads = grid_quads(x.size - 1, z.size - 1)
    return ContainerMesh(
        elevation=Elevation(np.column_stack([np.tile(x, z.size), np.repeat(z, x.size)]), quads),
        region=np.full(len(quads), int(Region.SOLID)),
        box=np.zeros(len(quads), dtype=np.int64),
        thickness=np.full(len(quads), depth),
        areal_density=np.full(len(quads), areal_density),
    )


def graded_block() -> ContainerMesh:
    """A block of 1.1 x 1.0 m, columns narrowing toward both ends."""
    x = 0.55 * np.sin(0.5 * np.pi * np.linspace(-1.0, 1.0, 9))
    return grid_mesh(x, np.linspace(0.0, 1.0, 6), depth=0.5, areal_density=1000.0)
