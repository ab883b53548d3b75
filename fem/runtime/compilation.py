"""Compilation of kernels in this process: long ones are announced, and the time of all is counted.

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
#: what they step, by the class of the body
BODIES = {"ModalBody": "an elastic container", "BlockOnCorners": "a rigid one", "LooseStack": "loose boxes"}
OPTIMISING = 0.7  #: time that LLVM takes for a whole kernel, over that of numba for its functions


class Compilations(event.Listener):
    """Counts the time spent compiling, nested compilations once, and announces long ones and what is left of them.

    numba compiles under a lock, one thread at a time, so that the events do not mix.
    """

    def __init__(self) -> None:
        self._depth, self._functions, self._began = 0, 0, 0.0
        self.past = 0.0  #: time spent in compilations that have ended [s]
        self.message: Callable[[str], None] | None = None  #: where to announce long ones

    def on_start(self, event: event.Event) -> None:
        self._depth += 1
        if self._depth > 1:
            return
        self._began, self._functions = time.perf_counter(), 0
        if self.message is None or event.data["dispatcher"].py_func.__name__ not in LONG:
            return
        if SHIPPED.is_dir():
            self.message(f"the machine code of this package is not for {FITTING}, or not of this kernel")
        kind = getattr(event.data["args"][0], "instance_class", None)
        body = BODIES.get(getattr(kind, "__name__", ""), "this model")
        own = f"a minute or more with numba {numba.__version__}'s own passes, for the same results"
        time_left = own if PLAIN else "half a minute or more"
        self.message(f"compiling the stepping of {body}, step 1 of 2, once after installation: {time_left}")

    def on_end(self, event: event.Event) -> None:
        self._depth, self._functions = self._depth - 1, self._functions + 1
        took = time.perf_counter() - self._began
        if self._depth == 0:
            self.past += took
        elif self._depth == 1 and self.message and "advance" in event.data["dispatcher"].py_func.__name__:
            left = f"{self._functions} functions translated, {OPTIMISING * took:.0f} s left"
            self.message(f"compiling the stepping, step 2 of 2: {left}")


_ALL = Compilations()
event.register(COMPILING, _ALL)
_ANNOUNCING = threading.Lock()


@contextmanager
def compilation_announced(message: Callable[[str], None]) -> Iterator[None]:
    """Announce long compilations in the block before they begin; inside another such block, that one does."""
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
