"""Files of points: a line that names the columns, and lines of a number in each."""

from collections.abc import Sequence
from pathlib import Path

from fem.records.source import decoded
from fem.records.table import UserTable
from fem.runtime.user_files import read_regular

LARGEST_FILE = 1_000_000  #: [bytes]; a curve has some tens of points


def text_of(path: Path) -> str:
    """The text of a file of points.

    Raises:
        ValueError: it cannot be read.
    """
    try:
        return decoded(read_regular(path, LARGEST_FILE)) or ""
    except ValueError as error:
        raise ValueError(f"{path.name} {error}") from None


def read_points(path: Path, choices: Sequence[Sequence[str]]) -> dict[str, tuple[float, ...]]:
    """The columns by name, as any spreadsheet writes them.

    Args:
        path: of the file.
        choices: the columns that it may have, in their order.

    Raises:
        ValueError: it cannot be read, has other columns, or a line without a number for each.
    """
    table = UserTable(path.name, text_of(path))
    names = table.header
    if names not in [[*choice] for choice in choices]:
        actual = f"got {','.join(names)[:80]!r}" if names else "and the file is empty"
        raise ValueError(
            f"{path.name}: the first line must be {' or '.join(map(','.join, choices))}, {actual}"
        )
    table.require_one_decimal_mark(range(len(names)))
    rows = [line.numbers() for line in table.lines if len(line.fields) == len(names)]
    if not rows or [len(row) for row in rows] != [len(names)] * len(table.lines):
        raise ValueError(f"{path.name}: every further line must hold {len(names)} numbers")
    return dict(zip(names, zip(*rows, strict=True), strict=True))
