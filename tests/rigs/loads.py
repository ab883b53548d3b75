"""Consistent loads on finite elements, and distances from a field: what verification asks and no run does."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skfem import Basis, FacetBasis, LinearForm

from fem.runtime.arrays import FloatArray
from fem.solid.assembly import FiniteElements

#: a field over the elevation: (x, z) of any shape (...) -> the two components, shape (2, ...)
VectorField = Callable[[FloatArray, FloatArray], Any]
#: (x, z) of the midpoints of edges -> whether each edge is chosen
EdgeChoice = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]
DEGREE = 5  #: of the quadrature


def area_load(elements: FiniteElements, density: VectorField) -> FloatArray:
    """Consistent nodal forces of a load per area of elevation [N/m2], shape (n, 2) [N]."""
    return np.stack([_load(elements._basis, density, i) for i in range(2)], axis=1)


def edge_load(elements: FiniteElements, chosen: EdgeChoice, density: VectorField) -> FloatArray:
    """Consistent nodal forces (n, 2) [N] of a load per length [N/m] of outer edges, chosen by their midpoints."""
    mesh = elements._basis.mesh
    facets = mesh.facets_satisfying(lambda x: chosen(x[0], x[1]), boundaries_only=True)
    edge = FacetBasis(mesh, elements._basis.elem, facets=facets, intorder=DEGREE)
    return np.stack([_load(edge, density, i) for i in range(2)], axis=1)


def l2_distance(elements: FiniteElements, displacement: FloatArray, reference: VectorField) -> float:
    """Root of the integral over the elevation of |displacement - reference|^2 [m2]."""
    basis = Basis(elements._basis.mesh, elements._basis.elem, intorder=DEGREE + 4)
    x, z = basis.global_coordinates()
    exact = np.broadcast_arrays(*reference(x, z), x)[:2]
    errors = [np.array(basis.interpolate(displacement[:, i])) - exact[i] for i in range(2)]
    return float(np.sqrt(sum(np.sum(basis.dx * error**2) for error in errors)))


def _load(basis: Any, density: VectorField, component: int) -> FloatArray:
    @LinearForm
    def form(v: Any, w: Any) -> Any:
        return density(*w.x)[component] * v

    return form.assemble(basis)
