"""Runs for the verification ladder: a homogeneous block on two corners, changed key by key.

Everything goes the way of a user's run - case, mesh, model, stepping, audit - but for what the case file cannot
say: a container above the floor, a floor with a motion of its own, steps of one size.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact.interface.equilibrium import Stance
from contact.motion.kernel import FloorMotion, floor_motion
from contact.reference.rigid_block import RigidBlock
from contact.stepping import modal_body
from contact.stepping.body import State
from fem.assessment.verdict import outcome_of
from fem.case.case import Case, read_case
from fem.model.container import Container
from fem.model.model import Model, build_model
from fem.results.history import History
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.solid.nodal_body import FullBody

GRAVITY = 9.81

#: The homogeneous stack: 1.1 x 4.0 m, 10 t, on two corners; rigid, no fields.
STACK = read_case(
    """
    schema = 1
    gravity_m_s2 = 9.81
    [container]
    width_m = 1.1
    height_m = 4.0
    depth_m = 1.1
    weight_N = 98100.0
    [contact]
    mu_static = 1.0
    [motion]
    kind = "none"
    [solver]
    model = "rigid"
    order = 1
    element_size_m = 1.0
    [output]
    history_s = 0.005
    fields_s = 0.0
    """,
    name="stack",
)
BOX = STACK.with_values({"container.height_m": 1.0, "container.weight_N": 24525.0})
#: what makes the stack an elastic solid with 20 modes
SOLID = {"solver.model": "reduced", "solver.order": 2, "solver.element_size_m": 0.2}


class RunFailedError(ArithmeticError):
    """A run of the ladder did not reach its end."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Finished:
    """A run that came to its end."""

    model: Model
    history: History
    status: str  #: completed | overturned

    @property
    def track(self) -> Any:
        """What the run is judged by, see `contact.stepping.observables.OBSERVABLES`."""
        return self.model.run.track[0]

    @property
    def outcome(self) -> str:
        """rest | slide | rock | slide-rock | overturned."""
        return outcome_of(self.model)

    @property
    def block(self) -> RigidBlock:
        """The rigid block of the same mass, for the references."""
        return rigid_block(self.model)


def run(case: Case, values: Mapping[str, Any] | None = None, container: Container | None = None) -> Finished:
    """Compute a case with some keys changed.

    Raises:
        RunFailedError: the run failed or its ledger did not stand.
    """
    return finish(build_model(case.with_values(values) if values else case, container))


def finish(model: Model) -> Finished:
    """Step a model to its end.

    Raises:
        RunFailedError: as for `run`.
    """
    recorder = Recorder(model)
    ending = simulate(model, recorder)
    if ending.error is not None:
        raise RunFailedError(ending.error)
    return Finished(model=model, history=recorder.history(), status=ending.status)


def rigid_block(model: Model) -> RigidBlock:
    """The analytic block with the mass, centroid and inertia of the model's mesh."""
    mesh = model.container.mesh
    half, height = 0.5 * mesh.width, mesh.centroid[1]
    square = half**2 + height**2
    return RigidBlock(
        half_width=half,
        centroid_height=height,
        gravity=model.case.gravity_m_s2,
        inertia_ratio=1.0 + mesh.inertia / (mesh.mass * square),
    )


def with_steps_of(model: Model, step: float) -> Model:
    """The model with every step of one size [s], whatever its ledger says."""
    loose = model.run.control._replace(
        largest_step=step,
        smallest_step=step,
        event_step=step,
        closing_step=step,
        energy_rate=1e30,
    )
    return replace(model, run=model.run._replace(control=loose))


def with_motion(model: Model, motion: FloorMotion, breaks: tuple[float, ...] = ()) -> Model:
    """The model on another floor, with which the container moves at t = 0.

    `breaks` are the instants at which the floor's acceleration jumps [s].
    """
    state = model.run.old
    before, speed_before, _ = model.run.floor[0]
    floor, speed, acceleration = floor_motion(motion, 0.0)
    along = slice(None, None, 2) if isinstance(model.body, FullBody) else slice(0, 1)
    state.position[along] += floor - before
    state.velocity[along] += speed - speed_before
    model.run.floor[:] = floor, speed, acceleration
    _start(model, state, floor)
    ends = np.array([*breaks, model.case.solver.duration_s, np.inf])
    return replace(model, run=model.run._replace(motion=motion, breaks=ends))


def lifted(model: Model, height: float, speed: float = 0.0) -> Model:
    """The model with its container `height` [m] above the floor, unstrained, falling at `speed` [m/s]."""
    state, body, mesh = model.run.old, model.body, model.container.mesh
    stance = Stance(
        centre=(mesh.centroid[0], mesh.centroid[1] + height),
        rotation=0.0,
        velocity=(0.0, -speed),
        angular_velocity=0.0,
        force=np.zeros_like(state.force),
    )
    state.force[:] = 0.0
    state.stick[:] = 0.0
    if isinstance(body, FullBody):
        body.place(state, stance, model.container.response, 0.0)
    else:
        modal_body.place(body, state, stance, 0.0)
    _start(model, state, float(model.run.floor[0, 0]))
    return model


def _start(model: Model, state: State, floor: float) -> None:
    """Everything that follows from the coordinates, and the acceleration that goes with them."""
    if isinstance(model.body, FullBody):
        model.body.start(state, floor)
    else:
        modal_body.start(model.body, state, floor)
