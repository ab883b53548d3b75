"""A run that is interrupted from outside, as a process of its own: Ctrl-C, SIGTERM."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fem.results.history import read_history
from fem.results.kinds import read_result

LONG = (
    "solver.model=full",
    "solver.duration_s=600",
    "solver.element_size_m=0.5",
    "output.history_s=0.001",
    "output.figures=false",
)


@pytest.fixture
def running(tmp_path):
    """A long run that has begun to write its history; ended in any case afterwards."""
    folder = tmp_path / "r"
    changes = [word for override in LONG for word in ("--set", override)]
    process = subprocess.Popen(
        [sys.executable, "-m", "fem", "run", "free_rocking", "--out", str(folder), *changes],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )
    try:
        await_history(process, folder)
        yield process, folder
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
        process.stderr.close()


def await_history(process: subprocess.Popen, folder: Path) -> None:
    """Wait until twenty samples have been written; a first run may have to compile."""
    history = folder / "history.csv"
    end = time.monotonic() + 300.0
    while time.monotonic() < end:
        if history.exists() and history.read_bytes().count(b"\n") > 20:
            return
        if process.poll() is not None:
            raise AssertionError(f"the run ended by itself: {process.stderr.read()}")
        time.sleep(0.05)
    raise AssertionError("the run wrote no history")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_request_to_stop_keeps_what_was_computed(running, number):
    process, folder = running
    process.send_signal(number)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 4
    assert "Traceback" not in err
    assert "Not finished (interrupted)" in out
    result = read_result(folder / "run.json")
    assert result["status"] == "interrupted"
    assert result["numerics"]["steps"] > 0
    assert result["verdict"]["band"] is None
    history = read_history(folder / "history.csv")
    assert len(history) >= 20
    assert (folder / "history.csv").read_bytes().endswith(b"\n")
    assert history["time_s"].tolist() == pytest.approx([0.001 * k for k in range(len(history))])
    assert (folder / "summary.txt").is_file()
    assert (folder / "fields" / "run.pvd").is_file()
