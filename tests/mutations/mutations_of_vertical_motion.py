"""Faults in the vertical motion of the floor."""

from mutation import Mutation

VERTICAL = "verification/closed_forms/test_vertical_motion.py"

VERTICAL_MOTION = (
    Mutation(
        name="points against a floor that moves the other way up and down",
        old="body.arm[i, 1] - lift\n        work.free_velocity",
        new="body.arm[i, 1] + lift\n        work.free_velocity",
        tests=(VERTICAL,),
    ),
    Mutation(
        name="points closed at their absolute vertical velocity",
        old="- sine * u + cosine * w - lift_velocity",
        new="- sine * u + cosine * w",
        tests=(VERTICAL,),
    ),
    Mutation(
        name="nodes against a floor that stays at its height",
        old="work.free[a, 1] -= lift\n",
        new="work.free[a, 1] -= 0.0 * lift\n",
        tests=(VERTICAL, "-k", "full or models"),
    ),
    Mutation(
        name="nodes closed at their absolute vertical velocity",
        old="work.free_velocity[a, 1] -= lift_velocity\n",
        new="work.free_velocity[a, 1] -= 0.0 * lift_velocity\n",
        tests=(VERTICAL, "-k", "full or models"),
    ),
    Mutation(
        name="kinetic energy of the full model against the ground",
        old="0.5 * twice + lift_velocity *",
        new="0.5 * twice + 0.0 * lift_velocity *",
        tests=(VERTICAL, "-k", "full or models"),
    ),
    Mutation(
        name="gravity less the vertical acceleration where the support holds",
        old="gravity = run.problem.control.gravity + run.lift[1, 2] - pushed",
        new="gravity = run.problem.control.gravity - run.lift[1, 2] - pushed",
        tests=("verification/test_verification_checks.py", "-k", "vertical and slider"),
    ),
    Mutation(
        name="work of the vertical motion with the other sign",
        old="return -mass * gained / step",
        new="return mass * gained / step",
        tests=(VERTICAL,),
    ),
    Mutation(
        name="kinetic energy against the ground",
        old="rise = velocity[1] - lift_velocity",
        new="rise = velocity[1]",
        tests=(VERTICAL,),
    ),
    Mutation(
        name="restitution without the work of the vertical motion",
        old="work += work_of_lift(control.mass, old.pose, new.pose, lift, step)",
        new="work += 0.0 * control.mass",
        tests=(VERTICAL, "-k", "restitution"),
    ),
    Mutation(
        name="settled under g alone",
        old="weight=mesh.mass * gravity,\n            centroid",
        new="weight=mesh.mass * case.gravity_m_s2,\n            centroid",
        tests=(VERTICAL, "-k", "settled"),
    ),
    Mutation(
        name="a container left at rest by a floor that moves up",
        old="stance = stance.moving(*velocity)",
        new="stance = stance.moving(velocity[0])",
        tests=(VERTICAL, "-k", "start"),
    ),
    Mutation(
        name="the frame of the floor entered without its vertical velocity",
        old="shift_velocity(body, run.old, (floor_velocity, lift_velocity, 0.0)",
        new="shift_velocity(body, run.old, (floor_velocity, 0.0, 0.0)",
        tests=(VERTICAL, "-k", "steadily"),
    ),
    Mutation(
        name="contents that do not rise with the floor",
        old="x = monitor[i, k] + floor[k]",
        new="x = monitor[i, k] + (floor[0] if k == 0 else 0.0)",
        tests=(VERTICAL, "-k", "contents"),
    ),
    Mutation(
        name="centre above the ground in the history",
        old="b[CENTRE_Z], b[VELOCITY_Z]) - lift\n    row[ROW_UPLIFT]",
        new="b[CENTRE_Z], b[VELOCITY_Z]) + 0.0 * lift\n    row[ROW_UPLIFT]",
        tests=(VERTICAL, "-k", "gravity"),
    ),
    Mutation(
        name="steps of the horizontal motion alone",
        old="for motion in motions:\n        share",
        new="for motion in motions[:1]:\n        share",
        tests=("unit/model/test_step_size.py", "-k", "vertical"),
    ),
)
