"""A band in the folder of its run, so that an interrupted one continues.

The file `band.json` holds the finished members and is replaced whole with each further one; in the folder `members`
every other member has a checkpoint like the run's, without history and frames. Both are removed when the band is in
`run.json`. They hold for the case and the program that wrote them. What is damaged or foreign is reported and computed
again: the run itself is finished by then, and refusing it would lose more than a member.
"""

import json
from collections.abc import Sequence
from typing import Any

from fem.case.case import case_hash as hash_of
from fem.model.model import Model
from fem.results.archive import CheckpointError
from fem.results.files import to_json
from fem.results.folder import ResultFolder
from fem.results.run_files import RunFiles
from fem.results.run_result import BandMember
from fem.run.checkpoint import CheckpointWriter, SavedState, read_state
from fem.run.recorder import Recorder
from fem.run.simulation import Progress
from fem.runtime.identity import program_identity
from fem.runtime.progress import Reporter


class BandCheckpoint:
    """The checkpoint of a band; its methods may be called by several threads."""

    def __init__(self, folder: ResultFolder, *, case_hash: str, reporter: Reporter) -> None:
        self._folder, self._files = folder, RunFiles(folder.path)
        self._owner = {"case_hash": case_hash, "program": program_identity()}
        self._reporter = reporter

    def read_members(self) -> list[BandMember]:
        """The finished members."""
        path = self._files.band
        if not path.exists():
            return []
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
            if any(found[key] != value for key, value in self._owner.items()):
                raise ValueError("of another case or another version of the program")
            return [BandMember.from_json(member) for member in found["members"]]
        except (OSError, ValueError, KeyError, TypeError) as error:
            self._reporter.warning(f"{path} is refused ({error}): its members are computed again")
            return []

    def write_members(self, members: Sequence[BandMember], number: int | None = None) -> None:
        """Store the finished members; the one of this number needs its checkpoint no more.

        Raises:
            OSError: the file cannot be written, or the folder was lost.
        """
        self._folder.check()
        page = self._owner | {"members": [one.to_json() for one in members]}
        self._folder.write_text(self._files.band.name, to_json(page))
        if number is not None:
            self._files.member_checkpoint(number).unlink(missing_ok=True)

    def open_member(self, number: int, model: Model, recorder: Recorder) -> tuple[CheckpointWriter, Progress]:
        """Put a member where its checkpoint says; returns what writes the next one, and the progress.

        Raises:
            OSError: the folder of checkpoints cannot be made.
        """
        path, request, state = self._files.member_checkpoint(number), hash_of(model.case), SavedState()
        if path.exists():
            try:
                state = read_state(path, model, request)
            except CheckpointError as error:
                self._reporter.warning(
                    f"{path} is refused ({error.reason}): this member of the band starts over at t = 0"
                )
        state.restore(model, recorder)
        path.parent.mkdir(exist_ok=True)
        return CheckpointWriter(path, model, recorder, case_hash=request, notes=self._notes), state.progress

    def _notes(self) -> dict[str, Any]:
        self._folder.check()
        return {}
