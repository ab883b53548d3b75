"""Progress: one line, as seldom as it may be, in the right place."""

import io

import pytest
from rich.console import Console

from fem.runtime.progress import PLAIN_S, REDRAW_S, Reporter, ScreenReporter, SilentReporter, progress_line


class Clock:
    def __init__(self):
        self.time = 100.0

    def __call__(self):
        return self.time


def reporter(*, terminal=False, quiet=False):
    stream, clock = io.StringIO(), Clock()
    console = Console(file=stream, force_terminal=terminal, width=120, color_system=None)
    screen: Reporter = ScreenReporter(console=console, quiet=quiet, now=clock)
    return screen, stream, clock


def test_line_tells_time_rate_remaining_time_rotation_ratio_and_mode():
    line = progress_line(5.0, 20.0, 2.5, 0.3987, "rock")
    assert line == "t = 5.000 of 20 s, 2 s per s, 8 s left, rotation ratio 0.399, rock"


@pytest.mark.parametrize(
    ("remaining", "words"),
    [(0.2, "1 s left"), (59.4, "59 s left"), (200.0, "3 min 20 s left"), (7500.0, "2 h 05 min left")],
)
def test_remaining_time_is_told_for_people(remaining, words):
    assert words in progress_line(1.0, 1.0 + remaining, 1.0, 0.0, "rest")


def test_nothing_is_invented_at_the_start_and_after_the_end():
    assert "time left unknown" in progress_line(0.0, 20.0, 1.0, 0.0, "rest")
    assert "time left unknown" in progress_line(0.0, 20.0, 0.0, 0.0, "rest")
    assert "until it falls or comes back" in progress_line(21.0, 20.0, 1.0, 1.2, "rock")


def test_plain_lines_come_every_few_seconds():
    screen, stream, clock = reporter()
    screen.start(20.0)
    for i in range(1, 101):
        clock.time = 100.0 + 0.17 * i  # 17 s in all
        screen.update(0.2 * i, 0.1, "rock")
    screen.finish()
    lines = stream.getvalue().splitlines()
    assert len(lines) == int(17.0 / PLAIN_S)
    assert all(line.startswith("t = ") and line.endswith("rock") for line in lines)
    assert "\x1b" not in stream.getvalue() and "\r" not in stream.getvalue()


def test_long_plain_lines_are_not_wrapped():
    screen, stream, clock = reporter()
    screen._console.width = 20
    screen.start(20.0)
    clock.time += 10.0
    screen.update(1.0, 0.1, "slide-rock")
    screen.message("a message that is longer than twenty characters")
    assert len(stream.getvalue().splitlines()) == 2


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


def test_terminal_is_not_redrawn_at_every_sample():
    screen, stream, clock = reporter(terminal=True)
    screen.start(20.0)
    for i in range(1000):
        clock.time += REDRAW_S / 100.0
        screen.update(0.01 * i, 0.1, "rock")
    screen.finish()
    assert 8 <= stream.getvalue().count("t = ") <= 22


def test_cursor_comes_back_after_the_line():
    screen, stream, _ = reporter(terminal=True)
    screen.start(20.0)
    screen.finish()
    text = stream.getvalue()
    assert text.rindex("\x1b[?25h") > text.rindex("\x1b[?25l")  # shown again after it was hidden


def test_messages_are_printed_as_they_are():
    for terminal in (False, True):
        screen, stream, _ = reporter(terminal=terminal)
        screen.start(20.0)
        screen.message("compiling [red]kernels[/red]: once")
        screen.finish()
        assert "compiling [red]kernels[/red]: once" in stream.getvalue()


def test_quiet_and_silent_reporters_say_nothing():
    screen, stream, clock = reporter(terminal=True, quiet=True)
    for each in (screen, SilentReporter()):
        each.start(20.0)
        clock.time += 100.0
        each.update(1.0, 0.1, "rock")
        each.message("hello")
        each.finish()
    assert stream.getvalue() == ""


def test_default_goes_to_the_error_stream(capsys):
    ScreenReporter().message("hello")
    captured = capsys.readouterr()
    assert captured.out == "" and "hello" in captured.err
