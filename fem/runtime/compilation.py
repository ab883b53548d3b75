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


class Compilations(event.Listener):
    """Counts the time spent compiling, nested compilations once, and announces the first long one where it is to.

    numba compiles under a lock, one thread at a time, so that the events do not mix.
    """

    def __init__(self) -> None:
        self._depth, self._began = 0, 0.0
        self.past = 0.0  #: time spent in compilations that have ended [s]
        self.message: Callable[[str], None] | None = None  #: where to announce the first long one

    def on_start(self, event: event.Event) -> None:
        """A compilation begins."""
        if self._depth == 0:
            self._began = time.perf_counter()
        self._depth += 1
        if self.message is None or event.data["dispatcher"].py_func.__name__ not in LONG:
            return
        message, self.message = self.message, None
        if SHIPPED.is_dir():
            message(f"the machine code of this package is not for {FITTING}, or not of this kernel")
        message(
            f"compiling the stepping kernels with numba {numba.__version__}'s own passes, once after "
            "installation: the results are the same, but it takes a minute or more"
            if PLAIN
            else "compiling the stepping kernels, once after installation: a quarter of a minute or more"
        )

    def on_end(self, event: event.Event) -> None:
        """It has ended, or failed."""
        self._depth -= 1
        if self._depth == 0:
            self.past += time.perf_counter() - self._began


_ALL = Compilations()
event.register(COMPILING, _ALL)
_ANNOUNCING = threading.Lock()


@contextmanager
def compilation_announced(message: Callable[[str], None]) -> Iterator[None]:
    """Announce the first long compilation in the block before it begins; inside another such block, that one does."""
    if not _ANNOUNCING.acquire(blocking=False):
        yield
        return
    try:
        _ALL.message = message
        yield
    finally:
        _ALL.message = None
        _ANNOUNCING.release()


def compilation_time() -> float:
    """Time in which this process has compiled kernels so far [s], a clock beside `time.process_time`."""
    return _ALL.past
