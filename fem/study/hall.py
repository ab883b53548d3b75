"""A list of containers computed: which differ, the run of each under each motion, the weakest repeated, the results.

The runs are logged as they are ready, so an interrupted list continues where it was; its files depend neither on that
nor on the number of cores. A list of which names or tags alone have changed is written again, not computed.
"""

import math
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
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
from fem.case.validation import CaseError, told_as
from fem.html.page import text_of
from fem.model.geometry import build_container
from fem.model.motion import build_motions, motion_result, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.results.disk import table_bytes
from fem.results.figures import FIGURES, SCALARS, SLIPPED, TURNED
from fem.results.folder import ResultFolder
from fem.results.kinds import HALL
from fem.results.level import Level, in_a_word
from fem.results.outcome import COUNTED_AS, Outcome, ending_of
from fem.results.run_result import RunResult, Verdict
from fem.run.card import card_of, times
from fem.run.described import sides_of
from fem.run.expected import expected_s, expected_words, say_expected
from fem.run.verdict import place_of
from fem.runtime.identity import command_line
from fem.study.axes import MOTION_FILE, VERTICAL_FILE, read_axis
from fem.study.design import Design, Item
from fem.study.driver import (
    COMPLETED,
    FAILED,
    Study,
    StudyOptions,
    hash_of,
    run_study,
    runner_of,
)
from fem.study.hall_file import HallFile, HallRow
from fem.study.hall_result import (
    DOUBTFUL,
    NONE,
    OF_A_RUN,
    OF_MOTIONS,
    REFUSED,
    RESULT_COLUMNS,
    STATIC,
    HallResult,
)
from fem.study.motions import FloorMotionPair, motions_left_out, read_motion_set
from fem.study.runner import CARD, CARD_LINES, CHECKED, Row, Runner, boxes_in, check_chunk
from fem.study.table import line_of

DIGITS = 4  #: of a figure in the list; `hall.json` has all
#: of a row, what the result says of it
LISTED = ("line", "name", "count", "tag", "given")
CENTROID = "container.centroid_m"
TABLE, RUNS, CHECKS = "hall.csv", "runs.csv", "checks.csv"
RUN_COLUMNS = {"container": int, "motion": int} | OF_A_RUN
CHECK_COLUMNS = {"container": int} | CHECKED | CARD
MOST_RUNS = 200_000  #: unless it is forced
MOST_NAMED = 20  #: bad rows in a refusal
OF_A_ROW = 3e-3  #: processor time of checking a row [s]
#: share of the containers, the weakest first, whose run is repeated under stronger motions and with other inputs; at
#: least so many
SHARE, LEAST = 0.1, 30
Checks = Literal["weakest", "all", "none"]
MOVED = ("rested", "moved")
WORST_FIRST = ("overturned", "invalid", "failed", *DOUBTFUL, *reversed(MOVED))  #: what a container counts as
ROCKS = 0.01  #: rotation ratio up to which what stands is ranked by the static rule: nothing rocks


@dataclass(frozen=True, kw_only=True, eq=False)
class Hall(Design):
    """A list of containers, and the motions that they undergo."""

    file: HallFile
    one_side: bool = False  #: look only at the side that is given as the width
    pairs: tuple[FloorMotionPair, ...] = ()  #: in place of that of the base case
    named: tuple[str, ...] = ()  #: these, as they were named on the command line
    rows: tuple[HallRow, ...] = ()  #: each with its container, or why it is refused
    containers: Mapping[str, HallRow] = field(default_factory=dict)  #: by hash, the first row of each
    allow_outside: bool = False  #: files of the case may lie outside its folder

    @cached_property
    def keys(self) -> list[Mapping[str, Any]]:
        """Those that set each motion; of the motion of the base case none."""
        return [pair.keys for pair in self.pairs] or [{}]

    @cached_property
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
        words = ["run", self.base.origin_with({}).place, *["--allow-outside"] * self.allow_outside]
        if self.named:
            words += ["--motion", self.named[item.draw % len(self.named)].partition(",")[0].strip()]
        for override in self.base.overrides:
            words += ["--set", override]
        # with a vertical file of a pair, or that a motion among pairs has none
        set_by_motion = {key: value for key, value in item.point.items() if key != MOTION_FILE}
        for key, value in {**set_by_motion, **values, **item.more}.items():
            words += ["--set", f"{key}={value if isinstance(value, str) else toml_value(value)}"]
        return command_line(*words)

    def checked(self) -> "Hall":
        """The list with every row checked before any is computed; CaseError for no good row.

        Equal rows are one container.
        """
        containers = dict[str, HallRow]()
        seen: dict[str, dict[str, Any]] = {}  # by what a row sets: its container, or why it is refused
        rows, place = [], f"{self.base.origin_with({}).place}: "
        for row in self.file.rows:
            values = repr(sorted(row.values.items()))
            if not row.reason and values not in seen:
                try:  # whatever a run would be refused for
                    own, height = self.base.container, row.values.get("container.height_m")
                    stated = "centroid_m" in self.base.given()["container"]
                    if stated and height not in (None, own.height_m) and CENTROID not in row.values:
                        raise CaseError(
                            f"centroid_m = {own.centroid_m:g} of the case belongs to height_m = {own.height_m:g}; add "
                            "a column centroid_m, or leave that key out of the case for half the height"
                        )
                    first = self.make.case(Item(0, 0, self.keys[0], row.values))
                    if reasons := excluded_values(first):
                        raise CaseError("\n".join(reasons))
                    build_container(first)
                    moved = any(key.startswith(("motion.", "vertical.")) for key in row.values)
                    for keys in self.keys if moved else self.keys[:1]:
                        build_motions(self.make.case(Item(0, 0, keys, row.values)))
                    narrower = first.container.depth_m < first.container.width_m and not self.one_side
                    known = replace(row, across=first.turned if narrower else {}, container=len(containers))
                    seen[values] = {"container": containers.setdefault(case_hash(first), known).container}
                except ValueError as error:  # on one line, without mention of the command line
                    lines = (line.removeprefix(place) for line in str(error).splitlines())
                    lines = (re.sub(r" \(--set \S+?=.*\)$", "", line) for line in lines)
                    told = (line for line in lines if line and not line.startswith("with --set "))
                    seen[values] = {"reason": "; ".join(told)}
            rows.append(row if row.reason else replace(row, **seen[values]))
        if not containers:
            bad = [f"{self.name}, line {row.line} ({row.name}): {row.reason}" for row in rows]
            more = [f"and {len(bad) - MOST_NAMED} more rows"] * (len(bad) > MOST_NAMED)
            raise CaseError("\n".join([*bad[:MOST_NAMED], *more, "no row can be computed"]))
        return replace(self, rows=tuple(rows), containers=containers)


def _ending_in(row: Row) -> str:
    """What a row counts as."""
    return REFUSED if row["status"] == REFUSED else COUNTED_AS[ending_of(row["status"], row["outcome"])]


def _slipped_most(row: Row) -> float:
    """Largest slip, on the floor or of a box on another [m]."""
    return max(row.get(SLIPPED) or 0.0, row.get("max_joint_slip_m") or 0.0)


def weakness(row: Row) -> tuple[float, ...]:
    """Smaller for the worse: by what it counts as, its governing margin, rotation, static rule and slip.

    Of a run alone neither margin nor static rule are known, nor what its variations do. What stands, but beyond its
    `place_m`, has left its place.
    """
    ending, margin = _ending_in(row), row.get("margin_governs") or row.get("margin_tried_to")
    turned, static, slip = (row.get(name) or 0.0 for name in (TURNED, "utilisation_overturning", SLIPPED))
    if ending == "stood":
        left = _slipped_most(row) > row.get("place_m", math.inf)
        ending = Level.LEAVES if left else MOVED[row["outcome"] != Outcome.REST]
        ending = row["does"] if row.get("does") in DOUBTFUL else ending
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
        pairs: tuple[FloorMotionPair, ...] = ()
        origin, own = base.origin_with({}), base
        if motions:  # from anywhere: files "H" or "H,V"
            trusted = origin.trusted | {MOTION_FILE, VERTICAL_FILE}
            own = base.from_origin(replace(origin, trusted=trusted, allow_outside=True))
            files = [[as_named_from(base.folder, name.strip()) for name in one.split(",")] for one in motions]
            with told_as("--motion "):
                axis = read_axis(MOTION_FILE, [pair if len(pair) > 1 else pair[0] for pair in files])
            pairs = read_motion_set(own, axis, runner)
        asked: dict[str, Any] = {"pairs": pairs, "named": motions, "one_side": one_side}
        hall = Hall(
            name=file.name, file=file, base=own, allow_outside=origin.allow_outside, **asked
        ).checked()
        options["workers_of"] = runner.workers_of
        both = any(row.across for row in hall.containers.values())
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
            again=lambda results, finished: finished if finished.listed == begun.listed else None,
            size=2.0 * table_bytes(len(hall.items), len(RUN_COLUMNS)),
            cases=[] if pairs else [base],
            motions=[pair.case for pair in pairs],
        )
        return run_study(study, folder, **options)


def _compute(hall: Hall, begun: HallResult, results: ResultFolder, runner: Runner) -> HallResult:
    """Compute what is missing, and write the list with its results."""
    items, path = hall.items, results.path
    runs = hall.runs(what="runs", path=path / RUNS, columns=RUN_COLUMNS, key=lambda item: item[:2], ids=2)
    runs.run(runner, [items])
    begun = replace(begun, runs=len(runs.lines))
    if runs.missing(items):
        return begun.interrupted(f"{begun.runs} of {len(items)} runs are computed")
    found = [_governing(hall, [*own], runs.row) for _, own in groupby(items, key=itemgetter(0))]
    weakest = sorted(found, key=lambda pair: weakness(pair[1]))
    able = [item for item, row in weakest if row["outcome"] and hall.model_of(item) != "full"]
    count = {"none": 0, "all": len(able)}.get(begun.checks, max(math.ceil(SHARE * len(found)), LEAST))
    named = {"what": "containers repeated with other inputs and stronger motions", "work": check_chunk}
    own = {"path": path / CHECKS, "columns": CHECK_COLUMNS, "key": lambda item: item[:1], "ids": 1}
    checks = hall.runs(**named, **own)
    to_check = partial(checks.missing, able[:count])
    checks.run(runner, iter(to_check, []))
    begun = replace(begun, checked=len(checks.lines))
    if left := len(to_check()):
        return begun.interrupted(f"{left} of the weakest are still to be repeated")
    results.check()
    results.write(RUNS, runs.table())
    results.write(CHECKS, checks.table())
    for item, row in found:
        checked = checks.row(item)
        row |= checked | {name: checked.get(name) or row[name] for name in CARD}
        row["first_line"] = row["card"].partition(CARD_LINES)[0]
    for rank, (_, container) in enumerate(sorted(found, key=lambda pair: weakness(pair[1])), start=1):
        container["rank"] = rank
    return _written(results, begun, hall, found)


def _written(
    results: ResultFolder, begun: HallResult, hall: Hall, found: Sequence[tuple[Item, Row]]
) -> HallResult:
    """The result of a list whose containers are computed; writes the list with its results."""
    table, outcomes, tags = list[Row](), Counter[str](), dict[str, dict[str, Any]]()
    left: list[Row] = []  #: out of their places, whatever their variations do
    for number, listed in enumerate(hall.rows, start=1):
        shown: Row = {"status": REFUSED, "reason": listed.reason}
        if listed.container is not None:
            item, shown = found[listed.container]
            shown = shown | {"command": hall.command(item, listed.values)}
        row = {"row": number} | {name: getattr(listed, name) for name in LISTED}
        row |= {name: shown.get(name) for name in (*RESULT_COLUMNS, "command", *CARD)}
        table.append(row)
        ending = _ending_in(row)
        if ending == "stood" and _slipped_most(shown) > shown["place_m"]:
            left.append(row)
        outcomes[row["outcome"] or ending] += row["count"]
        empty = {"tag": row["tag"], "containers": 0, "counts": Counter[str](), "margin": None}
        tag = tags.setdefault(row["tag"], empty)
        tag["containers"] += row["count"]
        tag["counts"][ending] += row["count"]
        tag["margin"] = min(filter(None, (tag["margin"], row["margin_governs"])), default=None)
    result = replace(
        begun,
        status=FAILED if {row["status"] for _, row in found} == {FAILED} else COMPLETED,
        outcomes=dict(sorted(outcomes.items())),
        tags=tuple(tag for _, tag in sorted(tags.items())) if {*tags} != {""} else (),
        table=tuple(table),
    )
    # in the list's own separator and decimal mark; most programs do not read quoted fields as numbers
    separator, comma = hall.file.table.separator, hall.file.decimal_mark == ","
    separator = ";" if separator == "," and comma else separator
    fields = ([*row["given"].values(), *(row[name] for name in RESULT_COLUMNS)] for row in table)
    lines = (
        line_of(line, separator=separator, comma=comma, digits=DIGITS)
        for line in ([*hall.file.meanings, *RESULT_COLUMNS], *fields)
    )
    stated = f"sep={separator}\n" * (separator not in ",;\t")
    results.write(TABLE, stated + "".join(f"{line}\n" for line in lines))
    results.remove("report.html")  # the command makes another
    farthest = max(left, key=_slipped_most, default=None)
    tried = (row for row in result.ranked if row["margin_governs"] is not None)
    least = min(tried, key=itemgetter("margin_governs"), default=None)
    known: dict[str, Any] = {
        "left": left,
        "Level": Level,
        "farthest": farthest,
        "least": least,
        "slid": farthest and FIGURES[SLIPPED].unit.text(_slipped_most(farthest), figures=2),
        "margin": least and times(least["margin_governs"]),
    }
    return replace(result, answer=text_of("hall_answer.txt.j2", result=result, **known))


def _governing(hall: Hall, items: Sequence[Item], row_of: Callable[[Item], Row]) -> tuple[Item, Row]:
    """The run in which a container does worst, the first of equals; its results, its static rule, those of all motions.

    Of two sides the worse.
    """
    rows, motions, sides = [*map(row_of, items)], len(hall.keys), list[tuple[Item, Row]]()
    for first in range(0, len(items), motions):
        case = hall.make.case(items[first])
        mesh = build_container(case)
        place = place_of(case, mesh.width)
        own = [row | place for row in rows[first : first + motions]]
        worst = min(range(motions), key=lambda number: weakness(own[number]))
        item, row = items[first + worst], {name: own[worst][name] for name in (*OF_A_RUN, "place_m")}
        row["side"] = "depth" if first else "width"
        case = hall.make.case(item) if worst else case
        floor = build_motions(case)
        static = static_checks_of(case, mesh, *peaks_in_run(case, *floor)).to_result()
        said = {name: row[name] for name in SCALARS if name in Verdict.__dataclass_fields__}
        verdict = Verdict(**said, boxes=boxes_in(row), **place)
        run = RunResult(
            status=row["status"],
            static=static,
            sides=None if case.container.mesh_file else sides_of(mesh.width, case.container.depth_m, static),
            motion=motion_result(case, *floor),
            verdict=verdict,
            error=row["reason"],
        )
        row |= {"does": NONE, "card": ""}
        if verdict.outcome is not None:
            row |= {"does": in_a_word(run), "card": CARD_LINES.join(card_of(run))}
        sides.append((item, row | {name: getattr(static.ruling, name) for name in STATIC}))
    item, row = min(sides, key=lambda side: weakness(side[1]))
    rows = [min(rows[motion::motions], key=weakness) for motion in range(motions)]
    if names := [pair.name for pair in hall.pairs]:
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
