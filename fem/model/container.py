"""The container of a case, discretised: mesh, elements, contact nodes, elastic modes."""

import math
from dataclasses import dataclass

import numpy as np

from contact.interface.support import Support
from fem.case.case import Case
from fem.model.geometry import build_container, node_count
from fem.model.support import build_support
from fem.model.validity import require_memory
from fem.runtime.arrays import IntArray
from fem.runtime.threads import use_one_blas_thread
from fem.solid.array_cache import ArrayCache, no_cache
from fem.solid.assembly import FiniteElements, assemble
from fem.solid.modes import ElasticModes, elastic_modes, signs_of
from fem.solid.reduction import ReducedBasis, StaticResponse, reduced_basis, static_response
from mesh.container import ContainerMesh
from mesh.region import Region


@dataclass(frozen=True, kw_only=True, eq=False)
class Container:
    """A discretised container; it does not depend on floor, motion and damping, so many cases share one."""

    mesh: ContainerMesh
    elements: FiniteElements
    support: Support
    nodes: IntArray  #: (n_c,) contact nodes, those of the base first, by rising x
    monitors: IntArray  #: (n_m,) nodes whose motion is observed
    response: StaticResponse
    basis: ReducedBasis  #: elastic modes of a reduced model; none of the others
    free_modes: int  #: of the basis, the lowest so many are those of the free container
    first: float  #: lowest elastic angular frequency; infinite for a rigid container [rad/s]

    def damping(self, ratio: float) -> float:
        """a of C = a K [s], with this damping ratio of the first elastic mode."""
        return 2.0 * ratio / self.first

    def lowest_modes(self, count: int) -> ElasticModes:
        """The lowest elastic modes of the free container: those of a reduced model, or computed."""
        if count > self.free_modes:
            return elastic_modes(self.elements, count)
        basis = self.basis
        shapes = basis.shapes[:count]
        frequencies = basis.angular_frequencies[:count] / (2.0 * math.pi)
        return ElasticModes(frequencies_Hz=frequencies, shapes=shapes * signs_of(shapes))


def discretise(case: Case, mesh: ContainerMesh | None = None, cache: ArrayCache = no_cache) -> Container:
    """Build elements, contact nodes and elastic modes of a case's container.

    `mesh` is given where it is built already; `cache` holds the arrays that take long to compute.

    Raises:
        CaseError, MeshError: bad input.
    """
    use_one_blas_thread()
    mesh = mesh or build_container(case)
    support = build_support(case, mesh)
    require_memory(case, node_count(mesh, case.solver.order), support.index.size)
    elements = assemble(
        mesh,
        youngs_modulus=case.container.youngs_modulus_Pa,
        poisson_ratio=case.container.poisson_ratio,
        order=case.solver.order,
    )
    nodes = elements.base_nodes[support.index]
    if not case.output.stop_when_overturned:  # lying on its side it touches with the upper corners, too
        nodes = np.concatenate([nodes, _upper_corners(elements)])
    response = static_response(elements, nodes, cache)
    basis = ReducedBasis(angular_frequencies=np.zeros(0), shapes=np.zeros((0, *elements.nodes.shape)))
    free_modes, first = 0, math.inf
    if case.solver.model == "reduced":
        basis = reduced_basis(elements, response, case.solver.elastic_modes, cache)
        free_modes, first = case.solver.elastic_modes, float(basis.angular_frequencies[0])
    elif case.solver.model == "full":
        first = float(elastic_modes(elements, 1, cache).angular_frequencies[0])
    return Container(
        mesh=mesh,
        elements=elements,
        support=support,
        nodes=nodes,
        monitors=_monitors(elements),
        response=response,
        basis=basis,
        free_modes=free_modes,
        first=first,
    )


def _upper_corners(elements: FiniteElements) -> IntArray:
    x, z = elements.nodes.T
    top = np.flatnonzero(z >= z.max() - 1e-9 * np.ptp(z))
    return top[[np.argmin(x[top]), np.argmax(x[top])]]


def _monitors(elements: FiniteElements) -> IntArray:
    """Nodes to observe: the two upper corners, then the middle and the outermost nodes of the contents."""
    contents = np.isin(elements.region, (Region.FILL, Region.SOLID))
    held = np.unique(elements.cells[contents] if contents.any() else elements.cells)
    x, z = elements.nodes[held].T
    corners = [
        held[np.argmax(a * x / np.ptp(x) + b * z / np.ptp(z))] for a in (-1.0, 1.0) for b in (-1.0, 1.0)
    ]
    middle = held[np.argmin(np.hypot(x - x.mean(), z - 0.5 * (z.min() + z.max())))]
    return np.concatenate([_upper_corners(elements), [middle, *corners]])
