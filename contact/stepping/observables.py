"""Observables of a run, updated at every step: extremes, events, impacts, restitution.

A side is open, and the body turns about the other one, when only the outer part of the base at the other side is in
contact: a flat base on an elastic bed opens at one edge long before that. The corners are the first and the last
base point. An impact counts if a corner closes whose gap had exceeded a thousandth of width times slenderness angle
while the other corner was the pivot.
"""

import math
from typing import Any

import numpy as np
from numba.extending import register_jitable

from contact.stepping.body import ANGULAR_VELOCITY, POTENTIAL, ROTATION, State
from contact.stepping.scheme import hermite

NEVER = math.inf  #: time of an event that has not happened

#: gap of an open base, over the width
OPENING = 1e-9
#: gap whose closing counts as an impact, over width times slenderness angle
IMPACT_GAP = 1e-3
#: averaging time of the angular velocity after an impact, which rings, over 1/p
AVERAGED = 0.1
#: averaging time of corner forces, over 1/p: dashpots make the instantaneous force meaningless
FORCE_WINDOW = 0.01
#: outer part of the base about which the body turns when the rest is open, over the width
PIVOT = 0.15
#: rotation ratio above which motion with an open side is rocking
ROCKING = 0.01

#: modes of motion as stored in a history, and as bits in `modes`
REST, SLIDE, ROCK, SLIDE_ROCK, FALLEN = 0, 1, 2, 3, 4

OBSERVABLES = np.dtype(
    [
        ("max_rotation", "f8"),
        ("max_rocking", "f8"),  # largest rotation while a side carries nothing
        ("max_slip", "f8"),
        ("slip_travel", "f8"),
        ("max_uplift", "f8"),
        ("max_penetration", "f8"),
        ("max_corner_force", "f8"),  # mean over a short time
        ("peak_corner_force", "f8"),  # the instantaneous one
        ("left_force", "f8"),  # at the end of the last step
        ("right_force", "f8"),
        ("impulse_time", "f8"),  # over which the impulses were integrated
        ("left_impulse", "f8"),
        ("right_impulse", "f8"),
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
        ("left_gap", "f8"),  # largest gap of this corner since it opened with the other as pivot
        ("right_gap", "f8"),
        ("peak_energy", "f8"),  # potential energy above rest at the last turning point
        ("restitution_by_peaks", "f8"),
        ("angular_acceleration", "f8"),  # angular acceleration over the last step
        ("rigid_gain", "f8"),  # change of a rigid block's angular velocity since the first impact
        ("averaging_time", "f8"),  # over which the angular velocity has been averaged
        ("mean_velocity", "f8"),
        ("velocity_before", "f8"),  # angular velocity just before the first impact
        ("new_pivot", "i8"),  # pivot before the first impact: -1 left, +1 right, 0 none
        ("restitution_by_velocity", "f8"),
    ],
    align=True,
)


def make_observables() -> Any:
    """A record array (1,) of OBSERVABLES at the start."""
    track = np.zeros(1, OBSERVABLES).view(np.recarray)
    for name in ("first_opening", "first_uplift", "overturned_at", "first_impact"):
        track[name] = NEVER
    for name in ("restitution_by_peaks", "restitution_by_velocity", "peak_energy", "velocity_before"):
        track[name] = np.nan
    return track


def record_start(track: Any, control: Any, state: State) -> None:
    """Record the initial state: a container may start tilted, with an open side."""
    n = control.base_points
    gap, x = state.point[:n, 1], state.point[:n, 0]
    closed = gap <= 0.0
    left_open = int(not np.any(closed & (x < x[-1] - PIVOT * control.width)))
    right_open = int(not np.any(closed & (x > x[0] + PIVOT * control.width)))
    rotation, highest = float(abs(state.pose[ROTATION])), float(gap.max())
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


@register_jitable(forceinline=True)
def update_observables(
    track: Any,
    control: Any,
    old: State,
    new: State,
    time: float,
    step: float,
    sliding: bool,
    slip: float,
    slip_step: float,
    floor_acceleration: float,
) -> None:
    """Update the observables with the accepted step from `old` to `new`.

    Args:
        track: record of OBSERVABLES.
        control: the stepping's `Control`: constants of the container.
        old, new: states at both ends of the step.
        time: at its end [s]; step: its length [s].
        sliding: every loaded point slides.
        slip: container against floor so far, signed [m]; slip_step: of this step [m].
        floor_acceleration: at the end of the step [m/s2].
    """
    n = control.base_points
    rotation = new.pose[ROTATION]
    track.max_rotation = max(track.max_rotation, abs(rotation))
    before, after = old.pose[ANGULAR_VELOCITY], new.pose[ANGULAR_VELOCITY]
    if before * after < 0.0:  # it turned round within the step
        share = before / (before - after)
        peak = hermite(share, step, old.pose[ROTATION], before, rotation, after)
        track.max_rotation = max(track.max_rotation, abs(peak))
    track.max_slip = max(track.max_slip, abs(slip))
    track.slip_travel += abs(slip_step)
    left_open, right_open, uplift, left_force, right_force = 1, 1, 0.0, 0.0, 0.0
    first, last = new.point[0, 0], new.point[n - 1, 0]
    for i in range(n):
        gap, x = new.point[i, 1], new.point[i, 0]
        uplift = max(uplift, gap)
        track.max_penetration = max(track.max_penetration, -gap)
        if gap > OPENING * control.width and time < track.first_opening:
            track.first_opening = time
        if x < 0.5 * (first + last):
            left_force += new.force[i, 1]
        else:
            right_force += new.force[i, 1]
        if gap <= 0.0 and x < last - PIVOT * control.width:
            left_open = 0
        if gap <= 0.0 and x > first + PIVOT * control.width:
            right_open = 0
    track.max_uplift = max(track.max_uplift, uplift)
    track.left_impulse += 0.5 * step * (track.left_force + left_force)
    track.right_impulse += 0.5 * step * (track.right_force + right_force)
    track.left_force, track.right_force = left_force, right_force
    track.peak_corner_force = max(track.peak_corner_force, max(left_force, right_force))
    track.impulse_time += step
    if track.impulse_time >= FORCE_WINDOW / control.frequency_parameter:
        mean = max(track.left_impulse, track.right_impulse) / track.impulse_time
        track.max_corner_force = max(track.max_corner_force, mean)
        track.left_impulse, track.right_impulse, track.impulse_time = 0.0, 0.0, 0.0
    if left_open + right_open == 1 and time < track.first_uplift:
        track.first_uplift = time
    open_side = left_open + right_open > 0
    if open_side:
        track.max_rocking = max(track.max_rocking, abs(rotation))
    rocking = open_side and abs(rotation) > ROCKING * control.slenderness_angle
    track.mode = (ROCK if rocking else REST) + (SLIDE if sliding else REST)
    if track.overturned_at < time:
        track.mode = FALLEN
    track.modes |= 1 << track.mode
    track.left_open, track.right_open = left_open, right_open
    struck = find_impact(track, control, old, new, step)
    follow_restitution(track, control, old, new, time, step, struck, floor_acceleration)
    track.angular_acceleration = (new.pose[ANGULAR_VELOCITY] - old.pose[ANGULAR_VELOCITY]) / step


@register_jitable(forceinline=True)
def find_impact(track: Any, control: Any, old: State, new: State, step: float) -> int:
    """Corner of a counted impact in this step: -1 left, +1 right, 0 none."""
    last = control.base_points - 1
    counts = IMPACT_GAP * control.width * control.slenderness_angle
    left, right = new.point[0, 1], new.point[last, 1]
    if left > 0.0 and right <= 0.0:
        track.left_gap = max(track.left_gap, left)
    if right > 0.0 and left <= 0.0:
        track.right_gap = max(track.right_gap, right)
    struck = 0
    if left <= 0.0 and old.point[0, 1] > 0.0:
        if track.left_gap > counts:
            struck = -1
        track.left_gap = 0.0
    if right <= 0.0 and old.point[last, 1] > 0.0:
        if track.right_gap > counts:
            struck = 1
        track.right_gap = 0.0
    if struck != 0:
        track.impacts += 1
    return struck


@register_jitable(forceinline=True)
def follow_restitution(
    track: Any,
    control: Any,
    old: State,
    new: State,
    time: float,
    step: float,
    struck: int,
    floor_acceleration: float,
) -> None:
    """Restitution of the first impact, from angular velocities and from the heights of the peaks around it.

    The impact has a duration and causes ringing. So the velocity after it is a mean over `AVERAGED`, after subtracting
    the change that a rigid block rocking about the new pivot would have had since the impact.
    """
    velocity = new.pose[ANGULAR_VELOCITY]
    if struck != 0 and track.impacts == 1:
        corner = 0 if struck < 0 else control.base_points - 1
        gap, depth = old.point[corner, 1], -new.point[corner, 1]
        track.first_impact = time
        track.velocity_before = old.pose[ANGULAR_VELOCITY] + track.angular_acceleration * step * gap / (
            gap + depth
        )
        track.new_pivot = -struck
    elif track.new_pivot != 0:
        corner = control.base_points - 1 if track.new_pivot > 0 else 0
        lean = -track.new_pivot * control.slenderness_angle - new.pose[ROTATION]
        pull = math.sin(lean) + floor_acceleration / control.gravity * math.cos(lean)
        track.rigid_gain -= step * control.frequency_parameter**2 * pull
        if new.point[corner, 1] > IMPACT_GAP * control.width * control.slenderness_angle:
            track.mean_velocity += step * (velocity - track.rigid_gain)
            track.averaging_time += step
        if struck != 0 or track.averaging_time >= AVERAGED / control.frequency_parameter:
            if track.averaging_time >= 0.5 * AVERAGED / control.frequency_parameter:
                ratio = track.mean_velocity / (track.averaging_time * track.velocity_before)
                if ratio > 0.0:  # otherwise it did not change to the new pivot, and there is no ratio
                    track.restitution_by_velocity = ratio
            track.new_pivot = 0
    turned = old.pose[ANGULAR_VELOCITY] * velocity < 0.0 or old.pose[ANGULAR_VELOCITY] == 0.0
    aside = abs(new.pose[ROTATION]) > ROCKING * control.slenderness_angle
    if turned and aside and track.left_open + track.right_open == 1:
        energy = max(old.energy[POTENTIAL], new.energy[POTENTIAL]) - control.resting_energy
        if track.impacts == 1 and not track.restitution_by_peaks >= 0.0 and track.peak_energy > 0.0:
            track.restitution_by_peaks = math.sqrt(max(energy, 0.0) / track.peak_energy)
        if track.impacts == 0:
            track.peak_energy = energy
