"""Ctrl-C and SIGTERM in the first moments of the process."""

import os
import signal
import subprocess
import sys
import time

import pytest

from fem.runtime.progress import Reporter
from fem.runtime.signals import interruptible, stop_requested


def outcome(argument: str, script: str) -> tuple[int, str]:
    # A suite started in the background inherits an ignored SIGINT, which would stay ignored here.
    default = "signal.signal(signal.SIGINT, signal.default_int_handler)"
    program = f"import os, signal, sys\n{default}\nsys.argv[0] = {argument!r}\nimport fem\n{script}"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.slow), signal.SIGTERM])
def test_while_the_command_line_is_imported_a_signal_ends_the_process_in_a_line(number):
    # "-m" is what Python itself writes there while it looks for the module to run.
    assert outcome("-m", f"os.kill(os.getpid(), {int(number)})") == (4, "interrupted\n")


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_in_a_command_that_keeps_nothing_a_signal_is_told_in_a_line(number):
    script = f"""
from fem import __main__ as command_line
command_line.build_app = lambda: lambda *_, **__: os.kill(os.getpid(), {int(number)})
command_line.program()
"""
    assert outcome("-m", script) == (4, "interrupted\n")


def test_a_signal_within_a_callback_from_c_is_not_lost():
    # ctypes drops what a callback raises; the compiler of the kernels calls back whenever it has made one.
    script = """
import ctypes, time
from fem import __main__ as command_line
callback = ctypes.CFUNCTYPE(None)(lambda: os.kill(os.getpid(), signal.SIGINT))
def compute(*_, **__):
    callback()
    for _ in range(500):
        time.sleep(0.01)
command_line.build_app = lambda: compute
command_line.program()
"""
    assert outcome("-m", script) == (4, "interrupted\n")


def test_a_library_leaves_signals_alone():
    script = (
        "assert signal.getsignal(signal.SIGINT) is signal.default_int_handler\n"
        "assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL"
    )
    assert outcome("a script", script) == (0, "")


def test_a_signal_that_is_ignored_stays_ignored():
    script = "signal.signal(signal.SIGINT, signal.SIG_IGN); fem.exit_on_signal(); os.kill(os.getpid(), signal.SIGINT)"
    assert outcome("a script", script) == (0, "")


class Telling(Reporter):
    """Keeps what it is told."""

    def __init__(self):
        self.told = []

    def message(self, text):
        self.told.append(text)

    warning = message


def test_ctrl_c_pressed_twice_in_a_hurry_is_one_request_to_stop():
    reporter = Telling()
    with interruptible(reporter) as stop:
        for _ in range(3):
            os.kill(os.getpid(), signal.SIGINT)
        assert stop()
    assert reporter.told == ["stopping after the current step; press Ctrl-C again to quit now"]


def test_the_first_signal_requests_a_stop_and_a_second_ctrl_c_insists(monkeypatch):
    monkeypatch.setattr("fem.runtime.signals.SAME_PRESS_S", 0.0)
    reporter, before = Telling(), signal.getsignal(signal.SIGINT)
    for number in (signal.SIGTERM, signal.SIGINT):
        with interruptible(reporter) as stop:
            assert not stop()
            assert not stop_requested()
            os.kill(os.getpid(), number)
            assert stop()
            assert stop_requested()
            with pytest.raises(KeyboardInterrupt):
                os.kill(os.getpid(), signal.SIGINT)
                signal.sigtimedwait([], 1.0)
            assert reporter.told.pop().startswith("quitting now")
    assert not stop_requested()
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.slow), signal.SIGTERM])
def test_a_process_that_c_code_holds_ends_all_the_same(number):
    # As the compiler of the kernels does for many seconds, this does not let Python see the signal.
    script = f"""
import hashlib, threading, time
from fem import __main__ as command_line
def compute(*_, **__):
    threading.Timer(0.2, os.kill, (os.getpid(), {int(number)})).start()
    hashlib.pbkdf2_hmac("sha256", b"", b"", 100_000_000)
command_line.build_app = lambda: compute
command_line.program()
"""
    begin = time.monotonic()
    assert outcome("-m", script) == (4, "interrupted\n")
    assert time.monotonic() - begin < 12.0  # the work takes 20 s or more


@pytest.mark.slow
def test_a_signal_that_was_heard_ends_nothing_later():
    script = """
import time
from fem.runtime import signals
from fem.runtime.progress import Reporter
signals.UNHEARD_S = 0.2
signals.raise_on_signal()
with signals.interruptible(Reporter()):
    os.kill(os.getpid(), signal.SIGTERM)
time.sleep(0.6)
try:
    os.kill(os.getpid(), signal.SIGTERM)
except KeyboardInterrupt:
    time.sleep(0.6)
print("whole", file=sys.stderr)
"""
    assert outcome("-c", script) == (0, "whole\n")
