"""The container with every node free to move: total Lagrangian, without a tangent ever being assembled.

In the frame that turns with the container the Newmark matrix M/(beta h^2) + K is constant, because M, the same
on x and z, commutes with the rotation. It is factored once a step size; the residual is the exact one of finite
rotation and St. Venant-Kirchhoff elasticity, and each iteration is one rotated back-substitution. What is left
out of the matrix - geometric stiffness, of the order of the strain - only costs iterations. The contact is
condensed to the base points and solved by the same compiled functions as for the reduced container.

Coordinates are the absolute positions of the nodes, x and z in turn. Damping is proportional to the stiffness
and acts in the turned frame, so that it does not brake the rocking itself.
"""

import math
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from contact.body import (
    ANGULAR_VELOCITY,
    CENTRE_X,
    CENTRE_Z,
    KINETIC,
    POTENTIAL,
    ROTATION,
    STRAIN,
    VELOCITY_X,
    VELOCITY_Z,
    State,
)
from contact.initial import Stance
from contact.interface import FloatArray, IntArray, Workspace, turn_compliance
from contact.scheme import Scheme
from fem.assembly import FiniteElements
from fem.nodal_products import sums_of_momentum, sums_of_position, times_field
from fem.reduction import StaticResponse

#: residual of a step at which its iteration stops, over the weight; the next iterate would have its square
RESIDUAL_TOLERANCE = 5e-6
FACTOR_MEMORY = 600_000_000  #: for factors of different step sizes [bytes]


@dataclass(frozen=True, eq=False)
class _Factor:
    """The effective matrix of one step size, factored, and its compliance seen from the base points."""

    solve: scipy.sparse.linalg.SuperLU
    to_base: FloatArray  #: (2 n_c, 2 n) displacement under unit forces at the base points, turned frame
    compliance: FloatArray  #: (2 n_c, 2 n_c) of the base points, turned frame


def _rotation_matrix(rotation: float) -> FloatArray:
    """R with x = R X for a rotation > 0 toward +x."""
    cosine, sine = math.cos(rotation), math.sin(rotation)
    return np.array([[cosine, sine], [-sine, cosine]])


class FullBody:
    """What `contact.body` asks of a body, for a finite-element container.

    Args:
        elements: the container, discretised.
        base: (n_c,) its supporting nodes, by rising x.
        monitor: (n_m,) nodes whose motion is followed.
        gravity: [m/s2].
        damping: a of the stiffness-proportional damping C = a K in the turned frame [s].
    """

    def __init__(
        self,
        elements: FiniteElements,
        base: IntArray,
        monitor: IntArray,
        *,
        gravity: float,
        damping: float,
    ) -> None:
        self.elements = elements
        self.base = np.asarray(base)
        self.monitor = np.asarray(monitor)
        self.gravity = gravity
        self.damping = damping
        self._mass = elements.mass
        self._vector_mass = elements.vector_mass
        self._stiffness = elements.stiffness.tocsr()
        self._nodal_mass = elements.mass @ np.ones(len(elements.nodes))
        self.mass = float(self._nodal_mass.sum())
        self.centroid = self._nodal_mass @ elements.nodes / self.mass
        self._arm = elements.nodes - self.centroid
        self._mass_arm = elements.mass @ self._arm
        self.inertia = float(np.sum(self._mass_arm * self._arm))
        self._weight = np.column_stack([np.zeros(len(elements.nodes)), self._nodal_mass * gravity])
        self._factors: OrderedDict[tuple[Scheme, float], _Factor] = OrderedDict()
        self._turn = np.eye(2)
        self._residual: FloatArray | None = None
        self._internal = np.zeros_like(elements.nodes)
        self._strain_energy = 0.0
        self._damping_force = np.zeros_like(elements.nodes)
        self._free_change = np.zeros_like(elements.nodes)
        self.residuals = 0  #: evaluated so far

    @property
    def coordinates(self) -> int:
        """Number of coordinates."""
        return 2 * len(self.elements.nodes)

    def place(self, state: State, stance: Stance, response: StaticResponse, floor_velocity: float) -> None:
        """Write the initial coordinates: the stance's rigid pose, strained by its contact forces."""
        turn = _rotation_matrix(stance.rotation)
        elastic = np.tensordot((stance.force @ turn).ravel(), response.displacement, axes=1)
        arm = (self._arm + elastic) @ turn.T
        position = np.asarray(stance.centre) + arm
        speed = stance.angular_velocity * np.column_stack([arm[:, 1], -arm[:, 0]])
        velocity = np.asarray(stance.velocity) + np.array([floor_velocity, 0.0]) + speed
        state.position[:] = position.ravel()
        state.velocity[:] = velocity.ravel()
        self._turn = turn
        self._forces(position, velocity)

    def start(self, state: State, floor: float) -> None:
        """What follows from the coordinates and contact forces in `state`, and the acceleration they give."""
        self.complete(state, floor)
        force = (state.external - state.internal).reshape(-1, 2)
        factor = scipy.sparse.linalg.splu(self._mass.tocsc())
        state.acceleration[:] = factor.solve(force).ravel()

    def predict(self, scheme: Scheme, step: float, old: State, new: State) -> None:
        """See `contact.body.predict`."""
        new.position[:] = old.position + step * (old.velocity + 0.5 * step * old.acceleration)
        new.velocity[:] = old.velocity + step * old.acceleration
        new.acceleration[:] = old.acceleration
        rotation, _ = self._best_fit(new.position.reshape(-1, 2))
        self._turn = _rotation_matrix(rotation)
        self._residual = None

    def release(
        self,
        scheme: Scheme,
        step: float,
        old: State,
        new: State,
        work: Workspace,
        floor: float,
        floor_velocity: float,
    ) -> None:
        """See `contact.body.release`."""
        factor = self._factor(scheme, step)
        if self._residual is None:
            self._residual = self._unbalanced(scheme, old, new)
        turn = self._turn
        change = factor.solve.solve(-(self._residual @ turn).ravel()).reshape(-1, 2) @ turn.T
        self._free_change = change
        moved = change[self.base]
        slope = scheme.newmark_gamma / (scheme.newmark_beta * step)
        shift = np.array([floor, 0.0])
        work.free[:] = new.position.reshape(-1, 2)[self.base] + moved - shift
        work.free_velocity[:] = new.velocity.reshape(-1, 2)[self.base] + slope * moved
        work.free_velocity[:, 0] -= floor_velocity
        now = 1.0 - scheme.alpha_f
        turn_compliance(factor.compliance, turn[0, 0], turn[0, 1], now, work.compliance)

    def respond(self, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
        """See `contact.body.respond`; the error is the residual over its tolerance."""
        now = 1.0 - scheme.alpha_f
        factor = self._factor(scheme, step)
        turn = self._turn
        answer = ((work.force @ turn).ravel() @ factor.to_base).reshape(-1, 2) @ turn.T
        change = (self._free_change + now * answer).ravel()
        new.position[:] += change
        new.velocity[:] += scheme.newmark_gamma / (scheme.newmark_beta * step) * change
        new.acceleration[:] += change / (scheme.newmark_beta * step * step)
        self._residual = self._unbalanced(scheme, old, new)
        unbalanced = self._residual.copy()
        unbalanced[self.base] -= now * work.force
        return float(np.abs(unbalanced).max() / (RESIDUAL_TOLERANCE * self.mass * self.gravity))

    def complete(self, new: State, floor: float) -> None:
        """See `contact.body.complete`; internal forces and strain energy are those of the last residual."""
        position, velocity = new.position.reshape(-1, 2), new.velocity.reshape(-1, 2)
        new.internal[:] = (self._internal + self._damping_force + self._weight).ravel()
        new.damping[:] = self._damping_force.ravel()
        new.external[:] = 0.0
        new.external.reshape(-1, 2)[self.base] = new.force
        new.point[:] = position[self.base]
        new.point[:, 0] -= floor
        rotation, centre = self._best_fit(position)
        momentum = times_field(self._mass, velocity)
        x, z, spin, twice = sums_of_momentum(momentum, position, velocity, centre)
        new.pose[ROTATION], new.pose[ANGULAR_VELOCITY] = rotation, spin / self.inertia
        new.pose[CENTRE_X], new.pose[CENTRE_Z] = centre
        new.pose[VELOCITY_X], new.pose[VELOCITY_Z] = x / self.mass, z / self.mass
        new.energy[KINETIC] = 0.5 * twice
        new.energy[STRAIN] = self._strain_energy
        new.energy[POTENTIAL] = self.mass * self.gravity * centre[1]

    def observe(self, new: State, floor: float) -> None:
        """See `contact.body.observe`."""
        position, velocity = new.position.reshape(-1, 2), new.velocity.reshape(-1, 2)
        new.monitor[:, :2] = position[self.monitor] - self.elements.nodes[self.monitor]
        new.monitor[:, 0] -= floor
        new.monitor[:, 2:] = velocity[self.monitor]

    def shift_velocity(self, state: State, velocity: float) -> None:
        """See `contact.body.shift_velocity`."""
        state.velocity[::2] -= velocity

    def memory(self) -> dict[str, FloatArray]:
        """What the last residual left behind for `complete`, by name; everything else follows from the state."""
        return {
            "turn": self._turn,
            "internal": self._internal,
            "damping_force": self._damping_force,
            "strain_energy": np.array([self._strain_energy]),
        }

    def recall(self, memory: Mapping[str, FloatArray]) -> None:
        """Take over the memory of another body of the same container."""
        self._turn = memory["turn"]
        self._internal = memory["internal"]
        self._damping_force = memory["damping_force"]
        self._strain_energy = float(memory["strain_energy"][0])

    def _best_fit(self, position: FloatArray) -> tuple[float, FloatArray]:
        """Mass-weighted best-fit rotation [rad] and mass centre [m]."""
        x, z, along, across = sums_of_position(self._nodal_mass, self._mass_arm, position)
        return math.atan2(across, along), np.array([x, z]) / self.mass

    def _forces(self, position: FloatArray, velocity: FloatArray) -> None:
        """Internal and damping forces at these positions and velocities (n, 2)."""
        self._internal, self._strain_energy = self.elements.force_and_energy(position - self.elements.nodes)
        turned = (velocity @ self._turn).ravel()
        self._damping_force = self.damping * (self._stiffness @ turned).reshape(-1, 2) @ self._turn.T
        self.residuals += 1

    def _unbalanced(self, scheme: Scheme, old: State, new: State) -> FloatArray:
        """Inertia plus internal minus external forces of the step, without its new contact forces (n, 2)."""
        now, before = 1.0 - scheme.alpha_f, scheme.alpha_f
        self._forces(new.position.reshape(-1, 2), new.velocity.reshape(-1, 2))
        mean = (1.0 - scheme.alpha_m) * new.acceleration + scheme.alpha_m * old.acceleration
        residual = times_field(self._mass, mean.reshape(-1, 2))
        residual += now * (self._internal + self._damping_force + self._weight)
        if before != 0.0:
            residual += before * (old.internal - old.external).reshape(-1, 2)
        return residual

    def _factor(self, scheme: Scheme, step: float) -> _Factor:
        """The factored effective matrix of this step size, kept for the next time."""
        key = (scheme, step)
        if key in self._factors:
            self._factors.move_to_end(key)
            return self._factors[key]
        now = 1.0 - scheme.alpha_f
        inertial = (1.0 - scheme.alpha_m) / (scheme.newmark_beta * step * step)
        elastic = now * (1.0 + self.damping * scheme.newmark_gamma / (scheme.newmark_beta * step))
        solver = scipy.sparse.linalg.splu(
            (inertial * self._vector_mass + elastic * self.elements.stiffness).tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        dofs = (2 * self.base[:, None] + np.arange(2)).ravel()
        loads = np.zeros((self.coordinates, dofs.size))
        loads[dofs, np.arange(dofs.size)] = 1.0
        answers = solver.solve(loads)
        seen = 0.5 * (answers[dofs] + answers[dofs].T)
        factor = _Factor(
            solve=solver,
            to_base=np.ascontiguousarray(answers.T),
            compliance=np.ascontiguousarray(seen),
        )
        size = 12 * solver.nnz + factor.to_base.nbytes
        self._factors[key] = factor
        while len(self._factors) > max(8, FACTOR_MEMORY // size):
            self._factors.popitem(last=False)
        return factor
