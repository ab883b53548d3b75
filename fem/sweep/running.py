"""A list of cases, run on all cores: one row of figures each, in the order of the list.

Cases that have the same container share its mesh and modes. A case that cannot be computed is a row with
status "failed" and the reason; it never has an outcome.
"""

import os
import threading
import time
from collections.abc import Callable, Hashable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context
from operator import itemgetter
from typing import Any, TypeVar

from fem.case import Case
from fem.model import Container, build_model, discretise
from fem.recorder import Recorder
from fem.recovery import recovery_of
from fem.simulation import cores, simulate
from fem.sweep.table import SCALARS
from fem.verdict import verdict_of

#: cases handed to a core at a time
CASES_AT_A_TIME = {"rigid": 16, "reduced": 4, "full": 1}
#: chunks handed out for every worker, so that none waits for the next
AHEAD = 2

Row = dict[str, Any]
ItemT = TypeVar("ItemT")


def run_cases(
    cases: Sequence[Case],
    *,
    jobs: int | None = None,
    done: Callable[[int], None] = lambda count: None,
    stop: Callable[[], bool] = lambda: False,
) -> list[Row]:
    """Run cases and return a row each, in their order, the same whatever `jobs`.

    No files are written, no fields are kept.

    Args:
        cases: what to run, of any models and containers.
        jobs: cores to use; all by default.
        done: told now and then how many rows there are.
        stop: asked now and then; true ends the work.

    Returns:
        For each case `status` (completed | overturned | failed), `reason` (why it failed, else None), `wall_s`, and
        every scalar of a verdict (`SCALARS`). Cases not reached when stopped have status "interrupted".
    """
    rows: list[Row] = [_row_without_outcome("interrupted", "stopped before its turn") for _ in cases]
    first: dict[Hashable, int] = {}
    for k, case in enumerate(cases):
        first.setdefault(container_key(case), k)
    order = sorted(range(len(cases)), key=lambda k: first[container_key(cases[k])])
    finished = 0
    for model in ("rigid", "reduced", "full"):
        items = [(k, cases[k]) for k in order if cases[k].solver.model == model]
        with local_workers(model, jobs or cores()) as workers:
            for chunk, found in run_items(items, itemgetter(1), model, workers, stop=stop):
                for (k, _), row in zip(chunk, found, strict=True):
                    rows[k] = row
                finished += len(chunk)
                done(finished)
    return rows


def container_key(case: Case) -> Hashable:
    """Equal for cases whose containers are the same, whatever floor they stand on."""
    solver = case.solver
    return (
        case.container,
        case.support,
        case.gravity_m_s2,
        case.folder,
        solver.model,
        solver.elastic_modes if solver.model == "reduced" else None,
        solver.element_size_m,
        solver.order,
        case.output.stop_when_overturned,
    )


@dataclass(frozen=True, kw_only=True)
class Workers:
    """Who computes: an executor, and how many chunks it works on at once."""

    pool: Executor
    count: int


@contextmanager
def local_workers(model: str, jobs: int) -> Iterator[Workers]:
    """Threads for the compiled models, which work without the interpreter's lock, and processes for `full`."""
    if model == "full":
        context = get_context("spawn")
        with ProcessPoolExecutor(jobs, context, _end_with_parent, (os.getpid(),)) as processes:
            yield Workers(pool=processes, count=jobs)
    else:
        with ThreadPoolExecutor(jobs) as threads:
            yield Workers(pool=threads, count=jobs)


def run_items(
    items: Sequence[ItemT],
    make: Callable[[ItemT], Case],
    model: str,
    workers: Workers,
    *,
    stop: Callable[[], bool] = lambda: False,
) -> Iterator[tuple[list[ItemT], list[Row]]]:
    """Run one case for each item; yields items and their rows as they come, in any order.

    Args:
        items: in an order in which those of one container stand together.
        make: the case of an item; goes to the workers, so for processes it must be a module's function or a
            method of something that can be pickled.
        model: of all these cases.
        workers: from `local_workers`, or a cluster.
        stop: asked now and then; true ends the work when what has begun is done.
    """
    remaining = iter(items)
    waiting: dict[Future[list[Row]], list[ItemT]] = {}
    try:
        while waiting or not stop():
            while len(waiting) < AHEAD * workers.count and not stop():
                chunk = list(islice(remaining, CASES_AT_A_TIME[model]))
                if not chunk:
                    break
                waiting[workers.pool.submit(run_chunk, make, chunk)] = chunk
            if not waiting:
                break
            finished, _ = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in finished:
                yield waiting.pop(future), future.result()
            if stop():
                for future in [future for future in waiting if future.cancel()]:
                    del waiting[future]
    finally:
        for future in waiting:
            future.cancel()


def run_chunk(make: Callable[[ItemT], Case], items: Sequence[ItemT]) -> list[Row]:
    """Run the cases of some items one after the other."""
    return [_run_one(make, item) for item in items]


class Shelf:
    """The containers used last; safe for threads, and no container is built twice at once."""

    def __init__(self, room: int = 8) -> None:
        self._room = room
        self._lock = threading.Lock()
        self._held: dict[Hashable, Future[Container]] = {}

    def container_of(self, case: Case) -> Container:
        """The case's container, built if it is not there.

        Raises:
            CaseError, MeshError: bad input.
        """
        key = container_key(case)
        with self._lock:
            found = self._held.pop(key, None)
            mine = found is None
            promise = Future[Container]() if found is None else found
            self._held[key] = promise  # the one used last stands last
            while len(self._held) > self._room:
                del self._held[next(iter(self._held))]
        if mine:
            try:
                promise.set_result(discretise(case))
            except BaseException as error:
                promise.set_exception(error)
        return promise.result()


_SHELF = Shelf()


def _run_one(make: Callable[[ItemT], Case], item: ItemT) -> Row:
    began = time.perf_counter()
    try:
        case = make(item)
        quiet = case.with_values({"output.fields_s": 0.0}) if case.output.fields_s > 0.0 else case
        model = build_model(quiet, _SHELF.container_of(case))
        recorder = Recorder(model, recovery_of(model))
        ending = simulate(model, recorder)
        rigid = case.solver.model == "rigid"
        found = verdict_of(model, recorder.history(), None if rigid else recorder.largest_von_mises)
    except (ValueError, ArithmeticError, RuntimeError) as error:  # bad input, no stance, a singular matrix
        row = _row_without_outcome("failed", str(error))
    else:
        row = {"status": ending.status, "reason": ending.error}
        row |= {name: found[name] for name in SCALARS}
        if ending.status == "failed":
            row["outcome"] = None
    return row | {"wall_s": time.perf_counter() - began}


def _row_without_outcome(status: str, reason: str) -> Row:
    return {"status": status, "reason": reason, "wall_s": 0.0} | dict.fromkeys(SCALARS)


def _end_with_parent(parent: int) -> None:
    """End this worker when the process that started it is gone, however it went."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
