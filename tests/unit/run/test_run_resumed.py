"""A run that is interrupted, or killed at any moment, and resumed is, bit for bit, the undisturbed run."""

import os
import random
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from interrupted_runs import (
    COARSE,
    FLAT_SHELL,
    one_slice,
    require_readable,
    require_same,
    run_command,
    stored_run,
)

import fem.run.compute
import fem.run.simulation
from fem.case.case import load_case
from fem.results.reader import OpenedRun

RIGID = ("solver.model=rigid", "solver.element_size_m=0.5", "solver.duration_s=1.2", "output.fields_s=0.1")
REDUCED = ("solver.element_size_m=0.25", "solver.duration_s=0.7", "output.fields_s=0.1")
FLAT = (*REDUCED, *FLAT_SHELL)
FULL = (*COARSE, "solver.duration_s=0.12", "output.fields_s=0.02")
#: still beyond its slenderness angle when time is up, then falling
FALLING = ("solver.model=rigid", "initial.rotation_rad=0.8", "solver.duration_s=0.3", "output.fields_s=0.2")

#: a pulse of which the box slides on, comes to rest and is watched for 0.3 s
FREE = (
    *("solver.model=rigid", "solver.duration_s=auto", "motion.kind=pulse", "motion.shape=rectangular"),
    *("motion.pulse_s=0.1", "motion.peak_acceleration_m_s2=6.0", "output.fields_s=0.1"),
)

UP = ("vertical.kind=harmonic", "vertical.peak_acceleration_m_s2=3", "vertical.frequency_Hz=3")

LOOSE = ("container.joints=loose", "motion.peak_acceleration_m_s2=9")
PAIR = ("container.boxes=2", "solver.elastic_modes=4")

STRAP = "tie=[{from = 'left', height_m = 0.5, slack_m = 0.001, stiffness_N_m = 1e6, strength_N = 1e3}]"

#: the uppermost of four loose boxes strikes a wall
HELD_BOXES = ("stop=[{side = 'right', height_m = 3.5, gap_m = 0.01, stiffness_N_m = 1e8, mu = 0.3}]", STRAP)

#: it rocks between two others, tied to the floor, one of them before a wall
ROW = (
    *RIGID,
    "motion.peak_acceleration_m_s2=6",
    "neighbour=[{side = 'right', gap_m = 0.01, stiffness_N_m = 1e8, mu = 0.3, height_m = 0.8, mass_kg = 2000.0, "
    "centroid_m = 0.4}, {side = 'left', gap_m = 0.0, stiffness_N_m = 1e8}]",
    "stop=[{side = 'right', height_m = 0.5, gap_m = 0.01, stiffness_N_m = 1e8}]",
    "tie=[{from = 'right', height_m = 0.8, stiffness_N_m = 1e6}]",
)

CASES = {
    "row": ("rocking", ROW),
    "loose": ("seed_stack_plateau", (*RIGID, *LOOSE, *HELD_BOXES)),
    "loose, reduced": ("seed_stack_plateau", (*REDUCED, *LOOSE, *PAIR)),
    "vertical": ("rocking", (*RIGID, *UP)),
    "rigid": ("rocking", RIGID),
    "reduced, flat base": ("seed_stack_plateau", FLAT),
    "full": ("seed_stack_plateau", (*FULL, *UP)),
    "free motion": ("seed_box", FREE),
    "aftermath": ("free_rocking", FALLING),
}

#: compiled for this test alone, or steps as another kind does
SLOW = ("loose, reduced", "vertical", "rigid")


def run(folder: Path, name: str, overrides: tuple[str, ...], **options) -> OpenedRun:
    case = load_case(name, [*overrides, "output.figures=false"])
    return stored_run(case, folder, band=False, **options)


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind in SLOW)) for kind in CASES]
)
def test_a_run_cut_off_after_every_slice_is_the_run_left_alone(tmp_path, monkeypatch, kind):
    name, overrides = CASES[kind]
    monkeypatch.setattr(fem.run.simulation, "SLICE_REDUCED", 0.25)
    monkeypatch.setattr(fem.run.simulation, "SLICE_FULL", 0.03)
    monkeypatch.setattr(fem.run.simulation, "FIRST_PAUSE", 400)
    monkeypatch.setattr(fem.run.simulation, "AFTERMATH_SLICE", 0.15)
    run(tmp_path / "whole", name, overrides)
    stepping = fem.run.compute.simulate
    cuts = 0
    while True:
        # every beginning steps one slice, so every state between slices has been through a checkpoint
        monkeypatch.setattr(fem.run.compute, "simulate", partial(one_slice, stepping))
        if run(tmp_path / "cut", name, overrides, resume=True).status != "interrupted":
            break
        cuts += 1
        assert (tmp_path / "cut" / "checkpoint.npz").is_file()
    assert cuts >= 2
    require_same(tmp_path / "cut", tmp_path / "whole")


@pytest.mark.parametrize("kind", ["reduced, flat base", "full"])
def test_a_run_paused_after_every_step_is_the_run_that_never_pauses(tmp_path, monkeypatch, kind):
    # Where the pauses fall depends on the wall clock; nothing else may.
    name, overrides = CASES[kind]
    for folder, first, longer in (("paused", 1, 1), ("whole", 10**9, 8)):
        monkeypatch.setattr(fem.run.simulation, "FIRST_PAUSE", first)
        monkeypatch.setattr(fem.run.simulation, "LONGER", longer)
        run(tmp_path / folder, name, (*overrides, "solver.duration_s=0.1"))
    require_same(tmp_path / "paused", tmp_path / "whole")


def test_pauses_come_every_few_seconds_whatever_a_step_takes():
    for seconds in (1e-6, 1e-3, 0.1, 3.0):  # of wall time a step
        pace, pauses = fem.run.simulation.Pace(), []
        for _ in range(40):
            pauses.append(pace.attempts * seconds)
            pace.note(pace.attempts, pauses[-1])
        assert max(pauses[1:]) <= fem.run.simulation.PAUSE_S
        assert pauses[0] <= fem.run.simulation.FIRST_PAUSE * seconds
    pace.note(1, 60.0)  # a factorisation
    assert pace.attempts == 1
    pace.note(1, 1e-3)
    assert pace.attempts == fem.run.simulation.LONGER  # the next pause is not far, whatever comes


#: the command line, with a checkpoint after every slice
PROMPT = """
import sys
import fem.run.output, fem.run.simulation
fem.run.output.CHECKPOINT_S = 0.0
fem.run.simulation.SLICE_REDUCED = fem.run.simulation.SLICE_FULL = 0.01
from fem.__main__ import main
sys.exit(main(sys.argv[1:]))
"""
KILLED_FLAT = ("solver.duration_s=0.6", "output.fields_s=0.005", *FLAT_SHELL)
KILLED_FULL = (*COARSE, "solver.duration_s=0.3", "output.fields_s=0.005")
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
@pytest.mark.parametrize(
    ("overrides", "seed"), [(KILLED_FLAT, 2), (KILLED_FULL, 3)], ids=["reduced, flat base", "full"]
)
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
