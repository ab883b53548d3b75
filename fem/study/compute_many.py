"""Many runs in memory on all cores: `fem.compute_many(cases)`."""

import warnings
from collections.abc import Callable, Hashable, Iterable, Sequence
from contextlib import closing
from functools import partial
from operator import itemgetter
from typing import Literal, TypedDict, Unpack, overload

from fem.case.case import Case
from fem.model.geometry import build_container
from fem.model.motion import build_motions
from fem.run.checks import WantedChecks
from fem.run.compute import Run, compute_on, require_case
from fem.runtime.progress import ScreenReporter, watched
from fem.runtime.signals import stop_requested
from fem.runtime.threads import cores
from fem.study.containers import ContainerCache, container_key
from fem.study.runner import Row, Runner
from fem.study.workers import IN_THREADS, STDIN, LocalWorkers, unguarded_script

#: number of cases from which processes pay off: runs with history and band hold the interpreter longer than rows do
WORTH_PROCESSES = {"rigid": 24, "reduced": 6, "full": 2}

_CONTAINERS = ContainerCache()

Item = tuple[int, Case]


class Wanted(TypedDict, total=False):
    """What is found of each run, as for `fem.compute`."""

    band: bool | None
    margin: bool | None
    check_rigid: bool
    #: whether the members of a band find stresses, and forces in the joints of a stack, which takes twice as long
    inner_forces: bool


@overload
def compute_many(
    cases: Iterable[Case], jobs: int | None = None, *, progress: bool | None = None, **wanted: Unpack[Wanted]
) -> list[Run]: ...
@overload
def compute_many(
    cases: Iterable[Case],
    jobs: int | None = None,
    *,
    errors: Literal["return"],
    progress: bool | None = None,
    **wanted: Unpack[Wanted],
) -> list[Run | ValueError]: ...
def compute_many(
    cases: Iterable[Case],
    jobs: int | None = None,
    *,
    errors: Literal["raise", "return"] = "raise",
    progress: bool | None = None,
    **wanted: Unpack[Wanted],
) -> Sequence[Run | ValueError]:
    """Compute cases in memory, side by side; no file is written.

    Several cases are shared by threads, many by processes as well. A process loads the script that started it: in a
    script, call this behind `if __name__ == "__main__":`. Where that is missing, a warning says so, and the cases are
    computed by threads alone. Cases that differ in floor or friction only share their container.

    Args:
        cases: from `fem.load_case`, `fem.case_from` or `case.replace`, of any models.
        jobs: cores to use; default: all.
        errors: "raise" that of the first case that cannot be computed, which is looked for before any is computed; or
            "return" it in place of its run.
        progress: show it by a line; default: on a terminal and in a notebook.
        wanted: band, margin, check_rigid, inner_forces: see `Wanted`.

    Returns:
        The runs in the order of the cases, each the same as `fem.compute` gives, whatever `jobs` is.

    Raises:
        CaseError, MeshError: one of the cases cannot be computed; a note of the error says which.
        ValueError: jobs is less than 1.
        WorkersLostError: a process died, perhaps for want of memory.
    """
    all_cases = list(cases)
    for case in all_cases:
        require_case(case)
    jobs = cores() if jobs is None else jobs
    if jobs < 1:
        raise ValueError(f"compute_many: jobs must be at least 1, got {jobs}")
    runs: dict[int, Run | ValueError] = {}
    for number, case in enumerate(all_cases):
        try:
            build_container(case)
            build_motions(case)
        except ValueError as error:
            runs[number] = _noted(error, number, len(all_cases))
            if errors == "raise":
                raise
    script = unguarded_script() if min(jobs, len(all_cases)) > 1 else None
    if script is not None:
        reason = (
            "is no file that a process can load" if script == STDIN else 'lacks `if __name__ == "__main__":`'
        )
        warnings.warn(
            f"{script} {reason}, so its cases are computed by threads of this process only; call compute_many behind "
            "that line, in a script that is a file, to use several processes",
            stacklevel=2,
        )
    first: dict[Hashable, int] = {}
    for number, case in enumerate(all_cases):
        first.setdefault(container_key(case), number)
    order = sorted(range(len(all_cases)), key=lambda number: first[container_key(all_cases[number])])
    work = partial(_compute, WantedChecks(**wanted), len(all_cases))
    reporter = ScreenReporter(quiet=not (watched() if progress is None else progress))
    with LocalWorkers(jobs, WORTH_PROCESSES if script is None else IN_THREADS) as workers_of:
        runner = Runner(workers_of=workers_of, reporter=reporter, stop=stop_requested)
        items = [(number, all_cases[number]) for number in order if number not in runs]
        found = runner.rows("runs", items, itemgetter(1), lambda item: item[1].solver.model, work)
        with closing(found):
            for chunk, rows in found:
                for (number, _), row in zip(chunk, rows, strict=True):
                    runs[number] = row["run"]
                    if errors == "raise" and isinstance(row["run"], ValueError):
                        raise row["run"]
    if stop_requested():
        raise KeyboardInterrupt
    return [runs[number] for number in range(len(all_cases))]


def _noted(error: ValueError, number: int, count: int) -> ValueError:
    error.add_note(f"case {number + 1} of {count} of compute_many")
    return error


def _compute(
    wanted: WantedChecks, count: int, make: Callable[[Item], Case], items: Sequence[Item]
) -> list[Row]:
    rows: list[Row] = []
    for item in items:
        try:
            case = make(item)
            rows.append({"status": "", "run": compute_on(_CONTAINERS.container_of(case), case, wanted)})
        except ValueError as error:
            rows.append({"status": "failed", "run": _noted(error, item[0], count)})
    return rows
