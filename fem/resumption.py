"""Going on where a run was cut off: what a checkpoint takes of it, and how that is put back.

A checkpoint is made in a pause of the stepping. It takes everything of the run that changes - coordinates,
velocities, friction springs, kept factors of the contact, ledger, step control, record, samples not yet written -
bit for bit, the recorder's memory, and how far history and frames had come. What only follows
from the case (mesh, modes, floor) is built anew; factors of the bodies follow from the step size alone.
"""

import hashlib
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.body import State
from contact.interface import Workspace
from contact.run import Run
from fem.checkpoint import Checkpoint, CheckpointError, read_checkpoint, write_checkpoint
from fem.compilation import compilation_time
from fem.fields import FieldWriter, frame_name
from fem.folder_lock import FolderLock
from fem.full_body import FullBody
from fem.history import HistoryWriter
from fem.model import Model
from fem.program import program_identity
from fem.recorder import Recorder
from fem.run_folder import RunFolder
from fem.simulation import Progress

#: wall time between checkpoints; what passes between two pauses of the stepping may come on top of it, some five
#: seconds, and the writing of a few frames
CHECKPOINT_S = 15.0
#: parts of `contact.run.Run` that do not change, and those of which a part is kept
CONSTANT = frozenset({"scheme", "contact", "motion", "breaks", "control"})
SAMPLES = frozenset({"history", "frames"})
RECORDED, BODY = "recorder.", "body."

Arrays = dict[str, NDArray[Any]]


@dataclass(frozen=True, kw_only=True)
class Spent:
    """What a run has cost so far, over all its beginnings; or a reading of the clocks that count it."""

    wall_s: float = 0.0
    cpu_s: float = 0.0
    compile_s: float = 0.0  #: of the wall time, the compilation of kernels


class CheckpointKeeper:
    """Keeps a run's checkpoint: every quarter of a minute, and when the run is interrupted."""

    def __init__(
        self,
        place: RunFolder,
        lock: FolderLock,
        *,
        case_hash: str,
        model: Model,
        recorder: Recorder,
        history: HistoryWriter,
        fields: FieldWriter | None,
        before: Spent,
        began: Spent,
    ) -> None:
        self._place, self._lock = place, lock
        self._case_hash, self._program = case_hash, program_identity()
        self._model, self._recorder = model, recorder
        self._history, self._fields = history, fields
        self._before, self._began = before, began
        self._last = time.monotonic()

    def keep(self, progress: Progress, *, at_once: bool = False) -> None:
        """Write the checkpoint if the last one is old enough, or at once.

        Raises:
            OSError: it cannot be written, or the folder is no longer ours.
        """
        if not at_once and time.monotonic() - self._last < CHECKPOINT_S:
            return
        self._lock.check()
        self._history.sync()
        if self._fields is not None:
            self._fields.sync()
        about = {
            "case_hash": self._case_hash,
            "program": self._program,
            "time_s": float(self._model.run.clock[0].time),
            "progress": asdict(progress),
            "history": {"bytes": self._history.position, "sha256": self._history.digest},
            "frames_s": list(self._fields.times) if self._fields is not None else [],
            "spent": asdict(spent_since(self._began, self._before)),
        }
        write_checkpoint(self._place.checkpoint, about, state_of(self._model, self._recorder))
        self._last = time.monotonic()


@dataclass(frozen=True, kw_only=True, eq=False)
class Beginning:
    """From where a run is stepped: a checkpoint found in its folder, or t = 0."""

    progress: Progress = field(default_factory=Progress)
    history_bytes: int | None = None  #: of the history that stay; None: it is begun
    frames_s: tuple[float, ...] = ()  #: times of the frames that stay
    spent: Spent = field(default_factory=Spent)
    arrays: Mapping[str, NDArray[Any]] | None = None


def beginning_in(place: RunFolder, model: Model, case_hash: str) -> Beginning:
    """The beginning that the checkpoint in a folder asks for, after holding it against all that it names.

    Raises:
        CheckpointError: it is damaged, foreign or of another version, or history and frames are not those that
            it was made with. Nothing has been changed then.
    """
    if not place.checkpoint.exists():
        return Beginning()
    found = read_checkpoint(place.checkpoint, case_hash=case_hash, program=program_identity())
    _require_fit(place.checkpoint, found, model)
    try:
        about = found.about
        undriven, under_way = about["progress"]["undriven"], about["progress"]["slice"]
        beginning = Beginning(
            progress=Progress(
                stepping_cpu_s=float(about["progress"]["stepping_cpu_s"]),
                undriven=None if undriven is None else (float(undriven[0]), float(undriven[1])),
                slice=None if under_way is None else (float(under_way[0]), int(under_way[1])),
            ),
            history_bytes=int(about["history"]["bytes"]),
            frames_s=tuple(float(instant) for instant in about["frames_s"]),
            spent=Spent(**{name: float(about["spent"][name]) for name in ("wall_s", "cpu_s", "compile_s")}),
            arrays=found.arrays,
        )
        digest = str(about["history"]["sha256"])
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise _misfit(place.checkpoint, f"its notes cannot be read ({error!r})") from None
    if _digest_of_first(place.history, beginning.history_bytes or 0) != digest:
        raise _misfit(place.checkpoint, f"{place.history.name} was changed since, or is missing")
    missing = [
        frame_name(i) for i in range(len(beginning.frames_s)) if not (place.fields / frame_name(i)).is_file()
    ]
    if missing:
        raise _misfit(place.checkpoint, f"{place.fields.name}/{missing[0]} is missing")
    return beginning


def state_of(model: Model, recorder: Recorder) -> Arrays:
    """Everything that changes in a run, by name; the arrays themselves, not copies, where they are kept."""
    found = _changing(model) | _waiting(model.run, model.run.clock)
    if isinstance(model.body, FullBody):
        found |= {BODY + name: array for name, array in model.body.memory().items()}
    return found | {RECORDED + name: array for name, array in recorder.memory().items()}


def put_back(model: Model, recorder: Recorder, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Give run, body and recorder the state that `state_of` took."""
    for name, array in _changing(model).items():
        np.copyto(array, arrays[name])
    for name, array in _waiting(model.run, model.run.clock).items():  # the clock is put back by now
        np.copyto(array, arrays[name])
    if isinstance(model.body, FullBody):
        model.body.recall(_named(arrays, BODY))
    recorder.recall(_named(arrays, RECORDED))


def clock_readings() -> Spent:
    """What the clocks say now; only differences of it mean something."""
    return Spent(wall_s=time.perf_counter(), cpu_s=time.process_time(), compile_s=compilation_time())


def spent_since(began: Spent, before: Spent) -> Spent:
    """What was spent since the clocks said `began`, and `before`."""
    now = clock_readings()
    return Spent(
        wall_s=before.wall_s + now.wall_s - began.wall_s,
        cpu_s=before.cpu_s + now.cpu_s - began.cpu_s,
        compile_s=before.compile_s + now.compile_s - began.compile_s,
    )


def _changing(model: Model) -> Arrays:
    found: Arrays = {}
    for name, part in model.run._asdict().items():
        if name in CONSTANT | SAMPLES:
            continue
        if isinstance(part, State | Workspace):
            found |= {f"{name}.{key}": array for key, array in part._asdict().items()}
        else:
            found[name] = part
    return found


def _waiting(run: Run, clock: NDArray[Any]) -> Arrays:
    """The samples of a run that no file has yet, as many as this clock says."""
    found: Arrays = {}
    for name, samples, so_far, gone in (
        ("history", run.history, "samples", "samples_gone"),
        ("frames", run.frames, "frames", "frames_gone"),
    ):
        count = int(clock[so_far][0] - clock[gone][0])
        parts = samples._asdict().items()
        found |= {f"{name}.{key}": array[:count] for key, array in parts if isinstance(array, np.ndarray)}
    return found


def _named(arrays: Mapping[str, NDArray[Any]], prefix: str) -> Arrays:
    return {name.removeprefix(prefix): array for name, array in arrays.items() if name.startswith(prefix)}


def _require_fit(path: Path, found: Checkpoint, model: Model) -> None:
    """Refuse arrays that are not those of this model's run."""
    _require_same(path, found, _changing(model))
    _require_same(path, found, _waiting(model.run, found.arrays["clock"]))


def _require_same(path: Path, found: Checkpoint, arrays: Arrays) -> None:
    for name, mine in arrays.items():
        theirs = found.arrays.get(name)
        if theirs is None or theirs.shape != mine.shape or theirs.dtype.descr != mine.dtype.descr:
            raise _misfit(path, f"its {name} is not that of this run")


def _misfit(path: Path, reason: str) -> CheckpointError:
    return CheckpointError(f"{path}: cannot be gone on from: {reason}; begin the run anew with --force")


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
