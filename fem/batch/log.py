"""The log of a study: a table that grows by whole lines.

While a study runs, rows are appended in the order in which they are ready; a kill leaves whole lines and at most one
broken one, which is cut off when the study is resumed. At the end the table is replaced by one in the order of the
study.
"""

import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Generic

from fem.batch.runner import ChunkWork, ItemT, Row, Runner
from fem.batch.table import Columns, is_row, line_of, read_lines, row_of, table_of_lines
from fem.case.case import Case
from fem.results.errors import FolderError, FolderLostError
from fem.results.files import write_atomically


class RowLog:
    """Appends lines to a table, each as a whole.

    Args:
        path: of the table; continued behind its last whole line if it has these columns, else begun.
        columns: of the table.
        warn: receives a sentence where lines are no rows, as after a fault of the disk; they are removed.
    """

    def __init__(self, path: Path, columns: Columns, warn: Callable[[str], None]) -> None:
        self._path = path
        there = read_lines(path, columns)
        self.lines = [line for line in there if is_row(columns, line)]  #: already there
        kept = table_of_lines(columns, self.lines).encode()
        if damaged := len(there) - len(self.lines):
            warn(f"{path}: damaged rows, which are computed again: {damaged}")
            write_atomically(path, kept)
        self._file = open(path, "r+b" if self.lines else "wb", buffering=0)  # noqa: SIM115
        if self.lines:
            self._file.truncate(len(kept))
            self._file.seek(len(kept))
        else:
            self._file.write(kept)

    def append(self, lines: Iterable[str]) -> None:
        """Write lines in one go.

        Raises:
            OSError: they cannot be written; FolderLostError: the log was removed.
        """
        if os.fstat(self._file.fileno()).st_nlink == 0:
            raise FolderLostError(self._path.parent)
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
class LoggedRows(Generic[ItemT]):
    """Rows that are kept in a log: none is computed twice, whatever interrupts the study."""

    path: Path  #: of the log
    columns: Columns  #: of the log
    #: values of the first columns; the others are of the row of an item
    key: Callable[[ItemT], Iterable[Any]]
    note: Callable[[str], None] = lambda line: None  #: called with every line of the log, old and new
    logged: Callable[[Row], Row] = lambda row: row  #: a row as the log holds it
    #: all that there may be, where they are known beforehand and their keys tell them apart: their lines are kept
    items: Iterable[ItemT] = ()
    lines: dict[tuple[Any, ...], str] = field(default_factory=dict, init=False)  #: by key

    @cached_property
    def keys(self) -> dict[tuple[Any, ...], ItemT]:
        """The items by key."""
        return {tuple(self.key(item)): item for item in self.items}

    def missing(self, among: Iterable[ItemT] | None = None) -> list[ItemT]:
        """Those of the items, or of some, that have no row yet."""
        chosen = self.keys.values() if among is None else among
        return [item for item in chosen if tuple(self.key(item)) not in self.lines]

    def row(self, item: ItemT) -> Row:
        """The row of an item, by column; empty where it has none."""
        line = self.lines.get(tuple(self.key(item)))
        return {} if line is None else row_of(self.columns, line)

    def table(self) -> str:
        """The rows in the order of their keys."""
        return table_of_lines(self.columns, (line for _, line in sorted(self.lines.items())))

    def compute(
        self,
        runner: Runner,
        batches: Iterable[Sequence[ItemT]],
        rows_of: Callable[[Sequence[ItemT]], Iterable[tuple[Sequence[ItemT], Sequence[Row]]]],
    ) -> None:
        """Note the rows of earlier attempts, then compute the items that are missing.

        Args:
            runner: says when to stop.
            batches: of missing items; each is asked for when all rows before are noted.
            rows_of: items and their rows, as they are ready.

        Raises:
            FolderError: the log holds a row of another study.
        """
        with closing(RowLog(self.path, self.columns, runner.reporter.warning)) as log:
            for line in log.lines:
                try:
                    self._note(line)
                except (AttributeError, LookupError, TypeError, ValueError):
                    raise FolderError(
                        f"{self.path}: damaged, no run of this study has the row {line:.60}; start over with --force"
                    ) from None
            for items in batches:
                if runner.stop():
                    break
                for chunk, rows in rows_of(items):
                    lines = [self._line(item, row) for item, row in zip(chunk, rows, strict=True)]
                    log.append(lines)
                    for line in lines:
                        self._note(line)
            log.sync()

    def _note(self, line: str) -> None:
        if self.keys:
            key = tuple(row_of(self.columns, line).values())[: len(next(iter(self.keys)))]
            self.lines[tuple(self.key(self.keys[key]))] = line  # a LookupError: of no item
        self.note(line)

    def _line(self, item: ItemT, row: Row) -> str:
        key, cells = tuple(self.key(item)), self.logged(row)
        return line_of((*key, *(cells[name] for name in [*self.columns][len(key) :])))


@dataclass(frozen=True, kw_only=True)
class LoggedRuns(LoggedRows[ItemT]):
    """Runs of one kind whose rows are kept in a log."""

    what: str  #: they are, for the line of progress
    make: Callable[[ItemT], Case]  #: the case of an item; picklable
    model_of: Callable[[ItemT], str]
    work: ChunkWork | None = None  #: what is done with some items in place of their runs

    def run(self, runner: Runner, batches: Iterable[Sequence[ItemT]]) -> None:
        """Note the rows of earlier attempts, then run the items that are missing; see `compute`."""
        self.compute(
            runner,
            batches,
            lambda items: runner.rows(self.what, items, self.make, self.model_of, self.work),
        )
