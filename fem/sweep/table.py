"""The table of a sweep: one row a cell, as it is written and as it is read.

While a sweep runs, rows are appended to `rows.csv` in the order in which they are ready; `table.csv` is written at the
end, in the order of the cells. It has the columns of the log, and those of the perturbed copies.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.batch.axes import Axis, shape_of
from fem.batch.table import Columns, fields_of, read_lines
from fem.results.errors import FolderError
from fem.results.figures import RUN_COLUMNS, TURNED, Shown
from fem.results.kinds import SWEEP, read_result
from fem.runtime.units import RATIO
from fem.sweep.result import SweepResult

#: columns behind the values of axes and derived keys in every row
FOUND = {"status": str} | RUN_COLUMNS | {"reason": str, "wall_s": float}
#: of a cell and its copies
RATIOS = {
    f"band_{TURNED}_low": Shown("rotation ratio, perturbed, least", RATIO),
    f"band_{TURNED}_high": Shown("rotation ratio, perturbed, most", RATIO),
}
#: columns of the perturbed copies of a cell; the width of the band along each numeric axis follows
BAND: Columns = {
    **{"perturbed": int, "unsure": bool, "sure": str, "decided_by": str},
    **dict.fromkeys((*RATIOS, "overturned_share"), float),
}
WIDTH = "band_width."  #: before the key of an axis
WORDS = frozenset(name for name, kind in (FOUND | BAND).items() if kind in (str, tuple))


def row_columns(axes: Sequence[Axis], derived: Iterable[str]) -> Columns:
    """Columns of the row of a run; values of axes and what follows from them are read elsewhere."""
    following = (key for axis in axes for key in axis.following)
    values = (*(axis.key for axis in axes), *following, *derived)
    return {"cell": int} | dict.fromkeys(values, str) | FOUND


def band_columns(axes: Sequence[Axis]) -> tuple[str, ...]:
    """Columns that the band adds."""
    return (*BAND, *(WIDTH + axis.key for axis in axes if axis.is_numeric))


@dataclass(frozen=True, kw_only=True, eq=False)
class SweepTable:
    """A sweep read from its folder: what was asked, and the results."""

    info: SweepResult
    axes: tuple[Axis, ...]
    columns: dict[str, NDArray[Any]]  #: (n_cells,) by name; nan and "" where there is no result

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of each axis."""
        return shape_of(self.axes)

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
        FolderError: it is not the folder of a sweep, or it is damaged.
    """
    folder = Path(folder)
    content = read_result(folder / SWEEP.mark, SWEEP)
    try:
        info = SweepResult.from_json(content)
        axes = tuple(entry.axis for entry in info.axes)
        source = folder / "table.csv"
        if not source.is_file():
            source = folder / "rows.csv"
        names = _header(source, ("cell", *(axis.key for axis in axes), "status", "outcome", TURNED))
        lines = [fields_of(line) for line in read_lines(source, names)]
        if info.state == "finished" and len(lines) != info.cells:
            raise ValueError(
                f"{source.name} has {len(lines)} rows of {info.cells}; recompute it: "
                f"python -m fem sweep {info.sweep} --out {folder} --force"
            )
        return SweepTable(info=info, axes=axes, columns=_columns(axes, names, lines))
    except (KeyError, TypeError, ValueError, IndexError, OSError) as error:
        raise FolderError(f"{folder}: damaged, or not the folder of a sweep ({error})") from None


def _header(source: Path, needed: Sequence[str]) -> list[str]:
    """The columns of a table, those of an earlier version of the program too; ValueError without the needed ones."""
    if not source.is_file():
        return list(needed)
    with source.open(encoding="utf-8", newline="") as stream:
        names = fields_of(stream.readline().rstrip("\n"))
    if missing := [name for name in needed if name not in names]:
        raise ValueError(f"{source.name} has no column {missing[0]!r}")
    return names


def _columns(
    axes: Sequence[Axis], names: Sequence[str], lines: Sequence[Sequence[str]]
) -> dict[str, NDArray[Any]]:
    count = math.prod(shape_of(axes))
    cells = np.array([int(fields[0]) for fields in lines], dtype=np.int64)
    columns: dict[str, NDArray[Any]] = {}
    words = WORDS.union(*(axis.following for axis in axes))
    grids = np.meshgrid(*(np.array(axis.values, dtype=object) for axis in axes), indexing="ij")
    for name, text in zip(names, zip(*lines, strict=True) if lines else [()] * len(names), strict=True):
        if name in words:
            column = np.full(count, "", dtype=object)
            column[cells] = text
        else:
            column = np.full(count, np.nan)
            column[cells] = list(map(_number, text))
        columns[name] = column
    columns["cell"] = np.arange(count)
    for axis, grid in zip(axes, grids, strict=True):
        has_words = any(isinstance(value, str | bool) for value in axis.values)
        columns[axis.key] = grid.ravel() if has_words else grid.ravel().astype(float)
    return columns


def _number(text: str) -> float:
    """A field as a number: nan for an empty one, 1 and 0 for true and false."""
    if text in ("true", "false"):
        return float(text == "true")
    try:
        return float(text) if text else np.nan
    except ValueError:  # a word in a column of numbers, such as "auto"
        return np.nan
