"""An ensemble from its file to its folder: draws, points, curve or boundary, figures.

The draws are logged as they are ready, so an interrupted ensemble continues where it was; its result depends neither on
that nor on the number of cores.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from fem.batch.answers import table_lines
from fem.batch.axes import MOTION_FILE, Axis
from fem.batch.log import LoggedRuns, fields_of, table_of_lines, table_text
from fem.batch.motion_set import (
    FloorMotionPair,
    motion_cases,
    motions_left_out,
    read_motion_set,
    write_motions,
)
from fem.batch.runner import Row, Runner
from fem.batch.workers import LocalWorkers, WorkersOf
from fem.case.case import case_hash, to_toml
from fem.case.rules import ends_at_rest, longest_time
from fem.ensemble.answers import ensemble_answer
from fem.ensemble.distributions import RandomChoice, RandomQuantity
from fem.ensemble.figures import ensemble_figures
from fem.ensemble.plan import Draw, Ensemble
from fem.ensemble.statistics import (
    POINT_COLUMNS,
    PointResult,
    count_point,
    fragility_of,
)
from fem.ensemble.unknown import UnknownInputs
from fem.results.folder import ResultFolder, open_result_folder, program_of_results
from fem.results.kinds import ENSEMBLE
from fem.results.outcome import COUNTED, Ending, ending_of
from fem.results.run_files import copy_data_files
from fem.runtime.progress import Reporter, SilentReporter
from fem.runtime.signals import interruptible
from fem.runtime.threads import cores

DRAWS = "draws.csv"
#: room on the disk [bytes]: a row of draws.csv without its numbers, a number, a row of points.csv, all else
BYTES_OF_A_DRAW, BYTES_OF_A_NUMBER, BYTES_OF_A_POINT, BYTES_BESIDE = 45, 20, 1000, 500_000
BYTES_OF_A_MOTION = 4000  #: its spectrum and measures
MOST_COPIED = 100  #: motions of a set that is copied into the results unless the file says otherwise
WORDS = {ending: word for word, ending in COUNTED.items()}


class DrawRows:
    """The rows of the draws so far."""

    def __init__(self, ensemble: Ensemble, unknown: UnknownInputs) -> None:
        self._ensemble, self._unknown = ensemble, unknown
        #: keys that follow the motion of a draw
        self._following = [key for axis in sets_of(ensemble) for key in axis.following]
        keys = [f"{one.key}{' factor' if one.relative else ''}" for one in ensemble.random]
        keys += self._following
        self.columns = ("point", "draw", "replicate", *keys, *unknown.keys, "outcome", "rotation_ratio")
        self.codes = np.full((ensemble.count, ensemble.draws), Ending.UNKNOWN, dtype=np.int8)
        self._lines: dict[tuple[int, int], str] = {}

    def values(self, draw: Draw, row: Row) -> tuple[Any, ...]:
        """The row of a draw: what was drawn, and its result."""
        replicate = draw.number // (self._ensemble.draws // self._ensemble.replicates)
        ratio = row["rotation_ratio"]
        known = ratio is not None and np.isfinite(ratio)
        found = WORDS[ending_of(row["status"], row["outcome"])], ratio if known else None
        unknown = (draw.unknown.get(key) for key in self._unknown.keys)
        following = (draw.following.get(key) for key in self._following)
        return draw.cell, draw.number, replicate, *draw.values, *following, *unknown, *found

    def note(self, line: str) -> None:
        """Add a line of the log."""
        cell, number, *_, outcome, _ = fields_of(line)
        self.codes[int(cell), int(number)] = COUNTED[outcome]
        self._lines[int(cell), int(number)] = line

    def table(self) -> str:
        """`draws.csv`: a row a draw, in their order."""
        return table_of_lines(self.columns, (line for _, line in sorted(self._lines.items())))

    def by_replicate(self) -> list[dict[str, int]]:
        """How many draws of each replicate stood, overturned and failed, over all points."""
        blocks = self.codes.reshape(len(self.codes), self._ensemble.replicates, -1)
        return [
            {word: int((block == code).sum()) for word, code in COUNTED.items()}
            for block in np.moveaxis(blocks, 1, 0)
        ]

    def missing(self) -> list[Draw]:
        """The draws that have no row."""
        cells = np.flatnonzero((self.codes == Ending.UNKNOWN).any(axis=1)).tolist()
        draws = (draw for cell in cells for draw in self._unknown.draws_at(cell))
        return [draw for draw in draws if self.codes[draw.cell, draw.number] == Ending.UNKNOWN]


def run_ensemble(
    ensemble: Ensemble,
    *,
    folder: Path,
    jobs: int | None = None,
    workers_of: WorkersOf | None = None,
    force: bool = False,
    resume: bool = False,
    reporter: Reporter | None = None,
) -> dict[str, Any]:
    """Compute an ensemble into a folder; a finished one of the same request is not computed again.

    Args:
        jobs: cores to use; all by default.
        workers_of: who computes so many draws of a model, in place of this machine's cores.

    Returns:
        The content of `ensemble.json`.

    Raises:
        CaseError, FolderError: bad input, or an unfinished ensemble (without `resume` or `force`).
        WorkersLostError: a worker died; what was computed is kept.
        OutputError: the disk is full, the folder was removed; what was written is kept.
    """
    reporter = reporter or SilentReporter()
    with ExitStack() as stack:
        workers_of = workers_of or stack.enter_context(LocalWorkers(jobs or cores()))
        reader = Runner(workers_of=workers_of, reporter=reporter)
        motions = read_motion_set(ensemble.base, sets_of(ensemble), reader)
        asked = ensemble_hash(ensemble, [one.case_hash for one in motions])
        place = stack.enter_context(open_result_folder(folder, ENSEMBLE, asked, force=force, resume=resume))
        runner = replace(reader, stop=stack.enter_context(interruptible(reporter)))
        if place.finished and place.found:
            reporter.message(f"{folder} holds this ensemble already; --force computes it again")
            return place.found
        place.refuse_unfinished("its draws so far")
        if place.resuming:
            place.require_same_program()
        return _run(ensemble, motions, asked, place, runner)


def _run(
    ensemble: Ensemble,
    motions: Sequence[FloorMotionPair],
    asked: str,
    place: ResultFolder,
    runner: Runner,
) -> dict[str, Any]:
    """Compute the draws that are missing."""
    unknown = UnknownInputs(ensemble)
    copied = motions if _is_copied(ensemble) else ()
    room = required_disk(ensemble, unknown, copied)
    place.require_room(room, "the ensemble", "take fewer draws")
    texts = {"ensemble.toml": ensemble.text, "base.toml": to_toml(ensemble.base)}
    place.begin({"status": "running", "asked": asked} | program_of_results(), texts)
    copy_data_files(ensemble.base, place.path)
    for motion in copied:
        copy_data_files(motion.case, place.path, read=True)
    draws = DrawRows(ensemble, unknown)
    LoggedRuns(
        what="draws",
        path=place.path / DRAWS,
        columns=draws.columns,
        make=ensemble.of_draws.case,
        model_of=lambda draw: ensemble.base.solver.model,
        values=draws.values,
        note=draws.note,
    ).run(runner, iter(draws.missing, []))
    return _finish(ensemble, unknown, motions, asked, place, draws, runner)


def _finish(
    ensemble: Ensemble,
    unknown: UnknownInputs,
    motions: Sequence[FloorMotionPair],
    asked: str,
    place: ResultFolder,
    draws: DrawRows,
    runner: Runner,
) -> dict[str, Any]:
    """Count what there is, and write it."""
    complete = (draws.codes != Ending.UNKNOWN).all(axis=1)
    points = [count_point(ensemble, int(k), draws.codes[k]) for k in np.flatnonzero(complete)]
    status, fragility = "interrupted", None
    if complete.all():
        status = "failed" if all(point.failed == ensemble.draws for point in points) else "completed"
        fragility = fragility_of(ensemble, draws.codes, points)
    place.check()
    place.write_text("points.csv", csv_of_points(ensemble, points))
    place.write_text(DRAWS, draws.table())
    if complete.all():
        for name, svg in ensemble_figures(ensemble, unknown, points, fragility).items():
            place.write_text(f"figures/{name}.svg", svg)
    result = result_of(ensemble, unknown, motions, asked, points, fragility, status)
    if motions and complete.all():
        measures = [one.numbers() | found for one, found in zip(motions, draws.by_replicate(), strict=True)]
        figures = write_motions(place, motions, measures, runner)
        result |= {"motions": measures, "motion_figures": figures}
    answer = ensemble_answer(result)
    result["answer"] = answer.sentence if answer else None
    place.write_result(result)
    return result


def _is_copied(ensemble: Ensemble) -> bool:
    """Whether the motions of the set are copied into the results."""
    return ensemble.replicates <= MOST_COPIED if ensemble.copy_motions is None else ensemble.copy_motions


def required_disk(
    ensemble: Ensemble, unknown: UnknownInputs, copied: Sequence[FloorMotionPair] = ()
) -> float:
    """Size of the folder of an ensemble [bytes]: the rows of the draws twice, a row a point, motions, figures."""
    row = BYTES_OF_A_DRAW + BYTES_OF_A_NUMBER * (len(ensemble.random) + len(unknown.keys))
    motions = BYTES_OF_A_MOTION * ensemble.replicates if ensemble.motions else 0
    motions += sum(path.stat().st_size for one in copied for path in one.case.data_files.values())
    return ensemble.count * (2 * ensemble.draws * row + BYTES_OF_A_POINT) + motions + BYTES_BESIDE


def ensemble_hash(ensemble: Ensemble, motions: Sequence[str] | None = None) -> str:
    """Equal for ensembles that give the same result.

    Args:
        motions: hashes of the cases of a set of motions, where they are known.
    """
    given = {
        "base": case_hash(ensemble.base),
        "axes": [[axis.key, list(axis.values)] for axis in ensemble.axes],
        "random": [[one.key, _hashed(one)] for one in ensemble.random],
        "derived": [[one.key, one.expression.text] for one in ensemble.derived],
    }
    if motions is None:
        motions = [case_hash(case) for case in motion_cases(ensemble.base, sets_of(ensemble))]
    if motions:
        given["motions"] = list(motions)
    return hashlib.sha256(json.dumps(given | asked_of(ensemble), sort_keys=True).encode()).hexdigest()


def sets_of(ensemble: Ensemble) -> list[Axis]:
    """The set of motions that is drawn, as a list of one or none."""
    return [] if ensemble.motions is None else [ensemble.motions]


def _hashed(one: RandomQuantity | RandomChoice) -> Any:
    return one.asked if isinstance(one, RandomChoice) else one.spread.model_dump()


def asked_of(ensemble: Ensemble) -> dict[str, Any]:
    """How the draws are made and counted."""
    names = ("draws", "seed", "sampling", "replicates", "confidence", "probability", "unknown_inputs")
    return {name: getattr(ensemble, name) for name in names}


def result_of(
    ensemble: Ensemble,
    unknown: UnknownInputs,
    motions: Sequence[FloorMotionPair],
    asked: str,
    points: Sequence[PointResult],
    fragility: dict[str, Any] | None,
    status: str,
) -> dict[str, Any]:
    """The content of `ensemble.json`."""
    regions = [point.region for point in points]
    return {
        "status": status,
        "asked": asked,
        "ensemble": ensemble.name,
        "title": ensemble.title,
        "case": ensemble.base.name,
        "model": ensemble.base.solver.model,
        "duration_s": longest_time(ensemble.base) if not ends_at_rest(ensemble.base) else "auto",
        "motion_covered": motions_left_out(ensemble.base, motions),
        **asked_of(ensemble),
        "axes": [{"key": axis.key, "values": list(axis.values), "unit": axis.unit} for axis in ensemble.axes],
        "random": {one.key: one.asked for one in ensemble.random},
        "derived": {one.key: one.expression.text for one in ensemble.derived},
        "drawn_over_uncertainty": list(unknown.keys),
        "held": unknown.held,
        "motions": None,
        "motion_figures": [],
        "points": [point.row() for point in points],
        "regions": {name: regions.count(name) for name in ("below", "undecided", "above")},
        "failed": sum(point.failed for point in points),
        "fragility": fragility,
    } | program_of_results()


def _of_motions(result: dict[str, Any]) -> str:
    """What is random about the floor's motion."""
    count = len(result["random"].get(MOTION_FILE, ()))
    if not count:
        return "the floor's motion is not random"
    return f"the intervals are those of a sample of {count} motions"


def _each(duration: float | str) -> str:
    return "to rest" if isinstance(duration, str) else f"{duration:g} s"


def page_of(result: dict[str, Any], folder: Path) -> str:
    """The result of an ensemble as text."""
    lines = [
        f"{result['ensemble']}: {result['title']}" if result["title"] else str(result["ensemble"]),
        f"  {len(result['points'])} points x {result['draws']} draws ({result['sampling']}, seed {result['seed']}), "
        f"model {result['model']}, {_each(result['duration_s'])} each, {result['status']}",
        *([f"  under {result['motion_covered']}"] if result.get("motion_covered") else []),
        f"  random: {', '.join(result['random'])}; {_of_motions(result)}",
    ]
    if drawn := result.get("drawn_over_uncertainty"):
        lines.append(f"  drawn over [uncertainty]: {', '.join(drawn)}")
    if held := result.get("held"):
        lines.append(f"  held: {held}")
    words = region_words(result)
    for name, count in result["regions"].items():
        lines.append(f"  {name:10} {count:>6} points  {words[name]}")
    if result["failed"]:
        lines.append(
            f"  failed     {result['failed']:>6} draws; the intervals allow for either outcome of these"
        )
    lines += [f"  {name:10} {line}" for name, line in fragility_lines(result)]
    lines.append(f"  files      {folder}")
    if result["status"] == "interrupted":
        lines.append("  --resume continues")
    if answer := ensemble_answer(result):
        lines += table_lines(answer.lines())
        lines.append(answer.sentence)
    return "\n".join(lines)


def csv_of_points(ensemble: Ensemble, points: Sequence[PointResult]) -> str:
    """`points.csv`: a row a point of the axes."""
    names = [*(axis.key for axis in ensemble.axes), *POINT_COLUMNS]
    rows = [point.row() for point in points]
    return table_text(names, ([row[name] for name in names] for row in rows))


def region_words(result: Mapping[str, Any]) -> dict[str, str]:
    """The regions in words."""
    limit = f"{result['probability']:g}"
    return {
        "below": f"probability of overturning at most {limit}",
        "undecided": f"the {100.0 * result['confidence']:g} % interval holds {limit}",
        "above": f"more than {limit}",
    }


def fragility_lines(result: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Where the curve falls, and the lognormal curve: name and words; nothing where there is no curve."""
    fragility = result["fragility"]
    if fragility is None:
        return
    for fall in fragility["falls"]:
        yield (
            "falls",
            f"from {fall['probability_weaker']:.3f} at {fall['weaker']:g} to {fall['probability_stronger']:.3f} at "
            f"{fall['stronger']:g}: a stronger motion overturns less often",
        )
    fitted = fragility["lognormal"]
    if fitted is None:
        yield "lognormal", f"none: {fragility['no_lognormal']}"
        return
    parts = []
    for name, unit in (("median", result["axes"][0]["unit"]), ("deviation", "")):
        ends = fitted[f"{name}_interval"]
        interval = f" ({ends[0]:.3g} to {ends[1]:.3g})" if ends else ""
        parts.append(f"{name} {fitted[name]:.3g}{interval} {unit}".rstrip())
    fit = "" if fitted["adequate"] else "; the lognormal curve does not describe the counts"
    yield (
        "lognormal",
        f"{', '.join(parts)}; misses {fitted['levels_missed']} of {fitted['levels']} intervals of "
        f"{100.0 * result['confidence']:g} % ({fitted['missed_by_chance']} by chance){fit}",
    )
