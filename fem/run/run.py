"""A run, from a case to a verdict and its files.

case -> model (mesh, body, floor, equilibrium) -> step until done -> verdict -> files; then, where they are wanted, the
comparison with the rigid block and the band of the contact.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fem.assessment.joint_demands import joint_demands
from fem.assessment.summary import outcome_sentence, plain_summary
from fem.assessment.verdict import energy_of, numerics_of, verdict_of
from fem.assessment.warnings import warnings_for
from fem.case.case import Case, case_hash, to_toml
from fem.case.rules import ends_at_rest, longest_time
from fem.figures.cache import write_figures
from fem.model.container import discretise
from fem.model.geometry import build_container, node_count
from fem.model.model import Model, build_model
from fem.model.motion import build_motions, longest_run, motion_result, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.model.step_size import largest_step_of
from fem.model.support import normal_penalty
from fem.results.errors import FolderError, FolderLostError, unwritable
from fem.results.folder import ResultFolder, find_result, open_result_folder
from fem.results.history import History
from fem.results.kinds import RUN
from fem.results.reader import open_run
from fem.results.run_files import RunFiles, copy_data_files
from fem.results.run_result import RunResult
from fem.run.checkpoint import CheckpointWriter
from fem.run.checks import WantedChecks, add_checks, lacks_band, lacks_checks
from fem.run.output import Start, Stopwatch, open_output, read_start
from fem.run.setup_cache import SetupCache
from fem.run.simulation import simulate
from fem.run.size import required_disk, size_in_words
from fem.runtime.compilation import compilation_announced
from fem.runtime.identity import versions
from fem.runtime.progress import Reporter, SilentReporter
from fem.runtime.signals import ending_at_once, interruptible
from fem.solid.nodal_body import advance_body
from mesh.container import ContainerMesh

WAY_ON = "--resume continues from the last checkpoint"
SETUP_PARTS = ".setup/part_*.npz"


@dataclass(frozen=True, kw_only=True)
class RunOptions(WantedChecks):
    """What the command line asks of a run besides its case."""

    resume: bool = False
    force: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """A run that has ended, or was interrupted."""

    typed_result: RunResult
    history: History
    stopped: bool = False  #: the stepping was interrupted, or the band after it

    @property
    def status(self) -> str:
        """Status of the run: completed | overturned | failed | interrupted."""
        return self.typed_result.status

    @property
    def result(self) -> dict[str, Any]:
        """As in `run.json`."""
        return self.typed_result.to_json()


def run_case(
    case: Case,
    *,
    case_text: str,
    folder: Path,
    options: RunOptions | None = None,
    reporter: Reporter | None = None,
) -> Run:
    """Compute a case into a folder.

    A finished run of the same case is not computed again; a band or a rigid check that it lacks is added.

    Raises:
        CaseError, MeshError, FolderError: bad input, or no room for the results; nothing is left behind.
        OutputError: the disk is full, the folder was removed; what was written can be read.
    """
    options, reporter, watch = options or RunOptions(), reporter or SilentReporter(), Stopwatch()
    files, mesh = RunFiles(folder), build_container(case)
    files.require_free_names(case)
    resolved = resolve(case, mesh)
    request, history = case_hash(resolved), History.empty()
    known = finished_result(folder, request, options, reporter)
    if known is not None and not lacks_checks(known, case, options) and not _lacks_figures(files, case):
        return Run(typed_result=known, history=history)

    with open_result_folder(
        folder, RUN, request, force=options.force, resume=options.resume, way_on=WAY_ON
    ) as place:
        if known is None:
            nodes = node_count(mesh, case.solver.order)
            way_out = "set a larger output.fields_s (0: no frames) or output.history_s"
            longest = longest_run(case, *build_motions(case))
            size = size_in_words(case, nodes, longest)
            place.require_room(required_disk(case, nodes, longest), size, way_out)
        model = set_up(case, mesh, place, request, force=options.force, reporter=reporter)
        with interruptible(reporter) as stop:
            result = known
            if result is None:
                texts = {files.case.name: case_text, files.resolved.name: to_toml(resolved)}
                result, history = compute(
                    model, place, request, texts=texts, watch=watch, reporter=reporter, stop=stop
                )
                result = store(replace(result, **watch.spent()), case, place)
            # The run is safe before its checks begin, and complete after them.
            checked = add_checks(result, model, place, options, reporter=reporter, stop=stop)
            if checked is not result:
                if known is None:
                    checked = replace(checked, **watch.spent())
                result = store(checked, case, place)
            if result is not known or _lacks_figures(files, case):
                draw(model, place.path, reporter)
    finished = result.status in RUN.finished
    stopped = lacks_band(result, case, options) if finished else result.status == "interrupted"
    return Run(typed_result=result, history=history, stopped=stopped)


def compute(
    model: Model,
    place: ResultFolder,
    request: str,
    *,
    texts: Mapping[str, str],
    watch: Stopwatch,
    reporter: Reporter,
    stop: Callable[[], bool],
) -> tuple[RunResult, History]:
    """Step a model from t = 0, or from its checkpoint, to a verdict; its files grow on the way.

    Args:
        model: at t = 0.
        place: its folder.
        request: hash of the case.
        texts: files that describe the case.
        watch: counts from the checkpoint on.
        stop: called in pauses; true ends the stepping.

    Raises:
        CheckpointError: the checkpoint to resume from does not fit; nothing has been changed then.
    """
    case, files = model.case, RunFiles(place.path)
    start = read_start(files, model, request) if place.resuming else Start()
    watch.before = start.spent
    result = RunResult(
        status="running",
        case=case.name,
        title=case.title,
        case_hash=request,
        static=model.static.to_result(),
        motion=motion_result(case, model.motion, model.vertical),
        versions=versions(),
    )
    place.begin(result.to_json(), texts, keep=start.is_resumed)
    with failure_noted(place, result):
        copy_data_files(case, place.path)
        with open_output(files, model, start) as output:
            recorder = output.recorder
            if start.is_resumed:
                reporter.message(f"resuming at t = {float(model.run.clock[0].time):.6g} s")

            def notes() -> dict[str, Any]:
                place.check()
                return output.sync() | {"spent": watch.spent()}

            save = CheckpointWriter(files.checkpoint, model, recorder, case_hash=request, notes=notes)
            ending = simulate(
                model, recorder, reporter=reporter, stop=stop, save=save, progress=start.state.progress
            )
    history = recorder.history()
    stress = recorder.largest_von_mises if case.solver.model != "rigid" else None
    verdict = verdict_of(model, history, stress)
    result = replace(
        result,
        status=ending.status,
        verdict=verdict if ending.error is None else replace(verdict, outcome=None),
        joints=joint_demands(model, history),
        energy=energy_of(model),
        numerics=numerics_of(model, ending.stepping_cpu_s),
        error=ending.error,
    )
    return result, history


def finished_result(folder: Path, request: str, options: RunOptions, reporter: Reporter) -> RunResult | None:
    """The result of a finished run of this case in a folder, unless it is to be overwritten."""
    found = find_result(folder, RUN, request, force=options.force)
    if found is None or found.get("status") not in RUN.finished:
        return None
    reporter.message(f"{folder} holds this run already; --force computes it again")
    try:
        return RunResult.from_json(found)
    except ValueError as error:
        raise FolderError(f"{folder / RUN.mark}: damaged, {error}; compute it again with --force") from None


@contextmanager
def failure_noted(place: ResultFolder, begun: RunResult) -> Iterator[None]:
    """Let `run.json` say that the run failed where its files cannot be written."""
    try:
        yield
    except OSError as error:
        if not isinstance(error, FolderLostError):
            reason = unwritable(place.path, error, WAY_ON)
            with suppress(OSError):
                place.write_result(replace(begun, status="failed", error=reason).to_json())
        raise


def store(result: RunResult, case: Case, place: ResultFolder) -> RunResult:
    """Write the summary, then `run.json` with its warnings: a run that is marked as finished has both.

    Checkpoints are removed after that, when there is nothing left to resume.
    """
    place.check()
    result = replace(result, warnings=tuple(warnings_for(result, case)))
    if result.verdict is not None:
        first_line = outcome_sentence(result)
        result = replace(result, verdict=replace(result.verdict, first_line=first_line))
    place.write_text(RunFiles(place.path).summary.name, plain_summary(result, folder=place.path))
    place.write_result(result.to_json())
    if result.status in RUN.finished:
        place.remove("checkpoint.npz", SETUP_PARTS)
        if result.verdict is not None and result.verdict.band is not None:
            place.remove("band.json", "members/member_*.npz")
    return result


def draw(model: Model, folder: Path, reporter: Reporter) -> None:
    """Draw the figures of the run in a folder, where they are wanted; they are no part of the result."""
    if not model.case.output.figures:
        return
    try:
        write_figures(open_run(folder), model.container)
    except Exception as error:  # a full disk, a history cut short, a fault of the drawing: never the run's
        reporter.message(
            f"figures were not drawn ({type(error).__name__}: {error}); the results are complete"
        )


def resolve(case: Case, mesh: ContainerMesh) -> Case:
    """The case with every "auto" replaced by the value chosen; running it again gives the same result.

    A duration that depends on when the container comes to rest stays "auto".

    Raises:
        CaseError: a motion that cannot be built, or that the given step would step over.
    """
    chosen: dict[str, Any] = {}
    if case.contact.normal_penalty_Pa_m == "auto":
        chosen["contact.normal_penalty_Pa_m"] = normal_penalty(case, mesh)
    if case.solver.duration_s == "auto" and not ends_at_rest(case):
        chosen["solver.duration_s"] = longest_time(case)
    if case.solver.step_s == "auto":
        motions = build_motions(case)
        static = static_checks_of(case, mesh, *peaks_in_run(case, *motions))
        chosen["solver.step_s"], _ = largest_step_of(case, static, *motions)
    return case.with_values(chosen) if chosen else case


def set_up(
    case: Case, mesh: ContainerMesh, place: ResultFolder, request: str, *, force: bool, reporter: Reporter
) -> Model:
    """Build the model of a case and compile the kernels that step it; arrays that take long are cached in the folder.

    Raises:
        CaseError, MeshError: it cannot be built; the cache is removed then.
    """
    if force:
        place.remove(SETUP_PARTS)
    try:
        with ending_at_once(), compilation_announced(reporter.message):
            cache = SetupCache(place, case_hash=request, reporter=reporter)
            model = build_model(case, discretise(case, mesh, cache))
            advance_body(model.body, model.run, 0.0)  # no step: compiles
    except ValueError:
        place.remove(SETUP_PARTS)
        raise
    return model


def _lacks_figures(files: RunFiles, case: Case) -> bool:
    return case.output.figures and not files.drawn.is_file()
