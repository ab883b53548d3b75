"""The perturbed copies of a sweep's cells: which cells have which, and what they show.

A change is tried on a coarse grid of all cells and near changes of outcome, and then around every cell whose outcome it
turns, until no further cell has another outcome. The draws of all unknown inputs follow where nothing else turned a
cell over. Which copies there are depends on the outcomes alone, not on the order in which they are computed.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fem.assessment.sureness import (
    OTHER_END,
    OTHER_REGIME,
    REGIME_UNSURE,
    SAME,
    SURE,
    UNSURE,
    deciding_inputs,
    difference,
)
from fem.batch.log import LoggedRuns
from fem.batch.runner import Runner
from fem.batch.table import row_of
from fem.results.figures import TURNED
from fem.results.outcome import Ending
from fem.runtime.arrays import BoolArray
from fem.sweep.cells import SHOWN, CellRows, RunShown, shown_in
from fem.sweep.copies import CellCopies, Copy
from fem.sweep.neighbours import around, band_width, coarse_cells, near_cells
from fem.sweep.plan import CopyItem, Sweep

FIRST = ("status", "outcome", TURNED)
COLUMNS = (
    {"cell": int, "member": int, "change": str} | {key: SHOWN[key] for key in FIRST} | {"reason": str} | SHOWN
)
#: cells around one with another outcome that try the same change
REACH = 2


@dataclass(frozen=True, kw_only=True)
class PerturbedRow:
    """A perturbed copy of a cell."""

    line: str  #: as in the log
    copy: Copy
    run: RunShown
    level: int  #: how it differs from the cell, see `fem.assessment.sureness`; a failed one as if it ended otherwise


class PerturbedRows:
    """The perturbed copies of cells so far."""

    def __init__(self, sweep: Sweep, cells: CellRows) -> None:
        self._cells = cells
        self.copies = CellCopies(sweep)
        self.rows: dict[int, dict[int, PerturbedRow]] = {}  #: by cell and number of the copy
        #: by name: a change, and which cells' outcome it turns, (n_cells,)
        self.turned: dict[str, tuple[Copy, BoolArray]] = {}

    def note(self, line: str) -> None:
        """Add a line of the log."""
        row = row_of(COLUMNS, line)
        cell, number = row["cell"], row["member"]
        copy, own = self.copies.of(cell)[number], self._cells.runs[cell]
        run = shown_in(row)
        level = OTHER_END
        if run.outcome is not None:
            level = difference(own, run, self.copies.width(cell))
        self.rows.setdefault(cell, {})[number] = PerturbedRow(line=line, copy=copy, run=run, level=level)
        # Draws are to find what overturns; half of them turn rest to sliding, by the start alone.
        if level == OTHER_END or (run.outcome != own.outcome and not copy.drawn):
            nowhere: BoolArray = np.zeros(self._cells.kind.size, dtype=bool)
            self.turned.setdefault(copy.name, (copy, nowhere))[1][cell] = True

    def lines(self) -> Iterator[str]:
        """The log, in the order of cells and copies."""
        for _, copies in sorted(self.rows.items()):
            yield from (copy.line for _, copy in sorted(copies.items()))

    def unsure(self, *, drawn: bool = True) -> BoolArray:
        """Which cells are unsure, (n_cells,): those that failed, or have a copy that ends otherwise or fails."""
        unsure = ~self._cells.decided
        for cell, copies in self.rows.items():
            unsure[cell] |= any(
                copy.level == OTHER_END for copy in copies.values() if drawn or not copy.copy.drawn
            )
        return unsure

    def sureness(self, cell: int) -> tuple[str, tuple[str, ...]]:
        """How sure a cell is, and the inputs that decide: the smallest change that turns its outcome first.

        Both coefficients of friction moved a little at once count as the first of them.
        """
        if not self._cells.decided[cell]:
            return UNSURE, ()
        rows = [row for _, row in sorted(self.rows.get(cell, {}).items())]
        most = max((row.level for row in rows), default=SAME)
        levels = [row.level if row.level == most else SAME for row in rows]
        alone = [
            replace(copy.change, values=dict([*copy.change.values.items()][:1]))
            if copy.small
            else copy.change
            for copy in (row.copy for row in rows)
        ]
        word = {SAME: SURE, OTHER_REGIME: REGIME_UNSURE, OTHER_END: UNSURE}[most]
        return word, tuple(deciding_inputs(levels, alone))

    def ratios(self, cell: int) -> tuple[float | None, float | None]:
        """Least and largest rotation ratio of a cell and its copies; None where there is none."""
        copies = self.rows.get(cell, {}).values()
        ratios = [ratio for copy in copies if (ratio := copy.run[TURNED]) is not None]
        own = float(self._cells.ratio[cell])
        return (min(own, *ratios), max(own, *ratios)) if ratios and np.isfinite(own) else (None, None)

    def overturned_share(self, cell: int) -> float | None:
        """Share of a cell and all its copies that do not stand; None of a cell that failed.

        A copy that was not tried, because it turned no cell around this one, counts as the cell, and so does one that
        failed; draws count where some were tried.
        """
        if self._cells.kind[cell] in (Ending.UNKNOWN, Ending.FAILED):
            return None
        own, tried = self._cells.kind[cell] == Ending.STANDING, self.rows.get(cell, {}).values()
        known = [trial.run.kind for trial in tried if trial.run.kind != Ending.FAILED]
        turned = sum((kind == Ending.STANDING) != own for kind in known)
        drawn = any(trial.copy.drawn for trial in tried)
        share = turned / (1 + sum(drawn or not copy.drawn for copy in self.copies.of(cell)))
        return share if own else 1.0 - share


def band_rows(
    sweep: Sweep, cells: CellRows, perturbed: PerturbedRows
) -> tuple[Counter[str], Counter[str], Callable[[int], tuple[Any, ...]]]:
    """What the perturbed copies add to the table.

    Returns:
        How many cells are sure, regime unsure, unsure; how many unsure ones each input decides; and for a cell the
        values of `table.band_columns`.
    """
    everywhere = sweep.perturbation.cells != "near"
    sureness = [perturbed.sureness(cell) for cell in range(sweep.count)]
    unsure = np.array([word == UNSURE for word, _ in sureness])
    grid = unsure.reshape(sweep.shape)
    widths = [band_width(sweep.axes, grid, k).ravel() for k, axis in enumerate(sweep.axes) if axis.is_numeric]

    def sure(cell: int) -> str:
        """Nothing is known of a cell that was left out."""
        return sureness[cell][0] if everywhere or unsure[cell] or cell in perturbed.rows else ""

    def values(cell: int) -> tuple[Any, ...]:
        copies = len(perturbed.rows.get(cell, {}))
        by = " ".join(sureness[cell][1])
        ratios = perturbed.ratios(cell)
        share = perturbed.overturned_share(cell) if sure(cell) else None
        return copies, unsure[cell], sure(cell), by, *ratios, share, *(width[cell] for width in widths)

    counts = Counter(word for cell in range(sweep.count) if (word := sure(cell)))
    return counts, Counter(key for word, by in sureness if word == UNSURE for key in by), values


def perturb_cells(runner: Runner, sweep: Sweep, cells: CellRows, log: Path) -> PerturbedRows | None:
    """Compute the perturbed copies of a sweep's cells.

    Returns:
        The copies, those that the log held already included; None where none are wanted.
    """
    chosen = sweep.perturbation.cells
    if chosen == "none" or (chosen == "auto" and sweep.base.solver.model == "full"):
        return None
    perturbed = PerturbedRows(sweep, cells)
    LoggedRuns(
        what="perturbed copies",
        path=log,
        columns=COLUMNS,
        make=sweep.copy_case,
        model_of=lambda item: sweep.model_of(item.cell),
        key=_key,
        note=perturbed.note,
    ).run(runner, _missing(sweep, cells, perturbed))
    return perturbed


def _missing(sweep: Sweep, cells: CellRows, perturbed: PerturbedRows) -> Iterator[list[CopyItem]]:
    """Copies that are not there yet: single changes and pairs, then draws."""
    axes, shape = sweep.axes, sweep.shape
    decided = cells.decided.reshape(shape)
    near = near_cells(axes, cells.kind.reshape(shape), cells.ratio.reshape(shape), sweep.perturbation.close)
    begin = near.copy()
    match sweep.perturbation.cells:
        case "all":
            near[:] = begin[:] = True
        case "auto":
            begin |= coarse_cells(axes)
    yield from _closing_in(sweep, perturbed, decided, drawn=False, begin=begin, small=near)
    sure = decided & ~perturbed.unsure(drawn=False).reshape(shape)
    yield from _closing_in(sweep, perturbed, sure, drawn=True, begin=begin | around(axes, ~sure), small=near)


def _closing_in(
    sweep: Sweep,
    perturbed: PerturbedRows,
    among: BoolArray,
    *,
    drawn: bool,
    begin: BoolArray,
    small: BoolArray,
) -> Iterator[list[CopyItem]]:
    """Missing copies of the cells to begin with, then of each change around the cells that it turns.

    Args:
        sweep, perturbed: what is asked for, and what there is.
        among: cells that may have them, in the shape of the axes.
        drawn: the draws, or all others.
        begin: cells to begin with, for small changes those of `small`.
        small: as `begin`.
    """
    seen: dict[str, BoolArray] = {}

    def known(copy: Copy) -> BoolArray:
        if copy.name not in seen:
            seen[copy.name] = among & (small if copy.small else begin)
        return seen[copy.name]

    here = among & begin
    wanted: dict[str, BoolArray] | None = None

    def wants(cell: int, copy: Copy) -> bool:
        if wanted is None:
            return copy.drawn == drawn and bool(known(copy).flat[cell])
        return copy.name in wanted and bool(wanted[copy.name].flat[cell])

    while here.any():
        yield _items(sweep, perturbed, here, wants)
        here, wanted = np.zeros_like(among), {}
        for name, (copy, turned) in perturbed.turned.items():
            around_it = around(sweep.axes, turned.reshape(sweep.shape), REACH) & among & ~known(copy)
            if copy.drawn == drawn and around_it.any():
                wanted[name] = around_it
                seen[name] |= around_it
                here |= around_it


def _items(
    sweep: Sweep, perturbed: PerturbedRows, cells: BoolArray, wants: Callable[[int, Copy], bool]
) -> list[CopyItem]:
    """Copies of cells that are not there yet: of one container together, and within it of one change."""
    items = []
    for cell in np.flatnonzero(cells).tolist():
        known, container = perturbed.rows.get(cell, {}), sweep.container_of(cell)
        for number, copy in enumerate(perturbed.copies.of(cell)):
            if number not in known and wants(cell, copy):
                items.append((container, copy.name, CopyItem(cell, number, copy.values, copy.change.values)))
    return [item for _, _, item in sorted(items, key=lambda entry: (*entry[:2], entry[2].cell))]


def _key(item: CopyItem) -> tuple[int, int, str]:
    return item.cell, item.number, " ".join(f"{key}={value!r}" for key, value in item.change.items())
