"""Manufactured solutions, static and dynamic, at finite strain and rotation; sources from the textbook law.

Roache, Verification and Validation in Computational Science and Engineering (1998), chapter 3. The source in space
follows from St. Venant-Kirchhoff's law of plane stress, by differences of its stress; it uses nothing of the
elements. The source of the moving body is exact in space (its internal forces are those of the elements), so its
error is that of the time stepping alone.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from meshes import area_load, edge_load, internal_force, l2_distance, mapped_mesh, tangent
from scipy.sparse.linalg import spsolve
from verification.bodies import Flight, free_run

from contact.stepping.body import State
from contact.stepping.integrator import UNPREPARED, advance
from contact.stepping.scheme import Scheme, generalised_alpha
from contact.stepping.state import RunState
from fem.runtime.arrays import BoolArray, FloatArray
from fem.solid import nodal_kernels
from fem.solid.assembly import FiniteElements, assemble
from fem.solid.nodal_body import FullBody

E, NU, THICKNESS, DENSITY = 5.0, 0.3, 0.4, 2.0
HEIGHT = 10.0  #: of the moving bodies above the floor [m]
H = 1e-3  #: of central differences [m, s]
OFFSETS = (-2, -1, 0, 1, 2)  #: of central differences of fourth order, in H


class NewtonError(ArithmeticError):
    """A static solution did not converge."""


def turned_and_strained(x: FloatArray, z: FloatArray, turn: float, strain: float) -> FloatArray:
    """Displacement (2, ...): rotated by `turn` [rad], with strains of `strain` times a few per cent."""
    cosine, sine = math.cos(turn) - 1.0, math.sin(turn)
    return np.array(
        [
            cosine * x + sine * z + strain * 0.03 * np.sin(2.0 * x + 0.5) * np.cos(1.5 * z),
            -sine * x + cosine * z + strain * 0.04 * np.cos(1.2 * x - 0.3) * np.sin(2.2 * z + 0.2),
        ]
    )


def gradient_of(x: FloatArray, z: FloatArray, turn: float, strain: float) -> FloatArray:
    """Its gradient (2, 2, ...), component first."""
    cosine, sine = math.cos(turn) - 1.0, math.sin(turn)
    return np.array(
        [
            [
                cosine + strain * 0.06 * np.cos(2.0 * x + 0.5) * np.cos(1.5 * z),
                sine - strain * 0.045 * np.sin(2.0 * x + 0.5) * np.sin(1.5 * z),
            ],
            [
                -sine - strain * 0.048 * np.sin(1.2 * x - 0.3) * np.sin(2.2 * z + 0.2),
                cosine + strain * 0.088 * np.cos(1.2 * x - 0.3) * np.cos(2.2 * z + 0.2),
            ],
        ]
    )


def textbook_stress(x: FloatArray, z: FloatArray, turn: float, strain: float) -> FloatArray:
    """P = F S, S by Hooke's law of plane stress from (F^T F - I)/2, shape (2, 2, ...)."""
    identity = np.eye(2).reshape(2, 2, *(1,) * np.ndim(x))
    (a, b), (c, d) = gradient_of(x, z, turn, strain) + identity
    xx, zz, xz = 0.5 * (a * a + c * c - 1), 0.5 * (b * b + d * d - 1), 0.5 * (a * b + c * d)
    sxx, szz, sxz = (E / (1 - NU**2) * (xx + NU * zz), E / (1 - NU**2) * (zz + NU * xx), E / (1 + NU) * xz)
    return np.array([[a * sxx + b * sxz, a * sxz + b * szz], [c * sxx + d * sxz, c * sxz + d * szz]])


def static_source(x: FloatArray, z: FloatArray, turn: float, strain: float) -> FloatArray:
    """Load per area of elevation, -t Div P, by differences of fourth order (2, ...)."""
    along = [textbook_stress(x + k * H, z, turn, strain)[:, 0] for k in OFFSETS]
    up = [textbook_stress(x, z + k * H, turn, strain)[:, 1] for k in OFFSETS]
    return -THICKNESS * (first_difference(along) / (12.0 * H) + first_difference(up) / (12.0 * H))


def first_difference(values: list[FloatArray]) -> FloatArray:
    """12 H times the first derivative, from the values at `OFFSETS`."""
    return values[0] - 8.0 * values[1] + 8.0 * values[3] - values[4]


def second_difference(values: list[FloatArray]) -> FloatArray:
    """12 H^2 times the second derivative, from the values at `OFFSETS`."""
    return -values[0] + 16.0 * values[1] - 30.0 * values[2] + 16.0 * values[3] - values[4]


def static_error(order: int, cells: int) -> float:
    """L2 error of the displacement of a curved block without a parallelogram, its boundary held at the exact one."""

    def curved(s: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        x = s * (1.0 + 0.3 * t) + 0.08 * np.sin(np.pi * t) * np.sin(np.pi * s)
        z = t * (1.2 - 0.2 * s) + 0.08 * np.sin(np.pi * t) * np.sin(2 * np.pi * s)
        return x, z

    mesh = mapped_mesh(cells, cells, curved, thickness=THICKNESS)
    elements = assemble(mesh, youngs_modulus=E, poisson_ratio=NU, order=order)
    turn, strain = 0.4, 1.0
    x, z = elements.nodes.T
    held = edge_load(elements, lambda x, z: x > -np.inf, lambda x, z: (1.0, 0.0))[:, 0] > 0.0  # all round
    inside, free = ~held, np.flatnonzero(~np.repeat(held, 2))
    load = area_load(elements, lambda x, z: static_source(x, z, turn, strain)).ravel()[free]
    displacement = turned_and_strained(x, z, turn, strain).T.copy()
    for _ in range(12):
        residual = internal_force(elements, displacement).ravel()[free] - load
        if np.abs(residual).max() < 1e-13 * E * THICKNESS:
            return l2_distance(elements, displacement, lambda x, z: turned_and_strained(x, z, turn, strain))
        correction = spsolve(tangent(elements, displacement)[free][:, free], residual)
        displacement[inside] -= correction.reshape(-1, 2)
    raise NewtonError(f"manufactured solution, {cells} cells of order {order}: no convergence")


def interpreted(body: FullBody, run: RunState, until: float) -> int:
    """`advance_body` by the interpreter, which calls the methods of the body."""
    while (code := advance(body, run, until)) == UNPREPARED:
        body.prepare(run.problem.scheme, float(run.clock[0].unprepared_step))
    return code


class DrivenBody(FullBody):
    """A full body under a source that makes a given motion exact.

    The source is part of its internal forces, which the stepper averages over a step like all forces.
    """

    def __init__(self, elements: FiniteElements, *, damping: float = 0.0) -> None:
        ends, no_monitors = elements.base_nodes[[0, -1]], elements.base_nodes[:0]
        super().__init__(elements, ends, no_monitors, gravity=1e-3, damping=damping)

    def fly(self, scheme: Scheme, step: float, end: float) -> Flight:
        """Step the body along its motion to `end` [s]."""
        self._flight = flight = free_run(self, step=step, scheme=scheme, ends=end)
        flight.advance_by = interpreted
        state = flight.state
        position, velocity, acceleration = self.motion(0.0)
        state.position[:], state.velocity[:] = position.ravel(), velocity.ravel()
        self.nodal.turn[:] = nodal_kernels.fit(self.nodal, state.position)[2:]
        self.nodal.source[:] = self.source(0.0)
        self.evaluate(state)
        self.start(state, 0.0)
        state.acceleration[:] = acceleration.ravel()
        return flight.advance(end)

    def __getattr__(self, operation: str) -> Callable[..., Any]:
        """What `contact.stepping.body` asks of a body, as its nodes do it."""
        return partial(getattr(nodal_kernels, operation), self.nodal)

    def predict(self, scheme: Scheme, step: float, old: State, new: State) -> None:
        """See `contact.stepping.body.predict`; the source is then that of the step's end."""
        nodal_kernels.predict(self.nodal, scheme, step, old, new)
        self.nodal.source[:] = self.source(self._flight.time + step)

    def motion(self, time: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, velocities and accelerations of the nodes, each (n, 2)."""
        positions = [self._position(time + k * H) for k in OFFSETS]
        velocity, acceleration = first_difference(positions), second_difference(positions)
        return positions[2], velocity / (12.0 * H), acceleration / (12.0 * H * H)

    @property
    def weight(self) -> FloatArray:
        """Of the nodes, upward as an internal force is, (n, 2) [N]."""
        return np.column_stack([np.zeros(self.nodal.nodal_mass.size), self.gravity * self.nodal.nodal_mass])

    def source(self, time: float) -> FloatArray:
        """Nodal forces (n, 2) that make the motion exact [N]."""
        raise NotImplementedError

    def _position(self, time: float) -> FloatArray:
        x, z = self.elements.nodes.T
        turn, strain = turn_and_strain(time)
        displacement = turned_and_strained(x, z, turn, strain).T
        return self.elements.nodes + displacement + np.array([0.3 * time, HEIGHT + 2.0 * time**2])


class SemiDiscreteBody(DrivenBody):
    """Its source balances the elements' own forces: exact in space."""

    def source(self, time: float) -> FloatArray:
        """M x'' + internal forces + damping + weight of the motion."""
        position, velocity, acceleration = self.motion(time)
        internal = internal_force(self.elements, position - self.elements.nodes)
        cosine, sine = self.nodal.turn
        turn = np.array([[cosine, sine], [-sine, cosine]])
        damping = self.damping * (self.elements.stiffness @ (velocity @ turn).ravel()).reshape(-1, 2) @ turn.T
        return self.elements.mass @ acceleration + internal + damping + self.weight


class ContinuumBody(DrivenBody):
    """Its source is that of the continuum: inertia, -Div P inside and P n on the faces of the unit square."""

    def source(self, time: float) -> FloatArray:
        """Consistent nodal forces of the textbook's source, and the weight."""
        turn, strain = turn_and_strain(time)

        def inertia(x: FloatArray, z: FloatArray) -> FloatArray:
            moved = []
            for t in (time + k * H for k in OFFSETS):
                rise = np.array([0.3 * t, 2.0 * t**2]).reshape(2, *(1,) * np.ndim(x))
                moved.append(turned_and_strained(x, z, *turn_and_strain(t)) + rise)
            return DENSITY * THICKNESS * second_difference(moved) / (12.0 * H * H)

        load = area_load(self.elements, lambda x, z: static_source(x, z, turn, strain) + inertia(x, z))
        for axis, coordinate, sign in ((0, 0.0, -1.0), (0, 1.0, 1.0), (1, 0.0, -1.0), (1, 1.0, 1.0)):

            def on_face(x: FloatArray, z: FloatArray, axis: int = axis, at: float = coordinate) -> BoolArray:
                return np.asarray(np.abs((x, z)[axis] - at) < 1e-9)

            def traction(x: FloatArray, z: FloatArray, axis: int = axis, sign: float = sign) -> FloatArray:
                return np.asarray(sign * THICKNESS * textbook_stress(x, z, turn, strain)[:, axis])  # [N/m]

            load += edge_load(self.elements, on_face, traction)
        return load + self.weight


def turn_and_strain(time: float) -> tuple[float, float]:
    """Rotation [rad] and size of the strains of the moving bodies."""
    return 0.2 + 2.0 * time + 0.8 * time**2, 1.0 + 0.5 * math.sin(3.0 * time)


def moving_body_error(scheme: Scheme, step: float) -> float:
    """Largest error of a node at 0.5 s of the motion that is exact in space, over the size of the body."""
    body = SemiDiscreteBody(unit_square(3, 1), damping=0.02)
    flight = body.fly(scheme, step, 0.5)
    return float(np.abs(flight.state.position.reshape(-1, 2) - body.motion(flight.time)[0]).max())


def dynamic_error(order: int, cells: int, step: float) -> float:
    """L2 error of the displacement at 0.3 s of the motion of the continuum."""
    elements = unit_square(cells, order)
    flight = ContinuumBody(elements).fly(generalised_alpha(0.5), step, 0.3)
    displacement = flight.state.position.reshape(-1, 2) - elements.nodes
    turn, strain = turn_and_strain(flight.time)
    rise = np.array([0.3 * flight.time, HEIGHT + 2.0 * flight.time**2])
    return l2_distance(elements, displacement - rise, lambda x, z: turned_and_strained(x, z, turn, strain))


def unit_square(cells: int, order: int) -> FiniteElements:
    """The moving body: `cells` x `cells` elements."""
    mesh = mapped_mesh(cells, cells, lambda s, t: (s, t), thickness=THICKNESS, density=DENSITY)
    return assemble(mesh, youngs_modulus=E, poisson_ratio=NU, order=order)
