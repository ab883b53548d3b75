"""The rows of a sweep's cells so far."""

from collections import Counter

import numpy as np

from fem.batch.log import fields_of, number_in
from fem.runtime.arrays import BoolArray, FloatArray, IntArray
from fem.sweep.neighbours import OVERTURNED, STANDING, UNKNOWN, kind_of
from fem.sweep.plan import Sweep
from fem.sweep.table import row_columns


class CellRows:
    """The rows of the cells, and what follows from them, cell by cell."""

    def __init__(self, sweep: Sweep) -> None:
        self.columns = row_columns(sweep.axes, (one.key for one in sweep.derived))
        self.lines: dict[int, str] = {}  #: row of each cell, as in the log
        self.kind: IntArray = np.full(sweep.count, UNKNOWN)  #: (n_cells,) see `neighbours`
        self.outcome: list[str] = [""] * sweep.count  #: "" where there is none
        self.rotation_ratio: FloatArray = np.full(sweep.count, np.nan)  #: (n_cells,)
        self.outcomes = Counter[str]()  #: how often there is each; "failed" too
        self._places = [self.columns.index(name) for name in ("status", "outcome", "rotation_ratio")]

    def note(self, line: str) -> None:
        """Add a line of the log."""
        fields = fields_of(line)
        status, outcome, ratio = (fields[place] for place in self._places)
        cell, found = int(fields[0]), number_in(ratio)
        if cell in self.lines:
            return
        self.lines[cell] = line
        self.kind[cell] = kind_of(status, outcome)
        self.outcome[cell] = outcome
        self.rotation_ratio[cell] = np.nan if found is None else found
        self.outcomes[outcome if outcome and status != "failed" else "failed"] += 1

    @property
    def decided(self) -> BoolArray:
        """Whether a cell stands or overturns, shape (n_cells,); what failed does neither."""
        return (self.kind == STANDING) | (self.kind == OVERTURNED)
