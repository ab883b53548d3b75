"""The rows of a sweep's cells so far."""

from collections import Counter
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fem.batch.log import fields_of, number_in, numbers_in
from fem.batch.runner import BOXES
from fem.results.outcome import Ending, ending_of
from fem.runtime.arrays import BoolArray, FloatArray, IntArray
from fem.sweep.plan import Sweep
from fem.sweep.table import row_columns

#: columns of what a row shows
SHOWN = ("status", "outcome", "rotation_ratio", "max_slip_m", "fell_box", *BOXES)


class BoxShown(NamedTuple):
    """What a box of a loose stack shows; slip and opening over what is below it."""

    max_rotation_rad: float
    max_slip_m: float
    max_opening_m: float


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What a cell, or a copy of it, shows."""

    kind: Ending
    outcome: str | None  #: None where it failed
    rotation_ratio: float | None
    max_slip_m: float | None
    fell_box: int | None = None  #: of a loose stack, as the following
    boxes: tuple[BoxShown, ...] = ()


def shown_in(
    status: str, outcome: str, ratio: str, slip: str, fell_box: str, rotations: str, slips: str, openings: str
) -> Shown:
    """What the fields of a row show, those of `SHOWN`."""
    kind = ending_of(status, outcome)
    return Shown(
        kind=kind,
        outcome=None if kind is Ending.FAILED else outcome,
        rotation_ratio=number_in(ratio),
        max_slip_m=number_in(slip),
        fell_box=int(fell_box) if fell_box else None,
        boxes=tuple(map(BoxShown, *map(numbers_in, (rotations, slips, openings)))),
    )


class CellRows:
    """The rows of the cells, and what follows from them, cell by cell."""

    def __init__(self, sweep: Sweep) -> None:
        self.columns = row_columns(sweep.axes, (one.key for one in sweep.derived))
        self.lines: dict[int, str] = {}  #: row of each cell, as in the log
        self.shown: dict[int, Shown] = {}
        self.kind: IntArray = np.full(sweep.count, Ending.UNKNOWN)  #: endings, (n_cells,)
        self.rotation_ratio: FloatArray = np.full(sweep.count, np.nan)  #: (n_cells,)
        self.outcomes = Counter[str]()  #: how often there is each; "failed" too
        self._places = [self.columns.index(name) for name in SHOWN]

    def note(self, line: str) -> None:
        """Add a line of the log."""
        fields = fields_of(line)
        cell = int(fields[0])
        if cell in self.lines:
            return
        shown = shown_in(*(fields[place] for place in self._places))
        self.lines[cell], self.shown[cell], self.kind[cell] = line, shown, shown.kind
        if shown.rotation_ratio is not None:
            self.rotation_ratio[cell] = shown.rotation_ratio
        self.outcomes[shown.outcome or "failed"] += 1

    @property
    def decided(self) -> BoolArray:
        """Whether a cell stands or overturns, shape (n_cells,); what failed does neither."""
        return (self.kind == Ending.STANDING) | (self.kind == Ending.OVERTURNED)
