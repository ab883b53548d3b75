"""The table of a sweep: one row a cell, as it grows, as it is kept, and as it is read.

While a sweep runs, rows are appended to `rows.csv` by whole lines in the order in which they come; a kill leaves whole
lines and at most one broken one, which is cut off when the sweep goes on. `table.csv` is written at the end, in
the order of the cells, and replaced whole. Both have the same columns up to the band's, which only the table has.
"""

import csv
import io
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from fem.batch.axes import Axis
from fem.batch.runner import SCALARS
from fem.results.run_folder import FolderError, write_atomically

#: what stands behind the values of axes and derived keys in every row
FOUND = ("status", *SCALARS, "reason", "wall_s")
#: what the perturbed copies of a cell say; the width of the band along each numeric axis follows
BAND = ("perturbed", "unsure", "band_rotation_ratio_low", "band_rotation_ratio_high")
WIDTH = "band_width."  #: before the key of an axis
WORDS = frozenset({"status", "outcome", "reason"})
TRUTHS = frozenset({"restored", "unsure"})
SYNC_S = 2.0


def row_columns(axes: Sequence[Axis], derived: Iterable[str]) -> tuple[str, ...]:
    """Columns of a row as it comes from a run."""
    return ("cell", *(axis.key for axis in axes), *derived, *FOUND)


def band_columns(axes: Sequence[Axis]) -> tuple[str, ...]:
    """Columns that the band adds."""
    return (*BAND, *(WIDTH + axis.key for axis in axes if axis.is_numeric))


def line_of(values: Iterable[Any]) -> str:
    """Values as a line of a table, without its end."""
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow([_text(value) for value in values])
    return text.getvalue()


def _text(value: Any) -> str:
    """Numbers in the shortest form that reads back to the same bits; nothing for None; text on one line."""
    if value is None:
        return ""
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, float | np.floating):
        return repr(float(value))
    return " ".join(str(value).split())


class RowLog:
    """Appends lines to a file, each as a whole; a context manager.

    Args:
        path: the file; made anew with `header` unless it begins with it already: then it is gone on with, behind
            its last whole line.
        header: the first line.
    """

    def __init__(self, path: Path, header: str) -> None:
        self.lines = read_lines(path, header)
        length = sum(len(line.encode()) + 1 for line in [header, *self.lines])
        self._file = open(path, "r+b" if self.lines else "wb", buffering=0)  # noqa: SIM115
        if self.lines:
            self._file.truncate(length)
            self._file.seek(length)
        else:
            self._file.write(header.encode() + b"\n")

    def append(self, lines: Sequence[str]) -> None:
        """Write lines in one go."""
        data = "".join(f"{line}\n" for line in lines).encode()
        done = 0
        while done < len(data):
            done += self._file.write(data[done:])

    def sync(self) -> None:
        """See to it that what was written survives a power cut as well."""
        os.fsync(self._file.fileno())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()


def read_lines(path: Path, header: str) -> list[str]:
    """The whole lines of a log behind its header; none if the file is missing, or begins otherwise."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except FileNotFoundError:
        return []
    lines = text[: text.rfind("\n") + 1].split("\n")[:-1]
    return lines[1:] if lines[:1] == [header] else []


def fields_of(line: str) -> list[str]:
    """The fields of one line."""
    return next(csv.reader([line]))


def write_table(path: Path, columns: Sequence[str], lines: Iterable[str]) -> None:
    """Replace the table."""
    write_atomically(path, "".join(f"{line}\n" for line in [line_of(columns), *lines]))


@dataclass(frozen=True, kw_only=True, eq=False)
class SweepTable:
    """A sweep as it lies in its folder: what was asked, and what was found."""

    info: dict[str, Any]  #: as in sweep.json
    axes: tuple[Axis, ...]
    columns: dict[str, NDArray[Any]]  #: (n_cells,) by name; nan and "" where nothing was found

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    def __getitem__(self, column: str) -> NDArray[Any]:
        """A column, one value a cell; KeyError names the columns there are."""
        try:
            return self.columns[column]
        except KeyError:
            raise KeyError(f"no column {column!r}; known: {', '.join(self.columns)}") from None

    def grid(self, column: str) -> NDArray[Any]:
        """A column in the shape of the axes."""
        return self[column].reshape(self.shape)

    @property
    def outcome(self) -> NDArray[Any]:
        """Outcome of each cell; "failed" where it failed, "" where it was not computed."""
        return np.where(self["status"] == "failed", "failed", self["outcome"])


def open_sweep(folder: Path | str) -> SweepTable:
    """Read the folder of a sweep, a running or interrupted one too.

    Raises:
        FolderError: it is no folder of a sweep, or damaged.
    """
    folder = Path(folder)
    info = read_info(folder)
    try:
        axes = tuple(
            Axis(key=one["key"], values=tuple(one["values"]), scale=one["scale"], unit=one["unit"])
            for one in info["axes"]
        )
        rows = row_columns(axes, info["derived"])
        names = (*rows, *band_columns(axes))
        source = folder / "table.csv"
        if not source.is_file():
            source, names = folder / "rows.csv", rows
        lines = [fields_of(line) for line in read_lines(source, line_of(names))]
        if info["status"] in ("completed", "failed") and len(lines) != info["cells"]:
            raise ValueError(
                f"{source.name} has {len(lines)} rows of {info['cells']}; compute it again: "
                f"python -m fem sweep {info['sweep']} --out {folder} --force"
            )
        return SweepTable(info=info, axes=axes, columns=_columns(info, axes, names, lines))
    except (KeyError, TypeError, ValueError, IndexError, OSError) as error:
        raise FolderError(f"{folder}: damaged, or not the folder of a sweep ({error})") from None


def read_info(folder: Path) -> dict[str, Any]:
    """The content of `sweep.json`.

    Raises:
        FolderError: there is none, or it is not one.
    """
    path = folder / "sweep.json"
    try:
        info = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FolderError(
            f"{path}: cannot be read ({error.strerror}); is this the folder of a sweep?"
        ) from None
    except ValueError:
        info = None
    if not isinstance(info, dict) or not isinstance(info.get("sweep_hash"), str):
        raise FolderError(f"{path}: damaged, or not that of a sweep")
    return info


def _columns(
    info: Mapping[str, Any], axes: Sequence[Axis], names: Sequence[str], lines: Sequence[Sequence[str]]
) -> dict[str, NDArray[Any]]:
    count = int(np.prod([len(axis.values) for axis in axes]))
    cells = np.array([int(fields[0]) for fields in lines], dtype=np.int64)
    columns: dict[str, NDArray[Any]] = {}
    grids = np.meshgrid(*(np.array(axis.values, dtype=object) for axis in axes), indexing="ij")
    for name, text in zip(names, zip(*lines, strict=True) if lines else [()] * len(names), strict=True):
        if name in WORDS:
            column = np.full(count, "", dtype=object)
            column[cells] = text
        else:
            column = np.full(count, np.nan)
            column[cells] = [_number(one) for one in text]
        columns[name] = column
    columns["cell"] = np.arange(count)
    for axis, grid in zip(axes, grids, strict=True):
        words = any(isinstance(value, str | bool) for value in axis.values)
        columns[axis.key] = grid.ravel() if words else grid.ravel().astype(float)
    return columns


def _number(text: str) -> float:
    """A field as a number: nan for an empty one, 1 and 0 for true and false."""
    if text in ("true", "false"):
        return float(text == "true")
    try:
        return float(text) if text else np.nan
    except ValueError:  # a word in a column of numbers, such as "auto"
        return np.nan
