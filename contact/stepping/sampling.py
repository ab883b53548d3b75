"""Samples of a run on an exact grid of times, interpolated within the accepted step."""

from contact.arrays import FloatArray
from contact.interface.compliance import add_modes
from contact.jit import compiled, inlined
from contact.motion.kernel import floor_motion
from contact.stepping import state
from contact.stepping.body import (
    ANGULAR_VELOCITY,
    CENTRE_X,
    CENTRE_Z,
    ROTATION,
    STRAIN,
    VELOCITY_X,
    VELOCITY_Z,
)
from contact.stepping.joints import points_of
from contact.stepping.ledger import ROWS as LEDGER_ROWS
from contact.stepping.scheme import hermite
from contact.stepping.state import STRAIN_WINDOW, RunState, Samples, Stresses

SAME_INSTANT = 1e-12  #: difference of two times, over their size, that is rounding


@compiled(inline=True)
def write_columns(
    run: RunState,
    row: FloatArray,
    force: FloatArray,
    time: float,
    s: float,
    step: float,
    loose: bool | None,
) -> None:
    """One row of a history at the share `s` of the step; `force` (n, 2) is the contact force at this instant."""
    old, new = run.old, run.attempt.new
    a, b = old.pose, new.pose
    if loose is not None:
        a, b = old.boxes[0], new.boxes[0]
    floor, _, _ = floor_motion(run.problem.motion, time)
    lift, _, _ = floor_motion(run.problem.vertical, time)
    row[state.ROW_ROTATION] = hermite(
        s, step, a[ROTATION], a[ANGULAR_VELOCITY], b[ROTATION], b[ANGULAR_VELOCITY]
    )
    row[state.ROW_ANGULAR_VELOCITY] = (1.0 - s) * a[ANGULAR_VELOCITY] + s * b[ANGULAR_VELOCITY]
    row[state.ROW_SLIP] = run.joints[0].slip + s * run.joints[0].shift
    row[state.ROW_CENTRE_X] = hermite(s, step, a[CENTRE_X], a[VELOCITY_X], b[CENTRE_X], b[VELOCITY_X]) - floor
    row[state.ROW_CENTRE_Z] = hermite(s, step, a[CENTRE_Z], a[VELOCITY_Z], b[CENTRE_Z], b[VELOCITY_Z]) - lift
    row[state.ROW_UPLIFT], row[state.ROW_NORMAL], row[state.ROW_SHEAR] = 0.0, 0.0, 0.0
    begin, end = points_of(run, 0)
    for i in range(begin, end):
        if i < run.problem.control.base_points:
            gap = (1.0 - s) * old.point[i, 1] + s * new.point[i, 1]
            row[state.ROW_UPLIFT] = max(row[state.ROW_UPLIFT], gap - run.problem.contact.camber[i])
        row[state.ROW_SHEAR] += force[i, 0]
        row[state.ROW_NORMAL] += force[i, 1]
    if loose is not None:
        for j in range(1, run.joints.shape[0]):
            joint, first = run.joints[j], state.ROW_COLUMNS + state.BOX_COLUMNS * (j - 1)
            p, q = run.old.boxes[j], run.attempt.new.boxes[j]
            row[first + state.BOX_ROTATION] = hermite(
                s, step, p[ROTATION], p[ANGULAR_VELOCITY], q[ROTATION], q[ANGULAR_VELOCITY]
            )
            row[first + state.BOX_SLIP] = joint.slip + s * joint.shift
            row[first + state.BOX_OPENING] = (1.0 - s) * joint.opening + s * joint.opens
            for k in range(2):
                x, v = CENTRE_X + k, VELOCITY_X + k
                row[first + state.BOX_CENTRE_X + k] = hermite(s, step, p[x], p[v], q[x], q[v])
                row[first + state.BOX_CENTRE_X + k] -= floor if k == 0 else lift
    for k in range(3):
        row[state.ROW_KINETIC + k] = (1.0 - s) * old.energy[k] + s * new.energy[k]
    for k in range(LEDGER_ROWS):
        row[state.ROW_BASE_WORK + k] = run.ledger[k] + s * run.attempt.change[k]


@inlined
def keep_most_strained_step(run: RunState, step: float) -> None:
    """Keep the coordinates at the end of the accepted step, where it strains the body most in its window of time."""
    kept, new = run.strained, run.attempt.new
    if kept.shape[1] > 0:
        window = min(int((run.clock[0].time + step) / STRAIN_WINDOW), kept.shape[1] - 1)
        keep_if_more(kept[0, window], new.energy[STRAIN], new.position)
        for group in range(kept.shape[0] - 1):
            if new.energy[STRAIN] * run.problem.stress.bound[group] <= kept[1 + group, window, 0]:
                continue
            largest = largest_square(run.problem.stress, group, new.position)
            keep_if_more(kept[1 + group, window], largest, new.position)


@inlined
def keep_if_more(row: FloatArray, measure: float, position: FloatArray) -> None:
    """Write a measure of strain and the coordinates into a row, where it exceeds that of the row."""
    if measure > row[0]:
        row[0] = measure
        for j in range(position.size):
            row[1 + j] = position[j]


@compiled(inline=True)
def largest_square(stress: Stresses, group: int, position: FloatArray) -> float:
    """Largest square of the von Mises stress at the points of a group [Pa2]."""
    largest, modes, sums = 0.0, stress.of_modes.shape[1], stress.sums
    for body in range(stress.group[group], stress.group[group + 1]):
        for a in range(sums.size):
            sums[a] = 0.0
        first = stress.first[body]
        add_modes(stress.of_modes[body], position[first : first + modes], sums)
        for i in range(sums.size // 3):
            along, upward, shear = sums[3 * i], sums[3 * i + 1], sums[3 * i + 2]
            largest = max(largest, along * along - along * upward + upward * upward + 3.0 * shear * shear)
    return largest


@inlined
def sample(
    run: RunState, samples: Samples, written: int, origin: int, step: float, loose: bool | None
) -> int:
    """Write the samples up to and including the new time, of which `written` exist; returns the number so far.

    The first `origin` of them are no longer in the arrays. Positions are interpolated by cubics, all else linearly.
    """
    old, new, clock = run.old, run.attempt.new, run.clock[0]
    end = clock.time + step
    while written - origin < samples.mode.size:
        time = written * samples.interval if written > 0 else 0.0
        if time - end > SAME_INSTANT * end:  # 12 x 0.1 s is more than 1.2 s by rounding
            break
        s = min((time - clock.time) / step, 1.0)
        at = written - origin
        for i in range(new.point.shape[0]):
            for k in range(2):
                samples.force[at, i, k] = (1.0 - s) * old.force[i, k] + s * new.force[i, k]
        for j in range(samples.position.shape[1]):
            samples.position[at, j] = hermite(
                s, step, old.position[j], old.velocity[j], new.position[j], new.velocity[j]
            )
        for j in range(samples.velocity.shape[1]):
            samples.velocity[at, j] = (1.0 - s) * old.velocity[j] + s * new.velocity[j]
        samples.mode[at] = run.track[0].mode
        if samples.columns.shape[1] > 0:
            write_columns(run, samples.columns[at], samples.force[at], time, s, step, loose)
        written += 1
    return written
