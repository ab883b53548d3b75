"""Rows of a list of cases, each that of a cell of a study, on all cores."""

from operator import itemgetter

from fem.runtime.threads import cores
from fem.study.containers import container_key
from fem.study.runner import Runner
from fem.study.workers import LocalWorkers, never


def model_of(item):
    return item[1].solver.model


def run_cases(cases, *, jobs=None, done=lambda count: None, stop=never):
    """A row for each case, in their order; None where `stop` came first. `done` is told how many are ready."""
    rows, first, finished = [None] * len(cases), {}, 0
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
