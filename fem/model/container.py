"""The container of a case, discretised: mesh, elements, contact nodes, elastic modes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.interface.faces import TOUCHING, make_faces, make_row
from contact.interface.support import Support
from fem.case.case import Case
from fem.case.tables.neighbours import Places, places_of
from fem.model.geometry import build_container, node_count
from fem.model.links import places_of_links, side_points
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
from mesh.stack import MeshArrays, box_mesh, mesh_of_row

ROUNDED = 9  #: decimals of the numbers by which boxes are equal


@dataclass(frozen=True, kw_only=True, eq=False)
class Container:
    """A discretised container, or one of its bodies; independent of floor, motion and damping, so many cases share one.

    The bodies of a container of several are the boxes of a loose stack, each on z = 0 and centred on x = 0, or the
    containers of a row. Their nodes are four: lower left and right, upper left and right; in a row in place of the
    upper ones those nearest to where its sides are struck. Equal ones share one.
    """

    mesh: ContainerMesh
    elements: FiniteElements
    support: Support
    #: (n_c,) contact nodes, those of the base first, by rising x, those nearest to links last; of a loose stack or a
    #: row the corners that touch, in the order of `contact.interface.faces`, before these
    nodes: IntArray
    monitors: IntArray  #: (n_m,) nodes whose motion is observed
    #: to forces at its contact nodes; of a container of a row at those it has alone, of which the first two are the
    #: same; none of a loose stack, a row as a whole, a rigid container
    response: StaticResponse
    basis: ReducedBasis  #: elastic modes of a reduced model; none of the others
    free_modes: int  #: of the basis, the lowest so many are those of the free container
    first: float  #: lowest elastic angular frequency; infinite for a rigid container [rad/s]
    #: its bodies, of a loose stack from the floor up; none where it is one itself
    boxes: tuple["Container", ...] = ()
    row: tuple["Container", ...] = ()  #: the containers of a row alone, that of the case first
    box_nodes: tuple[IntArray, ...] = ()  #: the node of the container for each node of each box

    @property
    def bodies(self) -> tuple["Container", ...]:
        """What moves each for itself."""
        return self.boxes or (self,)

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
                try:
                    known[key] = discretise(alone, None if number else mesh)
                except MeshError as error:
                    if not number:
                        raise
                    raise MeshError(f"[[neighbour]] {number}, as a container: {error}") from error
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
    return _body(case, mesh, elements, support, nodes)


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
    if case.foot != own.foot:  # the mesh has a line at its inner end
        return None
    if any(getattr(case.support, key) != getattr(own.support, key) for key in ("kind", "camber_m")):
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


def _assembled(case: Case, mesh: ContainerMesh | MeshArrays) -> FiniteElements:
    box = case.container
    order = case.solver.order
    return assemble(mesh, youngs_modulus=box.youngs_modulus_Pa, poisson_ratio=box.poisson_ratio, order=order)


def _no_modes(elements: FiniteElements) -> tuple[StaticResponse, ReducedBasis]:
    nodes = elements.nodes
    return (
        StaticResponse(displacement=np.zeros((0, *nodes.shape)), compliance=np.zeros((0, 0))),
        ReducedBasis(
            angular_frequencies=np.zeros(0),
            shapes=np.zeros((0, *nodes.shape)),
            stress=np.zeros((3, 0, len(nodes))),
        ),
    )


def _body(
    case: Case, mesh: ContainerMesh, elements: FiniteElements, support: Support, nodes: IntArray
) -> Container:
    """One body that may be touched at these nodes."""
    (response, basis), first, model = _no_modes(elements), math.inf, case.solver.model
    if model != "rigid":
        response = static_response(elements, nodes)
    if model == "reduced":
        basis = reduced_basis(elements, response, modes_of_a_body(case))
        first = float(basis.angular_frequencies[0])
    elif model == "full":
        first = float(elastic_modes(elements, 1).angular_frequencies[0])
    # what is observed: the two upper corners, then the middle and the outermost nodes of the contents
    contents = np.isin(elements.region, (Region.FILL, Region.SOLID))
    held = np.unique(elements.cells[contents] if contents.any() else elements.cells)
    x, z = elements.nodes[held].T
    corners = [
        held[np.argmax(a * x / np.ptp(x) + b * z / np.ptp(z))] for a in (-1.0, 1.0) for b in (-1.0, 1.0)
    ]
    middle = held[np.argmin(np.hypot(x - x.mean(), z - 0.5 * (z.min() + z.max())))]
    return Container(
        mesh=mesh,
        elements=elements,
        support=support,
        nodes=nodes,
        monitors=np.concatenate([_upper_corners(elements), [middle, *corners]]),
        response=response,
        basis=basis,
        free_modes=case.solver.elastic_modes if model == "reduced" else 0,
        first=first,
    )


def _loose(case: Case, mesh: ContainerMesh, elements: FiniteElements, support: Support) -> Container:
    """A container of boxes that share no node; boxes with equal meshes are analysed once."""
    known: dict[tuple[bytes, ...], Container] = {}
    boxes, nodes = [], []
    for number in range(case.container.boxes):
        own = box_mesh(mesh, number)
        key = tuple(
            np.round(part, ROUNDED).tobytes()
            for part in (own.points, own.quads, own.region, own.thickness, own.areal_density)
        )
        if key not in known:
            alone = _assembled(case, own)
            corners = np.concatenate([alone.base_nodes[[0, -1]], _upper_corners(alone)])
            known[key] = _body(case, own, alone, support, corners)
        boxes.append(known[key])
        nodes.append(_places(boxes[-1], elements.cells[mesh.box == number]))
    # Those of the uppermost box first, with its upper corners; then box by box downwards.
    monitors = [
        place[box.monitors[0 if place is nodes[-1] else 2 :]] for box, place in zip(boxes, nodes, strict=True)
    ]
    corners = np.concatenate([place[box.nodes] for box, place in zip(boxes, nodes, strict=True)])
    touching = make_faces(elements.nodes[corners], np.ones(0), np.ones(0)).corner[:, TOUCHING]
    return _of_bodies(
        case,
        mesh,
        elements,
        support,
        touching=corners[touching],
        monitors=np.concatenate(monitors[::-1]),
        boxes=boxes,
        nodes=nodes,
    )


def _places(body: Container, cells: IntArray) -> IntArray:
    """The node of the whole for each node of a body, which has these cells of the whole."""
    place = np.empty(len(body.elements.nodes), dtype=np.int64)
    place[body.elements.cells] = cells
    return place


def _of_bodies(
    case: Case,
    mesh: ContainerMesh,
    elements: FiniteElements,
    support: Support,
    *,
    touching: IntArray,
    monitors: IntArray,
    boxes: Sequence[Container],
    nodes: Sequence[IntArray],
    row: Sequence[Container] = (),
) -> Container:
    """A container of several bodies, and the node of it for each node of each."""
    held = []  # nodes nearest to the points of links
    for point in side_points(case):
        x, z = boxes[point.box].elements.nodes.T
        on_side = np.abs(x - (x.max() if point.right else x.min())) <= 1e-9 * np.ptp(x)
        away = np.where(on_side, np.abs(z - z.min() - point.place * np.ptp(z)), math.inf)
        held.append(nodes[point.box][int(np.argmin(away))])
    response, basis = _no_modes(elements)
    return Container(
        mesh=mesh,
        elements=elements,
        support=support,
        nodes=np.append(touching, np.array(held, dtype=np.int64)),
        monitors=monitors,
        response=response,
        basis=basis,
        free_modes=0,
        first=min(box.first for box in boxes),
        boxes=tuple(boxes),
        row=tuple(row),
        box_nodes=tuple(nodes),
    )


def _beside_one_another(case: Case, row: Sequence[Container]) -> Container:
    """Containers as a row; the elements and boxes are those of all."""
    meshes = [alone.mesh for alone in row]
    places = places_of(case, [mesh.width for mesh in meshes])
    struck = np.array(places.struck([(mesh.width, mesh.height) for mesh in meshes]))
    elements = _assembled(case, mesh_of_row(meshes, places.x))
    behind = np.cumsum([len(alone.elements.cells) for alone in row])
    nodes = [
        _places(alone, elements.cells[end - len(alone.elements.cells) : end])
        for alone, end in zip(row, behind, strict=True)
    ]
    boxes = [
        replace(
            alone,
            nodes=np.concatenate([alone.elements.base_nodes[[0, -1]], nodes_at(at, alone.elements.nodes)]),
        )
        for alone, at in zip(row, struck, strict=True)
    ]
    corners = np.concatenate([place[box.nodes] for box, place in zip(boxes, nodes, strict=True)])
    faces = make_row(np.ones((corners.size, 2)), *facing(places), np.zeros(len(row)), *np.zeros((2, 0)))
    return _of_bodies(
        case,
        meshes[0],
        elements,
        row[0].support,
        touching=corners[faces.corner[:, TOUCHING]],
        monitors=nodes[0][row[0].monitors],
        boxes=boxes,
        nodes=nodes,
        row=row,
    )


def facing(places: Places) -> tuple[IntArray, FloatArray]:
    """Containers that face each other at each gap of a row (N - 1, 2), and the distances of their axes (N - 1,) [m]."""
    return np.array(places.pairs, dtype=np.int64), np.array(places.distance)


def _upper_corners(elements: FiniteElements) -> IntArray:
    x, z = elements.nodes.T
    top = np.flatnonzero(z >= z.max() - 1e-9 * np.ptp(z))
    return top[[np.argmin(x[top]), np.argmax(x[top])]]
