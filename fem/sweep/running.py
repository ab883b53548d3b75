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
from itertools import islice
from multiprocessing import get_context
from typing import Any

from fem.case import Case
from fem.model import Container, build_model, discretise
from fem.recorder import Recorder
from fem.recovery import recovery_of
from fem.simulation import cores, simulate
from fem.verdict import verdict_of

#: cases handed to a core at a time
CASES_AT_A_TIME = {"rigid": 16, "reduced": 4, "full": 1}
#: scalars of a verdict, as columns; None where a case does not have them
SCALARS = (
    "outcome",
    "max_rotation_rad",
    "rotation_ratio",
    "max_slip_m",
    "residual_slip_m",
    "slip_peak_to_peak_m",
    "slip_travel_m",
    "max_uplift_m",
    "impacts",
    "first_opening_s",
    "first_uplift_s",
    "first_impact_s",
    "overturned_at_s",
    "restored",
    "restitution_first",
    "max_corner_force_N",
    "max_top_displacement_m",
    "max_acceleration_m_s2",
    "max_von_mises_Pa",
)
#: what a row holds besides: how it ended, why it failed, what it took
STATE = ("status", "reason", "wall_s")

Row = dict[str, Any]


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
    for chunk, found in run_in_chunks([(k, cases[k]) for k in order], jobs=jobs, stop=stop):
        for k, row in zip(chunk, found, strict=True):
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


def run_in_chunks(
    numbered: Sequence[tuple[int, Case]],
    *,
    jobs: int | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Iterator[tuple[list[int], list[Row]]]:
    """Run numbered cases; yields numbers and rows as they come, in any order."""
    jobs = jobs or cores()
    compiled = [item for item in numbered if item[1].solver.model != "full"]
    whole = [item for item in numbered if item[1].solver.model == "full"]
    if compiled:
        with ThreadPoolExecutor(jobs) as pool:
            shelf = Shelf()
            yield from _spread(pool, jobs, _chunks(compiled), lambda chunk: run_chunk(chunk, shelf), stop)
    if whole:
        with ProcessPoolExecutor(jobs, get_context("spawn"), _die_with, (os.getpid(),)) as processes:
            yield from _spread(processes, jobs, _chunks(whole), run_chunk, stop)


def run_chunk(cases: Sequence[Case], shelf: "Shelf | None" = None) -> list[Row]:
    """Run cases one after the other."""
    shelf = shelf or _SHELF
    return [_run_one(case, shelf) for case in cases]


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


def _chunks(numbered: Sequence[tuple[int, Case]]) -> Iterator[tuple[list[int], list[Case]]]:
    remaining = iter(numbered)
    while chunk := list(islice(remaining, CASES_AT_A_TIME[numbered[0][1].solver.model])):
        yield [number for number, _ in chunk], [case for _, case in chunk]


def _spread(
    pool: Executor,
    jobs: int,
    chunks: Iterator[tuple[list[int], list[Case]]],
    work: Callable[[list[Case]], list[Row]],
    stop: Callable[[], bool],
) -> Iterator[tuple[list[int], list[Row]]]:
    """Keep `jobs` workers busy without queueing up everything at once."""
    waiting: dict[Future[list[Row]], list[int]] = {}
    try:
        while not stop():
            for numbers, cases in islice(chunks, 2 * jobs - len(waiting)):
                waiting[pool.submit(work, cases)] = numbers
            if not waiting:
                break
            finished, _ = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in finished:
                yield waiting.pop(future), future.result()
    finally:
        for future in waiting:
            future.cancel()


def _run_one(case: Case, shelf: Shelf) -> Row:
    began = time.perf_counter()
    try:
        quiet = case.with_values({"output.fields_s": 0.0}) if case.output.fields_s > 0.0 else case
        model = build_model(quiet, shelf.container_of(case))
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


def _die_with(parent: int) -> None:
    """End this worker when the process that started it is gone, however it went."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
