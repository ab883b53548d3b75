"""A list of containers: which differ, the run of each under each motion, the weakest repeated, the list with results.

The runs are logged as they are ready, so an interrupted list continues where it was; its files depend neither on that
nor on the number of cores. A list of which names or tags alone have changed is written again, not computed.
"""

import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any, Literal, Unpack

from fem.case.case import Case, case_hash
from fem.case.data_files import as_named_from
from fem.case.tables.unknown_inputs import excluded_values
from fem.case.toml import toml_document, toml_value
from fem.case.validation import CaseError
from fem.model.geometry import build_container
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.results.disk import table_bytes
from fem.results.figures import SLIPPED, TURNED
from fem.results.folder import ResultFolder
from fem.results.kinds import HALL
from fem.results.outcome import COUNTED_AS, ending_of
from fem.run.expected import expected_s, expected_words, say_expected
from fem.runtime.identity import command_line
from fem.study.axes import MOTION_FILE, VERTICAL_FILE, AxisError, read_axis
from fem.study.design import CaseMaker, Design, Item
from fem.study.driver import (
    COMPLETED,
    FAILED,
    INTERRUPTED,
    LoggedRuns,
    Study,
    StudyOptions,
    hash_of,
    run_study,
    runner_of,
)
from fem.study.list_file import (
    LISTED,
    OF_A_RUN,
    OF_MOTIONS,
    REFUSED,
    RESULT_COLUMNS,
    STATIC,
    HallFile,
    HallResult,
    HallRow,
)
from fem.study.motions import FloorMotionPair, motions_left_out, read_motion_set
from fem.study.runner import CHECKED, Row, Runner, check_chunk

TABLE, RUNS, CHECKS = "hall.csv", "runs.csv", "checks.csv"
RUN_COLUMNS = {"container": int, "motion": int} | OF_A_RUN
CHECK_COLUMNS = {"container": int} | CHECKED
MOST_RUNS = 200_000  #: unless it is forced
MOST_NAMED = 20  #: bad rows in a refusal
OF_A_ROW = 3e-3  #: processor time of checking a row [s]
#: share of the containers, the weakest first, whose run is repeated under stronger motions and with other inputs; at
#: least so many
SHARE, LEAST = 0.1, 30
Checks = Literal["weakest", "all", "none"]
WORST_FIRST = ("overturned", "invalid", "failed", "stood")  #: what a container counts as
ROCKS = 0.01  #: rotation ratio up to which what stands is ranked by the static rule: nothing rocks


@dataclass(frozen=True, kw_only=True, eq=False)
class Hall(Design):
    """A list of containers, and the motions that they undergo."""

    file: HallFile
    one_side: bool = False  #: look only at the side that is given as the width
    motions: tuple[FloorMotionPair, ...] = ()  #: in place of that of the base case
    named: tuple[str, ...] = ()  #: these, as they were named on the command line
    rows: tuple[HallRow, ...] = ()  #: each with its container, or why it is refused
    containers: Mapping[str, HallRow] = field(default_factory=dict)  #: by hash, the first row of each

    @cached_property
    def keys(self) -> list[Mapping[str, Any]]:
        """Those that set each motion; of the motion of the base case none."""
        return [pair.keys for pair in self.motions] or [{}]

    @cached_property
    def make(self) -> CaseMaker:
        """Makes the cases of runs."""
        base = _with_files_of_the_command_line(self.base) if self.motions else self.base
        return CaseMaker(base.without_fields())

    @property
    def items(self) -> list[Item]:
        """All runs; those of a container follow one another, and those across stand behind the others."""
        return [
            Item(number, motion + side * len(self.keys), keys, row.values, more=turned)
            for number, row in enumerate(self.containers.values())
            for side, turned in enumerate([{}, row.across][: 1 + bool(row.across)])
            for motion, keys in enumerate(self.keys)
        ]

    def command(self, item: Item, values: Mapping[str, Any]) -> str:
        """The command that computes a run by itself, with the values of a row."""
        origin = self.base.origin_with({})
        words = ["run", origin.place, *["--allow-outside"] * origin.allow_outside]
        if self.named:
            words += ["--motion", self.named[item.draw % len(self.named)].partition(",")[0].strip()]
        for override in self.base.overrides:
            words += ["--set", override]
        # with a vertical file of a pair, or that a motion among pairs has none
        set_by_motion = {key: value for key, value in item.point.items() if key != MOTION_FILE}
        for key, value in {**set_by_motion, **values, **item.more}.items():
            words += ["--set", f"{key}={value if isinstance(value, str) else toml_value(value)}"]
        return command_line(*words)

    def first_of(self, values: Mapping[str, Any]) -> Case:
        """A container's case under the first motion, once its mesh and motions can be built.

        Raises:
            CaseError, MeshError, RecordError: what a run would be refused for.
        """
        moved = any(key.startswith(("motion.", "vertical.")) for key in values)
        first = self.make.case(Item(0, 0, self.keys[0], values))
        if reasons := excluded_values(first):
            raise CaseError("\n".join(reasons))
        build_container(first)
        for keys in self.keys if moved else self.keys[:1]:
            build_motions(self.make.case(Item(0, 0, keys, values)))
        return first

    def checked(self) -> "Hall":
        """The list with every row checked before any is computed; equal rows are one container.

        Raises:
            CaseError: no good row.
        """
        containers, numbers = dict[str, HallRow](), dict[str, int]()  # by hash: the first row, and its number
        seen: dict[str, dict[str, Any]] = {}  # by what a row sets: its container, or why it is refused
        rows = []
        for row in self.file.rows:
            values = repr(sorted(row.values.items()))
            if not row.reason and values not in seen:
                try:
                    first = self.first_of(row.values)
                    narrower = first.container.depth_m < first.container.width_m and not self.one_side
                    digest = case_hash(first)
                    containers.setdefault(digest, replace(row, across=first.turned if narrower else {}))
                    seen[values] = {"container": numbers.setdefault(digest, len(numbers))}
                except ValueError as error:
                    seen[values] = {"reason": _in_words_of_list(str(error), self.base)}
            rows.append(row if row.reason else replace(row, **seen[values]))
        if not containers:
            bad = [f"{self.name}, line {row.line} ({row.name}): {row.reason}" for row in rows]
            more = [f"and {len(bad) - MOST_NAMED} more rows"] * (len(bad) > MOST_NAMED)
            raise CaseError("\n".join([*bad[:MOST_NAMED], *more, "no row can be computed"]))
        return replace(self, rows=tuple(rows), containers=containers)


def _read_motions(base: Case, named: Sequence[str], runner: Runner) -> tuple[FloorMotionPair, ...]:
    """Motions named on the command line, from anywhere: files "H" or "H,V"; a large set is read by the workers."""
    pairs = [[as_named_from(base.folder, name.strip()) for name in pair.split(",")] for pair in named]
    try:
        axis = read_axis(MOTION_FILE, [pair if len(pair) > 1 else pair[0] for pair in pairs])
    except AxisError as error:
        raise CaseError(f"--motion {error}") from None
    return read_motion_set(_with_files_of_the_command_line(base), [axis], runner)


def _with_files_of_the_command_line(base: Case) -> Case:
    """The base case with motions from anywhere."""
    origin = base.origin_with({})
    trusted = origin.trusted | {MOTION_FILE, VERTICAL_FILE}
    return base.from_origin(replace(origin, trusted=trusted, allow_outside=True))


def _in_words_of_list(reason: str, base: Case) -> str:
    """Why a case cannot be used, on one line, without mention of the command line."""
    lines = (
        re.sub(r" \(--set \S+?=.*\)$", "", line.removeprefix(f"{base.origin_with({}).place}: "))
        for line in reason.splitlines()
    )
    return "; ".join(line for line in lines if line and not line.startswith("with --set "))


def _ending_in(row: Row) -> str:
    """What a row counts as."""
    return REFUSED if row["status"] == REFUSED else COUNTED_AS[ending_of(row["status"], row["outcome"])]


def weakness(row: Row) -> tuple[float, ...]:
    """Smaller for the worse: by what it counts as, by margin, by rotation, by the static rule, by slip.

    Of a run alone neither margin nor static rule are known.
    """
    ending, margin = _ending_in(row), row.get("margin") or row.get("margin_tried_to")
    turned, static, slip = (row.get(name) or 0.0 for name in (TURNED, "utilisation_overturning", SLIPPED))
    if ending in WORST_FIRST[:3] or (static and turned <= ROCKS):
        turned = 0.0
    return WORST_FIRST.index(ending), margin is None, margin or 0.0, -turned, -static, -slip


def run_hall(
    file: HallFile,
    base: Case,
    folder: Path,
    *,
    motions: tuple[str, ...] = (),
    checks: Checks = "weakest",
    one_side: bool = False,
    **options: Unpack[StudyOptions],
) -> HallResult:
    """Compute a hall into a folder; raises as `run_study`, and CaseError for bad input.

    Args:
        base: the case that its rows change.
        motions: files of motions in place of that of the case, "H" or "H,V" each; every container undergoes all.
        checks: which governing runs are repeated for `sure` and `margin`: those of the weakest tenth and of at least
            30 containers, all, or none.
        one_side: of a container with a narrower side across, too, look at its width alone; else the worse governs.
    """
    with runner_of(**options) as runner:
        rows, each, under = file.table.count, 1.0, max(len(motions), 1)
        with suppress(ValueError):  # of a case that cannot be used the rows say why
            each = expected_s(base)
        seconds = rows * (under * each / runner.jobs + OF_A_ROW)
        words = f"{file.name}: {rows} rows" + (f" under {under} motions" if under > 1 else "")
        if rows * under > MOST_RUNS and not options.get("force", False):
            raise CaseError(
                f"{words}, {rows * under} runs: {expected_words(seconds, runner.jobs)}; take fewer rows, or use --force"
            )
        say_expected(runner.reporter, words, seconds, runner.jobs)
        if motions and (named := [key for key in file.keys if key in (MOTION_FILE, VERTICAL_FILE)]):
            raise CaseError(f"{file.name}: column {named[0]!r} and --motion both name the motion; use one")
        pairs = _read_motions(base, motions, runner) if motions else ()
        hall = Hall(
            name=file.name, file=file, base=base, motions=pairs, named=motions, one_side=one_side
        ).checked()
        options["workers_of"] = runner.workers_of
        origin, both = base.origin_with({}), any(row.across for row in hall.containers.values())
        begun = HallResult(
            hall=hall.name,
            case=origin.place,
            model=base.solver.model,
            rows=len(hall.rows),
            containers=sum(row.count for row in hall.rows),
            distinct=len(hall.containers),
            refused=sum(row.container is None for row in hall.rows),
            kept=tuple(column for column, meaning in file.meanings.items() if not meaning),
            columns=tuple(file.meanings),
            asked=hash_of([[*hall.containers], [pair.case_hash for pair in pairs], *["both sides"] * both]),
            one_side=one_side or None,
            listed=hash_of([file.table.text, checks]),
            motions=motions,
            motion_covered=motions_left_out(base, pairs),
            checks=checks,
            allow_outside=origin.allow_outside or None,
        )
        study = Study(
            kind=HALL,
            request=begun.asked,
            result=HallResult,
            begun=begun,
            compute=partial(_compute, hall, begun),
            texts={"list.csv": file.table.text, "base.toml": toml_document(base.given())},
            subject=f"the hall ({begun.distinct} containers)",
            way_out="take fewer rows",
            progress=lambda results: "what was computed so far",
            again=lambda results, finished: finished if finished.listed == begun.listed else None,
            size=2.0 * table_bytes(len(hall.items), len(RUN_COLUMNS)),
            cases=[] if pairs else [base],
            motions=[pair.case for pair in pairs],
        )
        return run_study(study, folder, **options)


def _compute(hall: Hall, begun: HallResult, results: ResultFolder, runner: Runner) -> HallResult:
    """Compute what is missing, and write the list with its results."""
    items = hall.items
    logged = partial(LoggedRuns[Item], make=hall.make.case, model_of=hall.model_of)
    runs = logged(
        what="runs",
        path=results.path / RUNS,
        columns=RUN_COLUMNS,
        key=lambda item: item[:2],
        ids=2,
        known={(item.cell, item.draw) for item in items},
    )
    runs.run(runner, iter(partial(runs.missing, items), []))
    begun = replace(begun, runs=len(runs.lines))
    if runs.missing(items):
        words = f"{begun.runs} of {len(items)} runs are computed"
        return replace(begun, status=INTERRUPTED, missing=words)
    found = [_governing(hall, [*own], runs) for _, own in groupby(items, key=itemgetter(0))]
    weakest = sorted(found, key=lambda pair: weakness(pair[1]))
    able = [item for item, row in weakest if row["outcome"] and hall.model_of(item) != "full"]
    count = {"none": 0, "all": len(able)}.get(begun.checks, max(math.ceil(SHARE * len(found)), LEAST))
    checks = logged(
        what="containers repeated with other inputs and stronger motions",
        path=results.path / CHECKS,
        columns=CHECK_COLUMNS,
        key=lambda item: item[:1],
        ids=1,
        known={(item.cell,) for item, _ in found},
        work=check_chunk,
    )
    to_check = partial(checks.missing, able[:count])
    checks.run(runner, iter(to_check, []))
    begun = replace(begun, checked=len(checks.lines))
    if left := len(to_check()):
        return replace(begun, status=INTERRUPTED, missing=f"{left} of the weakest are still to be repeated")
    results.check()
    results.write(RUNS, runs.table())
    results.write(CHECKS, checks.table())
    for item, row in found:
        row |= checks.row(item)
    for rank, (_, container) in enumerate(sorted(found, key=lambda pair: weakness(pair[1])), start=1):
        container["rank"] = rank
    return _written(results, begun, hall, found)


def _governing(hall: Hall, items: Sequence[Item], runs: LoggedRuns[Item]) -> tuple[Item, Row]:
    """The run in which a container does worst, the first of equals; and the results of the container.

    These are those of that run, the static rule under its peak, and what all its motions do. Of two sides the worse.
    """
    rows, motions, sides = [*map(runs.row, items)], len(hall.keys), list[tuple[Item, Row]]()
    for first in range(0, len(items), motions):
        worst = min(range(first, first + motions), key=lambda place: weakness(rows[place]))
        case = hall.make.case(items[worst])
        peaks = peaks_in_run(case, *build_motions(case))
        ruling = static_checks_of(case, build_container(case), *peaks).ruling.to_result()
        row = {name: rows[worst][name] for name in OF_A_RUN} | {"side": "depth" if first else "width"}
        sides.append((items[worst], row | {name: getattr(ruling, name) for name in STATIC}))
    item, row = min(sides, key=lambda side: weakness(side[1]))
    rows = [min(rows[motion::motions], key=weakness) for motion in range(motions)]
    if names := [pair.name for pair in hall.motions]:
        counts, slips = Counter(map(_ending_in, rows)), [run[SLIPPED] or 0.0 for run in rows]
        slid = slips.index(max(slips))
        under = (
            names[item.draw % motions],
            *(counts[word] for word in WORST_FIRST[:3]),
            slips[slid],
            names[slid],
        )
        row |= zip(OF_MOTIONS, under, strict=True)
    return item, row


def _written(
    results: ResultFolder, begun: HallResult, hall: Hall, found: Sequence[tuple[Item, Row]]
) -> HallResult:
    """The finished result of a checked list, with the list written; the governing run and the row of each container."""
    table = tuple(_rows(hall, found))
    outcomes, tags = Counter[str](), dict[str, dict[str, Any]]()
    for row in table:
        ending = _ending_in(row)
        outcomes[row["outcome"] or ending] += row["count"]
        empty = {"tag": row["tag"], "containers": 0, "counts": Counter[str](), "margin": None}
        tag = tags.setdefault(row["tag"], empty)
        tag["containers"] += row["count"]
        tag["counts"][ending] += row["count"]
        tag["margin"] = min(filter(None, (tag["margin"], row["margin"])), default=None)
    result = replace(
        begun,
        status=FAILED if {row["status"] for _, row in found} == {FAILED} else COMPLETED,
        outcomes=dict(sorted(outcomes.items())),
        tags=tuple(tag for _, tag in sorted(tags.items())) if {*tags} != {""} else (),
        table=table,
    )
    fields = ([*row["given"].values(), *(row[name] for name in RESULT_COLUMNS)] for row in table)
    results.write(TABLE, hall.file.with_results(fields))
    results.remove("report.html")  # the command makes another
    return replace(result, answer=_answer_of(result))


def _rows(hall: Hall, found: Sequence[tuple[Item, Row]]) -> Iterator[Row]:
    """The rows of the list with their results, and the command that computes each by itself."""
    for number, row in enumerate(hall.rows, start=1):
        results: Row = {"status": REFUSED, "reason": row.reason}
        if row.container is not None:
            item, results = found[row.container]
            results = results | {"command": hall.command(item, row.values)}
        own = {"row": number} | {name: getattr(row, name) for name in LISTED}
        yield own | {name: results.get(name) for name in (*RESULT_COLUMNS, "command")}


def _answer_of(result: HallResult) -> str:
    """How many containers did what, and which is the weakest, in one sentence."""
    counts = dict(result.outcomes)
    refused = counts.pop(REFUSED, 0)
    overturned, invalid, failed = (counts.get(word, 0) for word in ("overturned", "invalid", "failed"))
    under = f" under at least one of {len(result.motions)} motions" if len(result.motions) > 1 else ""
    words = f"{overturned or 'none'} of {result.containers - refused} containers overturned"
    words += under if overturned else ""
    words += f"; {invalid} destroyed a corner, which is not valid" if invalid else ""
    words += f"; {failed} have no outcome" if failed else ""
    words += f"; {result.refused} row{'s were' if result.refused != 1 else ' was'} refused" if refused else ""
    weakest = result.ranked[0]
    words += f"; the weakest is {weakest['name']}"
    if not overturned and (margin := weakest["margin"]) is not None:
        words += f", which overturns from {margin:.3g} times its motion on"
    return words
