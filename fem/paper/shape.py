"""The paper's assumptions on the body: a prism or a cylinder, rigid, in one piece."""

import math
from dataclasses import replace

import numpy as np

from contact.reference.floor_acceleration import sine_floor
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import first_swing_threshold, simulate_rocking
from fem.assessment.joint_demands import joint_demands
from fem.assessment.rigid_check import block_of, first_peaks
from fem.model.recovery import recovery_of
from fem.paper.cases import (
    ANGULAR_FREQUENCY,
    GRAVITY,
    HALF_WIDTH,
    HEIGHT,
    NO_SLIDING,
    PLATEAU,
    PLATEAU_PEAK,
    STACK,
    WIDTH,
)
from fem.paper.claims import Comparison, Finding, Setup, Statement, Table
from fem.paper.experiments import RIGID, Laboratory
from fem.paper.figures import Line, drawing
from fem.run.recorder import Recorder
from fem.run.simulation import simulate

RESTITUTION = "Housner's restitution"


def inertia_ratio(
    *, cylinder: bool, hollow: bool = False, width: float = WIDTH, height: float = HEIGHT
) -> float:
    """I_O/(M R^2) in the plane of motion about the edge of the base, homogeneous or all mass in the side wall [-].

    About the mass centre: prism M (a^2 + c^2)/12; cylinder of diameter a, M (3 a^2/4 + c^2)/12; its thin wall
    M (3 a^2/2 + c^2)/12.
    """
    share = (1.5 if hollow else 0.75) if cylinder else 1.0
    own = (share * width**2 + height**2) / 12.0
    return 1.0 + own / (0.25 * (width**2 + height**2))


def block(ratio: float) -> RigidBlock:
    """The stack with another inertia."""
    return RigidBlock(
        half_width=HALF_WIDTH, centroid_height=0.5 * HEIGHT, gravity=GRAVITY, inertia_ratio=ratio
    )


def cylinder(laboratory: Laboratory) -> Finding:
    """A vertical cylinder in the plane of motion: its inertia, in closed forms, analytic blocks and runs."""
    prism = block(inertia_ratio(cylinder=False))
    bodies = {
        "prism": prism,
        "cylinder": block(inertia_ratio(cylinder=True)),
        "cylinder, all mass in its wall": block(inertia_ratio(cylinder=True, hollow=True)),
    }
    table, comparisons = [], []
    first = {name: _first_swing(body) for name, body in bodies.items()}
    for name, body in bodies.items():
        peak = _largest_at_plateau(body)
        table.append(
            (
                name,
                body.inertia_ratio,
                body.frequency_parameter,
                body.housner_restitution,
                peak,
                first[name],
            )
        )
    solid = bodies["cylinder"]
    changes = {
        "frequency parameter p": solid.frequency_parameter / prism.frequency_parameter,
        RESTITUTION: solid.housner_restitution / prism.housner_restitution,
        "acceleration of tilting, g a/c": solid.uplift_acceleration / prism.uplift_acceleration,
        "acceleration that overturns in the first swing": first["cylinder"] / first["prism"],
    }
    comparisons = [
        Comparison(
            what=f"{what}, cylinder over prism",
            measured=ratio,
            relation="=",
            limit=1.0,
            unit="-",
            tolerance=0.01,
        )
        for what, ratio in changes.items()
    ]
    run_prism, run_cylinder, setup = _runs(laboratory, solid.inertia_ratio)
    comparisons.append(
        Comparison(
            what=(
                "largest rotation of the first two swings at the plateau value, run of the cylinder over "
                "run of the prism"
            ),
            measured=run_cylinder / run_prism,
            relation="=",
            limit=1.0,
            unit="-",
            tolerance=0.02,
        )
    )
    box = [inertia_ratio(cylinder=one, height=1.0) for one in (False, True)]
    square = 1.0 - (1.0 - math.cos(2.0 * math.atan2(HALF_WIDTH, 0.5))) / np.array(box)
    comparisons.append(
        Comparison(
            what="Housner's restitution of one box, cylinder less prism",
            measured=float(square[1] - square[0]),
            relation="=",
            limit=0.0,
            unit="-",
            tolerance=0.05,
        )
    )
    return Finding(
        comparisons=tuple(comparisons),
        bounds="motion in one plane, homogeneous body",
        reading=(
            f"A slender cylinder of the same width and height has I_O/(M R²) = {solid.inertia_ratio:.4f} "
            f"in place of 4/3: p changes by {100.0 * (changes['frequency parameter p'] - 1.0):+.2f} %, e "
            f"by {100.0 * (changes[RESTITUTION] - 1.0):+.2f} %, and the largest rotation in the runs by "
            f"{100.0 * (run_cylinder / run_prism - 1.0):+.2f} %. This is motion in the plane. A cylinder does not "
            "stay in it: it can roll on its rim, which no model of this program knows. The case file knows prisms "
            "alone: the run is one of the rigid model with the cylinder's inertia put in its place, not "
            "repeatable from the command line; the other figures are of the analytic block."
        ),
        setups=(setup,),
        tables=(
            Table(
                caption="In the plane of motion, 1.1 m wide, 4.0 m high",
                columns=(
                    "body",
                    "I_O/(M R²) [-]",
                    "p [1/s]",
                    "e [-]",
                    "largest rotation/beta at the plateau value [-]",
                    "first-swing peak at 6.928 rad/s [m/s²]",
                ),
                rows=tuple(table),
            ),
        ),
    )


def rigid_assumption(laboratory: Laboratory) -> Finding:
    """Body and surface are rigid: what the shell does differently at the plateau value."""
    base = PLATEAU.but({"solver.duration_s": 10.0})
    rigid = base.but(RIGID, "stack, rigid, plateau value")
    shell = base.but({"solver.model": "reduced"}, "stack, shell of 8 mm, plateau value")
    stiff = base.but(
        {"solver.model": "reduced", "container.section": "solid", "container.youngs_modulus_Pa": 2.1e11},
        "stack, solid steel, plateau value",
    )
    equal = {"contact.mu_kinetic": 0.4}
    held = [rigid.but(equal, "rigid, mu 0.4/0.4"), shell.but(equal, "shell, mu 0.4/0.4")]
    group = [rigid, shell, stiff, *held]
    rows = laboratory.rows(group)
    outcomes = [row["outcome"] for row in rows]
    ratios = [row["rotation_ratio"] for row in rows]
    record = [laboratory.record(setup).history for setup in (rigid, shell)]
    return Finding(
        comparisons=(
            _same("stands or falls as the rigid block does, shell", "overturned" in outcomes[:2]),
            _same(
                "another regime than the rigid block, shell, mu 0.4/0.2",
                outcomes[1] != outcomes[0],
                inside=False,
            ),
            _same(
                "another regime than the rigid block, shell, mu 0.4/0.4",
                outcomes[4] != outcomes[3],
                inside=False,
            ),
            Comparison(
                what="rotation ratio, shell over rigid, mu 0.4/0.4",
                measured=ratios[4] / ratios[3],
                relation="=",
                limit=1.0,
                unit="-",
                tolerance=0.1,
                inside=False,
            ),
            Comparison(
                what="rotation ratio, shell over rigid, mu 0.4/0.2",
                measured=ratios[1] / ratios[0],
                relation="=",
                limit=1.0,
                unit="-",
                tolerance=0.1,
                inside=False,
            ),
        ),
        bounds="whether the stack stands at the plateau value; not how it moves",
        reading=(
            f"With mu 0.4/0.2 the rigid block {_verb(outcomes[0])} to {ratios[0]:.3f} of beta. The shell "
            f"{_verb(outcomes[1])} to {ratios[1]:.3f} with mu 0.4/0.2, and {_verb(outcomes[4])} to {ratios[4]:.3f} "
            "with mu_k = mu_s; solid steel "
            f"{_verb(outcomes[2])} to {ratios[2]:.3f}. What deformation can change is what an impact leaves: it "
            "sets the shell ringing, and with its ringing the normal force and the grip."
        ),
        setups=tuple(group),
        drawings=(
            drawing(
                "rigid-assumption",
                "Rotation at the plateau value, mu 0.4/0.2: rigid block and shell of 8 mm.",
                [
                    Line(x=one["time_s"], y=one["rotation_rad"], label=name)
                    for one, name in zip(record, ("rigid", "shell"), strict=True)
                ],
                x_label="time [s]",
                y_label="rotation [rad]",
            ),
        ),
        band=laboratory.band(
            base,
            quantity="rotation ratio at the plateau value",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="the outcome of the rigid block",
            holds=lambda row: row["outcome"] == outcomes[0],
        ),
    )


def gaps_between_boxes(laboratory: Laboratory) -> Finding:
    """Gapping between the boxes is counterbalanced by the self-weight, or they are bolted."""
    comparisons, table, setups = [], [], []
    for base, name in ((STACK, "stated motion"), (PLATEAU, "plateau value")):
        for model in ("rigid", "reduced"):
            setup = base.but(
                {"solver.model": model, "solver.duration_s": 10.0, "output.history_s": 0.002},
                f"stack, {model}, {name}",
            )
            setups.append(setup)
            built = laboratory.model(setup)
            recorder = Recorder(built, recovery_of(built))
            ending = simulate(built, recorder)
            joints = joint_demands(built, recorder.history()) if ending.status == "completed" else None
            tension = max(
                (max(one.bolt_tension_left_N, one.bolt_tension_right_N) for one in joints or ()),
                default=math.nan,
            )
            opened = [one.joint for one in joints or () if one.opens_at_s is not None]
            slid = [one.joint for one in joints or () if one.slides_at_s is not None]
            comparisons.append(
                Comparison(
                    what=f"largest tension at an edge of any joint, {model}, {name}",
                    measured=tension / 1e3,
                    relation="<=",
                    limit=0.0,
                    unit="kN",
                    inside=base is STACK,
                )
            )
            table.append((f"{model}, {name}", tension / 1e3, _listed(opened), _listed(slid)))
    return Finding(
        comparisons=tuple(comparisons),
        bounds="as long as the stack rests; a rocking one needs its bolts",
        reading=(
            "What the bolts of the joints carry: "
            + "; ".join(
                f"{run}: {tension:.1f} kN at an edge, would open without bolts: {opened}, would slide: {slid}"
                for run, tension, opened, slid in table
            )
            + ". The tension of a rocking shell is that of a collision at an impact, and depends on the contact."
        ),
        setups=tuple(setups),
        tables=(
            Table(
                caption="Joints from the floor up; faces rigid, friction as on the floor",
                columns=("run", "largest tension [kN]", "would open", "would slide"),
                rows=tuple(table),
            ),
        ),
    )


def _first_swing(body: RigidBlock) -> float:
    return first_swing_threshold(
        body,
        lambda peak: sine_floor(amplitude=peak / ANGULAR_FREQUENCY**2, angular_frequency=ANGULAR_FREQUENCY),
        low=3.0,
        high=60.0,
        duration=4.0,
        relative_tolerance=1e-3,
    )


def _largest_at_plateau(body: RigidBlock) -> float:
    floor = sine_floor(amplitude=PLATEAU_PEAK / ANGULAR_FREQUENCY**2, angular_frequency=ANGULAR_FREQUENCY)
    return simulate_rocking(body, floor, duration=8.0).largest_rotation / body.slenderness_angle


def _runs(laboratory: Laboratory, ratio: float) -> tuple[float, float, Setup]:
    """Largest rotation of the first two swings of the rigid model as a prism and with another inertia [rad]."""
    setup = PLATEAU.but(
        {**RIGID, **NO_SLIDING, "container.section": "solid", "solver.duration_s": 3.0},
        "homogeneous rigid stack, plateau value (the prism)",
    )
    found = []
    for wanted in (None, ratio):
        model = laboratory.model(setup)
        if wanted is not None:
            square = block_of(model).radius ** 2
            inertia = model.container.mesh.mass * square * (wanted - 1.0)
            body = model.body._replace(inertia=inertia)  # type: ignore[union-attr]
            model = replace(model, footing=replace(model.footing, body=body))
        recorder = Recorder(model)
        simulate(model, recorder)
        history = recorder.history()
        peaks = first_peaks(history["time_s"], history["rotation_rad"], 1e-3)
        found.append(max(abs(rotation) for _, rotation in peaks[:2]))
    return found[0], found[1], setup


def _same(what: str, differs: bool, *, inside: bool = True) -> Comparison:
    return Comparison(what=what, measured=float(differs), relation="<=", limit=0.0, unit="-", inside=inside)


def _verb(outcome: str | None) -> str:
    words = {"rest": "rests", "slide": "slides", "rock": "rocks", "slide-rock": "slides and rocks"}
    return words.get(outcome or "", "overturns")


def _listed(joints: list[int]) -> str:
    return ", ".join(str(joint) for joint in joints) or "none"


STATEMENTS = (
    Statement(
        name="cylinder",
        section="3",
        quote="Thus, the findings do also hold for a vertical cylindrical body instead of a prism",
        tried=(
            "Inertia in the plane of motion: closed forms, analytic blocks, and the rigid model with the "
            "cylinder's inertia."
        ),
        examine=cylinder,
        seconds=3.0,
    ),
    Statement(
        name="rigid-assumption",
        section="3",
        quote="body and surface are rigid; the stack remains rigid, whipping is excluded",
        tried=(
            "The plateau value with the rigid block, the shell of 8 mm and solid steel, with mu_k of 50 "
            "and 100 %."
        ),
        examine=rigid_assumption,
    ),
    Statement(
        name="gaps-between-boxes",
        section="3",
        quote=(
            "either gapping between the boxes is counterbalanced by the self-weight or the boxes are bolted"
        ),
        tried="Forces in the joints of the stack, rigid and shell, at rest and rocking.",
        examine=gaps_between_boxes,
    ),
)
