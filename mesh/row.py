"""The meshes of containers beside one another as one."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from mesh.container import ContainerMesh


def mesh_of_row(meshes: Sequence[ContainerMesh], x: Sequence[float]) -> Any:
    """What the assembly needs of all meshes as one, one behind the other, with their axes at these places [m]."""
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
