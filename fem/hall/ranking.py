"""What the runs of a hall show, container by container, and which containers are the weakest."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

from fem.batch.checked import CHECKED
from fem.batch.runner import Row
from fem.batch.table import row_of
from fem.hall.plan import Hall, HallItem
from fem.hall.result import OF_A_RUN, OF_MOTIONS, STATIC
from fem.hall.table import ContainerResult, weakness
from fem.model.geometry import build_container
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.results.figures import SLIPPED
from fem.results.outcome import Ending
from fem.sweep.cells import RunShown, shown_in

RUN_COLUMNS = {"container": int, "motion": int} | OF_A_RUN
CHECK_COLUMNS = {"container": int} | CHECKED
#: rotation ratio below which containers are ranked by the static rule: nothing rocks
ROCKS = 0.01
#: share of the containers, the weakest first, whose run is repeated under stronger motions and with other inputs; at
#: least so many
SHARE, LEAST = 0.1, 30
WORST_FIRST = (Ending.OVERTURNED, Ending.INVALID, Ending.FAILED, Ending.STANDING)


@dataclass(frozen=True, kw_only=True, eq=False)
class HallRuns:
    """The runs so far, and what their repetition showed."""

    hall: Hall
    lines: dict[tuple[int, int], str] = field(default_factory=dict)  #: of the log, by container and motion
    #: what they show, by container and by motion
    by_container: dict[int, dict[int, RunShown]] = field(default_factory=dict)
    checked: dict[int, Row] = field(default_factory=dict)  #: what the repetition showed, by container
    #: of each container, utilisations by `STATIC` under the peak of its governing motion
    static: dict[int, Row] = field(default_factory=dict)

    def note(self, line: str) -> None:
        """Add a line of the log of the runs; IndexError: of a container that is not in the list."""
        row = row_of(RUN_COLUMNS, line)
        item = self.hall.item(row["container"], row["motion"])
        self.lines[item.container, item.motion] = line
        self.by_container.setdefault(item.container, {})[item.motion] = shown_in(row)

    def note_check(self, line: str) -> None:
        """Add a line of the log of the repetitions."""
        row = row_of(CHECK_COLUMNS, line)
        self.checked[row.pop("container")] = row

    def missing(self) -> list[HallItem]:
        """Runs that have no line."""
        return [item for item in self.hall.items if item[:2] not in self.lines]

    def governing(self, container: int) -> int:
        """The motion under which a container does worst, the first of equals."""
        runs = self.by_container[container]
        return min(sorted(runs), key=lambda motion: _weakness(runs[motion], {}))

    def counts(self, container: int) -> tuple[int, ...]:
        """How many motions overturn a container, destroy a corner of it, have no outcome."""
        endings = [run.kind for run in self.by_container[container].values()]
        return tuple(map(endings.count, WORST_FIRST[:3]))

    def to_check(self, checks: str, order: Sequence[int]) -> list[HallItem]:
        """The governing runs that are still to be repeated.

        Args:
            checks: weakest | all | none.
            order: of the containers, the weakest first, before any is repeated.
        """
        count = {"none": 0, "all": len(order)}.get(checks, max(math.ceil(SHARE * len(order)), LEAST))
        worst = [self.hall.item(number, self.governing(number)) for number in order]
        ended = [item for item in worst if self.by_container[item[0]][item[1]].kind != Ending.FAILED]
        able = [item for item in ended if self.hall.model_of(item) != "full"]
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
        run = self.by_container[container][self.governing(container)]
        return _weakness(run, self.static[container] | self.checked.get(container, {}), ROCKS)

    def found(self, container: int) -> ContainerResult:
        """What is known of a container."""
        by_motion, governing = self.by_container[container], self.governing(container)
        row = row_of(RUN_COLUMNS, self.lines[container, governing])
        values = {name: row[name] for name in OF_A_RUN} | self.static[container]
        values |= self.checked.get(container, {})
        if names := [pair.name for pair in self.hall.motions]:
            slipped = max(sorted(by_motion), key=lambda number: by_motion[number].slipped)
            under = names[governing], *self.counts(container), by_motion[slipped].slipped, names[slipped]
            values |= zip(OF_MOTIONS, under, strict=True)
        return ContainerResult(values, self.weakness(container), partial(self.hall.command, motion=governing))


def _weakness(run: RunShown, row: Row, rocks: float = 0.0) -> tuple[float, ...]:
    """Smaller for the worse; only what stands counts as far as it turned, and that from `rocks` on."""
    turned = run.turned if run.kind == Ending.STANDING and run.turned > rocks else 0.0
    return weakness(WORST_FIRST.index(run.kind), row | {SLIPPED: run.slipped}, turned)
