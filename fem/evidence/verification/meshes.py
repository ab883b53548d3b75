"""Meshes of the checks: images of the unit square, a block with a graded base, a bar."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.runtime.arrays import FloatArray, IntArray
from mesh.container import ContainerMesh

Mapping = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, kw_only=True, eq=False)
class PlainMesh:
    """What the assembly needs of a mesh; it has no mass, base or quality."""

    points: FloatArray  #: (n, 2) [m]
    quads: IntArray  #: (m, 4), counter-clockwise
    region: IntArray  #: (m,)
    box: IntArray  #: (m,)
    thickness: FloatArray  #: (m,) [m]
    areal_density: FloatArray  #: (m,) [kg/m2]


def mapped_mesh(
    columns: int, rows: int, mapping: Mapping, *, thickness: float = 1.0, density: float = 1.0
) -> PlainMesh:
    """Quads on the image of the unit square under `place`(s, t); density in kg/m3."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, columns + 1), np.linspace(0.0, 1.0, rows + 1))
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    corner = (j * (columns + 1) + i).ravel().astype(np.int64)
    full = np.ones(corner.size)
    return PlainMesh(
        points=np.stack(mapping(s.ravel(), t.ravel()), axis=1),
        quads=np.stack([corner, corner + 1, corner + columns + 2, corner + columns + 1], axis=1),
        region=np.zeros(corner.size, dtype=np.int64),
        box=np.zeros(corner.size, dtype=np.int64),
        thickness=thickness * full,
        areal_density=density * thickness * full,
    )


def grid_mesh(x: FloatArray, z: FloatArray, *, depth: float, areal_density: float) -> ContainerMesh:
    """A solid block with mesh lines at x and z [m]; areal density in kg/m2 of the elevation."""
    columns, rows = x.size - 1, z.size - 1
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    return ContainerMesh(
        points=np.column_stack([np.tile(x, z.size), np.repeat(z, x.size)]),
        quads=np.column_stack([first, first + 1, first + columns + 2, first + columns + 1]),
        region=np.full(first.size, 3),
        box=np.zeros(first.size, dtype=np.int64),
        thickness=np.full(first.size, depth),
        areal_density=np.full(first.size, areal_density),
    )


def graded_block() -> ContainerMesh:
    """A block of 1.1 x 1.0 m, columns narrowing toward both ends."""
    x = 0.55 * np.sin(0.5 * np.pi * np.linspace(-1.0, 1.0, 9))
    return grid_mesh(x, np.linspace(0.0, 1.0, 6), depth=0.5, areal_density=1000.0)
