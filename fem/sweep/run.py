"""A sweep, from its file to its table.

cells -> rows -> which are near a change of outcome -> these perturbed -> changes of outcome closed in on -> table,
maps. Everything that was computed lies in a log before the next begins, so that a sweep that was cut off goes on
where it was, and its table does not tell that it ever was.
"""

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.batch.runner import Row
from fem.batch.workers import LocalWorkers, WorkersOf
from fem.case.case import case_hash
from fem.case.validation import CaseError
from fem.results.result_folder import held
from fem.results.run_folder import copy_data_files, naming_what_cannot_be_written
from fem.runtime.arrays import BoolArray
from fem.runtime.identity import program_identity, versions
from fem.runtime.progress import Reporter, SilentReporter
from fem.runtime.signals import interruptible
from fem.runtime.threads import cores
from fem.sweep import perturbed
from fem.sweep.cells import Band, Found
from fem.sweep.executor import Computing
from fem.sweep.folder import SweepFolder, band_hash, open_sweep_folder, sweep_hash, write_info, write_plan
from fem.sweep.maps import draw_maps
from fem.sweep.neighbours import UNKNOWN
from fem.sweep.perturbed import ToldOfCopies, copy_cells
from fem.sweep.plan import Sweep
from fem.sweep.refine import refine, write_changes
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

#: how often `sweep.json` tells how far the sweep has come [s]
NOTE_S = 10.0


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
    with held(folder) as lock, interruptible(reporter) as stop, ExitStack() as stack:
        place = open_sweep_folder(folder, sweep, force=force, resume=resume)
        if place.finished:
            reporter.message(f"{folder} holds this sweep already; --force computes it again")
            return _with_maps(place, sweep)
        work = _Work(
            sweep=sweep,
            place=place,
            computing=Computing(
                sweep=sweep,
                workers_of=workers_of or stack.enter_context(LocalWorkers(jobs)),
                reporter=reporter,
            ),
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
    computing: Computing
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
        band = None if stop() else copy_cells(self.computing, found, self.place.members, stop)
        self.info["perturbed"] = 0 if band is None else len(band.members)
        changes = None if stop() else refine(self.computing, found, self.place.tried, stop)
        if stop():
            self.info["status"] = "interrupted"
        else:
            self.check()
            unsure = self._write_table(found, band)
            if band is not None:
                write_table(self.place.members, perturbed.COLUMNS, band.lines())
            if changes is not None:
                write_changes(self.sweep, changes, self.place.thresholds)
                self.info["changes"] = len(changes)
            self.info["unsure"] = None if unsure is None else int(unsure.sum())
            self.info["status"] = "completed" if self._any_outcome(found) else "failed"
            self.info["maps"] = _draw(self.place, self.sweep)
        self.info["wall_s"] = time.perf_counter() - began
        self._note(found, force=True)
        if self.info["status"] != "interrupted":
            self.place.rows.unlink(missing_ok=True)
        self.computing.reporter.finish()
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
            for cells, rows in self.computing.rows_of("cells", missing, self.sweep.case, stop):
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

    # table

    def _write_table(self, found: Found, band: Band | None) -> BoolArray | None:
        """The whole table; returns which cells are unsure."""
        told = ToldOfCopies(self.sweep, found, band)
        cells = range(self.sweep.count)
        lines = (f"{found.lines[cell]},{line_of(told.of(cell))}" for cell in cells)
        write_table(self.place.table, (*self._columns, *told.columns), lines)
        return told.unsure

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
