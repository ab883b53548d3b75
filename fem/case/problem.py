"""Why a case is refused: one key, one reason, one way out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath, PureWindowsPath
from typing import Any

from fem.case.quantities import with_unit


@dataclass(frozen=True, kw_only=True)
class Problem:
    """Why a case is refused: the key (empty for a whole table) and the reason with its way out."""

    key: str
    reason: str
    table: str = ""  #: empty: the table that the rule was asked about


class BrokenRulesError(ValueError):
    """Every rule that a table or a case breaks."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        super().__init__("; ".join(f"{problem.key} {problem.reason}".strip() for problem in problems))
        self.problems = tuple(problems)


Rule = Callable[[Any], Problem | None]


def leaves_the_folder(key: str, path: str | None) -> Problem | None:
    """A problem if the path may leave the folder of the case file; None if it stays, or is not given."""
    if path is None:
        return None
    name = PurePosixPath(path)
    leaves = name.is_absolute() or ".." in name.parts or PureWindowsPath(path).drive or "\\" in path
    if path.strip() and path.isprintable() and not leaves:
        return None
    return Problem(
        key=key,
        reason=f"must name a file in the folder of the case file or below it, got {with_unit(path, '')}; "
        "copy the file there and give its relative path, with forward slashes",
    )
