"""What a sweep knows of its cells so far: their rows, and what their perturbed copies say."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from fem.runtime.arrays import FloatArray, IntArray
from fem.sweep.neighbours import OVERTURNED, STANDING, kind_of
from fem.sweep.table import fields_of


@dataclass(kw_only=True)
class Found:
    """What is known of the cells so far."""

    lines: dict[int, str] = field(default_factory=dict)  #: row of each cell, as it stands in the log
    kind: IntArray  #: (n_cells,) see `band`
    rotation_ratio: FloatArray  #: (n_cells,)
    outcomes: dict[str, int] = field(default_factory=dict)  #: how often each was found; "failed" too

    def note(self, cell: int, line: str, status: str, outcome: str | None, ratio: float | None) -> None:
        """Enter a cell's row."""
        self.lines[cell] = line
        self.kind[cell] = kind_of(status, outcome)
        self.rotation_ratio[cell] = np.nan if ratio is None else ratio
        word = outcome if outcome and status != "failed" else "failed"
        self.outcomes[word] = self.outcomes.get(word, 0) + 1


@dataclass(frozen=True, kw_only=True)
class Member:
    """A perturbed copy of a cell."""

    line: str  #: as it stands in the log
    kind: int  #: see `band`
    ratio: float | None  #: rotation ratio


@dataclass(kw_only=True)
class Band:
    """What the perturbed copies say."""

    members: dict[int, dict[int, Member]] = field(default_factory=dict)  #: by cell and number

    def note(self, line: str) -> None:
        """Enter a line of the log."""
        cell, member, _, status, outcome, ratio, _ = fields_of(line)
        found = Member(line=line, kind=kind_of(status, outcome), ratio=float(ratio) if ratio else None)
        self.members.setdefault(int(cell), {})[int(member)] = found

    def is_unsure(self, cell: int, kind: int) -> bool:
        """Whether a copy is of another kind than the cell; of a cell that failed nothing is sure."""
        kinds = {member.kind for member in self.members.get(cell, {}).values()}
        return kind not in (STANDING, OVERTURNED) or bool(kinds - {kind})

    def lines(self) -> Iterator[str]:
        """The log, in the order of cells and members."""
        for cell in sorted(self.members):
            yield from (self.members[cell][member].line for member in sorted(self.members[cell]))
