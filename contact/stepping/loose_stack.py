"""Boxes that stand on one another without bolts, as one body: corners of any body over `contact.interface.faces`.

So do stacks beside one another, each a "box" that stands on the floor; the first is the one that a run is about.
Beneath are the boxes, each a body of its own whose base points are its four corners; here they are `ModalBody`s with as
many modes each. This layer gives the stepping the contact points in their place. Coordinates are those of the boxes in
turn, from the floor up.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.interface.equilibrium import StackedStances, stacked
from contact.interface.faces import (
    CORNERS,
    Faces,
    SidePoint,
    condense_points,
    is_of_one_box,
    linearise_points,
    make_faces,
    make_row,
    move_corners,
    place_points,
    share_forces,
    weigh_points,
)
from contact.interface.laws import ELASTIC_STICK
from contact.interface.workspace import Contact, Workspace, make_workspace
from contact.jit import compiled, inlined
from contact.layout import exchanging, row_of, shapes_of
from contact.stepping import body as interface
from contact.stepping.body import Boxes, Frame, Ground, State, implements
from contact.stepping.modal_body import STEP_SLOTS, ModalBody, by_modes, own_scratch
from contact.stepping.scheme import Scheme
from contact.structs import struct


@struct
class StackBody(NamedTuple):
    """N boxes with as many modes each."""

    #: a `ModalBody` whose fields have an axis of boxes in front, but for gravity, downhill, tolerance, and monitored
    #: points, which are of all boxes
    boxes: Any
    starts: IntArray  #: (N + 1,) first coordinate of a box
    monitors: IntArray  #: (N, 2) first monitored point of a box, and the one behind its last
    energy: FloatArray  #: (N, 3) scratch

    @property
    def modes(self) -> int:
        """Modes of each box."""
        return int(self.boxes.stiffness.shape[1])


@struct
class LooseStack(NamedTuple):
    """N boxes on one another, or beside one another."""

    body: Any  #: the boxes: a `StackBody`, or a class with these fields and a `box_of`
    faces: Faces
    mass: FloatArray  #: (N,) of the boxes [kg]
    tolerance: float  #: error of a contact point at which an iteration stops [m]
    in_a_row: bool  #: the boxes are stacks beside one another
    corners: Workspace  #: scratch, of the corners


one_box = row_of(ModalBody, "gravity", "downhill", "tolerance", "monitor", "monitor_shape")
COORDINATES = tuple(name for name, shape in shapes_of(State).items() if shape == ("d",))
state_of_box = exchanging(State, *COORDINATES, "point", "force", "pose", "energy", "monitor")
work_of_box = exchanging(Workspace, "free", "free_velocity", "compliance", "point", "velocity", "force")


def make_stack(
    boxes: Sequence[ModalBody],
    normal_stiffness: FloatArray,
    tangential_stiffness: FloatArray,
    row: tuple[IntArray, FloatArray, FloatArray] | None = None,
    held: Sequence[SidePoint] = (),
) -> LooseStack:
    """A loose stack of boxes, from the floor up; or bodies beside one another.

    Args:
        boxes: each with its four corners as base points, and `rest` its mass centre in the undeformed stack. Monitored
            points are those of the uppermost box first, then downwards.
        normal_stiffness, tangential_stiffness: of the contact points at full weight [N/m].
        row: of bodies beside one another what `make_row` says of them: pairs, distance, inset.
        held: points of sides that come last.
    """
    n, most = len(boxes), max(box.stiffness.size for box in boxes)
    wider: list[ModalBody] = []
    for box in boxes:  # a mode without shape stays at rest
        pad = (0, most - box.stiffness.size)
        wider.append(
            box._replace(
                shape=np.pad(box.shape, [(0, 0), (0, 0), pad]),
                monitor_shape=np.pad(box.monitor_shape, [(0, 0), (0, 0), pad]),
                stiffness=np.pad(box.stiffness, pad, constant_values=1.0),
                damping=np.pad(box.damping, pad),
            )
        )
    downwards = wider[::-1]
    ends = np.cumsum([0, *(len(box.monitor) for box in downwards)])
    each: Any = {
        name: np.array([getattr(box, name) for box in wider])
        for name in ("mass", "inertia", "point", "shape", "rest", "stiffness", "damping")
    }
    together = ModalBody(
        **each,
        gravity=boxes[0].gravity,
        downhill=boxes[0].downhill,
        across=by_modes(each["shape"]),
        monitor=np.concatenate([box.monitor for box in downwards]),
        monitor_shape=np.concatenate([box.monitor_shape for box in downwards]),
        tolerance=min(box.tolerance for box in boxes),
        cached_step=np.tile(np.append(np.full(STEP_SLOTS, -1.0), 0.0), (n, 1)),
        recent=np.zeros((n, 1), dtype=np.int64),
        inverse=np.zeros((n, STEP_SLOTS, 3 + most)),
        elastic_compliance=np.zeros((n, STEP_SLOTS, 2 * CORNERS, 2 * CORNERS)),
        arm=np.zeros((n, CORNERS, 2)),
        moved=np.zeros((n, 3, 2 * CORNERS)),
        free_change=np.zeros((n, 3 + most)),
    )
    body = StackBody(
        boxes=together,
        starts=(3 + most) * np.arange(n + 1),
        monitors=np.column_stack([ends[:-1], ends[1:]])[::-1].copy(),
        energy=np.zeros((n, 3)),
    )
    corner = (together.rest[:, None] + together.point).reshape(-1, 2)
    return LooseStack(
        body=body,
        faces=make_faces(corner, normal_stiffness, tangential_stiffness, held)
        if row is None
        else make_row(corner, *row, normal_stiffness, tangential_stiffness, held),
        mass=each["mass"],
        tolerance=together.tolerance,
        in_a_row=row is not None,
        corners=make_workspace(CORNERS * n),
    )


def stack_with_own_scratch(stack: LooseStack) -> LooseStack:
    """The same stack, of boxes in floating frames, with scratch arrays of its own."""
    body, faces = stack.body, stack.faces
    return stack._replace(
        body=body._replace(boxes=own_scratch(body.boxes), energy=np.empty_like(body.energy)),
        faces=faces._replace(
            weight=np.ones_like(faces.weight),
            placed=np.empty_like(faces.placed),
            gradient=faces.gradient.copy(),
            moved=np.empty_like(faces.moved),
        ),
        corners=make_workspace(CORNERS * len(body.energy)),
    )


def box_of(stack: Any, b: int) -> Any:
    """One of the boxes of a stack, a body of its own; of a `StackBody` it is `modal_box`."""
    return stack.boxes[b]


@implements(box_of, StackBody, inline=True)
def modal_box(stack: StackBody, b: int) -> ModalBody:
    """One of the boxes."""
    begin, end = stack.monitors[b, 0], stack.monitors[b, 1]
    boxes = stack.boxes
    return one_box(
        boxes,
        b,
        gravity=boxes.gravity,
        downhill=boxes.downhill,
        tolerance=boxes.tolerance,
        monitor=boxes.monitor[begin:end],
        monitor_shape=boxes.monitor_shape[begin:end],
    )


@inlined
def state_of(stack: LooseStack, state: State, b: int) -> State:
    """What a state holds of one of the boxes; its points are the corners, with the forces that these have now."""
    boxes, k, m = stack.body, CORNERS * b, CORNERS * (b + 1)
    i, j, begin, end = boxes.starts[b], boxes.starts[b + 1], boxes.monitors[b, 0], boxes.monitors[b, 1]
    return state_of_box(
        state,
        position=state.position[i:j],
        velocity=state.velocity[i:j],
        acceleration=state.acceleration[i:j],
        jerk=state.jerk[i:j],
        internal=state.internal[i:j],
        damping=state.damping[i:j],
        external=state.external[i:j],
        point=state.corner[k:m],
        force=stack.corners.force[k:m],
        pose=state.boxes[b],
        energy=boxes.energy[b],
        monitor=state.monitor[begin:end],
    )


@inlined
def work_of(corners: Workspace, b: int) -> Workspace:
    """What the workspace of all corners holds of one of the boxes."""
    k, m = CORNERS * b, CORNERS * (b + 1)
    return work_of_box(
        corners,
        free=corners.free[k:m],
        free_velocity=corners.free_velocity[k:m],
        compliance=corners.compliance[2 * k : 2 * m, 2 * k : 2 * m],
        point=corners.point[k:m],
        velocity=corners.velocity[k:m],
        force=corners.force[k:m],
    )


@implements(interface.weigh, LooseStack, inline=True)
def weigh(stack: LooseStack, contact: Contact, old: State) -> None:
    """Stiffness of the contact points: less where a corner is about to leave its face."""
    weigh_points(stack.faces, old.corner, old.point, contact)


@implements(interface.predict, LooseStack, inline=True)
def predict(stack: LooseStack, scheme: Scheme, step: float, old: State, new: State) -> None:
    """Coordinates after `step`, with derivatives at the old corners: those of an attempt a resumed run has not."""
    for b in range(stack.mass.size):
        own, after = state_of(stack, old, b), state_of(stack, new, b)
        interface.predict(box_of(stack.body, b), scheme, step, own, after)
    linearise_points(stack.faces, old.corner, stack.faces.placed)


@implements(interface.release, LooseStack, inline=True)
def release(
    stack: LooseStack, scheme: Scheme, step: float, old: State, new: State, work: Workspace, ground: Ground
) -> None:
    """Contact points at the end of the step without contact force, and their compliance.

    Linearised about the corners under the present forces, not about the free ones: at the last iteration these are
    the forces that are found.
    """
    corners = stack.corners
    for b in range(stack.mass.size):
        own, after = state_of(stack, old, b), state_of(stack, new, b)
        interface.release(box_of(stack.body, b), scheme, step, own, after, work_of(corners, b), ground)
    share_forces(stack.faces, work.force, corners.force)
    move_corners(corners)
    linearise_points(stack.faces, corners.point, work.free)
    condense_points(stack.faces, corners, work)


@implements(interface.respond, LooseStack, inline=True)
def respond(stack: LooseStack, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
    """Apply `work.force` to the iterate; returns the remaining error over its tolerance."""
    corners, error = stack.corners, 0.0
    share_forces(stack.faces, work.force, corners.force)
    for b in range(stack.mass.size):
        own, after = state_of(stack, old, b), state_of(stack, new, b)
        left = interface.respond(box_of(stack.body, b), scheme, step, own, after, work_of(corners, b))
        error = max(error, left)
    move_corners(corners)
    place_points(stack.faces, corners.point, work.trial)
    for i in range(work.trial.shape[0]):
        if is_of_one_box(stack.faces, i) or stack.faces.weight[i] == 0.0:
            continue
        apart = stack.in_a_row and work.trial[i, 1] > 0.0 and work.point[i, 1] > 0.0
        if not apart:  # the sides of a row are seldom where it matters how far they are from each other
            for k in range(2):
                error = max(error, abs(work.trial[i, k] - work.point[i, k]) / stack.tolerance)
    return error


@implements(interface.complete, LooseStack, inline=True)
def complete(stack: LooseStack, new: State, floor: float, lift: float, lift_velocity: float) -> None:
    """Internal forces, contact points, poses and energy at the converged coordinates."""
    share_forces(stack.faces, new.force, stack.corners.force)
    for row in range(new.energy.size):
        new.energy[row] = 0.0
    for b in range(stack.mass.size):
        interface.complete(box_of(stack.body, b), state_of(stack, new, b), floor, lift, lift_velocity)
        for row in range(new.energy.size):
            new.energy[row] += stack.body.energy[b, row]
    place_points(stack.faces, new.corner, new.point)
    for i in range(stack.faces.weight.size):
        if stack.faces.weight[i] == 0.0:
            new.point[i, 1] = stack.faces.length[i]
    total = 0.0
    for row in range(6):
        new.pose[row] = 0.0
    for b in range(stack.mass.size):
        total += stack.mass[b]
    for b in range(stack.mass.size):
        for row in (interface.CENTRE_X, interface.CENTRE_Z, interface.VELOCITY_X, interface.VELOCITY_Z):
            new.pose[row] += stack.mass[b] / total * new.boxes[b, row]
    new.pose[interface.ROTATION] = new.boxes[0, interface.ROTATION]
    new.pose[interface.ANGULAR_VELOCITY] = new.boxes[0, interface.ANGULAR_VELOCITY]


@implements(interface.observe, LooseStack, inline=True)
def observe(stack: LooseStack, state: State, floor: float, lift: float) -> None:
    """Displacement and velocity of the monitored points."""
    for b in range(stack.mass.size):
        interface.observe(box_of(stack.body, b), state_of(stack, state, b), floor, lift)


@implements(interface.shift_velocity, LooseStack, inline=True)
def shift_velocity(stack: LooseStack, state: State, frame: Frame, boxes: Boxes) -> None:
    """Subtract the velocities of a frame."""
    for b in range(*boxes):
        interface.shift_velocity(box_of(stack.body, b), state_of(stack, state, b), frame, (b, b + 1))


@implements(interface.prepared, LooseStack, inline=True)
def prepared(stack: LooseStack, step: float) -> bool:
    """Whether all boxes can take a step of this size."""
    ready = True
    for b in range(stack.mass.size):
        ready = ready and interface.prepared(box_of(stack.body, b), step)
    return ready


def stand(
    contact: Contact, state: State, faces: Faces, centre: FloatArray, point: FloatArray, **given: FloatArray
) -> StackedStances:
    """`contact.interface.equilibrium.stacked`; writes the stiffness of the points, and their forces and springs."""
    weigh_points(faces, (centre[:, None] + point).reshape(-1, 2), state.point, contact)
    rest = stacked(faces=faces, centre=centre, point=point, **given)
    state.force[:] = rest.force
    if contact.friction == ELASTIC_STICK:  # friction regularised in velocity has no springs
        state.stick[:] = -rest.force[:, 0] / np.maximum(contact.tangential_stiffness, 1e-300)
    return rest


def settle_stack(
    stack: LooseStack,
    contact: Contact,
    state: State,
    *,
    gravity: float,
    place: tuple[float, float] = (0.0, 0.0),
    velocity: tuple[float, float] = (0.0, 0.0),
    lift_velocity: float = 0.0,
) -> None:
    """Write the initial state of a stack at rest on its floor, and moving; the stiffness in `contact`, too.

    Args:
        gravity: toward the floor, with the acceleration of the floor upward [m/s2].
        place: of the floor, along x and upward [m]; lift_velocity: of it, upward [m/s].
        velocity: of the stack, absolute [m/s].

    Raises:
        SettlingError: the stack does not stand.
    """
    body, modes = stack.body.boxes, stack.body.modes
    n, size = len(body.mass), 3 + modes
    flat = body.shape.reshape(n, 2 * CORNERS, modes)
    rest = stand(
        contact,
        state,
        faces=stack.faces,
        centre=body.rest,
        point=body.point,
        compliance=np.einsum("bim,bm,bjm->bij", flat, 1.0 / body.stiffness, flat),
        load=body.mass[:, None] * np.array([body.downhill, -gravity]),
    )
    coordinates, rates = state.position.reshape(n, size), state.velocity.reshape(n, size)
    coordinates[:, :2], coordinates[:, 2] = rest.centre + place, rest.rotation
    cosine, sine = np.cos(rest.rotation), np.sin(rest.rotation)
    turn = np.moveaxis(np.array([[cosine, sine], [-sine, cosine]]), -1, 0)
    own = rest.corner_force.reshape(n, CORNERS, 2) @ turn  # in the frames of the boxes
    coordinates[:, 3:] = np.einsum("bi,bim->bm", own.reshape(n, -1), flat) / body.stiffness
    rates[:] = 0.0
    rates[:, :2] = velocity
    start_stack(stack, state, place=place, lift_velocity=lift_velocity)


def start_stack(stack: LooseStack, state: State, *, place: tuple[float, float], lift_velocity: float) -> None:
    """Complete an initial state from its coordinates, their rates and the contact forces, with the acceleration."""
    body, modes = stack.body.boxes, stack.body.modes
    n, size = len(body.mass), 3 + modes
    flat = body.shape.reshape(n, 2 * CORNERS, modes)
    coordinates = state.position.reshape(n, size)
    complete_compiled(stack, state, place[0], place[1], lift_velocity)
    masses = np.ones((n, size))
    masses[:, :2], masses[:, 2] = body.mass[:, None], body.inertia
    external = np.zeros((n, size))
    corner = state.corner.reshape(n, CORNERS, 2) + np.array(place) - coordinates[:, None, :2]
    forces = stack.corners.force.reshape(n, CORNERS, 2)
    cosine, sine = np.cos(coordinates[:, 2]), np.sin(coordinates[:, 2])
    turn = np.moveaxis(np.array([[cosine, sine], [-sine, cosine]]), -1, 0)
    external[:, :2] = forces.sum(axis=1)
    external[:, 2] = (corner[..., 1] * forces[..., 0] - corner[..., 0] * forces[..., 1]).sum(axis=1)
    external[:, 3:] = np.einsum("bi,bim->bm", (forces @ turn).reshape(n, -1), flat)
    state.external[:] = external.ravel()
    state.acceleration[:] = ((external - state.internal.reshape(n, size)) / masses).ravel()


@compiled
def complete_compiled(
    stack: LooseStack, state: State, floor: float, lift: float, lift_velocity: float
) -> None:
    """Linearise the contact at the corners of the state, and complete it."""
    interface.complete(stack, state, floor, lift, lift_velocity)
    linearise_points(stack.faces, state.corner, stack.faces.placed)
    interface.complete(stack, state, floor, lift, lift_velocity)
