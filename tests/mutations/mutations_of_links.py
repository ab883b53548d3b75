"""Faults in stops and ties."""

from mutation import Mutation

LINKS = "verification/closed_forms/test_links.py"
ON_BOXES = "verification/closed_forms/test_links_on_boxes.py"

LINK_FAULTS = (
    Mutation(
        name="a link that has broken holds again",
        old="new.crushed[i] += BROKEN\n    new.point[i, 1] += BROKEN",
        new="new.crushed[i] += 0.0",
        tests=(LINKS, "-k", "breaks"),
    ),
    Mutation(
        name="what a link held is lost without a row",
        old="change[CONTACT_DAMPING] += yielded + held",
        new="change[CONTACT_DAMPING] += yielded",
        tests=(LINKS, "-k", "breaks"),
    ),
    Mutation(
        name="walls that push without work",
        old="shear += push_of_links(run, links)",
        new="shear += 0.0 * push_of_links(run, links)",
        tests=(LINKS, "-k", "wedges"),
    ),
    Mutation(
        name="compliance of links turned on one side only",
        old="work.compliance[j, column] = along_z * x - along_x * z",
        new="work.compliance[j, column] = x",
        tests=("unit/contact/stepping/test_links.py",),
    ),
    Mutation(
        name="links without friction",
        old="run.work.mu[i] = run.problem.contact.mu_static[i]",
        new="run.work.mu[i] = 0.0",
        tests=(LINKS, "-k", "friction_on_a_face"),
    ),
    Mutation(
        name="a strap that holds before its slack is used up",
        old="[direction, apart - across, gap - along,",
        new="[direction, apart - across, -along,",
        tests=(LINKS, "-k", "strap_takes"),
    ),
    Mutation(
        name="ties to a wall that hold from the floor",
        old='return (outward, 0.0) if link.to == "wall" else (0.0, -1.0)',
        new="return 0.0, -1.0",
        tests=(LINKS, "-k", "tie_to_a_wall"),
    ),
    Mutation(
        name="restitution of a dashpot that pulls",
        old="math.exp(-math.tan(angle) * (math.pi - 2.0 * angle))",
        new="math.exp(-math.tan(angle) * math.pi)",
        tests=(LINKS, "-k", "belong"),
    ),
    Mutation(
        name="points of links at the foot of every box",
        old="*((BOTTOM_RIGHT, TOP_RIGHT) if point.right",
        new="*((BOTTOM_RIGHT, BOTTOM_RIGHT) if point.right",
        tests=(ON_BOXES, "-k", "momentum or as_one_container"),
    ),
    Mutation(
        name="links of the upper box on the lower one",
        old="number, bottom, height = case.stack.index(box), box.bottom, box.height",
        new="number, bottom, height = 0, 0.0, case.stack[-1].top",
        tests=(ON_BOXES, "-k", "holds_the_upper"),
    ),
    Mutation(
        name="records of links in place of those of gaps",
        old="before = new.point.shape[0] - line.shape[0], run.links.shape[0] - line.shape[0]",
        new="before = new.point.shape[0] - line.shape[0], 0",
        tests=(ON_BOXES, "-k", "momentum"),
    ),
    Mutation(
        name="what leans on a stop stands",
        old="run.joints.shape[0] == 1 and run.links.shape[0] == 0:",
        new="run.joints.shape[0] == 1:",
        tests=(ON_BOXES, "-k", "lean"),
    ),
)
