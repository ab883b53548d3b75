"""The meshes of containers beside one another as one."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from mesh.container import ContainerMesh


def mesh_of_row(meshes: Sequence[ContainerMesh], x: Sequence[float]) -> Any:
    """What the assembly needs of all meshes as one, one behind the other, with their axes at these places [m]."""
    starts = np.cumsum([0, *(len(one.points) for one in meshes)])
    boxes = np.cumsum([0, *(1 + one.box.max() for one in meshes)])
    return SimpleNamespace(
        points=np.concatenate([one.points + np.array([at, 0.0]) for one, at in zip(meshes, x, strict=True)]),
        quads=np.concatenate([one.quads + start for one, start in zip(meshes, starts, strict=False)]),
        box=np.concatenate([one.box + start for one, start in zip(meshes, boxes, strict=False)]),
        **{
            name: np.concatenate([getattr(one, name) for one in meshes])
            for name in ("region", "thickness", "areal_density")
        },
    )
