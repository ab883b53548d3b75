"""Recovery of fields on the whole mesh from the coordinates of a body: displacement, velocity, von Mises stress."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from fem.model.model import Model
from fem.model.peaks import ROUNDING, counted_nodes, stress_bounds
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.assembly import FiniteElements
from fem.solid.elasticity import von_mises
from fem.solid.nodal_body import rotation_matrix

ROWS_AT_ONCE = 32  #: of coordinates whose stress is recovered


@dataclass(frozen=True, kw_only=True, eq=False)
class NodalFields:
    """Fields at one instant, n nodes."""

    displacement: FloatArray  #: (n, 2) from the undeformed position, absolute [m]
    velocity: FloatArray  #: (n, 2) absolute [m/s]
    von_mises: FloatArray | None  #: (n,) [Pa]; None of a container without elastic modes


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyRecovery:
    """Fields of one body from its coordinates (for `full` these are the nodes' positions)."""

    elements: FiniteElements
    centroid: FloatArray  #: (2,) of the undeformed body [m]
    shapes: FloatArray  #: (m, n, 2) elastic modes [1/sqrt(kg)]
    full: bool
    angular_frequencies: FloatArray  #: (m,) of the modes [rad/s]
    counted: IntArray  #: nodes whose stress counts
    _stress: FloatArray = field(repr=False)  # (3, m, n) stress of each mode

    def frame(self, position: FloatArray, velocity: FloatArray) -> NodalFields:
        """Fields for one row of coordinates and their rates."""
        nodes = self.elements.nodes
        if self.full:
            displacement = position.reshape(-1, 2) - nodes
            return NodalFields(
                displacement=displacement,
                velocity=velocity.reshape(-1, 2),
                von_mises=self.elements.nodal_von_mises(displacement),
            )
        turn = rotation_matrix(position[2])
        arm = (nodes - self.centroid + np.tensordot(position[3:], self.shapes, axes=1)) @ turn.T
        elastic_rate = np.tensordot(velocity[3:], self.shapes, axes=1) @ turn.T
        spin = velocity[2] * np.column_stack([arm[:, 1], -arm[:, 0]])
        return NodalFields(
            displacement=position[:2] + arm - nodes,
            velocity=velocity[:2] + spin + elastic_rate,
            von_mises=von_mises(position[3:] @ self._stress) if len(self.shapes) else None,
        )

    def largest_von_mises(self, position: FloatArray) -> float:
        """Largest counted nodal von Mises stress over rows of coordinates (n_s, n_d) [Pa]; 0 without modes.

        Rows are taken by falling strain energy; only nodes are evaluated whose bound reaches the largest stress so far.
        """
        if self.full or not len(self.shapes) or not len(position):
            return 0.0
        modal = position[:, 3:]
        energies = np.linalg.norm(modal * self.angular_frequencies, axis=1)
        falling, largest = np.argsort(-energies, kind="stable"), 0.0
        for rows in np.split(falling, range(1, len(falling), ROWS_AT_ONCE)):
            reaching = self._bounds * energies[rows[0]] >= largest * (1.0 - ROUNDING)
            if not reaching.any():
                break
            stress = modal[rows] @ self._counted_stress[:, :, reaching]
            largest = max(largest, float(von_mises(stress).max()))
        return largest

    @cached_property
    def _counted_stress(self) -> FloatArray:
        """Stress of each mode at the counted nodes, (3, m, n_counted)."""
        every = self.counted.size == self._stress.shape[2]
        return self._stress if every else self._stress[:, :, self.counted]

    @cached_property
    def _bounds(self) -> FloatArray:
        """`stress_bounds` of the counted nodes."""
        return stress_bounds(self._counted_stress, self.angular_frequencies)


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacedBody:
    """One body of a model: its coordinates among all, its nodes, and where it stands undeformed."""

    body: BodyRecovery
    coordinates: slice
    nodes: IntArray | slice  #: of the container, for each node of the body
    place: FloatArray  #: (2,) of the body's own origin [m]


@dataclass(frozen=True, kw_only=True, eq=False)
class Recovery:
    """Fields of a model from its coordinates: of one body, of the boxes of a loose stack, or of a row."""

    elements: FiniteElements  #: of the container
    full: bool
    bodies: tuple[PlacedBody, ...]

    def frame(self, position: FloatArray, velocity: FloatArray) -> NodalFields:
        """Fields for one row of coordinates and their rates."""
        parts = [
            (body, body.body.frame(position[body.coordinates], velocity[body.coordinates]))
            for body in self.bodies
        ]
        if len(parts) == 1:
            return parts[0][1]
        displacement, speed = np.empty_like(self.elements.nodes), np.empty_like(self.elements.nodes)
        stress = np.zeros(len(displacement))
        for body, part in parts:
            displacement[body.nodes], speed[body.nodes] = part.displacement - body.place, part.velocity
            if part.von_mises is not None:
                stress[body.nodes] = part.von_mises
        stressed = any(part.von_mises is not None for _, part in parts)
        return NodalFields(displacement=displacement, velocity=speed, von_mises=stress if stressed else None)

    def largest_in(self, stress: FloatArray) -> float:
        """Largest counted one of the nodal stresses (n,) of a frame [Pa]."""
        return max(float(stress[body.nodes][body.body.counted].max()) for body in self.bodies)

    def largest_of_steps(self, strained: FloatArray) -> float | None:
        """Largest counted von Mises stress of a reduced run over the steps of `RunState.strained`, if any [Pa]."""
        rows = strained[strained[:, :, 0] >= 0.0, 1:] if strained.size else strained
        if not rows.size:
            return None
        return max(body.body.largest_von_mises(rows[:, body.coordinates]) for body in self.bodies)


def recovery_of(model: Model) -> Recovery:
    """Recovery of the fields of this model."""
    container, full = model.container, model.case.solver.model == "full"
    known: dict[int, BodyRecovery] = {}
    bodies, start = [], 0
    size = 3 + max(body.basis.angular_frequencies.size for body in container.bodies)
    places: Sequence[IntArray | slice] = container.box_nodes or (slice(None),)
    for body, nodes in zip(container.bodies, places, strict=True):
        elements, basis = body.elements, body.basis
        if id(body) not in known:
            known[id(body)] = BodyRecovery(
                elements=elements,
                centroid=np.asarray(body.mesh.centroid),
                shapes=basis.shapes,
                full=full,
                angular_frequencies=basis.angular_frequencies,
                counted=counted_nodes(model.case, elements),
                _stress=basis.stress,
            )
        own = 2 * len(elements.nodes) if full else 3 + basis.angular_frequencies.size
        moved = (
            np.zeros(2)  # of a row the coordinates are in a frame of their own
            if container.row
            else container.elements.nodes[nodes][0] - elements.nodes[0]
        )
        bodies.append(
            PlacedBody(body=known[id(body)], coordinates=slice(start, start + own), nodes=nodes, place=moved)
        )
        start += own if full else size
    return Recovery(elements=container.elements, full=full, bodies=tuple(bodies))
