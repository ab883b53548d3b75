"""Compliance of contact points: displacements under forces, and the tangent of the contact.

Arrays as in `contact.interface.solver`.
"""

from contact.arrays import FloatArray
from contact.interface.dense import factor_dense, substitute_dense
from contact.interface.workspace import Workspace
from contact.jit import compiled

FEW_POINTS = 2  #: up to so many, the rows of the compliance are taken one by one
WORTH_KEEPING = 5  #: active points from which an old factorisation is reused before a new one is computed


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
def add_columns(force: FloatArray, compliance: FloatArray, out: FloatArray) -> None:
    """Displacements (2 n,) under forces (n, 2), by columns of a symmetric compliance: several rows at once."""
    for a in range(out.size):
        out[a] = 0.0
    for j in range(force.shape[0]):
        along, up = force[j, 0], force[j, 1]
        if up != 0.0 or along != 0.0:
            for a in range(out.size):
                out[a] += compliance[2 * j, a] * along + compliance[2 * j + 1, a] * up


@compiled(inline=True)
def move_points(velocity_slope: float, force: FloatArray, work: Workspace) -> None:
    """Points and velocities that follow from contact forces, by the condensed compliance."""
    n = force.shape[0]
    if n > FEW_POINTS:
        add_columns(force, work.compliance, work.solution)
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
    """Whether the factors were computed for these tangents and this step size.

    The compliance has turned with the body since then; such a Newton step converges more slowly, but it converges.
    """
    if work.factored_step[0] != step or work.factored_count[0] < WORTH_KEEPING:
        return False
    for i in range(work.slope.shape[0]):
        for k in range(3):
            if work.slope[i, k] != work.factored_slope[i, k]:
                return False
    return True


@compiled(inline=True)
def factor_tangent(step: float, work: Workspace) -> bool:
    """Factor 1 + D G over the points whose law has a tangent, and store for which tangents and step."""
    count = 0
    for i in range(work.force.shape[0]):
        if has_tangent(work, i):
            work.active[count] = i
            count += 1
        for k in range(3):
            work.factored_slope[i, k] = work.slope[i, k]
    work.factored_count[0] = count
    for a in range(count):
        i = work.active[a]
        tangential_x, tangential_z, normal_z = work.slope[i, 0], work.slope[i, 1], work.slope[i, 2]
        for b in range(count):
            j = work.active[b]
            for k in range(2):
                by_x = work.compliance[2 * i, 2 * j + k]
                by_z = work.compliance[2 * i + 1, 2 * j + k]
                work.matrix[2 * a, 2 * b + k] = tangential_x * by_x + tangential_z * by_z
                work.matrix[2 * a + 1, 2 * b + k] = normal_z * by_z
        work.matrix[2 * a, 2 * a] += 1.0
        work.matrix[2 * a + 1, 2 * a + 1] += 1.0
    work.factored_step[0] = step
    if not factor_dense(2 * count, work.matrix, work.pivot):
        work.factored_step[0] = -1.0
        return False
    return True


@compiled(inline=True)
def newton_change(work: Workspace) -> None:
    """Change of the contact forces (1 + D G) df = law - f, with the present factors.

    A point without tangent takes the force of its law; the change acts on the other points.
    """
    n = work.force.shape[0]
    count = work.factored_count[0]
    for i in range(2 * n):
        work.change[i] = 0.0
    for i in range(n):
        if not has_tangent(work, i):
            work.change[2 * i] = work.law[i, 0] - work.force[i, 0]
            work.change[2 * i + 1] = work.law[i, 1] - work.force[i, 1]
    for a in range(count):
        i = work.active[a]
        tangential_x, tangential_z, normal_z = work.slope[i, 0], work.slope[i, 1], work.slope[i, 2]
        right_x = work.law[i, 0] - work.force[i, 0]
        right_z = work.law[i, 1] - work.force[i, 1]
        for j in range(n):
            if not has_tangent(work, j):
                for k in range(2):
                    given = work.change[2 * j + k]
                    if given != 0.0:
                        by_x = work.compliance[2 * i, 2 * j + k]
                        by_z = work.compliance[2 * i + 1, 2 * j + k]
                        right_x -= (tangential_x * by_x + tangential_z * by_z) * given
                        right_z -= normal_z * by_z * given
        work.solution[2 * a], work.solution[2 * a + 1] = right_x, right_z
    substitute_dense(2 * count, work.matrix, work.pivot, work.solution)
    for a in range(count):
        i = work.active[a]
        work.change[2 * i], work.change[2 * i + 1] = work.solution[2 * a], work.solution[2 * a + 1]
