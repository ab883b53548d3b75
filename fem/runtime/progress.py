"""Progress of long work: one line with time, rate, remaining time, rotation ratio and mode.

On a terminal the line is rewritten in place; elsewhere a plain line comes every few seconds; a quiet reporter
says nothing (errors do not come this way). Reporting goes to the error stream, so that the standard output
holds results alone.
"""

import sys
import time as clock
from collections.abc import Callable
from typing import Protocol

from rich.console import Console
from rich.live import Live
from rich.text import Text

REDRAW_S = 0.1  #: between rewritings of the line on a terminal
PLAIN_S = 5.0  #: between plain lines


class Reporter(Protocol):
    """What a long computation tells of itself. All times are simulated seconds."""

    def start(self, duration: float, begun: float = 0.0) -> None:
        """The work begins at `begun` [s], where it was cut off before; it will go to `duration` [s]."""

    def update(self, time: float, rotation_ratio: float, mode: str) -> None:
        """It has come to `time` [s]; cheap enough to be called at every sample."""

    def tell(self, line: Callable[[], str]) -> None:
        """How far work has come that is not one run; `line` is asked when it is time to say so again."""

    def message(self, text: str) -> None:
        """A sentence for the user, once."""

    def warning(self, text: str) -> None:
        """A sentence that the user must see, also without progress: work that was lost."""

    def finish(self) -> None:
        """The work has ended, in whatever way; may be called twice."""


class SilentReporter:
    """Says nothing: for sweeps, tests and library use."""

    def start(self, duration: float, begun: float = 0.0) -> None:
        """Nothing."""

    def update(self, time: float, rotation_ratio: float, mode: str) -> None:
        """Nothing."""

    def tell(self, line: Callable[[], str]) -> None:
        """Nothing."""

    def message(self, text: str) -> None:
        """Nothing."""

    def warning(self, text: str) -> None:
        """Nothing."""

    def finish(self) -> None:
        """Nothing."""


class ScreenReporter:
    """Reports to a person: in place on a terminal, by plain lines elsewhere.

    Args:
        console: where to; the error stream by default.
        quiet: no progress and no messages, but warnings; errors are not its matter.
        now: a clock that does not go back [s].
    """

    def __init__(
        self,
        *,
        console: Console | None = None,
        quiet: bool = False,
        now: Callable[[], float] = clock.monotonic,
    ) -> None:
        self._console = console or Console(file=sys.stderr, highlight=False)
        self._quiet = quiet
        self._now = now
        self._live: Live | None = None
        self._duration = self._begun = 0.0
        self._began = self._due = 0.0

    def start(self, duration: float, begun: float = 0.0) -> None:
        """The work begins at `begun` [s], where it was cut off before; it will go to `duration` [s]."""
        if self._quiet:
            return
        self.finish()
        self._duration, self._begun, self._began = duration, begun, self._now()
        if self._console.is_terminal:
            self._live = Live(console=self._console, auto_refresh=False, transient=True)
            self._live.start()
        self._due = self._began + self._pause

    def update(self, time: float, rotation_ratio: float, mode: str) -> None:
        """Show the line, if the last one is old enough."""
        elapsed = self._now() - self._began
        begun = self._begun
        self.tell(lambda: progress_line(time, self._duration, elapsed, rotation_ratio, mode, begun=begun))

    def tell(self, line: Callable[[], str]) -> None:
        """Show a line, if the last one is old enough."""
        if self._quiet:
            return
        now = self._now()
        if now < self._due:
            return
        self._due = now + self._pause
        if self._live is not None:
            self._live.update(Text(line(), no_wrap=True, overflow="ellipsis"), refresh=True)
        else:
            self._console.print(Text(line()), soft_wrap=True)

    def message(self, text: str) -> None:
        """Print a sentence; a line in place moves down and stays."""
        if not self._quiet:
            self.warning(text)

    def warning(self, text: str) -> None:
        """Print a sentence, quiet or not."""
        self._console.print(Text(text), soft_wrap=True)

    def finish(self) -> None:
        """Take the line away."""
        if self._live is not None:
            self._live.stop()
            self._live = None

    @property
    def _pause(self) -> float:
        return REDRAW_S if self._live is not None else PLAIN_S


def progress_line(
    time: float, duration: float, elapsed: float, rotation_ratio: float, mode: str, *, begun: float = 0.0
) -> str:
    """The line itself.

    Args:
        time: simulated so far [s].
        duration: to be simulated [s]; beyond it the run goes on until the container has fallen or come back.
        elapsed: wall time so far [s].
        rotation_ratio: |rotation| over the slenderness angle [-].
        mode: state of motion.
        begun: simulated before [s].
    """
    rate = (time - begun) / elapsed if elapsed > 0.0 else 0.0
    if time >= duration:
        remaining = "until it falls or comes back"
    elif rate > 0.0:
        remaining = f"{clock_time((duration - time) / rate)} left"
    else:
        remaining = "time left unknown"
    return (
        f"t = {time:.3f} of {duration:g} s, {rate:.3g} s per s, {remaining}, "
        f"rotation ratio {rotation_ratio:.3f}, {mode}"
    )


def clock_time(seconds: float) -> str:
    """A duration for people: 7 s, 3 min 20 s, 2 h 05 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{max(whole, 1)} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
