"""Restitution asked of the impacts: what the exchange of the pivot takes from the rocking, or returns to it.

When one corner has landed and the other leaves the floor, the angular momentum of the container about the landed
corner, relative to the floor, is multiplied by `impact_share`: a rigid motion about this corner is subtracted,

    turn = (1 - share) H/I,   H = sum m (r_z v_x - r_x v_z) + I_c w,   I = sum m r^2 + I_c,   r from the corner,

which costs the energy (1 - share^2) H^2/(2 I). The forces of the impact act at this corner and leave H alone, so the
instant within the impact does not matter: the angular velocity becomes `share` times what the impact itself leaves,
Housner's on two corners (BSSA 53, 1963). Slip and hop of the corner and the vibration of the container do not change.

Each container of a row exchanges its own pivot. In a loose stack all boxes turn with the lowest one; one that lands on
a box turns with those on it, if all below stand and stick: the floor takes the reaction. Otherwise it would have to
move the box below, and the impact keeps what its contact leaves.
"""

from typing import Any

from contact.jit import inlined
from contact.stepping import body as interface
from contact.stepping.body import State
from contact.stepping.joints import carrier_of, in_a_row, points_of, touching_corner
from contact.stepping.ledger import BASE_WORK, IMBALANCE, IMPACTS
from contact.stepping.links import links_of, shift_links
from contact.stepping.modes import ROCKING
from contact.stepping.observables import IMPACT_GAP, exchanges_pivot, lands
from contact.stepping.state import RunState
from contact.stepping.step import indent


@inlined
def lose_at_impacts(body: Any, run: RunState, loose: bool | None) -> None:
    """Exchange the pivots that are due in the step about to be accepted; the container's landing is known already."""
    new = run.attempt.new
    for j in range(run.joints.shape[0]):
        joint = run.joints[j]
        if joint.impact_share == 1.0:
            continue
        after, gaps = new.pose, side_gaps(run, j, new)
        if loose is not None:
            after = new.boxes[j]
        if j > 0:
            counts = IMPACT_GAP * joint.width * joint.angle
            rocks = joint.max_opening > ROCKING * joint.width * joint.angle
            lands(
                joint,
                counts,
                side_gaps(run, j, run.old),
                gaps,
                run.old.boxes[j, interface.ANGULAR_VELOCITY],
                rocks,
            )
        landed = exchanges_pivot(joint, gaps, after[interface.ANGULAR_VELOCITY])
        if landed != 0 and carrier_of(run, j) < 0:
            lose_at_impact(body, run, j, landed, loose)


@inlined
def side_gaps(run: RunState, j: int, state: State) -> tuple[float, float]:
    """Gaps of a joint at its left and right side [m]; between boxes each side has a corner of either."""
    begin, end = points_of(run, j)
    left, right = state.point[begin, 1], state.point[end - 1, 1]
    if run.joints[j].below >= 0:
        left, right = min(left, state.point[begin + 1, 1]), min(right, state.point[end - 2, 1])
    return left, right


@inlined
def place_of(run: RunState, j: int, i: int) -> tuple[float, float]:
    """Place of point i, of joint j, in the attempted step's new state, over the floor [m]."""
    new = run.attempt.new
    if run.joints[j].below >= 0:
        corner = touching_corner(i)
        return new.corner[corner, 0], new.corner[corner, 1]
    return new.point[i, 0], new.point[i, 1] - new.crushed[i]


@inlined
def lose_at_impact(body: Any, run: RunState, j: int, landed: int, loose: bool | None) -> None:
    """Multiply the angular momentum about the `landed` corner (-1 left, 1 right) of joint j, and book it."""
    new, share, change = run.attempt.new, run.joints[j].impact_share, run.attempt.change
    begin, end = points_of(run, j)
    corner = begin if landed == -1 else end - 1
    if run.joints[j].below >= 0 and new.point[corner - landed, 1] < new.point[corner, 1]:
        corner -= landed
    left, up = place_of(run, j, corner)
    x, z = left + run.floor[1, 0], up + run.lift[1, 0]
    boxes = j + 1 if in_a_row(run) else run.joints.shape[0]
    momentum, inertia, moment = 0.0, 0.0, 0.0
    for b in range(j, boxes):
        pose = new.pose
        if loose is not None:
            pose = new.boxes[b]
        mass, own = run.joints[b].mass, run.joints[b].inertia
        arm_x, arm_z = pose[interface.CENTRE_X] - x, pose[interface.CENTRE_Z] - z
        velocity_x = pose[interface.VELOCITY_X] - run.floor[1, 1]
        velocity_z = pose[interface.VELOCITY_Z] - run.lift[1, 1]
        momentum += mass * (arm_z * velocity_x - arm_x * velocity_z) + own * pose[interface.ANGULAR_VELOCITY]
        inertia += mass * (arm_x * arm_x + arm_z * arm_z) + own
        moment += mass * arm_z
    turn = (1.0 - share) * momentum / inertia
    kinetic = new.energy[interface.KINETIC]
    for i in range(begin, end):
        point_x, point_z = place_of(run, j, i)
        new.drift[i, 0] -= turn * (point_z - up)
        new.descent[i, 0] -= turn * (point_x - left)
    interface.shift_velocity(body, new, (-turn * z, turn * x, turn), (j, boxes))
    interface.complete(body, new, run.floor[1, 0], run.lift[1, 0], run.lift[1, 1])
    shift_links(run, links_of(body), turn, left, up, j, boxes)
    # behind the arms, which are of heights, not of gaps
    indent(run.problem.contact, new.point, new.crushed)
    lost = (1.0 - share**2) * momentum * momentum / (2.0 * inertia)
    work = -turn * moment * run.floor[1, 1]
    change[IMPACTS] += lost
    change[BASE_WORK] += work
    change[IMBALANCE] += work - lost - (new.energy[interface.KINETIC] - kinetic)
