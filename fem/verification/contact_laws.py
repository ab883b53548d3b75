"""The contact with the floor: patch test, penetration, drops, impact of a bar, opening edges, a ledger that must fail.

Wriggers, Computational Contact Mechanics (2006). The impact bar is that of Hughes, Taylor, Sackman, Curnier and
Kanoknukulchai, Comput. Methods Appl. Mech. Eng. 8 (1976) 249: exact by d'Alembert's solution.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.interface.equilibrium import standing
from contact.interface.support import choose_support
from contact.motion.kernel import PIECEWISE, FloorMotion, as_floor_motion
from contact.reference.closed_forms_rocking import damped_drop_restitution, drop_force
from contact.stepping.body import VELOCITY_Z
from fem.assessment.verdict import audit
from fem.model.model import Model, build_model
from fem.solid.assembly import assemble
from fem.solid.nodal_body import FullBody
from fem.solid.reduction import static_response
from fem.verification.bodies import Flight, free_run
from fem.verification.rows import Check, Convergence, Row, as_floats
from fem.verification.runs import BOX, GRAVITY, STACK, finish, lifted, run, with_motion, with_steps_of
from mesh.container import ContainerMesh

LANDING = 3.0  #: of damped drops, far above g sqrt(m/k) [m/s]
#: the bar's 10 m/s would strain it by a third, and the exact solution is that of small strains [m/s]
BAR_SPEED = 0.02
LIGHT = {"gravity_m_s2": 0.01, "container.weight_N": 100.0}


def patch_test() -> list[Row]:
    """A homogeneous elastic block stands on a graded flat base with uniform pressure; nu = 0."""
    mesh = graded_block()
    rows = []
    for order in (1, 2):
        elements = assemble(mesh, youngs_modulus=1e8, poisson_ratio=0.0, order=order)
        support = choose_support("flat", elements.nodes[elements.base_nodes, 0], depth=0.5, order=order)
        springs = support.normal_stiffness(1e9)
        weight = GRAVITY * mesh.mass
        stance = standing(
            weight=weight,
            centroid=mesh.centroid,
            point=elements.nodes[elements.base_nodes] - np.asarray(mesh.centroid),
            compliance=static_response(elements, elements.base_nodes).compliance,
            normal_stiffness=springs,
        )
        pressure = stance.force[:, 1] / (support.length * support.depth)
        exact = weight / (mesh.width * support.depth)
        rows.append(
            Row(
                case=f"block on a graded flat base, elements of order {order}",
                compared="contact pressure, the worst node [Pa]",
                value=float(pressure[np.argmax(np.abs(pressure - exact))]),
                reference=exact,
                kind="analytic",
                source="weight over area",
                tolerance=1e-8,
                relative=True,
            )
        )
    return rows


def penetration() -> list[Row]:
    """Static penetration under the weight: weight over penalty and area, in a run that stands still."""
    penalties = (1e8, 1e9, 1e10, 1e11)
    found = []
    for penalty in penalties:
        done = run(
            STACK, {"contact.normal_penalty_Pa_m": penalty, "support.kind": "flat", "solver.duration_s": 0.05}
        )
        found.append(float(done.track.max_penetration))
    exact = 98100.0 / (penalties[-1] * 1.1 * 1.1)
    return [
        Row(
            case="rigid stack on a flat base",
            compared="penetration at a penalty of 1e11 Pa/m [m]; order in 1/penalty",
            value=found[-1],
            reference=exact,
            kind="analytic",
            source="weight/(penalty x area)",
            tolerance=1e-6,
            relative=True,
            convergence=Convergence(
                against="1/penalty [m/Pa]",
                sizes=as_floats([1.0 / penalty for penalty in penalties]),
                errors=as_floats(found),
                expected=1.0,
                tolerance=0.02,
            ),
        )
    ]


def flat_drops() -> list[Row]:
    """Largest floor force of a flat drop without damping."""
    rows = []
    for speed in (0.1, 1.0):
        model = build_model(BOX.with_values({"contact.damping_ratio": 0.0, "solver.duration_s": 0.02}))
        gap = 1e-4 * speed
        done = finish(lifted(model, gap, math.sqrt(speed**2 - 2.0 * GRAVITY * gap)))
        rows.append(
            Row(
                case=f"rigid box lands flat at {speed} m/s",
                compared="largest floor force [N]",
                value=2.0 * float(done.track.peak_corner_force),
                reference=drop_force(
                    mass=2500.0, stiffness=model.base_stiffness, speed=speed, gravity=GRAVITY
                ),
                kind="analytic",
                source="m g + sqrt((m g)^2 + k m v^2)",
                tolerance=5e-3,
                relative=True,
            )
        )
    return rows


def damped_drops() -> list[Row]:
    """Rebound from springs and dashpots that do not pull, gravity next to nothing; steps of one size."""
    steps = (4e-5, 2e-5, 1e-5, 5e-6)
    rows = []
    for ratio in (0.05, 0.1, 0.2, 0.5):
        exact = damped_drop_restitution(ratio)
        found = [landing(ratio, step) for step in steps]
        rows.append(
            Row(
                case=f"rigid box lands flat, damping ratio {ratio} of its heave, steps of 5 us",
                compared="rebound over approach speed; order in the step",
                value=found[-1],
                reference=exact,
                kind="analytic",
                source="contact ends where k x + c v = 0 (Schwager and Poschel 2007)",
                tolerance=2e-3,
                relative=True,
                convergence=Convergence(
                    against="step [s]",
                    sizes=steps,
                    errors=as_floats([abs(value - exact) for value in found]),
                    expected=1.0,
                    tolerance=0.2,
                    at_least=True,
                ),
                note="order 1: the dashpot is switched on at touch; no step control, whose ledger is held "
                "against the energy to overturn: next to nothing without gravity",
            )
        )
    return rows


def landing(damping_ratio: float, step: float) -> float:
    """Rebound over approach speed of the box, in steps of one size [s]."""
    # heave: both corners' c and k; the case's ratio puts the whole mass on one of them
    values = LIGHT | {
        "contact.damping_ratio": damping_ratio / math.sqrt(2.0),
        "contact.normal_penalty_Pa_m": 1e9,
        "solver.duration_s": 0.02,
    }
    model = lifted(build_model(BOX.with_values(values)), 1e-3, LANDING)
    done = finish(with_steps_of(model, step))
    return float(done.model.run.old.pose[VELOCITY_Z]) / LANDING


@dataclass(frozen=True, kw_only=True)
class BarImpact:
    """What an elastic bar did that struck a rigid wall."""

    contact_time: float  #: [s]
    force: float  #: mean over the middle half of the contact, per unit area
    rebound: float  #: speed of the mass centre [m/s]
    energy_change: float  #: of kinetic and strain energy over the first, after the rebound [-]
    flight: Flight


def bar_impact(
    *, radius: float | None, elements: int, penalty_ratio: float, steps_per_element: float
) -> BarImpact:
    """Bar of E = 900, rho = 1, L = 10, unit section, against a wall; fixed steps, results for 10 m/s.

    Args:
        radius: spectral radius of generalised-alpha; None is the trapezoidal rule.
        elements: along the bar.
        penalty_ratio: penalty over E/h.
        steps_per_element: for the wave to cross one.
    """
    modulus, length, speed = 900.0, 10.0, BAR_SPEED
    size = length / elements
    discretised = assemble(bar_mesh(length, elements), youngs_modulus=modulus, poisson_ratio=0.0, order=1)
    body = FullBody(
        discretised, discretised.base_nodes, discretised.base_nodes[:0], gravity=1e-5, damping=0.0
    )
    flight = free_run(
        body,
        radius=radius,
        step=size / 30.0 / steps_per_element,
        velocity=np.tile([0.0, -speed], len(discretised.nodes)),
        springs=np.full(2, 0.5 * penalty_ratio * modulus / size),
    )
    flight.advance(0.9, trace=True)
    times, force = flight.trace("normal_force")
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


def impact_bar() -> list[Row]:
    """An elastic bar strikes a wall: one reflection of the wave, then it leaves."""
    found = bar_impact(radius=0.5, elements=400, penalty_ratio=1.0, steps_per_element=1.0)
    case = "bar of 400 elements, penalty E/h, generalised-alpha 0.5"
    printed = (
        ("time in contact [s]", found.contact_time, 2.0 / 3.0, 0.02),
        ("force per unit area, middle half of the contact", found.force, 300.0, 0.01),
        ("speed of the mass centre after the rebound [m/s]", found.rebound, 10.0, 0.01),
    )
    rows = [
        Row(
            case=case,
            compared=compared,
            value=value,
            reference=reference,
            kind="analytic",
            source="d'Alembert: 2 L/c, rho c v, v",
            tolerance=tolerance,
            relative=True,
        )
        for compared, value, reference, tolerance in printed
    ]
    rows.append(
        Row(
            case=case,
            compared="energy after the rebound over the energy before, less 1",
            value=found.energy_change,
            reference=0.0,
            kind="analytic",
            source="an elastic impact",
            tolerance=5e-3,
        )
    )
    return rows


def stiff_trapezoidal() -> list[Row]:
    """The trapezoidal rule wins energy on a stiff penalty: the audit of a run must refuse it."""
    rows = []
    for name, radius, ratio, refused in (
        ("trapezoidal rule, penalty 100 E/h", None, 100.0, True),
        ("generalised-alpha 0.5, penalty E/h", 0.5, 1.0, False),
    ):
        found = bar_impact(radius=radius, elements=100, penalty_ratio=ratio, steps_per_element=1.0)
        rows.append(
            Row(
                case=f"bar of 100 elements, {name}",
                compared="refused by the audit for a gain (1) or not (0)",
                value=float("won" in (audit(_as_model(found)) or "")),
                reference=float(refused),
                kind="analytic",
                source="energy is conserved",
                tolerance=0.0,
                note=f"energy changed by {found.energy_change:+.2%} of the first",
            )
        )
    return rows


def opening_edges() -> list[Row]:
    """Floor acceleration that grows slowly: when the edge of a flat base opens, when a block on corners lifts."""
    jerk, rows = 0.4, []
    for support, share, event in (("flat", 3.0, "first_opening"), ("corners", 1.0, "first_uplift")):
        case = STACK.with_values(
            {
                "support.kind": support,
                "solver.duration_s": 8.0,
                "solver.element_size_m": 0.1,
                "solver.order": 2,
            }
        )
        done = finish(with_motion(build_model(case), growing_floor(jerk)))
        rows.append(
            Row(
                case=f"rigid stack on {support}, floor acceleration growing by {jerk} m/s3",
                compared="acceleration when the edge of the base opens [m/s2]"
                if support == "flat"
                else "acceleration when the stack lifts off one corner [m/s2]",
                value=jerk * float(done.track[event]),
                reference=GRAVITY * 1.1 / (share * 4.0),
                kind="analytic",
                source="g a/(3c): the resultant leaves the middle third"
                if share == 3.0
                else "g a/c: moment equilibrium",
                tolerance=0.01,
                relative=True,
            )
        )
    return rows


def growing_floor(jerk: float) -> FloorMotion:
    """A floor whose acceleration grows evenly from rest, toward -x [m/s3]."""
    coefficients = np.array([[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, -jerk]])
    return as_floor_motion(PIECEWISE, breaks=np.zeros(1), coefficients=coefficients)


def graded_block() -> ContainerMesh:
    """A block of 1.1 x 1.0 m, columns narrowing toward both ends."""
    x = 0.55 * np.sin(0.5 * np.pi * np.linspace(-1.0, 1.0, 9))
    z = np.linspace(0.0, 1.0, 6)
    columns, rows = x.size - 1, z.size - 1
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    cells = columns * rows
    return ContainerMesh(
        points=np.column_stack([np.tile(x, z.size), np.repeat(z, x.size)]),
        quads=np.column_stack([first, first + 1, first + columns + 2, first + columns + 1]),
        region=np.full(cells, 3),
        thickness=np.full(cells, 0.5),
        areal_density=np.full(cells, 1000.0),
    )


def bar_mesh(length: float, elements: int) -> ContainerMesh:
    """A column one element wide, of unit width, depth and density."""
    z = np.linspace(0.0, length, elements + 1)
    first = 2 * np.arange(elements)
    return ContainerMesh(
        points=np.column_stack([np.tile([-0.5, 0.5], z.size), np.repeat(z, 2)]),
        quads=np.column_stack([first, first + 1, first + 3, first + 2]),
        region=np.full(elements, 3),
        thickness=np.ones(elements),
        areal_density=np.ones(elements),
    )


def _as_model(found: BarImpact) -> Model:
    """A model whose run is the bar's, for the audit; the energy to overturn is the bar's energy."""
    flight = found.flight
    control = flight.run.control._replace(reference_energy=float(flight.first_energy))
    return replace(build_model(STACK), run=flight.run._replace(control=control))


CHECKS = (
    Check(name="contact patch test on a graded base", rows=patch_test),
    Check(name="static penetration", rows=penetration),
    Check(name="flat drops", rows=flat_drops),
    Check(name="damped drops", rows=damped_drops),
    Check(name="impact of a bar", rows=impact_bar, quick=False),
    Check(name="a ledger that must fail", rows=stiff_trapezoidal),
    Check(name="opening edges", rows=opening_edges),
)
