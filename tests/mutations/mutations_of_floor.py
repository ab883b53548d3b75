"""Faults in the physical floor: cap, indentation, its work, slope."""

from mutation import Mutation

LANDING = ("verification/test_verification_checks.py", "-k", "landing")
FLOOR = "verification/closed_forms/test_floor.py"
SOLVER = "unit/contact/interface/test_solver.py"
SLAB = "unit/model/test_floor.py"
PLATES = "unit/model/test_landing_on_castings.py"
WEAK = "unit/model/test_weak_floor.py"

DROP = ("verification/closed_forms/test_contact_drop.py", "-k", "crushes")
CAMBER = "verification/closed_forms/test_camber.py"
PLANE = "unit/contact/stepping/test_plane_slider.py"

FLOOR_FAULTS = (
    Mutation(
        name="edges of a flat base that reach to the next node",
        old="outside = (left + right) / lengths",
        new="outside = np.ceil((left + right) / lengths)",
        tests=("unit/model/test_edge_springs.py", "-k", "one_place"),
    ),
    Mutation(
        name="a gain by damping that excuses itself",
        old="control.energy_share * max(dissipated, 0.0)",
        new="control.energy_share * abs(dissipated)",
        tests=("unit/contact/stepping/test_control.py",),
    ),
    Mutation(
        name="every floor of a building moves as its roof",
        old="shapes.sum(axis=0) * shapes[floor - 1]",
        new="shapes.sum(axis=0) * shapes[-1]",
        tests=("unit/seismic/test_floor.py", "-k", "closed_form"),
    ),
    Mutation(
        name="a slider that a rising floor makes lighter",
        old="            n = gravity + acceleration[2, i] + s * dn\n",
        new="            n = gravity - acceleration[2, i] + s * dn\n",
        tests=(PLANE, "-k", "planar"),
    ),
    Mutation(
        name="a turn of the path that no step looks for",
        old="error = max(error, h * early)",
        new="error = max(error, 0.0 * early)",
        tests=(PLANE, "-k", "planar"),
    ),
    Mutation(
        name="a slider that never sticks again",
        old="state, w, q = STICKS, 0.0, 0.0",
        new="state, w, q = SLIDES, 0.0, 0.0",
        tests=(PLANE, "-k", "planar"),
    ),
    Mutation(
        name="a landing without friction",
        old="_shrunk(w, q, mu_kinetic * max(-rising, 0.0))",
        new="_shrunk(w, q, 0.0 * max(-rising, 0.0))",
        tests=(PLANE, "-k", "landing"),
    ),
    Mutation(
        name="camber of the other sign",
        old="point[i, 1] += contact.camber[i] + crushed[i]",
        new="point[i, 1] += crushed[i] - contact.camber[i]",
        tests=(CAMBER, "-k", "small_rocking and rigid"),
    ),
    Mutation(
        name="points of a cambered base twice as stiff",
        old="curvature * distance[pairs] ** 2",
        new="0.5 * curvature * distance[pairs] ** 2",
        tests=(CAMBER, "-k", "closed_form"),
    ),
    Mutation(
        name="a resultant that lags behind the place of touch",
        old="max(radius * (rotation + time * rate), -reach)",
        new="max(radius * (rotation - time * rate), -reach)",
        tests=(CAMBER, "-k", "pulse"),
    ),
    Mutation(
        name="rolling resistance that is not in the ledger",
        old="damping += rolling_loss(run)",
        new="damping += 0.0 * rolling_loss(run)",
        tests=(CAMBER, "-k", "pulse"),
    ),
    Mutation(
        name="a mass centre that does not rise as the base rolls",
        old="(contact.rolling_radius - (old.pose",
        new="0.0 * (contact.rolling_radius - (old.pose",
        tests=(CAMBER, "-k", "pulse"),
    ),
    Mutation(
        name="a cap on the spring alone, not on the dashpot",
        old="    if force >= cap:\n        return cap, 0.0, 0.0\n",
        new="    if stiffness * penetration >= cap:\n        return cap, 0.0, 0.0\n",
        tests=("unit/contact/interface/test_laws.py",),
    ),
    Mutation(
        name="the tangent of the spring kept at the cap",
        old="return cap, 0.0, 0.0",
        new="return cap, slope, by_rate",
        tests=("unit/contact/interface/test_laws.py",),
    ),
    Mutation(
        name="a point at its cap without its tangential tangent",
        old="return work.slope[i, 2] != 0.0 or work.slope[i, 0] != 0.0",
        new="return work.slope[i, 2] != 0.0",
        tests=(SOLVER,),
    ),
    Mutation(
        name="no elastic guess between open and the cap",
        old="if iteration > 0 and level * work.level[i] < 0:",
        new="if iteration < 0 and level * work.level[i] < 0:",
        tests=(SOLVER, "-k", "gives_up"),
    ),
    Mutation(
        name="an indentation that is forgotten at each step",
        old="indented = old.crushed[i]",
        new="indented = 0.0 * old.crushed[i]",
        tests=DROP,
    ),
    Mutation(
        name="points above the undamaged floor in the contact problem",
        old="        indent(contact, work.free, old.crushed)\n",
        new="",
        tests=DROP,
    ),
    Mutation(
        name="the elastic part indents the floor, too",
        old="indented = max(indented, -new.point[i, 1] - elastic)",
        new="indented = max(indented, -new.point[i, 1])",
        tests=LANDING,
    ),
    Mutation(
        name="points above the undamaged floor in the frame of the floor",
        old="    indent(run.problem.contact, run.old.point, run.old.crushed)\n",
        new="",
        tests=(FLOOR, "-k", "frame"),
    ),
    Mutation(
        name="rest on the edges that rocking crushed",
        old="least = min(least, crushed[i] + camber[i])",
        new="least = max(least, crushed[i] + camber[i])",
        tests=("unit/model/test_landing_on_castings.py", "-k", "least_crushed"),
    ),
    Mutation(
        name="a corner that bears no more as it sinks in",
        old="(1.0 + contact.cap_growth[i] * old.crushed[i])",
        new="(1.0 + 0.0 * contact.cap_growth[i] * old.crushed[i])",
        tests=DROP,
    ),
    Mutation(
        name="an edge that wins as much width as a casting",
        old="return sum(box.height for box in case.stack) / case.stack[0].width",
        new="return 1.0",
        tests=(SLAB, "-k", "wins_more_width"),
    ),
    Mutation(
        name="a weak floor that turns the container about the edge",
        old="share = case.effective_width - 2.0 * inset / mesh.width",
        new="share = case.effective_width - 0.0 * inset / mesh.width",
        tests=(WEAK, "-k", "in_the_middle"),
    ),
    Mutation(
        name="a floor of five times the weight that turns the container about the edge",
        old="SEEN = 0.005",
        new="SEEN = 0.015",
        tests=(WEAK, "-k", "in_the_middle"),
    ),
    Mutation(
        name="corners that stay where the container does not turn",
        old="share = pivot_share(case, mesh) if sharp else case.support.effective_width",
        new="share = case.support.effective_width",
        tests=(WEAK, "-k", "in_the_middle"),
    ),
    Mutation(
        name="a landing on plates whose block gains as it rolls out",
        old="math.sqrt((about_middle + inner**2) * about_corner)",
        new="(about_middle + inner**2)",
        tests=(PLATES, "-k", "rolled_over"),
    ),
    Mutation(
        name="half the weight on the corner that carries all of it",
        old="LEAST_BEARING = 1.2",
        new="LEAST_BEARING = 0.6",
        tests=(SLAB, "-k", "sinks_into_the_floor"),
    ),
    Mutation(
        name="a corner that is never destroyed",
        old="if depth <= slab.deepest:",
        new="if depth <= 1e3 * slab.deepest:",
        tests=("unit/run/test_slab_run.py", "-k", "gives_way"),
    ),
    Mutation(
        name="half the work of crushing",
        old="work += 0.5 * (force[i, 1]",
        new="work += 0.25 * (force[i, 1]",
        tests=("unit/contact/stepping/test_ledger.py",),
    ),
    Mutation(
        name="the work of crushing left out of the balance",
        old="- material - change[CRUSHING] - stored",
        new="- material - 0.0 * change[CRUSHING] - stored",
        tests=(FLOOR, "-k", "alike"),
    ),
    Mutation(
        name="the work of crushing left out of the dissipation",
        old=" + terms[MATERIAL_DAMPING] + terms[CRUSHING]",
        new=" + terms[MATERIAL_DAMPING]",
        tests=("unit/contact/stepping/test_ledger.py",),
    ),
    Mutation(
        name="gravity uphill in the floating frame",
        old="force += now * body.mass * body.downhill",
        new="force -= now * body.mass * body.downhill",
        tests=(FLOOR, "-k", "stands_still"),
    ),
    Mutation(
        name="gravity uphill at the nodes",
        old="body.damping_force[i, 0] - pull)",
        new="body.damping_force[i, 0] + pull)",
        tests=(FLOOR, "-k", "full_model_slides"),
    ),
    Mutation(
        name="gravity's internal forces at the nodes without their part along the slope",
        old="        new.internal[2 * i] -= body.nodal_mass[i] * body.downhill\n",
        new="",
        tests=(FLOOR, "-k", "full_model_slides"),
    ),
    Mutation(
        name="a potential without the way down",
        old="    new.energy[POTENTIAL] -= body.mass * body.downhill * (position[0] - floor)\n",
        new="",
        tests=(FLOOR,),
    ),
    Mutation(
        name="no work of gravity along the floor's displacement",
        old="(shear + run.problem.control.mass * run.problem.control.downhill)",
        new="(shear + 0.0 * run.problem.control.mass * run.problem.control.downhill)",
        tests=(FLOOR, "-k", "no_work"),
    ),
    Mutation(
        name="the force that holds on a slope taken downhill",
        old="run.floor[1, 2] - run.problem.control.downhill",
        new="run.floor[1, 2] + run.problem.control.downhill",
        tests=("verification/test_verification_checks.py", "-k", "floor and slider"),
    ),
    Mutation(
        name="settled as on a level floor",
        old="        system[m + 1, :m] -= shear_ratio * point[chosen, 1]\n",
        new="",
        tests=(FLOOR, "-k", "stands_still"),
    ),
    Mutation(
        name="at rest only at the height of the place it was set down",
        old="* sunk + downhill",
        new="* sunk",
        tests=(FLOOR, "-k", "comes_to_rest"),
    ),
)
