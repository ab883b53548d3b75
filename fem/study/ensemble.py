"""An ensemble, from its file to its folder: the draws of each point, counted.

draws -> rows -> points with their intervals -> the fragility curve, figures, answer. The rows are logged as they are
ready, so that an interrupted ensemble continues where it was, to the same files.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from fem.case.case import case_hash, to_toml
from fem.case.tables.duration import ends_at_rest, longest_time
from fem.results.disk import table_bytes
from fem.results.figures import FELL_FIRST, RUN_COLUMNS, SLIPPED, TURNED, Place, columns_of
from fem.results.folder import ResultFolder
from fem.results.kinds import ENSEMBLE
from fem.results.outcome import COUNTED, COUNTED_AS, Ending, counts_of, ending_of
from fem.study.answers import ensemble_answer
from fem.study.design import Ensemble, Item, sets_among
from fem.study.draws import RandomChoice
from fem.study.driver import (
    COMPLETED,
    FAILED,
    INTERRUPTED,
    LoggedRuns,
    Study,
    StudyOptions,
    hash_of,
    run_study,
    runner_of,
)
from fem.study.fragility import POINT_COLUMNS, EnsembleResult, count_point, fragility_of
from fem.study.maps import ensemble_figures
from fem.study.motions import FloorMotionPair, motions_left_out, read_motion_set, write_motions
from fem.study.runner import Row, Runner
from fem.study.table import Columns, row_of, table_of_rows

DRAWS = "draws.csv"
#: numbers in a row of draws.csv besides what is drawn, of a point in its files, of a motion: spectrum and measures
OF_A_DRAW, OF_A_POINT, OF_A_MOTION = 3, 50, 200
MOST_COPIED = 100  #: motions of a set that is copied into the results
#: columns of a draw behind what is drawn
SHOWN: Columns = {"outcome": str} | columns_of(Place.KEY) | {key: RUN_COLUMNS[key] for key in FELL_FIRST}


class _DrawRows:
    """The rows of the draws so far."""

    def __init__(self, ensemble: Ensemble) -> None:
        self._ensemble = ensemble
        #: keys that are drawn, and those that follow the motion of a draw
        self._drawn = [quantity.key for quantity in ensemble.random]
        self._drawn += [key for axis in sets_among(ensemble.random) for key in axis.following]
        keys = [f"{key}{' factor' if key in ensemble.relative else ''}" for key in self._drawn]
        numbers: Columns = dict.fromkeys(("point", "draw", "replicate"), int)
        self.columns = numbers | dict.fromkeys((*keys, *ensemble.unknown), str) | SHOWN
        self.codes = np.full((ensemble.count, ensemble.draws), Ending.UNKNOWN, dtype=np.int8)
        self.slips = np.full(self.codes.shape, np.nan)

    def key(self, draw: Item) -> tuple[Any, ...]:
        """What was drawn."""
        replicate = draw.draw // (self._ensemble.draws // self._ensemble.replicates)
        unknown = (draw.unknown.get(key) for key in self._ensemble.unknown)
        return draw.cell, draw.draw, replicate, *map(draw.drawn.get, self._drawn), *unknown

    def note(self, line: str) -> None:
        """Add a line of the log."""
        row, limit = row_of(self.columns, line), self._ensemble.limit_slip_m
        at = row["point"], row["draw"]
        self.codes[at], self.slips[at] = COUNTED[row["outcome"]], row[SLIPPED] or 0.0
        if limit is not None and self.codes[at] == Ending.STANDING and self.slips[at] > limit:
            self.codes[at] = Ending.OVERTURNED

    def missing(self) -> list[Item]:
        """The draws that have no row."""
        cells = np.flatnonzero((self.codes == Ending.UNKNOWN).any(axis=1)).tolist()
        draws = (draw for cell in cells for draw in self._ensemble.draws_at(cell))
        return [draw for draw in draws if self.codes[draw.cell, draw.draw] == Ending.UNKNOWN]


def _draw_row(row: Row) -> Row:
    """The result of a draw, by the names of `SHOWN`."""
    figures = {key: row[key] for key in (TURNED, SLIPPED)}
    known = {
        key: value if value is not None and np.isfinite(value) else None for key, value in figures.items()
    }
    outcome = COUNTED_AS[ending_of(row["status"], row["outcome"])]
    return {"outcome": outcome} | known | {key: row[key] for key in FELL_FIRST}


def run_ensemble(ensemble: Ensemble, *, folder: Path, **options: Unpack[StudyOptions]) -> EnsembleResult:
    """Compute an ensemble into a folder; raises as `run_study`, and CaseError for bad input."""
    with runner_of(**options) as reader:
        motions = read_motion_set(ensemble.base, sets_among(ensemble.random), reader)
        options["workers_of"] = reader.workers_of
        copied = [motion.case for motion in motions if ensemble.replicates <= MOST_COPIED]
        begun = begun_result(ensemble, motions)
        rows = table_bytes(
            ensemble.count * ensemble.draws, OF_A_DRAW + len(ensemble.random) + len(ensemble.unknown)
        )
        files = sum(path.stat().st_size for case in copied for path in case.data_files.values())
        points = table_bytes(ensemble.count, OF_A_POINT)
        study = Study(
            kind=ENSEMBLE,
            request=begun.asked,
            result=EnsembleResult,
            begun=begun,
            cases=[ensemble.base],
            motions=copied,
            compute=partial(_compute, ensemble, motions, begun),
            texts={"ensemble.toml": ensemble.text, "base.toml": to_toml(ensemble.base)},
            size=2 * rows + points + table_bytes(len(motions), OF_A_MOTION) + files,
            subject="the ensemble",
            way_out="take fewer draws",
            progress=lambda folder: "its draws so far",
        )
        return run_study(study, folder, **options)


def _compute(
    ensemble: Ensemble,
    motions: Sequence[FloorMotionPair],
    begun: EnsembleResult,
    results: ResultFolder,
    runner: Runner,
) -> EnsembleResult:
    """Compute the draws that are missing, count what there is, and write it."""
    draws = _DrawRows(ensemble)
    log = LoggedRuns[Item](
        what="draws",
        path=results.path / DRAWS,
        columns=draws.columns,
        make=ensemble.make.case,
        model_of=ensemble.model_of,
        key=draws.key,
        ids=2,
        note=draws.note,
        logged=_draw_row,
    )
    log.run(runner, iter(draws.missing, []))
    complete = (draws.codes != Ending.UNKNOWN).all(axis=1)
    points = [count_point(ensemble, int(k), draws.codes[k], draws.slips[k]) for k in np.flatnonzero(complete)]
    results.check()
    columns = dict.fromkeys((axis.key for axis in ensemble.axes), float) | POINT_COLUMNS
    results.write("points.csv", table_of_rows(columns, points))
    results.write(DRAWS, log.table())
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
    for name, svg in ensemble_figures(ensemble, points, fragility).items():
        results.write(f"figures/{name}.svg", svg)
    failed = all(point["failed"] == ensemble.draws for point in points)
    result = replace(result, status=FAILED if failed else COMPLETED, fragility=fragility)
    if motions:
        blocks = draws.codes.reshape(ensemble.count, ensemble.replicates, -1)
        outcomes = [counts_of(block) for block in np.moveaxis(blocks, 1, 0)]
        counted: Columns = dict.fromkeys(COUNTED, int)
        result = replace(result, **write_motions(results, motions, outcomes, counted, runner))
    answer = ensemble_answer(result)
    return replace(result, answer=answer.sentence if answer else None)


def begun_result(ensemble: Ensemble, motions: Sequence[FloorMotionPair]) -> EnsembleResult:
    """The part of `ensemble.json` that is known beforehand."""
    names = ("draws", "seed", "sampling", "replicates", "confidence", "probability", "unknown_inputs")
    counted = {name: getattr(ensemble, name) for name in names} | {"limit_slip_m": ensemble.limit_slip_m}
    random = [
        [one.key, one.definition if isinstance(one, RandomChoice) else one.spread.model_dump()]
        for one in ensemble.random
    ]
    request = {
        "base": case_hash(ensemble.base),
        "axes": [[axis.key, list(axis.values)] for axis in ensemble.axes],
        "random": random,
        "derived": [[key, expression.text] for key, expression in ensemble.derived.items()],
        "motions": [motion.case_hash for motion in motions],
    }
    return EnsembleResult(
        asked=hash_of(request | counted),
        ensemble=ensemble.name,
        title=ensemble.title,
        case=ensemble.base.name,
        model=ensemble.base.solver.model,
        duration_s=longest_time(ensemble.base) if not ends_at_rest(ensemble.base) else "auto",
        motion_covered=motions_left_out(ensemble.base, motions),
        axes=tuple(replace(axis, scale="") for axis in ensemble.axes),
        random={quantity.key: quantity.definition for quantity in ensemble.random},
        derived={key: expression.text for key, expression in ensemble.derived.items()},
        drawn_over_uncertainty=ensemble.unknown,
        held=ensemble.held,
        **counted,
    )
