"""What a run is judged by, followed step by step: extremes, events, impacts, restitution.

A side is the base points left or right of the middle; it carries nothing when none of its points touches.
The corners are the first and the last base point. Definitions of impact and restitution as in the results'
description: an impact counts when a corner closes whose gap had exceeded a thousandth of width times slenderness
angle while the other was the pivot.
"""

import math
from typing import Any

import numpy as np
from numba.extending import register_jitable

from contact.body import ANGULAR_VELOCITY, POTENTIAL, ROTATION, State

NEVER = math.inf  #: time of an event that has not happened

#: a gap that counts as an opening of the base, over the width
OPENING = 1e-9
#: gap whose closing counts as an impact, over width times slenderness angle
IMPACT_GAP = 1e-3
#: an impact is over when the old pivot is open and the floor carries less than this times the weight
SETTLED_FORCE = 1.2
#: rotation ratio above which an open side is called rocking
ROCKING = 0.01

#: modes of motion as stored in a history, and as bits in `modes`
REST, SLIDE, ROCK, SLIDE_ROCK, FALLEN = 0, 1, 2, 3, 4

TRACK = np.dtype(
    [
        ("max_rotation", "f8"),
        ("max_rocking", "f8"),  # largest rotation while a side carries nothing
        ("max_slip", "f8"),
        ("slip_travel", "f8"),
        ("max_uplift", "f8"),
        ("max_penetration", "f8"),
        ("max_corner_force", "f8"),
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
        ("left_gap", "f8"),  # largest gap of that corner since it opened with the other as pivot
        ("right_gap", "f8"),
        ("peak_energy", "f8"),  # potential energy above rest at the last turning point
        ("restitution_by_peaks", "f8"),
        ("turning", "f8"),  # angular acceleration over the last step
        ("velocity_before", "f8"),  # angular velocity just before the first impact
        ("pivot_waiting", "i8"),  # the corner that was the pivot at the first impact: -1 left, +1 right, 0 none
        ("restitution_by_velocity", "f8"),
        ("first_peak_after", "f8"),
    ],
    align=True,
)


def make_track() -> Any:
    """A fresh record array (1,) of TRACK: nothing has happened yet."""
    track = np.zeros(1, TRACK).view(np.recarray)
    for name in ("first_opening", "first_uplift", "overturned_at", "first_impact"):
        track[name] = NEVER
    for name in ("restitution_by_peaks", "restitution_by_velocity", "peak_energy", "velocity_before", "first_peak_after"):
        track[name] = np.nan
    return track


@register_jitable
def follow(
    track: Any,
    old: State,
    new: State,
    time: float,
    step: float,
    slenderness_angle: float,
    width: float,
    resting_energy: float,
    sliding: bool,
    slip: float,
    slip_step: float,
    top_monitors: int,
    base_points: int,
    weight: float,
) -> None:
    """Update the record with the accepted step from `old` to `new`.

    Args:
        track: record of TRACK.
        old, new: states at both ends of the step.
        time: at its end [s]; step: its length [s].
        slenderness_angle: [rad]; width: [m].
        resting_energy: gravity potential of the container at rest [J].
        sliding: every loaded point slides.
        slip: container against floor so far, signed [m]; slip_step: of this step [m].
        top_monitors: the first so many monitored points lie at the top; the others in the contents.
        base_points: the first so many contact points make up the base.
        weight: of the container [N].
    """
    n = base_points
    rotation = new.pose[ROTATION]
    track.max_rotation = max(track.max_rotation, abs(rotation))
    track.max_slip = max(track.max_slip, abs(slip))
    track.slip_travel += abs(slip_step)
    left_open, right_open, uplift, left_force, right_force = 1, 1, 0.0, 0.0, 0.0
    middle = 0.5 * (new.point[0, 0] + new.point[n - 1, 0])
    for i in range(n):
        gap = new.point[i, 1]
        uplift = max(uplift, gap)
        track.max_penetration = max(track.max_penetration, -gap)
        if gap > OPENING * width and time < track.first_opening:
            track.first_opening = time
        closed = gap <= 0.0
        if new.point[i, 0] < middle:
            left_force += new.force[i, 1]
            if closed:
                left_open = 0
        else:
            right_force += new.force[i, 1]
            if closed:
                right_open = 0
    track.max_uplift = max(track.max_uplift, uplift)
    track.max_corner_force = max(track.max_corner_force, max(left_force, right_force))
    if left_open + right_open == 1 and time < track.first_uplift:
        track.first_uplift = time
    for i in range(top_monitors):
        track.max_top_displacement = max(track.max_top_displacement, abs(new.monitor[i, 0]))
    open_side = left_open + right_open > 0
    if open_side:
        track.max_rocking = max(track.max_rocking, abs(rotation))
    rocking = open_side and abs(rotation) > ROCKING * slenderness_angle
    track.mode = (ROCK if rocking else REST) + (SLIDE if sliding else REST)
    if track.overturned_at < time:
        track.mode = FALLEN
    track.modes |= 1 << track.mode
    track.left_open, track.right_open = left_open, right_open
    _follow_impacts(track, old, new, time, step, slenderness_angle, width, resting_energy, n, weight, left_force + right_force)
    track.turning = (new.pose[ANGULAR_VELOCITY] - old.pose[ANGULAR_VELOCITY]) / step


@register_jitable
def _follow_impacts(
    track: Any,
    old: State,
    new: State,
    time: float,
    step: float,
    slenderness_angle: float,
    width: float,
    resting_energy: float,
    n: int,
    weight: float,
    carried: float,
) -> None:
    counts = IMPACT_GAP * width * slenderness_angle
    left, right = new.point[0, 1], new.point[n - 1, 1]
    if left > 0.0 and right <= 0.0:
        track.left_gap = max(track.left_gap, left)
    if right > 0.0 and left <= 0.0:
        track.right_gap = max(track.right_gap, right)
    struck = 0
    if left <= 0.0 and old.point[0, 1] > 0.0:
        if track.left_gap > counts:
            struck = -1
        track.left_gap = 0.0
    if right <= 0.0 and old.point[n - 1, 1] > 0.0:
        if track.right_gap > counts:
            struck = 1
        track.right_gap = 0.0
    if struck != 0:
        track.impacts += 1
        if track.impacts == 1:
            track.first_impact = time
            corner = 0 if struck < 0 else n - 1
            gap, depth = old.point[corner, 1], -new.point[corner, 1]
            track.velocity_before = old.pose[ANGULAR_VELOCITY] + track.turning * step * gap / (gap + depth)
            track.pivot_waiting = -struck
    if track.pivot_waiting != 0:  # until the old pivot opens, and the body turns about the new one
        gap = left if track.pivot_waiting < 0 else right
        if gap > counts and carried < SETTLED_FORCE * weight:
            track.restitution_by_velocity = new.pose[ANGULAR_VELOCITY] / track.velocity_before
            track.pivot_waiting = 0
        elif track.impacts > 1:
            track.restitution_by_velocity = 0.0
            track.pivot_waiting = 0
    # A turning point: the angular velocity changes sign while a side is open.
    turned = old.pose[ANGULAR_VELOCITY] * new.pose[ANGULAR_VELOCITY] < 0.0 or old.pose[ANGULAR_VELOCITY] == 0.0
    if turned and (track.left_open + track.right_open == 1) and abs(new.pose[ROTATION]) > ROCKING * slenderness_angle:
        energy = max(old.energy[POTENTIAL], new.energy[POTENTIAL]) - resting_energy
        if track.impacts == 1 and not track.restitution_by_peaks >= 0.0 and track.peak_energy > 0.0:
            track.restitution_by_peaks = math.sqrt(max(energy, 0.0) / track.peak_energy)
            track.first_peak_after = abs(new.pose[ROTATION])
        if track.impacts == 0:
            track.peak_energy = energy
