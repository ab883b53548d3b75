"""The result of a sweep as typed data: what `sweep.json` holds; its rows are in tables."""

import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.results.errors import FolderError
from fem.results.figures import (
    BOXES,
    FELL_FIRST,
    RUN_COLUMNS,
    SLIPPED,
    TURNED,
    BoxResult,
    Place,
    RunFigures,
    Shown,
    columns_of,
)
from fem.results.kinds import SWEEP, read_result
from fem.results.outcome import Ending, ending_of
from fem.runtime.arrays import BoolArray, FloatArray, IntArray
from fem.runtime.units import RATIO
from fem.study.answers import (
    Answer,
    AnswerRow,
    StudyAnswer,
    Trial,
    answer_axis,
    answer_of,
    is_rising,
    sentence_of,
)
from fem.study.axes import (
    Axis,
    axis_name,
    place_in_words,
    point_of,
    set_axis,
    shape_of,
    sign_axes,
)
from fem.study.design import Sweep
from fem.study.driver import StudyResult
from fem.study.table import Columns, fields_of, read_lines, read_rows, row_of, table_of_rows

FIGURES = columns_of(Place.KEY)


@dataclass(frozen=True, kw_only=True)
class SweepResult(StudyResult):
    """What was asked of a sweep, and what it found."""

    sweep_hash: str  #: equal for sweeps whose rows are the same
    sweep: str = ""  #: its name
    title: str = ""
    case: str = ""  #: name of the base case
    band_hash: str | None = None  #: equal for sweeps that are perturbed and refined in the same way
    base_hash: str = ""
    model: str = ""
    duration_s: float | str = "auto"
    motion_covered: str | None = None  #: the part of the motion that the runs cover, where they end before it
    axes: tuple[Axis, ...]
    derived: dict[str, str] = field(default_factory=dict)
    held: str = ""  #: of the unknown inputs, in words
    perturbation: dict[str, Any] = field(default_factory=dict)
    uncertainty: dict[str, Any] = field(default_factory=dict)
    left_out: str = ""  #: by the copies, of the band of a run, in words
    limit_slip_m: float | None = None  #: beyond which a cell does not stand in the answer
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


def band_columns(axes: Sequence[Axis]) -> tuple[str, ...]:
    """Columns that the band adds."""
    return (*BAND, *(WIDTH + axis.key for axis in axes if axis.is_numeric))


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

    def grid(self, column: str) -> NDArray[Any]:
        """A column in the shape of the axes."""
        return self[column].reshape(self.shape)

    @property
    def outcome(self) -> NDArray[Any]:
        """Outcome of each cell; "failed" where it failed, "" where it was not computed."""
        return np.where(self["status"] == "failed", "failed", self["outcome"])


def open_sweep(folder: Path | str) -> SweepTable:
    """Read the folder of a sweep, a running or interrupted one too, and one of an earlier version of the program.

    Raises:
        FolderError: it is not the folder of a sweep, or it is damaged.
    """
    folder = Path(folder)
    content = read_result(folder / SWEEP.mark, SWEEP)
    try:
        info = SweepResult.from_json(content)
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
        return SweepTable(info=info, columns=_columns(info.axes, names, lines))
    except (KeyError, TypeError, ValueError, IndexError, OSError) as error:
        raise FolderError(f"{folder}: damaged, or not the folder of a sweep ({error})") from None


def _columns(
    axes: Sequence[Axis], names: Sequence[str], lines: Sequence[Sequence[str]]
) -> dict[str, NDArray[Any]]:
    count, words = math.prod(shape_of(axes)), WORDS.union(*(axis.following for axis in axes))
    cells = np.array([int(fields[0]) for fields in lines], dtype=np.int64)
    columns: dict[str, NDArray[Any]] = {}
    for name, text in zip(names, zip(*lines, strict=True) if lines else [()] * len(names), strict=True):
        columns[name] = np.full(count, "", dtype=object) if name in words else np.full(count, np.nan)
        columns[name][cells] = text if name in words else list(map(_number, text))
    columns["cell"] = np.arange(count)
    grids = np.meshgrid(*(np.array(axis.values, dtype=object) for axis in axes), indexing="ij")
    for axis, grid in zip(axes, grids, strict=True):
        has_words = any(isinstance(value, str | bool) for value in axis.values)
        columns[axis.key] = grid.ravel() if has_words else grid.ravel().astype(float)
    return columns


def _number(text: str) -> float:
    """A field as a number: nan for an empty one and a word such as "auto", 1 and 0 for true and false."""
    try:
        return float({"true": 1.0, "false": 0.0}.get(text, text))
    except ValueError:
        return np.nan


#: what a threshold tries between cells, by the first cell of the line
TRIED = "tried.csv"
TRIED_COLUMNS = {
    "cell": int,
    "value": float,
    "status": str,
    "outcome": str,
    TURNED: float,
    "reason": str,
} | FIGURES
TRIED_COLUMNS |= {key: RUN_COLUMNS[key] for key in FELL_FIRST}
#: columns of `answers.csv` behind those of the other axes
COLUMNS: Columns = dict.fromkeys(("stood_to", f"stood_{SLIPPED}", "overturned_from", SLIPPED), float)
COLUMNS |= dict.fromkeys(("stood_again", "no_outcome", "unsure", "answer"), str)


def answers_csv(answer: StudyAnswer[Answer]) -> str:
    """`answers.csv`: one row for each combination of values of the other axes."""

    def cells(row: AnswerRow[Answer]) -> dict[str, Any]:
        found = row.found
        ranges = {"stood_again": found.stood_again, "no_outcome": found.failed, "unsure": found.unsure}
        words = {key: "; ".join(f"{a!r} to {b!r}" for a, b in spans) for key, spans in ranges.items()}
        numbers = found.stood_to, found.stood_slip, found.overturned_from, found.slip
        return {**row.point, **dict(zip(COLUMNS, numbers, strict=False)), **words, "answer": row.sentence}

    return table_of_rows(
        dict.fromkeys((axis.key for axis in answer.others), str) | COLUMNS, map(cells, answer.rows)
    )


def sweep_answer(table: SweepTable, folder: Path) -> StudyAnswer[Answer] | None:
    """The answer of a sweep; None where no axis asks for one, or cells are missing.

    The signs of a motion are no rows of their own: a motion stands where it stands with either sign.

    Args:
        table: of the sweep.
        folder: where the values are that a threshold tried between the cells.
    """
    wanted = (table.info.threshold or {}).get("axis")
    axis = next((axis for axis in table.axes if axis.key == wanted), None) or answer_axis(table.axes)
    if axis is None or not np.all(table["status"] != ""):
        return None
    lines = _lines_of(table, axis, folder / TRIED)
    rising = is_rising(axis, [trial for line in lines.values() for trial in line])
    others = [other for other in table.axes if other is not axis and len(other.values) > 1]

    def rows_of(kept: Sequence[Axis]) -> Iterator[AnswerRow[Answer]]:
        """A row for each combination of values of some of the other axes."""
        groups: dict[tuple[Any, ...], list[Trial]] = defaultdict(list)
        for first, line in lines.items():
            point = point_of(table.axes, first)
            groups[tuple(point[other.key] for other in kept)] += line
        for values, trials in groups.items():
            answer = answer_of(trials, rising=rising, limit_slip=table.info.limit_slip_m)
            rest = [other for other in others if other not in kept]
            where = "" if answer.line is None else place_in_words(rest, point_of(table.axes, answer.line))
            yield AnswerRow(
                point=dict(zip((other.key for other in kept), values, strict=True)),
                found=answer,
                sentence=sentence_of(answer, axis, rising=rising, where=where),
            )

    motions = set_axis(others)
    kept = [other for other in others if motions is None or other not in sign_axes(others)]
    outer = [other for other in kept if other is not motions]
    rows = [*rows_of(outer), *rows_of(kept)] if motions and outer else list(rows_of(kept))
    (together,) = rows_of(())
    return StudyAnswer(
        axis=axis,
        rising=rising,
        sentence=f"{axis_name(axis)}: {together.sentence}",
        others=tuple(kept),
        rows=tuple(rows),
    )


def _lines_of(table: SweepTable, axis: Axis, tried: Path) -> dict[int, list[Trial]]:
    """What is known along the axis, by the first cell of each line."""
    cells = np.moveaxis(np.arange(len(table["status"])).reshape(table.shape), table.axes.index(axis), -1)
    nothing = np.full(len(table["status"]), np.nan)
    slip, unsure = (table.columns.get(name, nothing) for name in (SLIPPED, "unsure"))
    fell = table.columns.get("fell_in_row")
    lines: dict[int, list[Trial]] = defaultdict(list)
    for line in cells.reshape(-1, len(axis.values)).tolist():
        for cell, value in zip(line, axis.values, strict=True):
            trial = Trial(
                value=float(value),
                line=line[0],
                kind=ending_of(table["status"][cell], table["outcome"][cell]),
                slip=None if np.isnan(slip[cell]) else float(slip[cell]),
                unsure=None if np.isnan(unsure[cell]) else bool(unsure[cell]),
                fell="" if fell is None else str(fell[cell]),
            )
            lines[line[0]].append(trial)
    for row in read_rows(tried, TRIED_COLUMNS):
        kind, fell_first = ending_of(row["status"], row["outcome"]), row["fell_in_row"] or ""
        lines[row["cell"]].append(Trial(row["value"], row["cell"], kind, row[SLIPPED], fell=fell_first))
    return lines


#: columns of what a row shows
SHOWN = {"status": str} | {key: RUN_COLUMNS[key] for key in ("outcome", *FIGURES, *FELL_FIRST, *BOXES)}


@dataclass(frozen=True, kw_only=True)
class RunShown(RunFigures):
    """What a cell, or a copy of it, shows."""

    kind: Ending


def shown_in(row: Mapping[str, Any]) -> RunShown:
    """What a row shows, by the names of `SHOWN`."""
    kind = ending_of(row["status"], row["outcome"])
    boxes = zip(*(row[name] or () for name in BOXES), strict=True)
    return RunShown(
        kind=kind,
        outcome=None if kind is Ending.FAILED else row["outcome"],
        boxes=tuple(BoxResult(**dict(zip(BOXES.values(), box, strict=True))) for box in boxes),
        **{key: row[key] for key in (*FELL_FIRST, *FIGURES)},
    )


class CellRows:
    """The rows of the cells, and what follows from them, cell by cell."""

    def __init__(self, sweep: Sweep) -> None:
        following = (key for axis in sweep.axes for key in axis.following)
        #: of the row of a run; values of axes and what follows from them are read elsewhere
        self.columns: Columns = {"cell": int}
        self.columns |= (
            dict.fromkeys((*(axis.key for axis in sweep.axes), *following, *sweep.derived), str) | FOUND
        )
        self.runs: dict[int, RunShown] = {}
        self.kind: IntArray = np.full(sweep.count, Ending.UNKNOWN)  #: endings, (n_cells,)
        self.ratio: FloatArray = np.full(sweep.count, np.nan)  #: (n_cells,)
        self.outcomes = Counter[str]()  #: how often there is each; "failed" too

    def note(self, line: str) -> None:
        """Add a line of the log."""
        row = row_of(self.columns, line)
        cell, run = row["cell"], shown_in(row)
        self.runs[cell], self.kind[cell] = run, run.kind
        if row[TURNED] is not None:
            self.ratio[cell] = row[TURNED]
        self.outcomes[run.outcome or "failed"] += 1

    @property
    def decided(self) -> BoolArray:
        """Whether a cell stands or overturns, shape (n_cells,); what failed or is not valid does neither."""
        return (self.kind == Ending.STANDING) | (self.kind == Ending.OVERTURNED)
