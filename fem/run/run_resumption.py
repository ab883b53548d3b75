"""Going on with a run where it was cut off: its simulation, and what its files held by then.

A checkpoint is made when history and frames have reached the disk, and says how far they had come: what lies behind
that is cut off when the run goes on, and what lies before must be as it was.
"""

import hashlib
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from fem.model.model import Model
from fem.results.fields import FieldWriter, frame_name
from fem.results.history import HistoryWriter
from fem.results.lock import FolderLock
from fem.results.run_folder import RunFolder
from fem.run.checkpoint import Beginning, misfit, read_beginning
from fem.runtime.compilation import compilation_time


@dataclass(frozen=True, kw_only=True)
class Spent:
    """What a run has cost so far, over all its beginnings; or a reading of the clocks that count it."""

    wall_s: float = 0.0
    cpu_s: float = 0.0
    compile_s: float = 0.0  #: of the wall time, the compilation of kernels


@dataclass(frozen=True, kw_only=True, eq=False)
class RunBeginning:
    """From where a run goes on: a checkpoint found in its folder, or nothing."""

    simulation: Beginning = field(default_factory=Beginning)
    history_bytes: int | None = None  #: of the history that stay; None: it is begun
    frames_s: tuple[float, ...] = ()  #: times of the frames that stay
    spent: Spent = field(default_factory=Spent)


def beginning_in(place: RunFolder, model: Model, case_hash: str) -> RunBeginning:
    """The beginning that the checkpoint in a folder asks for, after holding it against all that it names.

    Raises:
        CheckpointError: it is damaged, foreign or of another version, or history and frames are not those that
            it was made with. Nothing has been changed then.
    """
    if not place.checkpoint.exists():
        return RunBeginning()
    simulation = read_beginning(place.checkpoint, model, case_hash)
    try:
        notes = simulation.notes
        beginning = RunBeginning(
            simulation=simulation,
            history_bytes=int(notes["history"]["bytes"]),
            frames_s=tuple(float(instant) for instant in notes["frames_s"]),
            spent=Spent(**{name: float(notes["spent"][name]) for name in ("wall_s", "cpu_s", "compile_s")}),
        )
        digest = str(notes["history"]["sha256"])
    except (KeyError, TypeError, ValueError) as error:
        raise misfit(place.checkpoint, f"its notes cannot be read ({error!r})") from None
    if _digest_of_first(place.history, beginning.history_bytes or 0) != digest:
        raise misfit(place.checkpoint, f"{place.history.name} was changed since, or is missing")
    missing = [
        frame_name(i) for i in range(len(beginning.frames_s)) if not (place.fields / frame_name(i)).is_file()
    ]
    if missing:
        raise misfit(place.checkpoint, f"{place.fields.name}/{missing[0]} is missing")
    return beginning


def settling(
    lock: FolderLock,
    history: HistoryWriter,
    fields: FieldWriter | None,
    *,
    before: Spent,
    began: Spent,
) -> Callable[[], dict[str, Any]]:
    """What a run does before a checkpoint: its files go to the disk; how far they have come is noted.

    Args:
        lock: of the folder, which must still be ours.
        history, fields: writers of the run's files.
        before: spent by earlier beginnings of the run; began: readings of the clocks at this one, see `spent_since`.
    """

    def settle() -> dict[str, Any]:
        lock.check()
        history.sync()
        if fields is not None:
            fields.sync()
        return {
            "history": {"bytes": history.position, "sha256": history.digest},
            "frames_s": list(fields.times) if fields is not None else [],
            "spent": asdict(spent_since(began, before)),
        }

    return settle


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
