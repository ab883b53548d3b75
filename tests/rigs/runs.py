"""Runs for the verification checks: a homogeneous block on two corners, with keys changed.

They take the way of a user's run (case, mesh, model, stepping, audit), except for what a case file cannot express:
a container above the floor, a floor with any motion, steps of one size.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact.interface.equilibrium import Stance
from contact.motion.kernel import FloorMotion, floor_motion
from contact.reference.rigid_block import RigidBlock
from contact.stepping import modal_body
from contact.stepping.modal_body import ModalBody
from fem.case.case import Case, case_from
from fem.model.container import Container
from fem.model.model import Model, build_model
from fem.results.history import History
from fem.run.recorder import Recorder
from fem.run.rigid_check import block_of
from fem.run.simulation import simulate
from fem.run.verdict import outcome_of
from fem.runtime.arrays import FloatArray

GRAVITY = 9.81
Keys = dict[str, Any]  #: dotted keys of a case and their values

#: The homogeneous stack: 1.1 x 4.0 m, 10 t, on two corners; rigid, no fields.
STACK = case_from(
    {
        "gravity_m_s2": GRAVITY,
        "container": {"width_m": 1.1, "height_m": 4.0, "depth_m": 1.1, "weight_N": 98100.0},
        "contact": {"mu_static": 1.0},
        "motion": {"kind": "none"},
        "solver": {"model": "rigid", "order": 1, "element_size_m": 1.0},
        "output": {"history_s": 0.005, "fields_s": 0.0},
    }
)
SLENDERNESS = math.atan2(1.1, 4.0)  #: of the stack [rad]
BLOCK = RigidBlock.homogeneous(width=1.1, height=4.0)  #: the stack as an analytic reference
TILTED: Keys = {"initial.rotation_rad": 0.5 * SLENDERNESS}
BOX = STACK.with_values({"container.height_m": 1.0, "container.weight_N": 24525.0})
#: makes the stack an elastic solid with 20 modes
SOLID: Keys = {"solver.model": "reduced", "solver.order": 2, "solver.element_size_m": 0.2}
STACKS: dict[str, Keys] = {"rigid stack": {}, "solid stack, 20 modes": SOLID}
#: stiff enough on its floor to count as rigid: f1/f_c = 16
STIFF_SOLID = SOLID | {"container.youngs_modulus_Pa": 2.1e12}
#: of the paper
FRICTION: Keys = {"contact.mu_static": 0.4, "contact.mu_kinetic": 0.2}


def harmonic(amplitude: float, omega: float) -> Keys:
    """Keys of a floor A sin(Omega t), in m and rad/s."""
    return {
        "motion.kind": "harmonic",
        "motion.amplitude_m": amplitude,
        "motion.angular_frequency_rad_s": omega,
    }


def pulse(peak: float, length: float, shape: str = "rectangular") -> Keys:
    """Keys of a pulse of the floor's acceleration, in m/s2 and s."""
    return {
        "motion.kind": "pulse",
        "motion.shape": shape,
        "motion.peak_acceleration_m_s2": peak,
        "motion.pulse_s": length,
    }


class RunFailedError(ArithmeticError):
    """A run of a verification check failed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Finished:
    """A run that reached its end."""

    model: Model
    history: History
    status: str  #: completed | overturned

    @property
    def times(self) -> FloatArray:
        """Of the samples [s]."""
        return self.history["time_s"]

    @property
    def track(self) -> Any:
        """Extremes and events of the run, see `contact.stepping.observables.OBSERVABLES`."""
        return self.model.run.track[0]

    @property
    def joint(self) -> Any:
        """Slip over the floor, see `contact.stepping.state.JOINT_RECORD`."""
        return self.model.run.joints[0]

    @property
    def outcome(self) -> str:
        """rest | slide | rock | slide-rock | overturned."""
        return outcome_of(self.model)

    @property
    def restitution(self) -> float:
        """Velocity ratio of the first impact, by the peaks around it."""
        return float(self.track.restitution)

    @property
    def block(self) -> RigidBlock:
        """The analytic block with the mass, centroid and inertia of the mesh."""
        return block_of(self.model)


def run(
    case: Case,
    values: Mapping[str, Any] | None = None,
    container: Container | None = None,
    stiffer: float = 1.0,
) -> Finished:
    """Compute a case with some keys changed; `stiffer` multiplies the penalty that it has."""
    model = build_model(case.with_values(values) if values else case, container)
    if stiffer != 1.0:
        penalty = {"contact.normal_penalty_Pa_m": stiffer * model.penalty}
        model = build_model(model.case.with_values(penalty), model.container)
    return finish(model)


def finish(model: Model) -> Finished:
    """Step a model to its end."""
    recorder = Recorder(model)
    ending = simulate(model, recorder)
    if ending.error is not None:
        raise RunFailedError(ending.error)
    return Finished(model=model, history=recorder.history(), status=ending.status)


def bisected(happens: Callable[[float], bool], low: float, high: float, *, resolution: float) -> float:
    """Least parameter at which `happens`, to a relative resolution; nan if it is not within the bracket."""
    if happens(low) or not happens(high):
        return math.nan
    while high - low > resolution * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if happens(middle) else (middle, high)
    return 0.5 * (low + high)


def with_steps_of(model: Model, step: float) -> Model:
    """The model with every step of one size [s], whatever its energy balance."""
    loose = model.run.problem.control._replace(
        largest_step=step, smallest_step=step, event_step=step, closing_step=step, energy_rate=1e30
    )
    return replace(model, run=model.run.with_problem(control=loose))


def with_motion(model: Model, motion: FloorMotion, breaks: tuple[float, ...] = ()) -> Model:
    """A rigid or reduced model on another floor, with which the container moves at t = 0.

    `breaks` are the instants at which the floor's acceleration jumps [s].
    """
    state = model.run.old
    before, speed_before, _ = model.run.floor[0]
    floor, speed, acceleration = floor_motion(motion, 0.0)
    state.position[0] += floor - before
    state.velocity[0] += speed - speed_before
    model.run.floor[:] = floor, speed, acceleration
    modal_body.start(_modal(model), state, floor, 0.0, 0.0)
    ends = np.array([*breaks, model.duration, np.inf])
    return replace(model, run=model.run.with_problem(motion=motion, breaks=ends))


def lifted(model: Model, height: float, speed: float) -> Model:
    """A rigid or reduced model `height` [m] above the floor, unstrained, falling at `speed` [m/s]."""
    x, z = model.container.mesh.centroid
    stance = Stance(
        centre=(x, z + height),
        rotation=0.0,
        velocity=(0.0, -speed),
        angular_velocity=0.0,
        force=np.zeros_like(model.run.old.force),
    )
    return placed(model, stance)


def placed(model: Model, stance: Stance) -> Model:
    """A rigid or reduced model in another pose and motion at t = 0, without forces."""
    state = model.run.old
    state.force[:] = 0.0
    state.stick[:] = 0.0
    modal_body.place(_modal(model), state, stance)
    modal_body.start(_modal(model), state, float(model.run.floor[0, 0]), 0.0, 0.0)
    return model


def _modal(model: Model) -> ModalBody:
    assert isinstance(model.body, ModalBody)  # the checks lift and move no full model
    return model.body


#: four boxes on coarse meshes, so that the full model stays affordable: the models are compared on one mesh
BOXES: Keys = {"container.height_m": 1.0, "container.boxes": 4, "container.weight_N": 24525.0}
FOUR = STACK.with_values(
    SOLID | TILTED | BOXES | {"support.foot_m": 0.15, "solver.element_size_m": 0.55, "solver.duration_s": 2.4}
)
SECTIONS: dict[str, dict[str, Any]] = {
    "solid": {},
    # 20 mm of steel, two elements across a wall of 1 m: f1 is three times the contact frequency on corners
    "shell": {"container.section": "shell", "container.wall_m": 0.02, "solver.element_size_m": 0.5},
    # the 8 mm of the shipped cases: f1 is the contact frequency
    "thin shell": {"container.section": "shell", "container.wall_m": 0.008, "solver.element_size_m": 1.0},
}


def stack(section: str = "solid", **changes: Any) -> Case:
    """The stack of a section, with dotted keys changed; `__` in place of the dot."""
    changed = {key.replace("__", "."): value for key, value in changes.items()}
    return FOUR.with_values(SECTIONS[section] | changed)


def difference(one: Finished, other: Finished, *, until: float = math.inf) -> float:
    """Largest |difference| of rotation at common samples up to a time [s], over the slenderness angle."""
    count = min(len(one.history.modes), len(other.history.modes))
    apart = np.abs(one.history["rotation_rad"][:count] - other.history["rotation_rad"][:count])
    return float(apart[one.times[:count] < until].max()) / one.model.static.slenderness_angle
