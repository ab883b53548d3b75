"""The files of a set of motions in the folder of a sweep: numbers, spectra, what the set did, figures."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fem.batch.axes import Axis
from fem.batch.labels import axis_label
from fem.batch.log import table_text
from fem.batch.motion_set import FloorMotionPair, spectra_of, spectra_table
from fem.figures.motions import ShareCurve, draw_shares, draw_spectra
from fem.figures.style import number, svg_of
from fem.results.folder import ResultFolder
from fem.sweep.cells import CellRows
from fem.sweep.motion_outcomes import SET_COLUMNS, by_motion, motions_at, set_in_words, set_row
from fem.sweep.plan import Sweep

#: keys to whose values all motions of a set are scaled
STRENGTHS = ("motion.scale_to_m_s2", "motion.peak_acceleration_m_s2")
MOST_CURVES = 8  #: of a figure
SPECTRA, SHARES = "figures/spectra.svg", "figures/overturned.svg"


def write_set(
    place: ResultFolder, sweep: Sweep, motions: Sequence[FloorMotionPair], cells: CellRows
) -> dict[str, Any]:
    """Write the files of the set; returns what `sweep.json` tells of it."""
    points = list(motions_at(sweep, cells.shown))
    outcomes = by_motion([found for _, found in points])
    told = [one.numbers() | outcomes[one.name] for one in motions]
    rows = [values | set_row(found) for values, found in points]
    names = [key for key in rows[0] if key not in SET_COLUMNS]
    place.write_text("motion_set.csv", table_text([*names, *SET_COLUMNS], (row.values() for row in rows)))
    place.write_text("motions.csv", _motions_table(told))
    periods, spectra = spectra_of(motions)
    place.write_text("spectra.csv", spectra_table(periods, spectra))
    vertical = [one.vertical.name for one in motions if one.vertical is not None]
    figures = {SPECTRA: svg_of(draw_spectra(periods, spectra, vertical=vertical))}
    if curves := _shares(sweep.axes, rows):
        axis, shares = curves
        figures[SHARES] = svg_of(draw_shares(shares, title=sweep.title or sweep.name, label=axis_label(axis)))
    for name, svg in figures.items():
        place.write_text(name, svg)
    return {
        "motions": told,
        "motion_set": [row | {"in_words": set_in_words(row)} for row in rows],
        "motion_figures": list(figures),
    }


def _motions_table(told: Sequence[Mapping[str, Any]]) -> str:
    """`motions.csv`: a row a motion, the numbers of its vertical component with `vertical_` before them."""
    columns = [name for name in told[0] if name != "vertical"]
    verticals: Mapping[str, Any] = next((one["vertical"] for one in told if one["vertical"]), {})
    return table_text(
        [*columns, *(f"vertical_{name}" for name in verticals)],
        (
            [*(one[name] for name in columns), *((one["vertical"] or {}).get(name) for name in verticals)]
            for one in told
        ),
    )


def _shares(axes: Sequence[Axis], rows: Sequence[Mapping[str, Any]]) -> tuple[Axis, list[ShareCurve]] | None:
    """A curve over the strength for each point of the other axes; None without a strength, or with too many."""
    axis = next((one for one in axes if one.key in STRENGTHS and one.is_numeric), None)
    if axis is None:
        return None
    others = [key for key in rows[0] if key not in SET_COLUMNS and key != axis.key]
    labels = {one.key: axis_label(one) for one in axes}
    lines: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        label = ", ".join(f"{labels[key]} = {_shown(row[key])}" for key in others)
        lines.setdefault(label, []).append(row)
    if len(lines) > MOST_CURVES:
        return None

    def column(some: Sequence[Mapping[str, Any]], name: str) -> Any:
        return np.array([row[name] for row in some], dtype=float)

    return axis, [
        ShareCurve(
            label=label.replace(" [-]", ""),
            strengths=column(some, axis.key),
            share=column(some, "overturned_share"),
            low=column(some, "low"),
            high=column(some, "high"),
        )
        for label, some in lines.items()
    ]


def _shown(value: Any) -> str:
    return number(value) if isinstance(value, float) else str(value)
