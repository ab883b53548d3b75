"""Restitution asked of the impacts: what the exchange of the pivot takes from the rocking, or returns to it.

When one corner has landed and the other leaves the floor, the angular momentum of the container about the landed
corner, relative to the floor, is multiplied by `control.impact_share`: a rigid motion about this corner is subtracted,

    turn = (1 - share) H/I,   H = sum m (r_z v_x - r_x v_z) + I_c w,   I = sum m r^2 + I_c,   r from the corner,

which costs the energy (1 - share^2) H^2/(2 I). The forces of the impact act at this corner and leave H alone, so the
instant within the impact does not matter: the angular velocity becomes `share` times what the impact itself leaves,
Housner's on two corners (BSSA 53, 1963). Slip and hop of the corner and the vibration of the container do not change.
"""

from typing import Any

from contact.jit import inlined
from contact.stepping.body import (
    ANGULAR_VELOCITY,
    CENTRE_X,
    CENTRE_Z,
    KINETIC,
    VELOCITY_X,
    VELOCITY_Z,
    complete,
    shift_velocity,
)
from contact.stepping.joints import points_of
from contact.stepping.ledger import BASE_WORK, IMBALANCE, IMPACTS
from contact.stepping.links import links_of, shift_links
from contact.stepping.state import RunState
from contact.stepping.step import indent


@inlined
def lose_at_impact(body: Any, run: RunState, landed: int, loose: bool | None) -> None:
    """Multiply the angular momentum about a corner in the attempted step's new state, and book it.

    Args:
        landed: -1 the left corner, 1 the right one.
        loose: of a loose stack, see `contact.stepping.body.stands_loose`.
    """
    new, control, change = run.attempt.new, run.problem.control, run.attempt.change
    corner = 0 if landed == -1 else control.base_points - 1
    x = new.point[corner, 0] + run.floor[1, 0]
    z = new.point[corner, 1] - new.crushed[corner] + run.lift[1, 0]
    momentum, inertia, moment = 0.0, 0.0, 0.0
    for j in range(run.joints.shape[0]):
        pose = new.pose
        if loose is not None:
            pose = new.boxes[j]
        mass, own = run.joints[j].mass, run.joints[j].inertia
        arm_x, arm_z = pose[CENTRE_X] - x, pose[CENTRE_Z] - z
        velocity_x, velocity_z = pose[VELOCITY_X] - run.floor[1, 1], pose[VELOCITY_Z] - run.lift[1, 1]
        momentum += mass * (arm_z * velocity_x - arm_x * velocity_z) + own * pose[ANGULAR_VELOCITY]
        inertia += mass * (arm_x * arm_x + arm_z * arm_z) + own
        moment += mass * arm_z
    turn = (1.0 - control.impact_share) * momentum / inertia
    kinetic = new.energy[KINETIC]
    shift_velocity(body, new, -turn * z, turn * x, turn)
    complete(body, new, run.floor[1, 0], run.lift[1, 0], run.lift[1, 1])
    begin, end = points_of(run, 0)
    for i in range(begin, end):
        new.drift[i, 0] -= turn * (new.point[i, 1] - new.point[corner, 1])
        new.descent[i, 0] -= turn * (new.point[i, 0] - new.point[corner, 0])
    shift_links(run, links_of(body), turn, new.point[corner, 0], new.point[corner, 1])
    indent(run.problem.contact, new.point, new.crushed)  # behind the arms, which are of heights, not of gaps
    lost = (1.0 - control.impact_share**2) * momentum * momentum / (2.0 * inertia)
    work = -turn * moment * run.floor[1, 1]
    change[IMPACTS] += lost
    change[BASE_WORK] += work
    change[IMBALANCE] += work - lost - (new.energy[KINETIC] - kinetic)
