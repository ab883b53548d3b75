"""A hall from its list to its folder: runs, the weakest of them repeated, the list with results, page.

The runs are logged as they are ready, so an interrupted hall continues where it was; its files depend neither on that
nor on the number of cores. A hall of which names, tags or places alone have changed is written again, not computed.
"""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, Unpack

from fem.batch.checked import check_chunk
from fem.batch.log import LoggedRuns
from fem.batch.motion_set import motions_left_out
from fem.batch.runner import Runner
from fem.batch.study import COMPLETED, FAILED, INTERRUPTED, Study, StudyOptions, hash_of, run_study, runner_of
from fem.batch.table import row_of, table_of_lines, table_text
from fem.case.case import Case
from fem.case.toml import toml_document
from fem.hall.file import HallFile
from fem.hall.page import hall_report
from fem.hall.places import PICTURE, draw_places, geojson
from fem.hall.plan import Hall, Inventory, plan_hall
from fem.hall.ranking import CHECK_COLUMNS, RUN_COLUMNS, HallRuns, static_use, weakest_first
from fem.hall.result import OF_A_RUN, OF_MOTIONS, RESULT_COLUMNS, STATIC, HallResult
from fem.hall.table import HallTable, answer_of
from fem.results.disk import BYTES_BESIDE, table_bytes
from fem.results.folder import ResultFolder
from fem.results.kinds import HALL
from fem.results.outcome import COUNTED, Ending

RUNS, CHECKS, TABLE, PAGE, GEOJSON = "runs.csv", "checks.csv", "hall.csv", "report.html", "hall.geojson"
Checks = Literal["weakest", "all", "none"]
WORDS = {ending: word for word, ending in COUNTED.items()}


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
        begun = replace(
            begun_result(file, base, hall.inventory),
            asked=hash_of([hall.inventory.hashes, [pair.case_hash for pair in hall.motions]]),
            listed=hash_of([file.text, checks]),
            motions=hall.named,
            motion_covered=motions_left_out(base, hall.motions),
            checks=checks,
        )
        size = 2.0 * table_bytes(len(hall.items()), len(RUN_COLUMNS))
        study = study_of(file, base, begun, partial(_compute, hall, begun), size)
        copied = [pair.case for pair in hall.motions]
        return run_study(replace(study, cases=[] if copied else [base], motions=copied), folder, **options)


def study_of(file: HallFile, base: Case, begun: HallResult, compute: Any, size: float) -> Study[HallResult]:
    """The study of a list; `size` is that of its tables [bytes]."""
    return Study(
        kind=HALL,
        request=begun.asked,
        result=HallResult,
        begun=begun,
        compute=compute,
        texts={"list.csv": file.text, "base.toml": toml_document(base.given())},
        size=size + BYTES_BESIDE,
        subject=f"the hall ({begun.distinct} containers)",
        way_out="take fewer rows",
        progress=lambda results: "what was computed so far",
        again=lambda results, finished: finished if finished.listed == begun.listed else None,
    )


def begun_result(file: HallFile, base: Case, inventory: Inventory) -> HallResult:
    """The result before any run, without its hashes."""
    return HallResult(
        hall=file.name,
        case=base.origin_with({}).place,
        asked="",
        model=base.solver.model,
        rows=len(file.rows),
        containers=sum(row.count for row in file.rows),
        distinct=len(inventory.containers),
        refused=sum(map(bool, inventory.reasons)),
        kept=file.kept,
        columns=file.columns,
        allow_outside=base.origin_with({}).allow_outside or None,
    )


def _compute(hall: Hall, begun: HallResult, results: ResultFolder, runner: Runner) -> HallResult:
    """Compute what is missing, and write the list with its results, and its page."""
    runs = HallRuns(hall=hall)
    LoggedRuns(
        what="runs",
        path=results.path / RUNS,
        columns=RUN_COLUMNS,
        make=hall.cases,
        model_of=hall.model_of,
        key=lambda item: (item.container, item.motion),
        note=runs.note,
        number=lambda item: item.container * len(hall.cases.motions) + item.motion,
    ).run(runner, iter(runs.missing, []))
    if missing := len(runs.missing()):
        total = len(hall.items())
        words = f"{total - missing} of {total} runs are computed"
        return replace(begun, status=INTERRUPTED, runs=total - missing, missing=words)
    static = {
        number: dict(zip(STATIC, static_use(hall, hall.item(number, runs.governing(number))), strict=True))
        for number in runs.by_container
    }
    to_check = partial(runs.to_check, begun.checks, weakest_first(runs, static, margins=False))
    LoggedRuns(
        what="containers repeated with other inputs and stronger motions",
        path=results.path / CHECKS,
        columns=CHECK_COLUMNS,
        make=hall.cases,
        model_of=hall.model_of,
        key=lambda item: (item.container,),
        note=runs.note_check,
        work=check_chunk,
    ).run(runner, iter(to_check, []))
    if left := len(to_check()):
        words = f"{left} of the weakest are still to be repeated"
        return replace(
            begun, status=INTERRUPTED, runs=len(hall.items()), checked=len(runs.checked), missing=words
        )
    results.check()
    results.write_text(RUNS, table_of_lines(RUN_COLUMNS, runs.lines()))
    checked = sorted(runs.checked.items())
    results.write_text(CHECKS, table_text(CHECK_COLUMNS, ([k, *check.values()] for k, check in checked)))
    values = {number: static[number] | _result_columns(runs, number) for number in runs.by_container}
    endings = {number: runs.worst(number).ending for number in runs.by_container}
    table = HallTable(
        file=hall.file,
        inventory=hall.inventory,
        values=values,
        words={k: (str(row["outcome"] or WORDS[endings[k]]), WORDS[endings[k]]) for k, row in values.items()},
        order=weakest_first(runs, static),
        command=lambda row, container: hall.command(row, runs.governing(container)),
    )
    failed = {*endings.values()} == {Ending.FAILED}
    return written(
        results,
        table,
        replace(
            begun, status=FAILED if failed else COMPLETED, runs=len(hall.items()), checked=len(runs.checked)
        ),
    )


def written(results: ResultFolder, table: HallTable, result: HallResult) -> HallResult:
    """Write the list with its results, plan and page; the result with its answer."""
    result = table.added_to(result)
    result = replace(result, answer=answer_of(result))
    results.write_text(TABLE, table_text((*table.file.columns, *RESULT_COLUMNS), table.rows()))
    for name, text in ((PICTURE, draw_places(result)), (GEOJSON, geojson(result))):
        if text:
            results.write_text(name, text)
        else:
            results.remove(name)
    results.write_text(PAGE, hall_report(results.path, result=result))
    return result


def _result_columns(runs: HallRuns, container: int) -> dict[str, Any]:
    """Results of a container, by column."""
    by_motion, motion = runs.by_container[container], runs.governing(container)
    row = row_of(RUN_COLUMNS, runs.worst(container).line)
    values: dict[str, Any] = {name: row[name] for name in OF_A_RUN} | runs.checked.get(container, {})
    if names := [pair.name for pair in runs.hall.motions]:
        slipped = max(sorted(by_motion), key=lambda number: by_motion[number].slip)
        counts = runs.counts(container)
        values |= dict(
            zip(OF_MOTIONS, (names[motion], *counts, by_motion[slipped].slip, names[slipped]), strict=True)
        )
    return values
