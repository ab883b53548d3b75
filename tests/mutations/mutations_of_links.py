"""Faults in stops and ties."""

from mutation import Mutation

LINKS = "verification/closed_forms/test_links.py"

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
        tests=("unit/contact/test_links.py",),
    ),
    Mutation(
        name="links without friction",
        old="run.work.mu[i] = run.problem.contact.mu_static[i]",
        new="run.work.mu[i] = 0.0",
        tests=(LINKS, "-k", "friction_on_a_face"),
    ),
    Mutation(
        name="a strap that holds before its slack is used up",
        old='gap - np.einsum("kc,kc->k", direction, place)',
        new='-np.einsum("kc,kc->k", direction, place)',
        tests=(LINKS, "-k", "strap_takes"),
    ),
    Mutation(
        name="restitution of a dashpot that pulls",
        old="math.exp(-math.tan(angle) * (math.pi - 2.0 * angle))",
        new="math.exp(-math.tan(angle) * math.pi)",
        tests=(LINKS, "-k", "belong"),
    ),
)
