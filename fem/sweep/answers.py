"""The answer of a sweep: one sentence over all its lines of cells, and a row for each, from its folder alone.

A line holds the cells that differ along one axis alone, and the values that a threshold tried between them.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.batch.answers import Answer, Trial, answer_axis, answer_of, is_rising, sentence_of
from fem.batch.axes import Axis, point_of, set_axis
from fem.batch.labels import axis_name, place_in_words
from fem.batch.table import Columns, read_rows, table_of_rows
from fem.results.figures import FELL_FIRST, RUN_COLUMNS, SLIPPED, TURNED
from fem.results.outcome import ending_of
from fem.sweep.cells import FIGURES
from fem.sweep.motion_outcomes import sign_axes
from fem.sweep.table import SweepTable

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


@dataclass(frozen=True, kw_only=True)
class AnswerRow:
    """The answer of the lines that have some values of the other axes in common."""

    #: these values; without the motion where the row is that of all motions of a set
    point: Mapping[str, Any]
    answer: Answer
    sentence: str


@dataclass(frozen=True, kw_only=True)
class SweepAnswer:
    """What a sweep found along one axis."""

    axis: Axis
    rising: bool  #: the smaller values are the safe ones
    sentence: str  #: of all lines together
    others: tuple[Axis, ...]  #: the axes that distinguish the rows
    rows: tuple[AnswerRow, ...]  #: those of all motions of a set first

    def table(self) -> str:
        """`answers.csv`: one row for each combination of values of the other axes."""
        columns = dict.fromkeys((axis.key for axis in self.others), str) | COLUMNS
        return table_of_rows(columns, map(_cells, self.rows))

    def lines(self) -> Iterator[tuple[str, str]]:
        """Where, and the answer; of a set of motions the rows of all of them; nothing where there are no other axes."""
        of_sets = [row for row in self.rows if len(row.point) < len(self.others)]
        for row in of_sets or self.rows if self.others else ():
            yield self.where(row), row.sentence

    def where(self, row: AnswerRow) -> str:
        """The values of the other axes in words."""
        return place_in_words((axis for axis in self.others if axis.key in row.point), row.point)


def _cells(row: AnswerRow) -> dict[str, Any]:
    """A row of `answers.csv`, by column."""
    answer = row.answer
    ranges = {"stood_again": answer.stood_again, "no_outcome": answer.failed, "unsure": answer.unsure}
    return {
        **row.point,
        "stood_to": answer.stood_to,
        f"stood_{SLIPPED}": answer.stood_slip,
        "overturned_from": answer.overturned_from,
        SLIPPED: answer.slip,
        **{name: "; ".join(f"{low!r} to {high!r}" for low, high in spans) for name, spans in ranges.items()},
        "answer": row.sentence,
    }


def sweep_answer(table: SweepTable, folder: Path) -> SweepAnswer | None:
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

    def rows_of(kept: Sequence[Axis]) -> Iterator[AnswerRow]:
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
                answer=answer,
                sentence=sentence_of(answer, axis, rising=rising, where=where),
            )

    motions = set_axis(others)
    kept = [other for other in others if motions is None or other not in sign_axes(others)]
    outer = [other for other in kept if other is not motions]
    rows = [*rows_of(outer), *rows_of(kept)] if motions and outer else list(rows_of(kept))
    (together,) = rows_of(())
    return SweepAnswer(
        axis=axis,
        rising=rising,
        sentence=f"{axis_name(axis)}: {together.sentence}",
        others=tuple(kept),
        rows=tuple(rows),
    )


def _lines_of(table: SweepTable, axis: Axis, tried: Path) -> dict[int, list[Trial]]:
    """What is known along the axis, by the first cell of each line."""
    dimension = table.axes.index(axis)
    cells = np.moveaxis(np.arange(len(table["cell"])).reshape(table.shape), dimension, -1)
    slip, unsure = table.columns.get(SLIPPED), table.columns.get("unsure")
    fell = table.columns.get("fell_in_row")
    lines: dict[int, list[Trial]] = defaultdict(list)
    for line in cells.reshape(-1, len(axis.values)).tolist():
        for cell, value in zip(line, axis.values, strict=True):
            lines[line[0]].append(
                Trial(
                    value=float(value),
                    line=line[0],
                    kind=ending_of(table["status"][cell], table["outcome"][cell]),
                    slip=None if slip is None or np.isnan(slip[cell]) else float(slip[cell]),
                    unsure=None if unsure is None or np.isnan(unsure[cell]) else bool(unsure[cell]),
                    fell="" if fell is None else str(fell[cell]),
                )
            )
    for row in read_rows(tried, TRIED_COLUMNS):
        first, kind = row["cell"], ending_of(row["status"], row["outcome"])
        fell_first = row["fell_in_row"] or ""
        lines[first].append(
            Trial(value=row["value"], line=first, kind=kind, slip=row[SLIPPED], fell=fell_first)
        )
    return lines
