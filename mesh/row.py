"""The meshes of containers in a row as one mesh."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from mesh.container import ContainerMesh


def mesh_of_row(meshes: Sequence[ContainerMesh], x: Sequence[float]) -> Any:
    """All meshes as one, in their order and with their axes at x [m]: the part that the assembly needs."""
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    boxes = np.cumsum([0, *(1 + mesh.box.max() for mesh in meshes)])
    return SimpleNamespace(
        points=np.concatenate(
            [mesh.points + np.array([at, 0.0]) for mesh, at in zip(meshes, x, strict=True)]
        ),
        quads=np.concatenate([mesh.quads + start for mesh, start in zip(meshes, starts, strict=False)]),
        box=np.concatenate([mesh.box + start for mesh, start in zip(meshes, boxes, strict=False)]),
        **{
            name: np.concatenate([getattr(mesh, name) for mesh in meshes])
            for name in ("region", "thickness", "areal_density")
        },
    )
