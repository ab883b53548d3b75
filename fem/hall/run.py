"""A hall from its list to its folder: runs, the weakest of them repeated, the list with results, page.

The runs are logged as they are ready, so an interrupted hall continues where it was; its files depend neither on that
nor on the number of cores. A hall of which names, tags or places alone have changed is written again, not computed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Literal, Unpack

from fem.batch.axes import MOTION_FILE, VERTICAL_FILE
from fem.batch.checked import CHECKED, check_chunk
from fem.batch.log import LoggedRuns
from fem.batch.motion_set import motions_left_out
from fem.batch.runner import Row, Runner
from fem.batch.study import INTERRUPTED, StudyOptions, hash_of, run_study, runner_of
from fem.batch.table import row_of, table_of_lines, table_text
from fem.case.case import Case
from fem.case.validation import CaseError
from fem.hall.file import HallFile
from fem.hall.plan import Hall, HallItem, read_motions, say_time
from fem.hall.result import OF_A_RUN, OF_MOTIONS, STATIC, HallResult
from fem.hall.study import WORST_FIRST, ContainerResult, study_of, weakness, written
from fem.model.geometry import build_container
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.results.disk import table_bytes
from fem.results.folder import ResultFolder
from fem.results.outcome import COUNTED_AS, Ending, counts_of
from fem.sweep.cells import RunShown, shown_in

RUNS, CHECKS = "runs.csv", "checks.csv"
RUN_COLUMNS = {"container": int, "motion": int} | OF_A_RUN
CHECK_COLUMNS = {"container": int} | CHECKED
#: share of the containers, the weakest first, whose run is repeated under stronger motions and with other inputs; at
#: least so many
SHARE, LEAST = 0.1, 30
Checks = Literal["weakest", "all", "none"]


def run_hall(
    file: HallFile,
    base: Case,
    folder: Path,
    *,
    motions: tuple[str, ...] = (),
    checks: Checks = "weakest",
    strict: bool = False,
    **options: Unpack[StudyOptions],
) -> HallResult:
    """Compute a hall into a folder; raises as `run_study`, and CaseError for bad input.

    Args:
        base: the case that its rows change.
        motions: files of motions in place of that of the case, "H" or "H,V" each; every container undergoes all.
        checks: which governing runs are repeated for `sure` and `margin`: those of the weakest tenth and of at least
            30 containers, all, or none.
        strict: refuse the list for one bad row.
    """
    with runner_of(**options) as runner:
        say_time(file, base, max(len(motions), 1), runner, force=options.get("force", False))
        if motions and (named := [key for key in file.keys if key in (MOTION_FILE, VERTICAL_FILE)]):
            raise CaseError(f"{file.name}: column {named[0]!r} and --motion both name the motion; use one")
        pairs = read_motions(base, motions, runner) if motions else ()
        hall = Hall(file=file, base=base, motions=pairs, named=motions, containers={})
        hall = hall.checked(hall.hash_of, strict=strict)
        options["workers_of"] = runner.workers_of
        study = study_of(
            hall,
            HallRuns(hall=hall).compute,
            asked=hash_of([[*hall.containers], [pair.case_hash for pair in pairs]]),
            listed=hash_of([file.table.text, checks]),
            motions=motions,
            motion_covered=motions_left_out(base, pairs),
            checks=checks,
        )
        size = study.size + 2.0 * table_bytes(len(hall.items), len(RUN_COLUMNS))
        study = replace(
            study, size=size, cases=[] if pairs else [base], motions=[pair.case for pair in pairs]
        )
        return run_study(study, folder, **options)


@dataclass(frozen=True, kw_only=True, eq=False)
class HallRuns:
    """The runs so far, and what their repetition showed."""

    hall: Hall
    lines: dict[tuple[int, int], str] = field(default_factory=dict)  #: of the log, by container and motion
    #: what they show, by container and by motion
    by_container: dict[int, dict[int, RunShown]] = field(default_factory=dict)
    checked: dict[int, Row] = field(default_factory=dict)  #: what the repetition showed, by container

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

        def order(motion: int) -> tuple[float, ...]:
            run = runs[motion]
            turned = run.turned if run.kind == Ending.STANDING else 0.0
            return WORST_FIRST.index(COUNTED_AS[run.kind]), -turned, -run.slipped

        return min(sorted(runs), key=order)

    def counts(self, container: int) -> tuple[int, ...]:
        """How many motions overturn a container, destroy a corner of it, have no outcome."""
        counts = counts_of([run.kind for run in self.by_container[container].values()])
        return tuple(counts[ending] for ending in WORST_FIRST[:3])

    def to_check(self, checks: str, order: Sequence[int]) -> list[HallItem]:
        """The governing runs that are still to be repeated; `order` has the weakest first, before any is repeated."""
        count = {"none": 0, "all": len(order)}.get(checks, max(math.ceil(SHARE * len(order)), LEAST))
        worst = [self.hall.item(number, self.governing(number)) for number in order]
        ended = [item for item in worst if self.by_container[item[0]][item[1]].kind != Ending.FAILED]
        able = [item for item in ended if self.hall.model_of(item) != "full"]
        return [item for item in able[:count] if item.container not in self.checked]

    def row(self, container: int) -> Row:
        """The results of a container: those of its governing run, the static rule under its peak, all motions."""
        by_motion, governing = self.by_container[container], self.governing(container)
        case = self.hall.make(self.hall.item(container, governing))
        peaks = peaks_in_run(case, *build_motions(case))
        ruling = static_checks_of(case, build_container(case), *peaks).ruling.to_result()
        run = row_of(RUN_COLUMNS, self.lines[container, governing])
        row = {name: run[name] for name in OF_A_RUN} | {name: getattr(ruling, name) for name in STATIC}
        if names := [pair.name for pair in self.hall.motions]:
            slipped = max(sorted(by_motion), key=lambda number: by_motion[number].slipped)
            under = names[governing], *self.counts(container), by_motion[slipped].slipped, names[slipped]
            row |= zip(OF_MOTIONS, under, strict=True)
        return row

    def compute(self, begun: HallResult, results: ResultFolder, runner: Runner) -> HallResult:
        """Compute what is missing, and write the list with its results, and its page."""
        hall, total = self.hall, len(self.hall.items)
        logged = partial(LoggedRuns[HallItem], make=hall.make, model_of=hall.model_of)
        logged(
            what="runs",
            path=results.path / RUNS,
            columns=RUN_COLUMNS,
            key=lambda item: item[:2],
            note=self.note,
            number=lambda item: item.container * len(hall.keys) + item.motion,
        ).run(runner, iter(self.missing, []))
        if missing := len(self.missing()):
            words = f"{total - missing} of {total} runs are computed"
            return replace(begun, status=INTERRUPTED, runs=total - missing, missing=words)
        rows = [self.row(container) for container in range(len(hall.values))]
        order = sorted(range(len(rows)), key=lambda container: weakness(rows[container]))
        to_check = partial(self.to_check, begun.checks, order)
        logged(
            what="containers repeated with other inputs and stronger motions",
            path=results.path / CHECKS,
            columns=CHECK_COLUMNS,
            key=lambda item: item[:1],
            note=self.note_check,
            work=check_chunk,
        ).run(runner, iter(to_check, []))
        begun = replace(begun, runs=total, checked=len(self.checked))
        if left := len(to_check()):
            return replace(
                begun, status=INTERRUPTED, missing=f"{left} of the weakest are still to be repeated"
            )
        results.check()
        results.write_text(
            RUNS, table_of_lines(RUN_COLUMNS, (line for _, line in sorted(self.lines.items())))
        )
        checked = sorted(self.checked.items())
        results.write_text(CHECKS, table_text(CHECK_COLUMNS, ([k, *check.values()] for k, check in checked)))
        found = [
            ContainerResult(
                row | self.checked.get(container, {}), partial(hall.command, motion=self.governing(container))
            )
            for container, row in enumerate(rows)
        ]
        return written(results, begun, hall, found)
