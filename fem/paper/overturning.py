"""What the paper says of overturning: A and a/2, reversal, and the limit cycle of its example."""

import math

import numpy as np

from contact.reference.closed_forms_overturning import sustained_sine_threshold_slender
from contact.reference.floor_acceleration import sine_floor
from contact.reference.rocking import first_swing_threshold
from fem.assessment.rigid_check import block_of
from fem.paper.cases import (
    ANGULAR_FREQUENCY,
    FOR_MAPS,
    FREQUENCY_PARAMETER,
    HALF_WIDTH,
    NO_SLIDING,
    PLATEAU,
    STACK,
    UPLIFT,
    harmonic,
)
from fem.paper.claims import Comparison, Drawing, Finding, Statement, Table
from fem.paper.experiments import RIGID, Laboratory
from fem.paper.figures import Line, drawing, outcome_map
from fem.paper.maps import FREQUENCIES, PEAKS, Cell, doubts, outcomes, stack_map


def half_width_is_conservative(laboratory: Laboratory) -> Finding:
    """A <= a/2 as a bound on the safe side."""
    block = block_of(laboratory.model(STACK.but(RIGID)))
    threshold = first_swing_threshold(
        block,
        lambda peak: sine_floor(amplitude=peak / ANGULAR_FREQUENCY**2, angular_frequency=ANGULAR_FREQUENCY),
        low=3.0,
        high=60.0,
        duration=8.0,
        relative_tolerance=1e-4,
    )
    share = threshold / ANGULAR_FREQUENCY**2 / HALF_WIDTH
    scan = [
        STACK.but(
            {
                **FOR_MAPS,
                **NO_SLIDING,
                "motion.amplitude_m": round(part * HALF_WIDTH, 5),
                "solver.duration_s": 15.0,
            },
            f"stack that cannot slide, A = {part:.2f} a/2 at 6.928 rad/s",
        )
        for part in [round(0.1 + 0.02 * n, 3) for n in range(46)]
    ]
    found = laboratory.attempts(scan)
    fallen = [
        setup.values["motion.amplitude_m"] / HALF_WIDTH
        for setup, row in zip(scan, found, strict=True)
        if row["outcome"] == "overturned"
    ]
    comparisons, witnesses, tables = [], [], []
    for name, values in (("mu 0.4/0.2", {}), ("mu 1.0", NO_SLIDING)):
        cells = stack_map(laboratory, values, perturbed=True)
        below = [cell for cell in cells if cell.computed and cell.amplitude <= HALF_WIDTH]
        against = [cell for cell in below if cell.fell]
        sure = [cell for cell in against if cell.sure]
        comparisons.append(_none(f"{name}: sure cells of the map with A <= a/2 that overturn", len(sure)))
        tables.append((name, len(below), len(against), len(sure), _smallest(against)))
        witnesses += [cell.setup for cell in sorted(sure, key=lambda cell: cell.amplitude)[:1]]
    first = scan[[row["outcome"] for row in found].index("overturned")] if fallen else scan[-1]
    comparisons += [
        Comparison(
            what="smallest A/(a/2) that overturns at 6.928 rad/s, in a scan by 0.02",
            measured=min(fallen, default=math.inf),
            relation=">=",
            limit=1.0,
            unit="-",
        ),
        Comparison(
            what="A/(a/2) that overturns in the first swing at 6.928 rad/s, exact block",
            measured=share,
            relation=">=",
            limit=1.0,
            unit="-",
        ),
    ]
    witness = first.but(
        {"motion.amplitude_m": round(0.45 * HALF_WIDTH, 5)},
        "stack that cannot slide, A = 0.45 a/2 at 6.928 rad/s",
    )
    return Finding(
        comparisons=tuple(comparisons),
        reading=(
            f"At the paper's frequency an amplitude of {share:.2f} a/2 overturns the stack in the first "
            "swing, without any impact (exact block); of the runs, impacts included, the smallest that overturns has "
            f"{min(fallen, default=math.nan):.2f} a/2. What counts is not the amplitude alone but the acceleration "
            "over g a/c and the frequency over p: in the first swing A Omega²/(g a/c) against sqrt(1 + (Omega/p)²)."
        ),
        setups=(first, witness, *witnesses),
        tables=(
            Table(
                caption="Cells of the stack's map with A <= a/2",
                columns=(
                    "friction",
                    "cells",
                    "overturn",
                    ".. and are sure",
                    "smallest A/(a/2) that overturns",
                ),
                rows=tuple(tables),
            ),
        ),
        drawings=(
            _map_of(laboratory, stack_map(laboratory, NO_SLIDING, perturbed=True), block.frequency_parameter),
        ),
        band=laboratory.band(
            witness.but({"solver.model": "reduced", "solver.duration_s": 10.0}),
            quantity=f"rotation ratio at A = {witness.values['motion.amplitude_m'] / HALF_WIDTH:.2f} a/2",
            unit="-",
            value=lambda row: min(float(row["rotation_ratio"]), 1.0),
            criterion="it stands, as A <= a/2 says",
            holds=lambda row: row["outcome"] != "overturned",
        ),
    )


def rotation_at_half_width(laboratory: Laboratory) -> Finding:
    """phi < beta in the first quarter period for A = a/2."""
    setups, comparisons, rows = [], [], []
    block = block_of(laboratory.model(STACK.but(RIGID)))
    for frequency in (2.5, 3.5, 5.0, ANGULAR_FREQUENCY, 9.0, 12.0):
        setup = STACK.but(
            {
                **FOR_MAPS,
                **NO_SLIDING,
                "motion.amplitude_m": HALF_WIDTH,
                "motion.angular_frequency_rad_s": frequency,
                "solver.duration_s": 10.0,
                "output.history_s": 0.005,
            },
            f"stack that cannot slide, A = a/2 at {frequency:g} rad/s",
        )
        record = laboratory.record(setup)
        time, rotation = record.history["time_s"], np.abs(record.history["rotation_rad"])
        quarter = time <= 0.5 * math.pi / frequency
        ratio = float(rotation[quarter].max()) / block.slenderness_angle
        fell = record.status == "overturned"
        rows.append((frequency, HALF_WIDTH * frequency**2, ratio, "overturned" if fell else "stands"))
        setups.append(setup)
        comparisons += [
            Comparison(
                what=f"rotation in the first quarter period over beta, {frequency:g} rad/s",
                measured=ratio,
                relation="<=",
                limit=1.0,
                unit="-",
            ),
            Comparison(
                what=f"overturns in the end, {frequency:g} rad/s",
                measured=float(fell),
                relation="<=",
                limit=0.0,
                unit="-",
                inside=False,
            ),
        ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds="in the first quarter period; it says nothing of what follows",
        reading=(
            f"Within a quarter of the first period the rotation reaches {max(row[2] for row in rows):.2f} of beta at "
            "the most. The stack goes on turning with the speed it has by then; in the end it overturns at "
            f"{sum(row[3] == 'overturned' for row in rows)} of {len(rows)} frequencies."
        ),
        setups=tuple(setups),
        tables=(
            Table(
                caption="A = a/2 = 550 mm",
                columns=(
                    "frequency [rad/s]",
                    "peak [m/s²]",
                    "rotation/beta in the first quarter [-]",
                    "in the end",
                ),
                rows=tuple(rows),
            ),
        ),
    )


def beyond_half_width(laboratory: Laboratory) -> Finding:
    """A > a/2 and a tilting moment beyond the restoring one: overturning."""
    cells = [cell for cell in stack_map(laboratory, NO_SLIDING, perturbed=True) if cell.computed]
    beyond = [cell for cell in cells if cell.amplitude > HALF_WIDTH and cell.peak > UPLIFT]
    standing = [cell for cell in beyond if cell.stood]
    sure = [cell for cell in standing if cell.sure]
    limit = [
        cell
        for cell in sure
        if cell.peak / UPLIFT < sustained_sine_threshold_slender(cell.angular_frequency / FREQUENCY_PARAMETER)
    ]
    return Finding(
        comparisons=(
            Comparison(
                what="cells with A > a/2 and M_T > M_R that overturn, of all such cells",
                measured=1.0 - len(standing) / len(beyond) if beyond else math.nan,
                relation=">=",
                limit=0.9,
                unit="-",
                inside=False,
            ),
            _none("sure cells with A > a/2 and M_T > M_R that stand", len(sure)),
        ),
        reading=(
            f"Of {len(beyond)} motions with A > a/2 whose tilting moment exceeds the restoring one, "
            f"{len(beyond) - len(standing)} overturn the stack that cannot slide and {len(standing)} do "
            f"not, {len(sure)} of them surely ({len(limit)} below the exact limit of the first swing). Whether the "
            "reverse, A <= a/2, protects is another statement."
        ),
        setups=tuple(cell.setup for cell in [*sure[:2], *beyond[:1]]),
        band=laboratory.band(
            STACK.but(
                {
                    **NO_SLIDING,
                    "motion.amplitude_m": 0.66,
                    "motion.angular_frequency_rad_s": 2.5,
                    "solver.duration_s": 8.0,
                }
            ),
            quantity="rotation ratio at A = 1.2 a/2, 2.5 rad/s (1: overturned)",
            unit="-",
            value=lambda row: min(float(row["rotation_ratio"]), 1.0),
            criterion="it overturns",
            holds=lambda row: row["outcome"] == "overturned",
        ),
    )


def beginning_is_restored(laboratory: Laboratory) -> Finding:
    """Neither the beginning of tilting nor the loss of stiction necessarily overturns."""
    comparisons, setups, rows = [], [], []
    for name, values in (("mu 0.4/0.2", {}), ("mu 1.0", NO_SLIDING)):
        cells = [cell for cell in stack_map(laboratory, values, perturbed=True) if cell.computed]
        tilted = [cell for cell in cells if cell.tilted]
        slid = [cell for cell in cells if cell.row["max_slip_m"] > 1.1e-4]
        back = [cell for cell in tilted if not cell.fell and cell.sure]
        held = [cell for cell in slid if not cell.fell and cell.sure]
        rows.append((name, len(cells), len(tilted), len(back), len(slid), len(held)))
        comparisons.append(_some(f"{name}: cells that tilt and surely stand", len(back)))
        if not values:
            comparisons.append(_some(f"{name}: cells that lose stiction and surely stand", len(held)))
    pulse = PLATEAU.but(
        {**RIGID, "motion.cycles": 10.0, "solver.duration_s": 25.0},
        "stack, ten cycles of 4.0 m/s² at 6.928 rad/s, then a floor at rest",
    )
    row = laboratory.rows([pulse])[0]
    setups.append(pulse)
    comparisons.append(
        _some(
            "ten cycles of the plateau value: it tilts and is back on its base", float(bool(row["restored"]))
        )
    )
    return Finding(
        comparisons=tuple(comparisons),
        reading=(
            f"Of the motions of the map that tilt the stack, {sum(one[3] for one in rows)} of "
            f"{sum(one[2] for one in rows)} surely do not overturn it; of those that make it slide, "
            f"{sum(one[5] for one in rows)} of {sum(one[4] for one in rows)}. After ten cycles of the plateau value "
            f"and a floor at rest it is {'back on its base' if row['restored'] else 'not back on its base'}. The "
            "counts are of cells, not of earthquakes."
        ),
        setups=tuple(setups),
        tables=(
            Table(
                caption="Cells of the stack's map",
                columns=(
                    "friction",
                    "cells",
                    "tilt",
                    ".. and surely stand",
                    "lose stiction",
                    ".. and surely stand",
                ),
                rows=tuple(rows),
            ),
        ),
        band=laboratory.band(
            pulse.but({"solver.model": "reduced", "solver.duration_s": 20.0}),
            quantity="rotation ratio",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="it tilts and does not overturn",
            holds=lambda row: row["first_uplift_s"] is not None and row["outcome"] != "overturned",
        ),
    )


def short_before_reversal(laboratory: Laboratory) -> Finding:
    """Tilting that starts short before the reversal of the ground motion: how short is short."""
    ratios = (1.01, 1.02, 1.04, 1.07, 1.1, 1.15, 1.2, 1.3, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0)
    cells = stack_map(
        laboratory, NO_SLIDING, peaks=[float(f"{ratio * UPLIFT:.5g}") for ratio in ratios], perturbed=True
    )
    leads = {cell.setup.key: _lead(cell) for cell in cells}
    fallen = [cell for cell in cells if cell.computed and cell.fell]
    slow = 3.0 * FREQUENCY_PARAMETER
    late = [cell for cell in cells if cell.computed and leads[cell.setup.key] <= 1.0 / 12.0]
    short = [cell for cell in late if cell.angular_frequency >= slow]
    bad = [cell for cell in short if cell.fell and cell.sure]
    smallest = min(fallen, key=lambda cell: leads[cell.setup.key], default=None)
    comparisons = [
        _none(
            (
                "sure cells that tilt less than a twelfth of a period before reversal and overturn, Omega "
                "above 3 p"
            ),
            len(bad),
        ),
        _none("the same at all frequencies", sum(cell.fell and cell.sure for cell in late), inside=False),
        _none(
            "sure cells that tilt at any time before reversal and overturn",
            sum(cell.sure for cell in fallen),
            inside=False,
        ),
    ]
    least = leads[smallest.setup.key] if smallest else math.nan
    points = [
        Line(
            x=[cell.angular_frequency for cell in cells if cell.computed and cell.fell is fell],
            y=[leads[cell.setup.key] for cell in cells if cell.computed and cell.fell is fell],
            label=label,
            style=style,
        )
        for fell, label, style in ((False, "stands", "."), (True, "overturns", "x"))
    ]
    return Finding(
        comparisons=tuple(comparisons),
        bounds=(
            "a floor faster than three times p, tilting that begins less than a twelfth of a period "
            "before it reverses (peak up to 1.15 g a/c)"
        ),
        reading=(
            f"The least time before reversal with which the stack is still overturned is {least:.3f} of a "
            "period"
            + (
                f" ({least * 2.0 * math.pi / smallest.angular_frequency:.2f} s, at "
                f"{smallest.angular_frequency:g} rad/s)."
                if smallest
                else "."
            )
            + " How short is short is a matter of 1/p, the time scale of falling, here "
            f"{1.0 / FREQUENCY_PARAMETER:.2f} s."
        ),
        setups=(smallest.setup,) if smallest else (),
        drawings=(
            drawing(
                "short-before-reversal",
                (
                    "When the stack begins to tilt, in periods before the floor reverses, and what "
                    "becomes of it."
                ),
                points,
                x_label="angular frequency [rad/s]",
                y_label="lead over the period [-]",
            ),
        ),
        band=laboratory.band(
            STACK.but({**NO_SLIDING, **harmonic(1.1 * UPLIFT, ANGULAR_FREQUENCY), "solver.duration_s": 8.0}),
            quantity="rotation ratio at 1.1 g a/c, 6.928 rad/s",
            unit="-",
            value=lambda row: row["rotation_ratio"],
            criterion="it stands",
            holds=lambda row: row["outcome"] != "overturned",
        ),
    )


def _lead(cell: Cell) -> float:
    """Time from the first uplift to the next reversal of the floor, over the period."""
    phase = cell.angular_frequency * float(cell.row["first_uplift_s"] or math.nan) / (2.0 * math.pi)
    return (0.25 - phase) % 0.5


def _map_of(laboratory: Laboratory, cells: list[Cell], frequency_parameter: float) -> Drawing:
    smooth = np.linspace(min(FREQUENCIES), max(FREQUENCIES), 100)
    first = [UPLIFT * sustained_sine_threshold_slender(w / frequency_parameter) for w in smooth]
    return outcome_map(
        "half-width-map",
        "Outcome of the rigid stack that cannot slide; dots: unsure cells.",
        x=FREQUENCIES,
        y=PEAKS,
        outcomes=outcomes(cells),
        unsure=doubts(cells),
        x_label="angular frequency [rad/s]",
        y_label="peak floor acceleration [m/s²]",
        curves=(
            Line(x=smooth, y=HALF_WIDTH * smooth**2, label="A = a/2"),
            Line(x=smooth, y=np.full_like(smooth, UPLIFT), label="static rule, g a/c"),
            Line(x=smooth, y=first, label="first swing (slender)"),
        ),
    )


def _smallest(cells: list[Cell]) -> float | None:
    return min((cell.amplitude / HALF_WIDTH for cell in cells), default=None)


def _none(what: str, count: float, *, inside: bool = True) -> Comparison:
    return Comparison(what=what, measured=float(count), relation="<=", limit=0.0, unit="-", inside=inside)


def _some(what: str, count: float, *, inside: bool = True) -> Comparison:
    return Comparison(what=what, measured=float(count), relation=">=", limit=1.0, unit="-", inside=inside)


STATEMENTS = (
    Statement(
        name="beginning-is-restored",
        section="abstract, 1",
        quote=(
            "neither the beginning of an overturning motion nor the loss of stiction necessarily causes "
            "the structure to fall over"
        ),
        tried=(
            "Map of the rigid stack over frequency and peak acceleration, with friction that slips and "
            "that holds; ten cycles of the plateau value."
        ),
        examine=beginning_is_restored,
        seconds=3.0,
    ),
    Statement(
        name="short-before-reversal",
        section="1",
        quote=(
            "if tilting starts short before reversal of the ground motion, some bumping will happen, but "
            "the stack will not fall over"
        ),
        tried=(
            "Peaks from 1.01 to 3 g a/c over frequency, stack that cannot slide: time from tilting to "
            "reversal, and the end."
        ),
        examine=short_before_reversal,
        seconds=5.0,
    ),
    Statement(
        name="half-width-is-conservative",
        section="5.3",
        quote="the condition A <= a/2 is only a conservative description of the falling over limit",
        tried=(
            "The same maps below A = a/2, a scan of the amplitude at the paper's frequency, and the exact "
            "first swing."
        ),
        examine=half_width_is_conservative,
        seconds=3.0,
    ),
    Statement(
        name="rotation-at-half-width",
        section="5.3",
        quote=(
            "the acceleration of the center of mass during the first quarter period, leading to phi < "
            "beta for A = a/2"
        ),
        tried=(
            "A = a/2 at six frequencies, stack that cannot slide: rotation in the first quarter period, "
            "and the end."
        ),
        examine=rotation_at_half_width,
    ),
    Statement(
        name="beyond-half-width",
        section="5.4",
        quote=(
            "Overturning: tilting moment does exceed restoring moment; steady state amplitude A > a/2 "
            "(weak condition)"
        ),
        tried="The map of the stack that cannot slide, above A = a/2 and g a/c.",
        examine=beyond_half_width,
    ),
)
