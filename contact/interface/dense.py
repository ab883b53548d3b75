"""LU decomposition of a small dense matrix in place: numpy's would allocate, which no kernel may do."""

from contact.arrays import FloatArray, IntArray
from contact.jit import compiled


@compiled(inline=True)
def factor_dense(size: int, matrix: FloatArray, pivot: IntArray) -> bool:
    """LU decomposition with row pivoting of the leading size x size block, in place; False if singular."""
    for k in range(size):
        chosen, largest = k, abs(matrix[k, k])
        for i in range(k + 1, size):
            if abs(matrix[i, k]) > largest:
                chosen, largest = i, abs(matrix[i, k])
        pivot[k] = chosen
        if not largest > 0.0:
            return False
        if chosen != k:
            for j in range(size):
                matrix[k, j], matrix[chosen, j] = matrix[chosen, j], matrix[k, j]
        for i in range(k + 1, size):
            factor = matrix[i, k] / matrix[k, k]
            matrix[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, size):
                    matrix[i, j] -= factor * matrix[k, j]
    return True


@compiled(inline=True)
def substitute_dense(size: int, factors: FloatArray, pivot: IntArray, vector: FloatArray) -> None:
    """Solve with the factors of `factor_dense`, in place."""
    for k in range(size):
        if pivot[k] != k:
            vector[k], vector[pivot[k]] = vector[pivot[k]], vector[k]
    for k in range(1, size):
        total = vector[k]
        for j in range(k):
            total -= factors[k, j] * vector[j]
        vector[k] = total
    for k in range(size - 1, -1, -1):
        total = vector[k]
        for j in range(k + 1, size):
            total -= factors[k, j] * vector[j]
        vector[k] = total / factors[k, k]
