"""The part of a page about a set of motions: measures and spectra, the outcome of each, and of all together."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from fem.html.units import ABSENT, millimetres, number, rotation_ratio, short
from fem.records.units import STANDARD_GRAVITY
from fem.report.studies import PageTable, drawings, page_table
from fem.results.outcome import COUNTED, ROCKING, SLIDING, Ending, ending_of
from fem.sweep.cells import Shown
from fem.sweep.motion_outcomes import MotionOutcome, motions_at
from fem.sweep.table import SweepTable

MOST_POINTS = 12  #: beside one another in the table of outcomes


@dataclass(frozen=True, kw_only=True)
class MotionPart:
    """What a page shows of a set of motions."""

    numbers: PageTable
    drawn: Sequence[Markup]  #: spectra, and the share that overturns over the strength
    note: str  #: how the motions are counted
    outcomes: PageTable | None = None  #: a row a motion, a column a point; None with too many points
    together: PageTable | None = None  #: a row a point: worst, mean, share that overturns


def motions_of_ensemble(folder: Path, info: Mapping[str, Any]) -> MotionPart | None:
    """The motions that an ensemble draws, with their outcomes; None where it has none, or is not finished."""
    motions = info.get("motions")
    if not motions:
        return None
    rows = ([one["file"], *(str(one[name]) for name in COUNTED)] for one in motions)
    return MotionPart(
        numbers=_numbers(motions),
        drawn=_drawn(folder, info, "ensemble"),
        outcomes=page_table(
            "outcome of each motion",
            {"motion": False} | dict.fromkeys(COUNTED, True),
            rows,
            caption="Draws under each motion, at all points",
            file="motions.csv",
        ),
        note=f"Every draw is under one of {len(motions)} motions, each equally often. The intervals are those of "
        f"a sample of {len(motions)} motions: draws under one motion say little of others.",
    )


def motions_of_sweep(folder: Path, table: SweepTable) -> MotionPart | None:
    """The motions of a sweep, with what each did at each point of the other axes; None as for an ensemble."""
    if not table.info.get("motions"):
        return None
    points = list(motions_at(table.axes, _shown(table)))
    rows = table.info["motion_set"]
    places = [row["where"] for row in rows]
    outcomes = None
    if len(points) <= MOST_POINTS:
        heads = {"motion": False} | dict.fromkeys((place or "outcome" for place in places), False)
        lines = ([some[0].motion, *map(_outcome, some)] for some in zip(*(p for _, p in points), strict=True))
        outcomes = page_table(
            "outcome of each motion", heads, lines, caption="Outcome, with the worse sign", file="table.csv"
        )
    return MotionPart(
        numbers=_numbers(table.info["motions"]),
        drawn=_drawn(folder, table.info, "sweep"),
        outcomes=outcomes,
        together=_together(places, rows),
        note="A motion counts once, with the worse of its signs. The interval is that of the share among all motions "
        "of this kind, had these been drawn from them at random.",
    )


def _drawn(folder: Path, info: Mapping[str, Any], command: str) -> Sequence[Markup]:
    return drawings(folder, info.get("motion_figures") or (), command, prefix="motion")


def _numbers(motions: Sequence[Mapping[str, Any]]) -> PageTable:
    """A row a component: peaks, significant duration, length, step."""
    heads = ("PGA [m/s²]", "PGA [g]", "PGV [m/s]", "PGD [mm]", "D5-95 [s]", "length [s]", "step [s]")
    columns = {"motion": False} | dict.fromkeys(heads, True)

    def row(one: Mapping[str, Any], word: str) -> Iterator[str]:
        peak = one["peak_acceleration_m_s2"]
        yield f"{one['file']}{word}"
        yield from (number(peak, figures=3), number(peak, 1.0 / STANDARD_GRAVITY, 3))
        yield number(one["peak_velocity_m_s"], figures=3)
        yield millimetres(one["peak_displacement_m"])
        yield number(one["significant_s"], figures=3)
        yield from (short(one["duration_s"]), short(one["step_s"]))

    rows = [
        list(row(part, word))
        for one in motions
        for part, word in ((one, ""), (one["vertical"], " (vertical)"))
        if part
    ]
    return page_table(
        "motions", columns, rows, caption="The motions, as the base case takes them", file="motions.csv"
    )


def _together(places: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> PageTable:
    heads = {
        "": False,
        "motions": True,
        "overturned": True,
        "95 % interval": True,
        "failed": True,
        "worst": False,
        "largest slip": False,
        "mean rotation ratio": True,
        "mean slip [mm]": True,
    }

    def row(place: str, one: Mapping[str, Any]) -> Iterator[str]:
        yield place
        yield from (str(one["motions"]), str(one["overturned"]))
        yield f"{short(one['low'], 100.0, 3)} to {short(one['high'], 100.0, 3)} %"
        yield str(one["failed"] or "")
        worst = _words(one["worst_outcome"], one["worst_rotation_ratio"])
        yield f"{one['worst_motion']}: {worst}" if one["worst_motion"] else ABSENT
        slip = one["worst_slip_m"]
        yield f"{millimetres(slip)} mm, {one['worst_slip_motion']}" if slip else ABSENT
        of = f" (of {one['stood']})" if one["stood"] < one["motions"] else ""
        yield rotation_ratio(one["mean_rotation_ratio"]) + (of if one["stood"] else "")
        yield millimetres(one["mean_slip_m"])

    return page_table(
        "the set of motions",
        heads,
        (list(row(*pair)) for pair in zip(places, rows, strict=True)),
        caption="All motions together; means are of those under which it stood",
        file="motion_set.csv",
        optional=frozenset({"", "failed"}),
    )


def _shown(table: SweepTable) -> dict[int, Shown]:
    """What each cell shows."""
    found = {}
    for cell in range(len(table["cell"])):
        outcome = str(table["outcome"][cell])
        ratio, slip = float(table["rotation_ratio"][cell]), float(table["max_slip_m"][cell])
        kind = ending_of(str(table["status"][cell]), outcome)
        found[cell] = Shown(
            kind=kind,
            outcome=None if kind is Ending.FAILED else outcome,
            rotation_ratio=ratio if np.isfinite(ratio) else None,
            max_slip_m=slip if np.isfinite(slip) else None,
        )
    return found


def _outcome(one: MotionOutcome) -> str:
    """An outcome with the figures that belong to it."""
    words = _words(one.outcome, one.rotation_ratio)
    return f"{words}, {millimetres(one.max_slip_m)} mm" if one.outcome in SLIDING else words


def _words(outcome: str | None, ratio: float | None) -> str:
    """An outcome, and the rotation ratio of what rocked."""
    if outcome is None:
        return "failed"
    return f"{outcome}, {rotation_ratio(ratio)}" if outcome in ROCKING else outcome
