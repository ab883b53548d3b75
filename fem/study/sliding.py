"""What the paper says of slipping: it does not depend on the number of boxes, and it stabilises."""

import math

import numpy as np

from contact.floor_acceleration import sine_floor
from contact.sliding import RigidSlider, simulate_sliding
from fem.study.drawings import Line, drawing
from fem.study.laboratory import RIGID, Laboratory, Row
from fem.study.maps import Cell, stack_map
from fem.study.setups import ANGULAR_FREQUENCY, BOX, FOR_MAPS, PLATEAU, STACK, harmonic
from fem.study.statements import Comparison, Finding, Setup, Statement, Table

#: c/a of the stack is 3.636: below a/c = 0.275 it slides before it tilts
WIDTH_OVER_HEIGHT = 1.1 / 4.0
FRICTIONS = ((0.2, 0.1), (0.25, 0.125), (0.3, 0.15), (0.4, 0.2), (0.4, 0.4))
LARGER = 1.05  #: a rotation that much larger counts as larger


def number_of_boxes(laboratory: Laboratory) -> Finding:
    """Slip of one to six boxes under the same floor."""
    stacks = (1, 2, 3, 4, 6)
    comparisons, rows_of_table, setups = [], [], []
    for static, kinetic in ((0.2, 0.1), (0.4, 0.2)):
        for peak in (2.5, 5.0, 8.0):
            group = [
                STACK.but(
                    {
                        **FOR_MAPS,
                        "container.boxes": boxes,
                        "contact.mu_static": static,
                        "contact.mu_kinetic": kinetic,
                        "solver.duration_s": 10.0,
                        **harmonic(peak, 10.0),
                    },
                    f"{boxes} boxes, mu {static:g}/{kinetic:g}, {peak:g} m/s² at 10 rad/s",
                )
                for boxes in stacks
            ]
            rows = laboratory.rows(group)
            flat = [row for row in rows if row["first_uplift_s"] is None]
            title = f"mu {static:g}/{kinetic:g}, {peak:g} m/s²"
            # lengths of path below a tenth of a millimetre are the elasticity of the contact
            if max(row["slip_travel_m"] for row in rows) < 1e-4:
                continue
            comparisons.append(_spread(f"{title}: all that never lift from the floor", flat, inside=True))
            if len(flat) < len(rows):
                comparisons.append(_spread(f"{title}: all of them", rows, inside=False))
            setups += [group[0], group[-1]]
            rows_of_table += [
                (title, boxes, row["outcome"], 1e3 * row["slip_travel_m"], row["rotation_ratio"])
                for boxes, row in zip(stacks, rows, strict=True)
            ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="as long as no stack lifts from the floor",
        reading=(
            "Stacks that stay flat on the floor slide alike, whatever their height. A higher "
            "stack lifts earlier "
            "(g a/c against mu_s g), and then slides less, or rocks instead of sliding."
        ),
        setups=tuple(setups),
        tables=(
            Table(
                caption="Path over the floor in 10 s, 10 rad/s, rigid",
                columns=("case", "boxes", "outcome", "path [mm]", "rotation ratio [-]"),
                rows=tuple(rows_of_table),
            ),
        ),
    )


def slipping_stabilises(laboratory: Laboratory) -> Finding:
    """The same map with friction that holds and with friction that gives way."""
    holding = stack_map(laboratory, {"contact.mu_static": 1.0, "contact.mu_kinetic": 1.0}, perturbed=True)
    comparisons, table, worse = [], [], []
    for static, kinetic in FRICTIONS:
        values = {"contact.mu_static": static, "contact.mu_kinetic": kinetic}
        slipping = stack_map(laboratory, values, perturbed=static in (0.25, 0.4))
        pairs = [
            (held, slid)
            for held, slid in zip(holding, slipping, strict=True)
            if held.computed and slid.computed and slid.row["max_slip_m"] > 1e-3
        ]
        saved = sum(held.fell and not slid.fell for held, slid in pairs)
        lost = [(held, slid) for held, slid in pairs if slid.fell and not held.fell]
        sure_lost = [pair for pair in lost if pair[0].sure and pair[1].sure]
        more = [pair for pair in pairs if _turns_more(*pair)]
        inside = static < WIDTH_OVER_HEIGHT
        name = f"mu {static:g}/{kinetic:g}"
        comparisons += [
            _count(f"{name}: sure cells that fall only because they slip", len(sure_lost), inside=inside),
            _count(
                f"{name}: share of slipping cells that turn more than without slipping",
                len(more) / len(pairs) if pairs else math.nan,
                inside=inside,
            ),
        ]
        table.append((name, len(pairs), saved, len(lost), len(sure_lost), len(more)))
        worse += [slid for _, slid in (sure_lost or more)[:2]]
    return Finding(
        comparisons=tuple(comparisons),
        bounds=f"mu_s below a/c = {WIDTH_OVER_HEIGHT:.3f}: the stack slides before it could tilt",
        reading=(
            "Friction below a/c keeps the stack from tilting at all. Above it slipping mostly "
            "reduces the rotation "
            "and saves more cells than it costs, but not always: it changes when the container is set down, "
            "and some motions turn it further, or over, only because it slips."
        ),
        setups=tuple(cell.setup for cell in worse),
        tables=(
            Table(
                caption=(
                    f"Cells of {len(holding)} that slip more than 1 mm, against friction that holds (1.0)"
                ),
                columns=(
                    "friction",
                    "slip",
                    "saved by slipping",
                    "lost by slipping",
                    ".. of them sure",
                    "turn more by slipping",
                ),
                rows=tuple(table),
            ),
        ),
        band=laboratory.band(
            PLATEAU.but({"solver.duration_s": 10.0}),
            quantity="rotation ratio at the plateau value",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="it slides and turns less than the rigid block that does not slide (0.399)",
            holds=lambda row: row["outcome"] == "slide-rock" and row["rotation_ratio"] < 0.399,
        ),
    )


def same_amplitude(laboratory: Laboratory) -> Finding:
    """Section 5.2: the smaller rotation at equal amplitude, at the paper's frequency."""
    amplitudes = tuple(round(0.05 + 0.01 * n, 3) for n in range(16))
    curves: dict[str, list[float]] = {}
    setups: list[Setup] = []
    for static, kinetic in ((1.0, 1.0), (0.4, 0.2), (0.3, 0.15), (0.25, 0.125)):
        group = [
            STACK.but(
                {
                    **FOR_MAPS,
                    "contact.mu_static": static,
                    "contact.mu_kinetic": kinetic,
                    "motion.amplitude_m": amplitude,
                    "solver.duration_s": 15.0,
                },
                f"mu {static:g}/{kinetic:g}, {1e3 * amplitude:.0f} mm at 6.928 rad/s",
            )
            for amplitude in amplitudes
        ]
        rows = laboratory.rows(group)
        curves[f"mu {static:g}/{kinetic:g}"] = [_capped(row) for row in rows]
        setups.append(group[-1])
    held = np.array(curves["mu 1/1"])
    comparisons = []
    for name, values in list(curves.items())[1:]:
        over = float(np.nanmax(np.array(values) - held))
        comparisons.append(
            Comparison(
                what=f"{name}: largest excess of its rotation ratio over that without slipping",
                measured=over,
                relation="<=",
                limit=0.05,
                unit="-",
                inside=float(name.split()[1].split("/")[0]) < WIDTH_OVER_HEIGHT,
            )
        )
    return Finding(
        comparisons=tuple(comparisons),
        bounds=f"mu_s below a/c = {WIDTH_OVER_HEIGHT:.3f}",
        reading=(
            "At equal amplitude the stack that slides on its base does not turn at all; one that "
            "rocks first never "
            "loses its grip as a rigid block, and friction of 0.4 then changes nothing."
        ),
        setups=tuple(setups),
        drawings=(
            drawing(
                "same-amplitude",
                "Largest rotation over the slenderness angle (1: overturned) over the floor's "
                "amplitude at 6.928 rad/s; "
                "rigid stack.",
                [
                    Line(x=1e3 * np.array(amplitudes), y=values, label=name, style="o-")
                    for name, values in curves.items()
                ],
                x_label="amplitude A [mm]",
                y_label="rotation ratio [-]",
            ),
        ),
    )


def reversal(laboratory: Laboratory) -> Finding:
    """Section 3: more static friction at the reversals, the same kinetic friction."""
    comparisons, table, setups = [], [], []
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
            "With mu_s = 0.4 in place of 0.2 at every reversal, and mu_k = 0.2 in both, nothing "
            "falls that stood. How "
            "far a box slides changes where it comes to stops; and the stack begins to rock "
            "where it only slid, "
            "for what starts a motion from rest is mu_s."
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
    )


def halt_at_extremes(laboratory: Laboratory) -> Finding:
    """Section 3: where in the floor's motion the relative motion comes to a halt."""
    frequency, gravity = 10.0, 9.81
    peaks = np.geomspace(4.0, 40.0, 9)
    lags = []
    for peak in peaks:
        slider = RigidSlider(mu_static=0.4, mu_kinetic=0.2, gravity=gravity)
        floor = sine_floor(amplitude=peak / frequency**2, angular_frequency=frequency)
        motion = simulate_sliding(slider, floor, duration=12.0 * math.pi / frequency)
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
            "The slip of the exact slider vanishes close to the extreme points of the floor only "
            "under strong motion. "
            f"Just above stiction it vanishes {max(lags):.0f}° of phase beside them: the body "
            "still has the speed "
            "that friction gave it."
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
                    "Phase between the end of a slip and the extreme point of the floor; exact "
                    "slider, mu 0.4/0.2."
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
    comparisons, table, setups = [], [], []
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
            f"{1e3 * slips[1]:.0f} mm at "
            f"92 % and {1e3 * slips[2]:.0f} mm at 100 %. For overturning of the rigid stack see "
            "the counts. The "
            "deformable shell is another matter: it breaks loose at an impact with 0.4/0.2 and "
            "does not with 0.4/0.4 "
            "(band of the next statement on slipping)."
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


def _spread(what: str, rows: list[Row], *, inside: bool) -> Comparison:
    paths = [row["slip_travel_m"] for row in rows]
    mean = sum(paths) / len(paths)
    return Comparison(
        what=f"spread of the path, {what}",
        measured=(max(paths) - min(paths)) / mean,
        relation="<=",
        limit=0.02,
        unit="-",
        inside=inside,
    )


def _count(what: str, number: float, *, inside: bool = True) -> Comparison:
    return Comparison(what=what, measured=number, relation="<=", limit=0.0, unit="-", inside=inside)


def _turns_more(held: Cell, slid: Cell) -> bool:
    if slid.fell or held.fell:
        return slid.fell and not held.fell
    ratio = slid.row["rotation_ratio"]
    return bool(ratio > 0.01 and ratio > LARGER * held.row["rotation_ratio"])


def _capped(row: Row) -> float:
    if row["status"] == "failed":
        return math.nan
    return 1.0 if row["outcome"] == "overturned" else min(float(row["rotation_ratio"]), 1.0)


STATEMENTS = (
    Statement(
        name="number-of-boxes",
        section="8",
        quote=(
            "Slipping is not affected by the number of boxes in the stack, only by the base "
            "acceleration and the coefficient of friction"
        ),
        tried="One to six boxes under the same floor, two pairs of friction, three peaks.",
        examine=number_of_boxes,
        seconds=3.0,
    ),
    Statement(
        name="slipping-stabilises",
        section="8",
        quote="According to the above findings slipping leads to increased overall stability",
        tried=(
            "Maps of the rigid stack over frequency and peak acceleration with five frictions, "
            "against friction that holds."
        ),
        examine=slipping_stabilises,
        seconds=60.0,
    ),
    Statement(
        name="same-amplitude",
        section="5.2",
        quote=(
            "the body is less accelerated, leading to a smaller rotation phi if tilting. With the "
            "same displacement amplitude A, the motion of the body becomes less critical"
        ),
        tried="Amplitudes from 50 to 200 mm at the paper's frequency with four frictions, rigid stack.",
        examine=same_amplitude,
        seconds=3.0,
    ),
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
            "Box and stack with the same kinetic friction and with or without more static friction "
            "at the reversals."
        ),
        examine=reversal,
        seconds=2.0,
    ),
    Statement(
        name="friction-ratio",
        section="4.3, Eq. 6",
        quote=(
            "the relation of mu_k being app. 50 % of mu_s is arbitrary; 92 % ... nearly 100 % of the stiction"
        ),
        tried="Maps of the rigid stack with mu_k at 50, 92 and 100 % of 0.4, and the slip of a box.",
        examine=friction_ratio,
        seconds=20.0,
    ),
)
