"""What Ctrl-C and SIGTERM do, from the first import of `python -m fem` to the end of a run.

While the command line is imported (a good part of a second) nothing can be lost and nothing could catch an exception:
the process ends. Then both signals raise KeyboardInterrupt. A command with results to save requests a stop at the next
safe point. A signal that is ignored, as in a background job of a shell without job control, stays ignored.
This module is imported first and loads no other of this program.
"""

import _thread
import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from types import FrameType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem.runtime.progress import Reporter

INTERRUPTED = 4  #: the exit code
#: what `--json` prints of a command that was interrupted before it could say more
NO_ANSWER = '{"state": "interrupted", "answer": null}\n'
SAME_PRESS_S = 1.0  #: within which a further Ctrl-C belongs to the one before [s]
UNHEARD_S = 2.0  #: after which a signal ends the process that no Python code has seen [s]
AGAIN_S = 0.05  #: after which a lost signal is sent again [s]
_raised: list[int] = []
_heard = [-math.inf]  #: when Python has seen signals [s]
_requests: list[list[int]] = []  #: signals received by each `interruptible` under way
DEFAULTS: dict[signal.Signals, Any] = {
    signal.SIGINT: signal.default_int_handler,
    signal.SIGTERM: signal.SIG_DFL,
}
Handler = Callable[[int, FrameType | None], None]


def exit_on_signal() -> None:
    """From now on both signals end the process."""
    _replace_defaults(_exit)


def raise_on_signal(*, watched: bool = True) -> None:
    """From now on both signals raise KeyboardInterrupt, or end a process that C code holds, where they are watched."""
    _replace_defaults(_raise)
    sys.unraisablehook = _raise_again
    if not watched:
        return
    with suppress(AttributeError, ValueError):  # Windows, or not the main thread
        reader, writer = os.pipe()
        os.set_blocking(writer, False)
        signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
        threading.Thread(target=_end_where_unheard, args=(reader,), daemon=True).start()


@contextmanager
def interruptible(reporter: "Reporter") -> Iterator[Callable[[], bool]]:
    """Turn the first signal into a request to stop at the next safe point; a later Ctrl-C raises KeyboardInterrupt.

    Whoever presses the keys twice in a hurry wants the stop, and what was found: that is one request.

    Yields:
        Whether a stop is requested: of this work, or of that which it is a part of.
    """
    received: list[int] = []
    last = -math.inf

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal last
        before, last = last, time.monotonic()
        _heard.append(last)
        if received and number == signal.SIGINT:
            if last - before < SAME_PRESS_S:
                return
            reporter.warning("quitting now, in the middle of a step; what is in the files is kept")
            raise KeyboardInterrupt
        received.append(number)
        reporter.message("stopping after the current step; press Ctrl-C again to quit now")

    _requests.append(received)
    try:
        with _handled_by(note):
            yield stop_requested
    finally:
        _requests.remove(received)


def stop_requested() -> bool:
    """Whether a signal has asked this process to stop; for work that is handed to other processes as well."""
    return any(_requests)


def ending_at_once() -> AbstractContextManager[None]:
    """Let both signals raise KeyboardInterrupt: for work that has nothing to save."""
    return _handled_by(_raise)


def unheard() -> AbstractContextManager[None]:
    """Let neither signal cut off what is printed of finished work."""
    return _handled_by(lambda number, frame: _heard.append(time.monotonic()))


@contextmanager
def _handled_by(handler: Handler) -> Iterator[None]:
    earlier = {}
    for number in DEFAULTS:
        try:
            earlier[number] = signal.signal(number, handler)
        except ValueError:  # not the main thread: the caller has its own means
            break
    try:
        yield
    finally:
        for number, before in earlier.items():
            signal.signal(number, before)


def _replace_defaults(handler: Handler) -> None:
    for number, default in DEFAULTS.items():
        if signal.getsignal(number) in (default, _exit):
            signal.signal(number, handler)


def _exit(number: int, frame: FrameType | None) -> None:
    if "--json" in sys.argv:
        os.write(1, NO_ANSWER.encode())
    os.write(2, b"interrupted\n")
    os._exit(INTERRUPTED)


def _end_where_unheard(reader: int) -> None:
    """End the process where the compiler, for one, holds the main thread when a signal comes that has nothing to save.

    The operating system writes the number of each signal into a pipe.
    """
    while number := os.read(reader, 1):
        since = time.monotonic() - 0.5 * UNHEARD_S  # Python may have seen it before this thread did
        time.sleep(UNHEARD_S)
        if _heard[-1] < since and number[0] in DEFAULTS and signal.getsignal(number[0]) is _raise:
            _exit(number[0], None)


def interruptions() -> int:
    """How often a signal has raised KeyboardInterrupt, of which a module in C makes other errors while it is loaded."""
    return len(_raised)


def _raise(number: int, frame: FrameType | None) -> None:
    _heard.append(time.monotonic())
    _raised.append(number)
    raise KeyboardInterrupt


def _raise_again(unraisable: "sys.UnraisableHookArgs") -> None:
    """Send a signal again whose KeyboardInterrupt was lost: ctypes drops what callbacks of the compiler raise."""
    if issubclass(unraisable.exc_type, KeyboardInterrupt):
        again = threading.Timer(AGAIN_S, _thread.interrupt_main)
        again.daemon = True
        again.start()
    else:
        sys.__unraisablehook__(unraisable)
