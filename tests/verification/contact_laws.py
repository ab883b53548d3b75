"""Contact with the floor: patch test, penetration, drops, impact of a bar, energy audit, opening edges.

Wriggers, Computational Contact Mechanics (2006). The impact bar is that of Hughes, Taylor, Sackman, Curnier and
Kanoknukulchai, Comput. Methods Appl. Mech. Eng. 8 (1976) 249: exact by d'Alembert's solution.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import runs
from block_on_springs import largest_corner_force
from closed_forms import damped_drop_restitution, drop_force
from evidence.findings import Convergence, analytic, computed
from meshes import graded_block, grid_mesh
from verification.bodies import Flight, free_run, full_body
from verification.checks import Findings, check

from contact.interface.equilibrium import standing
from contact.interface.support import choose_support
from contact.motion.kernel import PIECEWISE, as_floor_motion
from contact.reference.rigid_block import RigidBlock
from contact.stepping.body import VELOCITY_Z
from contact.stepping.scheme import generalised_alpha, newmark
from fem.model.model import build_model
from fem.run.verdict import audit
from fem.solid.assembly import assemble
from fem.solid.reduction import static_response

LANDING = 3.0  #: of damped drops, far above g sqrt(m/k) [m/s]
#: the bar's 10 m/s would strain it by a third, and the exact solution is that of small strains [m/s]
BAR_SPEED = 0.02
LIGHT: runs.Keys = {"gravity_m_s2": 0.01, "container.weight_N": 100.0}


@check(
    "contact", "contact patch test on a graded base", inputs="Mass and width of the block come from the mesh."
)
def patch_test() -> Findings:
    """A homogeneous elastic block stands on a graded flat base with uniform pressure; nu = 0."""
    mesh = graded_block()
    weight = runs.GRAVITY * mesh.mass
    for order in (1, 2):
        elements = assemble(mesh, youngs_modulus=1e8, poisson_ratio=0.0, order=order)
        support = choose_support("flat", elements.nodes[elements.base_nodes, 0], depth=0.5, order=order)
        stance = standing(
            weight=weight,
            centroid=mesh.centroid,
            point=elements.nodes[elements.base_nodes] - np.asarray(mesh.centroid),
            compliance=static_response(elements, elements.base_nodes).compliance,
            normal_stiffness=support.normal_stiffness(1e9),
            camber=support.camber,
        )
        pressure = stance.force[:, 1] / (support.length * support.depth)
        exact = weight / (mesh.width * support.depth)
        worst = pressure[np.argmax(np.abs(pressure - exact))]
        case = f"block on a graded flat base, elements of order {order}"
        compared = "contact pressure at the worst node [Pa]"
        yield analytic(case, compared, worst, exact, source="weight over area", relative=1e-8)


@check("contact", "static penetration")
def penetration() -> Findings:
    """Static penetration under the weight: weight over penalty and area, in a run that stays at rest."""
    depths = {}
    for penalty in (1e8, 1e9, 1e10, 1e11):
        values = {"contact.normal_penalty_Pa_m": penalty, "support.kind": "flat", "solver.duration_s": 0.05}
        depths[1.0 / penalty] = float(runs.run(runs.STACK, values).track.max_penetration)
    yield analytic(
        "rigid stack on a flat base",
        "penetration at a penalty of 1e11 Pa/m [m]; order in 1/penalty",
        depths[1.0 / 1e11],
        98100.0 / (1e11 * 1.1 * 1.1),
        source="weight/(penalty x area)",
        relative=1e-6,
        convergence=Convergence("1/penalty [m/Pa]", depths, order=1.0, within=0.02),
    )


@check("contact", "flat drops", inputs="The stiffness of the base is the model's.")
def flat_drops() -> Findings:
    """Largest floor force of a flat drop without damping."""
    source = "m g + sqrt((m g)^2 + k m v^2)"
    for speed in (0.1, 1.0):
        model = build_model(runs.BOX.with_values({"contact.damping_ratio": 0.0, "solver.duration_s": 0.02}))
        gap = 1e-4 * speed
        done = runs.finish(runs.lifted(model, gap, math.sqrt(speed**2 - 2.0 * runs.GRAVITY * gap)))
        force = 2.0 * float(done.track.peak_corner_force)
        exact = drop_force(mass=2500.0, stiffness=model.base_stiffness, speed=speed, gravity=runs.GRAVITY)
        case = f"rigid box lands flat at {speed} m/s"
        yield analytic(case, "largest floor force [N]", force, exact, source=source, relative=5e-3)


@check("contact", "damped drops")
def damped_drops() -> Findings:
    """Rebound from springs and dashpots that do not pull, almost without gravity; steps of one size."""
    steps = (4e-5, 2e-5, 1e-5, 5e-6)
    for ratio in (0.05, 0.1, 0.2, 0.5):
        exact = damped_drop_restitution(ratio)
        rebounds = {step: rebound(ratio, step) for step in steps}
        errors = {step: abs(value - exact) for step, value in rebounds.items()}
        yield analytic(
            f"rigid box lands flat, heave damping ratio {ratio}, steps of 5 us",
            "rebound speed over approach speed; order in the step",
            rebounds[5e-6],
            exact,
            source="contact ends where k x + c v = 0 (Schwager and Poschel 2007)",
            relative=2e-3,
            convergence=Convergence("step [s]", errors, order=1.0, within=0.2, at_least=True),
            note="order 1: the dashpot starts to act at touchdown; no step control, since it compares the energy "
            "balance with the energy to overturn, which is almost zero without gravity",
        )


@check(
    "contact",
    "corner force of a landing",
    inputs="Stiffness and dashpot of a corner, and the window of the mean, are the model's.",
)
def landing_force() -> Findings:
    """Largest mean force on a corner of a block that is released from half its slenderness angle and lands.

    The program's mean slides by an eighth of the window, a tenth of the bounce's period, and takes the force as linear
    over a step. The dashpot of ratio 2, the default, makes the force of the first touch a spike that begins within a
    step: the part of that step before the touch is taken from the spike.
    """
    for height, ratio, tolerance in (
        (4.0, 0.05, 0.005),
        (4.0, 0.3, 0.005),
        (1.65, 0.3, 0.005),
        (4.0, 2.0, 0.04),
    ):
        tilt = 0.5 * math.atan(1.1 / height)
        released = {"initial.rotation_rad": tilt, "contact.damping_ratio": ratio, "solver.duration_s": 0.73}
        done = runs.run(runs.STACK, released | {"container.height_m": height})
        contact, window = done.model.run.problem.contact, float(done.model.run.problem.control.force_window)
        exact = largest_corner_force(
            RigidBlock.homogeneous(width=1.1, height=height),
            mass=1e4,
            stiffness=float(contact.normal_stiffness[0]),
            relaxation_time=float(contact.relaxation_time[0]),
            friction=1.0,
            window=window,
            rotation=tilt,
            duration=0.73,
        )
        yield computed(
            f"rigid block of 1.1 x {height:g} m lands, damping ratio of the contact {ratio:g}",
            f"largest mean force on a corner over {1e3 * window:.2f} ms [N]",
            float(done.track.max_corner_force),
            exact,
            source="block on two springs with dashpots, explicit steps of 8 us",
            relative=tolerance,
            note="read low: the spike begins within a step" if ratio > 1.0 else "",
        )


@check("contact", "impact of a bar", quick=False)
def impact_bar() -> Findings:
    """An elastic bar strikes a wall: one reflection of the wave, then it leaves."""
    impact = bar_impact(elements=400)
    case, source = "bar of 400 elements, penalty E/h, generalised-alpha 0.5", "d'Alembert: 2 L/c, rho c v, v"
    for compared, value, exact, tolerance in (
        ("time in contact [s]", impact.contact_time, 2.0 / 3.0, 0.02),
        ("force per unit area, middle half of the contact", impact.force, 300.0, 0.01),
        ("speed of the mass centre after the rebound [m/s]", impact.rebound, 10.0, 0.01),
    ):
        yield analytic(case, compared, value, exact, source=source, relative=tolerance)
    compared = "energy after the rebound over the energy before, minus 1"
    yield analytic(case, compared, impact.energy_change, source="an elastic impact", absolute=5e-3)


@check("contact", "the energy audit refuses a gain")
def stiff_trapezoidal() -> Findings:
    """The trapezoidal rule gains energy on a stiff penalty: the audit of a run must refuse it."""
    compared = "refused by the audit for a gain (1) or not (0)"
    for name, trapezoidal, ratio, refused in (
        ("trapezoidal rule, penalty 100 E/h", True, 100.0, True),
        ("generalised-alpha 0.5, penalty E/h", False, 1.0, False),
    ):
        impact = bar_impact(elements=100, trapezoidal=trapezoidal, penalty_ratio=ratio)
        # a model whose run is the flight's; the energy to overturn is the flight's energy
        run, clock = impact.flight.run, impact.flight.run.clock[0]
        control = run.problem.control._replace(reference_energy=impact.flight.first_energy)
        model = replace(build_model(runs.STACK), run=run.with_problem(control=control))
        gained = audit(model) is not None and -clock.least_imbalance > clock.most_imbalance
        case, note = f"bar of 100 elements, {name}", f"energy change {impact.energy_change:+.2%} of the first"
        yield analytic(case, compared, gained, refused, source="energy is conserved", absolute=0.0, note=note)


@check("contact", "opening edges")
def opening_edges() -> Findings:
    """Floor acceleration that grows slowly: when an edge of a flat base opens, when a block on corners lifts."""
    jerk = 0.4  # toward -x [m/s3]
    coefficients = np.array([[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, -jerk]])
    floor = as_floor_motion(PIECEWISE, breaks=np.zeros(1), coefficients=coefficients)
    edge, corner = "the edge of the base opens", "the stack lifts off one corner"
    third, moment = "g a/(3c): the resultant leaves the middle third", "g a/c: moment equilibrium"
    for support, share, event, compared, source in (
        ("flat", 3.0, "first_opening", edge, third),
        ("corners", 1.0, "first_uplift", corner, moment),
    ):
        mesh = {"solver.element_size_m": 0.1, "solver.order": 2}
        case = runs.STACK.with_values({"support.kind": support, "solver.duration_s": 8.0} | mesh)
        done = runs.finish(runs.with_motion(build_model(case), floor))
        yield analytic(
            f"rigid stack, support {support}, floor acceleration growing by {jerk} m/s3",
            f"acceleration when {compared} [m/s2]",
            jerk * float(done.track[event]),
            runs.GRAVITY * 1.1 / (share * 4.0),
            source=source,
            relative=0.01,
        )


def rebound(damping_ratio: float, step: float) -> float:
    """Rebound over approach speed of the box, in steps of one size [s]."""
    # heave: both corners' c and k; the case's ratio puts the whole mass on one of them
    values = LIGHT | {
        "contact.damping_ratio": damping_ratio / math.sqrt(2.0),
        "contact.normal_penalty_Pa_m": 1e9,
        "solver.duration_s": 0.02,
    }
    model = runs.lifted(build_model(runs.BOX.with_values(values)), 1e-3, LANDING)
    done = runs.finish(runs.with_steps_of(model, step))
    return float(done.model.run.old.pose[VELOCITY_Z]) / LANDING


class BarImpact(NamedTuple):
    """Result of an elastic bar striking a rigid wall."""

    contact_time: float  #: [s]
    force: float  #: mean over the middle half of the contact, per unit area
    rebound: float  #: speed of the mass centre [m/s]
    energy_change: float  #: of kinetic and strain energy over the first, after the rebound [-]
    flight: Flight


def bar_impact(*, elements: int, trapezoidal: bool = False, penalty_ratio: float = 1.0) -> BarImpact:
    """Bar of E = 900, rho = 1, L = 10, unit section, against a wall; results for 10 m/s.

    The wave crosses one of the `elements` in a step; the penalty is `penalty_ratio` times E/h. Generalised-alpha
    of spectral radius 0.5, or the trapezoidal rule.
    """
    modulus, length, speed = 900.0, 10.0, BAR_SPEED
    size = length / elements
    mesh = grid_mesh(
        np.array([-0.5, 0.5]), np.linspace(0.0, length, elements + 1), depth=1.0, areal_density=1.0
    )
    discretised = assemble(mesh, youngs_modulus=modulus, poisson_ratio=0.0, order=1)
    flight = free_run(
        full_body(discretised, gravity=1e-5),
        scheme=newmark(0.25, 0.5) if trapezoidal else generalised_alpha(0.5),
        step=size / 30.0,
        velocity=np.tile([0.0, -speed], len(discretised.nodes)),
        springs=np.full(2, 0.5 * penalty_ratio * modulus / size),
    )
    flight.advance(0.9, trace=True)
    times, force = np.array(flight.times), np.array(flight.normal_force)
    touching = times[force > 0.0]
    middle = (times > 0.25 * 0.66667) & (times < 0.75 * 0.66667)
    energy = 0.5 * length * speed**2
    return BarImpact(
        contact_time=float(touching[-1] - touching[0]) if touching.size else math.nan,
        force=float(force[middle].mean()) * 10.0 / speed,
        rebound=float(flight.run.old.pose[VELOCITY_Z]) * 10.0 / speed,
        energy_change=float(flight.run.old.energy[:2].sum()) / energy - 1.0,
        flight=flight,
    )
