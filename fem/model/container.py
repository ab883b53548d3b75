"""The container of a case, discretised: mesh, elements, contact nodes, elastic modes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.interface.contact_points import make_faces, make_row
from contact.interface.faces import TOUCHING
from contact.interface.support import Support
from fem.case.case import Case
from fem.case.tables.neighbours import Places, places_of
from fem.model.geometry import build_container, node_count
from fem.model.links import nodes_on_sides, places_of_links, side_points
from fem.model.support import build_support
from fem.model.validity import require_memory
from fem.runtime.arrays import FloatArray, IntArray
from fem.runtime.threads import use_one_blas_thread
from fem.solid.assembly import FiniteElements, assemble
from fem.solid.edges import nodes_at
from fem.solid.modes import ElasticModes, elastic_modes, signs_of
from fem.solid.reduction import ReducedBasis, StaticResponse, reduced_basis, static_response
from mesh.container import ContainerMesh
from mesh.errors import MeshError
from mesh.region import Region
from mesh.stack import box_mesh, mesh_of_row

ROUNDED = 9  #: decimals of the numbers by which boxes are equal


@dataclass(frozen=True, kw_only=True, eq=False)
class BoxModel:
    """One box of a loose stack, discretised on z = 0 and centred on x = 0; equal boxes share one."""

    mesh: ContainerMesh
    elements: FiniteElements
    #: (4,) nodes: lower left and right, upper left and right; of a container in a row in place of the upper ones those
    #: nearest to where its sides are struck
    corners: IntArray
    monitors: IntArray  #: nodes whose motion is observed
    response: StaticResponse  #: to forces at the corners; none of a rigid box
    basis: ReducedBasis  #: elastic modes of a reduced box; none of the others
    first: float  #: lowest elastic angular frequency; infinite for a rigid box [rad/s]


@dataclass(frozen=True, kw_only=True, eq=False)
class Container:
    """A discretised container; it does not depend on floor, motion and damping, so many cases share one."""

    mesh: ContainerMesh
    elements: FiniteElements
    support: Support
    #: (n_c,) contact nodes, those of the base first, by rising x, those nearest to links last; of a loose stack or a
    #: row the corners that touch, in the order of `contact.interface.faces`, before these
    nodes: IntArray
    monitors: IntArray  #: (n_m,) nodes whose motion is observed
    response: StaticResponse  #: none of a loose stack, a rigid container
    basis: ReducedBasis  #: elastic modes of a reduced model; none of the others
    free_modes: int  #: of the basis, the lowest so many are those of the free container
    first: float  #: lowest elastic angular frequency; infinite for a rigid container [rad/s]
    #: of a loose stack, from the floor up; or each container of a row as one
    boxes: tuple[BoxModel, ...] = ()
    row: tuple["Container", ...] = ()  #: the containers of a row alone, that of the case first
    box_nodes: tuple[IntArray, ...] = ()  #: the node of the container for each node of each box

    @property
    def corners(self) -> IntArray:
        """Nodes at the corners of all boxes of a loose stack, in the order of `contact.interface.faces`, (4 N,)."""
        corners = [nodes[box.corners] for box, nodes in zip(self.boxes, self.box_nodes, strict=True)]
        return np.concatenate(corners)

    def lowest_modes(self, count: int) -> ElasticModes:
        """The lowest elastic modes of the free container: those of a reduced model, or computed.

        Of a loose stack those of its boxes, of equal boxes once.
        """
        if not self.boxes and count > self.free_modes:
            return elastic_modes(self.elements, count)
        if not self.boxes:
            shapes = self.basis.shapes[:count]
            frequencies = self.basis.angular_frequencies[:count] / (2.0 * math.pi)
            return ElasticModes(frequencies_Hz=frequencies, shapes=shapes * signs_of(shapes))
        own, parts = [], []
        distinct = {id(box): (box, nodes) for box, nodes in zip(self.boxes, self.box_nodes, strict=True)}
        for box, nodes in distinct.values():
            modes = elastic_modes(box.elements, count)
            own.append(modes.frequencies_Hz)
            parts.append(np.zeros((count, *self.elements.nodes.shape)))
            parts[-1][:, nodes] = modes.shapes
        rising = np.argsort(np.concatenate(own), kind="stable")[:count]
        return ElasticModes(frequencies_Hz=np.concatenate(own)[rising], shapes=np.concatenate(parts)[rising])


def modes_of_a_body(case: Case) -> int:
    """Elastic modes of each body: the boxes of a loose stack share those of the case, rounded up."""
    return math.ceil(case.solver.elastic_modes / case.container.bodies)


def discretise(case: Case, mesh: ContainerMesh | None = None) -> Container:
    """Build elements, contact nodes and elastic modes of a case's container; `mesh`: where it is built already."""
    use_one_blas_thread()
    if case.neighbour:
        known: dict[str, Container] = {}  # equal ones are built once
        keys = [repr((alone.container, alone.support)) for alone in case.row]
        for number, (key, alone) in enumerate(zip(keys, case.row, strict=True)):
            if key not in known:
                known[key] = _neighbour(number, alone) if number else discretise(alone, mesh)
        return _beside_one_another(case, [known[key] for key in keys])
    mesh = mesh or build_container(case)
    support = build_support(case, mesh)
    require_memory(case, node_count(mesh, case.solver.order), support.index.size)
    elements = _assembled(case, mesh)
    if case.container.is_loose:
        return _loose(case, mesh, elements, support)
    nodes = elements.base_nodes[support.index]
    if not case.output.stop_when_overturned:  # lying on its side it touches with the upper corners, too
        nodes = np.concatenate([nodes, _upper_corners(elements)])
    nodes = np.concatenate([nodes, nodes_at(places_of_links(case), elements.nodes)])
    rigid = case.solver.model == "rigid"
    response = _no_response(elements) if rigid else static_response(elements, nodes)
    basis, first = _elastic(case, elements, response, modes_of_a_body(case))
    return Container(
        mesh=mesh,
        elements=elements,
        support=support,
        nodes=nodes,
        monitors=_monitors(elements),
        response=response,
        basis=basis,
        free_modes=case.solver.elastic_modes if case.solver.model == "reduced" else 0,
        first=first,
    )


def changed_container(case: Case, container: Container, own: Case) -> Container:
    """`adapted_container`, or a new one where that touches at other points."""
    return adapted_container(case, container, own) or discretise(case)


def adapted_container(case: Case, container: Container, own: Case) -> Container | None:
    """The container of a case from that of another case, `own`, with other places of its mass or contacts; else None.

    Elements and elastic modes stay where the same points touch; a shift of the mass by some hundredths changes them by
    less than its own square. None where other points touch.
    """
    given, there = case.container, own.container
    if case.neighbour:
        if all(getattr(case, key) == getattr(own, key) for key in ("container", "support", "neighbour")):
            return container
        row = zip(case.row, container.row, own.row, strict=True)
        return _beside_one_another(case, [changed_container(*standing) for standing in row])
    if (given.centroid_m, given.eccentricity_m) != (there.centroid_m, there.eccentricity_m):
        mesh = build_container(case)
        boxes = tuple(replace(box, mesh=box_mesh(mesh, number)) for number, box in enumerate(container.boxes))
        container = replace(container, mesh=mesh, boxes=boxes)
    if any(getattr(case.support, key) != getattr(own.support, key) for key in ("kind", "camber_m")) or (
        case.foot != own.foot
    ):
        if case.foot != own.foot:  # the mesh has a line at its inner end
            return None
        support = build_support(case, container.mesh)
        if not np.array_equal(support.index, container.support.index):
            return None
        container = replace(container, support=support)
    return container


def without_links(case: Case, container: Container) -> Container:
    """The container of a case without neighbours and the contact nodes of its links; their attachment modes stay."""
    if container.row:
        return container.row[0]
    points = len(container.nodes) - len(case.links)
    return replace(container, nodes=container.nodes[:points], response=container.response.of_first(points))


def _assembled(case: Case, mesh: ContainerMesh) -> FiniteElements:
    box = case.container
    order = case.solver.order
    return assemble(mesh, youngs_modulus=box.youngs_modulus_Pa, poisson_ratio=box.poisson_ratio, order=order)


def _elastic(
    case: Case, elements: FiniteElements, response: StaticResponse, modes: int
) -> tuple[ReducedBasis, float]:
    """Elastic modes of a reduced model, and the lowest angular frequency [rad/s]."""
    none = _no_modes(elements)
    if case.solver.model == "reduced":
        basis = reduced_basis(elements, response, modes)
        return basis, float(basis.angular_frequencies[0])
    if case.solver.model == "full":
        return none, float(elastic_modes(elements, 1).angular_frequencies[0])
    return none, math.inf


def _no_modes(elements: FiniteElements) -> ReducedBasis:
    nodes = elements.nodes
    return ReducedBasis(
        angular_frequencies=np.zeros(0),
        shapes=np.zeros((0, *nodes.shape)),
        stress=np.zeros((3, 0, len(nodes))),
    )


def _no_response(elements: FiniteElements) -> StaticResponse:
    return StaticResponse(displacement=np.zeros((0, *elements.nodes.shape)), compliance=np.zeros((0, 0)))


def _loose(case: Case, mesh: ContainerMesh, elements: FiniteElements, support: Support) -> Container:
    """A container of boxes that share no node; boxes with equal meshes are analysed once."""
    known: dict[tuple[bytes, ...], BoxModel] = {}
    boxes, nodes = [], []
    for number in range(case.container.boxes):
        own = box_mesh(mesh, number)
        key = tuple(
            np.round(part, ROUNDED).tobytes()
            for part in (own.points, own.quads, own.region, own.thickness, own.areal_density)
        )
        if key not in known:
            known[key] = _box(case, own)
        boxes.append(known[key])
        place = np.empty(len(boxes[-1].elements.nodes), dtype=np.int64)
        place[boxes[-1].elements.cells] = elements.cells[mesh.box == number]
        nodes.append(place)
    # Those of the uppermost box first, with its upper corners; then box by box downwards.
    monitors = [
        place[box.monitors[0 if place is nodes[-1] else 2 :]] for box, place in zip(boxes, nodes, strict=True)
    ]
    container = _of_bodies(mesh, elements, support, np.concatenate(monitors[::-1]), boxes, nodes)
    touching = make_faces(elements.nodes[container.corners], np.ones(0), np.ones(0)).corner[:, TOUCHING]
    return replace(container, nodes=np.append(container.corners[touching], _nodes_held(case, container)))


def _of_bodies(
    mesh: ContainerMesh,
    elements: FiniteElements,
    support: Support,
    monitors: IntArray,
    boxes: Sequence[BoxModel],
    nodes: Sequence[IntArray],
) -> Container:
    """A container of several bodies, and the node of it for each node of each; its contact nodes are still to come."""
    return Container(
        mesh=mesh,
        elements=elements,
        support=support,
        nodes=np.zeros(0, dtype=np.int64),
        monitors=monitors,
        response=_no_response(elements),
        basis=_no_modes(elements),
        free_modes=0,
        first=min(box.first for box in boxes),
        boxes=tuple(boxes),
        box_nodes=tuple(nodes),
    )


def _beside_one_another(case: Case, row: Sequence[Container]) -> Container:
    """Containers as a row; the elements and boxes are those of all."""
    meshes = [alone.mesh for alone in row]
    places = places_of(case, [mesh.width for mesh in meshes])
    struck = np.array(places.struck([(mesh.width, mesh.height) for mesh in meshes]))
    elements = _assembled(case, mesh_of_row(meshes, places.x))
    first, nodes = 0, []
    for alone in row:
        behind = first + len(alone.elements.cells)
        nodes.append(np.empty(len(alone.elements.nodes), dtype=np.int64))
        nodes[-1][alone.elements.cells] = elements.cells[first:behind]
        first = behind
    boxes = tuple(
        BoxModel(
            mesh=alone.mesh,
            elements=alone.elements,
            corners=np.concatenate([alone.elements.base_nodes[[0, -1]], nodes_at(at, alone.elements.nodes)]),
            monitors=alone.monitors,
            response=alone.response,
            basis=alone.basis,
            first=alone.first,
        )
        for alone, at in zip(row, struck, strict=True)
    )
    monitors = nodes[0][row[0].monitors]
    container = _of_bodies(meshes[0], elements, row[0].support, monitors, boxes, nodes)
    container = replace(container, row=tuple(row))
    corners = container.corners
    touching = make_row(np.ones((corners.size, 2)), *facing(places), np.zeros(len(row)), *np.zeros((2, 0)))
    touched = corners[touching.corner[:, TOUCHING]]
    return replace(container, nodes=np.append(touched, _nodes_held(case, container)))


def _nodes_held(case: Case, container: Container) -> IntArray:
    """Nodes of the container nearest to the points of links on its boxes, (k,)."""
    points = side_points(case)
    own = nodes_on_sides(points, [box.elements.nodes for box in container.boxes])
    chosen = [container.box_nodes[point.box][node] for point, node in zip(points, own, strict=True)]
    return np.array(chosen, dtype=np.int64)


def facing(places: Places) -> tuple[IntArray, FloatArray]:
    """Containers that face each other at each gap of a row (N - 1, 2), and the distances of their axes (N - 1,) [m]."""
    return np.array(places.pairs, dtype=np.int64), np.array(places.distance)


def _neighbour(number: int, alone: Case) -> Container:
    try:
        return discretise(alone)
    except MeshError as error:
        raise MeshError(f"[[neighbour]] {number}, as a container: {error}") from error


def _box(case: Case, mesh: ContainerMesh) -> BoxModel:
    elements = _assembled(case, mesh)
    corners = np.concatenate([elements.base_nodes[[0, -1]], _upper_corners(elements)])
    response = _no_response(elements)
    if case.solver.model != "rigid":
        response = static_response(elements, corners)
    basis, first = _elastic(case, elements, response, modes_of_a_body(case))
    return BoxModel(
        mesh=mesh,
        elements=elements,
        corners=corners,
        monitors=_monitors(elements),
        response=response,
        basis=basis,
        first=first,
    )


def _upper_corners(elements: FiniteElements) -> IntArray:
    x, z = elements.nodes.T
    top = np.flatnonzero(z >= z.max() - 1e-9 * np.ptp(z))
    return top[[np.argmin(x[top]), np.argmax(x[top])]]


def _monitors(elements: FiniteElements) -> IntArray:
    """Nodes to observe: the two upper corners, then the middle and the outermost nodes of the contents."""
    contents = np.isin(elements.region, (Region.FILL, Region.SOLID))
    held = np.unique(elements.cells[contents] if contents.any() else elements.cells)
    x, z = elements.nodes[held].T
    corners = [
        held[np.argmax(a * x / np.ptp(x) + b * z / np.ptp(z))] for a in (-1.0, 1.0) for b in (-1.0, 1.0)
    ]
    middle = held[np.argmin(np.hypot(x - x.mean(), z - 0.5 * (z.min() + z.max())))]
    return np.concatenate([_upper_corners(elements), [middle, *corners]])
