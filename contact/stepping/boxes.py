"""What the boxes of a loose stack do: rotations, openings, falls; and when a container has fallen."""

import math

from contact.jit import compiled, inlined
from contact.stepping.body import ANGULAR_VELOCITY, CENTRE_X, CENTRE_Z, ROTATION
from contact.stepping.joints import points_of
from contact.stepping.observables import FALLEN, NEVER, OPENING, REST, ROCK, ROCKING, SLIDE, SLIDE_ROCK
from contact.stepping.scheme import hermite
from contact.stepping.state import RunState

OVERTURNING_ROTATION = 0.5 * math.pi
#: without stop at overturning, it counts this much earlier, where the side of the container meets the floor [rad]
LYING_MARGIN = 2e-3


@inlined
def follow_boxes(run: RunState, step: float, loose: bool | None) -> None:
    """Update openings, rotations, falls and the mode of a loose stack from the step about to be accepted."""
    if loose is not None:
        follow_stack(run, step)


@compiled
def follow_stack(run: RunState, step: float) -> None:
    """`follow_boxes` of a loose stack.

    A box falls when it has turned by 90 degrees, or when a corner of an upper box meets the floor.
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
        if j > 0:
            leaning = abs(box[ROTATION] - new.boxes[j - 1, ROTATION]) > ROCKING * control.slenderness_angle
            rocks = rocks or (joint.opens > OPENING * control.width and leaning)
            slides = slides or joint.slides == 1
            for c in range(4 * j, 4 * j + 4):
                fallen = fallen or new.corner[c, 1] <= 0.0
        if fallen and joint.fell_at == NEVER:
            joint.fell_at = run.clock[0].time + step
    track.mode = (ROCK if rocks else REST) + (SLIDE if slides else REST)
    track.modes |= 1 << track.mode


@inlined
def has_fallen(run: RunState) -> bool:
    """Whether the container has overturned, or a box of a loose stack has fallen."""
    if run.joints.shape[0] == 1:
        lying = 0.0 if run.problem.control.stop_when_overturned else LYING_MARGIN
        return bool(abs(run.old.pose[ROTATION]) >= OVERTURNING_ROTATION - lying)
    fallen = False
    for j in range(run.joints.shape[0]):
        fallen = fallen or run.joints[j].fell_at < NEVER
    return fallen


@inlined
def has_footing(run: RunState, j: int) -> bool:
    """Whether the mass centre of a box of a loose stack is between the ends of the face below."""
    if j == 0:
        return True
    left, right = run.old.corner[4 * j - 2], run.old.corner[4 * j - 1]
    x = run.old.boxes[j, CENTRE_X] - run.floor[0, 0] - left[0]
    z = run.old.boxes[j, CENTRE_Z] - run.lift[0, 0] - left[1]
    along, up = right[0] - left[0], right[1] - left[1]
    return bool(0.0 <= x * along + z * up <= along * along + up * up)


@inlined
def is_unsettled(run: RunState) -> bool:
    """Whether a box of a loose stack has lost its footing, or is beyond the slenderness angle of the stack."""
    unsettled = False
    for j in range(run.joints.shape[0]):
        turned = abs(run.old.boxes[j, ROTATION]) > run.problem.control.slenderness_angle
        unsettled = unsettled or turned or not has_footing(run, j)
    return unsettled


@inlined
def lose_footing(run: RunState) -> None:
    """Count the boxes without footing as fallen now."""
    for j in range(run.joints.shape[0]):
        if not has_footing(run, j):
            run.joints[j].fell_at = run.clock[0].time
            run.track[0].overturned_at = run.clock[0].time
            run.track[0].mode = FALLEN
            run.track[0].modes |= 1 << FALLEN
