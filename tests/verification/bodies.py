"""A bare body in the stepper: free in the air or in front of a wall, with steps of one size and no case.

For what no case file can express: an oscillator, a body with a source term, a bar. Stepping, contact and energy
ledger are those of every run.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from block_on_floor import contact_of
from runs import STACK, with_steps_of

from contact.interface.equilibrium import Stance
from contact.motion.kernel import UNIFORM, as_floor_motion
from contact.stepping import modal_body
from contact.stepping.body import State, make_state
from contact.stepping.integrator import REACHED
from contact.stepping.modal_body import ModalBody
from contact.stepping.scheme import Scheme
from contact.stepping.state import RunState, make_run, make_samples
from fem.model.model import build_model
from fem.runtime.arrays import FloatArray
from fem.solid.assembly import FiniteElements
from fem.solid.nodal_body import FullBody, advance_body
from fem.solid.reduction import StaticResponse


class SteppingError(ArithmeticError):
    """The stepper did not converge."""


@dataclass(eq=False)
class Flight:
    """A body in motion; `advance` steps it in steps of one size."""

    body: ModalBody | FullBody
    run: RunState
    step: float  #: [s]
    first_energy: float  #: kinetic and strain at t = 0 [J]
    advance_by: Callable[[Any, RunState, float], int] = advance_body
    times: list[float] = field(default_factory=list)  #: of `normal_force` [s]
    normal_force: list[float] = field(default_factory=list)  #: of the floor, after every step [N]

    @property
    def state(self) -> State:
        """The present state."""
        return self.run.old

    @property
    def time(self) -> float:
        """[s]"""
        return float(self.run.clock[0].time)

    def advance(self, until: float, *, trace: bool = False) -> "Flight":
        """Step to `until` [s]; with `trace`, record the floor's force after every step."""
        while self.time < until * (1.0 - 1e-12):
            stop = self.time + 0.5 * self.step if trace else until * (1.0 - 1e-12)
            if self.advance_by(self.body, self.run, stop) != REACHED:
                raise SteppingError(f"t = {self.time:.6g} s: no convergence at the step {self.step:.3g} s")
            self.run.clock[0].samples_drained = self.run.clock[0].samples
            if trace:
                self.times.append(self.time)
                self.normal_force.append(float(self.state.force[:, 1].sum()))
        return self


def free_run(
    body: ModalBody | FullBody,
    *,
    step: float,
    scheme: Scheme,
    velocity: FloatArray | None = None,
    modal_position: float = 0.0,
    height: float = 0.0,
    springs: FloatArray | None = None,
    caps: FloatArray | None = None,
    growth: float = 0.0,
    speed: float = 0.0,
    ends: FloatArray | float = math.inf,
) -> Flight:
    """Put a body into the stepper, every step of one size [s].

    At t = 0 it is at a height above its place on the floor [m]; the nodes of a full body have velocities (n, 2) [m/s],
    a modal body its modes' amplitude and an upward speed [m/s]. Contact springs (n,) [N/m], negligible if not given,
    have neither damping nor friction; at caps (n,) [N] that grow with the indentation, over the cap [1/m], they crush
    the floor. A step must end at `ends` [s].
    """
    if isinstance(body, FullBody):
        coordinates, points, (x, z) = body.coordinates, len(body.base), body.centroid
    else:
        coordinates, points, (x, z) = 3 + body.stiffness.size, len(body.point), body.rest
    old = make_state(coordinates, points, 0)
    stance = Stance(
        centre=(float(x), float(z) + height),
        rotation=0.0,
        velocity=(0.0, speed),
        angular_velocity=0.0,
        force=np.zeros((points, 2)),
    )
    if isinstance(body, FullBody):
        unstrained = np.zeros((2 * points, len(body.elements.nodes), 2))
        compliance = np.zeros((2 * points, 2 * points))
        body.place(old, stance, StaticResponse(displacement=unstrained, compliance=compliance))
        if velocity is not None:
            old.velocity[:] = velocity.ravel()
        body.start(old, 0.0)
    else:
        modal_body.place(body, old, stance)
        old.position[3:] = modal_position
        modal_body.start(body, old, 0.0, 0.0, 0.0)
    samples = coordinates if isinstance(body, ModalBody) else 0
    run = make_run(
        scheme=scheme,
        contact=contact_of(
            np.full(points, 1.0) if springs is None else springs,
            force_scale=body.mass,
            mu=1e-9,
            cap=np.full(points, math.inf) if caps is None else caps,
            cap_growth=np.full(points, growth),
        ),
        motion=as_floor_motion(UNIFORM, (0.0, 0.0, 0.0)),
        breaks=np.atleast_1d(ends),
        control=with_steps_of(build_model(STACK), step).run.problem.control._replace(
            reference_energy=1.0,
            stop_when_overturned=False,
            mass=body.mass,
            gravity=body.gravity,
            base_points=points,
            rolls=False,
            contents_cutoff=200.0,
            top_monitors=0,
        ),
        old=old,
        history=make_samples(1e6 * step, 8, points, columns=True, position=samples),
        frames=make_samples(math.inf, 8, points),
    )
    return Flight(body=body, run=run, step=step, first_energy=float(old.energy[:2].sum()))


def full_body(elements: FiniteElements, *, gravity: float = 1e-3) -> FullBody:
    """A body of these elements on the ends of its base, nearly without weight."""
    ends, no_monitors = elements.base_nodes[[0, -1]], elements.base_nodes[:0]
    return FullBody(elements, ends, no_monitors, gravity=gravity, damping=0.0)
