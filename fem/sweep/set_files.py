"""The files of a set of motions in the folder of a sweep: measures, spectra, outcomes of the set, figures."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fem.batch.answers import STRENGTHS
from fem.batch.axes import Axis
from fem.batch.labels import axis_label, place_in_words
from fem.batch.motion_set import FloorMotionPair, write_motions
from fem.batch.table import table_of_rows
from fem.figures.motions import ShareCurve, draw_shares
from fem.figures.style import svg_of
from fem.html.units import rounded
from fem.results.folder import ResultFolder
from fem.sweep.cells import CellRows
from fem.sweep.motion_outcomes import OF_A_MOTION, SET_COLUMNS, by_motion, motions_at, set_in_words, set_row
from fem.sweep.plan import Sweep

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
