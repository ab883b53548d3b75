"""A sweep, from its file to its folder.

cells -> rows -> which are near a change of outcome -> these perturbed -> changes of outcome located -> table, maps.
Every step is logged before the next begins, so an interrupted sweep continues where it was, to the same table.
"""

import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

from fem.case.case import case_hash
from fem.case.tables.unknown_inputs import UncertaintyTable
from fem.case.toml import toml_document
from fem.case.validation import CaseError
from fem.results.disk import table_bytes
from fem.results.folder import ResultFolder
from fem.results.kinds import SWEEP
from fem.run.expected import expected_s, expected_words
from fem.runtime.threads import cores
from fem.runtime.user_files import read_own
from fem.study.answers import answers_csv, fallen_cells_in_words, sweep_answer
from fem.study.design import Item, Sweep
from fem.study.driver import COMPLETED, FAILED, Study, StudyOptions, hash_of, run_study
from fem.study.maps import draw_maps
from fem.study.motions import FloorMotionPair, motions_left_out, read_motion_set
from fem.study.runner import NamedStages, Runner
from fem.study.sure import BETWEEN, COPIES, Copies, RunShown, change_columns, left_out, refine, shown_in
from fem.study.sweep_table import BAND, FOUND, TRIED, WIDTH, SweepResult, open_sweep
from fem.study.table import Columns, fields_of, line_of, read_lines, row_of, table_of_lines, table_of_rows

ROWS, TABLE, MEMBERS = "rows.csv", "table.csv", "members.csv"
THRESHOLDS, ANSWERS = "thresholds.csv", "answers.csv"
CELLS = "cells"  #: the first stage
MOST_CELLS = 1_000_000  #: unless it is forced
OF_A_CELL = 250  #: numbers, in the log, the table, the copies and the maps


def run_sweep(sweep: Sweep, folder: Path, **options: Unpack[StudyOptions]) -> SweepResult:
    """Compute a sweep into a folder; raises as `run_study`, and CaseError for too many cells.

    The rows of a finished sweep are kept where it is to be perturbed or refined in another way; maps over other axes
    are drawn again. `force` also lifts the limit on the number of cells.
    """

    def progress(folder: Path) -> str:
        """How many rows an unfinished sweep has; one without any is no loss."""
        log = folder / ROWS
        rows = read_own(log).count(b"\n") - 1 if log.is_file() else 0
        return f"{rows} of {sweep.count} rows" if rows > 0 else ""

    jobs = options.get("jobs") or cores()
    check_size(sweep, jobs, options.get("force", False))
    motions = read_motion_set(sweep.base, sweep.motions)
    begun = asked_of(sweep, motions, jobs)
    study = Study(
        kind=SWEEP,
        request=begun.sweep_hash,
        result=SweepResult,
        begun=replace(begun, band_hash=None),  # until the copies of another band are gone
        cases=[sweep.base],
        motions=[motion.case for motion in motions],
        compute=partial(_compute, sweep, begun),
        texts={"sweep.toml": sweep.text, "base.toml": toml_document(sweep.base.given())},
        size=table_bytes(sweep.count, OF_A_CELL),
        progress=progress,
        again=partial(_again, sweep, begun),
    )
    return run_study(study, folder, **options)


def check_size(sweep: Sweep, jobs: int, force: bool) -> None:
    """Refuse more cells than anybody asks for on purpose: CaseError with the time and the disk they would take."""
    if sweep.count <= MOST_CELLS or force:
        return
    corners = [expected_s(case) for case in sweep.cases] or [expected_s(sweep.base)]
    seconds = sweep.count * sum(corners) / len(corners) / jobs
    raise CaseError(
        f"{sweep.name}: [axes] make {' x '.join(map(str, sweep.shape))} = {sweep.count} cells, more than {MOST_CELLS}: "
        f"{expected_words(seconds, jobs)}, {table_bytes(sweep.count, OF_A_CELL) / 1e9:.1f} GB on the disk; "
        "take fewer values, or say --force"
    )


def asked_of(sweep: Sweep, motions: Sequence[FloorMotionPair], jobs: int) -> SweepResult:
    """The part of `sweep.json` that is known beforehand."""
    base = sweep.base.model_copy(update={"uncertainty": UncertaintyTable()})  # of the copies alone
    given = {key: value for key, value in base.given().items() if key not in ("title", "uncertainty")}
    rows_asked = [
        case_hash(base),
        toml_document(given),
        [(axis.key, axis.values) for axis in sweep.axes],
        [(key, repr(expression.tree)) for key, expression in sweep.derived.items()],
        [motion.case_hash for motion in motions],
    ]
    band_asked = sweep.perturbation, sweep.base.uncertainty, sweep.threshold, sweep.limit_slip_m
    return SweepResult(
        **sweep.asked,
        sweep=sweep.name,
        sweep_hash=hash_of(rows_asked),
        band_hash=hash_of(repr(band_asked)),
        base_hash=case_hash(sweep.base),
        motion_covered=motions_left_out(sweep.base, motions),
        perturbation=sweep.perturbation.model_dump(),
        uncertainty=sweep.base.uncertainty.model_dump(),
        left_out=left_out(sweep),
        threshold=sweep.threshold.model_dump() if sweep.threshold else None,
        jobs=jobs,
        cells=sweep.count,
        map_axes=sweep.maps.model_dump(),
    )


def _again(
    sweep: Sweep, begun: SweepResult, place: ResultFolder, finished: SweepResult
) -> SweepResult | None:
    """A finished sweep, with maps over the axes that are asked for; None where its band is to be another."""
    if finished.band_hash != begun.band_hash or not (place.path / TABLE).is_file():
        return None
    if finished.map_axes != begun.map_axes:
        finished = replace(
            finished,
            map_axes=begun.map_axes,
            maps=tuple(draw_maps(open_sweep(place.path), place.path / "maps", sweep.maps)),
        )
        place.write_result(finished.to_json())
    return finished


def _compute(sweep: Sweep, begun: SweepResult, place: ResultFolder, runner: Runner) -> SweepResult:
    """Compute what is missing, and write tables and maps."""
    began, stop = time.perf_counter(), runner.stop
    if (place.earlier or {}).get("band_hash") != begun.band_hash:
        place.remove(MEMBERS, TRIED, THRESHOLDS, ANSWERS)
    runs, cells = dict[int, RunShown](), range(sweep.count)
    keys = *sweep.axis_keys, *(key for axis in sweep.axes for key in axis.following)

    def key(item: Item) -> Iterator[Any]:
        """What a row begins with: the values of axes, of what follows them, of derived keys."""
        values: Mapping[str, Any] = {}
        with suppress(CaseError):  # the row has the reason
            values = sweep.make.values(item.point) if sweep.derived else {}
        yield from (item.cell, *map(item.point.get, keys), *map(values.get, sweep.derived))

    def note(line: str) -> None:
        row = row_of(columns, line)
        runs[cells[row["cell"]]] = shown_in(row)

    columns: Columns = {"cell": int} | dict.fromkeys((*keys, *sweep.derived), str) | FOUND
    further = [COPIES] * sweep.has_copies + [BETWEEN] * (sweep.threshold is not None)
    stages = NamedStages([CELLS, *further], runner.reporter)
    own: dict[str, Any] = {"told": stages.begin, "columns": columns, "key": key, "ids": 1, "note": note}
    log = sweep.runs(what=CELLS, path=place.path / ROWS, **own)
    place.write_result(begun.to_json())  # with the hash of the band: copies of another are gone
    with_band = (*columns, *BAND, *(WIDTH + axis.key for axis in sweep.axes if axis.is_numeric))
    table = place.path / TABLE
    if table.exists() and not log.path.exists():  # of a finished sweep, whose band is to be another
        kept = (line_of(fields_of(line)[: len(columns)]) for line in read_lines(table, with_band))
        place.write(ROWS, table_of_lines(columns, kept))
    place.remove(TABLE)
    log.run(runner, [sweep.by_container(cells)])
    copies = Copies(sweep, runs) if sweep.has_copies and not stop() else None
    members = copies.compute(runner, place.path / MEMBERS, stages.begin) if copies else ""
    changes, wanted = None, sweep.threshold
    if wanted is not None and not stop():
        changes = refine(runner, sweep, wanted, runs, place.path / TRIED, stages.begin)
    outcomes = Counter(run.outcome or FAILED for run in runs.values())
    result = replace(begun, rows=len(runs), outcomes=dict(sorted(outcomes.items())))
    if stop():
        words = f"{result.rows} of {sweep.count} cells are computed"
        if result.rows == sweep.count:
            words = "all cells are computed, their copies or the changes between them are not"
        return replace(result.interrupted(words), wall_s=time.perf_counter() - began)
    place.check()
    result = replace(result, status=FAILED if {*outcomes} == {FAILED} else COMPLETED)
    bands: Iterator[tuple[Any, ...]] = iter([(None,) * (len(with_band) - len(columns))] * sweep.count)
    if copies:
        found, bands = copies.band()
        result = replace(result, **found)
        place.write(MEMBERS, members)
    lines = (f"{log.lines[cell,]},{line_of(band)}" for cell, band in enumerate(bands))
    place.write(TABLE, table_of_lines(with_band, lines))
    if changes is not None and wanted is not None:
        place.write(THRESHOLDS, table_of_rows(change_columns(sweep.axes, wanted.axis), changes))
        result = replace(result, changes=len(changes))
    open_table = open_sweep(place.path)
    if answer := sweep_answer(open_table, place.path):
        place.write(ANSWERS, answers_csv(answer))
    result = replace(result, answer=answer.sentence if answer else fallen_cells_in_words(open_table))
    maps = tuple(draw_maps(open_table, place.path / "maps", sweep.maps))
    return replace(result, maps=maps, wall_s=time.perf_counter() - began)
