"""The contact of a body's base points with the floor, condensed to those points and solved implicitly.

Within one step contact forces f displace the base points by y = free + G f, with G the effective compliance
(inverse of mass/(beta h^2) + stiffness, condensed to the points). With the laws f = law(y) this is a small, non-smooth
system, unsymmetric because of friction. It is solved by a semismooth Newton method with line search (exact after
finitely many iterations, because the laws are piecewise linear).
Wriggers (2006) sec. 9.5; Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353.

Arrays: points (n, 2) with columns x [m] and z [m], both relative to the floor, z > 0 open; forces (n, 2) on
the container with columns tangential (along +x) and normal (> 0 in compression) [N].
"""

import numpy as np

from contact.arrays import FloatArray
from contact.interface.compliance import (
    FEW_POINTS,
    factor_is_current,
    factor_tangent,
    move_points,
    newton_change,
)
from contact.interface.laws import (
    ELASTIC_STICK,
    REGULARISED,
    normal_force,
    regularised_friction,
    stick_friction,
    stick_trial,
)
from contact.interface.workspace import Contact, Workspace
from contact.jit import compiled

FULL_STEPS = 1  #: full Newton steps before the line search begins; problems with friction tend to cycle
NEWTON_LIMIT = 40
FORCE_TOLERANCE = 1e-11  #: residual force over the largest force at which the contact problem is solved
SLIDING = 1.0 - 1e-6  #: force over its limit above which a point counts as sliding, or as crushing the floor


@compiled(inline=True)
def evaluate_laws(
    contact: Contact,
    step: float,
    velocity_slope: float,
    start: FloatArray,
    stick: FloatArray,
    work: Workspace,
) -> None:
    """Forces of the laws at `work.point`, and minus their derivatives by the points' positions.

    Args:
        velocity_slope: derivative of an end velocity by an end position, gamma/(beta h) [1/s].
            start: (n, 2) points at the beginning of the step, relative to the floor [m].
        stick: (n,) elongation of the stuck tangential springs then [m].
        work: point, velocity and mu are read, law, slope and excess are written.
    """
    for i in range(work.point.shape[0]):
        normal, by_gap, by_rate = normal_force(
            -work.point[i, 1],
            -work.velocity[i, 1],
            contact.normal_stiffness[i],
            contact.normal_stiffness[i] * contact.relaxation_time[i],
            work.cap[i],
            step,
        )
        work.law[i, 1] = normal
        work.slope[i, 2] = by_gap + by_rate * velocity_slope
        if normal <= 0.0:
            work.law[i, 0] = 0.0
            work.slope[i, 0] = 0.0
            work.slope[i, 1] = 0.0
            work.excess[i, 0] = 0.0
        elif contact.friction == ELASTIC_STICK:
            stiffness = contact.tangential_stiffness[i]
            elongation, trial_slope = 0.0, stiffness * contact.relaxation_time[i] * velocity_slope
            if start[i, 1] < 0.0:  # closed at the beginning: the spring acts over the whole step
                elongation = stick[i] + work.point[i, 0] - start[i, 0]
                trial_slope += stiffness
            trial = stick_trial(stiffness, contact.relaxation_time[i], elongation, work.velocity[i, 0])
            force, by_trial, by_limit = stick_friction(trial, work.mu[i] * normal)
            work.excess[i, 0], work.excess[i, 1] = trial - force, trial_slope
            work.law[i, 0] = force
            work.slope[i, 0] = by_trial * trial_slope
            work.slope[i, 1] = by_limit * work.mu[i] * work.slope[i, 2]
        elif contact.friction == REGULARISED:
            force, by_normal, by_velocity = regularised_friction(
                normal,
                work.velocity[i, 0],
                work.mu[i],
                contact.mu_kinetic[i],
                contact.regularisation_velocity,
            )
            work.excess[i, 0] = 0.0
            work.law[i, 0] = force
            work.slope[i, 0] = -by_velocity * velocity_slope
            work.slope[i, 1] = by_normal * work.slope[i, 2]


@compiled(inline=True)
def return_held_points(contact: Contact, velocity_slope: float, start: FloatArray, work: Workspace) -> bool:
    """Move points that were held by the floor back to where they were before the step, to linearise there first.

    `work.force` is a guess from before the step. Its error in position is multiplied by compliance times stiffness:
    where this exceeds one, the old position is the better guess. Writes the shifts to `work.trial`; whether any moved.
    """
    placed = False
    for i in range(work.force.shape[0]):
        tangential, normal = work.force[i, 0], work.force[i, 1]
        closed = normal > 0.0 and start[i, 1] < 0.0
        magnified = 1.0 + contact.relaxation_time[i] * velocity_slope
        stuck = (
            closed and contact.friction == ELASTIC_STICK and abs(tangential) < SLIDING * work.mu[i] * normal
        )
        for k in range(2):
            stiffness = contact.tangential_stiffness[i] if k == 0 else contact.normal_stiffness[i]
            held = stuck if k == 0 else closed and normal < SLIDING * work.cap[i]
            work.trial[i, k] = 0.0
            if held and magnified * stiffness * work.compliance[2 * i + k, 2 * i + k] > 1.0:
                back = start[i, k] - work.point[i, k]
                work.point[i, k] += back
                work.velocity[i, k] += velocity_slope * back
                work.trial[i, k] = back
                placed = True
    return placed


@compiled
def linearise_in_old_states(
    contact: Contact,
    velocity_slope: float,
    start: FloatArray,
    stick: FloatArray,
    work: Workspace,
) -> bool:
    """Linearise points that were closed in the state that they were in: elastic or crushing, stuck or sliding.

    The laws of one state are linear: where the points stay in their states, the first Newton step solves the problem
    wherever it begins. Returns whether there is such a point.
    """
    closed = False
    for i in range(work.force.shape[0]):
        tangential, normal = work.force[i, 0], work.force[i, 1]
        if not (normal > 0.0 and start[i, 1] < 0.0):
            continue
        closed = True
        stiffness = contact.normal_stiffness[i]
        damping = stiffness * contact.relaxation_time[i]
        if normal < SLIDING * work.cap[i]:
            work.law[i, 1] = -stiffness * work.point[i, 1] - damping * work.velocity[i, 1]
            work.slope[i, 2] = stiffness + damping * velocity_slope
        else:
            work.law[i, 1], work.slope[i, 2] = work.cap[i], 0.0
        if abs(tangential) < SLIDING * work.mu[i] * normal:
            stiffness, elongation = contact.tangential_stiffness[i], stick[i] + work.point[i, 0] - start[i, 0]
            work.law[i, 0] = stick_trial(
                stiffness, contact.relaxation_time[i], elongation, work.velocity[i, 0]
            )
            work.slope[i, 0] = stiffness * contact.relaxation_time[i] * velocity_slope + stiffness
            work.slope[i, 1] = 0.0
            work.excess[i, 0] = 0.0
        else:
            limit = work.mu[i] if tangential > 0.0 else -work.mu[i]
            work.law[i, 0] = limit * work.law[i, 1]
            work.slope[i, 0], work.slope[i, 1] = 0.0, limit * work.slope[i, 2]
            work.excess[i, 0] = tangential  # only its sign is used
    return closed


@compiled(inline=True)
def stick_where_turned(iteration: int, work: Workspace) -> bool:
    """Linearise as stuck what has changed from one limit of friction to the other since the last iteration.

    Its stick may cover so small a range of positions (a stiff dashpot, a short step) that iterations never meet it.
    Returns whether there is such a point.
    """
    turned = False
    for i in range(work.law.shape[0]):
        side = int(work.excess[i, 0] > 0.0) - int(work.excess[i, 0] < 0.0)
        if iteration > 0 and side * work.side[i] < 0:
            work.law[i, 0] += work.excess[i, 0]
            work.slope[i, 0], work.slope[i, 1] = work.excess[i, 1], 0.0
            side, turned = 0, True
        work.side[i] = side
    return turned


@compiled(inline=True)
def press_where_turned(
    contact: Contact, step: float, velocity_slope: float, iteration: int, work: Workspace
) -> bool:
    """Linearise as elastic what has changed from open to the cap, or back, as `stick_where_turned`."""
    turned = False
    for i in range(work.law.shape[0]):
        level = 0
        if work.law[i, 1] <= 0.0:
            level = -1
        elif work.law[i, 1] >= work.cap[i]:
            level = 1
        if iteration > 0 and level * work.level[i] < 0:
            stiffness = contact.normal_stiffness[i]
            damping = stiffness * contact.relaxation_time[i]
            penetration, rate = -work.point[i, 1], -work.velocity[i, 1]
            if rate * step < penetration:
                work.law[i, 1] = stiffness * penetration + damping * rate
                work.slope[i, 2] = stiffness + damping * velocity_slope
            else:
                work.slope[i, 2] = stiffness + damping / step
                work.law[i, 1] = work.slope[i, 2] * penetration
            level, turned = 0, True
        work.level[i] = level
    return turned


@compiled(inline=True)
def solve_contact(
    contact: Contact,
    step: float,
    velocity_slope: float,
    start: FloatArray,
    stick: FloatArray,
    work: Workspace,
) -> int:
    """Contact forces that satisfy all laws at the end of the step; the number of Newton iterations, -1: not converged.

    Arguments as of `evaluate_laws`. Of `work`, free, free_velocity, compliance, cap and mu are inputs; force is the
    first guess and the result; point and velocity are the corresponding positions and velocities.
    """
    n = work.force.shape[0]
    before = np.inf
    many = n > FEW_POINTS and contact.friction == ELASTIC_STICK
    evaluated = False
    for iteration in range(NEWTON_LIMIT):
        placed = False
        if not evaluated:
            move_points(velocity_slope, work.force, work)
            if iteration == 0 and not many and step > contact.held_step:
                placed = return_held_points(contact, velocity_slope, start, work)
            evaluate_laws(contact, step, velocity_slope, start, stick, work)
            if placed:  # along the tangents to the points before
                for i in range(n):
                    work.law[i, 0] += (
                        work.slope[i, 0] * work.trial[i, 0] + work.slope[i, 1] * work.trial[i, 1]
                    )
                    work.law[i, 1] += work.slope[i, 2] * work.trial[i, 1]
            if iteration == 0 and many and step > contact.held_step:
                placed = linearise_in_old_states(contact, velocity_slope, start, stick, work)
        residual, largest, stiffest = 0.0, contact.force_scale, 0.0
        for i in range(n):
            stiffest = max(stiffest, work.slope[i, 0], work.slope[i, 2])
            for k in range(2):
                residual = max(residual, abs(work.law[i, k] - work.force[i, k]))
                largest = max(largest, abs(work.force[i, k]))
        if not placed and residual <= FORCE_TOLERANCE * largest + contact.resolution * stiffest:
            return iteration
        turned = stick_where_turned(iteration, work)
        turned = press_where_turned(contact, step, velocity_slope, iteration, work) or turned
        # Keep old factors while they converge well: usually the contact has not changed.
        if not factor_is_current(step, work) or residual > 0.1 * before:
            if not factor_tangent(step, work):
                return -1
            before = np.inf
        else:
            before = residual
        newton_change(work)
        for i in range(n):
            work.trial[i, 0] = work.force[i, 0]
            work.trial[i, 1] = work.force[i, 1]
        share, evaluated = 1.0, False
        while True:
            for i in range(n):
                for k in range(2):
                    work.force[i, k] = work.trial[i, k] + share * work.change[2 * i + k]
            if iteration < FULL_STEPS or (turned and iteration < contact.turned_steps) or share < 1e-3:
                break
            move_points(velocity_slope, work.force, work)
            evaluate_laws(contact, step, velocity_slope, start, stick, work)
            after = 0.0
            for i in range(n):
                for k in range(2):
                    after = max(after, abs(work.law[i, k] - work.force[i, k]))
            if after <= (1.0 - 0.25 * share) * residual:
                evaluated = True
                break
            share *= 0.5
    return -1
