"""Friction in the joints of a run: what slides, what breaks loose, what stops.

Static and kinetic friction are states of a joint, not of a point: see "Static and kinetic friction" in
`contact/README.md`. Forces and slips are those of the box on top of the joint.
"""

import math

from contact.arrays import FloatArray
from contact.interface.laws import ELASTIC_STICK, REGULARISED, relaxed_stick, weakened_mu
from contact.jit import compiled, inlined
from contact.stepping.body import ANGULAR_VELOCITY, CENTRE_X, CENTRE_Z, ROTATION, VELOCITY_X, VELOCITY_Z
from contact.stepping.links import LinkedBody, load_of_links
from contact.stepping.modes import SLIDING
from contact.stepping.observables import bearing_place
from contact.stepping.state import RunState

NO_POINT, SOME, ALL, AIRBORNE = 0, 1, 2, 3  #: sliding of the loaded points of a joint
#: change of a coefficient that weakens with the slip of a step at which it is known
WEAKENING_TOLERANCE = 1e-9
SLIDES_ON = math.inf  #: no force that holds a joint, see `slide`
IMPACT_LOAD = 2.0  #: normal force over the weight from which there is an impact


@inlined
def points_of(run: RunState, j: int) -> tuple[int, int]:
    """First contact point of a joint, and the one behind its last."""
    if run.joints.shape[0] == 1:
        return 0, run.attempt.new.point.shape[0] - run.links.shape[0]
    return run.joints[j].begin, run.joints[j].end


@inlined
def friction_of(run: RunState, j: int, slid: float) -> float:
    """Coefficient of friction of a joint at no velocity; where it slides, after a path of `slid` [m]."""
    contact, first = run.problem.contact, points_of(run, j)[0]
    falls_with_velocity = contact.stribeck_velocity > 0.0 and contact.weakening[first] <= 0.0
    if run.joints[j].sliding == 0 or falls_with_velocity or contact.friction == REGULARISED:
        return contact.mu_static[first]
    return weakened_mu(contact.mu_static[first], contact.mu_kinetic[first], contact.weakening[first], slid)


@inlined
def weight_on(run: RunState, j: int) -> float:
    """Weight of the boxes from a joint up [N]."""
    weight = 0.0
    for k in range(j, run.joints.shape[0]):
        if k > j and run.joints[k].below < 0:
            break
        weight += run.joints[k].mass * (run.problem.control.gravity + run.lift[1, 2])
    return weight


@compiled(inline=True)
def settle_friction(run: RunState, step: float, loose: bool | None, links: LinkedBody | None) -> bool:
    """Decide which joints slide after the attempted step [s]; whether one starts to, stops or turns round in it.

    A joint whose points all slide at the limit of static friction breaks loose as a whole where a rigid body would
    slide, or the points have slid as far as counts as sliding. Less is the overshoot of an elastic swing, which lasts
    milliseconds and slides micrometres: too little for friction to fall. Where a joint stops, its slip may change.
    """
    switches = False
    for j in range(run.joints.shape[0]):
        joint, mu_static = run.joints[j], run.problem.contact.mu_static[points_of(run, j)[0]]
        every = joint.motion == ALL or (joint.motion == AIRBORNE and joint.sliding == 1)
        turned = False
        if run.problem.contact.friction == ELASTIC_STICK and joint.sliding == 1 and joint.motion != AIRBORNE:
            # It stops where its slip has turned round, or none of its points slides, and static friction can hold it. A
            # slip that turns round without a stop goes on: kinetic friction remains, and the path since it broke loose.
            turned, every = joint.velocity * joint.slip_velocity < 0.0, True
            if turned or joint.motion == NO_POINT:
                holding, normal = holding_force(run, j, loose, links)
                every = not abs(holding) <= mu_static * normal
                # a stop within an impact does not last
                if turned and not every and normal < IMPACT_LOAD * weight_on(run, j):
                    slide(run, j, step, holding)
        elif run.problem.contact.friction == ELASTIC_STICK and every and joint.sliding == 0:
            holding, normal = holding_force(run, j, loose, links)
            slid = joint.slip_since_break + abs(joint.slip_step)
            every = abs(holding) > mu_static * normal or slid > SLIDING * joint.width
        overshoots = joint.sliding == 0 and (joint.motion == ALL) != (joint.slip_since_break > 0.0)
        changes = turned or overshoots or (joint.sliding == 1) != every
        switches = switches or (changes and mu_static > 0.0)
        joint.slides = 1 if every else 0
    return switches


@compiled(inline=True)
def holding_force(run: RunState, j: int, loose: bool | None, links: LinkedBody | None) -> tuple[float, float]:
    """Tangential force that holds a joint at the end of the attempted step, and the normal force for it [N].

    The forces of a rigid body that stands on both sides of its base, or rocks about the resultant of its normal forces,
    or begins to rock about a corner because it cannot stand. The springs of the contact, and an elastic body, swing
    around them. In an impact the normal force is larger. On a floor that accelerates upward by a_v gravity is g + a_v;
    a slope acts as an acceleration of the floor uphill. What links push is taken from what the joint must hold.
    """
    new, track = run.attempt.new, run.track[0]
    if loose is not None:
        if not in_a_row(run):
            return holding_in_stack(run, j, load_of_links(run, links, j, new.boxes[j]))
        box, first, last = new.boxes[j], run.joints[j].begin, run.joints[j].end - 1
        stands = (new.force[first, 1] > 0.0) == (new.force[last, 1] > 0.0)
        # what pushes it is all external force but that of the floor
        own = j * (new.external.size // run.joints.shape[0])
        x, z, moment = new.external[own], new.external[own + 1], new.external[own + 2]
        for i in range(first, last + 1):
            arm_x = new.point[i, 0] + run.floor[1, 0] - box[CENTRE_X]
            arm_z = new.point[i, 1] - new.crushed[i] + run.lift[1, 0] - box[CENTRE_Z]
            x -= new.force[i, 0]
            z -= new.force[i, 1]
            moment -= arm_z * new.force[i, 0] - arm_x * new.force[i, 1]
        return holding_on_floor(run, j, box, stands, first, last, (x, z, moment))
    stands, last = track.left_open == track.right_open, run.problem.control.base_points - 1
    return holding_on_floor(run, j, new.pose, stands, 0, last, load_of_links(run, links, j, new.pose))


@inlined
def in_a_row(run: RunState) -> bool:
    """Whether the boxes of a run stand beside one another, each on the floor."""
    last = run.joints.shape[0] - 1
    return bool(last > 0 and run.joints[last].below < 0)


@inlined
def holding_on_floor(
    run: RunState,
    j: int,
    pose: FloatArray,
    stands: bool,
    first: int,
    last: int,
    pushed: tuple[float, float, float],
) -> tuple[float, float]:
    """`holding_force` of a body on the floor, which `stands` on both sides of its base, points `first` to `last`.

    `pushed`: forces on it but those of floor and gravity, x and z [N], and their moment about its centre [Nm].
    """
    new, joint = run.attempt.new, run.joints[j]
    acceleration = run.floor[1, 2] - run.problem.control.downhill - pushed[0] / joint.mass
    gravity = run.problem.control.gravity + run.lift[1, 2] - pushed[1] / joint.mass
    normal, x, z = 0.0, 0.0, 0.0
    begin, end = points_of(run, j)
    for i in range(begin, end):
        normal += new.force[i, 1]
        x += new.force[i, 1] * new.point[i, 0]
        z += new.force[i, 1] * new.point[i, 1]
    stands = normal <= 0.0 or stands
    if stands:
        x, z = new.point[first, 0], new.point[first, 1]
        if acceleration <= 0.0:
            x, z = new.point[last, 0], new.point[last, 1]
    else:
        x, z = x / normal, z / normal
    arm_x = pose[CENTRE_X] - run.floor[1, 0] - x
    arm_z = pose[CENTRE_Z] - run.lift[1, 0] - z
    inertia = joint.inertia / joint.mass + arm_x * arm_x + arm_z * arm_z
    turning = (gravity * arm_x - acceleration * arm_z + pushed[2] / joint.mass) / inertia
    push, load = acceleration, gravity
    if not stands or turning * acceleration < 0.0:
        spin = pose[ANGULAR_VELOCITY] ** 2
        push += turning * arm_z - spin * arm_x
        load -= turning * arm_x + spin * arm_z
    return joint.mass * push, max(normal, joint.mass * load)


@inlined
def touching_corner(i: int) -> int:
    """The corner that touches a face at a contact point of a loose stack, see `contact.interface.faces`."""
    joint, k = (i + 2) // 4, (i + 2) % 4
    if k % 2 == 1:
        return 4 * joint - 2 + k // 2
    return 4 * joint + k // 2


@compiled
def holding_in_stack(run: RunState, j: int, pushed: tuple[float, float, float]) -> tuple[float, float]:
    """`holding_force` of a box of a loose stack, under the present forces from above and those of links, `pushed`.

    The box stands on the face below, which moves it and turns it; or it rocks on that face as a container on its floor.
    With t along the face and n across it, F and M from above, a the acceleration of the place about which it turns,
    d from there to its mass centre, w' and w its angular acceleration and velocity:

        f = F/m - a + g,   push = -f t,   load = -f n
        w' = (load d_t - push d_n + M/m) / (I/m + d^2),   or that of the carrier where the box stands
        T = m (push + w' d_n - w^2 d_t),   N = m (load - w' d_t - w^2 d_n)
    """
    new, joint, box, carrier = run.attempt.new, run.joints[j], run.attempt.new.boxes[j], carrier_of(run, j)
    begin, end = points_of(run, j)
    half = (end - begin) // 2
    x, z, left, right = 0.0, 0.0, 0.0, 0.0
    for i in range(begin, end):
        c = touching_corner(i)
        x += new.force[i, 1] * new.corner[c, 0]
        z += new.force[i, 1] * new.corner[c, 1]
        if i < begin + half:
            left += new.force[i, 1]
        else:
            right += new.force[i, 1]
    normal, stands = left + right, (left > 0.0) == (right > 0.0)
    above_x, above_z, moment = 0.0, 0.0, 0.0  # from the joint on top of it
    low, high = points_of(run, j + 1) if j + 1 < run.joints.shape[0] else (0, 0)
    for i in range(low, high):
        lean = new.boxes[j + (i % 2), ROTATION]  # of the box whose face it is
        cosine, sine = math.cos(lean), math.sin(lean)
        along = -cosine * new.force[i, 0] - sine * new.force[i, 1]
        up = sine * new.force[i, 0] - cosine * new.force[i, 1]
        c = touching_corner(i)
        arm_x = new.corner[c, 0] + run.floor[1, 0] - box[CENTRE_X]
        arm_z = new.corner[c, 1] + run.lift[1, 0] - box[CENTRE_Z]
        above_x += along
        above_z += up
        moment += arm_z * along - arm_x * up
    above_x, above_z, moment = above_x + pushed[0], above_z + pushed[1], moment + pushed[2]
    cosine, sine, swing, swung = 1.0, 0.0, 0.0, 0.0
    if j > 0:
        lean = new.boxes[j - 1, ROTATION]
        cosine, sine = math.cos(lean), math.sin(lean)
    if carrier >= 0:
        swung = new.boxes[carrier, ANGULAR_VELOCITY]
        swing = (swung - run.old.boxes[carrier, ANGULAR_VELOCITY]) / run.clock[0].lag_step
    push, load, arm_x, arm_z = 0.0, 0.0, 0.0, 0.0
    for side in range(2 if stands else 1):  # about which corner it would rock depends on the push
        if stands:
            first = begin + side * half
            stiffness = run.problem.contact.normal_stiffness
            heavier = stiffness[first + half - 1] > stiffness[first]
            c = touching_corner(first + half - 1 if heavier else first)
            x, z = new.corner[c, 0], new.corner[c, 1]
        else:
            x, z = x / normal, z / normal
        shake_x, shake_z = acceleration_of(run, carrier, x, z)
        force_x = above_x / joint.mass - shake_x + run.problem.control.downhill
        force_z = above_z / joint.mass - shake_z - run.problem.control.gravity
        push, load = sine * force_z - cosine * force_x, -sine * force_x - cosine * force_z
        along, up = box[CENTRE_X] - run.floor[1, 0] - x, box[CENTRE_Z] - run.lift[1, 0] - z
        arm_x, arm_z = cosine * along - sine * up, sine * along + cosine * up
        if push > 0.0:
            break
    inertia = joint.inertia / joint.mass + arm_x * arm_x + arm_z * arm_z
    turning = (load * arm_x - push * arm_z + moment / joint.mass) / inertia
    spin = box[ANGULAR_VELOCITY] ** 2
    if stands and (turning - swing) * push >= 0.0:
        turning, spin = swing, swung * swung
    push += turning * arm_z - spin * arm_x
    load -= turning * arm_x + spin * arm_z
    return joint.mass * push, max(normal, joint.mass * load)


@inlined
def carrier_of(run: RunState, j: int) -> int:
    """The box that moves what is below a joint, -1: the floor; one that sticks and stands moves with what is below.

    On its springs it swings about this motion, most of all when the friction on top of it turns round: that does not
    end a stop.
    """
    box = run.joints[j].below
    while box >= 0 and run.joints[box].slides == 0:
        begin, end = points_of(run, box)
        half, left, right = (end - begin) // 2, 0.0, 0.0
        for i in range(half):
            left += run.attempt.new.force[begin + i, 1]
            right += run.attempt.new.force[begin + half + i, 1]
        if left <= 0.0 or right <= 0.0:
            break
        box = run.joints[box].below
    return box


@compiled
def acceleration_of(run: RunState, box: int, x: float, z: float) -> tuple[float, float]:
    """Acceleration of a box (-1: the floor) at a place relative to the floor [m/s2]."""
    if box < 0:
        return run.floor[1, 2], run.lift[1, 2]
    now, before, step = run.attempt.new.boxes[box], run.old.boxes[box], run.clock[0].lag_step
    along, up = x + run.floor[1, 0] - now[CENTRE_X], z + run.lift[1, 0] - now[CENTRE_Z]
    turning = (now[ANGULAR_VELOCITY] - before[ANGULAR_VELOCITY]) / step
    spin = now[ANGULAR_VELOCITY] ** 2
    return (
        (now[VELOCITY_X] - before[VELOCITY_X]) / step + turning * up - spin * along,
        (now[VELOCITY_Z] - before[VELOCITY_Z]) / step - turning * along - spin * up,
    )


@compiled(inline=True)
def slide(run: RunState, j: int, step: float, holding: float) -> None:
    """Sliding of the points of a joint and elongation of their springs after a converged step.

    Of the joint it writes `motion` - ALL loaded points slide one way, SOME or NO_POINT; AIRBORNE without a load -, the
    force-weighted sliding [m], and the force-weighted velocity at the end of the step [m/s].

    `holding`: of a joint that stops sliding in this step, the tangential force with which its springs start [N], else
    SLIDES_ON. With the forces of the slide, the motion would have to wind them up first, and the dashpots make that
    overshoot.
    """
    stops = holding < SLIDES_ON
    contact, new, work, joint = run.problem.contact, run.attempt.new, run.work, run.joints[j]
    slip = run.attempt.slip
    every, any_slides, direction, weighted, total, velocity = True, False, 0.0, 0.0, 0.0, 0.0
    begin, end = points_of(run, j)
    loaded = 0.0
    for i in range(begin, end):
        loaded += new.force[i, 1]
    for i in range(begin, end):
        normal = new.force[i, 1]
        start = SLIDES_ON
        if stops and normal > 0.0:
            start = -holding * normal / loaded / contact.tangential_stiffness[i]
        slide_point(run, i, step, start)
        if new.point[i, 1] >= 0.0:
            continue
        if normal > 0.0:
            weighted += normal * slip[i]
            velocity += normal * work.velocity[i, 0]
            total += normal
            if contact.friction == REGULARISED:
                slides = abs(work.velocity[i, 0]) > contact.regularisation_velocity
                every = every and slides
            else:
                slides = work.slope[i, 0] == 0.0
                every = every and slides and direction * work.law[i, 0] >= 0.0
            any_slides = any_slides or slides
            direction = work.law[i, 0]
    if total <= 0.0:
        joint.motion, joint.slip_step, joint.velocity = AIRBORNE, 0.0, 0.0
        return
    joint.slip_step, joint.velocity = weighted / total, velocity / total
    if stops:  # what decided that it stops remains
        return
    joint.motion = ALL if every else (SOME if any_slides else NO_POINT)


@inlined
def slide_point(run: RunState, i: int, step: float, start: float) -> None:
    """Write the slip of point i over a step [s] and the elongation of its tangential spring.

    `start` [m]: elongation from which the spring of a point that stops sliding starts, else SLIDES_ON; see `slide`.
    """
    contact, old, new, work, slip = run.problem.contact, run.old, run.attempt.new, run.work, run.attempt.slip
    normal, tangential = new.force[i, 1], new.force[i, 0]
    moved = new.point[i, 0] - old.point[i, 0]
    stick = old.stick[i]
    if old.point[i, 1] >= 0.0:  # open at the beginning: it slides in the closed part of the step only
        below = max(0.0, new.crushed[i] - old.crushed[i] - new.point[i, 1])
        moved *= below / (below + old.point[i, 1]) if below > 0.0 else 0.0
    slip[i] = 0.0
    if new.point[i, 1] >= 0.0:
        new.stick[i] = 0.0
    elif contact.friction == REGULARISED:
        new.stick[i] = 0.0
        slip[i] = moved
    elif start < SLIDES_ON:
        new.stick[i] = start - contact.relaxation_time[i] * work.velocity[i, 0]
        slip[i] = moved - (new.stick[i] - stick)
    elif normal <= 0.0 or work.slope[i, 0] == 0.0:
        new.stick[i] = relaxed_stick(
            stick, -tangential, contact.tangential_stiffness[i], contact.relaxation_time[i], step
        )
        slip[i] = moved - (new.stick[i] - stick)
    elif old.point[i, 1] >= 0.0:
        new.stick[i] = 0.0
    else:
        new.stick[i] = stick + moved


@inlined
def slide_points(run: RunState, step: float, loose: bool | None, links: LinkedBody | None) -> bool:
    """Sliding of all joints, none of which stops, and of the other points, each for itself, after a step [s].

    Returns whether a coefficient of friction has changed, after this slip.
    """
    changed = False
    for j in range(run.joints.shape[0]):
        joint = run.joints[j]
        slide(run, j, step, SLIDES_ON)
        if joint.sliding == 1 and run.problem.contact.weakening[points_of(run, j)[0]] > 0.0:
            weakened = friction_of(run, j, joint.slip_since_break + abs(joint.slip_step))
            if abs(weakened - joint.mu) > WEAKENING_TOLERANCE:
                joint.mu, changed = weakened, True
    if links is not None or loose is not None:
        for i in range(points_of(run, run.joints.shape[0] - 1)[1], run.attempt.new.point.shape[0]):
            slide_point(run, i, step, SLIDES_ON)
    return changed


@compiled(inline=True)
def update_joints(run: RunState, step: float) -> None:
    """Update the joints from the step about to be accepted, all but `slip`."""
    old, new = run.old, run.attempt.new
    for j in range(run.joints.shape[0]):
        joint = run.joints[j]
        slides = joint.sliding == 1 or joint.motion == ALL
        joint.slip_since_break = joint.slip_since_break + abs(joint.slip_step) if slides else 0.0
        joint.sliding = joint.slides
        tangential, normal, before = 0.0, 0.0, 0.0
        begin, end = points_of(run, j)
        for i in range(begin, end):
            tangential += new.force[i, 0]
            normal += new.force[i, 1]
            before += old.force[i, 1]
        limit = run.problem.contact.mu_static[begin] * normal
        utilisation = abs(tangential) / limit if limit > 0.0 else 0.0
        joint.utilisation_rate = (utilisation - joint.utilisation) / step
        joint.utilisation = utilisation
        joint.slip_acceleration = (joint.velocity - joint.slip_velocity) / step
        joint.slip_velocity = joint.velocity
        stood = joint.stood_at + joint.slip
        place = bearing_place(run.problem.contact, run.problem.along, new, begin, end, stood)
        joint.shift = place - stood
        joint.slip_travel += abs(joint.slip_step)
        if before <= 0.0 or normal <= 0.0:
            joint.slip_in_air += joint.shift
            joint.slip_travel += abs(joint.shift)
        joint.max_slip = max(joint.max_slip, abs(joint.slip + joint.shift))
        if joint.sliding == 1:
            joint.max_slip_velocity = max(joint.max_slip_velocity, abs(joint.slip_velocity))
