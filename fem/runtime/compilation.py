"""Compilation of kernels in this process: a long one is announced, and the time of all is counted.

numba compiles a function when it is first called and no cached machine code fits, and broadcasts when it begins and
ends. Loading cached code is not compilation. All times are wall-clock times [s].
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numba
from numba.core import event

from contact.compiler import PLAIN
from contact.jit import FITTING, SHIPPED

COMPILING = "numba:compile"
#: kernels that hold the whole stepping; all others take seconds at most
LONG = frozenset({"advance", "advance_in_slices"})


class CompilationClock(event.Listener):
    """Counts the time spent compiling; nested compilations are counted once.

    numba compiles under a lock, one thread at a time, so that the events do not mix.
    """

    def __init__(self) -> None:
        self._depth, self._began, self._past = 0, 0.0, 0.0

    def on_start(self, event: event.Event) -> None:
        """A compilation begins."""
        if self._depth == 0:
            self._began = time.perf_counter()
        self._depth += 1

    def on_end(self, event: event.Event) -> None:
        """It has ended, or failed."""
        self._depth -= 1
        if self._depth == 0:
            self._past += time.perf_counter() - self._began

    def reading(self) -> float:
        """Time spent so far in compilations that have ended [s]."""
        return self._past


class Announcer(event.Listener):
    """Announces the first long compilation."""

    def __init__(self, message: Callable[[str], None]) -> None:
        self._message, self._announced = message, False

    def on_start(self, event: event.Event) -> None:
        """A compilation begins."""
        if not self._announced and kernel_name(event) in LONG:
            self._announced = True
            if SHIPPED.is_dir():
                self._message(f"the machine code of this package is not for {FITTING}, or not of this kernel")
            self._message(
                f"compiling the stepping kernels with numba {numba.__version__}'s own passes, once after "
                "installation: the results are the same, but it takes a minute or more"
                if PLAIN
                else "compiling the stepping kernels, once after installation: a quarter of a minute or more"
            )

    def on_end(self, event: event.Event) -> None:
        """Nothing to announce."""


def kernel_name(compilation: event.Event) -> str:
    """Name of the function that is compiled."""
    return str(compilation.data["dispatcher"].py_func.__name__)


_ANNOUNCING = threading.Lock()


@contextmanager
def compilation_announced(message: Callable[[str], None]) -> Iterator[None]:
    """Announce the first long compilation in the block before it begins; inside another such block, that one does."""
    if not _ANNOUNCING.acquire(blocking=False):
        yield
        return
    try:
        with event.install_listener(COMPILING, Announcer(message)):
            yield
    finally:
        _ANNOUNCING.release()


_CLOCK = CompilationClock()
event.register(COMPILING, _CLOCK)


def compilation_time() -> float:
    """Time in which this process has compiled kernels so far [s], a clock beside `time.process_time`."""
    return _CLOCK.reading()
