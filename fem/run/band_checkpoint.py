"""A band in the folder of its run, so that an interrupted one continues.

The file `band.json` holds the finished members and is replaced whole with each further one; it is removed when the band
is in `run.json`. It holds for the case and the program that wrote it. What is damaged or foreign is reported and
computed again: the run itself is finished by then, and refusing it would lose more than a member.
"""

import json
from collections.abc import Sequence

from fem.results.files import to_json
from fem.results.folder import ResultFolder
from fem.results.run_files import RunFiles
from fem.results.run_result import BandMember
from fem.runtime.identity import program_identity
from fem.runtime.progress import Reporter


class BandCheckpoint:
    """The checkpoint of a band; its methods may be called by several threads."""

    def __init__(self, folder: ResultFolder, *, case_hash: str, reporter: Reporter) -> None:
        self._folder, self._path = folder, RunFiles(folder.path).band
        self._owner = {"case_hash": case_hash, "program": program_identity()}
        self._reporter = reporter

    def read_members(self) -> list[BandMember]:
        """The finished members."""
        if not self._path.exists():
            return []
        try:
            found = json.loads(self._path.read_text(encoding="utf-8"))
            if any(found[key] != value for key, value in self._owner.items()):
                raise ValueError("of another case or another version of the program")
            return [BandMember.from_json(member) for member in found["members"]]
        except (OSError, ValueError, KeyError, TypeError) as error:
            self._reporter.warning(f"{self._path} is refused ({error}): its members are computed again")
            return []

    def write_members(self, members: Sequence[BandMember]) -> None:
        """Store the finished members.

        Raises:
            OSError: the file cannot be written, or the folder was lost.
        """
        self._folder.check()
        page = self._owner | {"members": [one.to_json() for one in members]}
        self._folder.write_text(self._path.name, to_json(page))
