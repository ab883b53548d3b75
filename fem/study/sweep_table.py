"""The result of a sweep as typed data: what `sweep.json` holds; its rows are in tables."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.results.errors import FolderError
from fem.results.figures import FELL_FIRST, RUN_COLUMNS, TURNED, Place, Shown, columns_of
from fem.results.kinds import SWEEP, read_result, typed_result
from fem.runtime.units import RATIO
from fem.study.axes import Axis, shape_of
from fem.study.design import DesignResult
from fem.study.table import Columns, fields_of, read_lines

FIGURES = columns_of(Place.KEY)


@dataclass(frozen=True, kw_only=True)
class SweepResult(DesignResult):
    """What was asked of a sweep, and what it found."""

    sweep_hash: str  #: equal for sweeps whose rows are the same
    sweep: str = ""  #: its name
    band_hash: str | None = None  #: equal for sweeps that are perturbed and refined in the same way
    base_hash: str = ""
    perturbation: dict[str, Any] = field(default_factory=dict)
    uncertainty: dict[str, Any] = field(default_factory=dict)
    left_out: str = ""  #: by the copies, of the band of a run, in words
    threshold: dict[str, Any] | None = None
    jobs: int = 1
    wall_s: float | None = None
    cells: int = 0
    rows: int = 0  #: cells that are there
    outcomes: dict[str, int] = field(default_factory=dict)  #: how many there are of each
    perturbed: int = 0  #: cells that have copies
    copies: int = 0
    unsure: int | None = None  #: cells; None without copies
    sure: dict[str, int] | None = None  #: how many cells are sure, regime unsure, unsure
    decided_by: dict[str, int] | None = None  #: how many unsure cells each input decides
    changes: int | None = None  #: of outcome, refined; None where none are asked for
    map_axes: dict[str, Any] = field(default_factory=dict)
    maps: tuple[str, ...] = ()


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


@dataclass(frozen=True, kw_only=True, eq=False)
class SweepTable:
    """A sweep read from its folder: what was asked, and the results."""

    info: SweepResult
    columns: dict[str, NDArray[Any]]  #: (n_cells,) by name; nan and "" where there is no result

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Of the sweep."""
        return self.info.axes

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

    @property
    def outcome(self) -> NDArray[Any]:
        """Outcome of each cell; "failed" where it failed, "" where it was not computed."""
        return np.where(self["status"] == "failed", "failed", self["outcome"])


def open_sweep(folder: Path | str) -> SweepTable:
    """Read the folder of a sweep, a running or interrupted one too, and one of an earlier version of the program.

    FolderError where it is not the folder of a sweep, or it is damaged.
    """
    folder = Path(folder)
    mark = folder / SWEEP.mark
    info = typed_result(SweepResult, read_result(mark, SWEEP), mark)
    try:
        names: list[str] = ["cell", *(axis.key for axis in info.axes), "status", "outcome", TURNED]
        sources = [path for name in ("table.csv", "rows.csv") if (path := folder / name).is_file()]
        for source in sources[:1]:
            with source.open(encoding="utf-8", newline="") as stream:
                needed, names = names, fields_of(stream.readline().rstrip("\n"))
            if missing := [name for name in needed if name not in names]:
                raise ValueError(f"{source.name} has no column {missing[0]!r}")
        lines = [fields_of(line) for source in sources[:1] for line in read_lines(source, names)]
        if info.state == "finished" and len(lines) != info.cells:
            raise ValueError(
                f"table.csv has {len(lines)} rows of {info.cells}; recompute it: "
                f"python -m fem sweep {info.sweep} --out {folder} --force"
            )
        count, words = math.prod(shape_of(info.axes)), WORDS.union(*(axis.following for axis in info.axes))
        cells = np.array([int(fields[0]) for fields in lines], dtype=np.int64)
        columns: dict[str, NDArray[Any]] = {}
        for name, text in zip(names, zip(*lines, strict=True) if lines else [()] * len(names), strict=True):
            columns[name] = np.full(count, "", dtype=object) if name in words else np.full(count, np.nan)
            columns[name][cells] = text if name in words else list(map(_number, text))
        columns["cell"] = np.arange(count)
        grids = np.meshgrid(*(np.array(axis.values, dtype=object) for axis in info.axes), indexing="ij")
        for axis, grid in zip(info.axes, grids, strict=True):
            has_words = len(axis.numbers) < len(axis.values)
            columns[axis.key] = grid.ravel() if has_words else grid.ravel().astype(float)
        return SweepTable(info=info, columns=columns)
    except (KeyError, TypeError, ValueError, IndexError, OSError) as error:
        raise FolderError(f"{mark}: damaged, its axes or table are of another sweep ({error})") from None


def _number(text: str) -> float:
    """A field as a number: nan for an empty one and a word such as "auto", 1 and 0 for true and false."""
    try:
        return float({"true": 1.0, "false": 0.0}.get(text, text))
    except ValueError:
        return np.nan


#: what a threshold tries between cells, by the first cell of the line
TRIED = "tried.csv"
TRIED_COLUMNS: Columns = {"cell": int, "value": float, "status": str, "outcome": str, TURNED: float}
TRIED_COLUMNS |= {"reason": str} | FIGURES | {key: RUN_COLUMNS[key] for key in FELL_FIRST}
