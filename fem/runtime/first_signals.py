"""Ctrl-C and SIGTERM before a command hears them: the imports of `python -m fem` take a good part of a second.

Until the command line is there nothing can be lost and nothing could catch an exception, so the process ends at
once; from then on both are a KeyboardInterrupt, until a command that has something to keep hears them itself. A signal
that is ignored (as in a job of a shell without job control) stays ignored.
"""

import os
import signal
from collections.abc import Callable
from types import FrameType
from typing import Any

INTERRUPTED = 4  #: the exit code
USUAL: dict[signal.Signals, Any] = {
    signal.SIGINT: signal.default_int_handler,
    signal.SIGTERM: signal.SIG_DFL,
}


def end_at_once() -> None:
    """From now on they end the process."""
    _hear(_end)


def raise_from_now_on() -> None:
    """From now on they are a KeyboardInterrupt."""
    _hear(_raise)


def _hear(handler: Callable[[int, FrameType | None], None]) -> None:
    for number, usual in USUAL.items():
        if signal.getsignal(number) in (usual, _end):
            signal.signal(number, handler)


def _end(number: int, frame: FrameType | None) -> None:
    os.write(2, b"interrupted\n")
    os._exit(INTERRUPTED)


def _raise(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
