"""The mesh of a case: its filled container, standing on the floor."""

import numpy as np

from fem.case.case import Case
from fem.runtime.arrays import FloatArray
from mesh.container import ContainerMesh, build_container_mesh
from mesh.files import read_container_mesh
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, Section


def build_container(case: Case) -> ContainerMesh:
    """The case's container: from its mesh file if it names one, else structured.

    Raises:
        MeshError: too many cells, walls heavier than the box, an impossible mass centre or foot, a mesh file
            that does not fit the case.
        CaseError: the mesh file is missing in the folder of the case.
    """
    box = case.container
    geometry = ContainerGeometry(
        width=box.width_m,
        height=box.height_m,
        depth=box.depth_m,
        boxes=box.boxes,
        section=Section(box.section),
        wall=box.wall_m if box.section == "shell" else None,
    )
    fill = MassFill(mass=case.box_mass, centroid_height=box.centroid_m, wall_density=box.wall_density_kg_m3)
    if box.mesh_file is not None:
        return read_container_mesh(case.data_files["container.mesh_file"], geometry, fill)
    return build_container_mesh(
        geometry, fill, element_size=case.solver.element_size_m, foot=case.support.foot
    )


def node_count(mesh: ContainerMesh, order: int) -> int:
    """Number of nodes: the points of the mesh; for order 2 also one on every edge and in every cell."""
    if order == 1:
        return len(mesh.points)
    edges = np.sort(np.stack([mesh.quads, np.roll(mesh.quads, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    return len(mesh.points) + len(np.unique(edges, axis=0)) + len(mesh.quads)


def base_positions(mesh: ContainerMesh, order: int) -> FloatArray:
    """x of the nodes on the floor from left to right, shape (n,) [m]; order 2 has one in every edge."""
    base = mesh.points[mesh.base_points, 0]
    return base if order == 1 else np.sort(np.concatenate([base, 0.5 * (base[1:] + base[:-1])]))
