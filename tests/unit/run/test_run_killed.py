"""A run that is killed at any moments gives the same bits as an undisturbed one."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from interrupted_runs import COARSE, FLAT_SHELL, require_readable, require_same, run_command

#: the command line, with a checkpoint after every slice
PROMPT = """
import sys
import fem.run.output, fem.run.simulation
fem.run.output.CHECKPOINT_S = 0.0
fem.run.simulation.SLICE_REDUCED = fem.run.simulation.SLICE_FULL = 0.01
from fem.__main__ import main
sys.exit(main(sys.argv[1:]))
"""
FLAT = ("solver.duration_s=0.6", "output.fields_s=0.005", *FLAT_SHELL)
FULL = (*COARSE, "solver.duration_s=0.3", "output.fields_s=0.005")
COMMON = ("output.figures=false", "output.fields_s=0.01")


def start(folder: Path, *overrides: str) -> subprocess.Popen:
    command = run_command("seed_stack_plateau", folder, *COMMON, *overrides)
    return subprocess.Popen(
        [sys.executable, "-c", PROMPT, *command, "--resume", "--no-band"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )


def frames_in(folder: Path) -> int:
    return len(list(folder.glob("fields/frame_*.vtu")))


def end_when(process: subprocess.Popen, folder: Path, frames: int, delay: float, number: int) -> int:
    """Send a signal when so many frames are there, a little later; returns the exit code."""
    end = time.monotonic() + 300.0
    while frames_in(folder) < frames and process.poll() is None and time.monotonic() < end:
        time.sleep(0.002)
    time.sleep(delay)
    process.send_signal(number)
    process.wait(timeout=120)
    return process.returncode


@pytest.mark.slow
@pytest.mark.parametrize(("overrides", "seed"), [(FLAT, 2), (FULL, 3)], ids=["reduced, flat base", "full"])
def test_a_run_killed_ten_times_comes_to_the_same_bits(tmp_path, overrides, seed):
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    process = start(whole, *overrides)
    assert process.wait(timeout=300) == 0, process.stderr.read()
    chance, reached, frames = random.Random(seed), 0, frames_in(whole)
    for _ in range(10):
        reached = min(reached + chance.randrange(1, 20), frames - 1)
        number = chance.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
        process = start(cut, *overrides)
        code = end_when(process, cut, reached, chance.uniform(0.0, 0.03), number)
        message = process.stderr.read()
        # A signal may come while Python itself is starting, before a line of ours: then it ends so, with 1.
        starting = code == 1 and message.startswith("Fatal Python error: init_")
        assert starting or code in (-signal.SIGKILL, 4, 0, -signal.SIGTERM, -signal.SIGINT), message
        require_readable(cut)
    process = start(cut, *overrides)
    assert process.wait(timeout=300) == 0, process.stderr.read()
    require_same(cut, whole)
    assert not (cut / "checkpoint.npz").exists()
