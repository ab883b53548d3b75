"""A hall from its list to its folder: runs, the weakest of them repeated, the list with results, page.

The runs are logged as they are ready, so an interrupted hall continues where it was; its files depend neither on that
nor on the number of cores. A hall of which names, tags or places alone have changed is written again, not computed.
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Literal, Unpack

from fem.batch.axes import MOTION_FILE, VERTICAL_FILE
from fem.batch.checked import CHECKED, check_chunk
from fem.batch.log import LoggedRuns
from fem.batch.motion_set import motions_left_out
from fem.batch.runner import Row, Runner
from fem.batch.study import INTERRUPTED, StudyOptions, hash_of, run_study, runner_of
from fem.case.case import Case
from fem.case.validation import CaseError
from fem.hall.file import HallFile
from fem.hall.plan import Hall, HallItem, read_motions, say_time
from fem.hall.result import OF_A_RUN, OF_MOTIONS, STATIC, HallResult
from fem.hall.study import WORST_FIRST, ending_in, study_of, weakness, written
from fem.model.geometry import build_container
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.results.disk import table_bytes
from fem.results.figures import SLIPPED
from fem.results.folder import ResultFolder

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
            partial(_compute, hall),
            asked=hash_of([[*hall.containers], [pair.case_hash for pair in pairs]]),
            listed=hash_of([file.table.text, checks]),
            motions=motions,
            motion_covered=motions_left_out(base, pairs),
            checks=checks,
        )
        size = 2.0 * table_bytes(len(hall.items), len(RUN_COLUMNS))
        study = replace(
            study, size=size, cases=[] if pairs else [base], motions=[pair.case for pair in pairs]
        )
        return run_study(study, folder, **options)


def _compute(hall: Hall, begun: HallResult, results: ResultFolder, runner: Runner) -> HallResult:
    """Compute what is missing, and write the list with its results, and its page."""
    items, motions = hall.items, len(hall.keys)
    logged = partial(LoggedRuns[HallItem], make=hall.make, model_of=hall.model_of)
    runs = logged(
        what="runs",
        path=results.path / RUNS,
        columns=RUN_COLUMNS,
        key=lambda item: item[:2],
        items=items,
    )
    runs.run(runner, iter(runs.missing, []))
    begun = replace(begun, runs=len(runs.lines))
    if runs.missing():
        words = f"{begun.runs} of {len(items)} runs are computed"
        return replace(begun, status=INTERRUPTED, missing=words)
    found = [_governing(hall, items[k : k + motions], runs) for k in range(0, len(items), motions)]
    weakest = sorted(found, key=lambda pair: weakness(pair[1]))
    able = [item for item, row in weakest if row["outcome"] and hall.model_of(item) != "full"]
    count = {"none": 0, "all": len(able)}.get(begun.checks, max(math.ceil(SHARE * len(found)), LEAST))
    checks = logged(
        what="containers repeated with other inputs and stronger motions",
        path=results.path / CHECKS,
        columns=CHECK_COLUMNS,
        key=lambda item: item[:1],
        items=[item for item, _ in found],
        work=check_chunk,
    )
    to_check = partial(checks.missing, able[:count])
    checks.run(runner, iter(to_check, []))
    begun = replace(begun, checked=len(checks.lines))
    if left := len(to_check()):
        return replace(begun, status=INTERRUPTED, missing=f"{left} of the weakest are still to be repeated")
    results.check()
    results.write_text(RUNS, runs.table())
    results.write_text(CHECKS, checks.table())
    rows = [row | checks.row(item) for item, row in found]
    return written(results, begun, hall, rows, lambda number, values: hall.command(found[number][0], values))


def _governing(hall: Hall, items: Sequence[HallItem], runs: LoggedRuns[HallItem]) -> tuple[HallItem, Row]:
    """The run in which a container does worst, the first of equals; and the results of the container.

    These are those of that run, the static rule under its peak, and what all its motions do.
    """
    rows = [runs.row(item) for item in items]
    ranks = [*map(weakness, rows)]
    item = items[ranks.index(min(ranks))]
    case = hall.make(item)
    peaks = peaks_in_run(case, *build_motions(case))
    ruling = static_checks_of(case, build_container(case), *peaks).ruling.to_result()
    row = {name: rows[item.motion][name] for name in OF_A_RUN}
    row |= {name: getattr(ruling, name) for name in STATIC}
    if names := [pair.name for pair in hall.motions]:
        counts, slips = Counter(map(ending_in, rows)), [run[SLIPPED] or 0.0 for run in rows]
        slid = slips.index(max(slips))
        under = names[item.motion], *(counts[word] for word in WORST_FIRST[:3]), slips[slid], names[slid]
        row |= zip(OF_MOTIONS, under, strict=True)
    return item, row
