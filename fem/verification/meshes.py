"""Meshes that are no containers: images of the unit square, for published benchmarks and manufactured solutions."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.runtime.arrays import FloatArray, IntArray

Mapping = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, kw_only=True, eq=False)
class PlainMesh:
    """What the assembly asks of a mesh; no mass, base or quality is asked for."""

    points: FloatArray  #: (n, 2) [m]
    quads: IntArray  #: (m, 4), counter-clockwise
    region: IntArray  #: (m,)
    thickness: FloatArray  #: (m,) [m]
    areal_density: FloatArray  #: (m,) [kg/m2]


def mapped_mesh(
    columns: int, rows: int, place: Mapping, *, thickness: float = 1.0, density: float = 1.0
) -> PlainMesh:
    """Quads on the image of the unit square under `place`(s, t); density in kg/m3."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, columns + 1), np.linspace(0.0, 1.0, rows + 1))
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    corner = (j * (columns + 1) + i).ravel().astype(np.int64)
    full = np.ones(corner.size)
    return PlainMesh(
        points=np.stack(place(s.ravel(), t.ravel()), axis=1),
        quads=np.stack([corner, corner + 1, corner + columns + 2, corner + columns + 1], axis=1),
        region=np.zeros(corner.size, dtype=np.int64),
        thickness=thickness * full,
        areal_density=density * thickness * full,
    )
