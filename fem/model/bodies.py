"""Several bodies as one on their floor: the boxes of a loose stack, or the containers of a row, whose sides may touch.

A joint between two boxes has the springs of a rigid floor under the face that they share, and friction and dashpot of
its own. Each contact point has the spring of a corner; two corners that face each other share it.

Each container of a row is built and settled alone, by its own case. The first is that of the case itself; behind it
stand the neighbours in the order of the case. Its coordinates are in a frame of its own, so that a gap that nothing
uses up changes no bit.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from contact.interface.faces import ASIDE, CORNERS, place_points, weigh_points
from contact.interface.laws import ELASTIC_STICK
from contact.interface.penalty import relaxation_time
from contact.interface.workspace import Contact
from contact.stepping.body import State, make_state
from contact.stepping.boxes import POINTS_OF_GAP
from contact.stepping.loose_stack import LooseStack, make_stack, settle_stack, start_stack
from contact.stepping.modal_body import ModalBody, make_modal_body
from fem.case.case import Case, CaseError
from fem.case.tables.boxes import shared_face
from fem.case.tables.neighbours import places_of
from fem.model.bounce import bounce_of
from fem.model.container import Container, facing
from fem.model.links import OVERLAP, appended, dashpot_of, side_points
from fem.model.support import base_points
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.nodal_body import FullBody, FullStack
from mesh.container import ContainerMesh

#: step above which the solver begins at the old positions of held points, over 1/(angular bounce frequency): in the
#: short steps of a rattle the old forces are the better guess
HELD_SHARE = 0.15
TURNED_STEPS = 4  #: without line search, where points turn: corners that rattle turn in cycles


def with_joints(case: Case, floor: Contact, mass: float, penalty: float) -> Contact:
    """The contact of the floor under the lowest box, extended by the joints between boxes of this `mass` in all [kg].

    `penalty`: normal stiffness of a face over width times depth [Pa/m].
    """
    stack, friction, chosen, depth = case.stack, case.joint_friction, case.contact, case.container.depth_m
    faces = [shared_face(*pair) for pair in pairwise(stack)]
    # a point for each of the two corners of both boxes
    springs = np.repeat([0.5 * penalty * (right - left) * depth for left, right in faces], CORNERS)
    damping = relaxation_time(case.joints.dashpot, mass, penalty * stack[0].width * depth)
    joints = appended(
        floor,
        springs.size,
        normal_stiffness=springs,
        tangential_stiffness=chosen.tangential_ratio * springs,
        relaxation_time=damping,
        mu_static=friction["mu_static"],
        mu_kinetic=friction["mu_kinetic"],
        weakening=friction["weakening_m"],
    )
    held_step = HELD_SHARE * math.sqrt(mass / float(floor.normal_stiffness.sum()))
    return joints._replace(held_step=held_step, turned_steps=TURNED_STEPS)


def floating_body(
    case: Case,
    body: Container,
    *,
    placed: FloatArray,
    shapes: FloatArray,
    watched: IntArray,
    rest: tuple[float, float],
    damping: float,
    tolerance: float,
) -> ModalBody:
    """A container or a box in its floating frame.

    Args:
        placed: its contact points (n, 2) [m]; shapes: of its modes there, (m, n, 2).
        watched: nodes whose motion is observed; rest: its mass centre where it stands undeformed [m].
        damping: a of C = a K [s]; tolerance: error of a point at which a step stops iterating [m].
    """
    centroid, basis = np.asarray(body.mesh.centroid), body.basis
    return make_modal_body(
        mass=body.mesh.mass,
        inertia=body.mesh.inertia,
        gravity=case.gravity_toward_floor,
        downhill=case.gravity_downhill,
        point=placed - centroid,
        rest=rest,
        shape=np.moveaxis(shapes, 0, -1),
        frequencies=basis.angular_frequencies,
        damping_ratios=0.5 * damping * basis.angular_frequencies,
        monitor=body.elements.nodes[watched] - centroid,
        monitor_shape=np.moveaxis(basis.shapes[:, watched], 0, -1),
        tolerance=tolerance,
    )


def stack_of(case: Case, container: Container, contact: Contact, tolerance: float) -> LooseStack | FullStack:
    """The boxes of a loose stack as one body; `tolerance`: error of a corner at which a step stops iterating [m]."""
    springs = contact.normal_stiffness.copy(), contact.tangential_stiffness.copy()
    damping = bounce_of(case, container, contact).material_damping
    gravity, downhill = case.gravity_toward_floor, case.gravity_downhill
    nodal, modal = [], []
    for number, (box, place) in enumerate(zip(container.boxes, case.stack, strict=True)):
        # what is monitored: its contents; of the uppermost box its upper corners before them
        watched = box.monitors if number == len(container.boxes) - 1 else box.monitors[2:]
        if case.solver.model == "full":
            placed = replace(box.elements, nodes=container.elements.nodes[container.box_nodes[number]])
            nodal.append(
                FullBody(placed, box.nodes, watched, gravity=gravity, downhill=downhill, damping=damping)
            )
            continue
        centroid, corners = box.mesh.centroid, box.elements.nodes[box.nodes]
        modal.append(
            floating_body(
                case,
                box,
                placed=base_points(case, container.mesh, corners, 2 if number == 0 else 0),
                shapes=box.basis.shapes[:, box.nodes],
                watched=watched,
                rest=(place.axis + float(centroid[0]), place.bottom + float(centroid[1])),
                damping=damping,
                tolerance=tolerance,
            )
        )
    if case.solver.model == "full":
        responses = [box.response for box in container.boxes]
        return FullStack(nodal, responses, *springs, tolerance, side_points(case))
    return make_stack(modal, *springs, held=side_points(case))


def make_stack_state(stack: LooseStack | FullStack) -> State:
    """A state of a stack, all zero."""
    if isinstance(stack, FullStack):
        coordinates, beneath = stack.coordinates, stack.stack
        monitors = int(beneath.body.monitors.max())
    else:
        beneath, body = stack, stack.body
        coordinates, monitors = len(body.boxes.mass) * (3 + body.modes), len(body.boxes.monitor)
    return make_state(coordinates, beneath.faces.weight.size, monitors, beneath.mass.size)


def settle(
    stack: LooseStack | FullStack,
    contact: Contact,
    state: State,
    *,
    gravity: float,
    place: tuple[float, float] = (0.0, 0.0),
    velocity: tuple[float, float] = (0.0, 0.0),
    lift_velocity: float = 0.0,
) -> FloatArray:
    """Write the state of a stack at rest, as `contact.stepping.loose_stack.settle_stack`.

    Returns:
        The forces on its corners, along x and z, shape (N, 4, 2) [N].
    """
    if isinstance(stack, FullStack):
        stack.settle(
            contact, state, gravity=gravity, place=place, velocity=velocity, lift_velocity=lift_velocity
        )
        stack = stack.stack
    else:
        settle_stack(
            stack,
            contact,
            state,
            gravity=gravity,
            place=place,
            velocity=velocity,
            lift_velocity=lift_velocity,
        )
    return stack.corners.force.reshape(-1, CORNERS, 2)


def own_stiffness(contact: Contact) -> Contact:
    """The contact with springs of its own, which the weights of its points change."""
    return contact._replace(
        normal_stiffness=contact.normal_stiffness.copy(),
        tangential_stiffness=contact.tangential_stiffness.copy(),
    )


def require_no_jam(case: Case, meshes: Sequence[ContainerMesh]) -> None:
    """Refuse friction regularised in velocity that can jam a corner as it lands, as a CaseError with the limit.

    Friction mu on a corner at the distances x and z from the mass centre presses it into the floor faster than its
    normal force lifts it where mu > (I/m + x^2) / (x z): the paradox of Painleve. The springs of the other law take it
    up; this law has forces that jump, and the steps shrink without end.
    """
    if case.contact.friction == "elastic-stick":
        return
    limits = []
    for mesh in meshes:
        x, z = 0.5 * case.effective_width * mesh.width + abs(mesh.centroid[0]), mesh.centroid[1]
        other = x - 2.0 * abs(mesh.centroid[0])
        limits.append(min((mesh.inertia / mesh.mass + arm * arm) / (arm * z) for arm in (x, other)))
    number = int(np.argmin(limits))
    if case.contact.mu_static > limits[number]:
        which = f"neighbour {number}" if number else "the container"
        raise CaseError(
            f'[contact] friction = "regularised": with mu_static = {case.contact.mu_static:g} a corner of {which} can '
            f"jam on the floor as it lands, above {limits[number]:.3g}, and the run would not get on; "
            'take "elastic-stick", or less friction'
        )


def contact_of_row(case: Case, contacts: Sequence[Contact], masses: Sequence[float]) -> Contact:
    """The contact of containers of these masses [kg] with the floor, each its own, and of their sides."""
    sides = []
    places = places_of(case, [1.0] * len(masses))
    for neighbour, (left, right) in zip(case.neighbour, places.pairs, strict=True):
        mass = masses[left] * masses[right] / (masses[left] + masses[right])
        sides.append((0.5 * neighbour.stiffness_N_m, dashpot_of(neighbour, mass), neighbour.mu))
    stiffness, relaxation, mu = (np.repeat(column, POINTS_OF_GAP) for column in zip(*sides, strict=True))
    names = [name for name, part in contacts[0]._asdict().items() if isinstance(part, np.ndarray)]
    arrays: Any = {name: np.concatenate([getattr(own, name) for own in contacts]) for name in names}
    floor = contacts[0]._replace(resolution=contacts[0].resolution * (1.0 + ASIDE * len(sides)), **arrays)
    return appended(
        floor,
        mu.size,
        normal_stiffness=stiffness,
        tangential_stiffness=stiffness,
        relaxation_time=relaxation,
        mu_static=mu,
        mu_kinetic=mu,
    )


def body_of_row(
    case: Case, bodies: Sequence[ModalBody], containers: Sequence[Container], contact: Contact
) -> LooseStack:
    """The containers of a row as one body; `bodies`: they alone, with their points over the floor."""
    meshes = [container.mesh for container in containers]
    places = places_of(case, [mesh.width for mesh in meshes])
    inset = [
        max(round(0.5 * (1.0 - float(np.ptp(body.point[:, 0])) / mesh.width), 12), 0.0)
        for body, mesh in zip(bodies, meshes, strict=True)
    ]
    watched: list[ModalBody] = []
    for body, mesh in zip(bodies, meshes, strict=True):  # with the corners of its elevation as its points
        corner = [(x, z) for z in (0.0, mesh.height) for x in (-0.5 * mesh.width, 0.5 * mesh.width)]
        if watched:  # of the neighbours no point is watched
            body = body._replace(monitor=body.monitor[:0], monitor_shape=body.monitor_shape[:0])
        watched.append(body._replace(point=np.array(corner) - body.rest, shape=np.zeros((len(corner), 2, 0))))
    springs = contact.normal_stiffness.copy(), contact.tangential_stiffness.copy()
    return make_stack(watched, *springs, (*facing(places), np.array(inset)), held=side_points(case))


def measure_gaps(body: LooseStack, standing: FloatArray, contact: Contact) -> None:
    """Place the containers of a row so that its gaps are those at rest, with their corners (N, 4, 2) there [m].

    All lean on uneven springs. `contact` has a stiffness of its own, which is written.
    """
    boxes, faces, floor = body.body.boxes, body.faces, 2 * len(standing)
    undeformed = boxes.rest[:, None] + boxes.point
    before, at_rest = (_least_gaps(body, corners, contact) for corners in (undeformed, standing))
    pairs = faces.bodies[floor : floor + POINTS_OF_GAP * before.size : POINTS_OF_GAP]
    for pair, change in zip(pairs, before - at_rest, strict=True):
        faces.apart[:] += change * np.all(faces.bodies == pair, axis=1) * faces.side


def _least_gaps(body: LooseStack, corners: FloatArray, contact: Contact) -> FloatArray:
    """The gaps of a row, (g,) [m], with its corners (N, 4, 2) there."""
    point = np.zeros((contact.cap.size, 2))
    sides = slice(2 * len(corners), 2 * len(corners) + POINTS_OF_GAP * (len(corners) - 1))
    weigh_points(body.faces, corners.reshape(-1, 2), point, contact)
    place_points(body.faces, corners.reshape(-1, 2), point)
    gaps = np.where(body.faces.weight > 0.0, point[:, 1], math.inf)[sides]
    return np.asarray(gaps.reshape(-1, POINTS_OF_GAP).min(axis=1))


def begin_row(
    case: Case,
    body: LooseStack,
    contact: Contact,
    alone: Sequence[State],
    *,
    place: tuple[float, float],
    lift_velocity: float,
) -> State:
    """The initial state of a row from those of its containers alone; `contact` has a stiffness of its own, written.

    `place` and `lift_velocity` are those of the floor [m], [m/s]. CaseError: two of them overlap.
    """
    boxes, state, floor = body.body.boxes, make_stack_state(body), 2 * len(alone)
    for name in ("position", "velocity"):
        for own, single in zip(getattr(state, name).reshape(len(alone), -1), alone, strict=True):
            own[: single.position.size] = getattr(single, name)
    sides = slice(floor, floor + POINTS_OF_GAP * len(case.neighbour))
    state.force[:floor] = np.concatenate([settled.force for settled in alone])
    if contact.friction == ELASTIC_STICK:
        state.stick[:floor] = np.concatenate([settled.stick for settled in alone])
    weigh_points(body.faces, (boxes.rest[:, None] + boxes.point).reshape(-1, 2), state.point, contact)
    start_stack(body, state, place=place, lift_velocity=lift_velocity)
    gaps = state.point[sides, 1].reshape(-1, POINTS_OF_GAP).min(axis=1)
    for number, (neighbour, gap) in enumerate(zip(case.neighbour, gaps, strict=True), 1):
        if gap < -OVERLAP:
            raise CaseError(
                f"[neighbour] neighbour {number}: gap_m = {neighbour.gap_m:g} m is overlapped by {-gap:.3g} m at the "
                "start, as the containers stand; take a wider one, or another [initial]"
            )
    return state
