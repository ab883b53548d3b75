"""Rows of a list of cases, each that of a cell of a study, on all cores."""

from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Any

from fem.case.case import Case
from fem.runtime.threads import cores
from fem.study.containers import container_key
from fem.study.runner import Runner
from fem.study.workers import LocalWorkers, never


def model_of(item: tuple[int, Case]) -> str:
    return item[1].solver.model


def run_cases(
    cases: Sequence[Case],
    *,
    jobs: int | None = None,
    done: Callable[[int], Any] = lambda count: None,
    stop: Callable[[], bool] = never,
) -> list[Any]:
    """A row for each case, in their order; None where `stop` came first. `done` is told how many are ready."""
    rows: list[Any] = [None] * len(cases)
    first: dict[Any, int] = {}
    finished = 0
    for k, case in enumerate(cases):
        first.setdefault(container_key(case), k)
    order = sorted(range(len(cases)), key=lambda k: first[container_key(cases[k])])
    with LocalWorkers(jobs or cores()) as workers_of:
        runner = Runner(workers_of=workers_of, stop=stop)
        for chunk, computed in runner.rows("cases", [(k, cases[k]) for k in order], itemgetter(1), model_of):
            for (k, _), row in zip(chunk, computed, strict=True):
                rows[k] = row
            done(finished := finished + len(chunk))
    return rows
