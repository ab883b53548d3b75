"""How sure the cells of a sweep are: a cell is computed with its draws, copies of it in which inputs differ.

Small changes of motion and contact (`Perturbation`), and the changes by which a run tries its unknown inputs
(`fem.case.uncertainty`); each has a name that is the same in every cell. An input that is an axis is not varied: its
effect is what the sweep shows.
"""

from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy import ndimage

from fem.case.case import Case
from fem.case.tables.input_ranges import SUPPORT, TOLERANCE
from fem.case.tables.unknown_inputs import WORDS
from fem.case.uncertainty import InputChange, all_changes, as_changed
from fem.model.geometry import build_container
from fem.model.motion import build_motions
from fem.model.support import normal_penalty
from fem.results.figures import BOXES, FELL_FIRST, RUN_COLUMNS, TURNED, RunFigures, types_of
from fem.results.level import REGIME_UNSURE, SURE, UNSURE
from fem.results.outcome import Ending, ending_of
from fem.run.compute import chosen_values
from fem.run.sureness import (
    OTHER_END,
    SAME,
    Change,
    changes_of,
    deciding_inputs,
    difference,
    how_sure,
    least_width,
    rounds_left,
    values_to_try,
)
from fem.runtime.arrays import BoolArray, FloatArray, IntArray
from fem.study.axes import Axis, lines_along, shape_of
from fem.study.containers import container_key
from fem.study.design import SMALL, Item, Sweep, Threshold
from fem.study.runner import Runner, boxes_in
from fem.study.sweep_table import FIGURES, TRIED_COLUMNS
from fem.study.table import Columns, row_of
from mesh.container import ContainerMesh

COPIES, BETWEEN = "perturbed copies", "cases between cells"  #: stages of a sweep, behind its cells
FOLLOWING = 0.9  #: copies around those that turn an outcome over these, as a rule
REMEMBERED = 4096  #: cells of which the copies are remembered
SHARE_OF_DRAWS = 0.25  #: draws of a cell over those of the band of a run
DECIDED = (Ending.STANDING, Ending.OVERTURNED)
REACH = 2  #: cells around one with another outcome that try the same change
COARSE = 4  #: one in so many values of a numeric axis belongs to the coarse grid
#: what the copies of a deformable container, which take twenty times as long, leave out
LEFT_OUT = (
    "values between the ends of a range, pairs, draws of all inputs at once, a tighter energy tolerance"
)
#: columns of what a row shows
SHOWN = {"status": str} | {key: RUN_COLUMNS[key] for key in ("outcome", *FIGURES, *FELL_FIRST, *BOXES)}
FIRST = ("status", "outcome", TURNED)
COLUMNS = (
    {"cell": int, "member": int, "change": str} | {key: SHOWN[key] for key in FIRST} | {"reason": str} | SHOWN
)


@dataclass(frozen=True, kw_only=True)
class RunShown(RunFigures):
    """What a cell, or a copy of it, shows."""

    kind: Ending


def shown_in(row: Mapping[str, Any]) -> RunShown:
    """What a row shows, by the names of `SHOWN`."""
    kind = ending_of(row["status"], row["outcome"])
    return RunShown(
        kind=kind,
        outcome=None if kind is Ending.FAILED else row["outcome"],
        boxes=boxes_in(row) or (),
        **{key: row[key] for key in (*FELL_FIRST, *FIGURES)},
    )


def left_out(sweep: Sweep) -> str:
    """What the copies of a sweep leave out of the band of a run, in words; nothing where they leave out nothing."""
    if not sweep.has_copies:
        return "all"
    cells = "cells away from a change of outcome" if sweep.perturbation.cells == "near" else ""
    rigid = sweep.base.solver.model == "rigid"
    return ", ".join(filter(None, (cells, "contact of the base", "" if rigid else LEFT_OUT)))


def input_in_words(key: str) -> str:
    """What a copy changes, by its key, for people: an unknown input, or the motion."""
    moved = "phase of the motion" if key.endswith("phase_rad") else "strength of the motion"
    return WORDS.get(key) or moved


class Copy(NamedTuple):
    """What a copy of a cell changes."""

    name: str  #: of the change, the same in all cells: its keys, and which one of these it is
    change: InputChange
    #: that make its case of that of the cell: the change, and what a run of the cell chose
    values: Mapping[str, Any]
    width: float  #: of the container [m]

    @property
    def drawn(self) -> bool:
        """Whether it changes all unknown inputs at once."""
        return self.change.kind == "draw"

    @property
    def small(self) -> bool:
        """Whether it is a small change, which matters near a change of outcome alone."""
        return self.change.share == SMALL


class _TriedCopy(NamedTuple):
    """A copy that was computed."""

    copy: Copy
    run: RunShown
    level: int  #: how it differs from the cell, see `fem.run.sureness`; a failed one as if it ended otherwise


class Copies:
    """The copies of the cells of a sweep, and those computed so far."""

    def __init__(self, sweep: Sweep, runs: Mapping[int, RunShown]) -> None:
        self._sweep, self._runs = sweep, runs  #: those of all cells
        self._mesh: tuple[Hashable, ContainerMesh] | None = None  #: the last one, and its key
        #: the copies of a cell: each change once, the draws last
        self.of = lru_cache(REMEMBERED)(lambda cell: tuple(self._made(sweep.case(cell))))
        self.rows: dict[int, dict[int, _TriedCopy]] = {}  #: by cell and number of the copy
        #: by name: a change, and which cells' outcome it turns, (n_cells,)
        self.turned: dict[str, tuple[Copy, BoolArray]] = {}

    @cached_property
    def _kind(self) -> IntArray:
        """Endings, (n_cells,); what failed or is not valid neither stands nor overturns."""
        return np.array([self._runs[cell].kind for cell in range(self._sweep.count)])

    def _made(self, case: Case) -> Iterator[Copy]:
        """The small changes, and those of a run's band without the inputs that are axes."""
        if self._mesh is None or self._mesh[0] != container_key(case):
            self._mesh = container_key(case), build_container(case)
        mesh, wanted, axes = self._mesh[1], self._sweep.perturbation, self._sweep.axis_keys
        draws = round(SHARE_OF_DRAWS * case.uncertainty.draws) if wanted.draws is None else wanted.draws
        penalty = None if case.floor.is_slab else normal_penalty(case, mesh)
        ranges, pairs, drawn = all_changes(case, penalty, draws)
        if case.solver.model == "rigid":
            ranges = (*ranges, *pairs, *drawn)
        else:
            ranges = tuple(one for one in ranges if one.share == 1.0 and TOLERANCE not in one.values)
        changes = [*wanted.changes(case)]
        for change in ranges:
            if SUPPORT not in change.values:  # as a rule it takes longer than all other copies together
                kept = {key: value for key, value in change.values.items() if key not in axes}
                places = zip(change.values, change.place, strict=False)
                changes.append(
                    replace(change, values=kept, place=tuple(x for key, x in places if key in kept))
                )
        chosen = chosen_values(case, mesh, build_motions(case))
        seen, count = list[object](), Counter[str]()
        for change in changes:
            if change.values and change.values not in seen:
                seen.append(change.values)
                keys = "draw" if change.kind == "draw" else " ".join(change.values)
                values = chosen | as_changed(case, change.values)
                yield Copy(f"{keys} {count[keys]}", change, values, case.stack[0].width)
                count[keys] += 1

    def _note(self, line: str) -> None:
        """Add a line of the log."""
        row = row_of(COLUMNS, line)
        cell, run = row["cell"], shown_in(row)
        copy, own = self.of(cell)[row["member"]], self._runs[cell]
        level = OTHER_END if run.outcome is None else difference(own, run, copy.width)
        self.rows.setdefault(cell, {})[row["member"]] = _TriedCopy(copy, run, level)
        # Draws are to find what overturns; half of them turn rest to sliding, by the start alone.
        if level == OTHER_END or (run.outcome != own.outcome and not copy.drawn):
            nowhere: BoolArray = np.zeros(self._sweep.count, dtype=bool)
            self.turned.setdefault(copy.name, (copy, nowhere))[1][cell] = True

    def _sureness(self, cell: int) -> tuple[str, tuple[str, ...]]:
        """How sure a cell is, and the inputs that decide: the smallest change that turns its outcome first.

        Both coefficients of friction moved a little at once count as the first of them.
        """
        if self._kind[cell] not in DECIDED:
            return UNSURE, ()
        rows = [row for _, row in sorted(self.rows.get(cell, {}).items())]
        most = max((row.level for row in rows), default=SAME)
        levels = [row.level if row.level == most else SAME for row in rows]
        alone = [
            replace(change, values=dict([*change.values.items()][:1])) if change.share == SMALL else change
            for change in (row.copy.change for row in rows)
        ]
        return how_sure(levels), tuple(deciding_inputs(levels, alone))

    def band(self) -> tuple[dict[str, Any], Iterator[tuple[Any, ...]]]:
        """What the copies say: a part of `sweep.json`, and for each cell the values of the columns of the band.

        The share that overturns is of a cell and all its copies: one that was not tried, because it turned no cell
        around this one, counts as the cell, and so does one that failed; draws count where some were tried.
        """
        sweep, cells = self._sweep, range(self._sweep.count)
        found = [self._sureness(cell) for cell in cells]
        unsure = np.array([word == UNSURE for word, _ in found])
        everywhere = sweep.perturbation.cells != "near"  # else nothing is known of a cell that was left out
        words = [
            word if everywhere or unsure[cell] or cell in self.rows else ""
            for cell, (word, _) in enumerate(found)
        ]
        grid = unsure.reshape(sweep.shape)
        widths = [
            band_width(sweep.axes, grid, k).ravel() for k, axis in enumerate(sweep.axes) if axis.is_numeric
        ]

        def values() -> Iterator[tuple[Any, ...]]:
            for cell, word, (_, by) in zip(cells, words, found, strict=True):
                copies = self.rows.get(cell, {}).values()
                kind = self._kind[cell]
                own = self._runs[cell][TURNED]
                ratios = [ratio for copy in copies if (ratio := copy.run[TURNED]) is not None]
                ends, share = (None, None), None
                if ratios and own is not None and np.isfinite(own):
                    ends = min(own, *ratios), max(own, *ratios)
                if word and kind != Ending.FAILED:
                    stands, kinds = kind == Ending.STANDING, [one.run.kind for one in copies]
                    turned = sum((one == Ending.STANDING) != stands and one != Ending.FAILED for one in kinds)
                    drawn = any(one.copy.drawn for one in copies)
                    share = turned / (1 + sum(drawn or not copy.drawn for copy in self.of(cell)))
                    share = share if stands else 1.0 - share
                reach = (width[cell] for width in widths)
                yield len(copies), unsure[cell], word, " ".join(by), *ends, share, *reach

        counts = Counter(words)
        deciding = Counter(key for word, by in found if word == UNSURE for key in by)
        added = {
            "perturbed": len(self.rows),
            "copies": sum(map(len, self.rows.values())),
            "unsure": counts[UNSURE],
            "sure": {word: counts[word] for word in (SURE, REGIME_UNSURE, UNSURE)},
            "decided_by": dict(deciding.most_common()),
        }
        return added, values()

    def compute(self, runner: Runner, path: Path, told: Callable[[str, int], None]) -> str:
        """Compute the copies that the log at `path` does not hold; the rows of all, as a table.

        `told` is that of `LoggedRuns`.
        """

        def key(item: Item) -> tuple[int, int, str]:
            changed = (f"{key}={value!r}" for key, value in item.unknown.items())
            return item.cell, item.draw, " ".join(changed)

        own = {"what": COPIES, "columns": COLUMNS, "key": key, "ids": 2, "note": self._note}
        own["more"] = lambda count: FOLLOWING * count
        log = self._sweep.runs(**own, path=path, told=told)
        log.run(runner, self._missing())
        return log.table()

    def _missing(self) -> Iterator[list[Item]]:
        """Copies that are not there yet: single changes and pairs, then draws where nothing else made a cell unsure."""
        axes, shape, wanted = self._sweep.axes, self._sweep.shape, self._sweep.perturbation
        ratio = np.array([self._runs[cell][TURNED] for cell in range(self._sweep.count)], dtype=float)
        near = near_cells(axes, self._kind.reshape(shape), ratio.reshape(shape), wanted.close)
        begin = near.copy()
        if wanted.cells == "all":
            near[:] = begin[:] = True
        elif wanted.cells == "auto":
            begin |= coarse_cells(axes)
        sure = np.isin(self._kind, DECIDED)
        yield from self._closing_in(sure.reshape(shape), begin, near, drawn=False)
        for cell, tried in self.rows.items():
            sure[cell] &= not any(one.level == OTHER_END and not one.copy.drawn for one in tried.values())
        sure = sure.reshape(shape)
        yield from self._closing_in(sure, begin | around(axes, ~sure), near, drawn=True)

    def _closing_in(
        self, among: BoolArray, begin: BoolArray, small: BoolArray, *, drawn: bool
    ) -> Iterator[list[Item]]:
        """Missing draws, or all other copies: of the cells to begin with, then around those that a change turns."""
        sweep, here, reached = self._sweep, among & begin, dict[str, BoolArray]()

        def reach(copy: Copy) -> BoolArray:
            """The cells that have this change."""
            return reached.setdefault(copy.name, among & (small if copy.small else begin))

        while here.any():
            items = []
            for cell in np.flatnonzero(here).tolist():
                known, item = self.rows.get(cell, {}), sweep.item(cell)
                for number, copy in enumerate(self.of(cell)):
                    if number not in known and copy.drawn == drawn and reach(copy).flat[cell]:
                        made = item._replace(draw=number, unknown=copy.change.values, more=copy.values)
                        items.append((sweep.container_of(item), copy.name, cell, made))
            # of one container together, and within it of one change
            yield [item for *_, item in sorted(items, key=itemgetter(0, 1, 2))]
            here = np.zeros_like(among)
            for copy, turned in self.turned.values():
                if copy.drawn == drawn:
                    more = around(sweep.axes, turned.reshape(sweep.shape), REACH) & among & ~reach(copy)
                    reached[copy.name] = reach(copy) | more
                    here |= more


def _size(axes: Sequence[Axis], reach: int = 1) -> tuple[int, ...]:
    return tuple(2 * reach + 1 if axis.is_numeric else 1 for axis in axes)


def near_cells(axes: Sequence[Axis], kind: IntArray, ratio: FloatArray, close: float) -> BoolArray:
    """Cells next to one of another kind, or standing and with a rotation ratio that counts as close.

    Endings and ratios have the shape of the axes; a ratio is nan where there is none.
    """
    size = _size(axes)
    highest = ndimage.maximum_filter(kind, size=size, mode="nearest")
    lowest = ndimage.minimum_filter(kind, size=size, mode="nearest")
    with np.errstate(invalid="ignore"):
        return (highest != lowest) | ((kind == Ending.STANDING) & (ratio >= close))


def around(axes: Sequence[Axis], cells: BoolArray, reach: int = 1) -> BoolArray:
    """The cells and those up to `reach` away from them, diagonally as well."""
    grown: BoolArray = ndimage.maximum_filter(cells, size=_size(axes, reach), mode="constant", cval=False)
    return grown


def coarse_cells(axes: Sequence[Axis]) -> BoolArray:
    """Every fourth cell along each numeric axis, from the second on, in the shape of the axes."""
    chosen = np.zeros(shape_of(axes), dtype=bool)
    places = (
        slice((min(len(axis.values), COARSE) - 1) // 2, None, COARSE) if axis.is_numeric else slice(None)
        for axis in axes
    )
    chosen[tuple(places)] = True
    return chosen


def band_width(axes: Sequence[Axis], unsure: BoolArray, dimension: int) -> FloatArray:
    """Length along one axis of the stretch of unsure cells around a cell, in the unit of the axis; 0 for a sure cell.

    A cell extends half way to its neighbours (by ratio on a log scale), the outermost cells to their own value.
    """
    axis = axes[dimension]
    values = np.array(axis.values, dtype=float)
    middles = np.sqrt(values[:-1] * values[1:]) if axis.scale == "log" else 0.5 * (values[:-1] + values[1:])
    edges = np.concatenate([values[:1], middles, values[-1:]])
    touching = np.zeros((3,) * unsure.ndim, dtype=bool)  # cells that belong together: along this axis
    touching[tuple(slice(None) if k == dimension else 1 for k in range(unsure.ndim))] = True
    widths = np.zeros(unsure.shape)
    for stretch in ndimage.find_objects(ndimage.label(unsure, touching)[0]):
        inside = stretch[dimension]
        widths[stretch] = edges[inside.stop] - edges[inside.start]
    return widths


#: columns of `thresholds.csv` behind those of the other axes
CHANGES: Columns = {name: types_of(Change)[name] for name in ("low", "high", "value", "below", "above")}


def refine(
    runner: Runner,
    sweep: Sweep,
    wanted: Threshold,
    runs: Mapping[int, RunShown],
    path: Path,
    told: Callable[[str, int], None],
) -> list[dict[str, Any]]:
    """Locate every change of outcome along the axis asked for: the rows of `thresholds.csv`, by `change_columns`.

    Cases that the log at `path` holds are not computed again. `told` is that of `LoggedRuns`.
    """
    along = wanted.axis
    axis = next(axis for axis in sweep.axes if axis.key == along)
    width: dict[str, Any] = {"resolution": wanted.resolution, "inner": wanted.inner}
    width["least"] = least_width(axis.numbers, wanted.resolution)
    #: outcomes by value along the axis, by the first cell of each line of cells
    lines = {
        line[0]: {float(value): runs[cell].kind.word for value, cell in zip(axis.values, line, strict=True)}
        for line in lines_along(sweep.axes, axis)
    }

    def note(line: str) -> None:
        row = row_of(TRIED_COLUMNS, line)
        lines[row["cell"]][row["value"]] = ending_of(row["status"], row["outcome"]).word

    def between_cells() -> list[Item]:
        return [
            item._replace(point={**item.point, along: value})
            for item in sweep.by_container(lines)
            for value in values_to_try(lines[item.cell], **width)
        ]

    def more(count: int) -> float:
        """Runs that follow `count`, as many a round."""
        rounds = (
            rounds_left(line, resolution=wanted.resolution, inner=wanted.inner) for line in lines.values()
        )
        return count * max(0.0, max(rounds) - 1.0)

    own = {"what": BETWEEN, "columns": TRIED_COLUMNS, "key": lambda item: (item.cell, item.point[along])}
    sweep.runs(**own, more=more, path=path, told=told, ids=2, note=note).run(runner, iter(between_cells, []))
    return [
        sweep.point(first) | {key: getattr(change, key) for key in CHANGES}
        for first in sorted(lines)
        for change in changes_of(lines[first])
    ]


def change_columns(axes: Sequence[Axis], along: str) -> Columns:
    """The columns of `thresholds.csv`: where on the other axes, and the bracket of a change."""
    words = {axis.key: any(isinstance(value, str | bool) for value in axis.values) for axis in axes}
    return {key: str if words[key] else float for key in words if key != along} | CHANGES
