"""The interface between the time stepping and a body.

A body has coordinates, whose number and meaning only the body knows, and base points that may touch the floor. The
stepping calls the functions of this module: `weigh`, `predict`, `release`, `respond`, `complete`, `observe`,
`shift_velocity` and `prepared`. In compiled code they are those of `contact.stepping.modal_body` (a
floating frame with elastic modes), of `fem.solid.nodal_kernels` (the nodes of a mesh) or of
`contact.stepping.loose_stack` (boxes that stand on one another), see `implements`. In Python they call the method of
the body with the same name.
"""

import math
from collections.abc import Callable
from typing import Annotated, Any, NamedTuple, TypeVar

import numpy as np
from numba.extending import overload

from contact.arrays import FloatArray
from contact.interface.workspace import Contact, Workspace
from contact.jit import options_of_piece
from contact.layout import shapes_of
from contact.stepping.scheme import Scheme
from contact.structs import struct

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

#: rows of `State.pose`
ROTATION, ANGULAR_VELOCITY, CENTRE_X, CENTRE_Z, VELOCITY_X, VELOCITY_Z = 0, 1, 2, 3, 4, 5
#: rows of `State.energy`
KINETIC, STRAIN, POTENTIAL = 0, 1, 2


@struct
class State(NamedTuple):
    """Everything that moves, at one instant; d coordinates, n base points, k monitored points, N boxes."""

    position: Annotated[FloatArray, "d"]  #: coordinates of the body
    velocity: Annotated[FloatArray, "d"]
    acceleration: Annotated[FloatArray, "d"]  #: of the scheme; it lags by (alpha_f - alpha_m) times the step
    jerk: Annotated[FloatArray, "d"]  #: change of the acceleration over the last step, per second
    internal: Annotated[FloatArray, "d"]  #: internal forces with gravity and damping
    damping: Annotated[FloatArray, "d"]  #: material damping only
    external: Annotated[FloatArray, "d"]  #: contact forces
    #: base points over the floor, indented where it has been crushed [m]
    point: Annotated[FloatArray, "n", 2]
    force: Annotated[FloatArray, "n", 2]  #: contact forces on the container, tangential and normal [N]
    descent: Annotated[FloatArray, "n", 2]  #: downward velocity of the base points [m/s] and its rate [m/s2]
    #: tangential velocity of the base points over the floor and its rate
    drift: Annotated[FloatArray, "n", 2]
    stick: Annotated[FloatArray, "n"]  #: elongation of the stuck tangential springs [m]
    #: permanent indentation; a base point is above the floor by its height and this [m]
    crushed: Annotated[FloatArray, "n"]
    #: best-fit rotation, its rate, mass centre and its velocity (absolute); of a loose stack the rotation is the lowest
    #: box's
    pose: Annotated[FloatArray, 6]
    #: kinetic, strain, gravity potential [J], of positions and vertical velocities relative to the floor
    energy: Annotated[FloatArray, 3]
    #: poses of the boxes of a loose stack, from the floor up; none for one body
    boxes: Annotated[FloatArray, "N", 6]
    corner: Annotated[FloatArray, "4N", 2]  #: corners of its boxes relative to the floor [m]
    monitor: FloatArray  #: (k, 4) monitored points: displacement relative to the floor [m], velocity [m/s]
    numbers: FloatArray  #: all but the monitored points; the fields above are views of it


#: velocities of a frame: at x = z = 0 along x and upward [m/s], and its angular velocity [rad/s]
Frame = tuple[float, float, float]
Boxes = tuple[int, int]  #: the first of some boxes, and the one behind their last


class Ground(NamedTuple):
    """The floor at one instant: displacement [m] and velocity [m/s], along x and upward."""

    floor: float
    floor_velocity: float
    lift: float
    lift_velocity: float


def make_state(coordinates: int, points: int, monitors: int, boxes: int = 0) -> State:
    """Allocate a state for these numbers of coordinates, base points, monitored points and boxes of a loose stack."""
    shapes = shapes_of(State, **{"d": coordinates, "n": points, "N": boxes, "4N": 4 * boxes})
    numbers, fields, begin = np.zeros(sum(map(math.prod, shapes.values()))), {}, 0
    for name, shape in shapes.items():
        fields[name] = numbers[begin : begin + math.prod(shape)].reshape(shape)
        begin += math.prod(shape)
    return State(**fields, monitor=np.zeros((monitors, 4)), numbers=numbers)


def implements(
    operation: Callable[..., Any], *bodies: type, inline: bool = False
) -> Callable[[Kernel], Kernel]:
    """Decorator: compiled callers of `operation` use this function for bodies of these classes."""

    def register(implementation: Kernel) -> Kernel:
        def choose(body: Any, *arguments: Any) -> Kernel | None:
            return implementation if getattr(body, "instance_class", None) in bodies else None

        overload(operation, strict=False, jit_options=options_of_piece(inline))(choose)
        return implementation

    return register


def weigh(body: Any, contact: Contact, old: State) -> None:
    """Set the stiffness of the contact points for a step that begins with `old`."""
    body.weigh(contact, old)


def predict(body: Any, scheme: Scheme, step: float, old: State, new: State) -> None:
    """Write to `new` the coordinates after `step` [s] that follow from the old acceleration."""
    body.predict(scheme, step, old, new)


def release(
    body: Any, scheme: Scheme, step: float, old: State, new: State, work: Workspace, ground: Ground
) -> None:
    """Write the base points without contact force, and their compliance, from the iterate in `new`, to `work`."""
    body.release(scheme, step, old, new, work, ground)


def respond(body: Any, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
    """Move the iterate in `new` under `work.force`; returns the remaining error over its tolerance."""
    return float(body.respond(scheme, step, old, new, work))


def complete(body: Any, new: State, floor: float, lift: float, lift_velocity: float) -> None:
    """Compute internal forces, base points, pose and energy from the converged coordinates."""
    body.complete(new, floor, lift, lift_velocity)


def observe(body: Any, state: State, floor: float, lift: float) -> None:
    """Compute displacement and velocity of the monitored points; called for samples only."""
    body.observe(state, floor, lift)


def shift_velocity(body: Any, state: State, frame: Frame, boxes: Boxes) -> None:
    """Subtract the velocities of a frame from all that moves; of a loose stack or a row, from some boxes."""
    body.shift_velocity(state, frame, boxes)


def prepared(body: Any, step: float) -> bool:
    """Whether the body can take a step of this size [s]; if not, the caller prepares it and continues."""
    return bool(body.prepared(step))


def stands_loose(body: Any) -> bool | None:
    """True for a loose stack; None for a body that moves as one: what is not for None is not compiled for it."""
    return True if hasattr(body, "faces") or hasattr(getattr(body, "body", None), "faces") else None


@overload(stands_loose, strict=False, jit_options=options_of_piece(True))
def _stands_loose(body: Any) -> Callable[[Any], bool | None] | None:
    fields = getattr(body, "fields", ())
    if "line" in fields:  # of a body with links, see there
        return None
    return (lambda body: True) if "faces" in fields else (lambda body: None)
