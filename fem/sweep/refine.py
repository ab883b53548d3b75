"""Locates the changes of outcome of a sweep along one axis, on all lines of cells at once: see `fem.run.bracket`."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fem.batch.log import LoggedRuns
from fem.batch.runner import Runner
from fem.batch.table import row_of, table_text
from fem.results.figures import TURNED
from fem.results.outcome import Ending, ending_of
from fem.run.bracket import Change, changes_of, least_width, values_to_try
from fem.sweep.cells import FIGURES, CellRows
from fem.sweep.plan import Sweep

COLUMNS = {"cell": int, "value": float, "status": str, "outcome": str, TURNED: float, "reason": str} | FIGURES

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
        row = row_of(COLUMNS, line)
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
        columns=COLUMNS,
        make=sweep.tried_case,
        model_of=lambda item: sweep.model_of(item[0]),
        key=lambda item: item,
        note=note,
    ).run(runner, iter(between_cells, []))
    return [(first, change) for first in sorted(lines) for change in changes_of(lines[first])]


def table_of_changes(sweep: Sweep, changes: Sequence[tuple[int, Change]]) -> str:
    """`thresholds.csv`: one row a change of outcome."""
    others = [axis.key for axis in sweep.axes if axis is not sweep.threshold_axis]

    def row(first: int, change: Change) -> Iterator[Any]:
        point = sweep.point(first)
        yield from (point[key] for key in others)
        yield from (change.low, change.high, change.value, change.below, change.above)

    columns = (*others, "low", "high", "value", "below", "above")
    return table_text(columns, (row(first, change) for first, change in changes))


def _lines_of(sweep: Sweep, cells: CellRows) -> Lines:
    """What the cells themselves show."""
    values = sweep.threshold_axis.values
    place = sweep.axes.index(sweep.threshold_axis)
    numbers = np.moveaxis(np.arange(sweep.count).reshape(sweep.shape), place, -1)
    return {
        int(line[0]): {
            float(value): Ending(cells.kind[cell]).word for value, cell in zip(values, line, strict=True)
        }
        for line in numbers.reshape(-1, len(values))
    }
