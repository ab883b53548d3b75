"""Where the stress of a container with posts counts: outside the castings of its corners.

A corner bears on one node. The stress beside it is that of the force over an element, and grows without limit as the
mesh is refined; a casting spreads the force, and the mesh has none. A casting's length away the stress no longer
depends on that (Saint-Venant's principle; `README.md` has figures). Without posts it counts everywhere.
"""

import math
from weakref import WeakKeyDictionary

import numpy as np

from fem.case.case import Case
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.assembly import FiniteElements
from fem.solid.elasticity import von_mises
from fem.solid.reduction import ReducedBasis

#: |VON_MISES_ROOT s| is the equivalent stress of s = (sx, sz, t)
VON_MISES_ROOT = np.array([[1.0, -0.5, 0.0], [0.0, math.sqrt(0.75), 0.0], [0.0, 0.0, math.sqrt(3.0)]])
#: relative rounding error of a stress against its bound
ROUNDING = 1e-9
LOWEST = 4  #: modes by which nodes are chosen whose stress is looked at
ALIKE = 1e-3  #: relative difference of stresses at a node and its mirror image, at most
_WATCHED = WeakKeyDictionary[ReducedBasis, dict[object, tuple[FloatArray, float]]]()  #: see `watched_stress`


def casting_length(case: Case) -> float | None:
    """Length of the castings along x, without them the width of the posts [m]; None of a container without posts."""
    post, casting = case.container.post_section, case.support.casting_m
    if post is None:
        return None
    return post[0] if casting is None else casting[0]


def counted_nodes(case: Case, elements: FiniteElements) -> IntArray:
    """Nodes of a body outside the squares of the castings at its four corners; of one without posts, all."""
    length, nodes = casting_length(case), elements.nodes
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    outside = np.minimum(nodes - low, high - nodes).max(axis=1) >= 0.999 * (length or 0.0)
    return np.flatnonzero(outside if outside.any() else ~outside)


def stressed_nodes(case: Case, elements: FiniteElements, basis: ReducedBasis, loaded: IntArray) -> IntArray:
    """Nodes whose stress is looked at in every step of a reduced body that bears at the nodes `loaded`.

    These; with posts, the counted ones that a force at one of these, or one of the lowest modes, stresses most: of a
    symmetric container both of a pair, whichever rounding makes the larger.
    """
    if casting_length(case) is None:
        return loaded
    counted = counted_nodes(case, elements)
    amplitudes = basis.shapes[:, loaded].reshape(len(basis.shapes), -1).T / basis.angular_frequencies**2
    shapes = np.concatenate([amplitudes, np.eye(LOWEST, len(basis.shapes))])
    stresses = np.array([von_mises(shape @ basis.stress)[counted] for shape in shapes])
    largest = stresses >= (1.0 - ALIKE) * stresses.max(axis=1, keepdims=True)
    return counted[largest.any(axis=0)]


def watched_stress(
    case: Case, elements: FiniteElements, basis: ReducedBasis, loaded: IntArray
) -> tuple[FloatArray, float]:
    """Stress of each mode at the `stressed_nodes`, (m, n_s, 3), and the largest of its bounds squared, over the energy.

    Found once for a basis, which the runs of a band share.
    """
    known, key = _WATCHED.setdefault(basis, {}), (casting_length(case), loaded.tobytes())
    if key not in known:
        stress = basis.stress[:, :, stressed_nodes(case, elements, basis, loaded)]
        bound = 2.0 * (1.0 + ROUNDING) * np.max(stress_bounds(stress, basis.angular_frequencies)) ** 2
        known[key] = np.moveaxis(stress, 0, -1), bound
    return known[key]


def stress_bounds(stress: FloatArray, angular_frequencies: FloatArray) -> FloatArray:
    """Largest von Mises stress of nodes for modes (3, m, n) [Pa], over the root of twice the strain energy, (n,)."""
    rooted = np.moveaxis(np.tensordot(VON_MISES_ROOT, stress / angular_frequencies[:, None], axes=1), -1, 0)
    return np.sqrt(np.linalg.eigvalsh(rooted @ rooted.swapaxes(1, 2))[:, -1])
