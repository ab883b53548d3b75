"""A loose stack at rest on its floor: its contact points, its boxes as one body, its joints.

A joint between two boxes has the springs of a rigid floor under the face that they share, and friction and dashpot of
its own. Each contact point has the spring of a corner; two corners that face each other share it.
"""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from contact.interface.penalty import relaxation_time
from contact.interface.workspace import Contact
from contact.stepping.body import State, make_state
from contact.stepping.loose_stack import LooseStack
from contact.stepping.modal_body import make_modal_body
from contact.stepping.stack_body import make_stack, settle_stack
from fem.case.case import Case
from fem.case.tables.boxes import shared_face
from fem.model.bounce import bounce_of
from fem.model.container import Container
from fem.model.links import appended, side_points
from fem.model.support import base_points
from fem.runtime.arrays import FloatArray
from fem.solid.nodal_body import FullBody, FullStack

POINTS = 4  #: of a joint between boxes
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
    springs = np.repeat([0.5 * penalty * (right - left) * depth for left, right in faces], POINTS)
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


def stack_of(case: Case, container: Container, contact: Contact, tolerance: float) -> LooseStack | FullStack:
    """The boxes of a loose stack as one body; `tolerance`: error of a corner at which a step stops iterating [m]."""
    springs = contact.normal_stiffness.copy(), contact.tangential_stiffness.copy()
    damping = bounce_of(case, container, contact).material_damping
    gravity, downhill = case.gravity_toward_floor, case.gravity_downhill
    nodal, modal = [], []
    for number, (box, place) in enumerate(zip(container.boxes, case.stack, strict=True)):
        # what is monitored: its contents; of the uppermost box its upper corners before them
        watched = box.monitors if number == len(container.boxes) - 1 else box.monitors[2:]
        nodes = box.elements.nodes
        if case.solver.model == "full":
            placed = replace(box.elements, nodes=container.elements.nodes[container.box_nodes[number]])
            nodal.append(
                FullBody(placed, box.corners, watched, gravity=gravity, downhill=downhill, damping=damping)
            )
            continue
        centroid, basis = np.asarray(box.mesh.centroid), box.basis
        corner = base_points(case, container.mesh, nodes[box.corners], 2 if number == 0 else 0)
        modal.append(
            make_modal_body(
                mass=box.mesh.mass,
                inertia=box.mesh.inertia,
                gravity=gravity,
                downhill=downhill,
                point=corner - centroid,
                rest=(place.axis + float(centroid[0]), place.bottom + float(centroid[1])),
                shape=np.moveaxis(basis.shapes[:, box.corners], 0, -1),
                frequencies=basis.angular_frequencies,
                damping_ratios=0.5 * damping * basis.angular_frequencies,
                monitor=nodes[watched] - centroid,
                monitor_shape=np.moveaxis(basis.shapes[:, watched], 0, -1),
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
    """Write the state of a stack at rest, as `contact.stepping.stack_body.settle_stack`.

    Returns:
        The forces on its corners, along x and z, shape (N, 4, 2) [N].
    """
    if isinstance(stack, FullStack):
        stack.settle(
            contact, state, gravity=gravity, place=place, velocity=velocity, lift_velocity=lift_velocity
        )
        return stack.stack.corners.force.reshape(-1, POINTS, 2)
    settle_stack(
        stack, contact, state, gravity=gravity, place=place, velocity=velocity, lift_velocity=lift_velocity
    )
    return stack.corners.force.reshape(-1, POINTS, 2)


def own_stiffness(contact: Contact) -> Contact:
    """The contact with springs of its own, which the weights of its points change."""
    return contact._replace(
        normal_stiffness=contact.normal_stiffness.copy(),
        tangential_stiffness=contact.tangential_stiffness.copy(),
    )
