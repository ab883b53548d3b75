"""An interrupted set-up continues with the parts that it has and gives the same bits."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from interrupted_runs import require_same, run_command

from fem.__main__ import main
from fem.run import setup_cache
from fem.solid import reduction

#: a case of many unknowns in contact
FLAT = (
    "support.kind=flat",
    "solver.element_size_m=0.25",
    "solver.elastic_modes=4",
    "solver.duration_s=0.1",
    "output.fields_s=0.05",
    "output.figures=false",
)
FULL = (*FLAT, "solver.model=full", "solver.element_size_m=0.5", "solver.duration_s=0.02")


def command(folder: Path, *overrides: str) -> list[str]:
    return [*run_command("seed_stack_plateau", folder, *overrides), "--no-band"]


@pytest.fixture
def in_many_parts(monkeypatch):
    monkeypatch.setattr(reduction, "LOADS", 6)
    monkeypatch.setattr(reduction, "PRODUCT", 200_000)


@pytest.mark.parametrize("overrides", [FLAT, FULL], ids=["reduced", "full"])
def test_a_set_up_cut_off_after_every_file_is_the_set_up_left_alone(
    tmp_path, monkeypatch, in_many_parts, overrides
):
    assert main(command(tmp_path / "whole", *overrides)) == 0
    folder, names, cuts = tmp_path / "cut", [], 0
    write = setup_cache.write_archive
    monkeypatch.setattr(setup_cache, "CHECKPOINT_S", 0.0)

    def write_and_stop(path, about, arrays):
        write(path, about, arrays)
        names.extend(arrays)
        if len(names) % 3 == 0:
            raise KeyboardInterrupt

    monkeypatch.setattr(setup_cache, "write_archive", write_and_stop)
    while main(command(folder, *overrides)) == 4:
        cuts += 1
        assert [entry.name for entry in folder.iterdir()] == [".setup"]
    assert cuts >= 3
    assert len(names) == len(set(names))  # no part was made twice
    require_same(folder, tmp_path / "whole")


def test_arrays_that_the_disk_has_no_room_for_are_reported(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(setup_cache, "CHECKPOINT_S", 0.0)
    monkeypatch.setattr(setup_cache, "free_disk", lambda folder: 1e4)
    quiet = command(tmp_path / "r", *FULL)
    assert main([word for word in quiet if word != "-q"]) == 0
    message = capsys.readouterr().err
    assert (
        ".setup: " in message
        and "of the set-up are not stored, since the disk has only 10 kB free" in message
    )


def test_a_damaged_part_is_named_and_the_set_up_continues_before_it(
    tmp_path, monkeypatch, in_many_parts, capsys
):
    assert main(command(tmp_path / "whole", *FLAT)) == 0
    write = setup_cache.write_archive
    monkeypatch.setattr(setup_cache, "CHECKPOINT_S", 0.0)

    def write_ten(path, about, arrays):
        if path.name == "part_11.npz":
            raise KeyboardInterrupt
        write(path, about, arrays)

    with monkeypatch.context() as patch:
        patch.setattr(setup_cache, "write_archive", write_ten)
        assert main(command(tmp_path / "cut", *FLAT)) == 4
    damaged = tmp_path / "cut" / ".setup" / "part_4.npz"
    damaged.write_bytes(damaged.read_bytes()[:-100])
    capsys.readouterr()
    assert main(command(tmp_path / "cut", *FLAT)) == 0  # and -q
    assert str(damaged) in "".join(capsys.readouterr().err.split("\n"))
    require_same(tmp_path / "cut", tmp_path / "whole")


def test_a_short_set_up_keeps_nothing_and_a_refused_one_leaves_nothing(tmp_path, monkeypatch, in_many_parts):
    monkeypatch.setattr(setup_cache, "write_archive", lambda *_: pytest.fail("kept"))
    assert main(command(tmp_path / "short", *FLAT)) == 0
    monkeypatch.undo()
    monkeypatch.setattr(setup_cache, "CHECKPOINT_S", 0.0)
    # crushed by its own weight, which only the answers tell
    soft = (*FLAT, "container.youngs_modulus_Pa=1e6")
    assert main(command(tmp_path / "new" / "refused", *soft)) == 2
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
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
