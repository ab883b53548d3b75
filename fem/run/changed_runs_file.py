"""The finished runs of changed cases, kept in a folder while a band is not finished.

The file is replaced whole with each further run. It holds for the case and the program that wrote it. What is damaged
or foreign is reported and computed again: the run itself is finished by then, and refusing it would lose more.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from fem.case.tables.input_ranges import Value
from fem.results.files import to_json
from fem.results.run_result import ChangedRun
from fem.runtime.identity import program_identity


class ChangedRunsFile:
    """The finished runs of a file; its methods may be called by several threads.

    Args:
        path: of the file.
        case_hash: of the case that is changed.
        write: replaces the file by a text; an OSError of it ends the work.
        message: receives why a file is refused.
    """

    def __init__(
        self, path: Path, *, case_hash: str, write: Callable[[str], None], message: Callable[[str], None]
    ) -> None:
        self._path, self._write, self._message = path, write, message
        self._owner = {"case_hash": case_hash, "program": program_identity()}

    def read(self) -> list[ChangedRun]:
        """The finished runs."""
        if not self._path.exists():
            return []
        try:
            content = json.loads(self._path.read_text(encoding="utf-8"))
            if any(content[key] != value for key, value in self._owner.items()):
                raise ValueError("of another case or another version of the program")
            return [ChangedRun.from_json(member) for member in content["members"]]
        except (OSError, ValueError, KeyError, TypeError) as error:
            self._message(f"{self._path} is refused ({error}): its members are computed again")
            return []

    def store(self, runs: Sequence[ChangedRun]) -> None:
        """Store the finished runs, in an order that does not depend on which were finished first.

        Raises:
            OSError: the file cannot be written, or the folder was lost.
        """
        ordered = sorted(runs, key=lambda run: repr(key_of(run.values)))
        self._write(to_json(self._owner | {"members": [run.to_json() for run in ordered]}))


def key_of(values: Mapping[str, Value] | None) -> tuple[tuple[str, Value], ...]:
    """Equal for runs that change the same inputs to the same values, within rounding."""
    rounded = {
        key: float(f"{value:.9g}") if isinstance(value, float) else value
        for key, value in (values or {}).items()
    }
    return tuple(sorted(rounded.items()))
