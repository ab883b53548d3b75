"""What Ctrl-C and SIGTERM do: end at once where nothing can be lost, and at a clean place where something can."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from fem.runtime.progress import Reporter

NUMBERS = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def interruptible(reporter: Reporter) -> Iterator[Callable[[], bool]]:
    """Turn the first Ctrl-C or SIGTERM into a request to stop at a clean place; a second Ctrl-C insists."""
    asked: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        if asked and number == signal.SIGINT:
            raise KeyboardInterrupt
        asked.append(number)
        reporter.message("stopping at the next clean place; once more stops at once")

    with _heard_by(note):
        yield lambda: bool(asked)


@contextmanager
def ending_at_once() -> Iterator[None]:
    """Turn any Ctrl-C or SIGTERM into a KeyboardInterrupt: for a time in which nothing is computed that is not kept."""

    def end(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    with _heard_by(end):
        yield


@contextmanager
def _heard_by(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    before = {}
    for number in NUMBERS:
        try:
            before[number] = signal.signal(number, handler)
        except ValueError:  # not the main thread: whoever called has other means
            break
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)
