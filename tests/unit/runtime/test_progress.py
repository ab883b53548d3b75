"""Progress: one line, as seldom as it may be, in the right place."""

import io

import pytest
from rich.console import Console

from fem.runtime.progress import PLAIN_S, REDRAW_S, Reporter, ScreenReporter, clock_time


class Clock:
    def __init__(self):
        self.time = 100.0

    def __call__(self):
        return self.time


def reporter(*, terminal=False, quiet=False, width=120):
    stream, clock = io.StringIO(), Clock()
    console = Console(file=stream, force_terminal=terminal, width=width, color_system=None)
    screen: Reporter = ScreenReporter(console=console, quiet=quiet, now=clock)
    return screen, stream, clock


def line_after(seconds, time, *, duration=20.0, begun=0.0, rotation_ratio=0.3987):
    """The plain line of a run that reaches `time` after so many seconds of wall time."""
    screen, stream, clock = reporter()
    screen.start(duration, begun)
    clock.time += seconds
    screen.update(time, rotation_ratio, "rock")
    return stream.getvalue().strip()


def test_line_shows_time_rate_remaining_time_rotation_ratio_and_mode():
    assert line_after(10.0, 5.0) == ("t = 5.000 of 20 s, 0.5 s per s, 30 s left, rotation ratio 0.399, rock")


def test_what_was_computed_before_a_resumed_run_is_no_part_of_its_rate():
    assert "0.1 s per s, 2 min 20 s left" in line_after(10.0, 6.0, begun=5.0)


def test_nothing_is_invented_at_the_start_and_after_the_end():
    assert "time left unknown" in line_after(10.0, 0.0)
    assert "until it falls or comes back" in line_after(10.0, 21.0)


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.2, "1 s"), (59.4, "59 s"), (200.0, "3 min 20 s"), (7500.0, "2 h 05 min")]
)
def test_durations_are_given_in_seconds_minutes_and_hours(seconds, words):
    assert clock_time(seconds) == words


def test_plain_lines_come_every_few_seconds_and_are_not_wrapped():
    screen, stream, clock = reporter(width=20)
    screen.start(20.0)
    for i in range(1, 101):
        clock.time = 100.0 + 0.17 * i  # 17 s in all
        screen.update(0.2 * i, 0.1, "rock")
    screen.message("a message that is longer than twenty characters")
    screen.finish()
    lines = stream.getvalue().splitlines()
    assert len(lines) == int(17.0 / PLAIN_S) + 1
    assert all(line.startswith("t = ") and line.endswith("rock") for line in lines[:-1])
    assert "\x1b" not in stream.getvalue() and "\r" not in stream.getvalue()


def test_terminal_line_is_rewritten_in_place_and_gone_at_the_end():
    screen, stream, clock = reporter(terminal=True)
    screen.start(20.0)
    for i in range(1, 11):
        clock.time += REDRAW_S * 1.01
        screen.update(float(i), 0.1, "rock")
    screen.finish()
    screen.finish()
    text = stream.getvalue()
    assert text.count("t = ") >= 10 and "t = 10.000 of 20 s" in text
    assert text.count("\n") <= 2  # no scrolling
    assert "\x1b[2K" in text  # the line is erased
    assert text.rindex("\x1b[?25h") > text.rindex("\x1b[?25l")  # the cursor is shown again


@pytest.mark.parametrize("terminal", [False, True])
def test_messages_and_lines_are_printed_as_they_are(terminal):
    screen, stream, clock = reporter(terminal=terminal)
    screen.start(20.0)
    clock.time += 10.0
    screen.tell(lambda: "3 of 9 [bold]rows[/bold]")
    screen.message("compiling [red]kernels[/red]: once")
    screen.finish()
    assert "compiling [red]kernels[/red]: once" in stream.getvalue()
    assert "3 of 9 [bold]rows[/bold]" in stream.getvalue()
