"""Going on with a simulation where it was cut off: what a checkpoint takes of it, and how that is put back.

A checkpoint is made in a pause of the stepping. It takes everything of the run that changes - coordinates,
velocities, friction springs, kept factors of the contact, ledger, step control, record, samples not yet written -
bit for bit, and the recorder's memory. What only follows from the case (mesh, modes, floor) is built anew; factors of
the bodies follow from the step size alone. What has been written to files is the matter of `fem.run.run_resumption`; a
member of a band writes none.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.interface.solver import Workspace
from contact.stepping.body import State
from contact.stepping.state import Run
from fem.model.model import Model
from fem.results.archive import Checkpoint, CheckpointError, read_checkpoint, write_checkpoint
from fem.run.recorder import Recorder
from fem.run.simulation import Progress
from fem.runtime.identity import program_identity
from fem.solid.nodal_body import FullBody

#: wall time between checkpoints; what passes between two pauses of the stepping may come on top of it, some five
#: seconds, and the writing of a few frames
CHECKPOINT_S = 15.0
#: parts of `contact.stepping.state.Run` that do not change, and those of which a part is kept
CONSTANT = frozenset({"scheme", "contact", "motion", "breaks", "control"})
SAMPLES = frozenset({"history", "frames"})
RECORDED, BODY = "recorder.", "body."

Arrays = dict[str, NDArray[Any]]


class CheckpointKeeper:
    """Keeps the checkpoint of a simulation: every quarter of a minute, and when it is interrupted.

    Args:
        path: of the checkpoint.
        case_hash: of the case that is simulated.
        model, recorder: of the simulation.
        settle: called before a checkpoint is written, to make sure that it may be and that what it speaks of has
            reached the disk; returns notes to be kept beside the state.
    """

    def __init__(
        self,
        path: Path,
        *,
        case_hash: str,
        model: Model,
        recorder: Recorder,
        settle: Callable[[], Mapping[str, Any]],
    ) -> None:
        self._path, self._case_hash, self._program = path, case_hash, program_identity()
        self._model, self._recorder, self._settle = model, recorder, settle
        self._last = time.monotonic()

    def keep(self, progress: Progress, *, at_once: bool = False) -> None:
        """Write the checkpoint if the last one is old enough, or at once.

        Raises:
            OSError: it cannot be written, or the folder is no longer ours.
        """
        if not at_once and time.monotonic() - self._last < CHECKPOINT_S:
            return
        about = {
            "case_hash": self._case_hash,
            "program": self._program,
            "time_s": float(self._model.run.clock[0].time),
            "progress": asdict(progress),
            **self._settle(),
        }
        write_checkpoint(self._path, about, state_of(self._model, self._recorder))
        self._last = time.monotonic()


@dataclass(frozen=True, kw_only=True, eq=False)
class Beginning:
    """From where a simulation is stepped: a checkpoint, or t = 0."""

    progress: Progress = field(default_factory=Progress)
    arrays: Mapping[str, NDArray[Any]] | None = None  #: as `state_of` took them; None: t = 0
    notes: Mapping[str, Any] = field(default_factory=dict)  #: that were kept beside them


def read_beginning(path: Path, model: Model, case_hash: str) -> Beginning:
    """The beginning that a checkpoint asks for, after holding it against the model.

    Raises:
        CheckpointError: it is damaged, of another case or another version, or not of this model's run.
    """
    found = read_checkpoint(path, case_hash=case_hash, program=program_identity())
    _require_fit(path, found, model)
    try:
        about = found.about["progress"]
        undriven, under_way = about["undriven"], about["slice"]
        progress = Progress(
            stepping_cpu_s=float(about["stepping_cpu_s"]),
            undriven=None if undriven is None else (float(undriven[0]), float(undriven[1])),
            slice=None if under_way is None else (float(under_way[0]), int(under_way[1])),
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise misfit(path, f"its notes cannot be read ({error!r})") from None
    return Beginning(progress=progress, arrays=found.arrays, notes=found.about)


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
        ("history", run.history, "samples", "samples_drained"),
        ("frames", run.frames, "frames", "frames_drained"),
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
            raise misfit(path, f"its {name} is not that of this run")


def misfit(path: Path, reason: str) -> CheckpointError:
    """The error of a checkpoint that does not fit what it is found with."""
    return CheckpointError(path, f"cannot be gone on from: {reason}")
