"""The rows of a sweep's cells so far."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.batch.table import row_of
from fem.results.figures import (
    BOXES,
    FELL_FIRST,
    RUN_COLUMNS,
    TURNED,
    BoxResult,
    Place,
    RunFigures,
    columns_of,
)
from fem.results.outcome import Ending, ending_of
from fem.runtime.arrays import BoolArray, FloatArray, IntArray
from fem.sweep.plan import Sweep
from fem.sweep.table import SweepTable, row_columns

FIGURES = columns_of(Place.KEY)
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


def shown_at(table: SweepTable, cell: int) -> RunShown:
    """What a cell of a table shows, but for the boxes of a loose stack."""
    outcome, values = str(table["outcome"][cell]), {key: float(table[key][cell]) for key in FIGURES}
    kind = ending_of(str(table["status"][cell]), outcome)
    figures: dict[str, Any] = {key: value for key, value in values.items() if math.isfinite(value)}
    return RunShown(kind=kind, outcome=None if kind is Ending.FAILED else outcome, **figures)


class CellRows:
    """The rows of the cells, and what follows from them, cell by cell."""

    def __init__(self, sweep: Sweep) -> None:
        self.columns = row_columns(sweep.axes, (quantity.key for quantity in sweep.derived))
        self.lines: dict[int, str] = {}  #: row of each cell, as in the log
        self.runs: dict[int, RunShown] = {}
        self.kind: IntArray = np.full(sweep.count, Ending.UNKNOWN)  #: endings, (n_cells,)
        self.ratio: FloatArray = np.full(sweep.count, np.nan)  #: (n_cells,)
        self.outcomes = Counter[str]()  #: how often there is each; "failed" too

    def note(self, line: str) -> None:
        """Add a line of the log."""
        row = row_of(self.columns, line)
        cell = row["cell"]
        if cell in self.lines:
            return
        run = shown_in(row)
        self.lines[cell], self.runs[cell], self.kind[cell] = line, run, run.kind
        if row[TURNED] is not None:
            self.ratio[cell] = row[TURNED]
        self.outcomes[run.outcome or "failed"] += 1

    @property
    def decided(self) -> BoolArray:
        """Whether a cell stands or overturns, shape (n_cells,); what failed or is not valid does neither."""
        return (self.kind == Ending.STANDING) | (self.kind == Ending.OVERTURNED)
