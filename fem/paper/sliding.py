"""What the paper says of slipping: it does not depend on the number of boxes, and it stabilises."""

import math
from collections.abc import Sequence

import numpy as np

from fem.paper.cases import FOR_MAPS, HEIGHT, NO_SLIDING, PLATEAU, STACK, WIDTH, harmonic
from fem.paper.claims import Band, Comparison, Finding, Setup, Statement, Table
from fem.paper.experiments import RIGID, Laboratory, Row
from fem.paper.figures import Line, drawing
from fem.paper.maps import Cell, stack_map

#: c/a of the stack is 3.636: below a/c = 0.275 it slides before it tilts
WIDTH_OVER_HEIGHT = WIDTH / HEIGHT
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
            f"The paths of stacks that stay flat differ by up to {_worst(comparisons, inside=True):.2%}, those of all "
            f"by up to {_worst(comparisons, inside=False):.0%}: a higher stack lifts earlier (g a/c against mu_s g), "
            "and what rocks slides otherwise."
        ),
        setups=tuple(setups),
        tables=(
            Table(
                caption="Path over the floor in 10 s, 10 rad/s, rigid",
                columns=("case", "boxes", "outcome", "path [mm]", "rotation ratio [-]"),
                rows=tuple(rows_of_table),
            ),
        ),
        band=_band_of_paths(laboratory),
    )


def _band_of_paths(laboratory: Laboratory) -> Band:
    """Path of the stack that stays flat, over that of one rigid box under the same floor."""
    values = {
        "contact.mu_static": 0.2,
        "contact.mu_kinetic": 0.1,
        "solver.duration_s": 5.0,
        **harmonic(5.0, 10.0),
    }
    path = laboratory.rows([STACK.but({**FOR_MAPS, **values, "container.boxes": 1})])[0]["slip_travel_m"]
    return laboratory.band(
        STACK.but(values),
        quantity="path of four boxes over that of one rigid box, mu 0.2/0.1, 5.0 m/s² at 10 rad/s",
        unit="-",
        value=lambda row: row["slip_travel_m"] / path,
        criterion="within 5 % of one rigid box",
        holds=lambda row: abs(row["slip_travel_m"] / path - 1.0) <= 0.05,
    )


def _worst(comparisons: Sequence[Comparison], *, inside: bool) -> float:
    return max((one.measured for one in comparisons if one.inside is inside), default=math.nan)


def slipping_stabilises(laboratory: Laboratory) -> Finding:
    """The same map with friction that holds and with friction that gives way."""
    holding = stack_map(laboratory, NO_SLIDING, perturbed=True)
    fixed = laboratory.rows([PLATEAU.but({**RIGID, **NO_SLIDING, "solver.duration_s": 10.0})])[0][
        "rotation_ratio"
    ]
    low_tilted = low_cells = 0
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
        if inside:
            low_tilted += sum(cell.tilted for cell in slipping if cell.computed)
            low_cells += sum(cell.computed for cell in slipping)
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
            f"{_reading_of_slipping(table)} With mu_s below a/c the stack lifts from the floor in {low_tilted} of "
            f"{low_cells} cells."
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
            criterion=f"it slides and turns less than the rigid block that cannot slide ({fixed:.3f})",
            holds=lambda row: row["outcome"] == "slide-rock" and row["rotation_ratio"] < fixed,
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
        rows = laboratory.attempts(group)
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
    further = ", ".join(
        f"{int(np.sum(np.array(values) > held * LARGER + 0.01))} ({name})"
        for name, values in list(curves.items())[1:]
    )
    at_100 = held[amplitudes.index(0.1)]
    return Finding(
        comparisons=tuple(comparisons),
        bounds=f"mu_s below a/c = {WIDTH_OVER_HEIGHT:.3f}",
        reading=(
            "Of the amplitudes tried the stack turns further than with friction that holds (1.0) at "
            f"{further}, of {len(amplitudes)} each. It overturns at {int((held >= 1.0).sum())} with friction that "
            f"holds and at {sum(one >= 1.0 for one in curves['mu 0.4/0.2'])} with 0.4/0.2. With mu 0.25/0.125, below "
            f"a/c, its largest rotation is {max(curves['mu 0.25/0.125']):.2g} of beta."
        ),
        setups=tuple(setups),
        drawings=(
            drawing(
                "same-amplitude",
                "Largest rotation over the slenderness angle (1: overturned) over the floor's amplitude "
                "at 6.928 rad/s; "
                "rigid stack.",
                [
                    Line(x=1e3 * np.array(amplitudes), y=values, label=name, style="o-")
                    for name, values in curves.items()
                ],
                x_label="amplitude A [mm]",
                y_label="rotation ratio [-]",
            ),
        ),
        band=laboratory.band(
            STACK.but({"motion.amplitude_m": 0.1, "solver.duration_s": 8.0}),
            quantity="rotation ratio at 100 mm, mu 0.4/0.2",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion=f"no more than the rigid stack that cannot slide ({at_100:.3f})",
            holds=lambda row: row["rotation_ratio"] <= at_100 * LARGER,
        ),
    )


def _reading_of_slipping(table: list[tuple[str, int, int, int, int, int]]) -> str:
    """What the counts say: cells saved, lost, lost for sure, and turned further by slipping."""
    _, cells, saved, lost, sure, more = (list(column) for column in zip(*table, strict=True))
    return (
        f"Of {sum(cells)} motions that make the stack slip, over all frictions, slipping saves "
        f"{sum(saved)} from overturning and overturns {sum(lost)} that would have stood ({sum(sure)} of "
        f"them surely); {sum(more)} turn further than without slipping, which changes when the container is set "
        "down."
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
            "Slipping is not affected by the number of boxes in the stack, only by the base acceleration "
            "and the coefficient of friction"
        ),
        tried="One to six boxes under the same floor, two pairs of friction, three peaks.",
        examine=number_of_boxes,
    ),
    Statement(
        name="slipping-stabilises",
        section="8",
        quote="According to the above findings slipping leads to increased overall stability",
        tried=(
            "Maps of the rigid stack over frequency and peak acceleration with five frictions, against "
            "friction that holds."
        ),
        examine=slipping_stabilises,
        seconds=23.0,
    ),
    Statement(
        name="same-amplitude",
        section="5.2",
        quote=(
            "the body is less accelerated, leading to a smaller rotation phi if tilting. With the same "
            "displacement amplitude A, the motion of the body becomes less critical"
        ),
        tried="Amplitudes from 50 to 200 mm at the paper's frequency with four frictions, rigid stack.",
        examine=same_amplitude,
        seconds=2.0,
    ),
)
