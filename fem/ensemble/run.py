"""An ensemble from its file to its folder: draws, points, curve or boundary, figures.

The runs go through the engine of the sweeps. After every batch the folder holds the outcomes there are, so that an
ensemble that was cut off goes on where it was; its result does not depend on that, nor on the number of cores.
"""

import hashlib
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.batch.runner import Row, run_cases
from fem.case.case import case_hash, to_toml
from fem.ensemble.figures import ensemble_figures
from fem.ensemble.plan import Ensemble
from fem.ensemble.statistics import (
    FAILED,
    MISSING,
    OVERTURNED,
    POINT_COLUMNS,
    STOOD,
    PointResult,
    count_point,
    fragility_of,
)
from fem.results.result_folder import COMPLETED, ResultFolder, opened_result_folder, program_of_results
from fem.results.run_folder import FolderError
from fem.runtime.progress import Reporter, SilentReporter, clock_time
from fem.runtime.signals import interruptible

MARK, STATE = "ensemble.json", "state.npz"
OWN = ("points.csv", "draws.csv", "base.toml", "ensemble.toml", STATE, "figures/*.svg")
#: room on the disk: a row of draws.csv without its numbers, a number, what is kept of a draw, a row of points.csv, and
#: figures and pages [bytes]
BYTES_OF_A_DRAW, BYTES_OF_A_NUMBER, BYTES_OF_A_CODE, BYTES_OF_A_POINT, BYTES_BESIDE = (
    45,
    20,
    10,
    1000,
    500_000,
)
BATCH = 512  #: runs between two looks and saves
WORDS = {STOOD: "stood", OVERTURNED: "overturned", FAILED: "failed"}


@dataclass(frozen=True, kw_only=True, eq=False)
class EnsembleResult:
    """What an ensemble came to."""

    status: str  #: completed | interrupted | failed: no draw has an outcome
    result: dict[str, Any]  #: as in ensemble.json
    points: tuple[PointResult, ...]


def run_ensemble(
    ensemble: Ensemble,
    *,
    folder: Path,
    jobs: int | None = None,
    force: bool = False,
    resume: bool = False,
    reporter: Reporter | None = None,
) -> EnsembleResult:
    """Compute an ensemble into a folder; a finished one of the same request is not computed again.

    Raises:
        CaseError, FolderError: bad input.
    """
    reporter = reporter or SilentReporter()
    asked = ensemble_hash(ensemble)
    with (
        opened_result_folder(
            folder,
            mark=MARK,
            kind="ensemble",
            asked=asked,
            own=OWN,
            wanted=required_disk(ensemble),
            force=force,
            resume=resume,
        ) as place,
        interruptible(reporter) as stop,
    ):
        if place.finished is not None:
            reporter.message(f"{folder} holds this ensemble already; --force computes it again")
            return EnsembleResult(status=COMPLETED, result=place.finished, points=())
        place.write_text("ensemble.toml", ensemble.text)
        place.write_text("base.toml", to_toml(ensemble.base))
        codes, ratios = read_state(place, ensemble)
        whole = _run(ensemble, place, codes, ratios, jobs=jobs, stop=stop, reporter=reporter)
        points = [
            count_point(ensemble, cell, codes[cell])
            for cell in range(ensemble.count)
            if (codes[cell] != MISSING).all()
        ]
        status = COMPLETED if whole else "interrupted"
        if whole and all(point.failed == ensemble.draws for point in points):
            status = "failed"
        fragility = fragility_of(ensemble, codes, points) if whole else None
        result = result_of(ensemble, points, fragility, status)
        place.write_text("points.csv", csv_of_points(ensemble, points))
        place.write_text("draws.csv", csv_of_draws(ensemble, codes, ratios))
        if whole:
            for name, svg in ensemble_figures(ensemble, points, fragility).items():
                place.write_text(f"figures/{name}.svg", svg)
        place.write_result(result)
        if status == COMPLETED:
            (place.path / STATE).unlink(missing_ok=True)
    return EnsembleResult(status=status, result=result, points=tuple(points))


def required_disk(ensemble: Ensemble) -> float:
    """What the folder of an ensemble comes to hold [bytes]: a row a draw, the state twice, a row a point, figures."""
    row = BYTES_OF_A_DRAW + BYTES_OF_A_NUMBER * len(ensemble.random)
    return ensemble.count * (ensemble.draws * (row + 2 * BYTES_OF_A_CODE) + BYTES_OF_A_POINT) + BYTES_BESIDE


def ensemble_hash(ensemble: Ensemble) -> str:
    """Equal for ensembles that give the same result."""
    given = {
        "base": case_hash(ensemble.base),
        "axes": [[axis.key, list(axis.values)] for axis in ensemble.axes],
        "random": [[one.key, one.spread.model_dump()] for one in ensemble.random],
        "derived": [[one.key, one.expression.text] for one in ensemble.derived],
    }
    return hashlib.sha256(json.dumps(given | asked_of(ensemble), sort_keys=True).encode()).hexdigest()


def asked_of(ensemble: Ensemble) -> dict[str, Any]:
    """How it is drawn and counted."""
    names = ("draws", "seed", "sampling", "replicates", "confidence", "probability")
    return {name: getattr(ensemble, name) for name in names}


def result_of(
    ensemble: Ensemble, points: Sequence[PointResult], fragility: dict[str, Any] | None, status: str
) -> dict[str, Any]:
    """The content of `ensemble.json`."""
    regions = [point.region for point in points]
    return {
        "status": status,
        "asked": ensemble_hash(ensemble),
        "ensemble": ensemble.name,
        "title": ensemble.title,
        "case": ensemble.base.name,
        "model": ensemble.base.solver.model,
        "duration_s": ensemble.base.solver.duration_s,
        **asked_of(ensemble),
        "axes": [{"key": axis.key, "values": list(axis.values), "unit": axis.unit} for axis in ensemble.axes],
        "random": {
            one.key: one.spread.model_dump(by_alias=True, exclude_none=True) for one in ensemble.random
        },
        "derived": {one.key: one.expression.text for one in ensemble.derived},
        "points": [point.row() for point in points],
        "regions": {name: regions.count(name) for name in ("below", "undecided", "above")},
        "failed": sum(point.failed for point in points),
        "fragility": fragility,
    } | program_of_results()


def page_of(result: dict[str, Any], folder: Path) -> str:
    """What an ensemble found, for people."""
    lines = [
        f"{result['ensemble']}: {result['title']}" if result["title"] else str(result["ensemble"]),
        f"  {len(result['points'])} points x {result['draws']} draws ({result['sampling']}, seed {result['seed']}), "
        f"model {result['model']}, {result['duration_s']:g} s each, {result['status']}",
        f"  random: {', '.join(result['random'])}; not random: the floor's motion itself",
    ]
    for name, count in result["regions"].items():
        lines.append(
            f"  {name:10} {count:>6} points  "
            + {
                "below": f"probability of overturning at most {result['probability']:g}",
                "above": f"more than {result['probability']:g}",
                "undecided": f"the {100.0 * result['confidence']:g} % interval holds {result['probability']:g}",
            }[name]
        )
    if result["failed"]:
        lines.append(f"  failed     {result['failed']:>6} draws, counted against either end of the intervals")
    lines += _fragility_lines(result["fragility"], result["confidence"])
    lines.append(f"  files      {folder}")
    if result["status"] == "interrupted":
        lines.append("  --resume goes on from here")
    return "\n".join(lines)


def csv_of_points(ensemble: Ensemble, points: Sequence[PointResult]) -> str:
    """`points.csv`: a row a point of the axes."""
    names = [*(axis.key for axis in ensemble.axes), *POINT_COLUMNS]
    rows = [point.row() for point in points]
    return (
        "\n".join([",".join(names), *(",".join(_written(row[name]) for name in names) for row in rows)])
        + "\n"
    )


def csv_of_draws(ensemble: Ensemble, codes: np.ndarray, ratios: np.ndarray) -> str:
    """`draws.csv`: a row a draw, with what was drawn (a relative quantity as its factor) and what came of it."""
    keys = [f"{one.key}{' factor' if one.spread.relative else ''}" for one in ensemble.random]
    lines = [",".join(["point", "draw", "replicate", *keys, "outcome", "rotation_ratio"])]
    size = ensemble.draws // ensemble.replicates
    for cell in range(ensemble.count):
        drawn = ensemble.draw(cell)
        for k in np.flatnonzero(codes[cell] != MISSING):
            values = [_written(float(value)) for value in drawn[k]]
            ratio = _written(float(ratios[cell, k])) if np.isfinite(ratios[cell, k]) else ""
            lines.append(
                ",".join([str(cell), str(k), str(k // size), *values, WORDS[int(codes[cell, k])], ratio])
            )
    return "\n".join(lines) + "\n"


def read_state(place: ResultFolder, ensemble: Ensemble) -> tuple[np.ndarray, np.ndarray]:
    """Codes and rotation ratios (points, draws) of the draws so far.

    Raises:
        FolderError: the state is damaged.
    """
    shape = (ensemble.count, ensemble.draws)
    saved = place.read_arrays(STATE)
    if saved is None:
        return np.full(shape, MISSING, dtype=np.int8), np.full(shape, np.nan)
    codes, ratios = saved.get("codes"), saved.get("ratios")
    if codes is None or ratios is None or codes.shape != shape or ratios.shape != shape:
        raise FolderError(f"{place.path / STATE}: damaged; --force computes everything anew")
    return codes, ratios


def code_of(row: Row) -> int:
    """Code of one run; what failed is never one that stood."""
    if row["outcome"] is None:
        return MISSING if row["status"] == "interrupted" else FAILED
    return OVERTURNED if row["outcome"] == "overturned" else STOOD


def _run(
    ensemble: Ensemble,
    place: ResultFolder,
    codes: np.ndarray,
    ratios: np.ndarray,
    *,
    jobs: int | None,
    stop: Callable[[], bool],
    reporter: Reporter,
) -> bool:
    """Run the draws that are missing, into `codes` and `ratios`; whether all are there then."""
    began, missing = time.monotonic(), np.flatnonzero((codes == MISSING).any(axis=1))
    total, per_batch = missing.size, max(1, BATCH // ensemble.draws)
    reporter.start(0.0)
    for first in range(0, total, per_batch):
        cells = missing[first : first + per_batch]
        cases = [case for cell in cells for case in ensemble.cases(int(cell))]
        rows = run_cases(cases, jobs=jobs, stop=stop)
        found = np.array([code_of(row) for row in rows], dtype=np.int8).reshape(len(cells), -1)
        codes[cells] = found
        ratios[cells] = np.array(
            [np.nan if row["rotation_ratio"] is None else row["rotation_ratio"] for row in rows]
        ).reshape(len(cells), -1)
        place.write_arrays(STATE, {"codes": codes, "ratios": ratios})
        if stop():
            break
        done = first + len(cells)
        left = (time.monotonic() - began) * (total / done - 1.0)
        reporter.tell(lambda: f"{done} of {total} points, {clock_time(left)} left")  # noqa: B023
    reporter.finish()
    return bool((codes != MISSING).all())


def _fragility_lines(fragility: dict[str, Any] | None, confidence: float) -> list[str]:
    if fragility is None:
        return []
    lines = [
        f"  falls      from {fall['probability_weaker']:.3f} at {fall['weaker']:g} to "
        f"{fall['probability_stronger']:.3f} at {fall['stronger']:g}: a stronger motion overturns less often"
        for fall in fragility["falls"]
    ]
    fitted = fragility["lognormal"]
    if fitted is None:
        return [*lines, f"  lognormal  none: {fragility['no_lognormal']}"]
    parts = []
    for name in ("median", "deviation"):
        ends = fitted[f"{name}_interval"]
        interval = f" ({ends[0]:.3g} to {ends[1]:.3g})" if ends else ""
        parts.append(f"{name} {fitted[name]:.3g}{interval}")
    fit = "" if fitted["adequate"] else "; the lognormal curve does not describe the counts"
    lines.append(
        f"  lognormal  {', '.join(parts)}; misses {fitted['levels_missed']} of {fitted['levels']} intervals of "
        f"{100.0 * confidence:g} % ({fitted['missed_by_chance']} by chance){fit}"
    )
    return lines


def _written(value: Any) -> str:
    if value is None:
        return ""
    return repr(value) if isinstance(value, float) else str(value)
