"""A signal during the set-up of a run, and a case that only its set-up can refuse."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from interrupted_runs import run_command

from fem.__main__ import main

#: crushed by its own weight
SOFT = ("support.kind=flat", "solver.element_size_m=0.25", "container.youngs_modulus_Pa=1e6")


def command(folder: Path, *overrides: str) -> list[str]:
    return [*run_command("seed_stack_plateau", folder, *overrides), "--no-band"]


def test_a_refused_set_up_leaves_nothing(tmp_path):
    assert main(command(tmp_path / "new" / "refused", *SOFT)) == 2
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.slow), signal.SIGTERM])
def test_a_signal_during_the_set_up_ends_it_at_once(tmp_path, number):
    slow = """
import sys, time
import fem.run.run
def slowly(*_):
    print(flush=True)
    time.sleep(600.0)
fem.run.run.discretise = slowly
from fem.__main__ import program
program()
"""
    process = subprocess.Popen(
        [sys.executable, "-c", slow, *command(tmp_path / "r")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "\n"
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 4
    assert err == "interrupted\n"
    assert not (tmp_path / "r").exists()
