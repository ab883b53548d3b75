"""The boxes of a loose stack in floating frames: for each the kernels of a `ModalBody`.

Coordinates are those of the boxes in turn, from the floor up: 3 + m for each, with as many modes m for every box.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.interface.contact_points import SidePoint, make_faces, make_row
from contact.interface.equilibrium import StackedStances, stacked
from contact.interface.faces import CORNERS, Faces, linearise_points, weigh_points
from contact.interface.laws import ELASTIC_STICK
from contact.interface.workspace import Contact, Workspace, make_workspace
from contact.jit import compiled, inlined
from contact.layout import exchanging, row_of, shapes_of
from contact.stepping import body as interface
from contact.stepping import modal_kernels  # noqa: F401 - registers the operations of a modal body
from contact.stepping.body import Boxes, Frame, Ground, State, implements
from contact.stepping.loose_stack import LooseStack
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
    # A mode without shape stays at rest.
    wider = [(0, most - box.stiffness.size) for box in boxes]
    downwards = list(zip(boxes, wider, strict=True))[::-1]
    ends = np.cumsum([0, *(len(box.monitor) for box, _ in downwards)])
    shape = np.array(
        [np.pad(box.shape, [(0, 0), (0, 0), pad]) for box, pad in zip(boxes, wider, strict=True)]
    )
    mass: Any = np.array([box.mass for box in boxes])
    inertia: Any = np.array([box.inertia for box in boxes])
    together = ModalBody(
        mass=mass,
        inertia=inertia,
        gravity=boxes[0].gravity,
        downhill=boxes[0].downhill,
        point=np.array([box.point for box in boxes]),
        shape=shape,
        across=by_modes(shape),
        rest=np.array([box.rest for box in boxes]),
        monitor=np.concatenate([box.monitor for box, _ in downwards]),
        monitor_shape=np.concatenate(
            [np.pad(box.monitor_shape, [(0, 0), (0, 0), pad]) for box, pad in downwards]
        ),
        stiffness=np.array(
            [np.pad(box.stiffness, pad, constant_values=1.0) for box, pad in zip(boxes, wider, strict=True)]
        ),
        damping=np.array([np.pad(box.damping, pad) for box, pad in zip(boxes, wider, strict=True)]),
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
        mass=mass,
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
def state_of(stack: Any, state: State, b: int) -> State:
    """What a state holds of one of the boxes; its points are the corners."""
    i, j, k, m = stack.starts[b], stack.starts[b + 1], CORNERS * b, CORNERS * (b + 1)
    begin, end = stack.monitors[b, 0], stack.monitors[b, 1]
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
        force=state.force[k:m],
        pose=state.boxes[b],
        energy=stack.energy[b],
        monitor=state.monitor[begin:end],
    )


@inlined
def work_of(work: Workspace, b: int) -> Workspace:
    """What the workspace of all corners holds of one of the boxes."""
    k, m = CORNERS * b, CORNERS * (b + 1)
    return work_of_box(
        work,
        free=work.free[k:m],
        free_velocity=work.free_velocity[k:m],
        compliance=work.compliance[2 * k : 2 * m, 2 * k : 2 * m],
        point=work.point[k:m],
        velocity=work.velocity[k:m],
        force=work.force[k:m],
    )


@implements(interface.predict, StackBody, inline=True)
def predict(stack: Any, scheme: Scheme, step: float, old: State, new: State) -> None:
    """Coordinates after `step`, for the last acceleration."""
    for b in range(stack.energy.shape[0]):
        interface.predict(box_of(stack, b), scheme, step, state_of(stack, old, b), state_of(stack, new, b))


@implements(interface.release, StackBody, inline=True)
def release(
    stack: Any, scheme: Scheme, step: float, old: State, new: State, work: Workspace, ground: Ground
) -> None:
    """Corners at the end of the step without contact force, and their compliance."""
    for b in range(stack.energy.shape[0]):
        interface.release(
            box_of(stack, b),
            scheme,
            step,
            state_of(stack, old, b),
            state_of(stack, new, b),
            work_of(work, b),
            ground,
        )


@implements(interface.respond, StackBody, inline=True)
def respond(stack: Any, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
    """Apply the forces on the corners to the iterate; returns the remaining error over its tolerance."""
    largest = 0.0
    for b in range(stack.energy.shape[0]):
        error = interface.respond(
            box_of(stack, b), scheme, step, state_of(stack, old, b), state_of(stack, new, b), work_of(work, b)
        )
        largest = max(largest, error)
    return largest


@implements(interface.complete, StackBody, inline=True)
def complete(stack: Any, new: State, floor: float, lift: float, lift_velocity: float) -> None:
    """Internal forces, corners, poses and energy at the converged coordinates."""
    for row in range(new.energy.size):
        new.energy[row] = 0.0
    for b in range(stack.energy.shape[0]):
        interface.complete(box_of(stack, b), state_of(stack, new, b), floor, lift, lift_velocity)
        for row in range(new.energy.size):
            new.energy[row] += stack.energy[b, row]


@implements(interface.observe, StackBody, inline=True)
def observe(stack: Any, state: State, floor: float, lift: float) -> None:
    """Displacement and velocity of the monitored points."""
    for b in range(stack.energy.shape[0]):
        interface.observe(box_of(stack, b), state_of(stack, state, b), floor, lift)


@implements(interface.shift_velocity, StackBody, inline=True)
def shift_velocity(stack: Any, state: State, frame: Frame, boxes: Boxes) -> None:
    """Subtract the velocities of a frame."""
    for b in range(*boxes):
        interface.shift_velocity(box_of(stack, b), state_of(stack, state, b), frame, (b, b + 1))


@implements(interface.prepared, StackBody, inline=True)
def prepared(stack: StackBody, step: float) -> bool:
    """Boxes in floating frames can take a step of any size."""
    return True


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
