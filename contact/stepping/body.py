"""What the stepper needs of a body, and no more.

A body has coordinates (their number and meaning are its own affair), base points that may touch the floor, and
some operations, each a function here that hands over to the body: `predict`, `release`, `respond`, `complete`,
`observe`, `shift_velocity`, and the two questions `prepared` and `sizes_match`. `contact.stepping.modal_body`
compiles them for a
floating frame with elastic modes, `fem.solid.nodal_kernels` for the nodes of a mesh; called by the interpreter they
are methods of the body. The stepper is written once, against these functions.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba.extending import overload

from contact.arrays import FloatArray
from contact.interface.solver import Workspace
from contact.stepping.scheme import Scheme

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

#: rows of `State.pose`
ROTATION, ANGULAR_VELOCITY, CENTRE_X, CENTRE_Z, VELOCITY_X, VELOCITY_Z = 0, 1, 2, 3, 4, 5
#: rows of `State.energy`
KINETIC, STRAIN, POTENTIAL = 0, 1, 2


class State(NamedTuple):
    """Everything that moves, at one instant; n_d coordinates, n base points."""

    position: FloatArray  #: (n_d,) coordinates of the body
    velocity: FloatArray  #: (n_d,)
    acceleration: FloatArray  #: (n_d,) of the scheme: it lags by (alpha_f - alpha_m) times the step
    jerk: FloatArray  #: (n_d,) its change over the last step, per second
    internal: FloatArray  #: (n_d,) internal forces with gravity and damping
    damping: FloatArray  #: (n_d,) of these the material damping
    external: FloatArray  #: (n_d,) contact forces
    point: FloatArray  #: (n, 2) base points relative to the floor [m]
    force: FloatArray  #: (n, 2) contact forces on the container, tangential and normal [N]
    descent: FloatArray  #: (n, 2) downward velocity of the base points [m/s] and its rate [m/s2]
    stick: FloatArray  #: (n,) elongation of the stuck tangential springs [m]
    pose: FloatArray  #: (6,) best-fit rotation, its rate, mass centre and its velocity (absolute)
    energy: FloatArray  #: (3,) kinetic, strain, gravity potential [J]
    monitor: FloatArray  #: (n_m, 4) monitored points: displacement relative to the floor [m], velocity [m/s]
    numbers: FloatArray  #: all of it but the monitored points: the other fields look into it


def make_state(coordinates: int, points: int, monitors: int) -> State:
    """Allocate a state of so many coordinates, base points and monitored points."""
    vector, pairs = (coordinates,), (points, 2)
    shapes = {
        "position": vector,
        "velocity": vector,
        "acceleration": vector,
        "jerk": vector,
        "internal": vector,
        "damping": vector,
        "external": vector,
        "point": pairs,
        "force": pairs,
        "descent": pairs,
        "stick": (points,),
        "pose": (6,),
        "energy": (3,),
    }
    numbers = np.zeros(sum(math.prod(shape) for shape in shapes.values()))
    fields, begin = {}, 0
    for name, shape in shapes.items():
        end = begin + math.prod(shape)
        fields[name], begin = numbers[begin:end].reshape(shape), end
    return State(**fields, monitor=np.zeros((monitors, 4)), numbers=numbers)


def implements(
    operation: Callable[..., Any], *bodies: type, inline: bool = False
) -> Callable[[Kernel], Kernel]:
    """Decorator: compiled callers of `operation` use this function when the body is of one of these classes.

    `inline` asks LLVM to put it into its callers, as in `contact.jit.compiled`.
    """

    def register(implementation: Kernel) -> Kernel:
        def choose(body: Any, *arguments: Any) -> Kernel | None:
            return implementation if getattr(body, "instance_class", None) in bodies else None

        overload(operation, strict=False, jit_options={"forceinline": inline})(choose)
        return implementation

    return register


def predict(body: Any, scheme: Scheme, step: float, old: State, new: State) -> None:
    """Write into `new` the coordinates that the old acceleration leads to after `step` [s]."""
    body.predict(scheme, step, old, new)


def release(
    body: Any,
    scheme: Scheme,
    step: float,
    old: State,
    new: State,
    work: Workspace,
    floor: float,
    floor_velocity: float,
) -> None:
    """From the iterate in `new`, where the base points would go without contact force, and the compliance.

    Writes `work.free`, `work.free_velocity` (relative to the floor) and `work.compliance`.
    """
    body.release(scheme, step, old, new, work, floor, floor_velocity)


def respond(body: Any, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
    """Move the iterate in `new` under `work.force`; returns the remaining error over its tolerance."""
    return float(body.respond(scheme, step, old, new, work))


def complete(body: Any, new: State, floor: float) -> None:
    """Fill in what follows from the converged coordinates: internal forces, base points, pose, energy."""
    body.complete(new, floor)


def observe(body: Any, state: State, floor: float) -> None:
    """Fill in displacement and velocity of the monitored points; asked for at samples only."""
    body.observe(state, floor)


def shift_velocity(body: Any, state: State, velocity: float) -> None:
    """Take the velocity of a new frame along x off that of every coordinate."""
    body.shift_velocity(state, velocity)


def prepared(body: Any, step: float) -> bool:
    """The body can take a step of this size [s]; false asks whoever steps it to make what it needs, and to go on."""
    return bool(body.prepared(step))


def sizes_match(body: Any, run: Any) -> bool:
    """The arrays of the run have the sizes that the body was compiled for; true where it takes any."""
    return True
