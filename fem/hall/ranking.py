"""What the runs of a hall show, container by container, and which containers are the weakest."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

from fem.batch.checked import CHECKED
from fem.batch.runner import Row
from fem.batch.table import row_of
from fem.hall.plan import Hall, HallItem
from fem.hall.result import OF_A_RUN, OF_MOTIONS, STATIC
from fem.hall.table import ContainerResult, weakness
from fem.model.geometry import build_container
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.results.figures import SLIPPED, TURNED
from fem.results.outcome import Ending, ending_of

RUN_COLUMNS = {"container": int, "motion": int} | OF_A_RUN
CHECK_COLUMNS = {"container": int} | CHECKED
#: rotation ratio below which containers are ranked by the static rule: nothing rocks
ROCKS = 0.01
#: share of the containers, the weakest first, whose run is repeated under stronger motions and with other inputs; at
#: least so many
SHARE, LEAST = 0.1, 30
WORST_FIRST = (Ending.OVERTURNED, Ending.INVALID, Ending.FAILED, Ending.STANDING)


class ContainerRun(NamedTuple):
    """A run of the log."""

    ending: Ending
    turned: float  #: rotation ratio of what stands; how far the others turned does not count
    slip: float
    line: str

    @property
    def weakness(self) -> tuple[float, ...]:
        """Smaller for the worse: overturned, not valid, without an outcome, the larger rotation, the larger slip."""
        return WORST_FIRST.index(self.ending), -self.turned, -self.slip


@dataclass(frozen=True, kw_only=True, eq=False)
class HallRuns:
    """The runs so far, and what their repetition showed."""

    hall: Hall
    by_container: dict[int, dict[int, ContainerRun]] = field(default_factory=dict)  #: and by motion
    checked: dict[int, Row] = field(default_factory=dict)  #: what the repetition showed, by container
    #: of each container, utilisations by `STATIC` under the peak of its governing motion
    static: dict[int, Row] = field(default_factory=dict)

    def note(self, line: str) -> None:
        """Add a line of the log of the runs; IndexError: of a container that is not in the list."""
        row = row_of(RUN_COLUMNS, line)
        item, ending = (
            self.hall.item(row["container"], row["motion"]),
            ending_of(row["status"], row["outcome"]),
        )
        turned = row[TURNED] if ending == Ending.STANDING else None
        run = ContainerRun(ending, turned or 0.0, row[SLIPPED] or 0.0, line)
        self.by_container.setdefault(item.container, {})[item.motion] = run

    def note_check(self, line: str) -> None:
        """Add a line of the log of the repetitions."""
        row = row_of(CHECK_COLUMNS, line)
        self.checked[row.pop("container")] = row

    def missing(self) -> list[HallItem]:
        """Runs that have no line."""
        known = self.by_container
        return [item for item in self.hall.items if item.motion not in known.get(item.container, {})]

    def lines(self) -> list[str]:
        """`runs.csv`, in the order of containers and motions."""
        return [
            run.line
            for _, by_motion in sorted(self.by_container.items())
            for _, run in sorted(by_motion.items())
        ]

    def governing(self, container: int) -> int:
        """The motion under which a container does worst, the first of equals."""
        runs = self.by_container[container]
        return min(sorted(runs), key=lambda motion: runs[motion].weakness)

    def worst(self, container: int) -> ContainerRun:
        """The run under that motion."""
        return self.by_container[container][self.governing(container)]

    def counts(self, container: int) -> tuple[int, ...]:
        """How many motions overturn a container, destroy a corner of it, have no outcome."""
        endings = [run.ending for run in self.by_container[container].values()]
        return tuple(map(endings.count, WORST_FIRST[:3]))

    def to_check(self, checks: str, order: Sequence[int]) -> list[HallItem]:
        """The governing runs that are still to be repeated.

        Args:
            checks: weakest | all | none.
            order: of the containers, the weakest first, before any is repeated.
        """
        count = {"none": 0, "all": len(order)}.get(checks, max(math.ceil(SHARE * len(order)), LEAST))
        ended = [number for number in order if self.worst(number).ending != Ending.FAILED]
        items = [self.hall.item(number, self.governing(number)) for number in ended]
        able = [item for item in items if self.hall.model_of(item) != "full"]
        return [item for item in able[:count] if item.container not in self.checked]

    def find_static(self) -> None:
        """Note the utilisations of the containers, once all are run."""
        for number in self.by_container:
            case = self.hall.make(self.hall.item(number, self.governing(number)))
            peaks = peaks_in_run(case, *build_motions(case))
            ruling = static_checks_of(case, build_container(case), *peaks).ruling.to_result()
            self.static[number] = {name: getattr(ruling, name) for name in STATIC}

    def weakest_first(self) -> list[int]:
        """The containers in the order of their weakness: what overturned comes first, then as `WORST_FIRST`."""
        return sorted(sorted(self.by_container), key=self.weakness)

    def weakness(self, container: int) -> tuple[float, ...]:
        """Smaller for the worse."""
        run = self.worst(container)
        row = self.static[container] | self.checked.get(container, {}) | {SLIPPED: run.slip}
        return weakness(WORST_FIRST.index(run.ending), row, run.turned if run.turned > ROCKS else 0.0)

    def found(self, container: int) -> ContainerResult:
        """What is known of a container."""
        by_motion, governing = self.by_container[container], self.governing(container)
        row = row_of(RUN_COLUMNS, by_motion[governing].line)
        values = {name: row[name] for name in OF_A_RUN} | self.static[container]
        values |= self.checked.get(container, {})
        if names := [pair.name for pair in self.hall.motions]:
            slipped = max(sorted(by_motion), key=lambda number: by_motion[number].slip)
            under = names[governing], *self.counts(container), by_motion[slipped].slip, names[slipped]
            values |= zip(OF_MOTIONS, under, strict=True)
        return ContainerResult(values, self.weakness(container), partial(self.hall.command, motion=governing))
