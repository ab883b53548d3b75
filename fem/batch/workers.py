"""Who computes the cases of a list: the cores of this machine, and how chunks of the list are handed to them."""

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import ExitStack
from dataclasses import dataclass, field
from itertools import islice
from multiprocessing import get_context
from multiprocessing.synchronize import Event
from types import TracebackType
from typing import Self, TypeVar

#: cases from which processes of their own, which take some seconds to start, are worth it for the compiled models
WORTH_PROCESSES = {"rigid": 500, "reduced": 100}
#: chunks handed out for every worker, so that none waits for the next
AHEAD = 2

ItemT = TypeVar("ItemT")
FoundT = TypeVar("FoundT")


def never() -> bool:
    """A `stop` that never asks to stop."""
    return False


class WorkersLostError(RuntimeError):
    """The workers died; what they had computed before is kept."""

    exit_code = 3


@dataclass
class Pool:
    """An executor, how many chunks it works on at once, and how many are with it."""

    executor: Executor
    count: int
    given: int = field(default=0, init=False)


#: who computes so many cases of a model
WorkersOf = Callable[[str, int], Sequence[Pool]]


class LocalWorkers:
    """The cores of this machine; called with a model and a number of cases, it tells who computes them.

    `full` runs in processes. The compiled models step without the interpreter's lock, but two fifths of a rigid case
    are the making of its model and its row: threads make two cores 1.3 times one. Many cases are therefore shared by
    one thread of this process, which works while the others start, and a process for every other core. Processes once
    started stay for later cases; to leave the context ends them, and does not wait for the case of a process, which
    may take an hour.
    """

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._held = ExitStack()
        self._over: Event | None = None
        self._pools: dict[tuple[type[Executor], int], Executor] = {}

    def __call__(self, model: str, count: int) -> Sequence[Pool]:
        jobs = self._jobs
        if model == "full":
            return [self._processes(jobs)]
        started = (ProcessPoolExecutor, jobs - 1) in self._pools
        if jobs > 1 and (started or count >= WORTH_PROCESSES[model]):
            return [self._threads(1), self._processes(jobs - 1)]
        return [self._threads(jobs)]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._over is not None:
            self._over.set()
        self._held.close()

    def _threads(self, count: int) -> Pool:
        key = ThreadPoolExecutor, count
        if key not in self._pools:
            self._pools[key] = self._held.enter_context(ThreadPoolExecutor(count))
        return Pool(self._pools[key], count)

    def _processes(self, count: int) -> Pool:
        key = ProcessPoolExecutor, count
        if key not in self._pools:
            context = get_context("spawn")
            self._over = self._over or context.Event()
            executor = ProcessPoolExecutor(count, context, _end_with_parent, (os.getpid(), self._over))
            self._pools[key] = self._held.enter_context(executor)
        return Pool(self._pools[key], count)


def hand_out(
    items: Iterable[ItemT],
    work: Callable[[list[ItemT]], FoundT],
    pools: Sequence[Pool],
    *,
    at_a_time: int,
    stop: Callable[[], bool] = never,
    finish: bool = True,
) -> Iterator[tuple[list[ItemT], FoundT]]:
    """Let pools work on chunks of items; yields chunks and what was found of them as they come, in any order.

    Args:
        items: what is to be done, in the order in which it is begun.
        work: done to a chunk; goes to the workers, so for processes it must be picklable.
        pools: who works.
        at_a_time: items of a chunk.
        stop: asked now and then; true ends the work.
        finish: whether what has begun is waited for then.

    Raises:
        WorkersLostError: a process died.
    """
    remaining = iter(items)
    waiting: dict[Future[FoundT], tuple[Pool, list[ItemT]]] = {}
    try:
        while waiting or not stop():
            for pool in pools:
                while pool.given < AHEAD * pool.count and not stop():
                    chunk = list(islice(remaining, at_a_time))
                    if not chunk:
                        break
                    waiting[pool.executor.submit(work, chunk)] = pool, chunk
                    pool.given += 1
            if not waiting:
                break
            finished, _ = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in finished:
                try:
                    found = future.result()
                except BrokenExecutor as error:
                    raise WorkersLostError(
                        f"a worker process died ({error}); perhaps it ran out of memory: --resume goes on, -j 1 needs "
                        "less"
                    ) from None
                pool, chunk = waiting.pop(future)
                pool.given -= 1
                yield chunk, found
            if stop():
                for future in [future for future in waiting if future.cancel()]:
                    del waiting[future]
                if not finish:
                    break
    finally:
        for future in waiting:
            future.cancel()


def _end_with_parent(parent: int, over: Event) -> None:
    """End this worker when the work is over, or the process that started it is gone, however it went."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is heard by the process that started it

    def watch() -> None:
        while os.getppid() == parent and not over.wait(1.0):
            pass
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
