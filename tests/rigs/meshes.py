"""Meshes of the checks, and what verification asks of their elements and no run does: loads, force and tangent, errors.

Loads point along +x and +z; the internal force is the gradient of the strain energy: in equilibrium it is the load.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array
from skfem import Basis, FacetBasis, LinearForm

from fem.runtime.arrays import FloatArray
from fem.solid import elasticity
from fem.solid.assembly import FiniteElements
from mesh.container import ContainerMesh, grid_quads
from mesh.elevation import Elevation
from mesh.region import Region
from mesh.stack import MeshArrays

Mapping = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
#: a field over the elevation: (x, z) of any shape (...) -> the two components, shape (2, ...)
VectorField = Callable[[FloatArray, FloatArray], Any]
#: (x, z) of the midpoints of edges -> whether each edge is chosen
EdgeChoice = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]
DEGREE = 5  #: of the quadrature


def mapped_mesh(
    columns: int, rows: int, mapping: Mapping, *, thickness: float = 1.0, density: float = 1.0
) -> MeshArrays:
    """Quads on the image of the unit square under `mapping`(s, t), sizes in m; density in kg/m3."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, columns + 1), np.linspace(0.0, 1.0, rows + 1))
    quads = grid_quads(columns, rows)
    full = np.ones(len(quads))
    return MeshArrays(
        points=np.stack(mapping(s.ravel(), t.ravel()), axis=1),
        quads=quads,
        region=np.zeros(len(quads), dtype=np.int64),
        box=np.zeros(len(quads), dtype=np.int64),
        thickness=thickness * full,
        areal_density=density * thickness * full,
    )


def grid_mesh(
    x: FloatArray, z: FloatArray, *, depth: float, areal_density: float | FloatArray
) -> ContainerMesh:
    """A solid block with mesh lines at x and z [m]; areal density in kg/m2 of the elevation, or of each element.

    Elements are counted row by row, from the base up.
    """
    quads = grid_quads(x.size - 1, z.size - 1)
    return ContainerMesh(
        elevation=Elevation(np.column_stack([np.tile(x, z.size), np.repeat(z, x.size)]), quads),
        region=np.full(len(quads), int(Region.SOLID)),
        box=np.zeros(len(quads), dtype=np.int64),
        thickness=np.full(len(quads), depth),
        areal_density=np.full(len(quads), areal_density),
    )


def graded_block() -> ContainerMesh:
    """A block of 1.1 x 1.0 m, columns narrowing toward both ends."""
    x = 0.55 * np.sin(0.5 * np.pi * np.linspace(-1.0, 1.0, 9))
    return grid_mesh(x, np.linspace(0.0, 1.0, 6), depth=0.5, areal_density=1000.0)


def force_and_energy(elements: FiniteElements, displacement: FloatArray) -> tuple[FloatArray, float]:
    """Gradient of the strain energy by the displacements (n, 2) [N], and the energy itself [J]."""
    blocks, force = elasticity.with_own_scratch(elements.blocks), np.empty_like(elements.nodes)
    values = np.ascontiguousarray(displacement, dtype=float)
    return force, elasticity.element_forces(blocks, elements.lame.first, elements.lame.shear, values, force)


def internal_force(elements: FiniteElements, displacement: FloatArray) -> FloatArray:
    """Gradient of the strain energy, shape (n, 2) [N]."""
    return force_and_energy(elements, displacement)[0]


def tangent(elements: FiniteElements, displacement: FloatArray) -> csc_array:
    """Derivative of `internal_force`, shape (2n, 2n), interleaved [N/m].

    Of P = F S: d P_ij / d H_kl = delta_ik S_jl + first F_ij F_kl + shear (F_il F_kj + (F F^T)_ik delta_jl).
    """
    gradient, lame = elements.displacement_gradient(displacement), elements.lame
    sxx, szz, sxz = elasticity.second_stress(elasticity.green_strain(gradient), lame)
    stress = ((sxx, sxz), (sxz, szz))
    deformation = gradient + np.eye(2)[:, :, None, None]
    moduli = lame.first * np.einsum("ij...,kl...->ijkl...", deformation, deformation)
    moduli += lame.shear * np.einsum("il...,kj...->ijkl...", deformation, deformation)
    left = lame.shear * np.einsum("im...,km...->ik...", deformation, deformation)
    for j in range(2):
        moduli[:, j, :, j] += left
        for i, n in np.ndindex(2, 2):
            moduli[i, j, i, n] += stress[j][n]
    moduli *= elements.weights
    cells, k = elements.cells.shape
    rows = elements.gradient.transpose(1, 3, 0, 2).reshape(cells, k, -1)
    blocks = np.empty((cells, k, 2, k, 2))
    for i, p in np.ndindex(2, 2):
        columns = np.einsum("jlcq,lcqb->cjqb", moduli[i, :, p], elements.gradient).reshape(cells, -1, k)
        blocks[:, :, i, :, p] = rows @ columns
    unknowns = (2 * elements.cells[:, :, None] + np.arange(2)).reshape(cells, -1)
    positions = (np.repeat(unknowns, 2 * k, axis=1).ravel(), np.tile(unknowns, 2 * k).ravel())
    return coo_array((blocks.ravel(), positions), shape=elements.stiffness.shape).tocsc()


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
