"""The reduced container: free elastic modes plus attachment modes, in the frame that floats with it.

An attachment mode is the static response of the free body to a unit force at a base point, without its rigid
acceleration (inertia relief). With one for every contact degree of freedom the local compliance under the contact is
exact, however few free modes are kept. Rubin, AIAA J. 13 (1975) 995; Craig, Structural Dynamics (1981), ch. 19.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.sparse import csc_array

from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.assembly import FiniteElements, factorised
from fem.solid.modes import elastic_modes, rigid_modes

#: relative mass below which an attachment mode, less its projection on the others, is rounding noise
INDEPENDENT = 1e-10
#: largest elastic displacement that probes the stress of a shape, over the size of the container
PROBE = 1e-6
LOADS = 32  #: solved at a time: the solver is no faster per load with more
PRODUCT = 50_000_000_000  #: multiplications in one product of dense rows: a few seconds


@dataclass(frozen=True, kw_only=True, eq=False)
class StaticResponse:
    """Inertia-relief displacements under unit forces at the base points."""

    displacement: FloatArray  #: (2 n_c, n, 2), for a force along x, z of each point in turn [m/N]
    compliance: FloatArray  #: (2 n_c, 2 n_c) seen at those points [m/N]

    def of_first(self, points: int) -> "StaticResponse":
        """The response to forces at the first points alone."""
        first = slice(2 * points)
        return StaticResponse(displacement=self.displacement[first], compliance=self.compliance[first, first])


@dataclass(frozen=True, kw_only=True, eq=False)
class ReducedBasis:
    """Orthonormal elastic shapes of the container, by rising frequency."""

    angular_frequencies: FloatArray  #: (m,) [rad/s]
    shapes: FloatArray  #: (m, n, 2) mass-normalised [1/sqrt(kg)]
    stress: FloatArray  #: (3, m, n) xx, zz, xz of each, linear in the amplitude [Pa/(m sqrt(kg))]


def static_response(elements: FiniteElements, base: IntArray) -> StaticResponse:
    """Response of the free elastic container to unit forces at the nodes `base` (n_c,).

    The body is held at three degrees of freedom, which carry nothing: the loads are self-balanced. The rigid motion is
    then removed.
    """
    rigid = rigid_modes(elements).reshape(3, -1)
    mass, nodes = elements.vector_mass, elements.nodes
    rigid_momentum = mass @ rigid.T
    first, last = int(np.argmin(nodes @ [1.0, 1.0])), int(np.argmax(nodes @ [1.0, 1.0]))
    free = np.ones(elements.unknowns, dtype=bool)
    free[[2 * first, 2 * first + 1, 2 * last]] = False
    dofs = (2 * np.asarray(base)[:, None] + np.arange(2)).ravel()

    factor = factorised(elements.stiffness[:, free][free])
    displacement = np.empty((dofs.size, elements.unknowns))
    for block in blocks(dofs.size, LOADS):
        loaded = dofs[block]
        loads = -rigid_momentum @ rigid[:, loaded]
        loads[loaded, np.arange(loaded.size)] += 1.0
        responses = np.zeros_like(loads)
        responses[free] = factor.solve(loads[free])
        displacement[block] = (responses - rigid.T @ (rigid_momentum.T @ responses)).T
    compliance = displacement[:, dofs]
    return StaticResponse(
        displacement=displacement.reshape(dofs.size, -1, 2), compliance=0.5 * (compliance + compliance.T)
    )


def reduced_basis(elements: FiniteElements, response: StaticResponse, modes: int) -> ReducedBasis:
    """Span of `modes` free modes and all attachment modes, diagonalised (Rayleigh-Ritz).

    Orthonormalised twice: first the attachment modes against the free ones, by products with the mass, which cancel to
    rounding where an attachment mode is nearly spanned; then all columns.
    """
    mass, stiffness, unknowns = elements.vector_mass, elements.stiffness, elements.unknowns
    free = np.zeros((0, unknowns))
    if modes > 0:
        free = elastic_modes(elements, min(modes, unknowns - 3)).shapes.reshape(-1, unknowns)
    attached = response.displacement.reshape(-1, unknowns)
    products = _products(attached, mass)
    scale = 1.0 / np.sqrt(products.diagonal())
    shared = (free @ mass) @ attached.T * scale
    # The part of an attachment mode (of mass 1) outside the free modes; rounding noise if they span it.
    values, directions = np.linalg.eigh(scale[:, None] * products * scale - shared.T @ shared)
    independent = values > INDEPENDENT
    own = directions[:, independent] / np.sqrt(values[independent])
    columns = np.vstack([free, np.empty((own.shape[1], unknowns))])
    _combine(columns[len(free) :], (own.T * scale, attached), (-(shared @ own).T, free))
    gram = _products(columns, mass)
    projected = _products(columns, stiffness)
    squares, combination = scipy.linalg.eigh(projected, gram)
    shapes = np.empty_like(columns)
    _combine(shapes, (combination.T, columns), (np.zeros((squares.size, 0)), free[:0]))
    shapes = shapes.reshape(squares.size, -1, 2)
    stress = np.zeros((3, len(shapes), len(elements.nodes)))
    size = float(np.ptp(elements.nodes, axis=0).max())
    for k, shape in enumerate(shapes):
        probe = PROBE * size / np.abs(shape).max()
        # The difference of both signs leaves the part of the stress that is linear in the displacement.
        both = elements.nodal_stress(probe * shape) - elements.nodal_stress(-probe * shape)
        stress[:, k] = both.T / (2.0 * probe)
    return ReducedBasis(angular_frequencies=np.sqrt(squares), shapes=shapes, stress=stress)


def _products(rows: FloatArray, matrix: csc_array) -> FloatArray:
    """rows matrix rows^T, symmetric to the bit."""
    products = np.empty((len(rows), len(rows)))
    for block in blocks(len(rows), max(1, PRODUCT // rows.size)):
        products[block] = (rows[block] @ matrix) @ rows.T
    return 0.5 * (products + products.T)


def _combine(
    target: FloatArray, first: tuple[FloatArray, FloatArray], second: tuple[FloatArray, FloatArray]
) -> None:
    """Sum of two products of coefficients and rows, into `target`."""
    (factors, rows), (more_factors, more_rows) = first, second
    for block in blocks(len(target), max(1, PRODUCT // rows.size)):
        target[block] = factors[block] @ rows + more_factors[block] @ more_rows


def blocks(count: int, largest: int) -> Iterator[slice]:
    """Slices of at most `largest` that cover `count` items; they depend on sizes alone, never on speed."""
    for first in range(0, count, largest):
        yield slice(first, min(first + largest, count))
