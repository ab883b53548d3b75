"""Faults to put into the physics, one at a time, each with the fast tests that must see it.

Signs, factors, dropped terms, one coefficient for another, tangents, the ledger: what a slip of the pen would do.
"""

from mutation import Mutation
from mutations_of_floor import FLOOR_FAULTS
from mutations_of_impacts import IMPACTS
from mutations_of_links import LINK_FAULTS
from mutations_of_loose_stacks import LOOSE_STACKS
from mutations_of_rows import ROW_FAULTS
from mutations_of_vertical_motion import VERTICAL_MOTION

ELASTICITY = (
    "unit/solid/test_elasticity.py",
    "unit/solid/test_assembly.py",
    "verification/convergence/test_elements.py",
)
MODAL = ("unit/contact/stepping/test_modal_body.py",)
LAWS = ("unit/contact/interface/test_laws.py", "unit/contact/interface/test_solver.py")
SLIDING = ("verification/test_verification_checks.py", "-k")

MUTATIONS = (
    Mutation(
        name="Lame pair of plane strain in place of plane stress",
        old="youngs_modulus * poisson_ratio / (1.0 - poisson_ratio**2)",
        new="youngs_modulus * poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))",
        tests=ELASTICITY,
    ),
    Mutation(
        name="linear strain: the products of gradients dropped in shear",
        old="0.5 * (xz + zx + xx * xz + zx * zz)",
        new="0.5 * (xz + zx)",
        tests=ELASTICITY,
    ),
    Mutation(
        name="sign of the shear stress in P = F S",
        old="(1.0 + xx) * sxz + xz * szz,",
        new="xz * szz - (1.0 + xx) * sxz,",
        tests=ELASTICITY,
    ),
    Mutation(
        name="shear strain counted once in the strain energy",
        old="shear * (xx * xx + zz * zz + 2.0 * xz * xz)",
        new="shear * (xx * xx + zz * zz + xz * xz)",
        tests=ELASTICITY,
    ),
    Mutation(
        name="geometric stiffness dropped from the tangent",
        old="tangent[i, j, i, l] += stress[j][l]",
        new="tangent[i, j, i, l] += 0.0 * stress[j][l]",
        tests=ELASTICITY,
    ),
    Mutation(
        name="stiffness without the factor 2 of the shear modulus",
        old="strain, test = sym_grad(u), sym_grad(v)\n    return w.thickness * (2.0 * w.shear",
        new="strain, test = sym_grad(u), sym_grad(v)\n    return w.thickness * (1.0 * w.shear",
        tests=ELASTICITY,
    ),
    Mutation(
        name="inertia of the mesh about its base, not its centroid",
        old="arms = ((positions - np.array(self.centroid)) ** 2).sum(axis=2)",
        new="arms = (positions**2).sum(axis=2)",
        tests=("unit/mesh/test_mesh_container.py",),
    ),
    Mutation(
        name="dashpot that pushes the container off",
        old="stiffness * penetration + damping * rate, stiffness, damping",
        new="stiffness * penetration - damping * rate, stiffness, damping",
        tests=LAWS,
    ),
    Mutation(
        name="a floor that pulls",
        old="        if force <= 0.0:\n            return 0.0, 0.0, 0.0\n",
        new="",
        tests=LAWS,
    ),
    Mutation(
        name="sign of friction against a negative trial force",
        old="return -limit, 0.0, -1.0",
        new="return limit, 0.0, 1.0",
        tests=LAWS,
    ),
    Mutation(
        name="mu_s for mu_k while sliding",
        old="    if slid >= weakening:\n        return mu_kinetic\n",
        new="    if slid >= weakening:\n        return mu_static\n",
        tests=(*LAWS, "verification/closed_forms/test_contact_sliding.py"),
    ),
    Mutation(
        name="tangent of regularised friction without the fall of mu",
        old="-normal * (mu_slope * sway + mu * sway_slope)",
        new="-normal * (mu * sway_slope)",
        tests=LAWS,
    ),
    Mutation(
        name="friction that does not know the normal force's tangent",
        old="work.slope[i, 1] = by_limit * mu[i] * work.slope[i, 2]",
        new="work.slope[i, 1] = 0.0 * by_limit",
        tests=LAWS,
    ),
    Mutation(
        name="friction that does not fall with the velocity",
        old="    return mu_kinetic + (mu_static - mu_kinetic) * math.exp(-ratio * ratio)\n",
        new="    return mu_static\n",
        tests=LAWS,
    ),
    Mutation(
        name="a stop with the springs of the slide",
        old="if turned and normal < IMPACT_LOAD * weight:",
        new="if turned and normal < 0.0:",
        tests=(*SLIDING, "short and stop"),
    ),
    Mutation(
        name="an elastic swing over the limit of friction that breaks the support loose",
        old="return abs(holding) > mu_static * normal or slid",
        new="return slid >= 0.0 or slid",
        tests=(*SLIDING, "pull and stiction"),
    ),
    Mutation(
        name="a support that cannot stand held as if it stood",
        old="    if not stands or turning * acceleration < 0.0:\n",
        new="    if not stands:\n",
        tests=(*SLIDING, "start and rest"),
    ),
    Mutation(
        name="a turn without a stop that restores static friction",
        old="            every = slides_on(run, j, step, turned, loose, links)\n",
        new="            every = slides_on(run, j, step, turned, loose, links)\n"
        "            joint.slip_since_break *= not turned\n",
        tests=(*SLIDING, "turn and without"),
    ),
    Mutation(
        name="elastic stick that forgets its elongation",
        old="                elongation = stick[i] + work.point[i, 0] - start[i, 0]",
        new="                elongation = work.point[i, 0] - start[i, 0]",
        tests=LAWS,
    ),
    Mutation(
        name="moment of the friction force with the wrong sign",
        old="out[2] += arm[i, 1] * tangential - arm[i, 0] * normal",
        new="out[2] += -arm[i, 1] * tangential - arm[i, 0] * normal",
        tests=MODAL,
    ),
    Mutation(
        name="velocity of a turned point without its angular part",
        old="state.velocity[1] - body.arm[i, 0] * rate - sine * u + cosine * w",
        new="state.velocity[1] - sine * u + cosine * w",
        tests=MODAL,
    ),
    Mutation(
        name="forces of the step's beginning dropped from the average",
        old="force = before * (old.external[j] - old.internal[j])",
        new="force = 0.0 * before",
        tests=MODAL,
    ),
    Mutation(
        name="beta of generalised-alpha without its square",
        old="newmark_beta=0.25 * (1.0 - alpha_m + alpha_f) ** 2,",
        new="newmark_beta=0.25 * (1.0 - alpha_m + alpha_f),",
        tests=("unit/contact/stepping/test_scheme.py",),
    ),
    Mutation(
        name="acceleration not shifted when the step changes",
        old="shift = (scheme.alpha_f - scheme.alpha_m) * shortened",
        new="shift = 0.0 * shortened",
        tests=("verification/convergence/test_time_newmark_family.py",),
    ),
    Mutation(
        name="an imbalance defined away: friction heat takes what is missing",
        old="change[IMBALANCE] = change[BASE_WORK] - friction - damping - material - change[CRUSHING] - stored",
        new="change[IMBALANCE] = 0.0 * stored",
        tests=("verification/convergence/test_time_energy.py",),
    ),
    Mutation(
        name="work of the floor with the wrong sign",
        old="shear += 0.5 * (old.force",
        new="shear -= 0.5 * (old.force",
        tests=("verification/convergence/test_time_energy.py",),
    ),
    Mutation(
        name="friction heat by the force of one end of the step",
        old="friction -= 0.5 * (force[i, 0] + force_new[i, 0]) * slip[i]",
        new="friction -= 0.5 * force_new[i, 0] * slip[i]",
        tests=("unit/contact/stepping/test_ledger.py",),
    ),
    Mutation(
        name="energy of the contact springs without the half",
        old="energy += 0.5 * contact.normal_stiffness[i] * point[i, 1] ** 2",
        new="energy += contact.normal_stiffness[i] * point[i, 1] ** 2",
        tests=("unit/contact/stepping/test_ledger.py",),
    ),
    Mutation(
        name="damping ratio with the whole base in place of one corner",
        old="math.sqrt(mass / (0.5 * base_stiffness))",
        new="math.sqrt(mass / base_stiffness)",
        tests=("unit/contact/interface/test_support.py",),
    ),
    Mutation(
        name="tilted start without the centripetal acceleration",
        old="free = np.array([downhill, -gravity]) - angular_velocity**2 * arm",
        new="free = np.array([downhill, -gravity])",
        tests=("unit/contact/interface/test_equilibrium.py",),
    ),
    Mutation(
        name="velocity of a harmonic floor without its frequency",
        old="return amplitude * sine, amplitude * omega * cosine, -amplitude * omega * omega * sine",
        new="return amplitude * sine, amplitude * cosine, -amplitude * omega * omega * sine",
        tests=("unit/contact/motion/test_base_motion.py",),
    ),
    Mutation(
        name="restitution by the ratio of energies, not of velocities",
        old="math.sqrt(max(after, 0.0) / before)",
        new="max(after, 0.0) / before",
        tests=("verification/against_block/test_first_impact.py", "-k", "peaks"),
    ),
    Mutation(
        name="restitution of an impact at which the container slides",
        old="track.heat <= SLIDING_HEAT * before",
        new="track.heat <= 1e9 * before",
        tests=("verification/against_block/test_first_impact.py", "-k", "slides"),
    ),
    Mutation(
        name="restitution without the work of the floor's motion",
        old="work = -control.mass * (floor[1, 1] - floor[0, 1]) / step * moved",
        new="work = 0.0 * moved",
        tests=("verification/against_block/test_first_impact.py", "-k", "ringing"),
    ),
    Mutation(
        name="impacts counted in a run that rests",
        old="rocks = not control.rolls and track.modes & (1 << ROCK | 1 << SLIDE_ROCK) != 0",
        new="rocks = not control.rolls",
        tests=("verification/against_block/test_first_impact.py", "-k", "rests or flutter"),
    ),
    Mutation(
        name="acceleration of the contents without its filter",
        old="contents_cutoff=2.0 * math.pi * case.output.contents_filter_Hz",
        new="contents_cutoff=1e4 + 0.0 * case.output.contents_filter_Hz",
        tests=("unit/contact/stepping/test_contents.py", "-k", "cut_off"),
    ),
    Mutation(
        name="velocities of the contents in the old frame after a change of frame",
        old="shift_contents(run.contents, (floor_velocity, lift_velocity))",
        new="shift_contents(run.contents, (0.0, lift_velocity))",
        tests=("unit/run/test_motion_ends.py", "-k", "no_jerk"),
    ),
    Mutation(
        name="Housner's restitution with cos(al) for cos(2 al)",
        old="1.0 - (1.0 - math.cos(2.0 * self.slenderness_angle)) / self.inertia_ratio",
        new="1.0 - (1.0 - math.cos(self.slenderness_angle)) / self.inertia_ratio",
        tests=("unit/contact/reference/test_rigid_block.py", "validation/test_closed_forms_rocking.py"),
    ),
    Mutation(
        name="the analytic block tilts with the floor, not against it",
        old="weight * math.sin(lean) + side * acceleration.x",
        new="weight * math.sin(lean) - side * acceleration.x",
        tests=("unit/contact/reference/test_rocking.py",),
    ),
    Mutation(
        name="the analytic slider slides on mu_s",
        old="friction = -direction * slider.mu_kinetic * (slider.gravity",
        new="friction = -direction * slider.mu_static * (slider.gravity",
        tests=("unit/contact/reference/test_slider.py",),
    ),
    Mutation(
        name="material damping of the full model in the fixed frame",
        old="body.turned[2 * i + 1] = cosine * x - sine * z, sine * x + cosine * z",
        new="body.turned[2 * i + 1] = x, z",
        tests=("verification/test_verification_checks.py", "-k", "large"),
    ),
    Mutation(
        name="rest in the frame of the earth, where the floor goes on",
        old="floor_velocity = run.floor[0, 1]\n    moving",
        new="floor_velocity = 0.0\n    moving",
        tests=("unit/run/test_motion_ends.py", "-k", "before_its_cap"),
    ),
    Mutation(
        name="a run for its outcome that ends with the container beyond its slenderness angle",
        old="            return UNSETTLED",
        new="            return REACHED",
        tests=("verification/closed_forms/test_vertical_motion.py",),
    ),
    Mutation(
        name="a motion cut short that is called whole",
        old="covered = max(0.0, min(end, duration) - max(begin, 0.0))",
        new="covered = max(0.0, end - max(begin, 0.0))",
        tests=("unit/run/test_motion_ends.py",),
    ),
    Mutation(
        name="the code's plateau without its 2.5",
        old="soil_factor * 2.5 / behaviour_factor",
        new="soil_factor / behaviour_factor",
        tests=("unit/model/test_static_checks.py", "validation/test_paper_numbers.py"),
    ),
    Mutation(
        name="an audit that lets the scheme win energy",
        old="if gained > GAIN_LIMIT * reference:",
        new="if gained > 1e9 * GAIN_LIMIT * reference:",
        tests=("verification/test_verification_checks.py", "-k", "audit"),
    ),
    Mutation(
        name="a band that does not try mu_kinetic up to mu_static",
        old="return short(min(own, LEAST_KINETIC * static)), static",
        new="return short(min(own, LEAST_KINETIC * static)), own",
        tests=("verification/sureness/test_sure_verdicts.py", "unit/case/test_case_uncertainty.py"),
    ),
    Mutation(
        name="a mass beside the axis that adds to both sides",
        old="factor[own] += distance * mass[own].sum()",
        new="factor[own] += abs(distance) * mass[own].sum()",
        tests=("unit/mesh/test_mass_beside.py",),
    ),
    Mutation(
        name="a member of an effective width that rocks about the corners of the mesh",
        old="placed[:count, 0] = share * place[:count, 0]",
        new="placed[:count, 0] = place[:count, 0]",
        tests=("unit/model/test_effective_width.py",),
    ),
    Mutation(
        name="castings that stand at the sides, wherever they are inset",
        old="(1.0 - 2.0 * self.support.inset / self.stack[0].width)",
        new="(1.0 - 0.0 * self.support.inset / self.stack[0].width)",
        tests=("unit/model/test_castings.py", "-k", "inside_its_sides"),
    ),
    Mutation(
        name="a material damping of a member that stays the run's",
        old="damping = container.damping(case.container.damping_ratio)\n    placed",
        new="damping = container.damping(0.02)\n    placed",
        tests=("unit/study/test_runner.py", "-k", "damping"),
    ),
    Mutation(
        name="sure although changes were left out",
        old="if no_outcome or missing or OTHER_END in levels",
        new="if no_outcome or OTHER_END in levels",
        tests=("unit/assessment/test_sureness.py", "-k", "left_out"),
    ),
    Mutation(
        name="a flat base below uplift without its stiff floor",
        old='bears = case.support.kind != "corners" or ',
        new="bears = ",
        tests=("verification/sureness/test_sure_verdicts.py", "-k", "flat"),
    ),
    Mutation(
        name="the last overturning taken for the first",
        old="change.high == min(fallen)",
        new="change.high == max(fallen)",
        tests=("unit/run/test_margin.py",),
    ),
    *VERTICAL_MOTION,
    *FLOOR_FAULTS,
    *IMPACTS,
    *LINK_FAULTS,
    *ROW_FAULTS,
    *LOOSE_STACKS,
)
