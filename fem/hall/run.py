"""A hall from its list to its folder: runs, the weakest of them repeated, the list with results, page.

The runs are logged as they are ready, so an interrupted hall continues where it was; its files depend neither on that
nor on the number of cores. A hall of which names, tags or places alone have changed is written again, not computed.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, Unpack

from fem.batch.axes import MOTION_FILE, VERTICAL_FILE
from fem.batch.checked import check_chunk
from fem.batch.log import LoggedRuns
from fem.batch.motion_set import motions_left_out
from fem.batch.runner import Runner
from fem.batch.study import INTERRUPTED, Study, StudyOptions, hash_of, run_study, runner_of
from fem.batch.table import table_of_lines, table_text
from fem.case.case import Case
from fem.case.toml import toml_document
from fem.case.validation import CaseError
from fem.hall.file import HallFile
from fem.hall.plan import Hall, HallItem, read_motions, say_time
from fem.hall.ranking import CHECK_COLUMNS, RUN_COLUMNS, HallRuns
from fem.hall.result import HallResult
from fem.hall.table import written
from fem.results.disk import BYTES_BESIDE, table_bytes
from fem.results.folder import ResultFolder
from fem.results.kinds import HALL

RUNS, CHECKS = "runs.csv", "checks.csv"
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
        file: the list.
        base: the case that its rows change.
        motions: files of motions in place of that of the case, "H" or "H,V" each; every container undergoes all.
        checks: which governing runs are repeated for `sure` and `margin`: those of the weakest tenth and of at least
            30 containers, all, or none.
        strict: refuse the list for one bad row.
        options: of every study.
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
            _compute,
            asked=hash_of([[*hall.containers], [pair.case_hash for pair in pairs]]),
            listed=hash_of([file.table.text, checks]),
            motions=motions,
            motion_covered=motions_left_out(base, pairs),
            checks=checks,
        )
        size = study.size + 2.0 * table_bytes(len(hall.items), len(RUN_COLUMNS))
        study = replace(study, size=size, cases=[] if pairs else [base], motions=[one.case for one in pairs])
        return run_study(study, folder, **options)


def study_of(
    hall: Hall, compute: Callable[[Hall, HallResult, ResultFolder, Runner], HallResult], **fields: Any
) -> Study[HallResult]:
    """The study of a list.

    Args:
        hall: the list, checked.
        compute: what is missing of it.
        fields: of the result before any run, in one way of computing.
    """
    rows, file, origin = hall.rows, hall.file, hall.base.origin_with({})
    known = {"model": hall.base.solver.model, "allow_outside": origin.allow_outside or None}
    begun = HallResult(
        hall=file.name,
        case=origin.place,
        rows=len(rows),
        containers=sum(row.count for row in rows),
        distinct=len(hall.containers),
        refused=sum(row.container is None for row in rows),
        kept=tuple(column for column, meaning in file.meanings.items() if not meaning),
        columns=file.columns,
        **(known | fields),
    )
    return Study(
        kind=HALL,
        request=begun.asked,
        result=HallResult,
        begun=begun,
        compute=partial(compute, hall, begun),
        texts={"list.csv": file.table.text, "base.toml": toml_document(hall.base.given())},
        size=BYTES_BESIDE,
        subject=f"the hall ({begun.distinct} containers)",
        way_out="take fewer rows",
        progress=lambda results: "what was computed so far",
        again=lambda results, finished: finished if finished.listed == begun.listed else None,
    )


def _compute(hall: Hall, begun: HallResult, results: ResultFolder, runner: Runner) -> HallResult:
    """Compute what is missing, and write the list with its results, and its page."""
    runs, total = HallRuns(hall=hall), len(hall.items)
    logged = partial(LoggedRuns[HallItem], make=hall.make, model_of=hall.model_of)
    logged(
        what="runs",
        path=results.path / RUNS,
        columns=RUN_COLUMNS,
        key=lambda item: item[:2],
        note=runs.note,
        number=lambda item: item.container * len(hall.keys) + item.motion,
    ).run(runner, iter(runs.missing, []))
    if missing := len(runs.missing()):
        words = f"{total - missing} of {total} runs are computed"
        return replace(begun, status=INTERRUPTED, runs=total - missing, missing=words)
    runs.find_static()
    to_check = partial(runs.to_check, begun.checks, runs.weakest_first())
    logged(
        what="containers repeated with other inputs and stronger motions",
        path=results.path / CHECKS,
        columns=CHECK_COLUMNS,
        key=lambda item: item[:1],
        note=runs.note_check,
        work=check_chunk,
    ).run(runner, iter(to_check, []))
    begun = replace(begun, runs=total, checked=len(runs.checked))
    if left := len(to_check()):
        return replace(begun, status=INTERRUPTED, missing=f"{left} of the weakest are still to be repeated")
    results.check()
    results.write_text(RUNS, table_of_lines(RUN_COLUMNS, (line for _, line in sorted(runs.lines.items()))))
    checked = sorted(runs.checked.items())
    results.write_text(CHECKS, table_text(CHECK_COLUMNS, ([k, *check.values()] for k, check in checked)))

    return written(results, begun, hall, [runs.found(number) for number in range(len(hall.values))])
