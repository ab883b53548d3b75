"""When a run is over, and a run to its end where only the outcome is wanted, as for maps.

A run has three parts. It is driven until `rest_from`, the end of a pulse or a record, or else to its duration. From
`rest_from` on it ends when the container is at rest or has fallen, at the latest at its duration. A container that is
beyond its slenderness angle then has neither fallen nor come back: it is followed on a resting floor until it has done
one or the other; so is a loose stack of which a box is beyond it, or has its mass centre beyond the face below. What
comes to rest there, held by stops, ties or a neighbour alone, has lost its footing, and counts as fallen. No history is
kept here, and no Python runs within a slice.

Of the samples that a history would have, the stepper follows the largest acceleration and the sway of the contents.
The slip of the last cycle is kept.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray
from contact.jit import compiled, inlined
from contact.motion.kernel import UNIFORM, as_floor_motion, floor_motion
from contact.stepping.body import KINETIC, VELOCITY_X
from contact.stepping.boxes import has_footing, is_unsettled
from contact.stepping.control import most_attempts
from contact.stepping.integrator import (
    AFTERMATH_SLICE,
    FAILED,
    OVERTURNED,
    REACHED,
    FloatingBody,
    advance_on,
    enter_floor_frame_compiled,
)
from contact.stepping.joints import in_a_row
from contact.stepping.links import LinkedBody
from contact.stepping.loose_stack import LooseStack, stack_with_own_scratch
from contact.stepping.modal_body import BlockOnCorners, own_scratch
from contact.stepping.modes import FALLEN
from contact.stepping.observables import NEVER, lifting_energy
from contact.stepping.state import ROW_SLIP, Buffers, RunState

#: energy of a container at rest, over that which it takes to overturn; and how long it must stay below [1/p]
RESTING_ENERGY, RESTING_TIME = 1e-5, 1.0
#: what ends a part of a run before its time: nothing but a fall; also rest; also being upright
DRIVEN, FREE, UNDECIDED = 0, 1, 2


UNSETTLED = 4  #: as `integrator.REACHED`, but what becomes of the container is not decided yet


class SteppingEnd(NamedTuple):
    """Result of a run, besides its final state and records."""

    status: int  #: REACHED, OVERTURNED or FAILED (also at the limit of attempts)
    slip: FloatArray  #: (n_k,) sample i, up to the last one kept, is in column i modulo n_k [m]


def run_to_end(
    body: FloatingBody,
    run: RunState,
    duration: float,
    *,
    rest_from: float = math.inf,
    aftermath: float = 0.0,
    slip_until: float = 0.0,
    cycle: float = 0.0,
) -> SteppingEnd:
    """Step a run from t = 0 to its end, in place; the result does not depend on other runs or threads.

    Args:
        body: its container, or a loose stack, in floating frames; runs may share it: its scratch is not touched.
        run: with samples at the interval of its history, if that has columns.
        duration: at most [s].
        rest_from: from here on the run ends where the container is at rest or has fallen [s].
        aftermath: how long a container beyond its slenderness angle is followed afterwards on a resting floor [s].
        slip_until, cycle: the slip is kept of the last `cycle` before `slip_until` [s].
    """
    own = own_body(body)
    samples = run.buffers.history
    run.clock["attempt_limit"] = most_attempts(run.problem.control, duration + aftermath)
    slip, kept_until = np.zeros(math.ceil(cycle / samples.interval) + 2), float(slip_until)
    if samples.position.shape[1] > 0 or samples.velocity.shape[1] > 0:
        samples = samples._replace(position=samples.position[:, :0], velocity=samples.velocity[:, :0])
    frames = run.buffers.frames._replace(interval=math.inf)
    run = run._replace(buffers=Buffers(history=samples, frames=frames))
    step_on: Callable[..., int] = advance_in_slices.call_by_class
    status = step_on(own, run, slip, kept_until, math.inf, float(rest_from), float(duration), DRIVEN)
    if status == UNSETTLED:
        since = float(run.clock[0].time)
        x, velocity_x, _ = floor_motion(run.problem.motion, since)
        z, velocity_z, _ = floor_motion(run.problem.vertical, since)
        enter_floor_frame_compiled(own, run, velocity_x, velocity_z)
        run, end = on_resting_floor(run, since, (x, z)), float(duration + aftermath)
        status = step_on(own, run, slip, kept_until, AFTERMATH_SLICE, math.inf, end, UNDECIDED)
        if status == REACHED and run.track[0].overturned_at < np.inf:
            status = OVERTURNED
    return SteppingEnd(status, slip)


def own_body(body: FloatingBody) -> FloatingBody:
    """The same body with scratch arrays of its own; a rigid one on two points becomes a `BlockOnCorners`."""
    if isinstance(body, LinkedBody):
        return body._replace(body=own_body(body.body))
    if isinstance(body, LooseStack):
        return stack_with_own_scratch(body)
    if body.stiffness.size == 0 and body.point.shape[0] == 2:  # the rest of its scratch is in registers
        return BlockOnCorners(*body._replace(arm=np.empty_like(body.arm)))
    return own_scratch(body)


def advance_compiled(body: FloatingBody, run: RunState, until: float) -> int:
    """`integrator.advance` of a container or a loose stack in floating frames.

    It is in the kernel of runs without history, so that a run and its band compile the stepping once.
    """
    nothing = np.zeros(0)  # the caller drains the samples
    return int(advance_in_slices(body, run, nothing, 0.0, math.inf, math.inf, until, DRIVEN))


def on_resting_floor(run: RunState, since: float, place: Sequence[float]) -> RunState:
    """The run on a floor that stands still from `since` on [s], at this place along x and upward [m]."""
    still, level = (as_floor_motion(UNIFORM, (since, coordinate, 0.0)) for coordinate in place)
    return run.with_problem(motion=still, vertical=level, breaks=np.full(1, np.inf))


@inlined
def least_sunk(run: RunState, begin: int, end: int) -> float:
    """How much lower the first of some points of the base bears than on an undamaged floor [m]."""
    crushed, camber = run.old.crushed, run.problem.contact.camber
    least = crushed[begin] + camber[begin]
    for i in range(begin + 1, end):
        least = min(least, crushed[i] + camber[i])
    return least


@compiled
def is_over(run: RunState, part: int) -> bool:
    """Whether a part of a run (DRIVEN, FREE or UNDECIDED) is over before its time; asked before each of its slices.

    At rest, kinetic energy in the frame of the floor and gravity potential above that of the container resting there
    are together below a share of the energy to overturn, at every look for some time; the floor must not accelerate.
    Where something beside it may hold the container, the kinetic energy alone.
    """
    clock, track, control = run.clock[0], run.track[0], run.problem.control
    if part == DRIVEN:
        return False
    if track.overturned_at < NEVER:
        return True
    if part == UNDECIDED and not is_unsettled(run):
        return True
    if part == UNDECIDED and run.joints.shape[0] == 1 and run.links.shape[0] == 0:
        return False  # nothing holds it there
    if clock.time < clock.next_look:
        return False
    clock.next_look = clock.time + AFTERMATH_SLICE
    floor_velocity = run.floor[0, 1]
    moving = run.old.energy[KINETIC] + control.mass * floor_velocity * (
        0.5 * floor_velocity - run.old.pose[VELOCITY_X]
    )
    if in_a_row(run):  # how much lower its mass centre is
        sunk, mass = 0.0, 0.0
        for j in range(run.joints.shape[0]):
            joint = run.joints[j]
            sunk += 0.5 * joint.mass * (run.old.crushed[joint.begin] + run.old.crushed[joint.end - 1])
            mass += joint.mass
        sunk = sunk / mass
    else:
        points = control.base_points
        sunk = 0.5 * (least_sunk(run, 0, (points + 1) // 2) + least_sunk(run, points // 2, points))
    held = run.links.shape[0] > 0  # what leans on a stop or on the next body stays raised
    raised = 0.0
    if part == FREE and not held:
        raised = max(0.0, lifting_energy(control, run.old, run.floor[0, 0], sunk))
    if moving + raised > RESTING_ENERGY * control.reference_energy:
        clock.rest_since = NEVER
        return False
    clock.rest_since = min(clock.rest_since, clock.time)
    if clock.time - clock.rest_since < RESTING_TIME / control.slowest_rocking:
        return False
    for j in range(run.joints.shape[0]):  # what is at rest without footing counts as fallen now
        if not has_footing(run, j):
            run.joints[j].fell_at = track.overturned_at = clock.time
            track.mode = FALLEN
            track.modes |= 1 << FALLEN
    return True


@compiled
def advance_in_slices(
    body: FloatingBody,
    run: RunState,
    slip: FloatArray,
    slip_until: float,
    ahead: float,
    rest_from: float,
    until: float,
    part: int,
) -> int:
    """Step to `until` or until the run is over, looking at the samples every `ahead` [s] or sooner.

    A driven run is free from `rest_from` on. Of the samples up to `slip_until` the slip is kept, each in its column
    modulo the size of `slip`. Where that has none, it returns as `integrator.advance` does; else a driven run may end
    UNSETTLED, too.
    """
    clock = run.clock[0]
    while clock.time < until:
        now = FREE if part == DRIVEN and clock.time >= rest_from else part
        if is_over(run, now):
            break
        target = clock.next_look if now == FREE else min(clock.time + ahead, rest_from)
        status = advance_on(body, run, min(target, until))
        if slip.size == 0:
            return status
        samples = run.buffers.history
        for i in range(clock.samples - clock.samples_drained if samples.columns.shape[1] > 0 else 0):
            index = clock.samples_drained + i
            if index * samples.interval <= slip_until + 1e-9:
                slip[index % slip.size] = samples.columns[i, ROW_SLIP]
        clock.samples_drained = clock.samples
        if status != REACHED:
            return status
        if clock.time < until and clock.steps + clock.rejected >= clock.attempt_limit:
            return FAILED
    if part == DRIVEN and slip.size > 0:
        if not is_over(run, UNDECIDED):
            return UNSETTLED
        if run.track[0].overturned_at < NEVER:
            return OVERTURNED
    return REACHED
