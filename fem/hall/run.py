"""A hall from its list to its folder: runs, the weakest of them repeated, the list with results, page.

The runs are logged as they are ready, so an interrupted hall continues where it was; its files depend neither on that
nor on the number of cores. A hall of which names, tags or places alone have changed is written again, not computed.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, Unpack

from fem.batch.log import LoggedRuns, fields_of, table_of_lines, table_text
from fem.batch.motion_set import motions_left_out
from fem.batch.runner import Runner
from fem.batch.study import (
    COMPLETED,
    FAILED,
    INTERRUPTED,
    Study,
    StudyOptions,
    hash_of,
    run_study,
    runner_of,
)
from fem.case.case import Case
from fem.case.toml import toml_document
from fem.hall.file import HallFile
from fem.hall.found import CHECK_COLUMNS, RUN_COLUMNS, HallRuns, check_chunk, static_use, weakest_first
from fem.hall.page import hall_report
from fem.hall.places import PICTURE, draw_places, geojson
from fem.hall.plan import Hall, plan_hall
from fem.hall.result import (
    CHECKED,
    OF_A_RUN,
    OF_MOTIONS,
    REFUSED,
    RESULT_COLUMNS,
    STATIC,
    HallResult,
    TagCount,
)
from fem.results.disk import BYTES_BESIDE, table_bytes
from fem.results.folder import ResultFolder
from fem.results.kinds import HALL
from fem.results.outcome import COUNTED, Ending
from fem.results.run_files import copy_data_files

RUNS, CHECKS, TABLE, PAGE = "runs.csv", "checks.csv", "hall.csv", "report.html"
GEOJSON = "hall.geojson"
Checks = Literal["weakest", "all", "none"]
WORDS = {ending: word for word, ending in COUNTED.items()}
NUMBERS = frozenset({"impacts", "fell_box"})
TEXTS = frozenset({"status", "reason", "outcome", "sure", "decided_by", "motion", "largest_slip_motion"})


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
        file: the list.
        base: the case that its rows change.
        folder: of the results.
        motions: files of motions in place of that of the case, "H" or "H,V" each; every container undergoes all.
        checks: which governing runs are repeated for `sure` and `margin`: those of the weakest tenth and of at least
            30 containers, all, or none.
        strict: refuse the list for one bad row.
        options: of every study.
    """
    with runner_of(**options) as runner:
        hall = plan_hall(file, base, motions, runner, strict=strict, force=options.get("force", False))
        options["workers_of"] = runner.workers_of
        begun = asked_of(hall, checks)
        study = Study(
            kind=HALL,
            request=begun.asked,
            result=HallResult,
            begun=begun,
            compute=partial(_compute, hall, begun),
            texts={"list.csv": file.text, "base.toml": toml_document(base.given())},
            size=2.0 * table_bytes(len(hall.items()), len(RUN_COLUMNS)) + BYTES_BESIDE,
            subject=f"the hall ({len(hall.items())} runs)",
            way_out="take fewer rows",
            progress=lambda place: "its runs so far",
            again=partial(_again, begun),
        )
        return run_study(study, folder, **options)


def asked_of(hall: Hall, checks: Checks) -> HallResult:
    """What is known before any run."""
    base = hall.base
    return HallResult(
        hall=hall.file.name,
        case=hall.base_place,
        asked=hash_of([hall.hashes, [pair.case_hash for pair in hall.motions]]),
        listed=hash_of([hall.file.text, checks]),
        model=base.solver.model,
        motions=tuple(pair.name for pair in hall.motions),
        motion_covered=motions_left_out(base, hall.motions),
        rows=len(hall.rows),
        containers=sum(row.count for row in hall.rows),
        distinct=len(hall.containers),
        refused=sum(map(bool, hall.reasons)),
        checks=checks,
        kept=hall.file.kept,
        columns=hall.file.columns,
    )


def _again(begun: HallResult, place: ResultFolder, finished: HallResult) -> HallResult | None:
    """A finished hall; None where another list asks for the same runs, or other runs are to be repeated."""
    return finished if finished.listed == begun.listed else None


def _compute(hall: Hall, begun: HallResult, place: ResultFolder, runner: Runner) -> HallResult:
    """Compute what is missing, and write the list with its results, and its page."""
    for case in [pair.case for pair in hall.motions] or [hall.base]:
        copy_data_files(case, place.path, read=bool(hall.motions))
    runs = HallRuns(hall=hall)
    LoggedRuns(
        what="runs",
        path=place.path / RUNS,
        columns=RUN_COLUMNS,
        make=hall.cases,
        model_of=hall.model_of,
        values=runs.values,
        note=runs.note,
        number=lambda item: item.container * len(hall.cases.motions) + item.motion,
    ).run(runner, iter(runs.missing, []))
    if missing := len(runs.missing()):
        total = len(hall.items())
        return replace(begun, status=INTERRUPTED, missing=f"{total - missing} of {total} runs are computed")
    static = {
        number: dict(zip(STATIC, static_use(hall, hall.item(number, runs.governing(number))), strict=True))
        for number in runs.found
    }
    order = weakest_first(runs, static)
    wanted = partial(runs.to_check, begun.checks, order)
    LoggedRuns(
        what="containers repeated with other inputs and stronger motions",
        path=place.path / CHECKS,
        columns=CHECK_COLUMNS,
        make=hall.cases,
        model_of=hall.model_of,
        values=lambda item, row: (item.container, *(row[name] for name in CHECKED)),
        note=runs.note_check,
        work=check_chunk,
    ).run(runner, iter(wanted, []))
    if left := len(wanted()):
        return replace(begun, status=INTERRUPTED, missing=f"{left} of the weakest are still to be repeated")
    place.check()
    found = _Table(hall=hall, runs=runs, static=static, order=weakest_first(runs, static))
    result = found.result(begun)
    place.write_text(RUNS, table_of_lines(RUN_COLUMNS, runs.lines()))
    checked = sorted(runs.checked.items())
    place.write_text(CHECKS, table_text(CHECK_COLUMNS, ([k, *one.values()] for k, one in checked)))
    place.write_text(TABLE, table_text((*hall.file.columns, *RESULT_COLUMNS), found.rows()))
    for name, text in ((PICTURE, draw_places(result)), (GEOJSON, geojson(result))):
        if text:
            place.write_text(name, text)
        else:
            place.remove(name)
    place.write_text(PAGE, hall_report(place.path, result=result))
    return result


@dataclass(frozen=True, kw_only=True, eq=False)
class _Table:
    """The list with its results."""

    hall: Hall
    runs: HallRuns
    static: Mapping[int, Mapping[str, float | None]]
    order: list[int]  #: of the containers, the weakest first

    def rows(self) -> Any:
        """`hall.csv`: the fields of the list as they were given, then the results."""
        ranks = {number: place for place, number in enumerate(self.order, start=1)}
        for number, row in enumerate(self.hall.rows):
            found = self.of_row(number) | {"rank": ranks.get(self._container(number))}
            yield (*row.given, *(found.get(name) for name in RESULT_COLUMNS))

    def of_row(self, number: int) -> dict[str, Any]:
        """The results of a row as texts of the log and as numbers."""
        container = self.hall.of_row[number]
        if container is None:
            return {"status": REFUSED, "reason": self.hall.reasons[number]}
        some = self.runs.found[container]
        motion = self.runs.governing(container)
        fields = dict(zip(RUN_COLUMNS, fields_of(some[motion].line), strict=True))
        names = [pair.name for pair in self.hall.motions]
        found: dict[str, Any] = {name: fields[name] for name in OF_A_RUN}
        found |= {**self.static[container], **self.runs.checked.get(container, {})}
        if names:
            slipped = max(sorted(some), key=lambda one: some[one].slip)
            endings = [run.ending for run in some.values()]
            counts = endings.count(Ending.OVERTURNED), endings.count(Ending.FAILED)
            found |= dict(
                zip(OF_MOTIONS, (names[motion], *counts, some[slipped].slip, names[slipped]), strict=True)
            )
        return found

    def result(self, begun: HallResult) -> HallResult:
        """Everything that was found."""
        hall, table, outcomes = self.hall, [], Counter[str]()
        tags: dict[str, TagCount] = {}
        ranks = {number: place for place, number in enumerate(self.order, start=1)}
        for number, row in enumerate(hall.rows):
            container, found = hall.of_row[number], self.of_row(number)
            values = {name: _parsed(name, found.get(name)) for name in RESULT_COLUMNS}
            ending = REFUSED
            if container is not None:
                ending = WORDS[self.runs.found[container][self.runs.governing(container)].ending]
            outcomes[values["outcome"] or ("failed" if container is not None else REFUSED)] += row.count
            tag = tags.get(row.tag, TagCount(tag=row.tag, containers=0))
            margins = [one for one in (tag.margin, values["margin"]) if one is not None]
            counted = {"containers": tag.containers + row.count, ending: getattr(tag, ending) + row.count}
            tags[row.tag] = replace(tag, **counted, margin=min(margins, default=None))
            motion = 0 if container is None else self.runs.governing(container)
            table.append(
                {"row": number + 1, "line": row.line, "name": row.name, "count": row.count, "tag": row.tag}
                | {"place_m": row.place, "lon_lat": row.geographic}
                | {"given": dict(zip(hall.file.columns, row.given, strict=True))}
                | values
                | {"rank": None if container is None else ranks[container]}
                | {"command": hall.command(row, motion)}
            )
        every = {self.runs.found[k][self.runs.governing(k)].ending for k in self.runs.found}
        result = replace(
            begun,
            status=FAILED if every == {Ending.FAILED} else COMPLETED,
            runs=len(hall.items()),
            checked=len(self.runs.checked),
            outcomes=dict(sorted(outcomes.items())),
            tags=tuple(tags[tag] for tag in sorted(tags)) if {*tags} != {""} else (),
            table=tuple(table),
        )
        return replace(result, answer=answer_of(result))

    def _container(self, number: int) -> int:
        container = self.hall.of_row[number]
        return -1 if container is None else container


def answer_of(result: HallResult) -> str:
    """How many containers did what, and which is the weakest, in one sentence."""
    counts = result.outcomes
    overturned, failed = counts.get(Ending.OVERTURNED.word, 0), counts.get("failed", 0)
    refused = counts.get(REFUSED, 0)
    computed = result.containers - refused
    under = f" under at least one of {len(result.motions)} motions" if len(result.motions) > 1 else ""
    words = f"{overturned} of {computed} containers overturned{under}"
    if not overturned:
        words = f"none of {computed} containers overturned"
    if failed:
        words += f"; {failed} have no outcome"
    if refused:
        words += f"; {result.refused} rows were refused"
    weakest = next((row for row in result.table if row["rank"] == 1), None)
    if weakest is not None:
        words += f"; the weakest is {weakest['name']}"
        if weakest["margin"] is not None:
            words += f", which overturns from {weakest['margin']:.3g} times its motion on"
    return words


def _parsed(name: str, value: Any) -> Any:
    """A field of a log as a value."""
    if not isinstance(value, str) or name in TEXTS:
        return value or None if isinstance(value, str) else value
    if value in ("true", "false"):
        return value == "true"
    if not value:
        return None
    if " " in value:
        return tuple(map(float, value.split()))
    return int(value) if name in NUMBERS else float(value)
