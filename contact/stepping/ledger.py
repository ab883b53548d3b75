"""The energy ledger: energy terms of the container, and the energy error of the time stepping.

    change of (kinetic + strain + gravity + contact springs)
        = base work - friction - contact damping - material damping - crushing - impacts - imbalance

Heights and vertical velocities are relative to the floor: in the frame that moves up and down with it gravity is
g + a_v, and the work of the vertical floor motion is that of -m a_v. Along x the frame is at rest, and the work of the
floor is that of its friction. On a slope the gravity potential is that of the place on the floor; what gravity does
along the floor's own displacement belongs to the work of the floor, which vanishes where friction balances it. Each
term on the right but the last is integrated independently, by the trapezoidal rule over forces and motions at both ends
of a step. The imbalance is the remainder: > 0 numerical loss, < 0 numerical gain.
"""

from contact.arrays import FloatArray
from contact.interface.workspace import Contact
from contact.jit import compiled
from contact.stepping.body import CENTRE_Z

#: rows of the ledger [J]
BASE_WORK, FRICTION, CONTACT_DAMPING, MATERIAL_DAMPING, CRUSHING, IMPACTS, IMBALANCE = 0, 1, 2, 3, 4, 5, 6
ROWS = 7

#: limit of the energy gained at the end, over the energy to overturn
GAIN_LIMIT = 1e-4
#: limit of the energy lost, likewise; or of that over the dissipation, if that is larger
LOSS_LIMIT, LOSS_SHARE_LIMIT = 1e-3, 1e-2


@compiled
def spring_energy(contact: Contact, point: FloatArray, stick: FloatArray) -> float:
    """Energy stored in the contact springs [J]: points (n, 2) relative to the floor, sticks (n,)."""
    energy = 0.0
    for i in range(point.shape[0]):
        if point[i, 1] < 0.0:
            energy += 0.5 * contact.normal_stiffness[i] * point[i, 1] ** 2
            energy += 0.5 * contact.tangential_stiffness[i] * stick[i] ** 2
    return energy


@compiled(inline=True)
def work_of_lift(mass: float, pose: FloatArray, pose_new: FloatArray, lift: FloatArray, step: float) -> float:
    """Work of the vertical floor motion in a step [J]: of the inertia force -m a_v over the rise above the floor.

    Args:
        mass: of the container [kg].
        pose, pose_new: (6,) of the container before and after the step, see `contact.stepping.body`.
        lift: (2, 3) height, velocity and acceleration of the floor before and after it.
        step: [s].
    """
    gained = lift[1, 1] - lift[0, 1]
    if gained == 0.0:
        return 0.0
    return -mass * gained / step * (pose_new[CENTRE_Z] - pose[CENTRE_Z] - lift[1, 0] + lift[0, 0])


@compiled(inline=True)
def contact_losses(
    contact: Contact,
    point: FloatArray,
    point_new: FloatArray,
    force: FloatArray,
    force_new: FloatArray,
    stick: FloatArray,
    stick_new: FloatArray,
    slip: FloatArray,
) -> tuple[float, float]:
    """Friction heat and contact damping of one step [J].

    Args:
        contact: the floor.
        point, point_new: (n, 2) base points relative to the floor before and after [m].
        force, force_new: (n, 2) contact forces on the container, tangential and normal [N].
        stick, stick_new: (n,) elongations of the tangential springs [m].
        slip: (n,) sliding of the points in this step [m].
    """
    friction, damping = 0.0, 0.0
    for i in range(point.shape[0]):
        stiffness = contact.normal_stiffness[i]
        before, after = max(0.0, -point[i, 1]), max(0.0, -point_new[i, 1])
        dashpot = 0.5 * (force[i, 1] - stiffness * before + force_new[i, 1] - stiffness * after)
        damping += dashpot * (after - before)
        stiffness = contact.tangential_stiffness[i]
        dashpot = 0.5 * (-force[i, 0] - stiffness * stick[i] - force_new[i, 0] - stiffness * stick_new[i])
        damping += dashpot * (stick_new[i] - stick[i])
        friction -= 0.5 * (force[i, 0] + force_new[i, 0]) * slip[i]
    return friction, damping


@compiled(inline=True)
def crushing_work(
    force: FloatArray, force_new: FloatArray, crushed: FloatArray, crushed_new: FloatArray
) -> float:
    """Plastic work of one step on the floor [J]: forces (n, 2) and permanent indentations (n,) before and after."""
    work = 0.0
    for i in range(crushed.size):
        work += 0.5 * (force[i, 1] + force_new[i, 1]) * (crushed_new[i] - crushed[i])
    return work


@compiled(inline=True)
def dissipation(terms: FloatArray) -> float:
    """Sum of the dissipated energy among the terms of a ledger (7,) [J], but for the row of impacts."""
    return terms[FRICTION] + terms[CONTACT_DAMPING] + terms[MATERIAL_DAMPING] + terms[CRUSHING]
