"""Adaptive time stepping of one body on a moving floor.

A step is tried (`contact.stepping.step`) and repeated with a smaller size if an iteration fails, if the support starts
to slide in a large step, or if its energy error exceeds the tolerance. `contact.stepping.control` chooses the next
size.

`advance` is written once: `outcome.advance_compiled` steps bodies in floating frames,
`fem.solid.nodal_kernels.advance_nodal` a finite-element body, and `advance` itself, in Python, any object with the
methods of `contact.stepping.body`. All use the same compiled laws, contact solver and ledger.

A `BlockOnCorners` is stepped on arrays of constant shape, which are kept in registers. State, scratch and attempted
step are copied to such arrays, the run is advanced, and what others read is copied back. A run for its outcome is
advanced once or some hundred times, in thousands of steps.
"""

from typing import Any

from contact.arrays import FloatArray
from contact.interface.workspace import Workspace
from contact.jit import compiled, inlined
from contact.layout import exchanging, parts_of, room_of
from contact.local_arrays import local_counts, local_row, local_rows
from contact.stepping.body import State, complete, implements, prepared, shift_velocity, stands_loose, weigh
from contact.stepping.boxes import follow_boxes, has_fallen
from contact.stepping.contents import follow_contents, shift_contents
from contact.stepping.control import (
    GROWTH,
    GROWTH_OF_STACK,
    STEPS_PER_OCTAVE,
    allowed_imbalance,
    change_level,
    grown_level,
    ledger_allowance,
    next_step,
    step_level,
)
from contact.stepping.impact import lose_at_impacts
from contact.stepping.joints import friction_of, settle_friction, slide_points, update_joints
from contact.stepping.ledger import IMBALANCE, dissipation, spring_energy
from contact.stepping.ledger import ROWS as LEDGER_ROWS
from contact.stepping.links import LinkedBody, follow_links, links_of, reach_strength
from contact.stepping.loose_stack import LooseStack
from contact.stepping.modal_body import BlockOnCorners, LocalBlock, ModalBody
from contact.stepping.modes import FALLEN
from contact.stepping.observables import IMPACT_GAP, NEVER, update_observables
from contact.stepping.sampling import keep_most_strained_step, sample
from contact.stepping.state import AttemptedStep, RunState
from contact.stepping.step import account, attempt, indent

WEAKENING_LIMIT = 8  #: repetitions of a step for friction that weakens with its slip
HELD_STEPS = 6  #: after a rejection
#: of the remembered imbalance, per step; where steps are eager, and of a loose stack, most of whose steps follow an
#: impact in short time
FADING, SHORT_FADING = 0.8, 0.5

#: what `advance` returns
REACHED, OVERTURNED, FAILED, UNPREPARED = 0, 1, 2, 3
AFTERMATH_SLICE = 0.05  #: interval of the checks after the end of the floor motion [s]


@compiled(inline=True)
def close_step(run: RunState, step: float, iterations: int) -> None:
    """Make the step the state of the run and add its terms to the ledger."""
    clock = run.clock[0]
    for row in range(LEDGER_ROWS):
        run.ledger[row] += run.attempt.change[row]
    if run.track[0].overturned_at == NEVER:  # the impact after overturning does not matter
        clock.least_imbalance = min(clock.least_imbalance, run.ledger[IMBALANCE])
        clock.most_imbalance = max(clock.most_imbalance, run.ledger[IMBALANCE])
        clock.dissipated = dissipation(run.ledger)
    clock.rolling_before = clock.rolling
    clock.time += step
    clock.steps += 1
    clock.iterations += iterations
    clock.smallest_step = min(clock.smallest_step, step)
    for i in range(run.old.numbers.size):  # all but the monitored points
        run.old.numbers[i] = run.attempt.new.numbers[i]
    if run.joints.shape[0] > 1:
        clock.spring_energy = spring_energy(run.problem.contact, run.old.point, run.old.stick)
    for j in range(run.joints.shape[0]):
        run.joints[j].slip += run.joints[j].shift
        run.joints[j].opening = run.joints[j].opens
    for k in range(3):
        run.floor[0, k] = run.floor[1, k]
        run.lift[0, k] = run.lift[1, k]


@inlined
def enter_floor_frame(body: Any, run: RunState, floor_velocity: float, lift_velocity: float) -> None:
    """Change to the frame of the floor as its motion ends, with this velocity [m/s]; nothing gets an impulse."""
    shift_velocity(body, run.old, (floor_velocity, lift_velocity, 0.0), (0, run.joints.shape[0]))
    shift_contents(run.contents, (floor_velocity, lift_velocity))
    complete(body, run.old, run.floor[0, 0], run.lift[0, 0], 0.0)
    indent(run.problem.contact, run.old.point, run.old.crushed)
    for side in range(2):
        run.floor[side, 1], run.floor[side, 2] = 0.0, 0.0
        run.lift[side, 1], run.lift[side, 2] = 0.0, 0.0
    run.clock[0].next_break = 0


def advance(body: Any, run: RunState, until: float) -> int:
    """Step the body to the time `until` [s] or just beyond (no step is shortened for it); changes `run` in place.

    It also returns when the sample arrays are full, so that no sample is lost, and at `clock.attempt_limit`.

    Returns:
        REACHED; OVERTURNED (90 degrees, with `control.stop_when_overturned`; or a box of a loose stack fell); FAILED:
        no convergence at the smallest step, `run.old` is the last good state; or UNPREPARED: prepare the body for
        steps of `clock.unprepared_step` and call again.
    """
    control, clock, track, loose = run.problem.control, run.clock[0], run.track[0], stands_loose(body)
    links, history, frames = links_of(body), run.buffers.history, run.buffers.frames
    while clock.time < until and clock.steps + clock.rejected < clock.attempt_limit:
        room = history.mode.size - (clock.samples - clock.samples_drained)
        room_of_frames = frames.mode.size - (clock.frames - clock.frames_drained)
        ahead = control.largest_step
        if (room - 1) * history.interval < ahead or (room_of_frames - 1) * frames.interval < ahead:
            break
        step = next_step(run)
        if not prepared(body, step):
            clock.unprepared_step = step
            return UNPREPARED
        iterations = 0
        weigh(body, run.problem.contact, run.old)
        for j in range(run.joints.shape[0]):
            run.joints[j].mu = friction_of(run, j, run.joints[j].slip_since_break)
        for _ in range(WEAKENING_LIMIT):  # friction that weakens with the slip of this step
            iterations = attempt(body, run, step)
            if iterations < 0:
                break
            if not slide_points(run, step, loose, links):
                break
        if iterations < 0:
            clock.rejected += 1
            clock.failed += 1
            if step <= control.smallest_step:
                return FAILED
            clock.level += STEPS_PER_OCTAVE
            continue
        switches = settle_friction(run, step, loose, links)
        switches = reach_strength(run, links) or switches
        dissipated = account(run, step, loose, links)
        allowed = allowed_imbalance(run, step, dissipated)
        allowed = min(allowed, ledger_allowance(run, step))
        used = abs(run.attempt.change[IMBALANCE]) / allowed
        if switches and step > 1.01 * control.event_step:
            used = max(used, 9.0 if step > 4.0 * control.event_step else 2.0)
        if used > 1.0 and step > control.smallest_step:
            clock.rejected += 1
            clock.level = change_level(clock.level, used, False)
            clock.growth_hold = HELD_STEPS
            continue
        if switches:  # the time scale of the contact matters again
            clock.level = max(clock.level, step_level(control.largest_step, control.event_step))
        late = step / control.recent_time
        clock.recent_dissipation = clock.recent_dissipation / (1.0 + late * (1.0 + 0.5 * late)) + max(
            dissipated, 0.0
        )
        update_joints(run, step)
        counts = IMPACT_GAP * control.width * control.slenderness_angle
        follow_links(run, step, links, counts)
        update_observables(run, step)
        if loose is not None:
            follow_boxes(run, step, counts)
        follow_contents(body, run, step)
        clock.samples = sample(run, history, clock.samples, clock.samples_drained, step, loose)
        clock.frames = sample(run, frames, clock.frames, clock.frames_drained, step, loose)
        lose_at_impacts(body, run, loose)
        keep_most_strained_step(run, step)
        close_step(run, step, iterations)
        stacked = run.joints.shape[0] > 1
        # The imbalance of one step may vanish by chance while it changes sign: remember the last steps.
        fading = SHORT_FADING if stacked or control.eager else FADING
        recent, not_held = max(min(used, 1.0), fading * clock.allowance_used), clock.growth_hold == 0
        if control.eager:
            level = grown_level(clock.level, recent, not_held)
        else:
            level = change_level(clock.level, recent, not_held, GROWTH_OF_STACK if stacked else GROWTH)
        if level < clock.level or step > control.smallest_step:
            clock.level = level
        clock.allowance_used = recent
        clock.growth_hold = max(clock.growth_hold - 1, 0)
        if track.overturned_at == NEVER and has_fallen(run):
            track.overturned_at = clock.time
            track.mode = FALLEN
            track.modes |= 1 << FALLEN
            if control.stop_when_overturned or stacked:
                return OVERTURNED
    return REACHED


inlined(advance)
advance_kernel = compiled(advance)
enter_floor_frame_compiled = compiled(enter_floor_frame)

#: sizes in the layouts of a `BlockOnCorners`: coordinates, points, boxes of a loose stack
SIZES = {"d": 3, "n": 2, "2n": 4, "N": 0, "4N": 0}
NUMBERS, _ = room_of(State, **SIZES)
NUMBERS_OF_WORK, COUNTS_OF_WORK = room_of(Workspace, **SIZES)


# In kernels these are made by value: the compiler sees their arrays.
class LocalState(State):
    """A state in registers."""


class LocalWorkspace(Workspace):
    """A workspace in registers."""


class LocalAttempt(AttemptedStep):
    """An attempted step in registers."""


class LocalRun(RunState):
    """A run whose states and workspace are in registers."""


FloatingBody = ModalBody | LooseStack | LinkedBody  #: what this module steps in machine code
local_state = parts_of(LocalState, State, **SIZES)
local_work = parts_of(LocalWorkspace, Workspace, **SIZES)
local_run = exchanging(LocalRun, "attempt", "old", "work", "floor", "lift", "ledger")
local_block = exchanging(
    LocalBlock, "point", "stiffness", "damping", "cached_step", "recent", "inverse", "arm", "free_change"
)


def advance_on(body: FloatingBody, run: RunState, until: float) -> int:
    """`advance`, compiled for the class of the body."""
    return advance(body, run, until)


@implements(advance_on, LooseStack, LinkedBody, inline=True)
def advance_in_memory(body: FloatingBody, run: RunState, until: float) -> int:
    """`advance` on the arrays of the run."""
    return int(advance_kernel(body, run, until))


@inlined
def has_two_points(state: State) -> bool:
    """Whether a state is of two points."""
    if state.stick.size != 2 or state.crushed.size != 2:
        return False
    if state.point.shape[0] != 2 or state.force.shape[0] != 2 or state.descent.shape[0] != 2:
        return False
    if state.drift.shape[0] != 2 or state.drift.shape[1] != 2:
        return False
    return bool(state.point.shape[1] == 2 and state.force.shape[1] == 2 and state.descent.shape[1] == 2)


@inlined
def stands_on_corners(body: ModalBody, run: RunState) -> bool:
    """Whether a body has two points: from each comparison with a constant the compiler infers a size."""
    work = run.work
    if body.point.shape[0] != 2 or run.problem.control.base_points != 2 or run.joints.shape[0] != 1:
        return False
    if run.links.shape[0] != 0:
        return False
    if body.moved.shape[1] != 4 or body.across.shape[1] != 4:
        return False
    if body.elastic_compliance.shape[1] != 4 or body.elastic_compliance.shape[2] != 4:
        return False
    if work.point.shape[0] != 2 or work.slope.shape[0] != 2:
        return False
    if work.force.shape[0] != 2 or work.force.shape[1] != 2:
        return False
    return has_two_points(run.old) and has_two_points(run.attempt.new)


@implements(advance_on, ModalBody)
def advance_on_points(body: ModalBody, run: RunState, until: float) -> int:
    """`advance`, twice in the machine code: where sizes are known, loops are unrolled. numba translates it once."""
    if stands_on_corners(body, run):
        return advance(body, run, until)
    return int(advance_kernel(body, run, until))


@inlined
def copy_row(target: FloatArray, source: FloatArray, size: int) -> None:
    """Copy the first numbers of a row."""
    for i in range(size):
        target[i] = source[i]


@inlined
def copy_pair(target: FloatArray, source: FloatArray, columns: int) -> None:
    """Copy two rows."""
    for i in range(2):
        for k in range(columns):
            target[i, k] = source[i, k]


@implements(advance_on, BlockOnCorners)
def advance_in_registers(body: BlockOnCorners, run: RunState, until: float) -> int:
    """`advance` on arrays of constant shape; of the last attempt what the residual needs is copied back."""
    if body.stiffness.size != 0 or body.point.shape[0] != 2 or run.problem.control.base_points != 2:
        return FAILED
    if run.links.shape[0] != 0:
        return FAILED
    if run.joints.shape[0] != 1 or run.old.numbers.size != NUMBERS or run.attempt.new.numbers.size != NUMBERS:
        return FAILED
    before, after, point, nothing = local_row(NUMBERS), local_row(NUMBERS), local_rows(2, 2), local_row(0)
    floor, lift, ledger, none = local_rows(2, 3), local_rows(2, 3), local_row(LEDGER_ROWS), local_counts(0)
    work = local_work(run.work, local_row(NUMBERS_OF_WORK), local_counts(COUNTS_OF_WORK))
    block = local_block(
        body,
        point=point,
        stiffness=nothing,
        damping=nothing,
        cached_step=local_row(2),
        recent=local_counts(1),
        inverse=local_rows(1, 3),
        arm=local_rows(2, 2),
        free_change=local_row(3),
    )
    attempt = LocalAttempt(
        local_state(run.attempt.new, after, none), slip=local_row(2), change=local_row(LEDGER_ROWS)
    )
    own = local_run(
        run,
        attempt=attempt,
        old=local_state(run.old, before, none),
        work=work,
        floor=floor,
        lift=lift,
        ledger=ledger,
    )
    copy_pair(point, body.point, 2)
    copy_row(before, run.old.numbers, NUMBERS)
    copy_row(after, run.attempt.new.numbers, NUMBERS)
    copy_pair(floor, run.floor, 3)
    copy_pair(lift, run.lift, 3)
    copy_row(ledger, run.ledger, LEDGER_ROWS)
    status = advance(block, own, until)
    copy_row(run.old.numbers, before, NUMBERS)
    copy_row(run.attempt.new.numbers, after, NUMBERS)
    copy_pair(run.floor, floor, 3)
    copy_pair(run.lift, lift, 3)
    copy_row(run.ledger, ledger, LEDGER_ROWS)
    copy_pair(run.work.law, work.law, 2)
    copy_pair(run.work.force, work.force, 2)
    return status
