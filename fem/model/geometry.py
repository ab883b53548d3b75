"""The mesh of a case: its filled container, standing on the floor."""

from dataclasses import replace

import numpy as np

from fem.case.case import Case
from fem.runtime.arrays import FloatArray
from mesh.container import ContainerMesh, build_container_mesh, with_mass_beside
from mesh.files import read_container_mesh, read_stack_mesh
from mesh.fill import MassFill
from mesh.geometry import ContainerGeometry, CornerPost, Section
from mesh.stack import StackedBox, build_bolted_mesh, build_loose_mesh


def build_container(case: Case) -> ContainerMesh:
    """The case's container: from its mesh file if it names one, else structured; loose boxes share no node.

    CaseError, MeshError: a mesh file that is missing or does not fit; walls, posts or a mass that are impossible.
    """
    container, size, foot = case.container, case.solver.element_size_m, case.foot
    file = case.data_files["container.mesh_file"] if container.mesh_file is not None else None
    post = container.post_section
    boxes = [
        StackedBox(
            geometry=ContainerGeometry(
                width=box.width,
                height=box.height,
                depth=container.depth_m,
                section=Section(container.section),
                wall=box.wall,
                round=container.is_round,
                post=None if post is None else CornerPost(width=post[0], wall=post[1]),
            ),
            fill=MassFill(
                mass=box.mass, centroid_height=box.centroid, wall_density=container.wall_density_kg_m3
            ),
            axis=box.axis,
            bottom=box.bottom,
        )
        for box in case.stack
    ]
    bears = case.solver.model != "rigid" and (case.support.kind != "corners" or case.rolls)
    if container.box is None and not container.is_loose:
        lowest = boxes[0]
        geometry = replace(lowest.geometry, boxes=container.boxes)
        if file is not None:
            mesh = read_container_mesh(file, geometry, lowest.fill)
        else:
            mesh = build_container_mesh(geometry, lowest.fill, element_size=size, foot=foot, bears=bears)
    elif file is not None:
        mesh = read_stack_mesh(file, boxes, loose=container.is_loose)
    elif container.is_loose:
        mesh = build_loose_mesh(boxes, element_size=size, foot=foot)
    else:
        mesh = build_bolted_mesh(boxes, element_size=size, foot=foot, bears=bears)
    beside = container.eccentricity_m
    return with_mass_beside(mesh, beside) if beside else mesh


def node_count(mesh: ContainerMesh, order: int) -> int:
    """Number of nodes: the points of the mesh; for order 2 also one on every edge and in every cell."""
    if order == 1:
        return len(mesh.points)
    first, last = mesh.quads, np.roll(mesh.quads, -1, axis=1)
    edges = np.sort(np.minimum(first, last) * len(mesh.points) + np.maximum(first, last), axis=None)
    different = 1 + int(np.count_nonzero(np.diff(edges)))  # np.unique would import masked arrays
    return len(mesh.points) + different + len(mesh.quads)


def base_positions(mesh: ContainerMesh, order: int) -> FloatArray:
    """x of the nodes on the floor from left to right, shape (n,) [m]; order 2 has one in every edge."""
    base = mesh.points[mesh.base_points, 0]
    return base if order == 1 else np.sort(np.concatenate([base, 0.5 * (base[1:] + base[:-1])]))
