"""A run, from a case to a verdict and its files.

case -> model (mesh, body, floor, settled) -> step until done -> history -> verdict -> outputs.
"""

import os
import platform
import shutil
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

from contact.body import ROTATION
from contact.compiled import is_compiled
from contact.floor_motion import coasting_floor
from contact.stepping import FAILED, OVERTURNED, Run, advance, advance_compiled
from fem.case import Case, case_hash, to_toml
from fem.fields import FieldWriter
from fem.full_body import FullBody
from fem.history import History, HistoryWriter
from fem.model import Model, build_model
from fem.progress import Reporter, SilentReporter
from fem.recorder import Recorder
from fem.recovery import Frame, recovery_of
from fem.run_folder import RunFolder, open_run_folder
from fem.run_warnings import warnings_for
from fem.summary import plain_summary
from fem.verdict import MODE_NAMES, audit, energy_of, numerics_of, verdict_of
from mesh.cells import FloatArray

#: how far a run goes before it looks up, in simulated seconds and in wall seconds of the files' age
SLICE_REDUCED, SLICE_FULL = 0.25, 0.01
STATUS_S = 2.0
#: a container left beyond its slenderness angle at the end falls or comes back within so many times 1/p
AFTERMATH = 50.0


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What the command line asks of a run besides its case."""

    check_rigid: bool = False
    band: bool | None = None
    resume: bool = False
    force: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class RunResult:
    """What a run came to."""

    status: str  #: completed | overturned | failed | interrupted
    result: dict[str, Any]  #: as in run.json
    history: History


@dataclass(frozen=True, kw_only=True)
class Ending:
    """How the stepping ended."""

    status: str
    stepping_cpu_s: float
    error: str | None = None


def run_case(
    case: Case,
    *,
    case_text: str,
    folder: Path,
    options: RunOptions | None = None,
    reporter: Reporter | None = None,
) -> RunResult:
    """Compute a case into a folder.

    Raises:
        CaseError, MeshError, FolderError: bad input; nothing is left behind.
    """
    options, reporter = options or RunOptions(), reporter or SilentReporter()
    began = time.perf_counter(), time.process_time()
    model = build_model(case)
    resolved = resolve(case, model)
    place = open_run_folder(
        folder,
        case_text=case_text,
        resolved_text=to_toml(resolved),
        case_hash=case_hash(resolved),
        force=options.force,
        resume=options.resume,
    )
    if place.finished is not None:
        reporter.message(f"{folder} holds this run already; --force computes it again")
        return RunResult(
            status=str(place.finished["status"]), result=place.finished, history=History.empty()
        )
    copy_data_files(case, place)
    base = {
        "status": "running",
        "case": case.name,
        "title": case.title,
        "case_hash": case_hash(resolved),
        "static": model.static.to_dict(),
        "versions": versions(),
    }
    place.write_result(base)
    with ExitStack() as stack:
        stop = stack.enter_context(interruptible(reporter))
        history_writer = stack.enter_context(HistoryWriter(place.history))
        frame_sink = None
        if case.output.fields_s > 0.0:
            elements = model.container.elements
            fields = FieldWriter(
                place.fields, points=elements.nodes, cells=elements.cells, region=elements.region
            )
            stack.callback(fields.close)
            frame_sink = _frame_writer(fields)
        recorder = Recorder(model, recovery_of(model), history_writer.append, frame_sink)
        ending = simulate(model, recorder, reporter=reporter, stop=stop)
    result = base | result_of(model, recorder, ending)
    result["wall_s"] = time.perf_counter() - began[0]
    result["cpu_s"] = time.process_time() - began[1]
    result["warnings"] = warnings_for(result, case)
    place.write_result(result)
    place.write_summary(
        plain_summary(result, title=case.title or case.name, folder=folder, warnings=result["warnings"])
    )
    return RunResult(status=ending.status, result=result, history=recorder.history())


def simulate(
    model: Model,
    recorder: Recorder,
    *,
    reporter: Reporter | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Ending:
    """Step a model to its end; the recorder takes the samples.

    A container that the end finds beyond its slenderness angle is followed on a floor that coasts, undriven, until
    it falls or has come back.
    """
    reporter = reporter or SilentReporter()
    full = isinstance(model.body, FullBody)
    step = advance if full else advance_compiled
    if not full:
        if not is_compiled("advance"):
            reporter.message("compiling the stepping kernels, once after installation: about half a minute")
        advance_compiled(model.body, model.run, 0.0)
    duration, control = model.case.solver.duration_s, model.run.control
    angle = control.slenderness_angle
    reporter.start(duration)
    cpu, run, until = 0.0, model.run, duration
    clock, track = run.clock[0], run.track[0]
    status = "completed"
    while clock.time < until:
        began = time.process_time()
        code = step(model.body, run, min(clock.time + (SLICE_FULL if full else SLICE_REDUCED), until))
        cpu += time.process_time() - began
        recorder.drain(run)
        rotation = abs(float(run.old.pose[ROTATION]))
        reporter.update(float(clock.time), rotation / angle, MODE_NAMES[int(track.mode)])
        if code == FAILED:
            reporter.finish()
            return Ending(status="failed", stepping_cpu_s=cpu, error=_failure(model))
        if code == OVERTURNED:
            status = "overturned"
            break
        if stop():
            reporter.finish()
            return Ending(status="interrupted", stepping_cpu_s=cpu)
        if clock.time >= duration:
            if until == duration and angle < rotation < 0.5 * np.pi:
                run, until = _left_alone(run), duration + AFTERMATH / control.frequency_parameter
            elif until > duration and rotation < angle:
                break
    if np.isfinite(track.overturned_at):
        status = "overturned"
    reporter.finish()
    error = audit(model)
    if error is not None:
        return Ending(status="failed", stepping_cpu_s=cpu, error=error)
    return Ending(status=status, stepping_cpu_s=cpu)


def result_of(model: Model, recorder: Recorder, ending: Ending) -> dict[str, Any]:
    """The blocks of `run.json` that the stepping fills."""
    rigid = model.case.solver.model == "rigid"
    result: dict[str, Any] = {
        "status": ending.status,
        "verdict": verdict_of(model, recorder.history(), None if rigid else recorder.largest_von_mises),
        "energy": energy_of(model),
        "numerics": numerics_of(model, ending.stepping_cpu_s),
    }
    if ending.error is not None:
        result["error"] = ending.error
        result["verdict"]["outcome"] = None
    return result


def resolve(case: Case, model: Model) -> Case:
    """The case with every "auto" replaced by what was chosen; running it again gives the same result."""
    chosen: dict[str, Any] = {}
    if case.contact.normal_penalty_Pa_m == "auto":
        chosen["contact.normal_penalty_Pa_m"] = model.penalty
    if case.solver.step_s == "auto":
        chosen["solver.step_s"] = model.run.control.largest_step
    return case.with_values(chosen) if chosen else case


def copy_data_files(case: Case, place: RunFolder) -> None:
    """Put mesh and motion files beside `resolved.toml`, under the names it gives them."""
    for path in case.data_files.values():
        target = place.path / path.relative_to(case.folder.resolve())
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.resolve() != path.resolve():
            shutil.copyfile(path, target)


def versions() -> dict[str, str]:
    """Of the program and of what its numbers depend on."""
    packages = ("unanchored", "numpy", "scipy", "scikit-fem", "numba", "meshio")
    return {"python": platform.python_version()} | {name: metadata.version(name) for name in packages}


@contextmanager
def interruptible(reporter: Reporter) -> Iterator[Callable[[], bool]]:
    """Turn the first Ctrl-C or SIGTERM into a request to stop at a clean place; a second Ctrl-C insists."""
    asked: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        if asked and number == signal.SIGINT:
            raise KeyboardInterrupt
        asked.append(number)
        reporter.message("stopping at the next clean place; once more stops at once")

    before = {}
    for number in (signal.SIGINT, signal.SIGTERM):
        try:
            before[number] = signal.signal(number, note)
        except ValueError:  # not the main thread: whoever called has other means
            break
    try:
        yield lambda: bool(asked)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _left_alone(run: Run) -> Run:
    """The run with its floor coasting from now on."""
    run.clock[0].next_break = 0
    return run._replace(
        motion=coasting_floor(run.motion, float(run.clock[0].time)), breaks=np.full(1, np.inf)
    )


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


def _failure(model: Model) -> str:
    """Where and why the stepping gave up, and what to try."""
    clock, work = model.run.clock[0], model.run.work
    residual = float(np.abs(work.law - work.force).max())
    step = model.run.control.smallest_step
    return (
        f"step {int(clock.steps) + 1}, t = {float(clock.time):.6g} s: the contact forces are out of balance by "
        f"{residual:.2g} N after the last iteration at the smallest step ({step:.1g} s); try a softer "
        "contact.normal_penalty_Pa_m, contact.weakening_m > 0, or a smaller solver.step_s"
    )


def cores() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)
