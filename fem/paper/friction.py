"""What the paper says of friction: halts at the reversals, stick-slip there, and kinetic over static friction."""

import math

import numpy as np

from contact.reference.floor_acceleration import sine_floor
from contact.reference.sliding import RigidSlider, simulate_sliding
from fem.paper.cases import ANGULAR_FREQUENCY, BOX, FOR_MAPS, PLATEAU, STACK, harmonic
from fem.paper.claims import Comparison, Finding, Statement, Table
from fem.paper.experiments import RIGID, Laboratory
from fem.paper.figures import Line, drawing
from fem.paper.maps import Cell, stack_map


def reversal(laboratory: Laboratory) -> Finding:
    """Section 3: more static friction at the reversals, the same kinetic friction."""
    comparisons, setups = [], []
    table: list[tuple[str, float, str, str, float, float]] = []
    changes = 0.0
    for name, base in (("box", BOX), ("stack", STACK)):
        for peak in (4.2, 5.0, 6.5, 8.0):
            group = [
                base.but(
                    {
                        **FOR_MAPS,
                        "contact.mu_static": static,
                        "contact.mu_kinetic": 0.2,
                        "solver.duration_s": 10.0,
                        **harmonic(peak, 10.0),
                    },
                    f"{name}, mu {static:g}/0.2, {peak:g} m/s² at 10 rad/s",
                )
                for static in (0.2, 0.4)
            ]
            smooth, rough = laboratory.rows(group)
            setups += group
            if name == "box":
                changes = max(changes, abs(rough["slip_travel_m"] / smooth["slip_travel_m"] - 1.0))
            fallen = [row["outcome"] == "overturned" for row in (smooth, rough)]
            comparisons.append(
                _count(f"{name}, {peak:g} m/s²: stands or falls differently", float(fallen[0] != fallen[1]))
            )
            if peak > 0.4 * 9.81 and name == "box":
                change = rough["slip_travel_m"] / smooth["slip_travel_m"] - 1.0
                comparisons.append(
                    Comparison(
                        what=f"box, {peak:g} m/s²: |change of the path over the floor|",
                        measured=abs(change),
                        relation="<=",
                        limit=0.05,
                        unit="-",
                        inside=False,
                    )
                )
            table.append(
                (
                    name,
                    peak,
                    smooth["outcome"],
                    rough["outcome"],
                    1e3 * smooth["slip_travel_m"],
                    1e3 * rough["slip_travel_m"],
                )
            )
    return Finding(
        comparisons=tuple(comparisons),
        bounds="whether it stands; not how far it slides, nor whether it slides or rocks",
        reading=(
            "With mu_s = 0.4 in place of 0.2 at every reversal, and mu_k = 0.2 in both, "
            f"{sum((one == 'overturned') != (other == 'overturned') for _, _, one, other, *_ in table)} of "
            f"{len(table)} motions stand or fall otherwise, and "
            f"{sum(one != other for _, _, one, other, *_ in table)} end in another mode: what starts a motion "
            f"from rest is mu_s. The path of the box changes by up to {changes:.0%}."
        ),
        setups=tuple(setups),
        tables=(
            Table(
                caption="Stick-slip at the reversals: mu_s = 0.2 and 0.4, mu_k = 0.2",
                columns=(
                    "container",
                    "peak [m/s²]",
                    "outcome, 0.2/0.2",
                    "outcome, 0.4/0.2",
                    "path, 0.2/0.2 [mm]",
                    "path, 0.4/0.2 [mm]",
                ),
                rows=tuple(table),
            ),
        ),
        band=laboratory.band(
            STACK.but({**harmonic(5.0, 10.0), "solver.duration_s": 6.0}),
            quantity="rotation ratio of the stack at 5.0 m/s², 10 rad/s, mu 0.4/0.2",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="it stands",
            holds=lambda row: row["outcome"] != "overturned",
        ),
    )


def halt_at_extremes(laboratory: Laboratory) -> Finding:
    """Section 3: where in the floor's motion the relative motion comes to a halt."""
    frequency, gravity = 10.0, 9.81
    peaks = np.geomspace(4.0, 40.0, 9)
    lags = []
    for peak in peaks:
        slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=gravity)
        floor = sine_floor(amplitude=peak / frequency**2, angular_frequency=frequency)
        # at rest while the floor starts with its largest velocity: it does not drift to one side
        motion = simulate_sliding(
            slider, floor, duration=12.0 * math.pi / frequency, slip_velocity=-peak / frequency
        )
        ends = [one.end for one in motion.intervals if one.direction][-5:-1]
        phases = np.array(ends) * frequency % math.pi  # the extremes lie at pi/2
        lags.append(float(np.degrees(np.abs(phases - 0.5 * math.pi)).max()))
    friction = 0.2 * gravity / peaks
    near = friction <= 0.25
    return Finding(
        comparisons=(
            Comparison(
                what="phase between halt and extreme of the floor, mu_k g up to a quarter of the peak",
                measured=float(np.max(np.array(lags)[near])),
                relation="<=",
                limit=30.0,
                unit="°",
            ),
            Comparison(
                what="the same, all peaks from stiction on",
                measured=max(lags),
                relation="<=",
                limit=30.0,
                unit="°",
                inside=False,
            ),
        ),
        bounds="strong motion: mu_k g below a quarter of the floor's peak acceleration",
        reading=(
            "The slip of the exact slider ends up to "
            f"{float(np.max(np.array(lags)[near])):.0f}° of phase beside the extreme points of the floor where mu_k g "
            f"is at most a quarter of its peak, and up to {max(lags):.0f}° beside them over all peaks: it ends where "
            "body and floor are equally fast, and the body has the speed that friction gave it."
        ),
        setups=(
            BOX.but(
                {**RIGID, **harmonic(4.5, frequency), "solver.duration_s": 5.0}, "box, 4.5 m/s² at 10 rad/s"
            ),
        ),
        drawings=(
            drawing(
                "halt-at-extremes",
                (
                    "Phase between the end of a slip and the extreme point of the floor; exact slider, mu "
                    "0.4/0.2."
                ),
                [Line(x=peaks, y=lags, style="o-")],
                x_label="peak floor acceleration [m/s²]",
                y_label="phase beside the extreme [°]",
                log_x=True,
            ),
        ),
    )


def friction_ratio(laboratory: Laboratory) -> Finding:
    """Section 4.3: kinetic friction of 50, 92 and 100 % of static."""
    ratios = (0.5, 0.92, 1.0)
    maps: dict[float, list[Cell]] = {
        ratio: stack_map(
            laboratory,
            {"contact.mu_static": 0.4, "contact.mu_kinetic": round(0.4 * ratio, 6)},
            perturbed=ratio in (0.5, 1.0),
        )
        for ratio in ratios
    }
    half = maps[0.5]
    comparisons, setups = [], []
    table: list[tuple[str, int, int, int]] = []
    for ratio in ratios[1:]:
        pairs = [
            (one, other)
            for one, other in zip(half, maps[ratio], strict=True)
            if one.computed and other.computed
        ]
        differ = [pair for pair in pairs if pair[0].fell != pair[1].fell]
        sure = [pair for pair in differ if pair[0].sure and pair[1].sure]
        comparisons.append(
            _count(
                f"sure cells that stand with 50 % and fall with {100 * ratio:.0f} %, or the reverse",
                len(sure),
            )
        )
        table.append((f"{100 * ratio:.0f} %", len(pairs), len(differ), len(sure)))
        setups += [one.setup for one, _ in sure[:1]]
    boxes = [
        BOX.but(
            {
                **FOR_MAPS,
                "contact.mu_kinetic": round(0.4 * ratio, 6),
                "solver.duration_s": 10.0,
                **harmonic(5.0, ANGULAR_FREQUENCY),
            },
            f"box, mu_k = {100 * ratio:.0f} % of 0.4, 5.0 m/s² at 6.928 rad/s",
        )
        for ratio in ratios
    ]
    slips = [row["max_slip_m"] for row in laboratory.rows(boxes)]
    comparisons += [
        Comparison(
            what=f"largest slip of a box, {100 * ratio:.0f} % over 50 %",
            measured=slip / slips[0],
            relation="=",
            limit=1.0,
            unit="-",
            tolerance=0.1,
            inside=False,
        )
        for ratio, slip in zip(ratios[1:], slips[1:], strict=True)
    ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="whether the rigid stack overturns; not how far anything slides",
        reading=(
            f"The largest slip of a box under 5.0 m/s² is {1e3 * slips[0]:.0f} mm at 50 %, "
            f"{1e3 * slips[1]:.0f} mm at 92 % and {1e3 * slips[2]:.0f} mm at 100 %. The rigid stack ends "
            f"otherwise in {table[0][2]} and {table[1][2]} of its {table[0][1]} cells, {table[0][3]} and "
            f"{table[1][3]} of them surely. So much hangs on a choice that the paper calls arbitrary."
        ),
        setups=(*setups, *boxes),
        tables=(
            Table(
                caption="Cells of the stack's map that end otherwise than with mu_k = 50 % of mu_s = 0.4",
                columns=("mu_k over mu_s", "cells", "end otherwise", ".. and are sure"),
                rows=tuple(table),
            ),
        ),
        band=laboratory.band(
            PLATEAU.but({"contact.mu_kinetic": 0.4, "solver.duration_s": 10.0}),
            quantity="rotation ratio at the plateau value with mu_k = mu_s",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="the same outcome as with mu_k = 0.5 mu_s on the rigid block: it rocks",
            holds=lambda row: row["outcome"] == "rock",
        ),
    )


def _count(what: str, number: float, *, inside: bool = True) -> Comparison:
    return Comparison(what=what, measured=number, relation="<=", limit=0.0, unit="-", inside=inside)


STATEMENTS = (
    Statement(
        name="halt-at-extremes",
        section="3",
        quote=(
            "we have decaying speeds towards the extreme points, so that the relative motion ... "
            "gradually comes to a halt"
        ),
        tried="The exact slider from stiction to ten times its acceleration: phase of its halts.",
        examine=halt_at_extremes,
        seconds=2.0,
    ),
    Statement(
        name="reversal",
        section="3",
        quote="stick-slip phenomena towards the reversal ... do not affect the findings of this study",
        tried=(
            "Box and stack with the same kinetic friction and with or without more static friction at the "
            "reversals."
        ),
        examine=reversal,
    ),
    Statement(
        name="friction-ratio",
        section="4.3, Eq. 6",
        quote=(
            "the relation of mu_k being app. 50 % of mu_s is arbitrary; 92 % ... nearly 100 % of the stiction"
        ),
        tried="Maps of the rigid stack with mu_k at 50, 92 and 100 % of 0.4, and the slip of a box.",
        examine=friction_ratio,
        seconds=4.0,
    ),
)
