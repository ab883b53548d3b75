"""The history of a run: one row a sample on an exact time grid, as a table in memory and as CSV.

SI units, named in the columns; x positive to the right, z up, rotation positive toward +x, forces on the container.
Numbers are written so that reading them gives the same bits (shortest exact decimal form).

Which columns there are: `fem.case.columns`. A kill during a write may leave the last line without its end.
"""

import contextlib
import hashlib
import importlib
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NoReturn, Self

import numpy as np

from fem.case import columns
from fem.runtime.arrays import FloatArray
from fem.runtime.own_files import appended, write_atomically
from fem.runtime.user_files import read_text

(ANALYTIC_COLUMN,) = columns.ANALYTIC.names((0,))
KNOWN = frozenset(column.name for group in columns.GROUPS for column in group.columns)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class History(dict[str, Any]):
    """Samples of a run: name of a column -> its samples, shape (n_samples,), so that pandas takes it as a table."""

    numbers: tuple[str, ...]  #: names of the columns
    samples: FloatArray  #: (n_samples, n_columns), in the units that the names end with
    modes: tuple[str, ...]  #: state of motion at each sample, length n_samples

    def __post_init__(self) -> None:
        self.update(zip(self.numbers, self.samples.T, strict=True))
        self[columns.MODE] = np.array(self.modes, dtype=str)

    @classmethod
    def empty(cls) -> Self:
        """No samples."""
        numbers = numbers_of(columns.ALWAYS.names((0,)))
        return cls(numbers=numbers, samples=np.zeros((0, len(numbers))), modes=())

    @property
    def joints(self) -> int:
        """Joints between bolted boxes."""
        return sum(name.startswith("joint_") for name in self.numbers) // len(columns.JOINTS.columns)

    @property
    def vertical(self) -> bool:
        """Whether the floor moves up and down."""
        return columns.VERTICAL.columns[0].name in self

    def with_analytic(self, rotation: FloatArray) -> Self:
        """These samples with the rotation of the rigid block as last column, shape (n_samples,) [rad]."""
        values = np.column_stack([self.samples, rotation])
        return replace(self, numbers=(*self.numbers, ANALYTIC_COLUMN), samples=values)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column; empty of a pure number."""
        units = {column.name: column.unit for group in columns.GROUPS for column in group.columns}
        return {name: units.get(re.sub(r"_\d+_", "_{}_", name), "") for name in self.numbers}

    def to_dataframe(self) -> Any:
        """A table of pandas, with the states of motion as its last column; ImportError without pandas."""
        try:
            pandas = importlib.import_module("pandas")
        except ModuleNotFoundError:
            raise ImportError(
                "a table of pandas needs pandas: python -m pip install pandas; or take history[column]"
            ) from None
        return pandas.DataFrame(self)

    def __repr__(self) -> str:
        """One line, for a notebook."""
        return f"<history: {len(self.modes)} samples of {', '.join(self.numbers)}>"

    def __missing__(self, column: str) -> NoReturn:
        raise KeyError(f"no column {column!r}; known: {', '.join(self)}")


class HistoryWriter:
    """Appends samples to a history file; a context manager.

    The lines of one `append` are written at once. When the disk is full, those that were written are cut off again
    before the error is raised.

    Args:
        path: the file; replaced unless `position` is given.
        names: of all columns, for the header.
        position: length of the file to resume from (`position` of its writer); what follows is cut off.

    Raises:
        ValueError: a position beyond the end of the file.
        OSError: the file cannot be made or written.
    """

    def __init__(self, path: Path, names: Sequence[str], *, position: int | None = None) -> None:
        self.path = path
        self._digest = hashlib.sha256()
        self._mode = names.index(columns.MODE)
        if position is None:
            header = ",".join(names) + "\n"
            write_atomically(path, header)
            position = len(header)
        if not path.is_file() or path.stat().st_size < position:
            raise ValueError(f"{path}: the history ends before byte {position}, where the run is to resume")
        self._file = appended(path, position)
        self._position = position
        self._file.seek(0)
        while self._file.tell() < position:
            self._digest.update(self._file.read(min(position - self._file.tell(), 1 << 20)))

    @property
    def position(self) -> int:
        """Bytes of the whole lines written so far, for a checkpoint."""
        return self._position

    @property
    def digest(self) -> str:
        """SHA-256 of these bytes."""
        return self._digest.hexdigest()

    def sync(self) -> None:
        """Bring the file to the disk."""
        os.fsync(self._file.fileno())

    def append(self, rows: FloatArray, modes: Sequence[str]) -> None:
        """Write samples: rows of numbers, in the columns of the header without `mode`, and their modes, length n."""
        lines = [list(map(repr, row)) for row in rows.tolist()]
        for words, mode in zip(lines, modes, strict=True):
            words.insert(self._mode, mode)
        self._write("".join(",".join(words) + "\n" for words in lines))

    def close(self) -> None:
        """Close the file; closing twice does no harm."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _write(self, text: str) -> None:
        data = text.encode()
        try:
            done = 0
            while done < len(data):
                done += self._file.write(data[done:])
        except OSError as error:
            with contextlib.suppress(OSError):  # the first error is the one to report
                os.ftruncate(self._file.fileno(), self._position)
                self._file.seek(self._position)
            raise OSError(error.errno, error.strerror, str(self.path)) from None
        self._position += len(data)
        self._digest.update(data)


def read_history(path: Path) -> History:
    """Read a history file, also of a running or killed run: a last line without its end is left out.

    Raises:
        ValueError: columns that no history has, or a line that does not hold them (named).
        OSError: the file cannot be read.
    """
    lines = _whole_lines(path)
    names = tuple(lines[0].split(",")) if lines else ()
    if (
        names[:1] != ("time_s",)
        or columns.MODE not in names
        or not KNOWN.issuperset(re.sub(r"(?<=_)\d+(?=_)", "{}", name) for name in names)
    ):
        raise ValueError(
            f"{path}: not a history; its first line must be {','.join(columns.ALWAYS.names((0,)))} .."
        )
    column, numbers = names.index(columns.MODE), numbers_of(names)
    values, modes = np.empty((len(lines) - 1, len(numbers))), []
    for number, line in enumerate(lines[1:]):
        fields = line.split(",")
        modes.append("".join(fields[column : column + 1]))
        try:
            values[number] = list(map(float, fields[:column] + fields[column + 1 :]))
        except ValueError:
            raise ValueError(
                f"{path}, line {number + 2}: {len(numbers)} numbers and a mode are needed"
            ) from None
    return History(numbers=numbers, samples=values, modes=tuple(modes))


def numbers_of(names: Sequence[str]) -> tuple[str, ...]:
    """The columns that are numbers."""
    return tuple(name for name in names if name != columns.MODE)


def add_analytic_rotation(path: Path, rotation: FloatArray) -> None:
    """Add the rigid block's rotation to a finished history, as its last column.

    Args:
        path: the file; a column of that name is replaced.
        rotation: at each sample, shape (n_samples,) [rad]; nan where the block is not followed.

    Raises:
        ValueError: not as many rotations as samples.
        OSError: the file cannot be read or written.
    """
    header, *rows = _whole_lines(path)
    if len(rows) != len(rotation):
        raise ValueError(f"{path}: {len(rotation)} rotations for {len(rows)} samples")
    if header.endswith("," + ANALYTIC_COLUMN):
        header, *rows = (line.rpartition(",")[0] for line in (header, *rows))
    lines = [f"{header},{ANALYTIC_COLUMN}"]
    lines += [f"{row},{value!r}" for row, value in zip(rows, rotation.tolist(), strict=True)]
    write_atomically(path, "\n".join(lines) + "\n")


def _whole_lines(path: Path) -> list[str]:
    text = read_text(path)
    return text[: text.rfind("\n") + 1].splitlines()
