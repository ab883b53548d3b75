"""Adaptive time stepping of one body on a moving floor.

A step is tried (`contact.stepping.step`) and repeated with a smaller size if an iteration fails, if the support starts
to slide in a large step, or if its energy error exceeds the tolerance. `contact.stepping.control` chooses the next
size.

`advance` is written once: `advance_compiled` steps a `ModalBody`, `fem.solid.nodal_kernels.advance_nodal` a
finite-element body, and `advance` itself, in Python, any object with the methods of `contact.stepping.body`. All use
the same compiled laws, contact solver and ledger.
"""

from typing import Any

import numpy as np
from numba.extending import register_jitable

from contact.interface.laws import ELASTIC_STICK, weakened_mu
from contact.interface.workspace import Contact
from contact.jit import compiled
from contact.motion.kernel import UNIFORM
from contact.stepping import modal_kernels  # noqa: F401 - registers the operations of a modal body
from contact.stepping.body import ROTATION, complete, prepared, shift_velocity, sizes_match
from contact.stepping.contents import follow_contents, shift_contents
from contact.stepping.control import (
    STEPS_PER_OCTAVE,
    allowed_imbalance,
    change_level,
    ledger_allowance,
    next_step,
    step_level,
)
from contact.stepping.ledger import FRICTION, IMBALANCE, dissipation
from contact.stepping.ledger import ROWS as LEDGER_ROWS
from contact.stepping.observables import FALLEN, NEVER, SLIDING, update_observables
from contact.stepping.sampling import sample
from contact.stepping.state import RunState
from contact.stepping.step import (
    AIRBORNE,
    ALL,
    NO_POINT,
    account,
    attempt,
    copy_state,
    holding_force,
    indent,
    slide,
)

WEAKENING_LIMIT = 8  #: repetitions of a step for friction that weakens with its slip
WEAKENING_TOLERANCE = 1e-9  #: change of the coefficient at which they end
IMPACT_LOAD = 2.0  #: normal force over the weight from which there is an impact
HELD_STEPS = 6  #: after a rejection
FADING = 0.8  #: of the remembered imbalance, per step

#: what `advance` returns
REACHED, OVERTURNED, FAILED, UNPREPARED = 0, 1, 2, 3
OVERTURNING_ROTATION = 0.5 * np.pi
#: without stop at overturning, it counts this much earlier, where the side of the container meets the floor [rad]
LYING_MARGIN = 2e-3
AFTERMATH_SLICE = 0.05  #: interval of the checks after the end of the floor motion [s]


@compiled(inline=True)
def update_records(
    run: RunState, step: float, sliding: int, slip_step: float, slip_velocity: float, every: bool
) -> None:
    """Update friction state and observables from the step about to be accepted."""
    clock = run.clock[0]
    clock.slip_since_break = (
        clock.slip_since_break + abs(slip_step) if clock.sliding == 1 or sliding == ALL else 0.0
    )
    clock.sliding = 1 if every else 0
    tangential, normal = 0.0, 0.0
    for i in range(run.new.force.shape[0]):
        tangential += run.new.force[i, 0]
        normal += run.new.force[i, 1]
    limit = run.contact.mu_static * normal
    utilisation = abs(tangential) / limit if limit > 0.0 else 0.0
    clock.utilisation_rate = (utilisation - clock.utilisation) / step
    clock.utilisation = utilisation
    clock.slip_acceleration = (slip_velocity - clock.slip_velocity) / step
    clock.slip_velocity = slip_velocity
    update_observables(
        run.track[0],
        run.control,
        run.old,
        run.new,
        clock.time + step,
        step,
        every,
        clock.slip + slip_step,
        slip_step,
        run.floor,
        run.lift,
        run.change[FRICTION],
    )


@compiled(inline=True)
def close_step(run: RunState, step: float, slip_step: float, iterations: int) -> None:
    """Make the step the state of the run and add its terms to the ledger."""
    clock = run.clock[0]
    for row in range(LEDGER_ROWS):
        run.ledger[row] += run.change[row]
    if run.track[0].overturned_at == NEVER:  # the impact after overturning does not matter
        clock.least_imbalance = min(clock.least_imbalance, run.ledger[IMBALANCE])
        clock.most_imbalance = max(clock.most_imbalance, run.ledger[IMBALANCE])
        clock.dissipated = dissipation(run.ledger)
    clock.slip += slip_step
    clock.time += step
    clock.steps += 1
    clock.iterations += iterations
    clock.smallest_step = min(clock.smallest_step, step)
    copy_state(run.old, run.new)
    for k in range(3):
        run.floor[0, k] = run.floor[1, k]
    if run.vertical.kind != UNIFORM:
        for k in range(3):
            run.lift[0, k] = run.lift[1, k]


@register_jitable(forceinline=True)
def _kinetic_friction(contact: Contact, slid: float) -> float:
    """Coefficient of friction, at no velocity, of a sliding support after a path of `slid` [m]."""
    if contact.stribeck_velocity > 0.0 and contact.weakening <= 0.0:
        return contact.mu_static
    return weakened_mu(contact.mu_static, contact.mu_kinetic, contact.weakening, slid)


@register_jitable(forceinline=True)
def _is_full(run: RunState) -> bool:
    """Whether the sample arrays cannot hold another largest step."""
    ahead = run.control.largest_step
    clock = run.clock[0]
    room = run.history.mode.size - (clock.samples - clock.samples_drained)
    room_of_frames = run.frames.mode.size - (clock.frames - clock.frames_drained)
    return (room - 1) * run.history.interval < ahead or (room_of_frames - 1) * run.frames.interval < ahead


@register_jitable(forceinline=True)
def enter_floor_frame(body: Any, run: RunState, floor_velocity: float, lift_velocity: float) -> None:
    """Change to the frame of the floor at the end of its motion, where its velocity is this, along x and upward [m/s].

    The floor is at rest in this frame; the container gets no impulse.
    """
    shift_velocity(body, run.old, floor_velocity, lift_velocity)
    shift_contents(run.contents, (floor_velocity, lift_velocity))
    complete(body, run.old, run.floor[0, 0], run.lift[0, 0], 0.0)
    indent(run.old.point, run.old.crushed)
    for side in range(2):
        run.floor[side, 1], run.floor[side, 2] = 0.0, 0.0
        run.lift[side, 1], run.lift[side, 2] = 0.0, 0.0
    run.clock[0].next_break = 0


@compiled(inline=True)
def breaks_loose(run: RunState, slip_step: float) -> bool:
    """Whether a support whose points all slide at the limit of static friction breaks loose as a whole.

    A rigid body would slide, or the points have slid as far as counts as sliding. Less is the overshoot of an elastic
    swing, which lasts milliseconds and slides micrometres: too little for friction to fall.
    """
    holding, normal = holding_force(run)
    slid = run.clock[0].slip_since_break + abs(slip_step)
    return abs(holding) > run.contact.mu_static * normal or slid > SLIDING * run.control.width


@compiled(inline=True)
def slides_on(run: RunState, step: float, sliding: int, slip_step: float, turned: bool) -> tuple[bool, float]:
    """Whether a sliding support slides on after the attempted step, and its sliding in it [m].

    It stops where its slip has `turned` round, or none of its points slides, and static friction can hold it. A slip
    that turns round without a stop goes on: kinetic friction remains, and the path since the support broke loose.
    """
    if turned or sliding == NO_POINT:
        holding, normal = holding_force(run)
        if abs(holding) <= run.contact.mu_static * normal:
            # a stop within an impact does not last
            weight = run.control.mass * (run.control.gravity + run.lift[1, 2])
            if turned and normal < IMPACT_LOAD * weight:
                _, slip_step, _ = slide(run, step, True, holding)
            return False, slip_step
    return True, slip_step


def advance(body: Any, run: RunState, until: float) -> int:
    """Step the body to the time `until` [s] or just beyond (no step is shortened for it); changes `run` in place.

    It also returns when the sample arrays are full, so that no sample is lost, and at `clock.attempt_limit`.

    Returns:
        REACHED; OVERTURNED (90 degrees, with `control.stop_when_overturned`); FAILED: no convergence at the smallest
        step, `run.old` is the last good state; or UNPREPARED: prepare the body for steps of `clock.unprepared_step`
        and call again.
    """
    control, clock, track = run.control, run.clock[0], run.track[0]
    if not sizes_match(body, run):
        return FAILED
    while clock.time < until and clock.steps + clock.rejected < clock.attempt_limit and not _is_full(run):
        step = next_step(run)
        if not prepared(body, step):
            clock.unprepared_step = step
            return UNPREPARED
        mu = run.contact.mu_static
        if clock.sliding == 1:
            mu = _kinetic_friction(run.contact, clock.slip_since_break)
        iterations, sliding, slip_step, slip_velocity = 0, NO_POINT, 0.0, 0.0
        for _ in range(WEAKENING_LIMIT):  # friction that weakens with the slip of this step
            iterations = attempt(body, run, step, mu)
            if iterations < 0:
                break
            sliding, slip_step, slip_velocity = slide(run, step, False, 0.0)
            if clock.sliding == 0 or run.contact.weakening <= 0.0:
                break
            weakened = _kinetic_friction(run.contact, clock.slip_since_break + abs(slip_step))
            if abs(weakened - mu) <= WEAKENING_TOLERANCE:
                break
            mu = weakened
        if iterations < 0:
            clock.rejected += 1
            clock.failed += 1
            if step <= control.smallest_step:
                return FAILED
            clock.level += STEPS_PER_OCTAVE
            continue
        every = sliding == ALL or (sliding == AIRBORNE and clock.sliding == 1)
        turned = False
        if clock.sliding == 1 and run.contact.friction == ELASTIC_STICK and sliding != AIRBORNE:
            turned = slip_velocity * clock.slip_velocity < 0.0
            every, slip_step = slides_on(run, step, sliding, slip_step, turned)
        elif every and clock.sliding == 0 and run.contact.friction == ELASTIC_STICK:
            every = breaks_loose(run, slip_step)
        dissipated = account(run, step)
        allowed = allowed_imbalance(run, step, dissipated)
        allowed = min(allowed, ledger_allowance(run, step))
        used = abs(run.change[IMBALANCE]) / allowed
        overshoots = clock.sliding == 0 and (sliding == ALL) != (clock.slip_since_break > 0.0)
        switches = turned or overshoots or (clock.sliding == 1) != every
        switches = switches and run.contact.mu_static > 0.0
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
        update_records(run, step, sliding, slip_step, slip_velocity, every)
        follow_contents(body, run, step)
        clock.samples = sample(run, run.history, clock.samples, clock.samples_drained, step, slip_step)
        clock.frames = sample(run, run.frames, clock.frames, clock.frames_drained, step, slip_step)
        close_step(run, step, slip_step, iterations)
        # The imbalance of one step may vanish by chance while it changes sign: remember the last steps.
        recent = max(min(used, 1.0), FADING * clock.allowance_used)
        level = change_level(clock.level, recent, clock.growth_hold == 0)
        if level < clock.level or step > control.smallest_step:
            clock.level = level
        clock.allowance_used = recent
        clock.growth_hold = max(clock.growth_hold - 1, 0)
        fallen = OVERTURNING_ROTATION if control.stop_when_overturned else OVERTURNING_ROTATION - LYING_MARGIN
        if abs(run.old.pose[ROTATION]) >= fallen and track.overturned_at == NEVER:
            track.overturned_at = clock.time
            track.mode = FALLEN
            track.modes |= 1 << FALLEN
            if control.stop_when_overturned:
                return OVERTURNED
    return REACHED


advance_compiled = compiled(advance)
enter_floor_frame_compiled = compiled(enter_floor_frame)
