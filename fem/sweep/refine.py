"""Where the outcome of a sweep changes along one axis: closed in on, on all lines of cells at once (`threshold`)."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fem.sweep.cells import Found
from fem.sweep.executor import Computing
from fem.sweep.neighbours import KIND_NAMES, kind_of
from fem.sweep.plan import Sweep
from fem.sweep.table import RowLog, fields_of, line_of, write_table
from fem.sweep.threshold import Change, changes_of, least_width, values_to_try

COLUMNS = ("cell", "value", "status", "outcome", "rotation_ratio", "reason")

#: outcomes by value along the axis, by the first cell of each line of cells
Lines = dict[int, dict[float, str]]


def refine(
    computing: Computing, found: Found, log_path: Path, stop: Callable[[], bool]
) -> list[tuple[int, Change]] | None:
    """Close in on every change of outcome along the axis asked for.

    Args:
        computing: runs the cases between cells.
        found: of the cells.
        log_path: keeps these cases; what an earlier attempt left there is not computed again.
        stop: asked now and then; true ends the work.

    Returns:
        The changes, each with the first cell of its line of cells; None where none are wanted.
    """
    sweep, wanted = computing.sweep, computing.sweep.threshold
    if wanted is None:
        return None
    lines = _lines_of(sweep, found)
    least = least_width(sweep.threshold_axis.values, wanted.resolution)

    def between_cells() -> Iterator[tuple[int, float]]:
        for first in sweep.by_container(lines):
            for value in values_to_try(
                lines[first], resolution=wanted.resolution, inner=wanted.inner, least=least
            ):
                yield first, value

    with RowLog(log_path, line_of(COLUMNS)) as log:
        for line in log.lines:
            first, value, status, outcome, *_ = fields_of(line)
            lines[int(first)][float(value)] = KIND_NAMES[kind_of(status, outcome)]
        while not stop() and (items := list(between_cells())):
            for chunk, rows in computing.rows_of("cases between cells", items, sweep.tried_case, stop):
                pairs = list(zip(chunk, rows, strict=True))
                log.append([line_of((*item, *(row[name] for name in COLUMNS[2:]))) for item, row in pairs])
                for (cell, tried), row in pairs:
                    lines[cell][tried] = KIND_NAMES[kind_of(row["status"], row["outcome"])]
        log.sync()
    return [(first, change) for first in sorted(lines) for change in changes_of(lines[first])]


def write_changes(sweep: Sweep, changes: Sequence[tuple[int, Change]], path: Path) -> None:
    """A table of the changes, a row each.

    Raises:
        OSError: it cannot be written.
    """
    others = [axis.key for axis in sweep.axes if axis is not sweep.threshold_axis]

    def row(first: int, change: Change) -> Iterator[Any]:
        point = sweep.point(first)
        yield from (point[key] for key in others)
        yield from (change.low, change.high, change.value, change.below, change.above)

    columns = (*others, "low", "high", "value", "below", "above")
    write_table(path, columns, (line_of(row(first, change)) for first, change in changes))


def _lines_of(sweep: Sweep, found: Found) -> Lines:
    """What the cells themselves say."""
    values = sweep.threshold_axis.values
    place = sweep.axes.index(sweep.threshold_axis)
    numbers = np.moveaxis(np.arange(sweep.count).reshape(sweep.shape), place, -1)
    return {
        int(cells[0]): {
            float(value): KIND_NAMES[int(found.kind[cell])] for value, cell in zip(values, cells, strict=True)
        }
        for cells in numbers.reshape(-1, len(values))
    }
