"""Adaptive time stepping of one body on a moving floor.

A step is tried (`contact.stepping.step`) and repeated with a smaller size if an iteration fails, if the support starts
to slide in a large step, or if its energy error exceeds the tolerance. `contact.stepping.control` chooses the next
size.

`advance` is written once: `outcome.advance_compiled` steps bodies in floating frames,
`fem.solid.nodal_kernels.advance_nodal` a finite-element body, and `advance` itself, in Python, any object with the
methods of `contact.stepping.body`. All use the same compiled laws, contact solver and ledger.
"""

from typing import Any

from contact.jit import compiled, inlined
from contact.motion.kernel import UNIFORM
from contact.stepping import modal_kernels  # noqa: F401 - registers the operations of a modal body
from contact.stepping.body import complete, prepared, shift_velocity, stands_loose, weigh
from contact.stepping.boxes import follow_boxes, follow_gap, has_fallen
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
from contact.stepping.joints import (
    friction_of,
    in_a_row,
    settle_friction,
    slide_points,
    update_joints,
    weaken_friction,
)
from contact.stepping.ledger import IMBALANCE, dissipation, spring_energy
from contact.stepping.ledger import ROWS as LEDGER_ROWS
from contact.stepping.links import follow_links, links_of, reach_strength
from contact.stepping.modes import FALLEN
from contact.stepping.observables import IMPACT_GAP, NEVER, update_observables
from contact.stepping.sampling import keep_most_strained_step, sample
from contact.stepping.state import RunState
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
    for j in range(run.joints.shape[0]):
        run.joints[j].slip += run.joints[j].shift
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
            run.joints[j].opening = run.joints[j].opens
    for k in range(3):
        run.floor[0, k] = run.floor[1, k]
    if run.problem.vertical.kind != UNIFORM:
        for k in range(3):
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
            slide_points(run, step, loose, links)
            if not weaken_friction(run):
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
            follow_boxes(run, step)
            for gap in range(run.joints.shape[0] - 1 if in_a_row(run) else 0):
                follow_gap(run, step, gap, counts)
        follow_contents(body, run, step)
        clock.samples = sample(run, history, clock.samples, clock.samples_drained, step, loose)
        clock.frames = sample(run, frames, clock.frames, clock.frames_drained, step, loose)
        lose_at_impacts(body, run, loose)
        keep_most_strained_step(run, step)
        close_step(run, step, iterations)
        # The imbalance of one step may vanish by chance while it changes sign: remember the last steps.
        stacked = run.joints.shape[0] > 1
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
            if control.stop_when_overturned or run.joints.shape[0] > 1:
                return OVERTURNED
    return REACHED


advance_kernel = compiled(advance)
enter_floor_frame_compiled = compiled(enter_floor_frame)
