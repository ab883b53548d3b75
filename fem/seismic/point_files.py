"""Files of points: a line that names the columns, and lines of numbers between commas."""

from collections.abc import Sequence
from pathlib import Path

from fem.records.source import as_numbers, decoded
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
    """The columns by name; blanks, empty lines and a byte order mark are passed over.

    Args:
        path: of the file.
        choices: the columns that it may have, in their order.

    Raises:
        ValueError: it cannot be read, has other columns, or a line without a number for each.
    """
    text = text_of(path)
    first, *lines = [line for line in text.splitlines() if line.strip()] or [""]
    names = [name.strip() for name in first.split(",")]
    if names not in [[*choice] for choice in choices]:
        actual = f"got {first[:80]!r}" if first else "and the file is empty"
        raise ValueError(
            f"{path.name}: the first line must be {' or '.join(map(','.join, choices))}, {actual}"
        )
    rows = [as_numbers([field.strip() for field in line.split(",")]) for line in lines]
    known = [row.tolist() for row in rows if row is not None and row.size == len(names)]
    if not known or len(known) < len(rows):
        raise ValueError(f"{path.name}: every further line must hold {len(names)} numbers")
    return dict(zip(names, zip(*known, strict=True), strict=True))
