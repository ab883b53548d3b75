"""The part of a page about a set of motions: measures and spectra, the outcome of each, and of all together."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fem.html import sections as html
from fem.html.units import ABSENT, millimetres, number, ratio, short
from fem.records.units import STANDARD_GRAVITY
from fem.report.studies import drawings
from fem.results.figures import DURATION, PGA, PGD, PGV
from fem.results.outcome import COUNTED, ROCKING, SLIDING
from fem.study.fragility import EnsembleResult
from fem.study.motion_outcomes import MEAN_TURNED, WORST_TURNED, MotionOutcome, motions_at
from fem.study.sweep_table import SweepResult, SweepTable, shown_at

PEAK = "peak_acceleration_m_s2"
#: what is shown of a motion
MEASURES = {PEAK: PGA, "peak_velocity_m_s": PGV, "peak_displacement_m": PGD, "significant_s": DURATION}
MOST_POINTS = 12  #: beside one another in the table of outcomes


#: what the columns of the motions mean
PEAKS = (
    "PGA, PGV and PGD are the peaks of acceleration, velocity and displacement of the floor; D5-95 is the time from 5 "
    "to 95 % of the integral of the squared acceleration."
)


def motions_of_ensemble(folder: Path, info: EnsembleResult) -> html.PageSection:
    """The motions that an ensemble draws, with their outcomes; empty where it has none, or is not finished."""
    motions = info.motions
    if not motions:
        return html.section("", "motions")
    outcomes = html.table_of(
        "outcome of each motion",
        html.in_order("motion", *COUNTED, look=html.NUMBER),
        ([motion["file"], *(str(motion.get(name, 0)) for name in COUNTED)] for motion in motions),
        caption="Draws under each motion, at all points",
        file="motions.csv",
    )
    note = (
        f"Every draw is under one of {len(motions)} motions, each equally often. The intervals are those of "
        f"a sample of {len(motions)} motions: draws under one motion say little of others."
    )
    return _section(folder, info, "ensemble", [outcomes], note)


def motions_of_sweep(folder: Path, table: SweepTable) -> html.PageSection:
    """The motions of a sweep, with what each did at each point of the other axes; empty as for an ensemble."""
    if not table.info.motions:
        return html.section("", "motions")
    by_cell = {cell: shown_at(table, cell) for cell in range(len(table["cell"]))}
    points = list(motions_at(table.axes, by_cell))
    rows = table.info.motion_set or ()
    tables = [_together(rows)]
    if len(points) <= MOST_POINTS:
        by_motion = zip(*(outcomes for _, outcomes in points), strict=True)
        lines = ([outcomes[0].motion, *map(_outcome, outcomes)] for outcomes in by_motion)
        columns = html.in_order("motion", *(row["where"] or "outcome" for row in rows))
        tables.append(
            html.table_of(
                "outcome of each motion",
                columns,
                lines,
                caption="Outcome, with the worse sign",
                file="table.csv",
            )
        )
    note = (
        "A motion counts once, with the worse of its signs. The interval is that of the share among all motions "
        "of this kind, had these been drawn from them at random."
    )
    return _section(folder, table.info, "sweep", tables, note)


def _section(
    folder: Path, info: EnsembleResult | SweepResult, command: str, tables: Sequence[html.Table], note: str
) -> html.PageSection:
    """Tables of outcomes, the motions in numbers, their spectra, and how they are counted."""
    return html.section(
        "The motions",
        "motions",
        *tables,
        _numbers(info.motions or ()),
        *drawings(folder, info.motion_figures, command, prefix="motion"),
        html.Note(f"{note} {PEAKS}"),
    )


def _numbers(motions: Sequence[Mapping[str, Any]]) -> html.Table:
    """A row a component: peaks, significant duration, length, step."""
    columns: list[html.Column[Mapping[str, Any]]] = [
        html.Column(
            "motion", lambda motion: motion["file"] + ("" if "vertical" in motion else " (vertical)")
        ),
        html.Column("PGA [g]", lambda motion: number(motion[PEAK], 1.0 / STANDARD_GRAVITY, 3), html.NUMBER),
        *html.figure_columns(MEASURES),
        html.Column("length [s]", lambda motion: short(motion["duration_s"]), html.NUMBER),
        html.Column("step [s]", lambda motion: short(motion["step_s"]), html.NUMBER),
    ]
    components = [part for motion in motions for part in (motion, motion["vertical"]) if part]
    return html.table_of(
        "motions", columns, components, caption="The motions, as the base case takes them", file="motions.csv"
    )


def _together(rows: Sequence[Mapping[str, Any]]) -> html.Table:
    """What all motions did at each point of the other axes."""

    def worst(row: Mapping[str, Any]) -> str:
        words = _words(row["worst_outcome"], row[WORST_TURNED])
        return f"{row['worst_motion']}: {words}" if row["worst_motion"] else ABSENT

    def slip(row: Mapping[str, Any]) -> str:
        largest = row["worst_slip_m"]
        return f"{millimetres(largest)} mm, {row['worst_slip_motion']}" if largest else ABSENT

    def mean_ratio(row: Mapping[str, Any]) -> str:
        of = f" (of {row['stood']})" if 0 < row["stood"] < row["motions"] else ""
        return ratio(row[MEAN_TURNED]) + of

    def interval(row: Mapping[str, Any]) -> str:
        return f"{short(row['low'], 100.0, 3)} to {short(row['high'], 100.0, 3)} %"

    columns: list[html.Column[Mapping[str, Any]]] = [
        html.Column("", lambda row: row["where"], optional=True),
        html.Column("motions", lambda row: str(row["motions"]), html.NUMBER),
        html.Column("overturned", lambda row: str(row["overturned"]), html.NUMBER),
        html.Column("95 % interval", interval, html.NUMBER),
        html.Column("not valid", lambda row: str(row.get("invalid") or ""), html.NUMBER, optional=True),
        html.Column("failed", lambda row: str(row["failed"] or ""), html.NUMBER, optional=True),
        html.Column("worst", worst),
        html.Column("largest slip", slip),
        html.Column("mean rotation ratio", mean_ratio, html.NUMBER),
        html.Column("mean slip [mm]", lambda row: millimetres(row["mean_slip_m"]), html.NUMBER),
    ]
    return html.table_of(
        "the set of motions",
        columns,
        rows,
        caption="All motions together; means are of those under which it stood",
        file="motion_set.csv",
    )


def _outcome(outcome: MotionOutcome) -> str:
    """An outcome with the figures that belong to it."""
    words = _words(outcome.outcome, outcome.turned)
    return f"{words}, {millimetres(outcome.slipped)} mm" if outcome.outcome in SLIDING else words


def _words(outcome: str | None, turned: float | None) -> str:
    """An outcome, and the rotation ratio of what rocked."""
    if outcome is None:
        return "failed"
    return f"{outcome}, {ratio(turned)}" if outcome in ROCKING else outcome
