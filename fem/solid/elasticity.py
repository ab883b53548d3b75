"""Plane-stress elasticity: strain, stress and energy as pure functions of the displacement gradient.

St. Venant-Kirchhoff material in total Lagrangian form: small strains, any rotation. Holzapfel, Nonlinear
Solid Mechanics (2000), sections 2.4, 3.1 and 6.5; plane stress as for a thin sheet.
Gradients have shape (2, 2, ...) with `gradient[i, j]` = d u_i / d X_j, i and j running over x, z; symmetric
tensors have shape (3, ...) in the order xx, zz, xz (the tensor's component, not twice it). Tension is
positive.
"""

from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
from numba.extending import register_jitable

from contact.jit import compiled
from contact.structs import struct
from fem.runtime.arrays import FloatArray, IntArray

SOURCES = (Path(__file__),)  #: on which the machine code of this module depends
LANES = 64  #: cells of a block
Real = TypeVar("Real", float, FloatArray)


@struct
class LamePair(NamedTuple):
    """The two Lamé constants of plane stress [Pa]."""

    first: float  #: multiplies the trace of the in-plane strain
    shear: float  #: shear modulus


def plane_stress_lame(youngs_modulus: float, poisson_ratio: float) -> LamePair:
    """Lamé pair for which 2 shear E + first tr(E) I is the plane-stress law [Pa]; ValueError: constants out of range.

    Timoshenko and Goodier, Theory of Elasticity (1970), section 16, solved for the stresses.
    """
    if not 0.0 < youngs_modulus < np.inf:
        raise ValueError(f"Young's modulus must be positive and finite, got {youngs_modulus} Pa")
    if not -1.0 < poisson_ratio <= 0.5:
        raise ValueError(f"Poisson's ratio must be above -1 and at most 0.5, got {poisson_ratio}")
    return LamePair(
        youngs_modulus * poisson_ratio / (1.0 - poisson_ratio**2),
        youngs_modulus / (2.0 * (1.0 + poisson_ratio)),
    )


@register_jitable
def strain_components(xx: Real, xz: Real, zx: Real, zz: Real) -> tuple[Real, Real, Real]:
    """Green-Lagrange strain (H + H^T + H^T H)/2 of a gradient's components, xx, zz, xz [-].

    Written in the gradient and not in F^T F - I, so that a strain of 1e-12 is not lost beside a small rotation;
    a large rotation leaves a rounding error of a few 1e-16. For numbers and arrays.
    """
    return (
        xx + 0.5 * (xx * xx + zx * zx),
        zz + 0.5 * (zz * zz + xz * xz),
        0.5 * (xz + zx + xx * xz + zx * zz),
    )


@register_jitable
def stress_components(xx: Real, zz: Real, xz: Real, first: float, shear: float) -> tuple[Real, Real, Real]:
    """Second Piola-Kirchhoff stress of St. Venant and Kirchhoff from the strain, xx, zz, xz [Pa]."""
    trace = first * (xx + zz)
    return 2.0 * shear * xx + trace, 2.0 * shear * zz + trace, 2.0 * shear * xz


@register_jitable
def energy_of_strain(xx: Real, zz: Real, xz: Real, first: float, shear: float) -> Real:
    """Strain energy per reference volume, shear E:E + first tr(E)^2/2 [J/m3]; never negative."""
    return shear * (xx * xx + zz * zz + 2.0 * xz * xz) + 0.5 * first * (xx + zz) ** 2


@register_jitable
def stress_and_energy(
    xx: Real, xz: Real, zx: Real, zz: Real, first: float, shear: float
) -> tuple[Real, Real, Real, Real, Real]:
    """First Piola-Kirchhoff stress P = F S, xx, xz, zx, zz, force axis first [Pa], and energy [J/m3], of a gradient."""
    exx, ezz, exz = strain_components(xx, xz, zx, zz)
    sxx, szz, sxz = stress_components(exx, ezz, exz, first, shear)
    return (
        (1.0 + xx) * sxx + xz * sxz,
        (1.0 + xx) * sxz + xz * szz,
        zx * sxx + (1.0 + zz) * sxz,
        zx * sxz + (1.0 + zz) * szz,
        energy_of_strain(exx, ezz, exz, first, shear),
    )


def green_strain(gradient: FloatArray) -> FloatArray:
    """Green-Lagrange strain, shape (3, ...) [-]."""
    (xx, xz), (zx, zz) = gradient
    return np.stack(strain_components(xx, xz, zx, zz))


def second_stress(strain: FloatArray, lame: LamePair) -> FloatArray:
    """Second Piola-Kirchhoff stress, shape (3, ...) [Pa]."""
    xx, zz, xz = strain
    return np.stack(stress_components(xx, zz, xz, lame.first, lame.shear))


@struct
class CellBlocks(NamedTuple):
    """The cells in blocks of `LANES`, for instructions on several at once; cells without volume fill the last."""

    number: int  #: m, of cells
    cells: IntArray  #: (m / LANES, k, LANES) their nodes
    #: (m / LANES, q, k, 2, LANES) derivatives of the shape functions along x and z [1/m]
    gradient: FloatArray
    weights: FloatArray  #: (m / LANES, q, LANES) volumes [m3]
    nodal: FloatArray  #: (4 k, LANES) scratch: displacements and forces of the nodes
    local: FloatArray  #: (5 LANES,) scratch: gradient, then stress and energy at a point


def cell_blocks(cells: IntArray, gradient: FloatArray, weights: FloatArray) -> CellBlocks:
    """Cells (m, k), derivatives of their shape functions (2, m, q, k) and volumes (m, q) in blocks."""
    (m, k), q = cells.shape, weights.shape[1]
    blocks = -(-m // LANES)
    row = np.minimum(np.arange(blocks * LANES), m - 1)
    volumes = np.where((np.arange(row.size) < m)[:, None], weights[row], 0.0)
    return CellBlocks(
        number=m,
        cells=np.ascontiguousarray(cells[row].reshape(blocks, LANES, k).transpose(0, 2, 1)),
        gradient=np.ascontiguousarray(
            gradient[:, row].reshape(2, blocks, LANES, q, k).transpose(1, 3, 4, 0, 2)
        ),
        weights=np.ascontiguousarray(volumes.reshape(blocks, LANES, q).transpose(0, 2, 1)),
        nodal=np.zeros((4 * k, LANES)),
        local=np.zeros(5 * LANES),
    )


def with_own_scratch(blocks: CellBlocks) -> CellBlocks:
    """The same cells for another thread."""
    return blocks._replace(nodal=np.zeros_like(blocks.nodal), local=np.zeros_like(blocks.local))


@compiled(sources=SOURCES)
def element_forces(
    blocks: CellBlocks, first: float, shear: float, displacement: FloatArray, out: FloatArray
) -> float:
    """Gradient of the strain energy by the displacements (n, 2), into `out` [N], and the energy [J]."""
    _, k, _ = blocks.cells.shape
    points, nodal, local = blocks.weights.shape[1], blocks.nodal, blocks.local
    energy = 0.0
    for i in range(out.shape[0]):
        out[i, 0], out[i, 1] = 0.0, 0.0
    for c in range(blocks.cells.shape[0]):
        for b in range(k):
            cells, u, w = blocks.cells[c, b], nodal[4 * b], nodal[4 * b + 1]
            along, up = nodal[4 * b + 2], nodal[4 * b + 3]
            for lane in range(LANES):
                u[lane], w[lane] = displacement[cells[lane], 0], displacement[cells[lane], 1]
                along[lane], up[lane] = 0.0, 0.0
        for q in range(points):
            for lane in range(4 * LANES):
                local[lane] = 0.0
            for b in range(k):
                by_x, by_z = blocks.gradient[c, q, b, 0], blocks.gradient[c, q, b, 1]
                u, w = nodal[4 * b], nodal[4 * b + 1]
                for lane in range(LANES):
                    local[lane] += by_x[lane] * u[lane]
                    local[LANES + lane] += by_z[lane] * u[lane]
                    local[2 * LANES + lane] += by_x[lane] * w[lane]
                    local[3 * LANES + lane] += by_z[lane] * w[lane]
            weights = blocks.weights[c, q]
            for lane in range(LANES):
                xx, xz = local[lane], local[LANES + lane]
                zx, zz = local[2 * LANES + lane], local[3 * LANES + lane]
                xx, xz, zx, zz, density = stress_and_energy(xx, xz, zx, zz, first, shear)
                weight = weights[lane]
                local[lane], local[LANES + lane] = weight * xx, weight * xz
                local[2 * LANES + lane], local[3 * LANES + lane] = weight * zx, weight * zz
                local[4 * LANES + lane] = weight * density
            for lane in range(LANES):
                energy += local[4 * LANES + lane]
            for b in range(k):
                by_x, by_z = blocks.gradient[c, q, b, 0], blocks.gradient[c, q, b, 1]
                along, up = nodal[4 * b + 2], nodal[4 * b + 3]
                for lane in range(LANES):
                    along[lane] += by_x[lane] * local[lane] + by_z[lane] * local[LANES + lane]
                    up[lane] += by_x[lane] * local[2 * LANES + lane] + by_z[lane] * local[3 * LANES + lane]
        for b in range(k):
            cells, along, up = blocks.cells[c, b], nodal[4 * b + 2], nodal[4 * b + 3]
            for lane in range(min(LANES, blocks.number - c * LANES)):
                out[cells[lane], 0] += along[lane]
                out[cells[lane], 1] += up[lane]
    return energy


def least_principal_strain(gradient: FloatArray) -> float:
    """Smallest principal value of the linear strain over gradients of shape (2, 2, ...) [-]; < 0 in compression."""
    (xx, xz), (zx, zz) = gradient
    return float(np.min(0.5 * (xx + zz) - np.hypot(0.5 * (xx - zz), 0.5 * (xz + zx))))


def least_volume_ratio(gradient: FloatArray) -> float:
    """Smallest det(1 + H) over gradients of shape (2, 2, ...) [-]; an element with a value <= 0 is inverted."""
    (xx, xz), (zx, zz) = gradient
    return float(np.min((1.0 + xx) * (1.0 + zz) - xz * zx))


def cauchy_stress(gradient: FloatArray, lame: LamePair) -> FloatArray:
    """True stress F S F^T / J in the axes of space, not of the body, shape (3, ...) [Pa].

    J includes the stretch of the thickness, sqrt(1 - (first/shear) tr(E)), which is free in plane stress.
    The stress is nan where the strain is so large that the thickness would vanish (tr(E) beyond shear/first).
    """
    strain = green_strain(gradient)
    sxx, szz, sxz = second_stress(strain, lame)
    xx, xz = 1.0 + gradient[0, 0], gradient[0, 1]
    zx, zz = gradient[1, 0], 1.0 + gradient[1, 1]
    with np.errstate(invalid="ignore"):
        thickness_stretch = np.sqrt(1.0 - lame.first / lame.shear * (strain[0] + strain[1]))
    volume = (xx * zz - xz * zx) * thickness_stretch
    stress = np.empty_like(strain)
    stress[0] = (xx * xx * sxx + 2.0 * xx * xz * sxz + xz * xz * szz) / volume
    stress[1] = (zx * zx * sxx + 2.0 * zx * zz * sxz + zz * zz * szz) / volume
    stress[2] = (xx * zx * sxx + (xx * zz + xz * zx) * sxz + xz * zz * szz) / volume
    return stress


def von_mises(stress: FloatArray) -> FloatArray:
    """Equivalent stress of plane stress, sqrt(sx^2 - sx sz + sz^2 + 3 t^2), shape (...) [Pa]."""
    xx, zz, xz = stress
    return np.sqrt(xx * xx - xx * zz + zz * zz + 3.0 * xz * xz)
