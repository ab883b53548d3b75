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
from fem.results.disk import table_bytes
from fem.results.figures import FELL_FIRST, RUN_COLUMNS, SLIPPED, TURNED, Place, columns_of
from fem.results.folder import ResultFolder
from fem.results.kinds import ENSEMBLE
from fem.results.outcome import COUNTED, COUNTED_AS, Ending, counts_of, ending_of
from fem.study.answers import ensemble_answer
from fem.study.design import Ensemble, Item
from fem.study.driver import COMPLETED, FAILED, Study, StudyOptions, hash_of, run_study, runner_of
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


def run_ensemble(ensemble: Ensemble, *, folder: Path, **options: Unpack[StudyOptions]) -> EnsembleResult:
    """Compute an ensemble into a folder; raises as `run_study`, and CaseError for bad input."""
    with runner_of(**options) as reader:
        motions = read_motion_set(ensemble.base, ensemble.motions, reader)
        options["workers_of"] = reader.workers_of
        copied = [motion.case for motion in motions if ensemble.replicates <= MOST_COPIED]
        begun = begun_result(ensemble, motions)
        numbers = OF_A_DRAW + len(ensemble.random) + len(ensemble.unknown)
        rows = table_bytes(ensemble.count * ensemble.draws, numbers)
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
    codes = np.full((ensemble.count, ensemble.draws), Ending.UNKNOWN, dtype=np.int8)
    slips, limit = np.full(codes.shape, np.nan), ensemble.limit_slip_m
    #: keys that are drawn, and those that follow the motion of a draw
    following = [*ensemble.motions.following] if ensemble.motions else []
    drawn = [*(quantity.key for quantity in ensemble.random), *following]
    keys = [*(f"{one.key}{' factor' * one.spread.relative}" for one in ensemble.random), *following]
    columns: Columns = dict.fromkeys(("point", "draw", "replicate"), int)
    columns |= dict.fromkeys((*keys, *ensemble.unknown), str) | SHOWN

    def key(draw: Item) -> tuple[Any, ...]:
        replicate = draw.draw // (ensemble.draws // ensemble.replicates)
        return *draw[:2], replicate, *map(draw.drawn.get, drawn), *map(draw.unknown.get, ensemble.unknown)

    def shown(row: Row) -> Row:
        known = {name: row[name] if np.isfinite(row[name] or 0.0) else None for name in (TURNED, SLIPPED)}
        outcome = COUNTED_AS[ending_of(row["status"], row["outcome"])]
        return {"outcome": outcome} | known | {name: row[name] for name in FELL_FIRST}

    def note(line: str) -> None:
        row = row_of(columns, line)
        at = row["point"], row["draw"]
        codes[at], slips[at] = COUNTED[row["outcome"]], row[SLIPPED] or 0.0
        if limit is not None and codes[at] == Ending.STANDING and slips[at] > limit:
            codes[at] = Ending.OVERTURNED

    def missing() -> list[Item]:
        cells = np.flatnonzero((codes == Ending.UNKNOWN).any(axis=1)).tolist()
        draws = (draw for cell in cells for draw in ensemble.draws_at(cell))
        return [draw for draw in draws if codes[draw[:2]] == Ending.UNKNOWN]

    named = {"what": "draws", "path": results.path / DRAWS, "columns": columns}
    log = ensemble.runs(**named, key=key, ids=2, note=note, logged=shown)
    log.run(runner, iter(missing, []))
    complete = (codes != Ending.UNKNOWN).all(axis=1)
    points = [count_point(ensemble, int(k), codes[k], slips[k]) for k in np.flatnonzero(complete)]
    results.check()
    of_points = dict.fromkeys(ensemble.axis_keys, float) | POINT_COLUMNS
    results.write("points.csv", table_of_rows(of_points, points))
    results.write(DRAWS, log.table())
    regions = [point["region"] for point in points]
    result = replace(
        begun,
        points=tuple(points),
        regions={name: regions.count(name) for name in ("below", "undecided", "above")},
        failed=sum(point["failed"] for point in points),
    )
    if not complete.all():
        return result.interrupted(f"{len(points)} of {ensemble.count} points have all their draws")
    fragility = fragility_of(ensemble, codes, points)
    for name, svg in ensemble_figures(ensemble, points, fragility).items():
        results.write(f"figures/{name}.svg", svg)
    failed = all(point["failed"] == ensemble.draws for point in points)
    result = replace(result, status=FAILED if failed else COMPLETED, fragility=fragility)
    if motions:
        blocks = codes.reshape(ensemble.count, ensemble.replicates, -1)
        outcomes = [counts_of(block) for block in np.moveaxis(blocks, 1, 0)]
        result = replace(result, **write_motions(results, motions, outcomes, runner))
    answer = ensemble_answer(result)
    return replace(result, answer=answer.sentence if answer else None)


def begun_result(ensemble: Ensemble, motions: Sequence[FloorMotionPair]) -> EnsembleResult:
    """The part of `ensemble.json` that is known beforehand."""
    names = ("draws", "seed", "sampling", "replicates", "confidence", "probability", "unknown_inputs")
    counted = {name: getattr(ensemble, name) for name in names} | {"limit_slip_m": ensemble.limit_slip_m}
    random = [
        [one.key, one.definition if one.choices else one.spread.model_dump()] for one in ensemble.random
    ]
    request = {
        "base": case_hash(ensemble.base),
        "axes": [[axis.key, list(axis.values)] for axis in ensemble.axes],
        "random": random,
        "derived": [[key, expression.text] for key, expression in ensemble.derived.items()],
        "motions": [motion.case_hash for motion in motions],
    }
    axes = tuple(replace(axis, scale="") for axis in ensemble.axes)
    return EnsembleResult(
        **ensemble.asked | counted | {"axes": axes},
        asked=hash_of(request | counted),
        ensemble=ensemble.name,
        motion_covered=motions_left_out(ensemble.base, motions),
        random={quantity.key: quantity.definition for quantity in ensemble.random},
        drawn_over_uncertainty=ensemble.unknown,
    )
