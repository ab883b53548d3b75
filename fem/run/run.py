"""A run, from a case to a verdict and its files.

case -> model (mesh, body, floor, settled) -> step until done -> history -> verdict -> outputs; then, where
they are wanted, the comparison with the rigid block and the band over the contact.
"""

import contextlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fem.assessment.joint_demands import joint_demands
from fem.assessment.summary import plain_summary
from fem.assessment.verdict import energy_of, numerics_of, verdict_of
from fem.assessment.warnings import warnings_for
from fem.case.case import Case, CaseError, case_hash, to_toml
from fem.figures.cache import write_figures
from fem.model.container import discretise
from fem.model.geometry import build_container, node_count
from fem.model.model import Model, build_model, checks_of
from fem.model.motion import build_motion, motion_notes
from fem.model.recovery import Frame, recovery_of
from fem.model.step_size import largest_step_of
from fem.model.support import normal_penalty
from fem.results.disk import require_room
from fem.results.fields import FieldWriter
from fem.results.history import History, HistoryWriter, read_history
from fem.results.kinds import RUN
from fem.results.lock import FolderLock, FolderLostError
from fem.results.reader import open_run
from fem.results.result_folder import held
from fem.results.run_folder import (
    FINISHED,
    OutputError,
    RunFolder,
    copy_data_files,
    finished_run,
    open_run_folder,
)
from fem.results.run_result import MotionResult, RunResult
from fem.run.checkpoint import CheckpointKeeper, put_back
from fem.run.checks import WantedChecks, add_checks, lacks_band, lacks_checks
from fem.run.recorder import Recorder
from fem.run.run_resumption import RunBeginning, Spent, beginning_in, clock_readings, settling, spent_since
from fem.run.setup_cache import PartFolder
from fem.run.simulation import Ending, simulate
from fem.run.size import required_disk, size_in_words
from fem.runtime.arrays import FloatArray
from fem.runtime.compilation import compilation_announced
from fem.runtime.identity import versions
from fem.runtime.progress import Reporter, SilentReporter
from fem.runtime.signals import ending_at_once, interruptible
from fem.solid.nodal_body import advance_body
from mesh.container import ContainerMesh


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
    stopped: bool = False  #: the stepping was interrupted, or the band behind it

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
        CaseError, MeshError, FolderError, FolderLockedError, CheckpointError: bad input, or no room for the
            results; nothing is left behind.
        OutputError: the disk is full, the folder was removed; what was written can be read.
    """
    options, reporter = options or RunOptions(), reporter or SilentReporter()
    began = clock_readings()
    mesh = build_container(case)
    resolved = resolve(case, mesh)
    mark, place = case_hash(resolved), RunFolder(path=folder)
    require_names_of_their_own(case, place)
    found = finished_run(folder, case_hash=mark, force=options.force)
    if found is not None:
        reporter.message(f"{folder} holds this run already; --force computes it again")
    if found is not None and _is_whole(found, place, case, options):
        return Run(typed_result=RunResult.from_json(found), history=History.empty())
    if found is None:
        nodes = node_count(mesh, case.solver.order)
        require_room(
            folder,
            required_disk(case, nodes),
            size_in_words(case, nodes),
            "set a larger output.fields_s (0: no frames) or output.history_s",
            RUN.own,
        )
    beginning = RunBeginning()

    with ExitStack() as stack:
        lock = stack.enter_context(held(folder))
        stack.enter_context(compilation_announced(reporter.message))
        model = _set_up(case, mesh, place, lock, mark, force=options.force, reporter=reporter)
        stop = stack.enter_context(interruptible(reporter))

        def inspect(place: RunFolder) -> None:
            nonlocal beginning
            beginning = beginning_in(place, model, mark)

        place = open_run_folder(
            folder,
            case_text=case_text,
            resolved_text=to_toml(resolved),
            case_hash=mark,
            force=options.force,
            resume=options.resume,
            inspect=inspect,
        )
        result: dict[str, Any] = {}
        with naming_what_failed(place, result):
            if place.finished is not None:
                before = RunResult.from_json(place.finished)
                checked = add_checks(before, model, place, lock, options, reporter=reporter, stop=stop)
                if checked is not before:
                    checked = store(checked, case, place)
                if checked is not before or not place.drawn.is_file():
                    draw(model, place, reporter)
                return Run(
                    typed_result=checked,
                    history=History.empty(),
                    stopped=_was_stopped(checked, case, options),
                )
            copy_data_files(case, place.path)
            started = RunResult(
                status="running",
                case=case.name,
                title=case.title,
                case_hash=mark,
                static=model.static.to_result(),
                motion=MotionResult(notes=tuple(motion_notes(model.motion))),
                versions=versions(),
            )
            result |= started.to_json()
            place.write_result(result)
            ending, recorder = _step_into(place, lock, model, reporter, stop, beginning, mark, began)
            result["status"] = ending.status

            def stored(done: RunResult) -> RunResult:
                spent = spent_since(began, beginning.spent)
                lock.check()
                return store(replace(done, **asdict(spent)), case, place)

            # The run is safe before its checks begin, and whole after them.
            done = stored(with_outcome(started, model, recorder, ending))
            checked = add_checks(done, model, place, lock, options, reporter=reporter, stop=stop)
            if checked is not done:
                done = stored(checked)
            draw(model, place, reporter)
    return Run(
        typed_result=done,
        history=recorder.history(),
        stopped=_was_stopped(done, case, options),
    )


@contextmanager
def naming_what_failed(place: RunFolder, result: dict[str, Any]) -> Iterator[None]:
    """Turn a disk that is full, or a folder that is gone, into a message and a failed run.

    Raises:
        OutputError: in the place of an OSError.
    """
    try:
        yield
    except OSError as error:
        reason = (
            f"{error.filename or place.path}: cannot be written ({error.strerror or error}); what was written "
            "before can be read; when there is room again, --resume goes on from the last checkpoint"
        )
        if result.get("status") == "running" and not isinstance(error, FolderLostError):
            with contextlib.suppress(OSError):
                place.write_result(result | {"status": "failed", "error": reason})
        raise OutputError(reason) from None


def store(result: RunResult, case: Case, place: RunFolder) -> RunResult:
    """Write the summary, then `run.json` with its warnings: a run that says it is finished has both.

    What was kept to go on with goes when nothing is left to go on with, and not before that is written.
    """
    result = replace(result, warnings=tuple(warnings_for(result.to_json(), case)))
    page = result.to_json()
    place.write_summary(
        plain_summary(page, title=case.title or case.name, folder=place.path, warnings=page["warnings"])
    )
    place.write_result(page)
    if result.status in FINISHED:
        place.remove_checkpoint()
        place.remove_setup()
        if result.verdict is not None and result.verdict.band is not None:
            place.remove_band()
    return result


def draw(model: Model, place: RunFolder, reporter: Reporter) -> None:
    """Draw the figures of what the folder holds, where they are wanted; a run stands without them."""
    if not model.case.output.figures:
        return
    try:
        write_figures(open_run(place.path), model.container)
    except Exception as error:  # a full disk, a history cut short, a fault of the drawing: never the run's
        reporter.message(f"figures were not drawn ({type(error).__name__}: {error}); the results are whole")


def _was_stopped(result: RunResult, case: Case, options: RunOptions) -> bool:
    """Whether the stepping, or the band behind it, was interrupted."""
    if result.status in FINISHED:
        return lacks_band(result, case, options)
    return result.status == "interrupted"


def _is_whole(result: dict[str, Any], place: RunFolder, case: Case, options: RunOptions) -> bool:
    """Whether a finished run has the checks that are wanted, and its figures."""
    return not lacks_checks(RunResult.from_json(result), case, options) and (
        place.drawn.is_file() or not case.output.figures
    )


def with_outcome(result: RunResult, model: Model, recorder: Recorder, ending: Ending) -> RunResult:
    """The result with the blocks that the stepping fills."""
    rigid, history = model.case.solver.model == "rigid", recorder.history()
    verdict = verdict_of(model, history, None if rigid else recorder.largest_von_mises)
    return replace(
        result,
        status=ending.status,
        verdict=verdict if ending.error is None else replace(verdict, outcome=None),
        joints=joint_demands(model, history),
        energy=energy_of(model),
        numerics=numerics_of(model, ending.stepping_cpu_s),
        error=ending.error,
    )


def resolve(case: Case, mesh: ContainerMesh) -> Case:
    """The case with every "auto" replaced by what is chosen; running it again gives the same result.

    Raises:
        CaseError: a motion that cannot be built, or that the step given would step over.
    """
    chosen: dict[str, Any] = {}
    if case.contact.normal_penalty_Pa_m == "auto":
        chosen["contact.normal_penalty_Pa_m"] = normal_penalty(case, mesh)
    if case.solver.step_s == "auto":
        motion = build_motion(case)
        chosen["solver.step_s"], _ = largest_step_of(case, checks_of(case, mesh, motion), motion)
    return case.with_values(chosen) if chosen else case


def _set_up(
    case: Case,
    mesh: ContainerMesh,
    place: RunFolder,
    lock: FolderLock,
    case_hash: str,
    *,
    force: bool,
    reporter: Reporter,
) -> Model:
    """The model of a case, and the kernels that step it; what of it takes long is kept in the folder.

    Raises:
        CaseError, MeshError: it cannot be built; nothing is kept of it then.
    """
    if force:
        place.remove_setup()
    try:
        with ending_at_once():
            parts = PartFolder(place, lock, case_hash=case_hash, reporter=reporter)
            model = build_model(case, discretise(case, mesh, parts))
            advance_body(model.body, model.run, 0.0)  # no step: compiled, where that has not been done
    except ValueError:
        place.remove_setup()
        raise
    return model


def require_names_of_their_own(case: Case, place: RunFolder) -> None:
    """Refuse a mesh or motion file whose copy would lie where results are written.

    Raises:
        CaseError: with the key and the name.
    """
    for key, path in case.data_files.items():
        name = path.relative_to(case.folder)
        if place.path / name.parts[0] in place.own:
            table, _, word = key.partition(".")
            raise CaseError(
                f"[{table}] {word} is named {str(name)!r}, as a result of the run is, which would take its place "
                "in the folder of results; give the file another name"
            )


def _step_into(
    place: RunFolder,
    lock: FolderLock,
    model: Model,
    reporter: Reporter,
    stop: Callable[[], bool],
    beginning: RunBeginning,
    case_hash: str,
    began: Spent,
) -> tuple[Ending, Recorder]:
    """Step the model; history, fields and checkpoints go into the folder as they come."""
    with ExitStack() as stack:
        history = stack.enter_context(
            HistoryWriter(
                place.history, position=beginning.history_bytes, joints=model.case.container.boxes - 1
            )
        )
        fields, frame_sink = None, None
        if model.case.output.fields_s > 0.0:
            elements = model.container.elements
            fields = FieldWriter(
                place.fields,
                points=elements.nodes,
                cells=elements.cells,
                region=elements.region.astype(np.int64),
                kept_times=beginning.frames_s,
            )
            stack.callback(fields.close)
            frame_sink = _frame_writer(fields)
        recorder = Recorder(model, recovery_of(model), history.append, frame_sink)
        simulation = beginning.simulation
        if simulation.arrays is not None:
            put_back(model, recorder, simulation.arrays)
            recorder.go_on(read_history(place.history))
            reporter.message(f"going on at t = {float(model.run.clock[0].time):.6g} s")
        keeper = CheckpointKeeper(
            place.checkpoint,
            case_hash=case_hash,
            model=model,
            recorder=recorder,
            settle=settling(lock, history, fields, before=beginning.spent, began=began),
        )
        ending = simulate(
            model, recorder, reporter=reporter, stop=stop, keeper=keeper, progress=simulation.progress
        )
        return ending, recorder


def _frame_writer(fields: FieldWriter) -> Callable[[float, Frame, FloatArray, float], None]:
    def write(instant: float, frame: Frame, pressure: FloatArray, floor: float) -> None:
        fields.write(
            instant,
            displacement=frame.displacement,
            velocity=frame.velocity,
            von_mises=frame.von_mises,
            contact_pressure=pressure,
            floor_displacement=floor,
        )

    return write
