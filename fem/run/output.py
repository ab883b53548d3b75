"""Files of a run while it is stepped, and the place in them from which an interrupted run resumes.

A checkpoint is written when history and frames have reached the disk, and notes how long they are: what follows that
place is cut off when the run resumes, and what lies before it must not have changed.
"""

import hashlib
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypedDict

import numpy as np

from fem.case.columns import history_columns
from fem.model.model import Model
from fem.model.recovery import recovery_of
from fem.results.fields import FieldWriter, frame_name
from fem.results.history import HistoryWriter, read_history
from fem.results.run_files import RunFiles
from fem.run.checkpoint import SavedState, misfit, read_state
from fem.run.link_cells import LinkCells
from fem.run.recorder import Recorder
from fem.runtime.arrays import FloatArray
from fem.runtime.compilation import compilation_time


class Spent(TypedDict):
    """Times that a run has taken, over all its resumptions [s]."""

    wall_s: float
    cpu_s: float
    compile_s: float  #: of the wall time, the compilation of kernels


NOTHING_SPENT = Spent(wall_s=0.0, cpu_s=0.0, compile_s=0.0)


class Stopwatch:
    """Counts the times that a run takes."""

    def __init__(self) -> None:
        self.before = NOTHING_SPENT  #: before the run was interrupted
        self._began = _readings()

    def spent(self) -> Spent:
        """What the run has taken in all."""
        before = self.before
        wall_s, cpu_s, compile_s = (_readings() - self._began).tolist()
        return Spent(
            wall_s=before["wall_s"] + wall_s,
            cpu_s=before["cpu_s"] + cpu_s,
            compile_s=before["compile_s"] + compile_s,
        )


def _readings() -> FloatArray:
    return np.array([time.perf_counter(), time.process_time(), compilation_time()])


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """Where a run starts: at t = 0, or at a checkpoint."""

    state: SavedState = field(default_factory=SavedState)
    history_bytes: int | None = None  #: of the history that stay; None: it is new
    frames_s: tuple[float, ...] = ()  #: times of the frames that stay
    spent: Spent = field(default_factory=lambda: NOTHING_SPENT)

    @property
    def is_resumed(self) -> bool:
        """Whether there is a checkpoint."""
        return bool(self.state.arrays)


def read_start(files: RunFiles, model: Model, case_hash: str) -> Start:
    """The start that the checkpoint of a run asks for, after a check of all that it refers to; without one, t = 0.

    Raises:
        CheckpointError: damaged, of another case or version, or history and frames have changed since. Nothing has
            been changed then.
    """
    path = files.checkpoint
    if not path.exists():
        return Start()
    state = read_state(path, model, case_hash)
    try:
        notes = state.notes
        length, digest = int(notes["history"]["bytes"]), str(notes["history"]["sha256"])
        frames_s = tuple(float(instant) for instant in notes["frames_s"])
        wall_s, cpu_s, compile_s = (float(notes["spent"][name]) for name in Spent.__annotations__)
        spent = Spent(wall_s=wall_s, cpu_s=cpu_s, compile_s=compile_s)
    except (KeyError, TypeError, ValueError) as error:
        raise misfit(path, f"its notes cannot be read ({error!r})") from None
    if _digest_of_first(files.history, length) != digest:
        raise misfit(path, f"{files.history.name} was changed since, or is missing")
    for i in range(len(frames_s)):
        if not (files.fields / frame_name(i)).is_file():
            raise misfit(path, f"{files.fields.name}/{frame_name(i)} is missing")
    return Start(state=state, history_bytes=length, frames_s=frames_s, spent=spent)


@dataclass(frozen=True, kw_only=True, eq=False)
class RunOutput:
    """History and frames of a run, written as they come."""

    recorder: Recorder  #: of the samples
    history: HistoryWriter
    fields: FieldWriter | None

    def sync(self) -> dict[str, Any]:
        """Bring the files to the disk; returns how long they are, for a checkpoint."""
        self.history.sync()
        if self.fields is not None:
            self.fields.sync()
        return {
            "history": {"bytes": self.history.position, "sha256": self.history.digest},
            "frames_s": list(self.fields.times) if self.fields is not None else [],
        }


@contextmanager
def open_output(files: RunFiles, model: Model, start: Start) -> Iterator[RunOutput]:
    """Open the files of a run, and put its model where it starts."""
    case, fields = model.case, None
    with ExitStack() as stack:
        history = stack.enter_context(
            HistoryWriter(files.history, history_columns(case), position=start.history_bytes)
        )
        if case.output.fields_s != 0.0:
            fields = FieldWriter(
                files.fields,
                **LinkCells(model).mesh,
                kept_times=start.frames_s,
            )
            stack.callback(fields.close)
        recorder = Recorder(model, recovery_of(model), history.append, fields.write if fields else None)
        if start.is_resumed:
            start.state.restore(model, recorder)
            recorder.resume(read_history(files.history))
        yield RunOutput(recorder=recorder, history=history, fields=fields)


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
