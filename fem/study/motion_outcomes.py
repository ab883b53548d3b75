"""The outcomes of a set of motions: of each motion, and of the whole set at each point on the other axes.

A motion that is tried with both signs counts once, with the worse of the two: the signs of one motion are not
independent. The share of motions that overturn has the interval of as many independent ones. A mean is that of the
motions under which the container stood, and stands beside the number that overturned: no mean includes a fall.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.figures.motions import ShareCurve, draw_shares
from fem.figures.style import svg_of
from fem.html.units import rounded
from fem.results.figures import SLIPPED, TURNED
from fem.results.folder import ResultFolder
from fem.results.outcome import COUNTED, NOT_STANDING, Ending, counts_of
from fem.runtime.arrays import IntArray
from fem.runtime.intervals import estimate
from fem.runtime.units import RATIO, SHORT_MILLIMETRES
from fem.study.answers import STRENGTHS
from fem.study.axes import MOTION_FILE, Axis, axis_label, place_in_words, point_of, shape_of, sign_axes
from fem.study.design import Sweep
from fem.study.motions import FloorMotionPair, write_motions
from fem.study.sweep_table import CellRows, RunShown
from fem.study.table import Columns, table_of_rows

CONFIDENCE = 0.95
WORST_TURNED, MEAN_TURNED = f"worst_{TURNED}", f"mean_{TURNED}"
#: columns of `motion_set.csv` behind those of the other axes
SET_COLUMNS: Columns = dict.fromkeys(("motions", *COUNTED), int)
SET_COLUMNS |= dict.fromkeys(("overturned_share", "low", "high"), float)
SET_COLUMNS |= {"worst_motion": str, "worst_outcome": str, WORST_TURNED: float}
SET_COLUMNS |= {"worst_slip_motion": str, "worst_slip_m": float, MEAN_TURNED: float, "mean_slip_m": float}
#: columns of `motions.csv` behind the measures of a motion
OF_A_MOTION: Columns = dict.fromkeys(COUNTED, int) | dict.fromkeys((f"max_{TURNED}", SLIPPED), float)


@dataclass(frozen=True, kw_only=True)
class MotionOutcome(RunShown):
    """The outcome of one motion, with the worse of its signs."""

    motion: str


def severity(run: RunShown) -> tuple[int, float]:
    """Larger for a worse outcome."""
    order = (Ending.STANDING, Ending.FAILED, Ending.INVALID, Ending.OVERTURNED)
    return order.index(run.kind), run.turned


def motions_at(
    axes: Sequence[Axis], runs: Mapping[int, RunShown]
) -> Iterator[tuple[dict[str, Any], list[MotionOutcome]]]:
    """At each point on the axes that are neither motions nor signs: its values, and the outcome of each motion."""
    keys = [axis.key for axis in axes]
    inner = [MOTION_FILE, *(axis.key for axis in sign_axes(axes))]
    places = [keys.index(key) for key in inner]
    shape = shape_of(axes)
    cells: IntArray = np.moveaxis(np.arange(math.prod(shape)).reshape(shape), places, range(-len(places), 0))
    names = axes[places[0]].values
    signs = int(np.prod(cells.shape[cells.ndim - len(places) + 1 :]))
    for block in cells.reshape(-1, len(names), signs):
        point = point_of(axes, int(block[0, 0]))
        values = {key: value for key, value in point.items() if key not in inner}
        yield (
            values,
            [
                _worst(str(name), [runs[int(cell)] for cell in row])
                for name, row in zip(names, block, strict=True)
            ],
        )


def set_row(outcomes: Sequence[MotionOutcome]) -> dict[str, Any]:
    """The outcome of a set of motions at a point, by `SET_COLUMNS`."""
    kinds = np.array([outcome.kind for outcome in outcomes])
    fallen = np.isin(kinds, NOT_STANDING)
    share = estimate(fallen, kinds == Ending.FAILED, replicates=1, confidence=CONFIDENCE)
    computed = [outcome for outcome in outcomes if outcome.kind != Ending.FAILED]
    standing = [cell for cell in computed if cell.kind == Ending.STANDING]
    worst = max(computed, key=severity, default=None)
    slipped = max(computed, key=lambda outcome: outcome.slipped, default=None)
    return {
        "motions": len(outcomes),
        **counts_of(kinds),
        "overturned_share": share.value,
        "low": share.low,
        "high": share.high,
        "worst_motion": worst and worst.motion,
        "worst_outcome": worst and worst.outcome,
        WORST_TURNED: worst and worst[TURNED],
        "worst_slip_motion": slipped and slipped.motion,
        "worst_slip_m": slipped and slipped[SLIPPED],
        MEAN_TURNED: _mean([cell[TURNED] for cell in standing]),
        "mean_slip_m": _mean([cell[SLIPPED] for cell in standing]),
    }


def set_in_words(row: Mapping[str, Any]) -> str:
    """One sentence about a set of motions."""
    count, overturned, failed = row["motions"], row["overturned"], row["failed"]
    interval = (
        f"{100.0 * row['low']:.0f} to {100.0 * row['high']:.0f} % of such motions at {100.0 * CONFIDENCE:g} %"
    )
    begin = (
        f"{overturned or 'none'} of {count} motions overturn{'s' * (overturned < 2)} ({interval} confidence)"
    )
    others = {"not valid": row.get("invalid", 0), "failed": failed}
    parts = [", ".join([begin, *(f"{number} {word}" for word, number in others.items() if number)])]
    if overturned:
        parts.append(f"worst {row['worst_motion']}")
    elif row[WORST_TURNED] is not None:
        ratio = RATIO.text(row[WORST_TURNED])
        parts.append(f"worst {row['worst_motion']}, {row['worst_outcome']}, rotation ratio {ratio}")
    if (row["worst_slip_m"] or 0.0) >= SHORT_MILLIMETRES.least:
        parts.append(
            f"largest slip {SHORT_MILLIMETRES.text(row['worst_slip_m'])}, {row['worst_slip_motion']}"
        )
    if row[MEAN_TURNED] is not None:
        of = f"mean of {row['stood']}" + (f" that stood, {overturned} overturned" if overturned else "")
        ratio = RATIO.text(row[MEAN_TURNED])
        parts.append(f"{of}: rotation ratio {ratio}, slip {SHORT_MILLIMETRES.text(row['mean_slip_m'])}")
    return "; ".join(parts)


def by_motion(points: Sequence[Sequence[MotionOutcome]]) -> dict[str, dict[str, Any]]:
    """Counts and largest figures of each motion over all points, by its name; the figures where it stood."""
    rows: dict[str, dict[str, Any]] = {}
    for outcomes in zip(*points, strict=True):
        standing = [outcome for outcome in outcomes if outcome.kind == Ending.STANDING]
        rows[outcomes[0].motion] = counts_of([outcome.kind for outcome in outcomes]) | {
            f"max_{TURNED}": max((cell.turned for cell in standing), default=None),
            SLIPPED: max((cell.slipped for cell in standing), default=None),
        }
    return rows


def _worst(motion: str, signs: Sequence[RunShown]) -> MotionOutcome:
    """The outcome of a motion, with the worse of its signs; a failed run hides no fall and never counts as standing."""
    slip = max((sign[SLIPPED] for sign in signs if sign[SLIPPED] is not None), default=None)
    return MotionOutcome(**vars(max(signs, key=severity)) | {"motion": motion, SLIPPED: slip})


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


MOST_CURVES = 8  #: of a figure
SHARES = "figures/overturned.svg"


def write_set(
    place: ResultFolder, sweep: Sweep, motions: Sequence[FloorMotionPair], cells: CellRows
) -> dict[str, Any]:
    """Write the files of the set; returns its part of `sweep.json`."""
    points = list(motions_at(sweep.axes, cells.runs))
    outcomes = by_motion([at_point for _, at_point in points])
    measures = [motion.numbers() | outcomes[motion.name] for motion in motions]
    rows = [values | set_row(at_point) for values, at_point in points]
    others = [axis for axis in sweep.axes if axis.key in rows[0]]
    columns = dict.fromkeys((axis.key for axis in others), str) | SET_COLUMNS
    place.write_text("motion_set.csv", table_of_rows(columns, rows))
    figures = write_motions(place, motions, measures, OF_A_MOTION)
    if curves := _shares(sweep.axes, rows):
        axis, shares = curves
        title = sweep.title or sweep.name
        place.write_text(SHARES, svg_of(draw_shares(shares, title=title, label=axis_label(axis))))
        figures.append(SHARES)
    return {
        "motions": tuple(measures),
        "motion_set": tuple(
            row | {"where": place_in_words(others, row), "in_words": set_in_words(row)} for row in rows
        ),
        "motion_figures": tuple(figures),
    }


def _shares(axes: Sequence[Axis], rows: Sequence[Mapping[str, Any]]) -> tuple[Axis, list[ShareCurve]] | None:
    """A curve over the strength for each point of the other axes; None without a strength, or with too many."""
    axis = next((axis for axis in axes if axis.is_numeric and axis.key in rows[0].keys() & STRENGTHS), None)
    if axis is None:
        return None
    others = [key for key in rows[0] if key not in SET_COLUMNS and key != axis.key]
    labels = {axis.key: axis_label(axis) for axis in axes}
    lines: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        label = ", ".join(f"{labels[key]} = {_shown(row[key])}" for key in others)
        lines.setdefault(label, []).append(row)
    if len(lines) > MOST_CURVES:
        return None

    def column(points: Sequence[Mapping[str, Any]], name: str) -> Any:
        return np.array([row[name] for row in points], dtype=float)

    return axis, [
        ShareCurve(
            label=label.replace(" [-]", ""),
            strengths=column(points, axis.key),
            share=column(points, "overturned_share"),
            low=column(points, "low"),
            high=column(points, "high"),
        )
        for label, points in lines.items()
    ]


def _shown(value: Any) -> str:
    return rounded(value) if isinstance(value, float) else str(value)
