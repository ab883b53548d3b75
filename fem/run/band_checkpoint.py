"""A band in the folder of its run: one that was cut off goes on with the members that it has, where each had come to.

The file `band.json` holds the finished members and is replaced whole whenever there is one more; in the folder
`members` each member under way has a checkpoint as the run's own, less history and frames, of which it writes none.
Both go when the band is in `run.json`. They hold for the case and the program that wrote them. What is damaged or
foreign is begun anew, which costs a member and no more: the run itself is finished by then, and to refuse it, as a
run does whose own checkpoint is damaged, would throw that away.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fem.case.case import case_hash as hash_of
from fem.model.model import Model
from fem.results.archive import CheckpointError
from fem.results.lock import FolderLock
from fem.results.run_folder import RunFolder, to_json, write_atomically
from fem.results.run_result import BandMember
from fem.run.checkpoint import CheckpointKeeper, put_back, read_beginning
from fem.run.recorder import Recorder
from fem.run.simulation import Keeper, Progress
from fem.runtime.identity import program_identity
from fem.runtime.progress import Reporter


class BandFolder:
    """Keeps a band in the folder of its run.

    Args:
        place: the folder; lock: by which it is held.
        case_hash: of the run.
        reporter: told of a checkpoint that is refused.
    """

    def __init__(self, place: RunFolder, lock: FolderLock, *, case_hash: str, reporter: Reporter) -> None:
        self._place, self._lock = place, lock
        self._case_hash, self._reporter = case_hash, reporter

    def members(self) -> Sequence[BandMember]:
        """The finished ones."""
        return read_members(self._place.band, self._case_hash)

    def begin(self, number: int, model: Model, recorder: Recorder) -> tuple[Keeper, Progress]:
        """Put a member where its checkpoint says; returns who keeps it from there, and how far it has come.

        Raises:
            OSError: the folder of checkpoints cannot be made.
        """
        path, mark, progress = self._place.member_checkpoint(number), hash_of(model.case), Progress()
        if path.exists():
            try:
                beginning = read_beginning(path, model, mark)
            except CheckpointError as error:
                self._reporter.warning(
                    f"{error.path} is refused ({error.reason}): its member starts over at t = 0"
                )
            else:
                progress = beginning.progress
                put_back(model, recorder, beginning.arrays or {})
        path.parent.mkdir(exist_ok=True)
        return (
            CheckpointKeeper(path, case_hash=mark, model=model, recorder=recorder, settle=self._settle),
            progress,
        )

    def finish(self, number: int, members: Sequence[BandMember]) -> None:
        """Keep the finished members, of which one has come to its end.

        Raises:
            OSError: the file cannot be written, or the folder is no longer ours.
        """
        self._lock.check()
        write_members(self._place.band, self._case_hash, members)
        self._place.member_checkpoint(number).unlink(missing_ok=True)

    def _settle(self) -> dict[str, Any]:
        self._lock.check()
        return {}


def read_members(path: Path, case_hash: str) -> list[BandMember]:
    """The finished members in a file; none where it is missing, damaged, or of another case or program."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        if (found["case_hash"], found["program"]) != (case_hash, program_identity()):
            return []
        return [BandMember(**member) for member in found["members"]]
    except (OSError, ValueError, KeyError, TypeError):
        return []


def write_members(path: Path, case_hash: str, members: Sequence[BandMember]) -> None:
    """Replace the file.

    Raises:
        OSError: it cannot be written; the old one is still there.
    """
    page = {
        "case_hash": case_hash,
        "program": program_identity(),
        "members": [one.to_json() for one in members],
    }
    write_atomically(path, to_json(page))
