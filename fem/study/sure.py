"""The copies that a cell of a sweep may have: what each changes, by a name that is the same in every cell.

Small changes of motion and contact (`perturbation`), and the changes by which a run tries its unknown inputs
(`fem.case.uncertainty`). An input that is an axis is not varied: its effect is what the sweep shows.
"""

from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
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
from fem.case.case import Case
from fem.case.tables.input_keys import SUPPORT, TOLERANCE
from fem.case.uncertainty import InputChange, all_changes, as_changed
from fem.model.geometry import build_container
from fem.model.motion import build_motions
from fem.model.support import normal_penalty
from fem.results.figures import TURNED, types_of
from fem.results.outcome import Ending, ending_of
from fem.run.bracket import Change, changes_of, least_width, values_to_try
from fem.run.checks import WantedChecks
from fem.run.solve import chosen_values
from fem.runtime.arrays import BoolArray
from fem.study.axes import Axis
from fem.study.containers import container_key
from fem.study.design import Item, Sweep
from fem.study.driver import LoggedRuns
from fem.study.perturbation import SMALL, around, band_width, coarse_cells, near_cells
from fem.study.runner import MARGIN, Runner, check_chunk
from fem.study.sweep_table import SHOWN, TRIED_COLUMNS, CellRows, RunShown, shown_in
from fem.study.table import Columns, fields_of, row_of, table_of_rows
from mesh.container import ContainerMesh

#: cells of which the copies are remembered
REMEMBERED = 4096
#: draws of a cell over those of the band of a run
SHARE_OF_DRAWS = 0.25
#: what the copies of a deformable container, which take twenty times as long, leave out
LEFT_OUT = (
    "values between the ends of a range, pairs, draws of all inputs at once, a tighter energy tolerance"
)


def left_out(sweep: Sweep) -> str:
    """What the copies of a sweep leave out of the band of a run, in words; nothing where they leave out nothing."""
    chosen, rigid = sweep.perturbation.cells, sweep.base.solver.model == "rigid"
    if chosen == "none" or (chosen == "auto" and sweep.base.solver.model == "full"):
        return "all"
    cells = "cells away from a change of outcome" if chosen == "near" else ""
    return ", ".join(filter(None, (cells, "contact of the base", "" if rigid else LEFT_OUT)))


@dataclass(frozen=True, kw_only=True)
class Copy:
    """What a copy of a cell changes."""

    name: str  #: of the change, the same in all cells: its keys, and which one of these it is
    change: InputChange
    #: that make its case of that of the cell: the change, and what a run of the cell chose
    values: Mapping[str, Any]

    @property
    def drawn(self) -> bool:
        """Whether it changes all unknown inputs at once."""
        return self.change.kind == "draw"

    @property
    def small(self) -> bool:
        """Whether it is a small change, which matters near a change of outcome alone."""
        return self.change.share == SMALL


class CellCopies:
    """The copies of the cells of a sweep; those asked for last are remembered."""

    def __init__(self, sweep: Sweep) -> None:
        self._sweep = sweep
        self._axes = {axis.key for axis in sweep.axes}
        self._known: dict[int, tuple[float, tuple[Copy, ...]]] = {}
        self._mesh: tuple[Hashable, ContainerMesh] | None = None  #: the last one, and its key

    def of(self, cell: int) -> tuple[Copy, ...]:
        """The copies of a cell: each change once, the draws last."""
        return self._of(cell)[1]

    def width(self, cell: int) -> float:
        """Width of the container of a cell [m]."""
        return self._of(cell)[0]

    def _of(self, cell: int) -> tuple[float, tuple[Copy, ...]]:
        if cell not in self._known:
            if len(self._known) >= REMEMBERED:
                self._known.clear()
            case = self._sweep.case(cell)
            self._known[cell] = case.stack[0].width, tuple(self._copies(case))
        return self._known[cell]

    def _copies(self, case: Case) -> Iterator[Copy]:
        seen: list[object] = []
        count = Counter[str]()
        key = container_key(case)
        if self._mesh is None or self._mesh[0] != key:
            self._mesh = key, build_container(case)
        mesh = self._mesh[1]
        chosen = chosen_values(case, mesh, build_motions(case))
        penalty = None if case.floor.is_slab else normal_penalty(case, mesh)
        for change in (*self._sweep.perturbation.changes(case), *self._over_ranges(case, penalty)):
            if change.values and change.values not in seen:
                seen.append(change.values)
                keys = "draw" if change.kind == "draw" else " ".join(change.values)
                values = chosen | as_changed(case, change.values)
                yield Copy(name=f"{keys} {count[keys]}", change=change, values=values)
                count[keys] += 1

    def _over_ranges(self, case: Case, penalty: float | None) -> Iterator[InputChange]:
        """The changes of a run's band, without the inputs that are axes."""
        count = self._sweep.perturbation.draws
        if count is None:
            count = round(SHARE_OF_DRAWS * case.uncertainty.draws)
        changes, pairs, draws = all_changes(case, penalty, count)
        if case.solver.model == "rigid":
            changes = (*changes, *pairs, *draws)
        else:
            changes = tuple(
                change for change in changes if change.share == 1.0 and TOLERANCE not in change.values
            )
        for change in changes:
            if SUPPORT in change.values:  # as a rule takes longer than all other copies together
                continue
            kept = {key: value for key, value in change.values.items() if key not in self._axes}
            coordinates = zip(change.values, change.place, strict=False)
            yield replace(change, values=kept, place=tuple(x for key, x in coordinates if key in kept))


FIRST = ("status", "outcome", TURNED)
COLUMNS = (
    {"cell": int, "member": int, "change": str} | {key: SHOWN[key] for key in FIRST} | {"reason": str} | SHOWN
)
#: cells around one with another outcome that try the same change
REACH = 2


@dataclass(frozen=True, kw_only=True)
class PerturbedRow:
    """A perturbed copy of a cell."""

    copy: Copy
    run: RunShown
    level: int  #: how it differs from the cell, see `fem.assessment.sureness`; a failed one as if it ended otherwise


class PerturbedRows:
    """The perturbed copies of cells so far."""

    def __init__(self, sweep: Sweep, cells: CellRows) -> None:
        self._cells = cells
        self.copies = CellCopies(sweep)
        self.rows: dict[int, dict[int, PerturbedRow]] = {}  #: by cell and number of the copy
        self.log: LoggedRuns[Item] | None = None
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
        self.rows.setdefault(cell, {})[number] = PerturbedRow(copy=copy, run=run, level=level)
        # Draws are to find what overturns; half of them turn rest to sliding, by the start alone.
        if level == OTHER_END or (run.outcome != own.outcome and not copy.drawn):
            nowhere: BoolArray = np.zeros(self._cells.kind.size, dtype=bool)
            self.turned.setdefault(copy.name, (copy, nowhere))[1][cell] = True

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
    perturbed.log = LoggedRuns(
        what="perturbed copies",
        path=log,
        columns=COLUMNS,
        make=sweep.make.case,
        model_of=sweep.model_of,
        key=_key,
        ids=2,
        note=perturbed.note,
    )
    perturbed.log.run(runner, _missing(sweep, cells, perturbed))
    return perturbed


def _missing(sweep: Sweep, cells: CellRows, perturbed: PerturbedRows) -> Iterator[list[Item]]:
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
) -> Iterator[list[Item]]:
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
) -> list[Item]:
    """Copies of cells that are not there yet: of one container together, and within it of one change."""
    items = []
    for cell in np.flatnonzero(cells).tolist():
        known, item = perturbed.rows.get(cell, {}), sweep.item(cell)
        container = sweep.container_of(item)
        for number, copy in enumerate(perturbed.copies.of(cell)):
            if number not in known and wants(cell, copy):
                made = item._replace(draw=number, unknown=copy.change.values, more=copy.values)
                items.append((container, copy.name, made))
    return [item for _, _, item in sorted(items, key=lambda entry: (*entry[:2], entry[2].cell))]


def _key(item: Item) -> tuple[int, int, str]:
    return item.cell, item.draw, " ".join(f"{key}={value!r}" for key, value in item.unknown.items())


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
    along, least = wanted.axis, least_width(sweep.threshold_axis.values, wanted.resolution)

    def note(line: str) -> None:
        row = row_of(TRIED_COLUMNS, line)
        lines[row["cell"]][row["value"]] = ending_of(row["status"], row["outcome"]).word

    def between_cells() -> list[Item]:
        return [
            item._replace(point={**item.point, along: value})
            for item in sweep.by_container(map(sweep.item, lines))
            for value in values_to_try(
                lines[item.cell], resolution=wanted.resolution, inner=wanted.inner, least=least
            )
        ]

    LoggedRuns[Item](
        what="cases between cells",
        path=log,
        columns=TRIED_COLUMNS,
        make=sweep.make.case,
        model_of=sweep.model_of,
        key=lambda item: (item.cell, item.point[along]),
        ids=2,
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


CHECKS = WantedChecks(band=False, margin=True)  #: as `run` makes them, without drawn inputs


def find_margins(runner: Runner, sweep: Sweep, log: Path) -> dict[int, tuple[str, ...]]:
    """The fields of `MARGIN` by cell, none where none are asked for; what the log holds is not computed again."""
    if not sweep.margin:
        return {}
    margins = LoggedRuns[Item](
        what="margins of cells",
        path=log,
        columns={"cell": int, **MARGIN},
        make=sweep.make.case,
        model_of=sweep.model_of,
        key=lambda item: item[:1],
        ids=1,
        work=partial(check_chunk, checks=CHECKS),
    )
    items = sweep.by_container(map(sweep.item, range(sweep.count)))
    margins.run(runner, iter(partial(margins.missing, items), []))
    return {cell: tuple(fields_of(line)[1:]) for (cell,), line in margins.lines.items()}
