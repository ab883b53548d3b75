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
from contact.stepping.body import CENTRE_Z, State

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
    """Work of the vertical floor motion in a step [J]: of the inertia force -m a_v over the rise above the floor."""
    gained = lift[1, 1] - lift[0, 1]
    if gained == 0.0:
        return 0.0
    return -mass * gained / step * (pose_new[CENTRE_Z] - pose[CENTRE_Z] - lift[1, 0] + lift[0, 0])


@compiled(inline=True)
def contact_losses(contact: Contact, old: State, new: State, slip: FloatArray) -> tuple[float, float, float]:
    """Friction heat, contact damping and plastic work on the floor in one step [J]; `slip`: (n,) of the points [m]."""
    friction, damping, crushing = 0.0, 0.0, 0.0
    for i in range(slip.size):
        stiffness = contact.normal_stiffness[i]
        before, after = max(0.0, -old.point[i, 1]), max(0.0, -new.point[i, 1])
        dashpot = 0.5 * (old.force[i, 1] - stiffness * before + new.force[i, 1] - stiffness * after)
        damping += dashpot * (after - before)
        stiffness = contact.tangential_stiffness[i]
        dashpot = -old.force[i, 0] - stiffness * old.stick[i] - new.force[i, 0] - stiffness * new.stick[i]
        damping += 0.5 * dashpot * (new.stick[i] - old.stick[i])
        friction -= 0.5 * (old.force[i, 0] + new.force[i, 0]) * slip[i]
        crushing += 0.5 * (old.force[i, 1] + new.force[i, 1]) * (new.crushed[i] - old.crushed[i])
    return friction, damping, crushing


@compiled(inline=True)
def dissipation(terms: FloatArray) -> float:
    """Sum of the dissipated energy among the terms of a ledger (7,) [J], but for the row of impacts."""
    return terms[FRICTION] + terms[CONTACT_DAMPING] + terms[MATERIAL_DAMPING] + terms[CRUSHING]
