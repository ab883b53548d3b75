"""The cores of this machine as pools of workers, and how chunks of a list are handed to them."""

import linecache
import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from itertools import islice
from multiprocessing import get_context
from multiprocessing.queues import SimpleQueue
from multiprocessing.synchronize import Semaphore
from typing import Self, TypeVar

#: number of cases from which processes pay off for the compiled models: to start from nothing they take as long as a
#: thousand rigid runs
WORTH_PROCESSES = {"rigid": 2000, "reduced": 100, "full": 1}
#: the same of processes that are forked, with all modules loaded
WORTH_FORKS = {"rigid": 64, "reduced": 8, "full": 1}
ENDING_S = 10.0  #: that running work is waited for once a stop is asked for
IN_THREADS = dict.fromkeys(WORTH_PROCESSES, math.inf)  #: no number: threads alone
ENDING = (signal.SIGINT, signal.SIGTERM)  #: signals that end a process
STDIN = "<stdin>"  #: file of a script that Python reads from its standard input
#: chunks handed out for every worker, so that none waits for the next
AHEAD = 2

ItemT = TypeVar("ItemT")
FoundT = TypeVar("FoundT")


def never() -> bool:
    """A `stop` that never asks to stop."""
    return False


class WorkersLostError(RuntimeError):
    """The workers died; their finished rows are kept."""

    exit_code = 3


@dataclass
class Pool:
    """An executor, how many chunks it works on at once, and how many it has."""

    executor: Executor
    count: int
    given: int = field(default=0, init=False)


#: the pools for so many cases of a model
WorkersOf = Callable[[str, int], Sequence[Pool]]


class LocalWorkers:
    """The cores of this machine; called with a model and a number of cases, it returns the pools that compute them.

    `full` runs in processes. The compiled models step without the interpreter's lock, but building the model and the
    row takes two fifths of a rigid case: with threads, two cores are 1.3 times as fast as one. Many cases are
    therefore shared by one thread of this process, which works while the others start, and one process for each other
    core. They are forks of this process where it has no other thread yet, as at the command line. Started processes are
    kept for later cases; leaving the context ends them at once, as a case may take an hour. `worth`: number of cases of
    a model from which new processes are started; default: `WORTH_PROCESSES`.
    """

    def __init__(self, jobs: int, worth: Mapping[str, float] | None = None) -> None:
        self._jobs, self._worth = jobs, worth or WORTH_PROCESSES
        self._held = ExitStack()
        #: released for each process at the end; a dead one blocks no other
        self._over: Semaphore | None = None
        self._begun: list[SimpleQueue[int]] = []  #: process ids of those that have begun
        self._pools: dict[tuple[bool, int], Executor] = {}  #: by whether it is of processes, and how many

    def __call__(self, model: str, count: int) -> Sequence[Pool]:
        jobs, least = self._jobs, self._worth[model]
        if least < math.inf and _may_fork():
            least = min(least, WORTH_FORKS[model])
        if model == "full" and count >= least:
            return [self._pool(jobs, processes=True)]
        if jobs > 1 and (count >= least or (True, jobs - 1) in self._pools):
            # the thread second: it would rule out forks
            return [self._pool(jobs - 1, processes=True), self._pool(1)]
        return [self._pool(jobs)]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *ended: object) -> None:
        for processes, count in self._pools:
            for _ in range(count if processes else 0):
                assert self._over is not None
                self._over.release()
        if sys.platform != "win32":
            for begun in self._begun:
                while not begun.empty():
                    with suppress(OSError):  # it has ended
                        os.kill(begun.get(), signal.SIGCONT)  # one that somebody stopped would never end
        self._held.close()

    def _pool(self, count: int, *, processes: bool = False) -> Pool:
        key = processes, count
        if key not in self._pools:
            executor: Executor = ThreadPoolExecutor(count)
            if processes:
                context = get_context("fork" if _may_fork() else "spawn")
                self._over = self._over or context.Semaphore(0)
                self._begun.append(context.SimpleQueue())
                watched = os.getpid(), self._over, self._begun[-1]
                executor = ProcessPoolExecutor(count, context, _end_with_parent, watched)
            self._pools[key] = self._held.enter_context(executor)
        return Pool(self._pools[key], count)


def _may_fork() -> bool:
    """Whether a copy of this process would lack nothing: it has no other thread, of Python or of a library.

    Such a thread may hold a lock, which nobody releases in the copy.
    """
    return sys.platform == "linux" and len(os.listdir("/proc/self/task")) == 1


def hand_out(
    items: Iterable[ItemT],
    work: Callable[[list[ItemT]], FoundT],
    pools: Sequence[Pool],
    *,
    at_a_time: int,
    stop: Callable[[], bool] = never,
    finish: bool = True,
) -> Iterator[tuple[list[ItemT], FoundT]]:
    """Let pools work on chunks of items; yields chunks and their results as they are ready, in any order.

    `work` is picklable. `stop` is asked repeatedly; true ends the work, and running chunks are completed if `finish`,
    of workers that answer within `ENDING_S`. WorkersLostError where a process died.
    """
    remaining, until = iter(items), math.inf
    waiting: dict[Future[FoundT], tuple[Pool, list[ItemT]]] = {}
    try:
        while waiting or not stop():
            for pool in pools:
                while pool.given < AHEAD * pool.count and not stop():
                    chunk = list(islice(remaining, at_a_time))
                    if not chunk:
                        break
                    # This may start a process, which keeps the signals blocked: Ctrl-C, sent to the whole group, would
                    # else meet it before `_end_with_parent` does.
                    held = () if sys.platform == "win32" else signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
                    try:
                        waiting[pool.executor.submit(work, chunk)] = pool, chunk
                    finally:
                        if sys.platform != "win32":
                            signal.pthread_sigmask(signal.SIG_SETMASK, held)
                    pool.given += 1
            if not waiting:
                break
            finished, _ = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in finished:
                try:
                    results = future.result()
                except BrokenExecutor as error:
                    if stop():  # the signal that asked for it ended the workers, too
                        return
                    raise WorkersLostError(
                        f"a worker process died ({error}); perhaps it ran out of memory: --resume continues, -j 1 "
                        "needs less memory"
                    ) from None
                pool, chunk = waiting.pop(future)
                pool.given -= 1
                yield chunk, results
            if stop():
                until = min(until, time.monotonic() + ENDING_S)
                for future in [future for future in waiting if future.cancel()]:
                    del waiting[future]
                if not finish or time.monotonic() > until:
                    break
    finally:
        for future in waiting:
            future.cancel()


def unguarded() -> str | None:
    """The main script, if it never asks for its `__name__`: a process would load it, and start it again; and why so.

    None where a process may be started; also for a notebook, whose processes load nothing. No process can load a script
    that Python reads from its standard input.
    """
    path = getattr(sys.modules["__main__"], "__file__", None) or ""
    if path == STDIN:
        return f"{STDIN} is no file that a process can load"
    source = "".join(linecache.getlines(path)) if path else ""
    guarded = not source or "__name__" in source
    return None if guarded else f'{os.path.basename(path)} lacks `if __name__ == "__main__":`'


def _end_with_parent(parent: int, over: Semaphore, begun: SimpleQueue[int]) -> None:
    """End this worker when the work is over, or when the process that started it has ended."""
    for number in ENDING:  # of a whole process group: the parent handles them
        signal.signal(number, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent and not over.acquire(timeout=1.0):
            pass
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    begun.put(os.getpid())
