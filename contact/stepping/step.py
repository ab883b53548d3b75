"""One attempted step of one body.

Predict the coordinates, then iterate free motion, contact forces and response of the body until the base points are
where the forces were computed. Then the sliding of the base and the terms of the energy ledger follow.
`contact.stepping.integrator` decides whether to accept the step.
"""

from typing import Any

from contact.arrays import FloatArray
from contact.interface.laws import relaxed_stick, rolling_lead, stribeck_mu
from contact.interface.solver import solve_contact
from contact.interface.workspace import Contact, Workspace
from contact.jit import compiled, inlined
from contact.motion.kernel import UNIFORM, floor_motion, rare_motion
from contact.stepping import body as interface
from contact.stepping import ledger
from contact.stepping.body import Ground, State
from contact.stepping.joints import in_a_row, points_of
from contact.stepping.ledger import contact_losses, spring_energy, work_of_lift
from contact.stepping.links import LinkedBody, push_of_links
from contact.stepping.state import RunState

FLIGHT = 1e-3  #: gap over half the width from which a base that rolls has left the floor
ITERATION_LIMIT = 12  #: of free motion, contact, response within one step


@compiled(inline=True)
def copy_rows(target: FloatArray, source: FloatArray) -> None:
    """Copy a matrix in place."""
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] = source[i, k]


@compiled(inline=True)
def indent(contact: Contact, point: FloatArray, crushed: FloatArray) -> None:
    """Add camber and indentations (n,) to the heights of points (n, 2), which makes them gaps [m]."""
    for i in range(point.shape[0]):
        point[i, 1] += contact.camber[i] + crushed[i]


@compiled(inline=True)
def crush(contact: Contact, step: float, old: State, new: State, work: Workspace) -> None:
    """Indent the floor under the points that reached their cap; `new.point` holds their heights.

    As the slider of a stick, a plastic slider keeps spring and dashpot at the cap: they relax, and what the point has
    moved besides indents the floor.
    """
    for i in range(new.point.shape[0]):
        indented = old.crushed[i]
        new.point[i, 1] += contact.camber[i]
        if work.law[i, 1] >= work.cap[i]:
            elastic = relaxed_stick(
                max(0.0, -old.point[i, 1]),
                work.cap[i],
                contact.normal_stiffness[i],
                contact.relaxation_time[i],
                step,
            )
            indented = max(indented, -new.point[i, 1] - elastic)
        new.crushed[i] = indented
        new.point[i, 1] += indented


@compiled(inline=True)
def rolling_share(run: RunState, step: float) -> float:
    """Couple that resists the rolling at the end of a step, over the sum of squared lever arms [N/m].

    Times its arm it is the normal force on a point. It follows from the motion extrapolated over the step: rotation and
    rate of the base by a fit to its points. The load is that of a rigid body that rolls, whose mass centre rises by
    (R - z) theta'^2: from point to point the normal forces chatter. A base that has left the floor has none.
    """
    contact, control, old = run.problem.contact, run.problem.control, run.old
    n = control.base_points
    middle, lowest = middle_of(old.point, n), old.point[0, 1]
    square, rate, rise = 0.0, 0.0, 0.0
    for i in range(n):
        arm = old.point[i, 0] - middle
        lowest = min(lowest, old.point[i, 1])
        square += arm * arm
        rate += arm * old.descent[i, 0]
        rise += arm * old.descent[i, 1]
    rate, rise = rate / square, rise / square
    rotation = old.pose[interface.ROTATION] + step * (rate + 0.5 * step * rise)
    lead = rolling_lead(
        rotation,
        rate + step * rise,
        contact.rolling_time,
        contact.rolling_radius,
        contact.rolling_reach,
    )
    if lowest > FLIGHT * contact.rolling_reach:
        return 0.0
    upward = run.lift[1, 2]
    if abs(contact.rolling_radius * rotation) < contact.rolling_reach:
        upward += (contact.rolling_radius - (old.pose[interface.CENTRE_Z] - run.lift[0, 0])) * rate * rate
    return control.mass * (control.gravity + upward) * lead / square


@compiled(inline=True)
def middle_of(point: FloatArray, n: int) -> float:
    """Mean place of the first n points (n, 2) along x [m]."""
    middle = 0.0
    for i in range(n):
        middle += point[i, 0]
    return middle / n


@compiled(inline=True)
def push_rolling(run: RunState, share: float, slope: float) -> None:
    """Move the points without contact force by the couple of rolling; `slope` is that of their velocities [1/s]."""
    work, point, n = run.work, run.old.point, run.problem.control.base_points
    middle = middle_of(point, n)
    for i in range(work.free.shape[0]):
        for a in range(2):
            moved = 0.0
            for j in range(n):
                moved += work.compliance[2 * i + a, 2 * j + 1] * share * (point[j, 0] - middle)
            work.free[i, a] += moved
            work.free_velocity[i, a] += slope * moved


@compiled(inline=True)
def add_rolling(run: RunState, share: float, force: FloatArray) -> None:
    """Add the couple of rolling to the forces on the points, (n, 2) [N]."""
    point, n = run.old.point, run.problem.control.base_points
    middle = middle_of(point, n)
    for i in range(n):
        force[i, 1] += share * (point[i, 0] - middle)


@inlined
def attempt(body: Any, run: RunState, step: float) -> int:
    """Try one step and write the result to `run.attempt.new`; returns the number of iterations, or -1."""
    old, new, work, scheme = run.old, run.attempt.new, run.work, run.problem.scheme
    clock = run.clock[0]
    floor, floor_velocity, floor_acceleration = floor_motion(run.problem.motion, clock.time + step)
    run.floor[1, 0], run.floor[1, 1], run.floor[1, 2] = floor, floor_velocity, floor_acceleration
    if run.problem.vertical.kind != UNIFORM:  # else the call would cost as much as a tenth of a step
        run.lift[1, 0], run.lift[1, 1], run.lift[1, 2] = rare_motion(run.problem.vertical, clock.time + step)
    lift, lift_velocity = run.lift[1, 0], run.lift[1, 1]
    ground = Ground(floor, floor_velocity, lift, lift_velocity)
    slope = scheme.newmark_gamma / (scheme.newmark_beta * step)
    # The averaged equation lags by (alpha_f - alpha_m) steps: else a change of the step would make it of first order.
    shift = (scheme.alpha_f - scheme.alpha_m) * (clock.lag_step - step)
    if shift != 0.0:
        for k in range(old.acceleration.size):
            old.acceleration[k] += shift * old.jerk[k]
    clock.lag_step = step
    interface.predict(body, scheme, step, old, new)
    copy_rows(work.force, old.force)
    contact = run.problem.contact
    for i in range(work.cap.size):  # constant within the step
        work.cap[i] = contact.cap[i] * (1.0 + contact.cap_growth[i] * old.crushed[i])
    # Friction follows the extrapolated velocity: its fall is a negative damping, not to be solved implicitly.
    for j in range(run.joints.shape[0]):
        begin, end = points_of(run, j)
        for i in range(begin, end):
            velocity = old.drift[i, 0] + step * old.drift[i, 1]
            work.mu[i] = stribeck_mu(
                run.joints[j].mu, contact.mu_kinetic[i], contact.stribeck_velocity, velocity
            )
    # that of the points of no joint, those of links and sides, does not change
    for i in range(points_of(run, run.joints.shape[0] - 1)[1], work.mu.size):
        work.mu[i] = contact.mu_static[i]
    rolls = contact.rolling_time > 0.0
    rolling = rolling_share(run, step) if rolls else 0.0
    clock.rolling = rolling
    for iteration in range(ITERATION_LIMIT):
        interface.release(body, scheme, step, old, new, work, ground)
        indent(contact, work.free, old.crushed)
        if rolls:
            push_rolling(run, rolling, slope)
        solved = solve_contact(contact, step, slope, old.point, old.stick, work)
        if solved < 0:
            return -1
        clock.contact_iterations += solved
        if rolls:
            add_rolling(run, rolling, work.force)
        converged = interface.respond(body, scheme, step, old, new, work) <= 1.0
        if converged:
            copy_rows(new.force, work.force)
            per_second = 1.0 / step
            for i in range(new.descent.shape[0]):
                new.descent[i, 0] = -work.velocity[i, 1]
                new.descent[i, 1] = (new.descent[i, 0] - old.descent[i, 0]) * per_second
                new.drift[i, 0] = work.velocity[i, 0]
                new.drift[i, 1] = (new.drift[i, 0] - old.drift[i, 0]) * per_second
            for k in range(new.jerk.size):
                new.jerk[k] = (new.acceleration[k] - old.acceleration[k]) * per_second
            interface.complete(body, new, floor, lift, lift_velocity)
        if rolls:
            add_rolling(run, -rolling, work.force)
            copy_rows(new.force, work.force)
        if converged:
            crush(contact, step, old, new, work)
            return iteration + 1
    return -1


@compiled(inline=True)
def account(run: RunState, step: float, loose: bool | None, links: LinkedBody | None) -> float:
    """Write the ledger terms of the attempted step; returns its dissipation but for crushing [J]."""
    old, new, change = run.old, run.attempt.new, run.attempt.change
    shear = 0.0
    begin, end = points_of(run, 0)
    if loose is not None and in_a_row(run):
        end = run.joints[run.joints.shape[0] - 1].end
    for i in range(begin, end):
        shear += 0.5 * (old.force[i, 0] + new.force[i, 0])
    if links is not None:  # what holds them moves with the floor
        shear += push_of_links(run, links)
    friction, damping, crushing = contact_losses(run.problem.contact, old, new, run.attempt.slip)
    material = 0.0
    for j in range(new.damping.size):
        material += 0.5 * (old.damping[j] + new.damping[j]) * (new.position[j] - old.position[j])
    before = spring_energy(run.problem.contact, old.point, old.stick)
    if run.joints.shape[0] > 1:  # what the springs of a corner lose as it leaves its face
        damping += run.clock[0].spring_energy - before
        before = run.clock[0].spring_energy
    if run.problem.contact.rolling_time > 0.0:
        n, loss = run.problem.control.base_points, 0.0
        middle, share = middle_of(old.point, n), 0.5 * (run.clock[0].rolling_before + run.clock[0].rolling)
        for i in range(n):
            sunk = (old.point[i, 1] - old.crushed[i]) - (new.point[i, 1] - new.crushed[i])
            loss += share * (old.point[i, 0] - middle) * sunk
        damping += loss
    stored = spring_energy(run.problem.contact, new.point, new.stick) - before
    for row in (interface.KINETIC, interface.STRAIN, interface.POTENTIAL):
        stored += new.energy[row] - old.energy[row]
    change[ledger.BASE_WORK] = (shear + run.problem.control.mass * run.problem.control.downhill) * (
        run.floor[1, 0] - run.floor[0, 0]
    )
    change[ledger.BASE_WORK] += work_of_lift(run.problem.control.mass, old.pose, new.pose, run.lift, step)
    change[ledger.FRICTION] = friction
    change[ledger.CONTACT_DAMPING] = damping
    change[ledger.MATERIAL_DAMPING] = material
    change[ledger.CRUSHING] = crushing
    change[ledger.IMPACTS] = 0.0
    change[ledger.IMBALANCE] = change[ledger.BASE_WORK] - friction - damping - material - crushing - stored
    return friction + damping + material
