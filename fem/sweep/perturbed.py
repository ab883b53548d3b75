"""The perturbed copies of a sweep's cells: which cells have them, and what they show."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.batch.log import LoggedRuns, fields_of, number_in
from fem.batch.runner import Row, Runner
from fem.runtime.arrays import BoolArray
from fem.sweep.cells import CellRows
from fem.sweep.neighbours import around, band_width, kind_of, near_cells
from fem.sweep.plan import Sweep

COLUMNS = ("cell", "member", "change", "status", "outcome", "rotation_ratio", "reason")


@dataclass(frozen=True, kw_only=True)
class PerturbedRow:
    """A perturbed copy of a cell."""

    line: str  #: as in the log
    kind: int  #: see `neighbours`
    ratio: float | None  #: rotation ratio


class PerturbedRows:
    """The perturbed copies of cells so far."""

    def __init__(self, cells: CellRows) -> None:
        self._cells = cells
        self.rows: dict[int, dict[int, PerturbedRow]] = {}  #: by cell and number of the copy

    def note(self, line: str) -> None:
        """Add a line of the log."""
        cell, member, _, status, outcome, ratio, _ = fields_of(line)
        row = PerturbedRow(line=line, kind=kind_of(status, outcome), ratio=number_in(ratio))
        self.rows.setdefault(int(cell), {})[int(member)] = row

    def lines(self) -> Iterator[str]:
        """The log, in the order of cells and copies."""
        for _, copies in sorted(self.rows.items()):
            yield from (copy.line for _, copy in sorted(copies.items()))

    def unsure(self, seen: BoolArray) -> BoolArray:
        """Which of the cells `seen` are unsure, (n_cells,): those that failed, or have a copy of another kind."""
        found = seen & ~self._cells.decided
        for cell, copies in self.rows.items():
            if seen[cell]:
                found[cell] |= any(copy.kind != self._cells.kind[cell] for copy in copies.values())
        return found

    def ratios(self, cell: int) -> tuple[float | None, float | None]:
        """Least and largest rotation ratio of a cell and its copies; None where there is none."""
        found = [copy.ratio for copy in self.rows.get(cell, {}).values() if copy.ratio is not None]
        own = float(self._cells.rotation_ratio[cell])
        return (min(own, *found), max(own, *found)) if found and np.isfinite(own) else (None, None)


def band_rows(
    sweep: Sweep, cells: CellRows, perturbed: PerturbedRows
) -> tuple[BoolArray, Callable[[int], tuple[Any, ...]]]:
    """What the perturbed copies add to the table.

    Returns:
        Which cells are unsure, (n_cells,), and for a cell the values of `table.band_columns`.
    """
    seen = ~cells.decided
    seen[list(perturbed.rows)] = True
    unsure = perturbed.unsure(seen)
    grid = unsure.reshape(sweep.shape)
    widths = [band_width(sweep.axes, grid, k).ravel() for k, axis in enumerate(sweep.axes) if axis.is_numeric]

    def values(cell: int) -> tuple[Any, ...]:
        copies = len(perturbed.rows.get(cell, {}))
        return copies, unsure[cell], *perturbed.ratios(cell), *(width[cell] for width in widths)

    return unsure, values


def perturb_cells(runner: Runner, sweep: Sweep, cells: CellRows, log: Path) -> PerturbedRows | None:
    """Perturb the cells near a change of outcome, then the neighbours of those that are unsure, until there are none.

    Returns:
        The copies, those that the log held already included; None where none are wanted.
    """
    chosen = sweep.perturbation.cells
    if chosen == "none" or (chosen == "auto" and sweep.base.solver.model == "full"):
        return None
    perturbed = PerturbedRows(cells)
    LoggedRuns(
        what="perturbed copies",
        path=log,
        columns=COLUMNS,
        make=sweep.member_case,
        model_of=lambda item: sweep.model_of(item[0]),
        values=lambda item, row: _values(sweep, item, row),
        note=perturbed.note,
    ).run(runner, _missing(sweep, cells, perturbed))
    return perturbed


def _missing(sweep: Sweep, cells: CellRows, perturbed: PerturbedRows) -> Iterator[list[tuple[int, int]]]:
    """Copies that are not there yet, as cell and number: ring after ring around the unsure cells."""
    shape, decided = sweep.shape, cells.decided.reshape(sweep.shape)
    kind, ratio = cells.kind.reshape(shape), cells.rotation_ratio.reshape(shape)
    wanted = decided & (
        (sweep.perturbation.cells == "all") | near_cells(sweep.axes, kind, ratio, sweep.perturbation.close)
    )
    seen = np.zeros(shape, dtype=bool)
    while wanted.any():
        yield list(_copies(sweep, np.flatnonzero(wanted), perturbed))
        seen |= wanted
        wanted = around(sweep.axes, perturbed.unsure(seen.ravel()).reshape(shape)) & ~seen & decided


def _copies(sweep: Sweep, cells: Iterable[int], perturbed: PerturbedRows) -> Iterator[tuple[int, int]]:
    for cell in sweep.by_container(int(cell) for cell in cells):
        known = perturbed.rows.get(cell, {})
        yield from ((cell, k) for k in range(len(sweep.member_changes(cell))) if k not in known)


def _values(sweep: Sweep, item: tuple[int, int], row: Row) -> Iterator[Any]:
    cell, member = item
    change = sweep.member_changes(cell)[member]
    yield from (cell, member, " ".join(f"{key}={value!r}" for key, value in change.items()))
    yield from (row[name] for name in COLUMNS[3:])
