"""Faults in boxes that stand loose on one another."""

from mutation import Mutation

FACES = ("unit/contact/interface/test_faces.py",)
STACKS = ("verification/test_verification_checks.py", "-k", "stacks")

LOOSE_STACKS = (
    Mutation(
        name="a corner that slides onto a face as if it had been open",
        old="            elif weight > 0.0:\n                point",
        new="            elif weight > 1.0:\n                point",
        tests=("unit/contact/interface/test_faces.py", "-k", "slides_onto"),
    ),
    Mutation(
        name="a lever rule that loads the far end of a face",
        old="(share - 1.0 if k == LEFT else -share)",
        new="(-share if k == LEFT else share - 1.0)",
        tests=FACES,
    ),
    Mutation(
        name="a corner that carries all up to the edge of a face and nothing beyond",
        old="weight = min(max(0.5 + 0.5 * inside, 0.0), 1.0)",
        new="weight = 1.0 if inside >= 0.0 else 0.0",
        tests=FACES,
    ),
    Mutation(
        name="a force on the face that points as that on the corner",
        old="corner_force[c, d] += (",
        new="corner_force[c, d] += (1.0 if k == TOUCHING else -1.0) * (",
        tests=FACES,
    ),
    Mutation(
        name="slips of a corner of the lower box counted the other way",
        old="corner)\n        point[i, 0] = faces.origin[i] + faces.side[i] * share",
        new="corner)\n        point[i, 0] = faces.origin[i] + share",
        tests=FACES,
    ),
    Mutation(
        name="friction of the floor in every joint",
        old="joint.mu = run.problem.contact.mu_static[points_of(run, j)[0]]\n        if",
        new="joint.mu = run.problem.contact.mu_static[0]\n        if",
        tests=STACKS,
    ),
    Mutation(
        name="the dashpot of the floor in every joint",
        old="relaxation_time=extended(floor.relaxation_time, damping)",
        new="relaxation_time=extended(floor.relaxation_time, floor.relaxation_time[0])",
        tests=("unit/model/test_loose_stack.py", "-k", "dashpot"),
    ),
    Mutation(
        name="a box that may lie on the floor without having fallen",
        old="fallen = fallen or new.corner[c, 1] <= 0.0",
        new="fallen = fallen or new.corner[c, 1] <= -1e9",
        tests=STACKS,
    ),
    Mutation(
        name="a stop that the swing of the box below ends",
        old="while box >= 0 and run.joints[box].slides == 0:",
        new="while box >= j and run.joints[box].slides == 0:",
        tests=STACKS,
    ),
)
