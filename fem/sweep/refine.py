"""Locates the changes of outcome of a sweep along one axis, on all lines of cells at once: see `fem.run.bracket`."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fem.batch.axes import Axis
from fem.batch.log import LoggedRuns
from fem.batch.runner import Runner
from fem.batch.table import Columns, row_of, table_of_rows
from fem.results.figures import types_of
from fem.results.outcome import Ending, ending_of
from fem.run.bracket import Change, changes_of, least_width, values_to_try
from fem.sweep.answers import TRIED_COLUMNS
from fem.sweep.cells import CellRows
from fem.sweep.plan import Sweep

#: columns of `thresholds.csv` behind those of the other axes
CHANGES: Columns = {name: types_of(Change)[name] for name in ("low", "high", "value", "below", "above")}
#: outcomes by value along the axis, by the first cell of each line of cells
Lines = dict[int, dict[float, str]]


def refine(runner: Runner, sweep: Sweep, cells: CellRows, log: Path) -> list[tuple[int, Change]] | None:
    """Locate every change of outcome along the axis asked for; cases that the log holds are not computed again.

    Returns:
        The changes, each with the first cell of its line of cells; None where none are wanted.
    """
    wanted = sweep.threshold
    if wanted is None:
        return None
    lines = _lines_of(sweep, cells)
    least = least_width(sweep.threshold_axis.values, wanted.resolution)

    def note(line: str) -> None:
        row = row_of(TRIED_COLUMNS, line)
        lines[row["cell"]][row["value"]] = ending_of(row["status"], row["outcome"]).word

    def between_cells() -> list[tuple[int, float]]:
        return [
            (first, value)
            for first in sweep.by_container(lines)
            for value in values_to_try(
                lines[first], resolution=wanted.resolution, inner=wanted.inner, least=least
            )
        ]

    LoggedRuns(
        what="cases between cells",
        path=log,
        columns=TRIED_COLUMNS,
        make=sweep.tried_case,
        model_of=lambda item: sweep.model_of(item[0]),
        key=lambda item: item,
        note=note,
    ).run(runner, iter(between_cells, []))
    return [(first, change) for first in sorted(lines) for change in changes_of(lines[first])]


def table_of_changes(sweep: Sweep, changes: Sequence[tuple[int, Change]]) -> str:
    """`thresholds.csv`: one row for each change of outcome."""
    rows = (sweep.point(first) | {key: getattr(change, key) for key in CHANGES} for first, change in changes)
    return table_of_rows(change_columns(sweep.axes, sweep.threshold_axis.key), rows)


def change_columns(axes: Sequence[Axis], along: str) -> Columns:
    """The columns of `thresholds.csv`: where on the other axes, and the bracket of a change."""
    words = {axis.key: any(isinstance(value, str | bool) for value in axis.values) for axis in axes}
    return {key: str if words[key] else float for key in words if key != along} | CHANGES


def _lines_of(sweep: Sweep, cells: CellRows) -> Lines:
    """What the cells themselves show."""
    values = sweep.threshold_axis.values
    dimension = sweep.axes.index(sweep.threshold_axis)
    numbers = np.moveaxis(np.arange(sweep.count).reshape(sweep.shape), dimension, -1)
    return {
        int(line[0]): {
            float(value): Ending(cells.kind[cell]).word for value, cell in zip(values, line, strict=True)
        }
        for line in numbers.reshape(-1, len(values))
    }
