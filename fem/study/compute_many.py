"""Many runs in memory on all cores: `fem.compute_many(cases)`."""

import warnings
from collections.abc import Hashable, Iterable, Sequence
from functools import partial
from typing import Literal, overload

from fem.case.case import Case
from fem.model.geometry import build_container
from fem.model.motion import build_motions
from fem.run.checks import WantedChecks
from fem.run.compute import Run, compute_on, require_case
from fem.runtime.signals import stop_requested
from fem.runtime.threads import cores
from fem.study.containers import ContainerCache, container_key
from fem.study.workers import IN_THREADS, STDIN, LocalWorkers, hand_out, unguarded_script

#: number of cases from which processes pay off: runs with history and band hold the interpreter longer than rows do
WORTH_PROCESSES = {"rigid": 24, "reduced": 6, "full": 2}

_CONTAINERS = ContainerCache()

Item = tuple[int, Case]


@overload
def compute_many(
    cases: Iterable[Case],
    jobs: int | None = None,
    *,
    band: bool | None = None,
    margin: bool | None = None,
    check_rigid: bool = False,
    inner_forces: bool = True,
    errors: Literal["raise"] = "raise",
) -> list[Run]: ...
@overload
def compute_many(
    cases: Iterable[Case],
    jobs: int | None = None,
    *,
    band: bool | None = None,
    margin: bool | None = None,
    check_rigid: bool = False,
    inner_forces: bool = True,
    errors: Literal["return"],
) -> list[Run | ValueError]: ...
def compute_many(
    cases: Iterable[Case],
    jobs: int | None = None,
    *,
    band: bool | None = None,
    margin: bool | None = None,
    check_rigid: bool = False,
    inner_forces: bool = True,
    errors: Literal["raise", "return"] = "raise",
) -> Sequence[Run | ValueError]:
    """Compute cases in memory, side by side; no file is written.

    Several cases are shared by threads, many by processes as well. A process loads the script that started it: in a
    script, call this behind `if __name__ == "__main__":`. Where that is missing, a warning says so, and the cases are
    computed by threads alone. Cases that differ in floor or friction only share their container.

    Args:
        cases: from `fem.load_case`, `fem.case_from` or `case.replace`, of any models.
        jobs: cores to use; default: all.
        band, margin, check_rigid: as for `fem.compute`.
        inner_forces: whether the members of a band find stresses, and forces in the joints of a stack, which takes
            twice as long.
        errors: "raise" that of the first case that cannot be computed, which is looked for before any is computed; or
            "return" it in place of its run.

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
    runs: dict[int, Run | ValueError] = _objections(all_cases)
    if runs and errors == "raise":
        raise next(error for error in runs.values() if isinstance(error, ValueError))
    script = unguarded_script() if min(jobs, len(all_cases)) > 1 else None
    if script is not None:
        unfit, fit = (
            ("is no file that a process can load", "run it from a file")
            if script == STDIN
            else ('calls compute_many outside `if __name__ == "__main__":`', "put the call behind that line")
        )
        warnings.warn(
            f"{script} {unfit}, so its cases are computed by threads of this process only; {fit} to use several "
            "processes",
            stacklevel=2,
        )
    first: dict[Hashable, int] = {}
    for number, case in enumerate(all_cases):
        first.setdefault(container_key(case), number)
    order = sorted(range(len(all_cases)), key=lambda number: first[container_key(all_cases[number])])
    wanted = WantedChecks(check_rigid=check_rigid, band=band, margin=margin, inner_forces=inner_forces)
    work = partial(_compute, wanted, len(all_cases))
    with LocalWorkers(jobs, WORTH_PROCESSES if script is None else IN_THREADS) as workers_of:
        for model in WORTH_PROCESSES:
            items = [(n, all_cases[n]) for n in order if all_cases[n].solver.model == model and n not in runs]
            chunks = hand_out(
                items, work, workers_of(model, len(items)), at_a_time=1, stop=stop_requested, finish=False
            )
            for chunk, results in chunks:
                runs |= dict(zip((number for number, _ in chunk), results, strict=True))
                if errors == "raise":
                    for error in (result for result in results if isinstance(result, ValueError)):
                        raise error
    if stop_requested():
        raise KeyboardInterrupt
    return [runs[number] for number in range(len(all_cases))]


def _objections(cases: Sequence[Case]) -> dict[int, Run | ValueError]:
    """What is wrong with the containers and motions of cases, by their numbers; little beside computing them."""
    objections: dict[int, Run | ValueError] = {}
    for number, case in enumerate(cases):
        try:
            build_container(case)
            build_motions(case)
        except ValueError as error:
            objections[number] = _noted(error, number, len(cases))
    return objections


def _noted(error: ValueError, number: int, count: int) -> ValueError:
    error.add_note(f"case {number + 1} of {count} of compute_many")
    return error


def _compute(wanted: WantedChecks, count: int, items: Sequence[Item]) -> list[Run | ValueError]:
    runs: list[Run | ValueError] = []
    for number, case in items:
        try:
            runs.append(compute_on(_CONTAINERS.container_of(case), case, wanted))
        except ValueError as error:
            runs.append(_noted(error, number, count))
    return runs
