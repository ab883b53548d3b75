"""The reduced container: free elastic modes plus attachment modes, in the frame that floats with it.

An attachment mode is the static answer of the free body to a unit force at a base point, its rigid acceleration
taken out (inertia relief). With one for every contact degree of freedom the local compliance under the contact
is exact, however few free modes are kept. All are made orthonormal: mass 1, stiffness diag(omega^2). Rubin,
AIAA J. 13 (1975) 995; Craig, Structural Dynamics (1981), ch. 19.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse.linalg

from contact.interface import FloatArray, IntArray
from fem.assembly import FiniteElements
from fem.modes import elastic_modes, rigid_modes

#: an attachment mode that the others span to this relative mass adds nothing but noise
INDEPENDENT = 1e-10


@dataclass(frozen=True, kw_only=True, eq=False)
class StaticResponse:
    """Inertia-relief displacements under unit forces at the base points."""

    displacement: FloatArray  #: (2 n_c, n, 2), for a force along x, z of each point in turn [m/N]
    compliance: FloatArray  #: (2 n_c, 2 n_c) seen at those points [m/N]


@dataclass(frozen=True, kw_only=True, eq=False)
class ReducedBasis:
    """Orthonormal elastic shapes of the container, by rising frequency."""

    angular_frequencies: FloatArray  #: (m,) [rad/s]
    shapes: FloatArray  #: (m, n, 2) mass-normalised [1/sqrt(kg)]


def static_response(elements: FiniteElements, base: IntArray) -> StaticResponse:
    """Answer of the free elastic container to unit forces at the nodes `base` (n_c,).

    The body is held at three degrees of freedom; the loads balance themselves, so the supports carry nothing
    and only choose the rigid motion, which is then taken out.
    """
    rigid = rigid_modes(elements).reshape(3, -1)
    mass = elements.vector_mass
    nodes = elements.nodes
    first, last = int(np.argmin(nodes @ [1.0, 1.0])), int(np.argmax(nodes @ [1.0, 1.0]))
    held = np.array([2 * first, 2 * first + 1, 2 * last])
    free = np.setdiff1d(np.arange(2 * len(nodes)), held)
    dofs = (2 * np.asarray(base)[:, None] + np.arange(2)).ravel()
    loads = np.zeros((2 * len(nodes), dofs.size))
    loads[dofs, np.arange(dofs.size)] = 1.0
    loads -= (mass @ rigid.T) @ (rigid @ loads)
    factor = scipy.sparse.linalg.splu(
        elements.stiffness[np.ix_(free, free)].tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    answers = np.zeros_like(loads)
    answers[free] = factor.solve(loads[free])
    answers -= rigid.T @ (rigid @ (mass @ answers))
    compliance = answers[dofs]
    return StaticResponse(
        displacement=answers.T.reshape(dofs.size, -1, 2), compliance=0.5 * (compliance + compliance.T)
    )


def reduced_basis(elements: FiniteElements, response: StaticResponse, modes: int) -> ReducedBasis:
    """Span of `modes` free modes and all attachment modes, diagonalised (Rayleigh-Ritz)."""
    mass, stiffness = elements.vector_mass, elements.stiffness
    columns = np.zeros((elements.unknowns, 0))
    if modes > 0:
        columns = (
            elastic_modes(elements, min(modes, elements.unknowns - 3)).shapes.reshape(-1, elements.unknowns).T
        )
    attachments = response.displacement.reshape(-1, elements.unknowns).T
    attachments = attachments / np.sqrt(np.sum(attachments * (mass @ attachments), axis=0))
    for _ in range(2):  # twice is enough to make them orthogonal to rounding
        attachments = attachments - columns @ (columns.T @ (mass @ attachments))
    # What the free modes leave of an attachment mode, of mass 1 before: nothing but noise, if they span it.
    values, directions = np.linalg.eigh(attachments.T @ (mass @ attachments))
    kept = values > INDEPENDENT
    columns = np.hstack([columns, attachments @ (directions[:, kept] / np.sqrt(values[kept]))])
    gram = columns.T @ (mass @ columns)
    projected = columns.T @ (stiffness @ columns)
    squares, combination = scipy.linalg.eigh(0.5 * (projected + projected.T), 0.5 * (gram + gram.T))
    shapes = (columns @ combination).T.reshape(squares.size, -1, 2)
    return ReducedBasis(angular_frequencies=np.sqrt(squares), shapes=shapes)
