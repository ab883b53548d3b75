"""LU decomposition of a small dense matrix in place: numpy's would allocate, which no kernel may do."""

from contact.arrays import FloatArray, IntArray
from contact.jit import compiled

SMALL = 8  #: size up to which columns are eliminated one by one
TINY = 4  #: size up to which rows are exchanged by constant indices, see `contact.local_arrays`


@compiled(inline=True)
def take_pivot(size: int, matrix: FloatArray, pivot: IntArray, k: int) -> bool:
    """Bring the row with the largest entry of column k to row k; False if there is none."""
    chosen, largest = k, abs(matrix[k, k])
    for i in range(k + 1, size):
        if abs(matrix[i, k]) > largest:
            chosen, largest = i, abs(matrix[i, k])
    pivot[k] = chosen
    if not largest > 0.0:
        return False
    if size <= TINY:
        for i in range(k + 1, size):
            if chosen == i:
                for j in range(size):
                    matrix[k, j], matrix[i, j] = matrix[i, j], matrix[k, j]
    elif chosen != k:
        for j in range(size):
            matrix[k, j], matrix[chosen, j] = matrix[chosen, j], matrix[k, j]
    return True


@compiled
def eliminate_pair(size: int, matrix: FloatArray, pivot: IntArray, k: int) -> bool:
    """Eliminate columns k and k + 1 in one pass over the rest, whose sums keep their order: the same bits."""
    if not take_pivot(size, matrix, pivot, k):
        return False
    for i in range(k + 1, size):
        matrix[i, k] /= matrix[k, k]
        matrix[i, k + 1] -= matrix[i, k] * matrix[k, k + 1]
    if not take_pivot(size, matrix, pivot, k + 1):
        return False
    # Slices begin at zero, so that the compiler takes several columns at once.
    first, second = matrix[k, k + 2 : size], matrix[k + 1, k + 2 : size]
    factor = matrix[k + 1, k]
    for j in range(second.size):
        second[j] -= factor * first[j]
    for i in range(k + 2, size):
        matrix[i, k + 1] /= matrix[k + 1, k + 1]
        factor, other, row = matrix[i, k], matrix[i, k + 1], matrix[i, k + 2 : size]
        for j in range(row.size):
            row[j] = row[j] - factor * first[j] - other * second[j]
    return True


@compiled(inline=True)
def eliminate_column(size: int, matrix: FloatArray, pivot: IntArray, k: int) -> bool:
    """Eliminate column k; False if there is no pivot."""
    if not take_pivot(size, matrix, pivot, k):
        return False
    for i in range(k + 1, size):
        factor = matrix[i, k] / matrix[k, k]
        matrix[i, k] = factor
        if factor != 0.0:
            for j in range(k + 1, size):
                matrix[i, j] -= factor * matrix[k, j]
    return True


@compiled(inline=True)
def factor_dense(size: int, matrix: FloatArray, pivot: IntArray) -> bool:
    """LU decomposition with row pivoting of the leading size x size block, in place; False if singular."""
    done = 0
    while size - done > SMALL:
        if not eliminate_pair(size, matrix, pivot, done):
            return False
        done += 2
    regular = True
    for k in range(done, size):
        regular = regular and eliminate_column(size, matrix, pivot, k)
    return regular


@compiled(inline=True)
def exchange_entry(size: int, pivot: IntArray, vector: FloatArray, k: int) -> None:
    """Exchange entry k as the rows of the matrix."""
    if size <= TINY:
        for i in range(k + 1, size):
            if pivot[k] == i:
                vector[k], vector[i] = vector[i], vector[k]
    elif pivot[k] != k:
        vector[k], vector[pivot[k]] = vector[pivot[k]], vector[k]


@compiled(inline=True)
def substitute_entry(
    begin: int, end: int, factors: FloatArray, vector: FloatArray, k: int, diagonal: float
) -> None:
    """Take the known entries from `begin` to `end` from entry k, and divide by the diagonal."""
    total = vector[k]
    for j in range(begin, end):
        total -= factors[k, j] * vector[j]
    vector[k] = total / diagonal


@compiled(inline=True)
def substitute_dense(size: int, factors: FloatArray, pivot: IntArray, vector: FloatArray) -> None:
    """Solve with the factors of `factor_dense`, in place."""
    for k in range(size):
        exchange_entry(size, pivot, vector, k)
    for k in range(1, size):
        substitute_entry(0, k, factors, vector, k, 1.0)
    for k in range(size - 1, -1, -1):
        substitute_entry(k + 1, size, factors, vector, k, factors[k, k])


@compiled(inline=True)
def factor_four(matrix: FloatArray, pivot: IntArray) -> bool:
    """`factor_dense` of four rows, without a loop over the columns: all indices are constants."""
    first = eliminate_column(4, matrix, pivot, 0) and eliminate_column(4, matrix, pivot, 1)
    return first and eliminate_column(4, matrix, pivot, 2) and eliminate_column(4, matrix, pivot, 3)


@compiled(inline=True)
def substitute_four(factors: FloatArray, pivot: IntArray, vector: FloatArray) -> None:
    """Solve with the factors of `factor_four`, in place."""
    exchange_entry(4, pivot, vector, 0)
    exchange_entry(4, pivot, vector, 1)
    exchange_entry(4, pivot, vector, 2)
    substitute_entry(0, 1, factors, vector, 1, 1.0)
    substitute_entry(0, 2, factors, vector, 2, 1.0)
    substitute_entry(0, 3, factors, vector, 3, 1.0)
    substitute_entry(4, 4, factors, vector, 3, factors[3, 3])
    substitute_entry(3, 4, factors, vector, 2, factors[2, 2])
    substitute_entry(2, 4, factors, vector, 1, factors[1, 1])
    substitute_entry(1, 4, factors, vector, 0, factors[0, 0])
