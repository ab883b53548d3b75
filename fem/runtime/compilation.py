"""Compilation of kernels in this process: that a long one begins is told, and what all of it takes is counted.

numba compiles a function when it is first called, after an installation or where a kept one does not fit, and
broadcasts when it begins and ends; loading what is kept is no compilation. All times are of the wall clock [s].
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core import event

COMPILING = "numba:compile"
#: kernels that hold the whole stepping; all others take seconds at most
LONG = frozenset({"advance", "advance_in_slices"})


class CompilationClock(event.Listener):
    """Counts the time in which kernels are compiled, one within another counted once.

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
    """Tells once that a long compilation begins."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell, self._told = tell, False

    def on_start(self, event: event.Event) -> None:
        """A compilation begins."""
        if not self._told and kernel_name(event) in LONG:
            self._told = True
            self._tell("compiling the stepping kernels, once after installation: a minute or two")

    def on_end(self, event: event.Event) -> None:
        """Nothing to tell."""


def kernel_name(compilation: event.Event) -> str:
    """Of the function that is compiled."""
    return str(compilation.data["dispatcher"].py_func.__name__)


@contextmanager
def compilation_announced(tell: Callable[[str], None]) -> Iterator[None]:
    """Within it, a long compilation is told before it begins, once."""
    with event.install_listener(COMPILING, Announcer(tell)):
        yield


_CLOCK = CompilationClock()
event.register(COMPILING, _CLOCK)


def compilation_time() -> float:
    """Time in which this process has compiled kernels so far [s], a clock beside `time.process_time`."""
    return _CLOCK.reading()
