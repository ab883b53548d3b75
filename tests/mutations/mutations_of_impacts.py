"""Faults in the restitution asked of the impacts."""

from mutation import Mutation

RESTITUTION = "verification/closed_forms/test_restitution.py"
FEW = (RESTITUTION, "-k", "every_impact or carries or slip or mirrored")
SEVERAL = (RESTITUTION, "-k", "every_container or on_one_that_stands or land_on_boxes")

IMPACTS = (
    Mutation(
        name="a share of the energy in place of one of the angular momentum",
        old="turn = (1.0 - share) * momentum",
        new="turn = (1.0 - share**2) * momentum",
        tests=FEW,
    ),
    Mutation(
        name="the angular momentum of the spin alone",
        old="momentum += mass * (arm_z * velocity_x - arm_x * velocity_z) + own",
        new="momentum += own",
        tests=FEW,
    ),
    Mutation(
        name="the other corner as the one that landed",
        old="corner = begin if landed == -1 else end - 1",
        new="corner = begin if landed == 1 else end - 1",
        tests=FEW,
    ),
    Mutation(
        name="velocities against the ground at an impact",
        old="velocity_x, velocity_z = pose[VELOCITY_X] - run.floor[1, 1],",
        new="velocity_x, velocity_z = pose[VELOCITY_X],",
        tests=FEW,
    ),
    Mutation(
        name="the loss of an impact left out of the ledger",
        old="change[IMPACTS] += lost",
        new="change[IMPACTS] += 0.0 * lost",
        tests=FEW,
    ),
    Mutation(
        name="the work of the floor at an impact left out",
        old="change[BASE_WORK] += work\n",
        new="change[BASE_WORK] += 0.0 * work\n",
        tests=FEW,
    ),
    Mutation(
        name="an impact that loses at every step",
        old="    joint.landed = 0\n    return landed if turns else 0",
        new="    return landed if turns else 0",
        tests=FEW,
    ),
    Mutation(
        name="an impact that loses when the container lifts much later",
        old="turns = joint.landing_rate > 0.0 and landed * rate > TURNING_ON * joint.landing_rate",
        new="turns = True",
        tests=(RESTITUTION, "-k", "chatters"),
    ),
    Mutation(
        name="a frame whose spin does not move the mass centre",
        old="state.velocity[0] -= velocity + spin * state.position[1]",
        new="state.velocity[0] -= velocity",
        tests=FEW,
    ),
    Mutation(
        name="impacts of the first container of a row, or of the lowest box, alone",
        old="        if joint.impact_share == 1.0:",
        new="        if joint.impact_share == 1.0 or j > 0:",
        tests=SEVERAL,
    ),
    Mutation(
        name="a row that turns as a whole where one of it lands",
        old="boxes = j + 1 if in_a_row(run) else run.joints.shape[0]",
        new="boxes = run.joints.shape[0]",
        tests=SEVERAL,
    ),
    Mutation(
        name="a box that loses where the floor does not take the reaction",
        old="if landed != 0 and carrier_of(run, j) < 0:",
        new="if landed != 0:",
        tests=SEVERAL,
    ),
)
