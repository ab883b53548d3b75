"""The paper's assumptions on the body: a prism or a cylinder, rigid, in one piece."""

import math
from collections.abc import Sequence

from closed_forms import first_swing_threshold
from evidence.findings import at_most, equal
from floors import sine_floor
from paper.cases import PLATEAU, RIGID, SHELL, STACK, PaperCase
from paper.claims import Curve, Evidence, claim, draw_curves, outcomes, table
from paper.dimensions import ANGULAR_FREQUENCY, GRAVITY, HALF_WIDTH, HEIGHT, PLATEAU_PEAK, WIDTH
from paper.experiments import Experiments

from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking
from fem.case.case import load_case
from fem.model.recovery import recovery_of
from fem.report.models import compared_in_words, side_by_side
from fem.results.outcome import Outcome
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.run.verdict import joint_demands


def inertia_ratio(*, cylinder: bool, hollow: bool = False, height: float = HEIGHT) -> float:
    """I_O/(M R^2) in the plane of motion about the edge of the base, homogeneous or all mass in the side wall [-].

    About the mass centre: prism M (a^2 + c^2)/12; cylinder of diameter a, M (3 a^2/4 + c^2)/12; its thin wall
    M (3 a^2/2 + c^2)/12.
    """
    share = (1.5 if hollow else 0.75) if cylinder else 1.0
    own = (share * WIDTH**2 + height**2) / 12.0
    return 1.0 + own / (0.25 * (WIDTH**2 + height**2))


def _floor(peak: float) -> FloorAcceleration:
    """That of the paper, of a peak acceleration [m/s2]."""
    return sine_floor(amplitude=peak / ANGULAR_FREQUENCY**2, angular_frequency=ANGULAR_FREQUENCY)


@claim(
    "3",
    "Thus, the findings do also hold for a vertical cylindrical body instead of a prism",
    bounds="motion in one plane, homogeneous body",
)
def cylinder(experiments: Experiments) -> Evidence:
    """Inertia in the plane of motion: closed forms, and the exact blocks with the inertia of either."""
    ratios = {
        "prism": inertia_ratio(cylinder=False),
        "cylinder": inertia_ratio(cylinder=True),
        "cylinder, all mass in its wall": inertia_ratio(cylinder=True, hollow=True),
    }
    rows = []
    for name, ratio in ratios.items():
        body = RigidBlock(
            half_width=HALF_WIDTH, centroid_height=0.5 * HEIGHT, gravity=GRAVITY, inertia_ratio=ratio
        )
        largest = simulate_rocking(body, _floor(PLATEAU_PEAK), duration=3.0).largest_rotation
        largest /= body.slenderness_angle
        first_swing = first_swing_threshold(
            body, _floor, low=3.0, high=60.0, duration=4.0, relative_tolerance=1e-3
        )
        p, e = body.frequency_parameter, body.housner_restitution
        rows.append((name, ratio, p, e, body.uplift_acceleration, largest, first_swing))
    names = (
        "frequency parameter p",
        "Housner's restitution",
        "acceleration of tilting, g a/c",
        "largest rotation in 3 s at the plateau value",
        "acceleration that overturns in the first swing",
    )
    changes = [solid / prism for prism, solid in zip(rows[0][2:], rows[1][2:], strict=True)]
    for name, change in zip(names, changes, strict=True):
        yield equal(f"{name}, cylinder over prism", change, 1.0, 0.02 if name == names[3] else 0.01)
    loss = 1.0 - math.cos(2.0 * math.atan2(HALF_WIDTH, 0.5))
    prism, solid = (
        1.0 - loss / inertia_ratio(cylinder=cylindrical, height=1.0) for cylindrical in (False, True)
    )
    yield equal("Housner's restitution of one box, cylinder less prism", solid - prism, 0.0, 0.05)
    yield (
        f"A slender cylinder of the same width and height has I_O/(M R²) = {ratios['cylinder']:.4f} in place of 4/3: "
        f"p changes by {changes[0] - 1.0:+.2%}, e by {changes[1] - 1.0:+.2%}, and the largest rotation at the "
        f"plateau value by {changes[3] - 1.0:+.2%}. This is motion in the plane. A cylinder does not stay in it: it "
        "can roll on its rim, which no model of this program describes. The numbers are those of the exact block."
    )
    yield table(
        "In the plane of motion, 1.1 m wide, 4.0 m high",
        "body | I_O/(M R²) [-] | p [1/s] | e [-] | tilts from [m/s²] | rotation over slenderness angle "
        "in 3 s at the plateau value [-] | first-swing peak at 6.928 rad/s [m/s²]",
        rows,
    )


@claim(
    "abstract, 6",
    "the rigid body assumption (“rocking block”) can be dropped and deformations of the container, e.g. shell modes, "
    "can be considered",
    kind="remark",
)
def four_models(experiments: Experiments) -> Evidence:
    """The shipped stack at the plateau value by four models, under its motion and up to four times of it."""
    case = load_case("seed_stack_plateau", ["output.fields_s=0"])
    found = side_by_side(case)
    rows = [
        [
            one.model,
            *(one.found[key] for key in ("outcome", "rotation_ratio", "max_slip_m")),
            one.margin,
            one.found.flight_share,
        ]
        for one in found
    ]
    equal = side_by_side(case.replace({"contact.mu_kinetic": case.contact.mu_static}))[1:]
    yield table(
        "The stack of the paper at 4.0 m/s² and 6.928 rad/s, mu 0.4/0.2",
        "model | outcome | rotation ratio [-] | largest slip [m] | overturns first at | in the air [-]",
        rows,
    )
    yield (
        f"{compared_in_words(case, found)} The rigid models keep to mu_s and rock; a landing of the elastic container "
        "takes the load off a corner for an instant. With mu_k = 0.4 the rigid body and both elastic containers reach "
        f"{', '.join(f'{one.found.rotation_ratio:.3f}' for one in equal)} of the slenderness angle."
    )


@claim(
    "3",
    "body and surface are rigid; ... the stack remains rigid, “whipping” is excluded",
    bounds="whether the stack stands at the plateau value; not how it moves",
)
def rigid_assumption(experiments: Experiments) -> Evidence:
    """The plateau value with the rigid block, the shell of 8 mm and solid steel, with mu_k of 50 and 100 %; solid steel
    with other tolerances of the numerics."""
    base = PLATEAU.but(duration=10.0)
    bodies = {
        "rigid": base.but(RIGID),
        "shell of 8 mm": base.but(SHELL),
        "solid steel": base.but(SHELL, {"container.section": "solid", "container.youngs_modulus_Pa": 2.1e11}),
    }
    cases = [
        case.but(mu_kinetic=mu_kinetic, what=f"{name}, mu 0.4/{mu_kinetic:g}")
        for mu_kinetic in (0.2, 0.4)
        for name, case in bodies.items()
    ]
    numerics = [
        cases[2].but(
            {"solver.energy_tolerance": tolerance}, what=f"{cases[2].what}, energy tolerance {tolerance:g}"
        )
        for tolerance in (0.1, 10.0)
    ]
    rows = experiments.rows([*cases, *numerics])
    ends = [row["outcome"] for row in rows]
    ratios = [row["rotation_ratio"] for row in rows]
    slips = [1e3 * rows[k]["max_slip_m"] for k in (2, 6, 7)]
    reproduced = max(slips) <= 1.1 * min(slips)
    for k, name in ((1, "shell"), (2, "solid steel")):
        yield at_most(
            f"stands or falls otherwise than the rigid block, {name}", ends[k] == Outcome.OVERTURNED, 0.0
        )
    for k in (1, 4):
        mu = cases[k].what.rpartition(", ")[2]
        other = ends[k] != ends[k - 1]
        yield at_most(f"another regime than the rigid block, shell, {mu}", other, 0.0, inside=False)
        yield equal(
            f"rotation ratio, shell over rigid, {mu}", ratios[k] / ratios[k - 1], 1.0, 0.1, inside=False
        )
    yield (
        f"With mu_k = mu_s rigid block, shell and solid steel turn to {_range(ratios[3:6])} of the slenderness "
        f"angle, with mu_k = mu_s/2 to {_range(ratios[:3])}. {_CHANCE if len(set(ends[:3])) > 1 else ''}With an "
        f"energy tolerance of 1, 0.1 and 10 solid steel slides by {', '.join(f'{slip:.0f}' for slip in slips)} mm"
        f"{'' if reproduced else ': this slip is not reproducible'}."
    )
    yield from [*cases, *numerics]
    yield outcomes("At the plateau value", experiments, [*cases, *numerics])
    histories = {case.what: experiments.run(case).history for case in cases[:2]}
    yield draw_curves(
        "rigid-assumption",
        "Rotation at the plateau value, mu 0.4/0.2: rigid block and shell of 8 mm.",
        "time [s] | rotation [rad]",
        [Curve(history["time_s"], history["rotation_rad"], name) for name, history in histories.items()],
    )
    yield experiments.band(
        base,
        "rotation ratio at the plateau value",
        "the outcome of the rigid block",
        lambda row: row["outcome"] == ends[0],
    )


_CHANCE = (
    "It is not deformation by itself: friction that drops at once makes any vibration after an impact a sliding, and "
    "which regime follows then rests on chance. "
)


def _range(values: Sequence[float]) -> str:
    return f"{min(values):.3f} to {max(values):.3f}"


@claim(
    "3",
    "either gapping between the boxes is counterbalanced by the self-weight or the boxes are bolted",
    bounds="as long as the stack rests; a rocking one needs its bolts",
)
def gaps_between_boxes(experiments: Experiments) -> Evidence:
    """Forces in the joints of the stack, rigid and shell, at rest and rocking."""
    rows = []
    for base, name in ((STACK, "stated motion"), (PLATEAU, "plateau value")):
        for kind, model in (("rigid", RIGID), ("reduced", SHELL)):
            case = base.but(model, duration=10.0, interval=0.002, what=f"stack, {kind}, {name}")
            yield case
            tension, opened, slid = _joints(experiments, case)
            what = f"largest tension at an edge of any joint, {kind}, {name}"
            yield at_most(what, tension, 0.0, "kN", inside=base is STACK)
            rows.append((f"{kind}, {name}", tension, opened, slid))
    yield (
        f"At rest the joints carry at most {max(rows[0][1], rows[1][1]):.1f} kN of tension at an edge; at the "
        f"plateau value the bolts of the rigid stack carry {rows[2][1]:.1f} kN, those of the shell {rows[3][1]:.0f} "
        "kN. The tension of a rocking shell is that of an impact, and depends on the contact."
    )
    yield table(
        "Joints from the floor up without bolts; faces rigid, friction as on the floor",
        "run | largest tension [kN] | would open | would slide",
        rows,
    )


def _joints(experiments: Experiments, case: PaperCase) -> tuple[float, str, str]:
    """Largest tension at an edge [kN], and the numbers of the joints that would open, and slide, without bolts."""
    model = experiments.model(case)
    recorder = Recorder(model, recovery_of(model))
    ending = simulate(model, recorder)
    joints = (joint_demands(model, recorder.history()) if ending.status == "completed" else None) or ()
    tension = max(
        (max(demand.bolt_tension_left_N, demand.bolt_tension_right_N) for demand in joints), default=math.nan
    )
    opened = [str(demand.joint) for demand in joints if demand.opens_at_s is not None]
    slid = [str(demand.joint) for demand in joints if demand.slides_at_s is not None]
    return tension / 1e3, ", ".join(opened) or "none", ", ".join(slid) or "none"
