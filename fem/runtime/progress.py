"""Progress of long work: one line with time, rate, remaining time, rotation ratio and mode.

On a terminal the line is rewritten in place; elsewhere a plain line is printed every few seconds. Both go to the error
stream, so that the standard output holds results alone. A quiet reporter prints warnings alone.
"""

import os
import sys
import time as clock
from collections.abc import Callable

from rich.console import Console
from rich.progress import Progress, TextColumn
from rich.text import Text

from fem.runtime.terminal import shown

REDRAW_S = 0.1  #: between redraws of the line on a terminal
PLAIN_S = 5.0  #: between plain lines


class Reporter:
    """Where a long computation reports to; this one prints nothing. All times are simulated seconds."""

    def start(self, duration: float, begun: float = 0.0) -> None:
        """Work starts at `begun` [s], later than 0 in a resumed run, and will end at `duration` [s]."""

    def update(self, time: float, ratio: float, mode: str) -> None:
        """Work has reached `time` [s]; cheap enough to be called at every sample."""

    def tell(self, line: Callable[[], str]) -> None:
        """Progress of work that is not one run; `line` is called only when a new line is due."""

    def message(self, text: str) -> None:
        """A sentence for the user."""

    def warning(self, text: str) -> None:
        """A sentence that the user must see, also when quiet: work was lost."""

    def finish(self) -> None:
        """Work has ended, with or without success; may be called twice."""


class ErrorStream(Console):
    """The error stream; work goes on unseen when its reader has left, as behind `2>&1 | head -n 1`."""

    def on_broken_pipe(self) -> None:
        """Write nowhere from now on."""
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())


class ScreenReporter(Reporter):
    """Reports to a person: in place on a terminal, by plain lines elsewhere.

    Args:
        console: the destination; the error stream by default.
        quiet: no progress and no messages, but warnings; errors do not pass through a reporter.
        now: a monotonic clock [s].
    """

    def __init__(
        self,
        *,
        console: Console | None = None,
        quiet: bool = False,
        now: Callable[[], float] = clock.monotonic,
    ) -> None:
        self._console = console or ErrorStream(file=sys.stderr, highlight=False)
        self._quiet, self._now, self._due = quiet, now, 0.0
        self._pause = REDRAW_S if self._console.is_terminal else PLAIN_S
        self._bar = self._new_bar()
        self._task = self._bar.add_task("")

    def start(self, duration: float, begun: float = 0.0) -> None:
        if self._quiet:
            return
        self.finish()
        self._bar = self._new_bar()
        self._task = self._bar.add_task("", total=duration)
        self._bar.update(self._task, completed=begun)
        self._bar.advance(self._task, 0.0)  # the first sample of the rate
        if self._console.is_terminal:
            self._bar.start()
        self._due = self._now() + self._pause

    def update(self, time: float, ratio: float, mode: str) -> None:
        def line() -> str:
            self._bar.update(self._task, completed=time)
            task = self._bar.tasks[-1]
            rate, duration, left = task.speed or 0.0, task.total or 0.0, "time left unknown"
            if time >= duration:
                left = "until it falls or comes back"
            elif rate > 0.0:
                left = f"{clock_time((duration - time) / rate)} left"
            return f"t = {time:.3f} of {duration:g} s, {rate:.3g} s per s, {left}, rotation ratio {ratio:.3f}, {mode}"

        self.tell(line)

    def tell(self, line: Callable[[], str]) -> None:
        if self._quiet or self._now() < self._due:
            return
        self._due = self._now() + self._pause
        if self._bar.live.is_started:
            self._bar.update(self._task, description=shown(line()), refresh=True)
        else:
            self._console.print(Text(shown(line())), soft_wrap=True)

    def message(self, text: str) -> None:
        if not self._quiet:
            self.warning(text)

    def warning(self, text: str) -> None:
        self._console.print(Text(shown(text)), soft_wrap=True)

    def finish(self) -> None:
        if self._bar.live.is_started:
            self._bar.stop()

    def _new_bar(self) -> Progress:
        column = TextColumn("{task.description}", markup=False)
        return Progress(column, console=self._console, auto_refresh=False, transient=True, get_time=self._now)


def watched() -> bool:
    """Whether somebody reads the error stream while the work is done: on a terminal, or in a notebook."""
    return sys.stderr.isatty() or Console().is_jupyter


def clock_time(seconds: float) -> str:
    """A duration for people: 7 s, 3 min 20 s, 2 h 05 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{max(whole, 1)} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
