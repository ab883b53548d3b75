"""Finite elements of the container: mass, stiffness and stresses under large rotations, with forms in scikit-fem.

The only door to scikit-fem. Total Lagrangian, plane stress, St. Venant-Kirchhoff (`fem.solid.elasticity`);
four-node bilinear or nine-node biquadratic quadrilaterals on straight-sided cells. 3 x 3 Gauss points, exact
for the mass of both; in bilinear parallelograms 2 x 2, exact for stiffness and mass.
Bathe, Finite Element Procedures (2014), sections 5.3, 5.5 and 6.3.

Axes x to the right, z up. Displacements have shape (n, 2); in vectors and matrices of all unknowns the order
is u_x of node 0, u_z of node 0, u_x of node 1, ...
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array, diags_array
from scipy.sparse.linalg import SuperLU, splu
from skfem import Basis, BilinearForm, ElementQuad1, ElementQuad2, ElementVector, MeshQuad
from skfem.helpers import ddot, sym_grad, trace

from fem.runtime.arrays import FloatArray, IntArray
from fem.solid import elasticity
from mesh.container import ContainerMesh
from mesh.stack import MeshArrays

_ELEMENTS = {1: ElementQuad1, 2: ElementQuad2}
_QUADRATURE_DEGREE = 5  # in each direction: 3 x 3 Gauss points
_ENOUGH_DEGREE = 3  # 2 x 2 points, exact for the stiffness and mass of bilinear parallelograms


@BilinearForm
def _mass_form(u: Any, v: Any, w: Any) -> Any:
    return w.areal_density * u * v


@BilinearForm
def _stiffness_form(u: Any, v: Any, w: Any) -> Any:
    """Linear plane stress: sigma(u) : epsilon(v)."""
    strain, test = sym_grad(u), sym_grad(v)
    return w.thickness * (2.0 * w.shear * ddot(strain, test) + w.first * trace(strain) * trace(test))


@dataclass(frozen=True, kw_only=True, eq=False)
class FiniteElements:
    """The elements of a container: its nodes, its constant matrices and its stresses.

    `nodes[: len(points)]` are the points of the mesh, in their order; order 2 (biquadratic) adds edge and cell middles.
    """

    nodes: FloatArray  #: reference positions of all nodes, shape (n, 2) [m]
    cells: IntArray  #: nodes of each cell in VTK's order (quad, biquadratic quad), shape (m, 4 | 9)
    region: NDArray[np.integer]  #: region of each cell, shape (m,)
    box: NDArray[np.integer]  #: box of each cell, from 0, shape (m,)
    base_nodes: IntArray  #: nodes at z = 0, by rising x
    thickness: NDArray[np.floating]  #: of each cell, out of plane, shape (m,) [m]
    areal_density: NDArray[np.floating]  #: of each cell, shape (m,) [kg per m2 of elevation]
    lame: elasticity.LamePair = field(repr=False)
    _basis: Basis = field(repr=False)

    @property
    def unknowns(self) -> int:
        """Number of displacement components."""
        return 2 * len(self.nodes)

    @cached_property
    def mass(self) -> csr_array:
        """Consistent mass, the same for x and z, shape (n, n) [kg]."""
        density = _at_points(self._basis, self.areal_density)
        return csr_array(_mass_form.assemble(self._basis, areal_density=density))

    @cached_property
    def stiffness(self) -> csc_array:
        """Linear plane stress, shape (2n, 2n), interleaved [N/m]."""
        return csc_array(
            _stiffness_form.assemble(
                self._basis.with_element(ElementVector(self._basis.elem)),
                thickness=_at_points(self._basis, self.thickness),
                first=self.lame.first,
                shear=self.lame.shear,
            )
        )

    @cached_property
    def gradient(self) -> FloatArray:
        """Derivatives of the shape functions along x and z at the points of all cells, shape (2, m, q, k) [1/m]."""
        functions = self._basis.basis
        return np.ascontiguousarray(np.stack([function[0].grad for function in functions], axis=-1))

    @cached_property
    def weights(self) -> FloatArray:
        """Volume of each quadrature point, (m, q) [m3]."""
        return np.ascontiguousarray(self._basis.dx * _at_points(self._basis, self.thickness))

    @cached_property
    def _recovery(self) -> csr_array:
        """Values at the quadrature points -> fitted in each cell, averaged at the nodes, shape (n, m q)."""
        basis, cells, thickness = self._basis, self.cells, np.asarray(self.thickness, dtype=float)
        places = (basis.X, basis.elem.doflocs.T)
        bilinear = [np.stack([np.ones_like(X), X, Z, X * Z], axis=1) for X, Z in places]
        fit = bilinear[1] @ np.linalg.pinv(bilinear[0])  # (k, q)
        greatest = np.zeros(basis.N)
        np.maximum.at(greatest, cells, thickness[:, None])
        thickest = thickness[:, None] >= (1.0 - 1e-9) * greatest[cells]
        share = np.where(thickest, basis.dx.sum(axis=1)[:, None], 0.0)
        values = share[:, :, None] * fit  # (m, k, q)
        rows = np.broadcast_to(cells[:, :, None], values.shape)
        points = np.broadcast_to(np.arange(basis.dx.size).reshape(len(cells), 1, -1), values.shape)
        summed = coo_array((values.ravel(), (rows.ravel(), points.ravel())), shape=(basis.N, basis.dx.size))
        total = np.zeros(basis.N)
        np.add.at(total, cells, share)
        recovery = (diags_array(1.0 / total) @ summed).tocsr()
        recovery.eliminate_zeros()
        return recovery

    @cached_property
    def blocks(self) -> elasticity.CellBlocks:
        """The cells in blocks, for the internal forces."""
        return elasticity.cell_blocks(self.cells, self.gradient, self.weights)

    @cached_property
    def _unit_mass(self) -> FloatArray:
        """Mass of each cell for a unit areal density, shape (m, k, k) [m2]."""
        unit = _at_points(self._basis, np.ones(len(self.cells)))
        return np.asarray(_mass_form.elemental(self._basis, areal_density=unit).tolocal())

    @property
    def nodal_mass(self) -> FloatArray:
        """Row sums of the mass, shape (n,) [kg]."""
        return self.mass @ np.ones(len(self.nodes))

    @cached_property
    def vector_mass(self) -> csc_array:
        """Mass for interleaved unknowns, shape (2n, 2n) [kg]."""
        mass = self.mass.tocoo()
        rows, columns = (np.concatenate([2 * index, 2 * index + 1]) for index in (mass.row, mass.col))
        data = np.tile(mass.data, 2)
        return coo_array((data, (rows, columns)), shape=self.stiffness.shape).tocsc()

    def mass_of(self, cells: IntArray, areal_density: NDArray[np.floating]) -> csr_array:
        """Consistent mass of some cells alone, for the areal density (m,) of all [kg/m2]; shape (n, n) [kg]."""
        masses = areal_density[cells, None, None] * self._unit_mass[cells]
        nodes = np.broadcast_to(self.cells[cells][:, :, None], masses.shape)
        places = nodes.ravel(), nodes.swapaxes(1, 2).ravel()
        return coo_array((masses.ravel(), places), shape=(len(self.nodes), len(self.nodes))).tocsr()

    def nodal_stress(self, displacement: FloatArray) -> FloatArray:
        """Cauchy stress at the nodes, shape (n, 3): xx, zz, xz in the axes of space [Pa].

        In each cell a bilinear field is fitted to the quadrature points and read at the nodes; at a node the
        cells are averaged by area, but only those of the greatest thickness there. So where a wall (thick out
        of plane) meets a sheet, the node shows the wall's stress, not diluted by the sheet's.
        """
        stress = elasticity.cauchy_stress(self.displacement_gradient(displacement), self.lame)
        return self._recovery @ stress.reshape(3, -1).T

    def nodal_von_mises(self, displacement: FloatArray) -> FloatArray:
        """Equivalent stress of `nodal_stress`, shape (n,) [Pa]."""
        return elasticity.von_mises(self.nodal_stress(displacement).T)

    def displacement_gradient(self, displacement: FloatArray) -> FloatArray:
        """H_ij = d u_i / d X_j at the quadrature points, shape (2, 2, m, q)."""
        return np.einsum("jcqb,cbi->ijcq", self.gradient, np.asarray(displacement)[self.cells], optimize=True)


def assemble(
    mesh: ContainerMesh | MeshArrays, *, youngs_modulus: float, poisson_ratio: float, order: int
) -> FiniteElements:
    """The finite elements of a mesh, assembled on first use; ValueError: elastic constants out of range."""
    lame = elasticity.plane_stress_lame(youngs_modulus, poisson_ratio)
    points = np.ascontiguousarray(np.asarray(mesh.points, dtype=float).T)
    quads = np.ascontiguousarray(np.asarray(mesh.quads, dtype=np.int64).T)
    a, b, c, d = (points[:, corner] for corner in quads)
    skewed = np.abs(a - b + c - d).max() > 1e-9 * np.ptp(points, axis=1).max()
    degree = _QUADRATURE_DEGREE if order == 2 or skewed else _ENOUGH_DEGREE
    basis = Basis(MeshQuad(points, quads), _ELEMENTS[order](), intorder=degree)
    cells = np.ascontiguousarray(basis.element_dofs.T).astype(np.int64)
    nodes = np.ascontiguousarray(basis.doflocs.T)
    nodes[: len(mesh.points)] = mesh.points  # exactly, not through the mapping
    base = np.flatnonzero(np.abs(nodes[:, 1]) <= 1e-9 * np.ptp(nodes[:, 1]))
    return FiniteElements(
        nodes=nodes,
        cells=cells,
        region=np.asarray(mesh.region),
        box=np.asarray(mesh.box),
        base_nodes=base[np.argsort(nodes[base, 0], kind="stable")],
        thickness=mesh.thickness,
        areal_density=mesh.areal_density,
        lame=lame,
        _basis=basis,
    )


def factorised(matrix: csc_array) -> SuperLU:
    """Factors of a symmetric, positive definite matrix; with pivots on the diagonal, a third of the usual fill."""
    return splu(
        matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )


def _at_points(basis: Basis, values: NDArray[np.floating]) -> FloatArray:
    """One value a cell, repeated at its quadrature points, shape (m, q)."""
    return np.repeat(np.asarray(values, dtype=float)[:, None], basis.X.shape[1], axis=1)
