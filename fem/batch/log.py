"""Tables of rows, and the log of a study: a table that grows by whole lines.

Numbers are written in the shortest form that reads back to the same bits. While a study runs, rows are appended in the
order in which they are ready; a kill leaves whole lines and at most one broken one, which is cut off when the study
is resumed. At the end the table is replaced by one in the order of the study. A text that a spreadsheet would compute,
such as a file name that begins with "=", has an apostrophe before it.
"""

import csv
import io
import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic

import numpy as np

from fem.batch.runner import ChunkWork, ItemT, Row, Runner
from fem.batch.shard import number_of
from fem.case.case import Case


def line_of(values: Iterable[Any]) -> str:
    """Values as a line of a table, without its end."""
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow([_text(value) for value in values])
    return text.getvalue()


def fields_of(line: str) -> list[str]:
    """The fields of one line."""
    return [plain_text(field) for field in next(csv.reader([line]))]


def plain_text(field: str) -> str:
    """A field without the apostrophe before what a spreadsheet would compute."""
    return field[1:] if field[:1] == "'" and _is_computed(field[1:]) else field


def number_in(field: str) -> float | None:
    """A field as a number; None for an empty one."""
    return float(field) if field else None


def numbers_in(field: str) -> tuple[float, ...]:
    """A field as numbers; none for an empty one."""
    return tuple(map(float, field.split()))


def table_text(columns: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """A table as text."""
    return table_of_lines(columns, map(line_of, rows))


def table_of_lines(columns: Iterable[str], lines: Iterable[str]) -> str:
    """A table as text, from lines."""
    return "".join(f"{line}\n" for line in (line_of(columns), *lines))


def read_lines(path: Path, columns: Iterable[str]) -> list[str]:
    """The whole lines of a table below its header; none if the file is missing, or has other columns."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except FileNotFoundError:
        return []
    lines = text[: text.rfind("\n") + 1].split("\n")[:-1]
    return lines[1:] if lines[:1] == [line_of(columns)] else []


class RowLog:
    """Appends lines to a table, each as a whole.

    Args:
        path: of the table; continued behind its last whole line if it has these columns, else begun.
        columns: names in the header.
    """

    def __init__(self, path: Path, columns: Iterable[str]) -> None:
        columns = tuple(columns)
        self.lines = read_lines(path, columns)  #: already there
        kept = table_of_lines(columns, self.lines).encode()
        self._file = open(path, "r+b" if self.lines else "wb", buffering=0)  # noqa: SIM115
        if self.lines:
            self._file.truncate(len(kept))
            self._file.seek(len(kept))
        else:
            self._file.write(kept)

    def append(self, lines: Iterable[str]) -> None:
        """Write lines in one go."""
        data = "".join(f"{line}\n" for line in lines).encode()
        done = 0
        while done < len(data):
            done += self._file.write(data[done:])

    def sync(self) -> None:
        """Have what was written survive a power cut as well."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        self._file.close()


@dataclass(frozen=True, kw_only=True)
class LoggedRuns(Generic[ItemT]):
    """Runs of one kind whose rows are kept in a log: none is computed twice, whatever interrupts the study."""

    what: str  #: they are, for the line of progress
    path: Path  #: of the log
    columns: Sequence[str]  #: of the log
    make: Callable[[ItemT], Case]  #: the case of an item; picklable
    model_of: Callable[[ItemT], str]
    values: Callable[[ItemT, Row], Iterable[Any]]  #: of the columns, from an item and its row
    note: Callable[[str], None]  #: called with every line of the log, old and new
    work: ChunkWork | None = None  #: what is done with some items in place of their runs
    number: Callable[[ItemT], int] = number_of  #: of an item, by which it has its shard

    def run(self, runner: Runner, batches: Iterable[Sequence[ItemT]]) -> None:
        """Note the rows of earlier attempts, then run the items that are missing.

        Args:
            runner: runs the cases.
            batches: of missing items; each is asked for when all rows before are noted.
        """
        with closing(RowLog(self.path, self.columns)) as log:
            for line in log.lines:
                self.note(line)
            for items in batches:
                if runner.stop():
                    break
                mine = runner.share.of(items, map(self.number, items)) if runner.share else items
                for chunk, rows in runner.rows(self.what, mine, self.make, self.model_of, self.work):
                    lines = [line_of(self.values(*pair)) for pair in zip(chunk, rows, strict=True)]
                    log.append(lines)
                    for line in lines:
                        self.note(line)
                if runner.share and len(mine) < len(items) and not runner.stop():
                    runner.share.waits = True
            log.sync()


def _text(value: Any) -> str:
    """One field: nothing for None, text on one line, spaces between several numbers."""
    if value is None:
        return ""
    if isinstance(value, tuple):
        return " ".join(map(_text, value))
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, float | np.floating):
        return repr(float(value))
    text = " ".join(str(value).split())
    return f"'{text}" if _is_computed(text) else text


def _is_computed(text: str) -> bool:
    """Whether a spreadsheet would take a text for a formula."""
    if text[:1] not in ("=", "+", "-", "@"):
        return False
    try:
        return not [float(word) for word in text.split()]
    except ValueError:
        return True
