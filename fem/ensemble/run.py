"""An ensemble from its file to its folder: draws, points, curve or boundary, figures.

The draws are logged as they are ready, so an interrupted ensemble continues where it was; its result depends neither on
that nor on the number of cores.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from fem.batch.axes import AxisResult
from fem.batch.log import LoggedRuns
from fem.batch.motion_set import (
    FloorMotionPair,
    motion_cases,
    motions_left_out,
    read_motion_set,
    write_motions,
)
from fem.batch.runner import Row, Runner
from fem.batch.study import COMPLETED, FAILED, INTERRUPTED, Study, StudyOptions, hash_of, run_study, runner_of
from fem.batch.table import Columns, row_of, table_of_lines, table_of_rows
from fem.case.case import case_hash, to_toml
from fem.case.tables.duration import ends_at_rest, longest_time
from fem.ensemble.answers import ensemble_answer
from fem.ensemble.distributions import RandomChoice
from fem.ensemble.figures import ensemble_figures
from fem.ensemble.plan import Draw, Ensemble, sets_among
from fem.ensemble.result import EnsembleResult
from fem.ensemble.statistics import POINT_COLUMNS, PointRow, count_point, fragility_of
from fem.ensemble.unknown import UnknownInputs
from fem.results.disk import table_bytes
from fem.results.figures import FELL_FIRST, RUN_COLUMNS, SLIPPED, TURNED, Place, columns_of
from fem.results.folder import ResultFolder
from fem.results.kinds import ENSEMBLE
from fem.results.outcome import COUNTED, COUNTED_AS, Ending, counts_of, ending_of

DRAWS = "draws.csv"
#: numbers in a row of draws.csv besides what is drawn, of a point in its files, of a motion: spectrum and measures
OF_A_DRAW, OF_A_POINT, OF_A_MOTION = 3, 50, 200
MOST_COPIED = 100  #: motions of a set that is copied into the results unless the file says otherwise
#: columns of a draw behind what is drawn
SHOWN: Columns = {"outcome": str} | columns_of(Place.KEY) | {key: RUN_COLUMNS[key] for key in FELL_FIRST}


class DrawRows:
    """The rows of the draws so far."""

    def __init__(self, ensemble: Ensemble, unknown: UnknownInputs) -> None:
        self._ensemble, self._unknown = ensemble, unknown
        #: keys that follow the motion of a draw
        self._following = [key for axis in sets_among(ensemble.random) for key in axis.following]
        keys = [f"{quantity.key}{' factor' if quantity.relative else ''}" for quantity in ensemble.random]
        keys += self._following
        numbers: Columns = dict.fromkeys(("point", "draw", "replicate"), int)
        self.columns = numbers | dict.fromkeys((*keys, *unknown.keys), str) | SHOWN
        self.codes = np.full((ensemble.count, ensemble.draws), Ending.UNKNOWN, dtype=np.int8)
        self.slips = np.full(self.codes.shape, np.nan)
        self._lines: dict[tuple[int, int], str] = {}

    def key(self, draw: Draw) -> tuple[Any, ...]:
        """What was drawn."""
        replicate = draw.number // (self._ensemble.draws // self._ensemble.replicates)
        unknown = (draw.unknown.get(key) for key in self._unknown.keys)
        following = (draw.following.get(key) for key in self._following)
        return draw.cell, draw.number, replicate, *draw.values, *following, *unknown

    def note(self, line: str) -> None:
        """Add a line of the log."""
        row, limit = row_of(self.columns, line), self._ensemble.limit_slip_m
        at = row["point"], row["draw"]
        self.codes[at], self.slips[at] = COUNTED[row["outcome"]], row[SLIPPED] or 0.0
        if limit is not None and self.codes[at] == Ending.STANDING and self.slips[at] > limit:
            self.codes[at] = Ending.OVERTURNED
        self._lines[at] = line

    def table(self) -> str:
        """`draws.csv`: a row a draw, in their order."""
        return table_of_lines(self.columns, (line for _, line in sorted(self._lines.items())))

    def by_replicate(self) -> list[dict[str, int]]:
        """How many draws of each replicate stood, overturned and failed, over all points."""
        blocks = self.codes.reshape(len(self.codes), self._ensemble.replicates, -1)
        return [counts_of(block) for block in np.moveaxis(blocks, 1, 0)]

    def missing(self) -> list[Draw]:
        """The draws that have no row."""
        cells = np.flatnonzero((self.codes == Ending.UNKNOWN).any(axis=1)).tolist()
        draws = (draw for cell in cells for draw in self._unknown.draws_at(cell))
        return [draw for draw in draws if self.codes[draw.cell, draw.number] == Ending.UNKNOWN]


def draw_row(row: Row) -> Row:
    """The result of a draw, by the names of `SHOWN`."""
    figures = {key: row[key] for key in (TURNED, SLIPPED)}
    known = {
        key: None if value is None or not np.isfinite(value) else value for key, value in figures.items()
    }
    outcome = {"outcome": COUNTED_AS[ending_of(row["status"], row["outcome"])]}
    return outcome | known | {key: row[key] for key in FELL_FIRST}


def run_ensemble(ensemble: Ensemble, *, folder: Path, **options: Unpack[StudyOptions]) -> EnsembleResult:
    """Compute an ensemble into a folder; raises as `run_study`, and CaseError for bad input."""
    with runner_of(**options) as reader:
        motions = read_motion_set(ensemble.base, sets_among(ensemble.random), reader)
        options["workers_of"] = reader.workers_of
        request = ensemble_hash(ensemble, [motion.case_hash for motion in motions])
        unknown = UnknownInputs(ensemble)
        few = ensemble.replicates <= MOST_COPIED
        copied = motions if ensemble.copy_motions or (ensemble.copy_motions is None and few) else ()
        begun = begun_result(ensemble, unknown, motions, request)
        study = Study(
            kind=ENSEMBLE,
            request=request,
            result=EnsembleResult,
            begun=begun,
            cases=[ensemble.base],
            motions=[motion.case for motion in copied],
            compute=partial(_compute, ensemble, unknown, motions, begun),
            texts={"ensemble.toml": ensemble.text, "base.toml": to_toml(ensemble.base)},
            size=required_disk(ensemble, unknown, copied),
            subject="the ensemble",
            way_out="take fewer draws",
            progress=lambda folder: "its draws so far",
        )
        return run_study(study, folder, **options)


def _compute(
    ensemble: Ensemble,
    unknown: UnknownInputs,
    motions: Sequence[FloorMotionPair],
    begun: EnsembleResult,
    results: ResultFolder,
    runner: Runner,
) -> EnsembleResult:
    """Compute the draws that are missing, count what there is, and write it."""
    draws = DrawRows(ensemble, unknown)
    LoggedRuns(
        what="draws",
        path=results.path / DRAWS,
        columns=draws.columns,
        make=ensemble.of_draws.case,
        model_of=lambda draw: ensemble.base.solver.model,
        key=draws.key,
        note=draws.note,
        logged=draw_row,
    ).run(runner, iter(draws.missing, []))
    complete = (draws.codes != Ending.UNKNOWN).all(axis=1)
    points = [count_point(ensemble, int(k), draws.codes[k], draws.slips[k]) for k in np.flatnonzero(complete)]
    results.check()
    results.write_text("points.csv", csv_of_points(ensemble, points))
    results.write_text(DRAWS, draws.table())
    regions = [point["region"] for point in points]
    result = replace(
        begun,
        status=INTERRUPTED,
        points=tuple(points),
        regions={name: regions.count(name) for name in ("below", "undecided", "above")},
        failed=sum(point["failed"] for point in points),
    )
    if not complete.all():
        return replace(result, missing=f"{len(points)} of {ensemble.count} points have all their draws")
    fragility = fragility_of(ensemble, draws.codes, points)
    for name, svg in ensemble_figures(ensemble, unknown, points, fragility).items():
        results.write_text(f"figures/{name}.svg", svg)
    failed = all(point["failed"] == ensemble.draws for point in points)
    result = replace(result, status=FAILED if failed else COMPLETED, fragility=fragility)
    if motions:
        measures = [
            motion.numbers() | counts for motion, counts in zip(motions, draws.by_replicate(), strict=True)
        ]
        figures = write_motions(results, motions, measures, dict.fromkeys(COUNTED, int), runner)
        result = replace(result, motions=tuple(measures), motion_figures=tuple(figures))
    answer = ensemble_answer(result)
    return replace(result, answer=answer.sentence if answer else None)


def required_disk(
    ensemble: Ensemble, unknown: UnknownInputs, copied: Sequence[FloorMotionPair] = ()
) -> float:
    """Size of the folder of an ensemble [bytes]: the rows of the draws twice, a row a point, motions."""
    columns = OF_A_DRAW + len(ensemble.random) + len(unknown.keys)
    draws = 2 * table_bytes(ensemble.count * ensemble.draws, columns)
    motions = table_bytes(ensemble.replicates if ensemble.motions else 0, OF_A_MOTION)
    motions += sum(path.stat().st_size for motion in copied for path in motion.case.data_files.values())
    return draws + table_bytes(ensemble.count, OF_A_POINT) + motions


def ensemble_hash(ensemble: Ensemble, motions: Sequence[str] | None = None) -> str:
    """A hash, equal for ensembles that give the same result.

    Args:
        motions: hashes of the cases of a set of motions, where they are known.
    """
    request = {
        "base": case_hash(ensemble.base),
        "axes": [[axis.key, list(axis.values)] for axis in ensemble.axes],
        "random": [
            [
                quantity.key,
                quantity.definition if isinstance(quantity, RandomChoice) else quantity.spread.model_dump(),
            ]
            for quantity in ensemble.random
        ],
        "derived": [[derived.key, derived.expression.text] for derived in ensemble.derived],
    }
    if motions is None:
        motions = [case_hash(case) for case in motion_cases(ensemble.base, sets_among(ensemble.random))]
    if motions:
        request["motions"] = list(motions)
    if ensemble.limit_slip_m is None:
        return hash_of(request | _counted(ensemble))
    return hash_of(request | _counted(ensemble) | {"limit_slip_m": ensemble.limit_slip_m})


def _counted(ensemble: Ensemble) -> dict[str, Any]:
    """How the draws are made and counted."""
    names = ("draws", "seed", "sampling", "replicates", "confidence", "probability", "unknown_inputs")
    return {name: getattr(ensemble, name) for name in names}


def begun_result(
    ensemble: Ensemble, unknown: UnknownInputs, motions: Sequence[FloorMotionPair], request: str
) -> EnsembleResult:
    """The part of `ensemble.json` that is known beforehand."""
    return EnsembleResult(
        asked=request,
        ensemble=ensemble.name,
        title=ensemble.title,
        case=ensemble.base.name,
        model=ensemble.base.solver.model,
        duration_s=longest_time(ensemble.base) if not ends_at_rest(ensemble.base) else "auto",
        motion_covered=motions_left_out(ensemble.base, motions),
        axes=tuple(AxisResult(key=axis.key, values=axis.values, unit=axis.unit) for axis in ensemble.axes),
        random={quantity.key: quantity.definition for quantity in ensemble.random},
        derived={derived.key: derived.expression.text for derived in ensemble.derived},
        drawn_over_uncertainty=tuple(unknown.keys),
        held=unknown.held,
        limit_slip_m=ensemble.limit_slip_m,
        **_counted(ensemble),
    )


def csv_of_points(ensemble: Ensemble, points: Sequence[PointRow]) -> str:
    """`points.csv`: a row a point of the axes."""
    columns = dict.fromkeys((axis.key for axis in ensemble.axes), float) | POINT_COLUMNS
    return table_of_rows(columns, points)
