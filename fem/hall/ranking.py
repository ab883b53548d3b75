"""What the runs of a hall show, container by container, and which containers are the weakest."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from fem.batch.checked import CHECKED
from fem.batch.runner import Row
from fem.batch.table import row_of
from fem.hall.plan import Hall, HallItem
from fem.hall.result import OF_A_RUN
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


@dataclass(frozen=True, kw_only=True)
class ContainerRun:
    """A run of the log."""

    line: str
    ending: Ending
    ratio: float
    slip: float

    @property
    def weakness(self) -> tuple[float, ...]:
        """Smaller for the worse: overturned, not valid, without an outcome, the larger rotation, the larger slip."""
        order = (Ending.OVERTURNED, Ending.INVALID, Ending.FAILED, Ending.STANDING).index(self.ending)
        return order, -self.ratio if self.ending == Ending.STANDING else 0.0, -self.slip


@dataclass(frozen=True, kw_only=True, eq=False)
class HallRuns:
    """The runs so far, and what their repetition showed."""

    hall: Hall
    by_container: dict[int, dict[int, ContainerRun]] = field(default_factory=dict)  #: and by motion
    checked: dict[int, Row] = field(default_factory=dict)  #: what the repetition showed, by container

    def note(self, line: str) -> None:
        """Add a line of the log of the runs; IndexError: of a container that is not in the list."""
        row = row_of(RUN_COLUMNS, line)
        item = self.hall.item(row["container"], row["motion"])
        run = ContainerRun(
            line=line,
            ending=ending_of(row["status"], row["outcome"]),
            ratio=row[TURNED] or 0.0,
            slip=row[SLIPPED] or 0.0,
        )
        self.by_container.setdefault(item.container, {})[item.motion] = run

    def note_check(self, line: str) -> None:
        """Add a line of the log of the repetitions."""
        row = row_of(CHECK_COLUMNS, line)
        self.checked[row.pop("container")] = row

    def missing(self) -> list[HallItem]:
        """Runs that have no line."""
        return [
            item for item in self.hall.items() if item.motion not in self.by_container.get(item.container, {})
        ]

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
        return tuple(map(endings.count, (Ending.OVERTURNED, Ending.INVALID, Ending.FAILED)))

    def to_check(self, checks: str, order: Sequence[int]) -> list[HallItem]:
        """The governing runs that are still to be repeated.

        Args:
            checks: weakest | all | none.
            order: of the containers, the weakest first, before any is repeated.
        """
        count = {"none": 0, "all": len(order)}.get(checks, max(math.ceil(SHARE * len(order)), LEAST))
        items = [self.hall.item(number, self.governing(number)) for number in order]
        ended = [item for item in items if self.worst(item.container).ending != Ending.FAILED]
        able = [item for item in ended if self.hall.model_of(item) != "full"]
        return [item for item in able[:count] if item.container not in self.checked]


def static_use(hall: Hall, item: HallItem) -> tuple[float | None, float | None]:
    """Utilisations of the static rules for sliding and overturning under the peak of a run's own motion."""
    case = hall.cases(item)
    checks = static_checks_of(case, build_container(case), *peaks_in_run(case, *build_motions(case)))
    static = checks.ruling.to_result()
    return static.utilisation_sliding, static.utilisation_overturning


def weakest_first(
    runs: HallRuns, static: Mapping[int, Mapping[str, float | None]], *, margins: bool = True
) -> list[int]:
    """The containers in the order of their weakness.

    What overturned comes first, then what destroyed a corner, then what has no outcome, then what stood; within these
    what has a margin before what has none, by the margin; then by rotation or, where nothing rocks, by the static
    rule; then by slip.
    """

    def weakness(number: int) -> tuple[float, ...]:
        run = runs.worst(number)
        order, _, slip = run.weakness
        check = runs.checked.get(number, {}) if margins else {}
        margin = check.get("margin") or check.get("margin_tried_to")
        turned = -run.ratio if run.ratio > ROCKS and run.ending == Ending.STANDING else 0.0
        known = margin is None, margin or 0.0
        return order, *known, turned, -(static[number]["utilisation_overturning"] or 0.0), slip, number

    return sorted(runs.by_container, key=weakness)
