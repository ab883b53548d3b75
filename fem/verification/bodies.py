"""A bare body in the stepper: free in the air or before a wall, steps of one size, no case around it.

For what no case can say: a single oscillator, a body with a source term, a bar. The stepping, the contact and the
ledger are those of every run.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contact.interface.equilibrium import Stance
from contact.interface.laws import ELASTIC_STICK
from contact.interface.solver import Contact, make_workspace
from contact.motion.kernel import UNIFORM, as_floor_motion
from contact.stepping import modal_body
from contact.stepping.body import State, make_state
from contact.stepping.integrator import REACHED
from contact.stepping.modal_body import ModalBody
from contact.stepping.scheme import Scheme, generalised_alpha, newmark
from contact.stepping.state import Run, make_run, make_samples
from fem.model.model import build_model
from fem.runtime.arrays import FloatArray
from fem.solid.assembly import FiniteElements
from fem.solid.nodal_body import FullBody, advance_body
from fem.solid.reduction import StaticResponse
from fem.verification.runs import STACK, with_steps_of


class SteppingError(ArithmeticError):
    """The stepper gave up."""


@dataclass(eq=False)
class Flight:
    """A body under way; `advance` moves it on in steps of one size."""

    body: Any
    run: Run
    step: float  #: [s]
    first_energy: float  #: kinetic and strain at t = 0 [J]
    _times: list[float] = field(default_factory=list)
    _normal: list[float] = field(default_factory=list)
    _energy: list[float] = field(default_factory=list)

    @property
    def state(self) -> State:
        """The present state."""
        return self.run.old

    @property
    def time(self) -> float:
        """[s]"""
        return float(self.run.clock[0].time)

    def advance(self, until: float, *, trace: bool = False) -> "Flight":
        """Step to `until` [s]; with `trace`, note floor force and energy after every step.

        Raises:
            SteppingError: an iteration did not converge.
        """
        while self.time < until * (1.0 - 1e-12):
            stop = self.time + 0.5 * self.step if trace else until * (1.0 - 1e-12)
            if advance_body(self.body, self.run, stop) != REACHED:
                raise SteppingError(f"t = {self.time:.6g} s: no convergence at the step {self.step:.3g} s")
            self.run.clock[0].samples_drained = self.run.clock[0].samples
            if trace:
                self._times.append(self.time)
                self._normal.append(float(self.state.force[:, 1].sum()))
                self._energy.append(float(self.state.energy.sum()))
        return self

    def trace(self, name: str) -> tuple[FloatArray, FloatArray]:
        """Times [s] and what was noted of `normal_force` [N] or `energy` [J]."""
        noted = {"normal_force": self._normal, "energy": self._energy}[name]
        return np.array(self._times), np.array(noted)


def free_run(
    body: ModalBody | FullBody,
    *,
    step: float,
    radius: float | None = 0.5,
    scheme: Scheme | None = None,
    velocity: FloatArray | None = None,
    modal_position: FloatArray | None = None,
    height: float = 0.0,
    springs: FloatArray | None = None,
    until: float = math.inf,
) -> Flight:
    """Put a body into the stepper, every step of one size.

    Args:
        step: [s].
        radius: spectral radius of generalised-alpha; None: the trapezoidal rule.
        scheme: in place of it.
        velocity: of the coordinates at t = 0; None: at rest.
        modal_position: amplitudes of a modal body's modes at t = 0; None: undeformed.
        height: above its place on the floor at t = 0 [m].
        springs: (n,) contact springs, without damping and friction [N/m]; None: none to speak of.
        until: an instant that a step ends on [s].
    """
    full = isinstance(body, FullBody)
    coordinates = body.coordinates if isinstance(body, FullBody) else 3 + body.stiffness.size
    points = len(body.base) if isinstance(body, FullBody) else len(body.point)
    old, new = (make_state(coordinates, points, 0) for _ in range(2))
    if isinstance(body, FullBody):
        nodes = len(body.elements.nodes)
        nothing = StaticResponse(
            displacement=np.zeros((2 * points, nodes, 2)), compliance=np.zeros((2 * points, 2 * points))
        )
        body.place(old, _in_place(body.centroid, height, points), nothing, 0.0)
    else:
        modal_body.place(body, old, _in_place(body.rest, height, points), 0.0)
    if velocity is not None:
        old.velocity[:] = np.ravel(velocity)
    if modal_position is not None:
        old.position[3:] = modal_position
    if isinstance(body, FullBody):
        body.start(old, 0.0)
    else:
        modal_body.start(body, old, 0.0)
    if scheme is None:
        scheme = newmark(0.25, 0.5) if radius is None else generalised_alpha(radius)
    stiffness = np.full(points, 1.0) if springs is None else springs
    run = make_run(
        scheme=scheme,
        contact=_contact(stiffness, body.mass),
        motion=as_floor_motion(UNIFORM, (0.0, 0.0, 0.0)),
        breaks=np.full(1, until),
        control=with_steps_of(build_model(STACK), step).run.control._replace(
            reference_energy=1.0,
            stop_when_overturned=False,
            mass=body.mass,
            gravity=body.gravity,
            base_points=points,
            top_monitors=0,
        ),
        old=old,
        new=new,
        work=make_workspace(points),
        history=make_samples(1e6 * step, 8, points, columns=True, position=0 if full else coordinates),
        frames=make_samples(math.inf, 8, points),
    )
    return Flight(body=body, run=run, step=step, first_energy=float(old.energy[:2].sum()))


def _in_place(centre: FloatArray, height: float, points: int) -> Stance:
    return Stance(
        centre=(float(centre[0]), float(centre[1]) + height),
        rotation=0.0,
        velocity=(0.0, 0.0),
        angular_velocity=0.0,
        force=np.zeros((points, 2)),
    )


def _contact(springs: FloatArray, mass: float) -> Contact:
    return Contact(
        normal_stiffness=springs,
        tangential_stiffness=springs.copy(),
        relaxation_time=0.0,
        mu_static=1e-9,
        mu_kinetic=1e-9,
        weakening=0.0,
        friction=ELASTIC_STICK,
        regularisation_velocity=1e-3,
        force_scale=mass,
        resolution=1e-15,
    )


def body_of(elements: FiniteElements) -> FullBody:
    """A free body of these elements, undamped and nearly without weight."""
    return FullBody(
        elements, elements.base_nodes[[0, -1]], elements.base_nodes[:0], gravity=1e-3, damping=0.0
    )
