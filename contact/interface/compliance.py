"""Compliance of contact points: of modes and of a turned body; displacements under forces; the tangent of the contact.

Arrays as in `contact.interface.solver`.
"""

from contact.arrays import FloatArray, IntArray
from contact.interface.workspace import Workspace
from contact.jit import compiled

FEW_POINTS = 2  #: up to so many, the rows of the compliance are taken one by one
#: LU: size up to which columns are eliminated one by one, and rows are exchanged by constant indices
SMALL, TINY = 8, 4
WORTH_KEEPING = 5  #: active points from which an old factorisation is reused before a new one is computed


@compiled(inline=True)
def add_modes(across: FloatArray, amplitude: FloatArray, out: FloatArray) -> None:
    """Add displacements (2 n,) of modes (m, 2 n) with these amplitudes, four at a time in the order of the modes."""
    if out.size == 4:  # two points, a loop of fixed length
        w, x, y, z = out[0], out[1], out[2], out[3]
        for k in range(amplitude.size):
            by = amplitude[k]
            w += across[k, 0] * by
            x += across[k, 1] * by
            y += across[k, 2] * by
            z += across[k, 3] * by
        out[0], out[1], out[2], out[3] = w, x, y, z
        return
    blocks = amplitude.size // 4
    for block in range(blocks):
        k = 4 * block
        first, second, third, fourth = across[k], across[k + 1], across[k + 2], across[k + 3]
        w, x, y, z = amplitude[k], amplitude[k + 1], amplitude[k + 2], amplitude[k + 3]
        for a in range(out.size):
            out[a] = out[a] + first[a] * w + second[a] * x + third[a] * y + fourth[a] * z
    for k in range(4 * blocks, amplitude.size):
        first, w = across[k], amplitude[k]
        for a in range(out.size):
            out[a] += first[a] * w


@compiled
def condense_modes(across: FloatArray, inverse: FloatArray, out: FloatArray) -> None:
    """Compliance (2 n, 2 n) of modes (m, 2 n) with these inverse effective masses (m,), four modes at a time."""
    blocks = inverse.size // 4
    for a in range(out.shape[0]):
        row = out[a, a:]  # slices begin at zero, so that the compiler takes several columns at once
        for b in range(row.size):
            row[b] = 0.0
        for block in range(blocks):
            k = 4 * block
            first, second, third, fourth = (
                across[k, a:],
                across[k + 1, a:],
                across[k + 2, a:],
                across[k + 3, a:],
            )
            w, x, y, z = first[0], second[0], third[0], fourth[0]
            by_w, by_x, by_y, by_z = inverse[k], inverse[k + 1], inverse[k + 2], inverse[k + 3]
            for b in range(row.size):
                row[b] = (
                    row[b]
                    + w * first[b] * by_w
                    + x * second[b] * by_x
                    + y * third[b] * by_y
                    + z * fourth[b] * by_z
                )
        for k in range(4 * blocks, inverse.size):
            first, by_w = across[k, a:], inverse[k]
            w = first[0]
            for b in range(row.size):
                row[b] += w * first[b] * by_w
        for b in range(row.size):
            out[a + b, a] = row[b]


@compiled(inline=True)
def add_turned(compliance: FloatArray, cosine: float, sine: float, share: float, out: FloatArray) -> None:
    """Add `share` R C R^T of every 2 x 2 block of a compliance (2 n, 2 n), R = [[cos, sin], [-sin, cos]]."""
    for i in range(compliance.shape[0] // 2):
        for j in range(compliance.shape[1] // 2):
            xx, xz = compliance[2 * i, 2 * j], compliance[2 * i, 2 * j + 1]
            zx, zz = compliance[2 * i + 1, 2 * j], compliance[2 * i + 1, 2 * j + 1]
            ax, az = cosine * xx + sine * zx, cosine * xz + sine * zz
            bx, bz = -sine * xx + cosine * zx, -sine * xz + cosine * zz
            out[2 * i, 2 * j] += share * (ax * cosine + az * sine)
            out[2 * i, 2 * j + 1] += share * (-ax * sine + az * cosine)
            out[2 * i + 1, 2 * j] += share * (bx * cosine + bz * sine)
            out[2 * i + 1, 2 * j + 1] += share * (-bx * sine + bz * cosine)


@compiled
def turned_compliance(
    elastic: FloatArray,
    arm: FloatArray,
    cosine: float,
    sine: float,
    share: float,
    drift: float,
    turn: float,
    out: FloatArray,
) -> None:
    """Compliance (2 n, 2 n) of many points: that of the rigid body and a share of that of the modes, as `add_turned`.

    `arm`: (n, 2) points from the mass centre [m]; `drift`: compliance of the body against a force [m/N], `turn` against
    a moment [1/(N m)]. Blocks below the diagonal follow from those above it.
    """
    for i in range(arm.shape[0]):
        along, up = elastic[2 * i], elastic[2 * i + 1]
        x, z = out[2 * i], out[2 * i + 1]
        by_x, by_z = turn * arm[i, 0], turn * arm[i, 1]
        for j in range(i, arm.shape[0]):
            a, b = 2 * j, 2 * j + 1
            ax, az = cosine * along[a] + sine * up[a], cosine * along[b] + sine * up[b]
            bx, bz = cosine * up[a] - sine * along[a], cosine * up[b] - sine * along[b]
            xx = drift + by_z * arm[j, 1] + share * (ax * cosine + az * sine)
            xz = -by_z * arm[j, 0] + share * (az * cosine - ax * sine)
            zx = -by_x * arm[j, 1] + share * (bx * cosine + bz * sine)
            zz = drift + by_x * arm[j, 0] + share * (bz * cosine - bx * sine)
            x[a], x[b], z[a], z[b] = xx, xz, zx, zz
            out[a, 2 * i], out[b, 2 * i], out[a, 2 * i + 1], out[b, 2 * i + 1] = xx, xz, zx, zz


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
def move_points(velocity_slope: float, force: FloatArray, work: Workspace) -> None:
    """Points and velocities that follow from contact forces, by the condensed compliance."""
    n = force.shape[0]
    if n > FEW_POINTS:
        for a in range(work.solution.size):
            work.solution[a] = 0.0
        for j in range(n):  # by columns of the symmetric compliance: several rows at once
            along, up = force[j, 0], force[j, 1]
            if up != 0.0 or along != 0.0:
                for a in range(work.solution.size):
                    work.solution[a] += work.compliance[2 * j, a] * along + work.compliance[2 * j + 1, a] * up
        for i in range(n):
            for k in range(2):
                moved = work.solution[2 * i + k]
                work.point[i, k] = work.free[i, k] + moved
                work.velocity[i, k] = work.free_velocity[i, k] + velocity_slope * moved
        return
    for i in range(n):
        for k in range(2):
            moved = 0.0
            for j in range(n):
                if force[j, 1] != 0.0 or force[j, 0] != 0.0:
                    moved += work.compliance[2 * i + k, 2 * j] * force[j, 0]
                    moved += work.compliance[2 * i + k, 2 * j + 1] * force[j, 1]
            work.point[i, k] = work.free[i, k] + moved
            work.velocity[i, k] = work.free_velocity[i, k] + velocity_slope * moved


@compiled(inline=True)
def has_tangent(work: Workspace, i: int) -> bool:
    """Whether the law of a point has a tangent: where the floor crushes, a stuck point has the tangential one."""
    return work.slope[i, 2] != 0.0 or work.slope[i, 0] != 0.0


@compiled(inline=True)
def factor_is_current(step: float, work: Workspace) -> bool:
    """Whether the factors were computed for these tangents and this step size; the body has turned since then."""
    if work.factored_step[0] != step or work.factored_count[0] < WORTH_KEEPING:
        return False
    for i in range(work.slope.shape[0]):
        for k in range(3):
            if work.slope[i, k] != work.factored_slope[i, k]:
                return False
    return True


@compiled(inline=True)
def enter_tangent(work: Workspace, a: int, i: int, b: int, j: int) -> None:
    """Write the block of 1 + D G of points i and j, as the active points a and b."""
    tangential_x, tangential_z, normal_z = work.slope[i, 0], work.slope[i, 1], work.slope[i, 2]
    for k in range(2):
        by_x = work.compliance[2 * i, 2 * j + k]
        by_z = work.compliance[2 * i + 1, 2 * j + k]
        work.matrix[2 * a, 2 * b + k] = tangential_x * by_x + tangential_z * by_z
        work.matrix[2 * a + 1, 2 * b + k] = normal_z * by_z
    if a == b:
        work.matrix[2 * a, 2 * a] += 1.0
        work.matrix[2 * a + 1, 2 * a + 1] += 1.0


@compiled(inline=True)
def less_given(work: Workspace, i: int, j: int, right_x: float, right_z: float) -> tuple[float, float]:
    """Right-hand side of point i, less what the known change of the force of point j contributes."""
    tangential_x, tangential_z, normal_z = work.slope[i, 0], work.slope[i, 1], work.slope[i, 2]
    for k in range(2):
        given = work.change[2 * j + k]
        if given != 0.0:
            by_x = work.compliance[2 * i, 2 * j + k]
            by_z = work.compliance[2 * i + 1, 2 * j + k]
            right_x -= (tangential_x * by_x + tangential_z * by_z) * given
            right_z -= normal_z * by_z * given
    return right_x, right_z


@compiled(inline=True)
def change_one(work: Workspace, i: int, j: int) -> None:
    """Change of the force of point i, the only active one, after that of point j."""
    work.solution[0], work.solution[1] = less_given(work, i, j, work.change[2 * i], work.change[2 * i + 1])
    substitute_dense(2, work.matrix, work.pivot, work.solution)
    work.change[2 * i], work.change[2 * i + 1] = work.solution[0], work.solution[1]


@compiled(inline=True)
def factor_tangent(step: float, work: Workspace) -> bool:
    """Factor 1 + D G over the points whose law has a tangent, and store for which tangents and step."""
    # Of two points the active ones are not listed: constant indices let the compiler keep all arrays in registers.
    if work.force.shape[0] == FEW_POINTS:
        first, second = has_tangent(work, 0), has_tangent(work, 1)
        work.factored_count[0] = int(first) + int(second)
        if first and second:
            for i in range(2):
                for j in range(2):
                    enter_tangent(work, i, i, j, j)
            regular = eliminate_column(4, work.matrix, work.pivot, 0)
            regular = regular and eliminate_column(4, work.matrix, work.pivot, 1)
            regular = regular and eliminate_column(4, work.matrix, work.pivot, 2)
            return regular and eliminate_column(4, work.matrix, work.pivot, 3)
        if first:
            enter_tangent(work, 0, 0, 0, 0)
        elif second:
            enter_tangent(work, 0, 1, 0, 1)
        return not (first or second) or factor_dense(2, work.matrix, work.pivot)
    count = 0
    for i in range(work.force.shape[0]):
        if has_tangent(work, i):
            work.active[count] = i
            count += 1
        for k in range(3):
            work.factored_slope[i, k] = work.slope[i, k]
    work.factored_count[0] = count
    for a in range(count):
        for b in range(count):
            enter_tangent(work, a, work.active[a], b, work.active[b])
    work.factored_step[0] = step
    if not factor_dense(2 * count, work.matrix, work.pivot):
        work.factored_step[0] = -1.0
        return False
    return True


@compiled(inline=True)
def newton_change(work: Workspace) -> None:
    """Change of the contact forces (1 + D G) df = law - f; a point without tangent takes the force of its law."""
    n = work.force.shape[0]
    if n == FEW_POINTS:
        for i in range(2):
            for k in range(2):
                work.change[2 * i + k] = work.law[i, k] - work.force[i, k]
        first, second = has_tangent(work, 0), has_tangent(work, 1)
        if first and second:
            factors, change = work.matrix, work.change
            exchange_entry(4, work.pivot, change, 0)
            exchange_entry(4, work.pivot, change, 1)
            exchange_entry(4, work.pivot, change, 2)
            substitute_entry(0, 1, factors, change, 1, 1.0)
            substitute_entry(0, 2, factors, change, 2, 1.0)
            substitute_entry(0, 3, factors, change, 3, 1.0)
            substitute_entry(4, 4, factors, change, 3, factors[3, 3])
            substitute_entry(3, 4, factors, change, 2, factors[2, 2])
            substitute_entry(2, 4, factors, change, 1, factors[1, 1])
            substitute_entry(1, 4, factors, change, 0, factors[0, 0])
        elif first:
            change_one(work, 0, 1)
        elif second:
            change_one(work, 1, 0)
        return
    count = work.factored_count[0]
    for i in range(2 * n):
        work.change[i] = 0.0
    for i in range(n):
        if not has_tangent(work, i):
            work.change[2 * i] = work.law[i, 0] - work.force[i, 0]
            work.change[2 * i + 1] = work.law[i, 1] - work.force[i, 1]
    for a in range(count):
        i = work.active[a]
        right_x = work.law[i, 0] - work.force[i, 0]
        right_z = work.law[i, 1] - work.force[i, 1]
        for j in range(n):
            if not has_tangent(work, j):
                right_x, right_z = less_given(work, i, j, right_x, right_z)
        work.solution[2 * a], work.solution[2 * a + 1] = right_x, right_z
    substitute_dense(2 * count, work.matrix, work.pivot, work.solution)
    for a in range(count):
        i = work.active[a]
        work.change[2 * i], work.change[2 * i + 1] = work.solution[2 * a], work.solution[2 * a + 1]
