"""Full disks, removed folders, damaged checkpoints: a reason is given and nothing is lost."""

import errno
import os
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest
from interrupted_runs import files_of, require_readable, run_command

import fem.results.archive
import fem.results.fields
import fem.results.history
import fem.run.output
import fem.runtime.own_files
from fem.__main__ import main
from fem.results.archive import read_archive, write_archive
from fem.results.folder import LOCK_NAME, OWNER_NAME, locked_folder
from fem.results.kinds import read_result
from fem.runtime.progress import ScreenReporter

COMMON = ("solver.model=rigid", "solver.duration_s=3", "output.figures=false", "output.fields_s=0.25")


def command(folder: Path, *options: str) -> int:
    return main([*run_command("rocking", folder, *COMMON), "--no-band", *options])


def at_time(monkeypatch, instant: float, action) -> None:
    """Do something when the run has come to `instant` [s]."""
    done = []

    def update(self, time, rotation_ratio, mode):
        if time >= instant and not done:
            done.append(time)
            action()

    monkeypatch.setattr(ScreenReporter, "update", update)


def interrupted(folder: Path, number: int = signal.SIGINT) -> Path:
    """A run stopped by Ctrl-C or another signal after one second."""
    with pytest.MonkeyPatch.context() as patch:
        at_time(patch, 1.0, lambda: os.kill(os.getpid(), number))
        assert command(folder) == 4
    return folder


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """The folder of a run stopped after one second."""
    return interrupted(tmp_path_factory.mktemp("stopped") / "r")


def no_room(*_, **__):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of the undisturbed run."""
    folder = tmp_path_factory.mktemp("whole")
    assert command(folder) == 0
    return folder


def require_resumed(folder: Path, whole: Path, *options: str) -> None:
    """When the fault is gone, --resume reaches the bits of the undisturbed run."""
    assert command(folder, *options) == 0
    for name in ("history.csv", "fields/run.pvd", "fields/frame_00012.vtu", "resolved.toml"):
        assert (folder / name).read_bytes() == (whole / name).read_bytes()
    assert read_result(folder / "run.json")["verdict"] == read_result(whole / "run.json")["verdict"]
    assert {path.name for path in folder.iterdir()} == {path.name for path in whole.iterdir()}


@pytest.mark.parametrize(("number", "options"), [(signal.SIGINT, ["--resume"]), (signal.SIGTERM, [])])
def test_an_interrupted_run_is_readable_names_the_way_on_and_reaches_the_same_bits(
    tmp_path, capsys, whole, number, options
):
    folder = tmp_path / "r"
    interrupted(folder, number)
    page = capsys.readouterr()
    assert "--resume" in page.err and "Not finished (interrupted" in page.out
    result = read_result(folder / "run.json")
    assert result["status"] == "interrupted" and result["numerics"]["steps"] > 0
    assert result["verdict"]["band"] is None
    assert (folder / "summary.txt").is_file()
    require_readable(folder)
    assert not (folder / LOCK_NAME).exists() and not (folder / OWNER_NAME).exists()
    require_resumed(folder, whole, *options)
    begun_again = "begins again at t = 0 s: --resume would have continued it" in capsys.readouterr().err
    assert begun_again == (not options)


@pytest.mark.parametrize(
    ("module", "name", "after"),
    [
        (fem.results.fields.FrameFormat, "frame", 5),
        (fem.runtime.own_files.os, "replace", 30),
        (fem.results.history.os, "fsync", 7),
        (fem.results.archive.zipfile.ZipFile, "writestr", 60),
    ],
    ids=["frame", "rename", "sync", "checkpoint"],
)
def test_a_disk_that_fills_up_ends_the_run_with_3(tmp_path, capsys, monkeypatch, whole, module, name, after):
    monkeypatch.setattr(fem.run.output, "CHECKPOINT_S", 0.0)
    kept, calls = getattr(module, name), []

    def fills_up(*arguments, **options):
        calls.append(name)
        return kept(*arguments, **options) if len(calls) <= after else no_room()

    with monkeypatch.context() as patch:
        patch.setattr(module, name, fills_up)
        assert command(tmp_path / "r") == 3
    message = capsys.readouterr().err
    assert "No space left on device" in message and "--resume" in message
    require_readable(tmp_path / "r")
    assert not list((tmp_path / "r").rglob(".part-*"))
    require_resumed(tmp_path / "r", whole, "--resume")


def test_a_folder_taken_by_another_run_is_left_to_it(tmp_path, capsys, monkeypatch):
    other = []

    def take():
        shutil.rmtree(tmp_path / "r")
        other.append(locked_folder(tmp_path / "r"))
        other[0].__enter__()
        (tmp_path / "r" / "run.json").write_text("theirs")

    monkeypatch.setattr(fem.run.output, "CHECKPOINT_S", 0.0)
    at_time(monkeypatch, 1.0, take)
    assert command(tmp_path / "r") == 3
    assert "taken by another process" in capsys.readouterr().err
    assert files_of(tmp_path / "r").keys() == {"run.json", LOCK_NAME, OWNER_NAME}
    assert (tmp_path / "r" / "run.json").read_text() == "theirs"
    other[0].__exit__(None, None, None)


def damage(folder: Path) -> None:
    content = bytearray((folder / "checkpoint.npz").read_bytes())
    content[len(content) // 2] ^= 1
    (folder / "checkpoint.npz").write_bytes(content)


def rewrite(folder: Path, **changes) -> None:
    """The checkpoint with other notes and a checksum that is right."""
    found = read_archive(folder / "checkpoint.npz")
    for name, value in changes.items():
        (found.arrays if name in found.arrays else found.about)[name] = value
    write_archive(folder / "checkpoint.npz", found.about, found.arrays)


def edit_history(folder: Path) -> None:
    text = (folder / "history.csv").read_text()
    (folder / "history.csv").write_text(text.replace("0.005", "0.006", 1))


FAULTS = {
    "damaged": (damage, "damaged"),
    "other sizes": (lambda folder: rewrite(folder, ledger=np.zeros(3)), "its ledger is not that"),
    "no notes": (lambda folder: rewrite(folder, progress=None), "notes cannot be read"),
    "history edited": (edit_history, "history.csv was changed since"),
    "frame gone": (lambda folder: (folder / "fields/frame_00002.vtu").unlink(), "frame_00002.vtu is miss"),
}


@pytest.mark.parametrize("kind", FAULTS)
def test_a_checkpoint_that_cannot_be_trusted_is_refused_and_nothing_changed(tmp_path, capsys, stopped, kind):
    folder = shutil.copytree(stopped, tmp_path / "r")
    fault, reason = FAULTS[kind]
    fault(folder)
    before = files_of(folder)
    capsys.readouterr()
    assert command(folder, "--resume") == 2
    message = capsys.readouterr().err
    assert "checkpoint.npz" in message and reason in message and "--force" in message
    assert files_of(folder) == before


def test_without_its_checkpoint_a_run_is_computed_from_the_start(tmp_path, stopped, whole):
    folder = shutil.copytree(stopped, tmp_path / "r")
    (folder / "checkpoint.npz").unlink()
    require_resumed(folder, whole, "--resume")


def test_a_motion_file_may_not_lie_where_results_are_written(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("history.csv").write_text("time_s,acceleration_m_s2\n0,0\n0.5,1\n1,0\n")
    changes = (
        *("motion.kind=table", "motion.file=history.csv", "motion.quantity=acceleration"),
        "motion.unit=m/s2",
    )
    assert main(["init", "seed_box", "--to", "mine.toml"]) == 0
    assert main(["run", "mine.toml", "-q", *(word for c in changes for word in ("--set", c))]) == 2
    assert "[motion] file is named 'history.csv'" in capsys.readouterr().err
    assert not Path("outputs").exists()
