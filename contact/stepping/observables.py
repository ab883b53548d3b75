"""Observables of a run, updated at every step: extremes, events, impacts, restitution.

A side is open, and the body turns about the other one, when only the outer part of the base at the other side is in
contact: a flat base on an elastic bed opens at one edge long before that. Of a base that rolls a side is open where all
of it is, and there are no impacts. The corners are the first and the last base point. An impact counts if the container
has rocked and a corner closes whose gap had exceeded a thousandth of width times slenderness angle while the other
corner was the pivot. With it the pivot is exchanged, as soon as the container, while it still turns the same way, has
lifted the other corner: once for every impact, whatever bounces or chatters on the way. Uplift and opening are above
the place of a point at rest.
"""

import math
from typing import Any

import numpy as np

from contact.arrays import FloatArray
from contact.jit import compiled, inlined
from contact.stepping.body import ANGULAR_VELOCITY, CENTRE_X, POTENTIAL, ROTATION, State
from contact.stepping.ledger import FRICTION, work_of_lift
from contact.stepping.modes import FALLEN, REST, ROCK, ROCKING, SLIDE, SLIDE_ROCK
from contact.stepping.scheme import hermite

NEVER = math.inf  #: time of an event that has not happened

#: gap of an open base, over the width
OPENING = 1e-9
#: gap whose closing counts as an impact, over width times slenderness angle
IMPACT_GAP = 1e-3
#: angular velocity over that at the landing of a corner, at least, with which the other corner leaves the floor; a
#: container that turns less has come to lie on its base
TURNING_ON = 0.05
#: outer part of the base about which the body turns when the rest is open, over the width
PIVOT = 0.15
ROLLING_PIVOT = 0.5  #: .. of a base that rolls: the side away from where it touches carries nothing
#: friction heat between the turning points around an impact, over the energy before it, from which it slides: unloading
#: points slip a little at every impact
SLIDING_HEAT = 0.02

PARTS = 8  #: of the window of the corner force, by which it slides

OBSERVABLES = np.dtype(
    [
        ("max_rotation", "f8"),
        ("max_rocking", "f8"),  # largest rotation while a side carries nothing
        ("max_uplift", "f8"),
        ("max_flight", "f8"),  # largest gap of the base point nearest to the floor
        ("max_penetration", "f8"),
        ("max_corner_force", "f8"),  # largest mean over `Control.force_window`
        ("peak_corner_force", "f8"),  # the instantaneous one
        ("left_force", "f8"),  # at the end of the last step
        ("right_force", "f8"),
        ("impulses", "f8", (PARTS, 3)),  # of each part of the window: its time, and at the left and the right
        ("part", "i8"),  # the one that is being integrated
        ("rocking_time", "f8"),  # with a rotation beyond `ROCKING`
        ("flight_time", "f8"),  # .. and no contact force
        ("max_top_displacement", "f8"),
        ("max_acceleration", "f8"),
        ("first_opening", "f8"),
        ("first_uplift", "f8"),
        ("overturned_at", "f8"),
        ("impacts", "i8"),
        ("first_impact", "f8"),
        ("modes", "i8"),
        ("mode", "i8"),
        ("left_open", "i8"),  # 1 while the left side carries nothing
        ("right_open", "i8"),
        ("turning_energy", "f8"),  # above rest, at the last turning point before the first impact
        ("work_before", "f8"),  # of the floor's motion, from there to the first impact
        ("work_after", "f8"),  # .. and since
        ("heat", "f8"),  # of friction, since that turning point
        ("restitution", "f8"),  # of the first impact
    ],
    align=True,
)


def make_observables() -> Any:
    """A record array (1,) of OBSERVABLES at the start."""
    track = np.zeros(1, OBSERVABLES)
    for name in ("first_opening", "first_uplift", "overturned_at", "first_impact"):
        track[name] = NEVER
    for name in ("restitution", "turning_energy"):
        track[name] = np.nan
    return track.view(np.recarray)


@inlined
def bearing_place(
    contact: Any, along: FloatArray, state: State, begin: int, end: int, otherwise: float
) -> float:
    """Where a base stands on what is below it: the slip is how far this has moved [m].

    The place of a point is how far it is from where it is `along` the undeformed base, less what its stuck spring has
    given way. They are weighted by the normal forces; in the air the point nearest to the ground counts. So rocking
    from corner to corner moves nothing, a flight moves what the base moves, and an upright container has moved as far
    as its mass centre. `otherwise` is returned where no point is on its face, as of a box that has fallen off.
    """
    total, place, lowest, nearest = 0.0, 0.0, math.inf, otherwise
    for i in range(begin, end):
        if contact.normal_stiffness[i] <= 0.0:
            continue
        moved = state.point[i, 0] - along[i]
        if state.force[i, 1] > 0.0:
            total += state.force[i, 1]
            place += state.force[i, 1] * (moved - state.stick[i])
        if state.point[i, 1] < lowest:
            lowest, nearest = state.point[i, 1], moved
    return place / total if total > 0.0 else nearest


@compiled(inline=True)
def pivot_length(control: Any) -> float:
    """Length of the outer part of the base about which the body turns when the rest is open [m]."""
    return (ROLLING_PIVOT if control.rolls else PIVOT) * control.width


def record_start(track: Any, control: Any, camber: FloatArray, state: State) -> None:
    """Record the initial state: a container may start tilted, with an open side; `camber` of its points (n,) [m]."""
    n = control.base_points
    gap, x = state.point[:n, 1], state.point[:n, 0]
    closed = gap <= 0.0
    pivot = pivot_length(control)
    left_open = int(not np.any(closed & (x < x[-1] - pivot)))
    right_open = int(not np.any(closed & (x > x[0] + pivot)))
    rotation, highest = float(abs(state.pose[ROTATION])), float((gap - camber[:n]).max())
    middle = 0.5 * (x[0] + x[-1])
    left = float(state.force[:n][x < middle, 1].sum())
    right = float(state.force[:n][x >= middle, 1].sum())
    mode = ROCK if left_open + right_open > 0 and rotation > ROCKING * control.slenderness_angle else REST
    begun = {
        "left_open": left_open,
        "right_open": right_open,
        "max_rotation": rotation,
        "max_uplift": max(0.0, highest),
        "max_penetration": max(0.0, -float(gap.min())),
        "left_force": left,
        "right_force": right,
        "max_corner_force": max(left, right),
        "peak_corner_force": max(left, right),
        "mode": mode,
        "modes": 1 << mode,
    }
    if highest > OPENING * control.width:
        begun["first_opening"] = 0.0
    if left_open + right_open == 1:
        begun |= {"first_uplift": 0.0, "max_rocking": rotation}
    for name, value in begun.items():  # by item: attribute access of a record takes ten times as long
        track[name] = value


@inlined
def update_observables(run: Any, step: float) -> None:
    """Update the observables of a run with the step [s] about to be accepted."""
    track, joint, control = run.track[0], run.joints[0], run.problem.control
    old, new, camber = run.old, run.attempt.new, run.problem.contact.camber
    n, time = control.base_points, run.clock[0].time + step
    rotation = new.pose[ROTATION]
    track.max_rotation = max(track.max_rotation, abs(rotation))
    before, after = old.pose[ANGULAR_VELOCITY], new.pose[ANGULAR_VELOCITY]
    if before * after < 0.0:  # it turned round within the step
        share = before / (before - after)
        peak = hermite(share, step, old.pose[ROTATION], before, rotation, after)
        track.max_rotation = max(track.max_rotation, abs(peak))
    left_open, right_open, uplift, left_force, right_force = 1, 1, 0.0, 0.0, 0.0
    lowest = math.inf
    first, last = new.point[0, 0], new.point[n - 1, 0]
    pivot = pivot_length(control)
    for i in range(n):
        gap, x = new.point[i, 1], new.point[i, 0]
        rise = gap - camber[i]
        uplift = max(uplift, rise)
        lowest = min(lowest, gap)
        track.max_penetration = max(track.max_penetration, -gap)
        if rise > OPENING * control.width and time < track.first_opening:
            track.first_opening = time
        if x < 0.5 * (first + last):
            left_force += new.force[i, 1]
        else:
            right_force += new.force[i, 1]
        if gap <= 0.0 and x < last - pivot:
            left_open = 0
        if gap <= 0.0 and x > first + pivot:
            right_open = 0
    track.max_uplift = max(track.max_uplift, uplift)
    track.max_flight = max(track.max_flight, lowest)
    part = track.impulses[track.part]
    part[0] += step
    part[1] += 0.5 * step * (track.left_force + left_force)
    part[2] += 0.5 * step * (track.right_force + right_force)
    track.left_force, track.right_force = left_force, right_force
    track.peak_corner_force = max(track.peak_corner_force, max(left_force, right_force))
    if part[0] >= control.force_window / PARTS:  # the mean over the last window may be the largest one
        window = control.force_window
        wanted, left, right, k = window, 0.0, 0.0, 0
        while wanted > 1e-9 * window and k < PARTS:  # one turn where a step is longer than the window
            part, k = track.impulses[(track.part - k) % PARTS], k + 1
            share = min(1.0, wanted / part[0]) if part[0] > 0.0 else 0.0
            left += share * part[1]
            right += share * part[2]
            wanted -= share * part[0]
        if wanted <= 1e-9 * window:
            track.max_corner_force = max(track.max_corner_force, max(left, right) / window)
        track.part = (track.part + 1) % PARTS
        track.impulses[track.part, :] = 0.0
    if abs(rotation) > ROCKING * control.slenderness_angle:
        track.rocking_time += step
        if left_force + right_force <= 0.0:
            track.flight_time += step
    if left_open + right_open == 1 and time < track.first_uplift:
        track.first_uplift = time
    open_side = left_open + right_open > 0
    if open_side:
        track.max_rocking = max(track.max_rocking, abs(rotation))
    rocking = open_side and abs(rotation) > ROCKING * control.slenderness_angle
    track.mode = (ROCK if rocking else REST) + (SLIDE if joint.slides == 1 else REST)
    if track.overturned_at < time:
        track.mode = FALLEN
    track.modes |= 1 << track.mode
    track.left_open, track.right_open = left_open, right_open
    counts = IMPACT_GAP * control.width * control.slenderness_angle
    rocks = not control.rolls and track.modes & (1 << ROCK | 1 << SLIDE_ROCK) != 0
    were, are = (old.point[0, 1], old.point[n - 1, 1]), (new.point[0, 1], new.point[n - 1, 1])
    if lands(joint, counts, were, are, before, rocks):
        track.impacts += 1
        track.first_impact = min(track.first_impact, time)
    follow_restitution(run, step)


@inlined
def lands(
    joint: Any,
    counts: float,
    before: tuple[float, float],
    after: tuple[float, float],
    rate: float,
    rocks: bool,
) -> bool:
    """Whether an impact that counts falls in this step; written to the record of the joint where it does.

    `counts`: gap whose closing counts [m]; `before`, `after`: gaps at its left and right side at both ends of the step
    [m]; `rate`: angular velocity of what is on the joint, before the step [rad/s]; `rocks`: it has rocked.
    """
    if after[0] > 0.0 and after[1] <= 0.0:
        joint.left_gap = max(joint.left_gap, after[0])
    if after[1] > 0.0 and after[0] <= 0.0:
        joint.right_gap = max(joint.right_gap, after[1])
    struck = 0
    if after[0] <= 0.0 < before[0]:
        struck = -1 if joint.left_gap > counts else 0
        joint.left_gap = 0.0
    if after[1] <= 0.0 < before[1]:
        struck = 1 if joint.right_gap > counts else struck
        joint.right_gap = 0.0
    if struck == 0 or not rocks:
        return False
    joint.landed, joint.landing_rate = struck, struck * rate
    return True


@inlined
def exchanges_pivot(joint: Any, gaps: tuple[float, float], rate: float) -> int:
    """The side that becomes the pivot with this step: -1 left, 1 right, 0 none; called at every step.

    The last landing exchanges the pivot when what landed, which still turns at a `rate`, has lifted its other side.
    """
    landed = joint.landed
    if landed == 0:
        return 0
    turns = joint.landing_rate > 0.0 and landed * rate > TURNING_ON * joint.landing_rate
    lifted = gaps[0 if landed == 1 else 1] > 0.0
    if turns and not lifted:
        return 0
    joint.landed = 0
    return landed if turns else 0


@compiled(inline=True)
def lifting_energy(control: Any, state: State, floor: float, sunk: float) -> float:
    """Gravity potential above that of the container standing upright at its place on the floor, lower by `sunk` [J]."""
    downhill = control.mass * control.downhill * (state.pose[CENTRE_X] - floor)
    return state.energy[POTENTIAL] - control.resting_energy + control.mass * control.gravity * sunk + downhill


@inlined
def follow_restitution(run: Any, step: float) -> None:
    """Restitution of the first impact: root of the energy of rocking after it over that before.

    Energy of rocking is the potential energy above rest at a turning point. The work of the floor's motion between a
    turning point and the impact is added to it, so both energies are those at the impact: of a rigid block, half its
    inertia about the pivot times the angular velocity squared. Vibration of the container or its contact does not
    enter. Where the floor is crushed, "at rest" is upright at the height of the corner about which the container turns.
    Bounces on the way from one turning point to the other belong to the impact. There is no restitution if the
    container slides on the way (`SLIDING_HEAT`), or if it does not turn.
    """
    track, control, old, new = run.track[0], run.problem.control, run.old, run.attempt.new
    floor = run.floor
    moved = new.pose[CENTRE_X] - old.pose[CENTRE_X] - (floor[1, 0] - floor[0, 0])
    work = -control.mass * (floor[1, 1] - floor[0, 1]) / step * moved
    work += work_of_lift(control.mass, old.pose, new.pose, run.lift, step)
    work += control.mass * control.downhill * moved
    track.heat += run.attempt.change[FRICTION]
    if track.impacts == 0:
        track.work_before += work
    else:
        track.work_after += work
    before, after = old.pose[ANGULAR_VELOCITY], new.pose[ANGULAR_VELOCITY]
    aside = abs(new.pose[ROTATION]) > ROCKING * control.slenderness_angle
    if not (before * after < 0.0 or before == 0.0) or not aside or track.left_open + track.right_open != 1:
        return
    sunk, sinks = old.crushed[0], new.crushed[0]
    if track.left_open == 1:
        last = control.base_points - 1
        sunk, sinks = old.crushed[last], new.crushed[last]
    energy = max(
        lifting_energy(control, old, floor[0, 0], sunk), lifting_energy(control, new, floor[1, 0], sinks)
    )
    if track.impacts == 0:
        track.turning_energy = energy
        track.work_before, track.work_after, track.heat = 0.0, 0.0, 0.0
    elif track.turning_energy > 0.0:
        before, after = track.turning_energy + track.work_before, energy - track.work_after
        if before > 0.0 and track.heat <= SLIDING_HEAT * before:
            track.restitution = math.sqrt(max(after, 0.0) / before)
        track.turning_energy = np.nan
