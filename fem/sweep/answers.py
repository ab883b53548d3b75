"""The answer of a sweep: one sentence over all its lines of cells, and a row for each, from its folder alone.

A line holds the cells that differ along one axis alone, and the values that a threshold tried between them.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.batch.answers import (
    Answer,
    Trial,
    answer_axis,
    answer_of,
    is_rising,
    sentence_of,
)
from fem.batch.axes import Axis, point_of
from fem.batch.labels import axis_name, place_in_words
from fem.batch.log import fields_of, number_in, table_text
from fem.sweep.neighbours import KIND_NAMES, kind_of
from fem.sweep.table import SweepTable

TRIED = "tried.csv"
#: columns of `answers.csv` behind those of the other axes
COLUMNS = ("stood_to", "overturned_from", "max_slip_m", "stood_again", "no_outcome", "unsure", "answer")


@dataclass(frozen=True, kw_only=True)
class SweepAnswer:
    """What a sweep found along one axis."""

    axis: Axis
    rising: bool  #: the smaller values are the safe ones
    sentence: str  #: of all lines together
    others: tuple[Axis, ...]  #: the axes that tell its lines apart
    rows: tuple[
        tuple[Mapping[str, Any], Answer, str], ...
    ]  #: values of the other axes, answer, the answer in words

    def table(self) -> str:
        """`answers.csv`: one row for each combination of values of the other axes."""
        return table_text((*(axis.key for axis in self.others), *COLUMNS), map(self._row, self.rows))

    def lines(self) -> Iterator[tuple[str, str]]:
        """The values of the other axes in words, and the answer; nothing where there are no other axes."""
        for point, _, sentence in self.rows if self.others else ():
            yield place_in_words(self.others, point), sentence

    def _row(self, row: tuple[Mapping[str, Any], Answer, str]) -> Iterator[Any]:
        point, answer, sentence = row
        yield from (point[axis.key] for axis in self.others)
        yield from (answer.stood_to, answer.overturned_from, answer.slip)
        for ranges in (answer.stood_again, answer.failed, answer.unsure):
            yield "; ".join(f"{low!r} to {high!r}" for low, high in ranges)
        yield sentence


def sweep_answer(table: SweepTable, folder: Path) -> SweepAnswer | None:
    """The answer of a sweep; None where no axis asks for one, or cells are missing.

    Args:
        table: of the sweep.
        folder: where the values are that a threshold tried between the cells.
    """
    wanted = (table.info.get("threshold") or {}).get("axis")
    axis = next((one for one in table.axes if one.key == wanted), None) or answer_axis(table.axes)
    if axis is None or not np.all(table["status"] != ""):
        return None
    lines = _lines_of(table, axis, folder / TRIED)
    trials = [trial for line in lines.values() for trial in line]
    rising = is_rising(axis, trials)
    others = tuple(one for one in table.axes if one is not axis and len(one.values) > 1)
    rows = []
    for first, line in lines.items():
        answer = answer_of(line, rising=rising)
        rows.append((point_of(table.axes, first), answer, sentence_of(answer, axis, rising=rising)))
    together = answer_of(trials, rising=rising)
    where = "" if together.line is None else place_in_words(others, point_of(table.axes, together.line))
    sentence = sentence_of(together, axis, rising=rising, where=where)
    return SweepAnswer(
        axis=axis,
        rising=rising,
        sentence=f"{axis_name(axis)}: {sentence}",
        others=others,
        rows=tuple(rows),
    )


def _lines_of(table: SweepTable, axis: Axis, tried: Path) -> dict[int, list[Trial]]:
    """What is known along the axis, by the first cell of each line."""
    place = table.axes.index(axis)
    cells = np.moveaxis(np.arange(len(table["cell"])).reshape(table.shape), place, -1)
    slip, unsure = table.columns.get("max_slip_m"), table.columns.get("unsure")
    lines: dict[int, list[Trial]] = defaultdict(list)
    for line in cells.reshape(-1, len(axis.values)).tolist():
        for cell, value in zip(line, axis.values, strict=True):
            lines[line[0]].append(
                Trial(
                    value=float(value),
                    line=line[0],
                    kind=KIND_NAMES[kind_of(table["status"][cell], table["outcome"][cell])],
                    slip=None if slip is None or np.isnan(slip[cell]) else float(slip[cell]),
                    unsure=None if unsure is None or np.isnan(unsure[cell]) else bool(unsure[cell]),
                )
            )
    for first, value, status, outcome, slip_between in _between(tried):
        kind = KIND_NAMES[kind_of(status, outcome)]
        lines[first].append(Trial(value=value, line=first, kind=kind, slip=slip_between))
    return lines


def _between(path: Path) -> Iterator[tuple[int, float, str, str, float | None]]:
    """First cell of the line, value, status, outcome and slip of what was tried between cells."""
    if not path.is_file():
        return
    header, *lines = path.read_text(encoding="utf-8").splitlines()
    names = fields_of(header)
    for line in lines:
        row = dict(zip(names, fields_of(line), strict=False))
        slip = number_in(row.get("max_slip_m", ""))
        yield int(row["cell"]), float(row["value"]), row["status"], row["outcome"], slip
