"""The history of a run: one row a sample on an exact time grid, as a table in memory and as CSV.

SI units, named in the columns; x positive to the right, z up, rotation positive toward +x, forces on the
container. Numbers are written so that reading them gives the same bits (shortest exact decimal form). The
file grows by whole lines and is readable while the run goes on and after it was killed.
"""

import contextlib
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

#: Columns of `history.csv`; the last is a word, all others are numbers.
HISTORY_COLUMNS = (
    "time_s",
    "base_displacement_m",
    "base_velocity_m_s",
    "base_acceleration_m_s2",
    "rotation_rad",
    "angular_velocity_rad_s",
    "slip_m",
    "uplift_m",
    "centre_x_m",
    "centre_z_m",
    "normal_force_N",
    "shear_force_N",
    "kinetic_J",
    "strain_J",
    "potential_J",
    "imbalance_J",
    "mode",
)
NUMBERS = len(HISTORY_COLUMNS) - 1
HEADER = ",".join(HISTORY_COLUMNS) + "\n"


@dataclass(frozen=True, kw_only=True, eq=False)
class History:
    """Samples of a run, in the order of `HISTORY_COLUMNS`.

    Raises:
        ValueError: arrays whose shapes do not fit the columns or each other.
    """

    values: FloatArray  #: shape (n_samples, 16), units as in the columns' names
    modes: tuple[str, ...]  #: state of motion at each sample, length n_samples

    def __post_init__(self) -> None:
        if self.values.shape != (len(self.modes), NUMBERS):
            raise ValueError(
                f"history: {self.values.shape} numbers for {len(self.modes)} modes; {NUMBERS} columns needed"
            )

    @classmethod
    def empty(cls) -> Self:
        """No samples."""
        return cls(values=np.zeros((0, NUMBERS)), modes=())

    def __len__(self) -> int:
        return len(self.modes)

    def __getitem__(self, column: str) -> FloatArray:
        """A column of numbers by its name, shape (n_samples,); KeyError names the columns there are."""
        try:
            return self.values[:, HISTORY_COLUMNS[:NUMBERS].index(column)]
        except ValueError:
            raise KeyError(f"no column {column!r}; known: {', '.join(HISTORY_COLUMNS[:NUMBERS])}") from None


class HistoryWriter:
    """Appends samples to a history file; a context manager.

    A line is one write to the file, with nothing held back, so a kill leaves whole lines. When the disk is
    full, the part of a line that went through is cut off again before the error is passed on.

    Args:
        path: the file; made anew, unless `position` is given.
        position: where an interrupted run had come to (`position` of its writer); what follows is cut off.

    Raises:
        ValueError: a position beyond the end of the file, which then is not that run's.
        OSError: the file cannot be made or written.
    """

    def __init__(self, path: Path, *, position: int | None = None) -> None:
        self.path = path
        if position is None:
            self._file = open(path, "wb", buffering=0)  # noqa: SIM115 (closed by `close`)
            self._position = 0
            try:
                self._write(HEADER)
            except OSError:
                self._file.close()
                raise
            return
        if not path.is_file() or path.stat().st_size < position:
            raise ValueError(f"{path}: the history ends before byte {position}, where the run is to go on")
        self._file = open(path, "r+b", buffering=0)  # noqa: SIM115
        self._position = position
        self._file.truncate(position)
        self._file.seek(position)

    @property
    def position(self) -> int:
        """Bytes of the whole lines written so far: what a checkpoint needs to go on from here."""
        return self._position

    def append(self, rows: FloatArray, modes: Sequence[str]) -> None:
        """Write samples: rows of numbers, shape (n, 16), and their modes, length n."""
        if rows.shape != (len(modes), NUMBERS):
            raise ValueError(
                f"history: {rows.shape} numbers for {len(modes)} modes; {NUMBERS} columns are needed"
            )
        for row, mode in zip(rows.tolist(), modes, strict=True):
            self._write(",".join(map(repr, row)) + f",{mode}\n")

    def close(self) -> None:
        """Close the file; closing twice does no harm."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _write(self, line: str) -> None:
        data = line.encode()
        try:
            done = 0
            while done < len(data):
                done += self._file.write(data[done:])
        except OSError:
            with contextlib.suppress(OSError):  # the first error is the one to tell
                os.ftruncate(self._file.fileno(), self._position)
                self._file.seek(self._position)
            raise
        self._position += len(data)


def read_history(path: Path) -> History:
    """Read a history file, that of a running or killed run too: a last line without its end is left out.

    Raises:
        ValueError: other columns than `HISTORY_COLUMNS`, or a line that does not hold them (named).
        OSError: the file cannot be read.
    """
    text = path.read_text(encoding="utf-8")
    lines = text[: text.rfind("\n") + 1].splitlines()
    if not lines or lines[0] != HEADER.strip():
        raise ValueError(f"{path}: not a history; its first line must be {HEADER.strip()}")
    values, modes = np.empty((len(lines) - 1, NUMBERS)), []
    for number, line in enumerate(lines[1:]):
        *fields, mode = line.split(",")
        try:
            values[number] = [float(field) for field in fields]
        except ValueError:
            raise ValueError(f"{path}, line {number + 2}: {NUMBERS} numbers and a mode are needed") from None
        modes.append(mode)
    return History(values=values, modes=tuple(modes))
