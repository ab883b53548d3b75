"""Products and sums over the nodes of a mesh, each in one pass: what a step of the full model spends its time on.

scipy would read a matrix twice for the two components of a field, and spends on the call what the product itself
takes.
"""

import numpy as np
from numba import njit
from scipy.sparse import csr_array

from mesh.cells import FloatArray, IntArray


def times_columns(matrix: csr_array, field: FloatArray, out: FloatArray) -> None:
    """out[i] = matrix @ field[:, i] for i = 0, 1: field (n, 2), out (2, m)."""
    _times_field(matrix.indptr, matrix.indices, matrix.data, field, out.T)


def times_rows(matrix: csr_array, field: FloatArray, out: FloatArray) -> None:
    """out[:, i] = matrix @ field[i] for i = 0, 1: field (2, n), out (m, 2)."""
    _times_field(matrix.indptr, matrix.indices, matrix.data, field.T, out)


def times_field(matrix: csr_array, field: FloatArray) -> FloatArray:
    """matrix @ field for a field (n, 2) of two components."""
    out = np.empty((matrix.shape[0], 2))
    _times_field(matrix.indptr, matrix.indices, matrix.data, field, out)
    return out


@njit(cache=True)
def sums_of_position(nodal_mass: FloatArray, mass_arm: FloatArray, position: FloatArray) -> FloatArray:
    """Moments of positions (n, 2): with the masses (n,) x and z [kg m], with M X (n, 2) along and across [kg m2].

    Along and across are cosine and sine of the mass-weighted best-fit rotation, times the inertia.
    """
    x, z, along, across = 0.0, 0.0, 0.0, 0.0
    for i in range(nodal_mass.size):
        x += nodal_mass[i] * position[i, 0]
        z += nodal_mass[i] * position[i, 1]
        along += mass_arm[i, 0] * position[i, 0] + mass_arm[i, 1] * position[i, 1]
        across += mass_arm[i, 1] * position[i, 0] - mass_arm[i, 0] * position[i, 1]
    return np.array([x, z, along, across])


@njit(cache=True)
def sums_of_momentum(
    momentum: FloatArray, position: FloatArray, velocity: FloatArray, centre: FloatArray
) -> FloatArray:
    """Momentum along x and z [kg m/s], angular momentum about `centre` [kg m2/s] and twice the kinetic energy [J].

    Of nodal momenta M v, positions and velocities (n, 2); rotation > 0 toward +x.
    """
    x, z, spin, twice = 0.0, 0.0, 0.0, 0.0
    for i in range(momentum.shape[0]):
        x += momentum[i, 0]
        z += momentum[i, 1]
        spin += (position[i, 1] - centre[1]) * momentum[i, 0] - (position[i, 0] - centre[0]) * momentum[i, 1]
        twice += momentum[i, 0] * velocity[i, 0] + momentum[i, 1] * velocity[i, 1]
    return np.array([x, z, spin, twice])


@njit(cache=True)
def _times_field(
    starts: IntArray, columns: IntArray, values: FloatArray, field: FloatArray, out: FloatArray
) -> None:
    for row in range(starts.size - 1):
        first, second = 0.0, 0.0
        for k in range(starts[row], starts[row + 1]):
            first += values[k] * field[columns[k], 0]
            second += values[k] * field[columns[k], 1]
        out[row, 0], out[row, 1] = first, second
