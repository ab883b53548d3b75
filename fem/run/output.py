"""Files of a run while it is stepped, and the place in them from which an interrupted run resumes.

A checkpoint is written when history and frames have reached the disk, and notes how long they are: what follows that
place is cut off when the run resumes, and what lies before it must not have changed.
"""

import hashlib
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from contact.stepping.links import LinkedBody
from contact.stepping.loose_stack import LooseStack
from contact.stepping.modal_body import ModalBody
from contact.stepping.state import RunState
from fem.case.columns import history_columns
from fem.model.model import Model
from fem.model.recovery import recovery_of
from fem.results.archive import CheckpointError, read_checkpoint, write_archive
from fem.results.fields import FieldWriter, frame_name
from fem.results.folder import ResultFolder
from fem.results.history import HistoryWriter, read_history
from fem.results.run_files import RunFiles
from fem.run.drawn_links import LinkCells
from fem.run.recorder import Recorder
from fem.run.simulation import BEGINNING, Progress
from fem.runtime.arrays import FloatArray
from fem.runtime.compilation import compilation_time
from fem.runtime.identity import program_identity
from fem.solid.nodal_body import FullStack

#: wall time between checkpoints [s]; the stepping pauses every five seconds or so, and writing frames takes time, too
CHECKPOINT_S = 15.0
RECORDED, BODY = "recorder.", "body."

Arrays = dict[str, NDArray[Any]]


def _misfit(path: Path, reason: str) -> CheckpointError:
    """The error of a checkpoint that does not fit the run it is found with."""
    return CheckpointError(path, f"does not fit this run: {reason}")


def state_of(model: Model, recorder: Recorder) -> Arrays:
    """Everything that changes in a run, by name; the arrays themselves, not copies."""
    arrays = changing(model) | _waiting(model.run, model.run.clock)
    if not isinstance(model.body, ModalBody | LooseStack | LinkedBody):
        arrays |= {BODY + name: array for name, array in model.body.memory().items()}
    return arrays | {RECORDED + name: array for name, array in recorder.memory().items()}


def changing(model: Model) -> Arrays:
    """All of a model that changes from step to step, but for its samples, by name; the arrays themselves."""
    arrays = model.run.progress()
    stack = model.body.stack if isinstance(model.body, FullStack) else model.body
    # a step begins with the weights and the linearisation of the one before
    if isinstance(stack, LooseStack):
        arrays["faces.weight"], arrays["faces.gradient"] = stack.faces.weight, stack.faces.gradient
        arrays["contact.normal_stiffness"] = model.run.problem.contact.normal_stiffness
        arrays["contact.tangential_stiffness"] = model.run.problem.contact.tangential_stiffness
    return arrays


def _waiting(run: RunState, clock: NDArray[Any]) -> Arrays:
    """The samples of a run that are in no file yet, as many as this clock says."""
    arrays: Arrays = {}
    for name, samples, so_far, gone in (
        ("history", run.buffers.history, "samples", "samples_drained"),
        ("frames", run.buffers.frames, "frames", "frames_drained"),
    ):
        count = int(clock[so_far][0] - clock[gone][0])
        parts = samples._asdict().items()
        arrays |= {f"{name}.{key}": array[:count] for key, array in parts if isinstance(array, np.ndarray)}
    return arrays


def require_same(path: Path, arrays: Arrays, wanted: Arrays) -> None:
    """Refuse arrays that are not those of this model's run, by a CheckpointError that names the first."""
    for name, mine in wanted.items():
        theirs = arrays.get(name)
        if theirs is None or theirs.shape != mine.shape or theirs.dtype.descr != mine.dtype.descr:
            raise _misfit(path, f"its {name} is not that of this run")


class Spent(TypedDict):
    """Times that a run has taken, over all its resumptions [s]."""

    wall_s: float
    cpu_s: float
    compile_s: float  #: of the wall time, the compilation of kernels


class Stopwatch:
    """Counts the times that a run takes, over all its resumptions."""

    def __init__(self) -> None:
        self.before = np.zeros(3)  #: before the run was interrupted
        self._began = self._readings()

    def spent(self) -> Spent:
        """What the run has taken in all."""
        wall_s, cpu_s, compile_s = (self.before + (self._readings() - self._began)).tolist()
        return Spent(wall_s=wall_s, cpu_s=cpu_s, compile_s=compile_s)

    def _readings(self) -> FloatArray:
        return np.array([time.perf_counter(), time.process_time(), compilation_time()])


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """Where a run starts: at t = 0, or at a checkpoint."""

    progress: Progress = BEGINNING
    arrays: Arrays = field(default_factory=dict)  #: as `state_of` names them; empty: t = 0
    history_bytes: int | None = None  #: of the history that stay; None: it is new
    frames_s: tuple[float, ...] = ()  #: times of the frames that stay
    spent: FloatArray = field(default_factory=lambda: np.zeros(3))  #: by then, as `Spent` has it [s]

    def restore(self, model: Model, recorder: Recorder) -> None:
        """Give run, body and recorder this state; they stay as they are at t = 0."""
        if not self.arrays:
            return
        for name, array in changing(model).items():
            np.copyto(array, self.arrays[name])
        for name, array in _waiting(model.run, model.run.clock).items():  # the clock is restored by now
            np.copyto(array, self.arrays[name])
        of_body, recorded = (
            {name.removeprefix(whose): array for name, array in self.arrays.items() if name.startswith(whose)}
            for whose in (BODY, RECORDED)
        )
        if not isinstance(model.body, ModalBody | LooseStack | LinkedBody):
            model.body.recall(of_body)
        recorder.recall(recorded)


def read_start(files: RunFiles, model: Model, case_hash: str) -> Start:
    """The start that the checkpoint of a run asks for, after a check of all that it refers to; without one, t = 0.

    A CheckpointError where it is damaged, of another case or version, not of this model's run, or history and frames
    have changed since.
    """
    path = files.checkpoint
    if not path.exists():
        return Start()
    archive = read_checkpoint(path, case_hash=case_hash, program=program_identity())
    require_same(path, archive.arrays, changing(model))
    require_same(path, archive.arrays, _waiting(model.run, archive.arrays["clock"]))
    try:
        notes, about = archive.about, archive.about["progress"]
        undriven, under_way = about["undriven"], about["slice"]
        length, digest = int(notes["history"]["bytes"]), str(notes["history"]["sha256"])
        start = Start(
            progress=Progress(
                stepping_cpu_s=float(about["stepping_cpu_s"]),
                undriven=None
                if undriven is None
                else (float(undriven[0]), float(undriven[1]), float(undriven[2])),
                slice=None if under_way is None else (float(under_way[0]), int(under_way[1])),
            ),
            arrays=archive.arrays,
            history_bytes=length,
            frames_s=tuple(float(instant) for instant in notes["frames_s"]),
            spent=np.array([float(notes["spent"][name]) for name in Spent.__annotations__]),
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise _misfit(path, f"its notes cannot be read ({error!r})") from None
    if _digest_of_first(files.history, length) != digest:
        raise _misfit(path, f"{files.history.name} was changed since, or is missing")
    for i in range(len(start.frames_s)):
        if not (files.fields / frame_name(i)).is_file():
            raise _misfit(path, f"{files.fields.name}/{frame_name(i)} is missing")
    return start


@contextmanager
def open_output(
    place: ResultFolder, model: Model, case_hash: str, watch: Stopwatch, start: Start
) -> Iterator[tuple[Recorder, Callable[[Progress, bool], None]]]:
    """Open the files of a run and put its model where it starts; its recorder, and what writes its checkpoint.

    That is written if the last one is old enough, or now; history and frames reach the disk before. It raises an
    OSError where it cannot be written, or the folder was lost.
    """
    case, fields, files, last = model.case, None, RunFiles(place.path), time.monotonic()

    def save(progress: Progress, now: bool) -> None:
        nonlocal last
        if not now and time.monotonic() - last < CHECKPOINT_S:
            return
        place.check()
        history.sync()
        if fields is not None:
            fields.sync()
        about = {
            "case_hash": case_hash,
            "program": program_identity(),
            "time_s": float(model.run.clock[0].time),
            "progress": asdict(progress),
            "history": {"bytes": history.position, "sha256": history.digest},
            "frames_s": list(fields.times) if fields is not None else [],
            "spent": watch.spent(),
        }
        write_archive(files.checkpoint, about, state_of(model, recorder))
        last = time.monotonic()

    with ExitStack() as stack:
        history = stack.enter_context(
            HistoryWriter(files.history, history_columns(case), position=start.history_bytes)
        )
        if case.output.fields_s != 0.0:
            fields = FieldWriter(files.fields, **LinkCells(model).mesh, kept_times=start.frames_s)
            stack.callback(fields.close)
        recorder = Recorder(model, recovery_of(model), history.append, fields.write if fields else None)
        if start.arrays:
            start.restore(model, recorder)
            recorder.resume(read_history(files.history))
        yield recorder, save


def _digest_of_first(path: Path, count: int) -> str | None:
    """SHA-256 of the first bytes of a file; None where it has not so many."""
    digest = hashlib.sha256()
    try:
        with open(path, "rb") as file:
            while count > 0:
                content = file.read(min(count, 1 << 20))
                if not content:
                    return None
                digest.update(content)
                count -= len(content)
    except OSError:
        return None
    return digest.hexdigest()
