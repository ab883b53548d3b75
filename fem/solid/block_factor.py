"""Factors L D L^T of a symmetric, positive definite matrix of 2 x 2 blocks, one for each pair of nodes.

Which blocks of L exist, and the order of elimination, follow from the mesh: they are found once. The numbers follow
for each matrix, column by column, without pivoting. George and Liu, Computer Solution of Large Sparse Positive
Definite Systems (1981), chapters 5 and 6.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array, tril

from contact.jit import compiled
from contact.structs import struct
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.assembly import factorised

SOURCES = (Path(__file__),)  #: on which the machine code of this module depends


@struct
class BlockPattern(NamedTuple):
    """Which blocks exist; n nodes, in the order of their elimination."""

    place: IntArray  #: (n,) rank of each node in this order
    starts: IntArray  #: (n + 1,) blocks of L below the diagonal, by columns
    rows: IntArray  #: (b,)
    row_starts: IntArray  #: (n + 1,) the same blocks, by rows
    row_columns: IntArray  #: (b,)
    row_blocks: IntArray  #: (b,) where they stand among those by columns
    matrix_starts: IntArray  #: (n + 1,) blocks of the matrix, on and below its diagonal, by columns
    matrix_rows: IntArray  #: (c,)
    matrix_blocks: NDArray[np.integer]  #: (c,) where they stand in the matrix by rows, nodes as in the mesh
    work: FloatArray  #: (n, 4) scratch
    pivots: FloatArray  #: (n, 4) scratch


def block_pattern(matrix: csr_array) -> BlockPattern:
    """For a matrix whose blocks are the entries of this symmetric one (n, n), sorted by columns in each row."""
    n = matrix.shape[0]
    links = csr_array((-np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
    # Diagonally dominant with negative links: no entry of its factor vanishes by chance.
    solver = factorised(links + diags_array(np.diff(matrix.indptr) + 1.0))
    lower = tril(solver.L, -1, format="csc")
    lower.sort_indices()
    place = solver.perm_r.astype(np.int32)
    by_rows = csr_array((np.arange(lower.nnz), lower.indices, lower.indptr), shape=(n, n)).tocsc()
    by_rows.sort_indices()
    row = np.repeat(np.arange(n), np.diff(matrix.indptr))
    below = np.flatnonzero(place[row] >= place[matrix.indices])
    column = place[matrix.indices[below]]
    order = np.lexsort((place[row[below]], column))
    return BlockPattern(
        place=place,
        starts=lower.indptr.astype(np.int32),
        rows=lower.indices.astype(np.int32),
        row_starts=by_rows.indptr.astype(np.int32),
        row_columns=by_rows.indices.astype(np.int32),
        row_blocks=by_rows.data.astype(np.int32),
        matrix_starts=np.searchsorted(column[order], np.arange(n + 1)).astype(np.int32),
        matrix_rows=place[row[below[order]]].astype(np.int32),
        matrix_blocks=below[order],
        work=np.zeros((n, 4)),
        pivots=np.zeros((n, 4)),
    )


@compiled(sources=SOURCES)
def factor_blocks(
    pattern: BlockPattern, matrix: FloatArray, lower: FloatArray, inverse_pivots: FloatArray
) -> None:
    """Factor a matrix of blocks (c, 4), xx, xz, zx, zz, in the order of `matrix_blocks`.

    Written are the blocks (b, 4) of L, and the inverse (n, 4) of D.
    """
    work, pivots, rows = pattern.work, pattern.pivots, pattern.rows
    for j in range(pattern.place.size):
        begin, end = pattern.starts[j], pattern.starts[j + 1]
        for at in range(begin, end):
            for c in range(4):
                work[rows[at], c] = 0.0
        for at in range(pattern.matrix_starts[j], pattern.matrix_starts[j + 1]):
            for c in range(4):
                work[pattern.matrix_rows[at], c] = matrix[at, c]
        for r in range(pattern.row_starts[j], pattern.row_starts[j + 1]):
            k, first = pattern.row_columns[r], pattern.row_blocks[r]
            xx, xz, zx, zz = lower[first, 0], lower[first, 1], lower[first, 2], lower[first, 3]
            dxx, dxz, dzz = pivots[k, 0], pivots[k, 1], pivots[k, 3]
            pxx, pxz = dxx * xx + dxz * xz, dxx * zx + dxz * zz  # D times the transpose of the block
            pzx, pzz = dxz * xx + dzz * xz, dxz * zx + dzz * zz
            for at in range(first, pattern.starts[k + 1]):
                i = rows[at]
                a, b, c, d = lower[at, 0], lower[at, 1], lower[at, 2], lower[at, 3]
                work[i, 0] -= a * pxx + b * pzx
                work[i, 1] -= a * pxz + b * pzz
                work[i, 2] -= c * pxx + d * pzx
                work[i, 3] -= c * pxz + d * pzz
        dxx, dxz, dzz = work[j, 0], work[j, 2], work[j, 3]
        pivots[j, 0], pivots[j, 1], pivots[j, 2], pivots[j, 3] = dxx, dxz, dxz, dzz
        share = 1.0 / (dxx * dzz - dxz * dxz)
        ixx, ixz, izz = share * dzz, -share * dxz, share * dxx
        inverse_pivots[j, 0], inverse_pivots[j, 1] = ixx, ixz
        inverse_pivots[j, 2], inverse_pivots[j, 3] = ixz, izz
        for at in range(begin, end):
            i = rows[at]
            a, b, c, d = work[i, 0], work[i, 1], work[i, 2], work[i, 3]
            lower[at, 0], lower[at, 1] = a * ixx + b * ixz, a * ixz + b * izz
            lower[at, 2], lower[at, 3] = c * ixx + d * ixz, c * ixz + d * izz


@compiled(sources=SOURCES)
def substitute_blocks(
    pattern: BlockPattern, lower: FloatArray, inverse_pivots: FloatArray, vector: FloatArray
) -> None:
    """Solve with the factors of a matrix, in place of the vector (2 n,) in the order of elimination."""
    starts, rows = pattern.starts, pattern.rows
    n = pattern.place.size
    for j in range(n):
        x, z = vector[2 * j], vector[2 * j + 1]
        for at in range(starts[j], starts[j + 1]):
            i = 2 * rows[at]
            vector[i] -= lower[at, 0] * x + lower[at, 1] * z
            vector[i + 1] -= lower[at, 2] * x + lower[at, 3] * z
    for j in range(n - 1, -1, -1):
        ax, az, bx, bz = 0.0, 0.0, 0.0, 0.0
        for at in range(starts[j], starts[j + 1]):
            i = 2 * rows[at]
            x, z = vector[i], vector[i + 1]
            ax += lower[at, 0] * x
            az += lower[at, 1] * x
            bx += lower[at, 2] * z
            bz += lower[at, 3] * z
        x, z = vector[2 * j], vector[2 * j + 1]
        vector[2 * j] = inverse_pivots[j, 0] * x + inverse_pivots[j, 1] * z - (ax + bx)
        vector[2 * j + 1] = inverse_pivots[j, 2] * x + inverse_pivots[j, 3] * z - (az + bz)
