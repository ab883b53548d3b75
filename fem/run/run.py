"""A run in a folder: its files grow with it, and an interrupted one continues.

case -> model (mesh, body, floor, equilibrium) -> step until done -> verdict -> files; then, where they are wanted, the
comparison with the rigid block and the band over unknown inputs.
"""

import importlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from fem.case.case import Case, case_hash, to_toml
from fem.model.container import discretise
from fem.model.geometry import build_container, node_count
from fem.model.model import Model, build_model
from fem.model.motion import build_motions, longest_run
from fem.results.errors import FolderError, FolderLostError, unwritable
from fem.results.folder import ResultFolder, find_result, open_result_folder
from fem.results.history import History, add_analytic_rotation, read_history
from fem.results.kinds import RUN, typed_result
from fem.results.reader import OpenedRun, open_run
from fem.results.run_files import RunFiles, copy_data_files, require_free_names
from fem.results.run_result import RunResult
from fem.run.band import ChangedRunsFile
from fem.run.card import with_words
from fem.run.compute import WantedChecks, add_checks, begun, lacking, resolve, stepped
from fem.run.expected import expected_s, of_its_band_s, say_expected
from fem.run.output import Start, Stopwatch, open_output, read_start
from fem.run.preview import required_disk, size_in_words
from fem.run.summary import plain_summary
from fem.runtime.compilation import compilation_announced
from fem.runtime.memory import CHECKS, FIGURES, RIGID, shortage
from fem.runtime.progress import Reporter
from fem.runtime.signals import ending_at_once, interruptible
from fem.runtime.threads import cores
from fem.solid.nodal_body import advance_body

WAY_ON = "--resume continues from the last checkpoint"


@dataclass(frozen=True, kw_only=True)
class RunOptions(WantedChecks):
    """What the command line asks of a run besides its case."""

    analytic: bool = True
    resume: bool = False
    force: bool = False


def run_case(
    case: Case,
    *,
    case_text: str,
    folder: Path,
    options: RunOptions | None = None,
    reporter: Reporter | None = None,
) -> OpenedRun:
    """Compute a case into a folder.

    A finished run of the same case is not computed again; a rigid check, a band or a margin that it lacks is added.

    Returns:
        The run, read from its folder; `was_stopped` says whether it was interrupted.

    Raises:
        CaseError, MeshError, FolderError: bad input, or no room for the results; nothing is left behind.
        OutputError: the disk is full, the folder was removed; what was written can be read.
    """
    options, reporter, watch = options or RunOptions(), reporter or Reporter(), Stopwatch()
    files, mesh = RunFiles(folder), build_container(case)
    require_free_names(case, RUN, (files.case.name, files.resolved.name))
    motions = build_motions(case)
    case = resolve(case, mesh, motions)  # what is changed later on is this case, too
    request = case_hash(case)
    mark, known = find_result(folder, RUN, request, force=options.force), None
    if mark is not None and mark.get("status") in RUN.finished:
        known = typed_result(RunResult, mark, folder / RUN.mark)
        complete = not lacking(known, case, options) and not _lacks_figures(files, case)
        what = "; --force computes it again" if complete else ", but for what is added now"
        reporter.message(f"{folder} holds this run already{what}")
        if complete:
            return open_run(folder)

    with (
        open_result_folder(
            folder, RUN, request, force=options.force, resume=options.resume, way_on=WAY_ON
        ) as place,
        compilation_announced(reporter.message),
    ):
        if known is None:
            nodes = node_count(mesh, case.solver.order)
            way_out = "set a larger output.fields_s (0: no frames) or output.history_s"
            longest = longest_run(case, *motions)
            size = size_in_words(case, nodes, longest)
            place.require_room(required_disk(case, nodes, longest), size, way_out)
            alone = options.band is False or (case.solver.model == "full" and not options.band)
            seconds = expected_s(case)
            seconds += 0.0 if alone else of_its_band_s(seconds) / cores()
            say_expected(reporter, "the run", seconds)
        with ending_at_once():
            model = build_model(case, discretise(case, mesh), motions=motions)
            advance_body(model.body, model.run, 0.0)  # no step: compiles
        with interruptible(reporter) as stop:
            result = known
            if result is None:
                texts = {files.case.name: case_text, files.resolved.name: to_toml(case)}
                result = _compute_into(
                    place, model, request, texts=texts, watch=watch, reporter=reporter, stop=stop
                )
                result = _store(replace(result, **watch.spent()), case, place)
            # The run is safe before its checks begin, and complete after them.

            def write(text: str) -> None:
                place.check()
                place.write(files.band.name, text)

            members = ChangedRunsFile(files.band, case_hash=request, write=write, message=reporter.warning)
            checked, block = add_checks(
                result, model, lambda: _history_of(files), options, members, reporter=reporter, stop=stop
            )
            if block is not None:
                place.write(files.rigid_check.name, block.table())
                add_analytic_rotation(files.history, block.analytic_rotation)
            if checked is not result:
                if known is None:
                    checked = replace(checked, **watch.spent())
                result = _store(checked, case, place)
            if result is not known or _lacks_figures(files, case):
                _draw(model, place.path, reporter)
    return open_run(folder)


def was_stopped(run: OpenedRun, options: RunOptions) -> bool:
    """Whether the stepping of a run was interrupted, or the band or the margin after it."""
    if run.status in RUN.finished:
        return bool(lacking(run.typed_result, run.case, options) & {"band", "margin"})
    return run.status == "interrupted"


def _compute_into(
    place: ResultFolder,
    model: Model,
    request: str,
    *,
    texts: Mapping[str, str],
    watch: Stopwatch,
    reporter: Reporter,
    stop: Callable[[], bool],
) -> RunResult:
    """Step a model from t = 0, or from its checkpoint, to a verdict; its files grow on the way."""
    files, result = RunFiles(place.path), begun(model, request)
    start = read_start(files, model, request) if place.resuming else Start()
    watch.before = start.spent
    if place.earlier is not None and not place.resuming and files.checkpoint.exists():
        reporter.warning(
            f"{place.path} held this run, unfinished; it begins again at t = 0 s: --resume would have continued it"
        )
    place.begin(result.to_json(), texts, keep=bool(start.arrays))
    try:
        copy_data_files(model.case, place.path)
        with open_output(place, model, request, watch, start) as (recorder, save):
            if start.arrays:
                reporter.message(f"resuming at t = {float(model.run.clock[0].time):.6g} s")
            return stepped(
                model, result, recorder, reporter=reporter, stop=stop, save=save, progress=start.progress
            )[0]
    except OSError as error:  # `run.json` says that it failed where its files cannot be written
        if not isinstance(error, FolderLostError):
            reason = unwritable(place.path, error, WAY_ON)
            with suppress(OSError):
                place.write_result(replace(result, status="failed", error=reason).to_json())
        raise


def _store(result: RunResult, case: Case, place: ResultFolder) -> RunResult:
    """Write the summary, then `run.json` with its warnings: a run that is marked as finished has both.

    Checkpoints are removed after that, when there is nothing left to resume.
    """
    place.check()
    result = with_words(result, case)
    place.write(RunFiles(place.path).summary.name, plain_summary(result, folder=place.path))
    place.write_result(result.to_json())
    if result.status in RUN.finished:
        place.remove("checkpoint.npz")
        if result.verdict is not None and result.verdict.band is not None:
            place.remove("band.json")
    return result


def _draw(model: Model, folder: Path, reporter: Reporter) -> None:
    """Draw the figures of the run in a folder, where they are wanted; they are no part of the result."""
    if not model.case.output.figures:
        return
    if short := shortage(RIGID + CHECKS + FIGURES):
        reporter.message(
            f"figures were not drawn: {short}; the results are complete, and `report` draws them"
        )
        return
    try:  # importing matplotlib takes as long as many a run
        importlib.import_module("fem.figures.cache").write_figures(open_run(folder), model.container)
    except Exception as error:  # a full disk, a history cut short, a fault of the drawing: never the run's
        reporter.message(
            f"figures were not drawn ({type(error).__name__}: {error}); the results are complete"
        )


def _history_of(files: RunFiles) -> History:
    """The samples of a finished run."""
    try:
        return read_history(files.history)
    except (OSError, ValueError) as error:
        raise FolderError(
            f"{files.history}: cannot be compared with the rigid block ({error}); --force repeats the run"
        ) from None


def _lacks_figures(files: RunFiles, case: Case) -> bool:
    return case.output.figures and not files.drawn.is_file()
