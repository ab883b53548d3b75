"""Faults in stops and ties."""

from mutation import Mutation

LINKS = "verification/closed_forms/test_links.py"
ON_BOXES = "verification/closed_forms/test_links_on_boxes.py"
BETWEEN = "verification/closed_forms/test_ties_in_rows.py"

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
        name="the lever of a tie to a wall at rest",
        old="(-ahead, -up) if tie.side == side else (ahead, up)",
        new="(-ahead, -up) if tie.side == side else (ahead, 0.0 * up + tie.height_m)",
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
        old="foot, top = (BOTTOM_RIGHT, TOP_RIGHT) if point.right",
        new="foot, top = (BOTTOM_RIGHT, BOTTOM_RIGHT) if point.right",
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
    Mutation(
        name="ties between containers that hold at the foot of their sides",
        old="return float(foot + faces.place[i, end] * (top - foot))",
        new="return float(foot)",
        tests=(BETWEEN, "-k", "distance_of_its_ends"),
    ),
    Mutation(
        name="a tie between containers that holds at one end alone",
        old="part = (1.0 if k < 2 else -1.0) * (place",
        new="part = (1.0 if k < 2 else 0.0) * (place",
        tests=(BETWEEN, "-k", "keeps_its_momentum"),
    ),
    Mutation(
        name="ties between containers that keep their direction",
        old="return x / length, z / length, length",
        new="return np.sign(x), 0.0, length",
        tests=(BETWEEN, "-k", "distance_of_its_ends"),
    ),
    Mutation(
        name="ends of ties in the frame of one container",
        old="apart=further[forth] if forth in further else -further[back],",
        new="apart=further[forth] if forth in further else further[back],",
        tests=(BETWEEN, "-k", "distance_of_its_ends"),
    ),
    Mutation(
        name="dashpot of a tie between containers for one mass",
        old="return mass if other is None else mass * masses[other] / (mass + masses[other])",
        new="return mass",
        tests=(BETWEEN, "-k", "keeps_its_momentum"),
    ),
    Mutation(
        name="a tie between containers that broke and is sought where it was",
        old="work.trial[i, 1] += old.crushed[i]",
        new="work.trial[i, 1] += 0.0",
        tests=(BETWEEN, "-k", "breaks"),
    ),
)
