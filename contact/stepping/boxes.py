"""What the boxes of a loose stack, or bodies in a row, do: rotations, openings, hits, falls."""

import math

from contact.jit import compiled, inlined
from contact.stepping.body import ANGULAR_VELOCITY, CENTRE_X, CENTRE_Z, ROTATION
from contact.stepping.joints import in_a_row, points_of
from contact.stepping.links import follow_touch
from contact.stepping.modes import REST, ROCK, ROCKING, SLIDE, SLIDE_ROCK
from contact.stepping.observables import NEVER, OPENING
from contact.stepping.scheme import hermite
from contact.stepping.state import RunState

OVERTURNING_ROTATION = 0.5 * math.pi
#: without stop at overturning, it counts this much earlier, where the side of the container meets the floor [rad]
LYING_MARGIN = 2e-3
POINTS_OF_GAP = 4  #: contact points of two bodies that face each other


@compiled
def follow_boxes(run: RunState, step: float, apart: float) -> None:
    """Update openings, rotations, falls, gaps and the mode of a loose stack from the step about to be accepted.

    A box falls when it has turned by 90 degrees, or when a corner of an upper box meets the floor. `apart`: see
    `links.follow_touch`.
    """
    new, track, control = run.attempt.new, run.track[0], run.problem.control
    rocks, slides = track.mode in (ROCK, SLIDE_ROCK), track.mode in (SLIDE, SLIDE_ROCK)
    for j in range(run.joints.shape[0]):
        joint, old, box = run.joints[j], run.old.boxes[j], new.boxes[j]
        before, after = old[ANGULAR_VELOCITY], box[ANGULAR_VELOCITY]
        joint.max_rotation = max(joint.max_rotation, abs(box[ROTATION]))
        if before * after < 0.0:  # it turned round within the step
            share = before / (before - after)
            peak = hermite(share, step, old[ROTATION], before, box[ROTATION], after)
            joint.max_rotation = max(joint.max_rotation, abs(peak))
        joint.opens = 0.0
        begin, end = points_of(run, j)
        for i in range(begin, end):
            if run.problem.contact.normal_stiffness[i] > 0.0:
                joint.opens = max(joint.opens, new.point[i, 1])
        joint.max_opening = max(joint.max_opening, joint.opens)
        fallen = abs(box[ROTATION]) >= OVERTURNING_ROTATION
        if joint.below >= 0:
            leaning = abs(box[ROTATION] - new.boxes[j - 1, ROTATION]) > ROCKING * control.slenderness_angle
            rocks = rocks or (joint.opens > OPENING * control.width and leaning)
            slides = slides or joint.slides == 1
            for c in range(4 * j, 4 * j + 4):
                fallen = fallen or new.corner[c, 1] <= 0.0
        if fallen and joint.fell_at == NEVER:
            joint.fell_at = run.clock[0].time + step
    track.mode = (ROCK if rocks else REST) + (SLIDE if slides else REST)
    track.modes |= 1 << track.mode
    last = run.joints.shape[0] - 1
    for g in range(last if in_a_row(run) else 0):  # the force in a gap is that of its four points together
        first = run.joints[last].end + POINTS_OF_GAP * g
        before, after, force, speed = NEVER, NEVER, 0.0, 0.0
        for i in range(first, first + POINTS_OF_GAP):
            now, then = new.point[i, 1], run.old.point[i, 1]
            before = min(before, then)
            # a point of no weight is a corner beside the other body's side: its distance says nothing of the gap
            if run.problem.contact.normal_stiffness[i] > 0.0:
                after = min(after, now)
            force += new.force[i, 1]
            if now < 0.0 <= then:
                speed = max(speed, run.old.descent[i, 0])
                if run.clock[0].steps == 0:  # the velocity of a touch at t = 0 follows from the step alone
                    speed = max(speed, (then - now) / step)
        follow_touch(run.links[g], force, (before, after), speed, apart)


@inlined
def has_fallen(run: RunState) -> bool:
    """Whether the container has overturned, or a box of a loose stack or a body of a row has fallen."""
    if run.joints.shape[0] == 1:
        lying = 0.0 if run.problem.control.stop_when_overturned else LYING_MARGIN
        return bool(abs(run.old.pose[ROTATION]) >= OVERTURNING_ROTATION - lying)
    fallen = False
    for j in range(run.joints.shape[0]):
        fallen = fallen or run.joints[j].fell_at < NEVER
    return fallen


@inlined
def rotation_of(run: RunState, j: int) -> float:
    """Rotation of a box of a loose stack or a body of a row, or of a body that moves as one [rad]."""
    return float(run.old.pose[ROTATION] if run.joints.shape[0] == 1 else run.old.boxes[j, ROTATION])


@inlined
def has_footing(run: RunState, j: int) -> bool:
    """Whether what stands on a joint rests by itself: beyond its slenderness angle it leans or hangs on a tie.

    On a box its mass centre must be between the ends of the face below.
    """
    if run.joints[j].below < 0:
        return bool(abs(rotation_of(run, j)) <= run.joints[j].angle)
    left, right = run.old.corner[4 * j - 2], run.old.corner[4 * j - 1]
    x = run.old.boxes[j, CENTRE_X] - run.floor[0, 0] - left[0]
    z = run.old.boxes[j, CENTRE_Z] - run.lift[0, 0] - left[1]
    along, up = right[0] - left[0], right[1] - left[1]
    return bool(0.0 <= x * along + z * up <= along * along + up * up)


@inlined
def is_unsettled(run: RunState) -> bool:
    """Whether a box has lost its footing, or is beyond the slenderness angle of its stack."""
    unsettled = False
    for j in range(run.joints.shape[0]):
        turned = abs(rotation_of(run, j)) > run.joints[j].angle
        unsettled = unsettled or turned or not has_footing(run, j)
    return unsettled
