"""A sweep, from its file to its table.

cells -> rows -> which are near a change of outcome -> these perturbed -> changes of outcome closed in on -> table,
maps. Everything that was computed lies in a log before the next begins, so that a sweep that was cut off goes on
where it was, and its table does not tell that it ever was.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.case import Case, case_hash
from fem.case_reading import CaseError
from fem.folder_lock import held_folder
from fem.program import program_identity, versions
from fem.progress import Reporter, SilentReporter, clock_time
from fem.run import copy_data_files, interruptible
from fem.run_folder import naming_what_cannot_be_written
from fem.simulation import cores
from fem.sweep.band import (
    KIND_NAMES,
    OVERTURNED,
    STANDING,
    UNKNOWN,
    BoolArray,
    FloatArray,
    around,
    band_width,
    kind_of,
    near_cells,
)
from fem.sweep.findings import Band, Found
from fem.sweep.folder import SweepFolder, band_hash, open_sweep_folder, sweep_hash, write_info, write_plan
from fem.sweep.maps import draw_maps
from fem.sweep.plan import Sweep
from fem.sweep.running import Row, run_items
from fem.sweep.size import check_size
from fem.sweep.table import (
    FOUND,
    RowLog,
    band_columns,
    fields_of,
    line_of,
    open_sweep,
    read_info,
    read_lines,
    row_columns,
    write_table,
)
from fem.sweep.threshold import Change, changes_of, least_width, values_to_try
from fem.sweep.workers import LocalWorkers, WorkersOf

#: how often `sweep.json` tells how far the sweep has come [s]
NOTE_S = 10.0

TRIED_COLUMNS = ("cell", "value", "status", "outcome", "rotation_ratio", "reason")
MEMBER_COLUMNS = ("cell", "member", "change", "status", "outcome", "rotation_ratio", "reason")


def run_sweep(
    sweep: Sweep,
    folder: Path,
    *,
    jobs: int | None = None,
    workers_of: WorkersOf | None = None,
    resume: bool = False,
    force: bool = False,
    reporter: Reporter | None = None,
) -> dict[str, Any]:
    """Compute a sweep into a folder.

    Args:
        sweep: what is asked.
        folder: of the results.
        jobs: cores to use; all by default. The table does not depend on it.
        workers_of: who computes so many cases of a model, in place of this machine's cores.
        resume: go on with what is there.
        force: begin anew over what is there; also lifts the limit on the number of cells.
        reporter: told of the progress.

    Returns:
        What stands in `sweep.json`.

    Raises:
        CaseError: too many cells.
        FolderError: the folder holds something else.
        FolderLockedError: another process writes into it.
        WorkersLostError: a worker died; what was computed is kept.
        OutputError: the disk is full, the folder was removed; what was written is kept.
    """
    reporter = reporter or SilentReporter()
    jobs = jobs or cores()
    check_size(sweep, jobs, force)
    with held_folder(folder) as lock, interruptible(reporter) as stop, ExitStack() as held:
        place = open_sweep_folder(folder, sweep, force=force, resume=resume)
        if place.finished:
            reporter.message(f"{folder} holds this sweep already; --force computes it again")
            return _with_maps(place, sweep)
        work = _Work(
            sweep=sweep,
            place=place,
            reporter=reporter,
            workers_of=workers_of or held.enter_context(LocalWorkers(jobs)),
            info=_asked(sweep) | {"jobs": jobs},
            check=lock.check,
        )
        with naming_what_cannot_be_written(folder, "--resume goes on"):
            return work.run(stop)


def _with_maps(place: SweepFolder, sweep: Sweep) -> dict[str, Any]:
    """A finished sweep; its maps are drawn anew if they are to be others."""
    info = read_info(place.path)
    asked = sweep.maps.model_dump()
    if info.get("map_axes") != asked:
        info |= {"map_axes": asked, "maps": _draw(place, sweep)}
        write_info(place, info)
    return info


def _draw(place: SweepFolder, sweep: Sweep) -> list[str]:
    return draw_maps(open_sweep(place.path), place.maps, **sweep.maps.model_dump())


def _asked(sweep: Sweep) -> dict[str, Any]:
    """The part of `sweep.json` that is known beforehand."""
    return {
        "status": "running",
        "sweep": sweep.name,
        "title": sweep.title,
        "case": sweep.base.name,
        "sweep_hash": sweep_hash(sweep),
        "band_hash": band_hash(sweep),
        "base_hash": case_hash(sweep.base),
        "model": sweep.base.solver.model,
        "duration_s": sweep.base.solver.duration_s,
        "axes": [
            {"key": axis.key, "values": axis.values, "scale": axis.scale, "unit": axis.unit}
            for axis in sweep.axes
        ],
        "derived": {one.key: one.expression.text for one in sweep.derived},
        "perturbation": sweep.perturbation.model_dump(),
        "threshold": sweep.threshold.model_dump() if sweep.threshold else None,
        "cells": sweep.count,
        "rows": 0,
        "outcomes": {},
        "perturbed": 0,
        "unsure": None,
        "changes": None,
        "map_axes": sweep.maps.model_dump(),
        "maps": [],
        "program": program_identity()["sources"],
        "versions": versions(),
    }


@dataclass(kw_only=True)
class _Work:
    """A sweep under way."""

    sweep: Sweep
    place: SweepFolder
    reporter: Reporter
    workers_of: WorkersOf
    info: dict[str, Any]
    check: Callable[[], None]  #: raises FolderLostError once the folder is another's
    _noted: float = 0.0

    def run(self, stop: Callable[[], bool]) -> dict[str, Any]:
        began = time.perf_counter()
        found = self._known_rows()
        if not self.place.same_band:
            # Told first: a kill must not leave the copies of another band beside the hash of this one.
            write_info(self.place, self.info | {"band_hash": None})
            for file in (self.place.members, self.place.tried, self.place.thresholds):
                file.unlink(missing_ok=True)
        write_plan(self.place, self.sweep, self.info)
        copy_data_files(self.sweep.base, self.place.path)
        self._compute_rows(found, stop)
        band = None if stop() else self._perturb(found, stop)
        changes = None if stop() else self._refine(found, stop)
        if stop():
            self.info["status"] = "interrupted"
        else:
            self.check()
            unsure = self._write_table(found, band)
            if band is not None:
                write_table(self.place.members, MEMBER_COLUMNS, band.lines())
            self._write_changes(changes)
            self.info["unsure"] = None if unsure is None else int(unsure.sum())
            self.info["status"] = "completed" if self._any_outcome(found) else "failed"
            self.info["maps"] = _draw(self.place, self.sweep)
        self.info["wall_s"] = time.perf_counter() - began
        self._note(found, force=True)
        if self.info["status"] != "interrupted":
            self.place.rows.unlink(missing_ok=True)
        self.reporter.finish()
        return self.info

    @staticmethod
    def _any_outcome(found: Found) -> bool:
        return set(found.outcomes) != {"failed"}

    # rows

    @property
    def _columns(self) -> tuple[str, ...]:
        return row_columns(self.sweep.axes, (one.key for one in self.sweep.derived))

    def _known_rows(self) -> Found:
        """Rows that an earlier attempt left, or the table of a finished sweep whose band is to be another."""
        count, header = self.sweep.count, line_of(self._columns)
        found = Found(kind=np.full(count, UNKNOWN), rotation_ratio=np.full(count, np.nan))
        whole = line_of((*self._columns, *band_columns(self.sweep.axes)))
        lines = read_lines(self.place.rows, header) + [
            line_of(fields_of(line)[: len(self._columns)]) for line in read_lines(self.place.table, whole)
        ]
        first = self._columns.index("status")
        ratio = first + FOUND.index("rotation_ratio")
        outcome = first + FOUND.index("outcome")
        for line in lines:
            fields = fields_of(line)
            cell = int(fields[0])
            if cell not in found.lines:
                number = float(fields[ratio]) if fields[ratio] else None
                found.note(cell, line, fields[first], fields[outcome], number)
        return found

    def _compute_rows(self, found: Found, stop: Callable[[], bool]) -> None:
        missing = self.sweep.by_container(set(range(self.sweep.count)) - found.lines.keys())
        with RowLog(self.place.rows, line_of(self._columns)) as log:
            lost = [found.lines[cell] for cell in sorted(found.lines)] if not log.lines else []
            log.append(lost)  # rows of a finished table, to be kept should this be cut off as well
            for cells, rows in self._computed("cells", missing, self.sweep.case, stop):
                lines = [line_of(self._row(cell, row)) for cell, row in zip(cells, rows, strict=True)]
                log.append(lines)
                for cell, line, row in zip(cells, lines, rows, strict=True):
                    found.note(cell, line, row["status"], row["outcome"], row["rotation_ratio"])
                self._note(found)
            log.sync()
        self.place.table.unlink(missing_ok=True)  # that of another band: its rows stand in the log now

    def _row(self, cell: int, row: Row) -> Iterator[Any]:
        point = self.sweep.point(cell)
        yield cell
        yield from point.values()
        if self.sweep.derived:
            try:
                values: Mapping[str, Any] = self.sweep.values(point)
            except CaseError:  # the row has the reason
                values = {}
            yield from (values.get(one.key) for one in self.sweep.derived)
        yield from (row[name] for name in FOUND)

    def _computed(
        self, what: str, items: Sequence[Any], make: Callable[[Any], Case], stop: Callable[[], bool]
    ) -> Iterator[tuple[list[Any], list[Row]]]:
        """Run the cases of some items, model by model; tells how far it has come."""
        total, done, failed = len(items), 0, 0
        self.reporter.start(0.0)
        began = time.perf_counter()
        for model, some in self._by_model(items).items():
            for chunk, rows in run_items(some, make, model, self.workers_of(model, len(some)), stop=stop):
                yield chunk, rows
                done += len(chunk)
                failed += sum(row["status"] == "failed" for row in rows)
                elapsed = time.perf_counter() - began
                self.reporter.tell(lambda: _progress(what, done, total, failed, elapsed))  # noqa: B023
        self.reporter.finish()

    def _by_model(self, items: Sequence[Any]) -> dict[str, list[Any]]:
        """Items by the model of their cells."""
        if all(axis.key != "solver.model" for axis in self.sweep.axes):
            return {self.sweep.base.solver.model: list(items)} if items else {}
        by_model: dict[str, list[Any]] = {}
        for item in items:
            cell = item if isinstance(item, int) else item[0]
            by_model.setdefault(self.sweep.point(cell)["solver.model"], []).append(item)
        return by_model

    # band

    def _perturb(self, found: Found, stop: Callable[[], bool]) -> Band | None:
        """Perturb the cells near a change of outcome, and go on from those that prove unsure."""
        chosen, shape = self.sweep.perturbation.cells, self.sweep.shape
        if chosen == "none" or (chosen == "auto" and self.info["model"] == "full"):
            return None
        band = Band()
        for line in read_lines(self.place.members, line_of(MEMBER_COLUMNS)):
            band.note(line)
        kind = found.kind.reshape(shape)
        ratios = found.rotation_ratio.reshape(shape)
        wanted = near_cells(self.sweep.axes, kind, ratios, self.sweep.perturbation.close)
        if chosen == "all":
            wanted = np.ones(shape, dtype=bool)
        wanted &= (kind == STANDING) | (kind == OVERTURNED)
        seen = np.zeros(shape, dtype=bool)
        with RowLog(self.place.members, line_of(MEMBER_COLUMNS)) as log:
            while wanted.any() and not stop():
                self._run_members(np.flatnonzero(wanted), band, log, stop)
                seen |= wanted
                unsure = self._unsure(found, band, seen)
                wanted = around(self.sweep.axes, unsure) & ~seen
                wanted &= (kind == STANDING) | (kind == OVERTURNED)
            log.sync()
        self.info["perturbed"] = len(band.members)
        return band

    def _unsure(self, found: Found, band: Band, seen: BoolArray) -> BoolArray:
        unsure = np.zeros(seen.size, dtype=bool)
        for cell in np.flatnonzero(seen):
            unsure[cell] = band.is_unsure(int(cell), int(found.kind[cell]))
        return unsure.reshape(seen.shape)

    def _run_members(self, cells: Iterable[int], band: Band, log: RowLog, stop: Callable[[], bool]) -> None:
        """Run the copies of some cells that are not there yet."""
        items = [
            (cell, member)
            for cell in self.sweep.by_container(int(cell) for cell in cells)
            for member in range(len(self.sweep.member_changes(cell)))
            if member not in band.members.get(cell, {})
        ]
        for chunk, rows in self._computed("perturbed copies", items, self.sweep.member_case, stop):
            lines = []
            for (cell, member), row in zip(chunk, rows, strict=True):
                change = self.sweep.member_changes(cell)[member]
                words = " ".join(f"{key}={value!r}" for key, value in change.items())
                lines.append(line_of((cell, member, words, *(row[name] for name in MEMBER_COLUMNS[3:]))))
            log.append(lines)
            for line in lines:
                band.note(line)

    # threshold

    def _refine(self, found: Found, stop: Callable[[], bool]) -> list[tuple[int, Change]] | None:
        """Close in on the changes of outcome along the axis asked for, on all lines of cells at once."""
        wanted = self.sweep.threshold
        if wanted is None:
            return None
        values = self.sweep.threshold_axis.values
        least = least_width(values, wanted.resolution)
        place = self.sweep.axes.index(self.sweep.threshold_axis)
        numbers = np.moveaxis(np.arange(self.sweep.count).reshape(self.sweep.shape), place, -1)
        lines = {
            int(cells[0]): {
                float(value): KIND_NAMES[int(found.kind[cell])]
                for value, cell in zip(values, cells, strict=True)
            }
            for cells in numbers.reshape(-1, len(values))
        }
        with RowLog(self.place.tried, line_of(TRIED_COLUMNS)) as log:
            for line in log.lines:
                fields = fields_of(line)
                kind = kind_of(fields[2], fields[3])
                lines[int(fields[0])][float(fields[1])] = KIND_NAMES[kind]
            while not stop():
                items = [
                    (first, value)
                    for first in self.sweep.by_container(lines)
                    for value in values_to_try(
                        lines[first], resolution=wanted.resolution, inner=wanted.inner, least=least
                    )
                ]
                if not items:
                    break
                for chunk, rows in self._computed("cases between cells", items, self.sweep.tried_case, stop):
                    log.append(
                        [
                            line_of((*item, *(row[name] for name in TRIED_COLUMNS[2:])))
                            for item, row in zip(chunk, rows, strict=True)
                        ]
                    )
                    for (first, value), row in zip(chunk, rows, strict=True):
                        lines[first][value] = KIND_NAMES[kind_of(row["status"], row["outcome"])]
            log.sync()
        return [(first, change) for first in sorted(lines) for change in changes_of(lines[first])]

    def _write_changes(self, changes: list[tuple[int, Change]] | None) -> None:
        if changes is None:
            return
        others = [axis.key for axis in self.sweep.axes if axis is not self.sweep.threshold_axis]
        write_table(
            self.place.thresholds,
            (*others, "low", "high", "value", "below", "above"),
            (
                line_of(
                    (
                        *(self.sweep.point(first)[key] for key in others),
                        *(change.low, change.high, change.value, change.below, change.above),
                    )
                )
                for first, change in changes
            ),
        )
        self.info["changes"] = len(changes)

    # table

    def _write_table(self, found: Found, band: Band | None) -> BoolArray | None:
        shape, axes = self.sweep.shape, self.sweep.axes
        unsure = None
        widths: list[FloatArray] = []
        if band is not None:
            perturbed = np.zeros(self.sweep.count, dtype=bool)
            perturbed[list(band.members)] = True
            perturbed |= (found.kind != STANDING) & (found.kind != OVERTURNED)
            unsure = self._unsure(found, band, perturbed.reshape(shape))
            widths = [band_width(axes, unsure, k).ravel() for k, axis in enumerate(axes) if axis.is_numeric]
            unsure = unsure.ravel()

        columns = band_columns(axes)

        def whole(cell: int) -> str:
            if band is None or unsure is None:
                return found.lines[cell] + "," * len(columns)
            copies = band.members.get(cell, {}).values()
            ratios = [copy.ratio for copy in copies if copy.ratio is not None]
            low = high = None
            if ratios and np.isfinite(found.rotation_ratio[cell]):
                ratios.append(float(found.rotation_ratio[cell]))
                low, high = min(ratios), max(ratios)
            own = (len(copies), unsure[cell], low, high)
            return found.lines[cell] + "," + line_of((*own, *(width[cell] for width in widths)))

        write_table(
            self.place.table,
            (*self._columns, *columns),
            (whole(cell) for cell in range(self.sweep.count)),
        )
        return unsure

    def _note(self, found: Found, *, force: bool = False) -> None:
        """Tell in `sweep.json` how far the sweep has come, now and then."""
        now = time.perf_counter()
        if not force and now - self._noted < NOTE_S:
            return
        self._noted = now
        self.check()
        self.info["rows"] = len(found.lines)
        self.info["outcomes"] = dict(sorted(found.outcomes.items()))
        write_info(self.place, self.info)


def _progress(what: str, done: int, total: int, failed: int, elapsed: float) -> str:
    """The line of progress."""
    rate = done / elapsed if elapsed > 0.0 else 0.0
    left = f"{clock_time((total - done) / rate)} left" if rate > 0.0 else "time left unknown"
    bad = f", {failed} failed" if failed else ""
    return f"{done} of {total} {what}, {rate:.3g} per s, {left}{bad}"
