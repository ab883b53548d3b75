"""The perturbed copies of a sweep's cells: which cells have them, what they say, and what the table tells of it.

Copied are cells near a change of outcome, or with a neighbour near one (see `fem.sweep.neighbours`); around each
that proves unsure its neighbours as well, until no unsure cell has a neighbour without copies.
"""

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fem.runtime.arrays import BoolArray, FloatArray
from fem.sweep.cells import Band, Found
from fem.sweep.executor import Computing
from fem.sweep.neighbours import OVERTURNED, STANDING, around, band_width, near_cells
from fem.sweep.plan import Sweep
from fem.sweep.table import RowLog, band_columns, line_of, read_lines

COLUMNS = ("cell", "member", "change", "status", "outcome", "rotation_ratio", "reason")


def copy_cells(computing: Computing, found: Found, log_path: Path, stop: Callable[[], bool]) -> Band | None:
    """Perturb the cells near a change of outcome, and go on from those that prove unsure.

    Args:
        computing: runs the copies.
        found: of the cells.
        log_path: keeps the copies; what an earlier attempt left there is not computed again.
        stop: asked now and then; true ends the work.

    Returns:
        What the copies say; None where none are wanted.
    """
    sweep = computing.sweep
    chosen, shape = sweep.perturbation.cells, sweep.shape
    if chosen == "none" or (chosen == "auto" and sweep.base.solver.model == "full"):
        return None
    band = Band()
    for line in read_lines(log_path, line_of(COLUMNS)):
        band.note(line)
    kind = found.kind.reshape(shape)
    decided = (kind == STANDING) | (kind == OVERTURNED)
    wanted = near_cells(sweep.axes, kind, found.rotation_ratio.reshape(shape), sweep.perturbation.close)
    if chosen == "all":
        wanted = np.ones(shape, dtype=bool)
    wanted &= decided
    seen = np.zeros(shape, dtype=bool)
    with RowLog(log_path, line_of(COLUMNS)) as log:
        while wanted.any() and not stop():
            _run_copies(computing, np.flatnonzero(wanted), band, log, stop)
            seen |= wanted
            wanted = around(sweep.axes, _unsure(found, band, seen)) & ~seen & decided
        log.sync()
    return band


class ToldOfCopies:
    """The columns that the copies add to a table."""

    def __init__(self, sweep: Sweep, found: Found, band: Band | None) -> None:
        self._found, self._band = found, band
        self.columns = band_columns(sweep.axes)
        self.unsure: BoolArray | None = None  #: (n_cells,); None where no cell has copies
        self._widths: list[FloatArray] = []
        if band is not None:
            perturbed = np.zeros(sweep.count, dtype=bool)
            perturbed[list(band.members)] = True
            perturbed |= (found.kind != STANDING) & (found.kind != OVERTURNED)
            unsure = _unsure(found, band, perturbed.reshape(sweep.shape))
            self._widths = [
                band_width(sweep.axes, unsure, k).ravel()
                for k, axis in enumerate(sweep.axes)
                if axis.is_numeric
            ]
            self.unsure = unsure.ravel()

    def of(self, cell: int) -> Iterator[Any]:
        """The values of a cell."""
        if self._band is None or self.unsure is None:
            yield from (None for _ in self.columns)
            return
        copies = self._band.members.get(cell, {}).values()
        ratios = [copy.ratio for copy in copies if copy.ratio is not None]
        low = high = None
        if ratios and np.isfinite(self._found.rotation_ratio[cell]):
            ratios.append(float(self._found.rotation_ratio[cell]))
            low, high = min(ratios), max(ratios)
        yield from (len(copies), self.unsure[cell], low, high)
        yield from (width[cell] for width in self._widths)


def _unsure(found: Found, band: Band, seen: BoolArray) -> BoolArray:
    """Which of the cells that were looked at are unsure, shape of the sweep."""
    unsure = np.zeros(seen.size, dtype=bool)
    for cell in np.flatnonzero(seen):
        unsure[cell] = band.is_unsure(int(cell), int(found.kind[cell]))
    return unsure.reshape(seen.shape)


def _run_copies(
    computing: Computing, cells: Iterable[int], band: Band, log: RowLog, stop: Callable[[], bool]
) -> None:
    """Run the copies of some cells that are not there yet."""
    sweep = computing.sweep
    items = [
        (cell, member)
        for cell in sweep.by_container(int(cell) for cell in cells)
        for member in range(len(sweep.member_changes(cell)))
        if member not in band.members.get(cell, {})
    ]
    for chunk, rows in computing.rows_of("perturbed copies", items, sweep.member_case, stop):
        lines = []
        for (cell, member), row in zip(chunk, rows, strict=True):
            change = sweep.member_changes(cell)[member]
            words = " ".join(f"{key}={value!r}" for key, value in change.items())
            lines.append(line_of((cell, member, words, *(row[name] for name in COLUMNS[3:]))))
        log.append(lines)
        for line in lines:
            band.note(line)
