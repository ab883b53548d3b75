"""A sweep, from its file to its folder.

cells -> rows -> which are near a change of outcome -> these perturbed -> changes of outcome located -> table, maps.
Every step is logged before the next begins, so an interrupted sweep continues where it was, to the same table.
"""

import hashlib
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from fem.assessment.sureness import REGIME_UNSURE, SURE, UNSURE
from fem.batch.axes import with_following
from fem.batch.held import held_inputs
from fem.batch.log import LoggedRuns, fields_of, line_of, read_lines, table_of_lines
from fem.batch.motion_set import FloorMotionPair, motion_cases, motions_left_out, read_motion_set
from fem.batch.runner import Row, Runner
from fem.batch.workers import LocalWorkers, WorkersOf
from fem.case.case import case_hash
from fem.case.rules import ends_at_rest, longest_time
from fem.case.tables import UncertaintyTable
from fem.case.toml import toml_document
from fem.case.validation import CaseError
from fem.results.folder import ResultFolder, open_result_folder, program_of_results
from fem.results.kinds import SWEEP
from fem.results.run_files import copy_data_files
from fem.runtime.progress import Reporter, SilentReporter, clock_time
from fem.runtime.signals import interruptible
from fem.runtime.threads import cores
from fem.sweep import perturbed
from fem.sweep.answers import TRIED, sweep_answer
from fem.sweep.cells import CellRows
from fem.sweep.copies import left_out
from fem.sweep.maps import draw_maps
from fem.sweep.perturbed import PerturbedRows, band_rows, perturb_cells
from fem.sweep.plan import Sweep
from fem.sweep.refine import refine, table_of_changes
from fem.sweep.set_files import write_set
from fem.sweep.table import FOUND, band_columns, open_sweep

ROWS, TABLE, MEMBERS, CHANGES, ANSWERS = (
    "rows.csv",
    "table.csv",
    "members.csv",
    "thresholds.csv",
    "answers.csv",
)
#: how often `sweep.json` is updated [s]
UPDATE_S = 10.0
#: cells that a sweep may have unless it is forced
MOST_CELLS = 1_000_000
#: rough CPU time of a simulated second [s]
SECONDS_PER_SECOND = {"rigid": 3e-4, "reduced": 3e-3, "full": 6.0}
#: room on the disk [bytes]: a cell in the log, the table, the copies and the maps; all else
BYTES_OF_A_CELL, BYTES_BESIDE = 5000, 500_000


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
    """Compute a sweep into a folder; a finished one is not computed again.

    Args:
        jobs: cores to use; all by default. The table does not depend on it.
        workers_of: who computes so many cases of a model, in place of this machine's cores.
        resume: continue with the rows that are there.
        force: overwrite earlier results; also lifts the limit on the number of cells.

    Returns:
        The content of `sweep.json`.

    Raises:
        CaseError: too many cells.
        FolderError: the folder holds something else, or an unfinished sweep (without `resume` or `force`).
        FolderLockedError: another process writes into it.
        WorkersLostError: a worker died; what was computed is kept.
        OutputError: the disk is full, the folder was removed; what was written is kept.
    """
    reporter = reporter or SilentReporter()
    jobs = jobs or cores()
    check_size(sweep, jobs, force)
    motions = read_motion_set(sweep.base, sweep.axes)
    with (
        open_result_folder(folder, SWEEP, sweep_hash(sweep), force=force, resume=resume) as place,
        interruptible(reporter) as stop,
        ExitStack() as stack,
    ):
        found = place.found or {}
        same_band = found.get("band_hash") == band_hash(sweep)
        has_table = place.finished and (folder / TABLE).is_file()
        if has_table and same_band:
            reporter.message(f"{folder} holds this sweep already; --force computes it again")
            return _with_maps(place, found, sweep)
        if not has_table and (rows := _rows_in(folder / ROWS)):
            place.refuse_unfinished(f"{rows} of {sweep.count} rows")
        place.require_same_program()
        place.require_room(
            sweep.count * BYTES_OF_A_CELL + BYTES_BESIDE,
            f"the sweep ({sweep.count} cells)",
            "take fewer values",
        )
        runner = Runner(
            workers_of=workers_of or stack.enter_context(LocalWorkers(jobs)), reporter=reporter, stop=stop
        )
        info = _asked(sweep, motions) | {"jobs": jobs}
        return _Work(sweep=sweep, motions=motions, place=place, runner=runner, info=info).run(
            same_band=same_band
        )


def sweep_hash(sweep: Sweep) -> str:
    """Equal for sweeps whose rows are the same."""
    base = sweep.base.model_copy(update={"uncertainty": UncertaintyTable()})  # of the copies alone
    digest = hashlib.sha256(case_hash(base).encode())
    given = {key: value for key, value in base.given().items() if key not in ("title", "uncertainty")}
    digest.update(toml_document(given).encode())
    digest.update(repr([(axis.key, axis.values) for axis in sweep.axes]).encode())
    digest.update(repr([(one.key, one.expression.tree) for one in sweep.derived]).encode())
    for case in motion_cases(sweep.base, sweep.axes):
        digest.update(case_hash(case).encode())
    return digest.hexdigest()


def band_hash(sweep: Sweep) -> str:
    """Equal for sweeps that are perturbed and refined in the same way."""
    asked = sweep.perturbation, sweep.base.uncertainty, sweep.threshold
    return hashlib.sha256(repr(asked).encode()).hexdigest()


def check_size(sweep: Sweep, jobs: int, force: bool) -> None:
    """Refuse more cells than anybody asks for on purpose.

    Raises:
        CaseError: says how many, and about how long and how much disk they would take.
    """
    if sweep.count <= MOST_CELLS or force:
        return
    axes = {axis.key: axis.values for axis in sweep.axes}
    asked = axes.get("solver.duration_s", (sweep.base.solver.duration_s,))
    durations = [longest_time(sweep.base) if one == "auto" else one for one in asked]
    speeds = [SECONDS_PER_SECOND[one] for one in axes.get("solver.model", (sweep.base.solver.model,))]
    seconds = sweep.count * sum(durations) / len(durations) * sum(speeds) / len(speeds) / jobs
    sizes = " x ".join(str(size) for size in sweep.shape)
    raise CaseError(
        f"{sweep.name}: [axes] make {sizes} = {sweep.count} cells, more than {MOST_CELLS}: about "
        f"{clock_time(seconds)} on {jobs} core{'s' * (jobs > 1)}, {sweep.count * BYTES_OF_A_CELL / 1e9:.1f} GB on the "
        "disk; take fewer values, or say --force"
    )


class _Work:
    """A sweep under way."""

    def __init__(
        self,
        *,
        sweep: Sweep,
        motions: Sequence[FloorMotionPair],
        place: ResultFolder,
        runner: Runner,
        info: dict[str, Any],
    ) -> None:
        self.sweep, self.motions, self.place, self.runner, self.info = sweep, motions, place, runner, info
        self.cells = CellRows(sweep)
        self._began = self._updated = time.perf_counter()

    def run(self, *, same_band: bool) -> dict[str, Any]:
        """Compute what is missing; `same_band`: the copies that are there belong to this sweep."""
        place, stop = self.place, self.runner.stop
        keep = place.found is not None
        if keep and not same_band:
            # The mark first: a kill must not leave the copies of another band beside the hash of this one.
            place.write_result(self.info | {"band_hash": None})
            place.remove(MEMBERS, TRIED, CHANGES, ANSWERS)
        base = toml_document(self.sweep.base.given())
        place.begin(self.info, {"sweep.toml": self.sweep.text, "base.toml": base}, keep=keep)
        copy_data_files(self.sweep.base, place.path)
        for motion in self.motions:
            copy_data_files(motion.case, place.path, read=True)
        self._compute_rows()
        copies = None if stop() else perturb_cells(self.runner, self.sweep, self.cells, place.path / MEMBERS)
        changes = None if stop() else refine(self.runner, self.sweep, self.cells, place.path / TRIED)
        self.info["perturbed"] = 0 if copies is None else len(copies.rows)
        self.info["copies"] = 0 if copies is None else sum(map(len, copies.rows.values()))
        self.info["status"] = "interrupted"
        if not stop():
            place.check()
            self._write_table(copies)
            if copies is not None:
                place.write_text(MEMBERS, table_of_lines(perturbed.COLUMNS, copies.lines()))
            if changes is not None:
                place.write_text(CHANGES, table_of_changes(self.sweep, changes))
                self.info["changes"] = len(changes)
            if self.motions:
                self.info |= write_set(place, self.sweep, self.motions, self.cells)
            self.info["status"] = "failed" if set(self.cells.outcomes) == {"failed"} else "completed"
            self._answer()
            self.info["maps"] = _draw(place, self.sweep)
        self.info["wall_s"] = time.perf_counter() - self._began
        self._update()
        if not stop():
            place.remove(ROWS)
        return self.info

    def _compute_rows(self) -> None:
        """The rows that are missing; those of a finished table whose band is to be another are kept."""
        log, table = self.place.path / ROWS, self.place.path / TABLE
        columns = self.cells.columns
        if table.exists() and not log.exists():
            lines = read_lines(table, (*columns, *band_columns(self.sweep.axes)))
            kept = (line_of(fields_of(line)[: len(columns)]) for line in lines)
            self.place.write_text(ROWS, table_of_lines(columns, kept))
        self.place.remove(TABLE)
        LoggedRuns(
            what="cells",
            path=log,
            columns=columns,
            make=self.sweep.case,
            model_of=self.sweep.model_of,
            values=self._values,
            note=self._note,
        ).run(self.runner, self._missing())

    def _missing(self) -> Iterator[list[int]]:
        yield self.sweep.by_container(set(range(self.sweep.count)) - self.cells.lines.keys())

    def _values(self, cell: int, row: Row) -> Iterator[Any]:
        point = self.sweep.point(cell)
        following = with_following(self.sweep.axes, point)
        yield cell
        yield from point.values()
        yield from (following.get(key) for axis in self.sweep.axes for key in axis.following)
        if self.sweep.derived:
            try:
                values = self.sweep.values(point)
            except CaseError:  # the row has the reason
                values = {}
            yield from (values.get(one.key) for one in self.sweep.derived)
        yield from (row[name] for name in FOUND)

    def _note(self, line: str) -> None:
        self.cells.note(line)
        if time.perf_counter() - self._updated > UPDATE_S:
            self._update()

    def _write_table(self, copies: PerturbedRows | None) -> None:
        columns = band_columns(self.sweep.axes)
        bands = [line_of([None] * len(columns))] * self.sweep.count
        if copies is not None:
            counts, deciding, values = band_rows(self.sweep, self.cells, copies)
            bands = [line_of(values(cell)) for cell in range(self.sweep.count)]
            self.info |= {
                "unsure": counts[UNSURE],
                "sure": {word: counts[word] for word in (SURE, REGIME_UNSURE, UNSURE)},
            }
            self.info["decided_by"] = dict(deciding.most_common())
        lines = (f"{self.cells.lines[cell]},{band}" for cell, band in enumerate(bands))
        self.place.write_text(TABLE, table_of_lines((*self.cells.columns, *columns), lines))

    def _answer(self) -> None:
        answer = sweep_answer(open_sweep(self.place.path), self.place.path)
        self.info["answer"] = answer.sentence if answer else None
        if answer:
            self.place.write_text(ANSWERS, answer.table())

    def _update(self) -> None:
        """Write into `sweep.json` how many rows there are."""
        self._updated = time.perf_counter()
        self.place.check()
        self.info["rows"] = len(self.cells.lines)
        self.info["outcomes"] = dict(sorted(self.cells.outcomes.items()))
        self.place.write_result(self.info)


def _with_maps(place: ResultFolder, info: dict[str, Any], sweep: Sweep) -> dict[str, Any]:
    """A finished sweep; its maps are drawn again if other axes are asked for."""
    asked = sweep.maps.model_dump()
    if info.get("map_axes") != asked:
        info |= {"map_axes": asked, "maps": _draw(place, sweep)}
        place.write_result(info)
    return info


def _draw(place: ResultFolder, sweep: Sweep) -> list[str]:
    return draw_maps(open_sweep(place.path), place.path / "maps", sweep.maps)


def _rows_in(log: Path) -> int:
    """Whole lines below the header."""
    return max(log.read_bytes().count(b"\n") - 1, 0) if log.is_file() else 0


def _asked(sweep: Sweep, motions: Sequence[FloorMotionPair]) -> dict[str, Any]:
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
        "duration_s": longest_time(sweep.base) if not ends_at_rest(sweep.base) else "auto",
        "motion_covered": motions_left_out(sweep.base, motions),
        "axes": [
            {"key": axis.key, "values": axis.values, "scale": axis.scale, "unit": axis.unit}
            | ({"following": dict(axis.following)} if axis.following else {})
            for axis in sweep.axes
        ],
        "derived": {one.key: one.expression.text for one in sweep.derived},
        "held": held_inputs(sweep.ends(), [axis.key for axis in sweep.axes]),
        "perturbation": sweep.perturbation.model_dump(),
        "uncertainty": sweep.base.uncertainty.model_dump(),
        "left_out": left_out(sweep),
        "threshold": sweep.threshold.model_dump() if sweep.threshold else None,
        "cells": sweep.count,
        "rows": 0,
        "outcomes": {},
        "perturbed": 0,
        "copies": 0,
        "unsure": None,
        "sure": None,
        "decided_by": None,
        "changes": None,
        "answer": None,
        "motions": None,
        "motion_set": None,
        "motion_figures": [],
        "map_axes": sweep.maps.model_dump(),
        "maps": [],
        **program_of_results(),
    }
