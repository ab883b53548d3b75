"""Room on the disk: told and asked for ahead, and what happens on file systems that are really full or read-only."""

import contextlib
import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from small_sweep import SMALL

import fem.paper.run
import fem.report.run_page
import fem.results.disk
import fem.run.run
import fem.sweep.run
from fem.__main__ import main
from fem.case.case import load_case
from fem.model.geometry import build_container, node_count
from fem.results.fields import open_fields
from fem.results.history import read_history
from fem.results.lock import locked_folder
from fem.results.run_folder import read_result
from fem.run.size import required_disk
from fem.sweep.table import open_sweep

COMMON = ("solver.model=rigid", "solver.duration_s=2", "output.figures=false", "output.fields_s=0.05")
BESIDE = 4e6  #: told for a report, figures and a checkpoint, none of which are written here [bytes]
ROOM = (
    400_000  #: of the small file system [bytes]: less than the run's two megabytes, more than its beginning
)


def run(folder: Path, *options: str) -> int:
    changes = [word for override in COMMON for word in ("--set", override)]
    return main(["run", "rocking", "--out", str(folder), "--no-band", "-q", *changes, *options])


@pytest.fixture
def small(tmp_path) -> Iterator[Path]:
    """A file system of its own with little room."""
    place = tmp_path / "small"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={ROOM}", "tmpfs", str(place)]
    if shutil.which("mount") is None or subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("mounting is not allowed here")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def remount_read_only(place: Path) -> None:
    subprocess.run(["mount", "-o", "remount,ro", str(place)], check=True)


@contextlib.contextmanager
def unforeseen() -> Iterator[None]:
    """As when others fill the disk while the run is under way."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fem.results.disk, "free_disk", lambda *_: None)
        yield


def told_of(name: str) -> float:
    case = load_case(name, COMMON)
    return required_disk(case, node_count(build_container(case), case.solver.order))


def everything_reads(folder: Path) -> None:
    assert len(read_history(folder / "history.csv")) > 10
    assert all(frame.points.size for frame in open_fields(folder / "fields"))
    assert not list(folder.rglob("*.part"))


def test_what_a_run_writes_is_told_ahead(tmp_path, capsys):
    told = told_of("rocking")
    assert run(tmp_path / "r") == 0
    written = sum(path.stat().st_size for path in (tmp_path / "r").rglob("*") if path.is_file())
    assert written < told < 1.6 * written + BESIDE
    capsys.readouterr()
    assert main(["check", "rocking", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["numerics"]["output_bytes"] > written
    assert main(["run", "rocking", "--dry-run", "--out", str(tmp_path)]) == 0
    page = capsys.readouterr().out
    assert "room for" in page and "about" in page


def test_a_run_that_does_not_fit_is_refused_before_anything_is_written(tmp_path, capsys, monkeypatch):
    free = shutil.disk_usage(tmp_path)._replace(free=2_000_000)
    monkeypatch.setattr(fem.results.disk.shutil, "disk_usage", lambda _: free)
    assert run(tmp_path / "r") == 2
    message = capsys.readouterr().err
    assert "would write about" in message and "room for 2 MB" in message and "output.fields_s" in message
    assert not (tmp_path / "r").exists()


def test_results_that_are_replaced_make_room(tmp_path, monkeypatch):
    assert run(tmp_path / "r") == 0
    size = sum(path.stat().st_size for path in (tmp_path / "r").rglob("*") if path.is_file())
    free = shutil.disk_usage(tmp_path)._replace(free=int(told_of("rocking") - 0.9 * size))
    monkeypatch.setattr(fem.results.disk.shutil, "disk_usage", lambda _: free)
    assert run(tmp_path / "r", "--force") == 0
    assert run(tmp_path / "other") == 2


def test_a_full_disk_ends_a_run_with_3_and_leaves_what_was_written(small, capsys):
    with unforeseen():
        assert run(small / "r") == 3
    message = capsys.readouterr().err
    assert "No space left on device" in message and str(small / "r") in message and "--resume" in message
    everything_reads(small / "r")
    assert read_result(small / "r" / "run.json")["status"] in ("failed", "running")


def test_a_disk_that_turns_read_only_ends_a_run_with_3(small, capsys, monkeypatch):
    def update(self, time, rotation_ratio, mode):
        if time >= 0.3:
            remount_read_only(small)

    monkeypatch.setattr(fem.runtime.progress.ScreenReporter, "update", update)
    with unforeseen():
        assert run(small / "r") == 3
    message = capsys.readouterr().err
    assert "Read-only file system" in message or "No space left" in message
    everything_reads(small / "r")


def test_a_read_only_folder_ends_a_run_with_3_before_it_begins(small, capsys):
    remount_read_only(small)
    with unforeseen():
        assert run(small / "r") == 3
    message = capsys.readouterr().err
    assert "cannot be written (Read-only file system)" in message and "--out DIR" in message


def test_a_sweep_on_a_full_disk_ends_with_3_keeps_its_rows_and_goes_on(small, capsys, tmp_path):
    (tmp_path / "small.toml").write_text(SMALL)
    command = ["sweep", str(tmp_path / "small.toml"), "--out", str(small / "s"), "-q", "-j", "1"]
    with open(small / "filler", "wb") as filler:
        filler.write(bytes(ROOM - 3 * 4096 - 4096))
    assert main(command) == 2
    assert "the sweep (20 cells) would write about" in capsys.readouterr().err and not (small / "s").exists()
    with unforeseen():
        assert main(command) in (2, 3)
        os.truncate(small / "filler", ROOM - 8 * 4096)
        assert main([*command, "--resume"]) == 3
    message = capsys.readouterr().err
    assert "No space left on device" in message and "--resume" in message
    (small / "filler").unlink()
    with unforeseen():
        assert main([*command, "--resume"]) == 0
    assert len(open_sweep(small / "s")["cell"]) == 20


def test_a_folder_removed_during_a_sweep_ends_it_with_3(tmp_path, capsys, monkeypatch):
    (tmp_path / "small.toml").write_text(SMALL)
    draw = fem.sweep.run._draw

    def removed(place, sweep):
        shutil.rmtree(place.path)
        return draw(place, sweep)

    monkeypatch.setattr(fem.sweep.run, "_draw", removed)
    assert main(["sweep", str(tmp_path / "small.toml"), "--out", str(tmp_path / "s"), "-q", "-j", "1"]) in (
        2,
        3,
    )
    message = capsys.readouterr().err
    assert str(tmp_path / "s") in message and "Traceback" not in message


TWO_STATEMENTS = ("study", "seed", "--only", "half-width", "--only", "numbers-one-box", "-q")
CURVE = (
    "response",
    "rocking",
    "--from",
    "0.6",
    "--to",
    "1",
    "--count",
    "2",
    "--settle",
    "2",
    "--observe",
    "8",
    "-q",
)
ENSEMBLE = """
case = "seed_stack_plateau"
draws = 8
confidence = 0.9
probability = 0.5
[set]
"solver.model" = "rigid"
"solver.duration_s" = 1.0
[axes]
"motion.peak_acceleration_m_s2" = [2.0, 6.0]
[random]
"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2 }
"""


@pytest.fixture(params=["study", "response", "ensemble"])
def command(request, tmp_path) -> list[str]:
    """Something that writes a folder of results and is no run."""
    (tmp_path / "e.toml").write_text(ENSEMBLE)
    return {
        "study": [*TWO_STATEMENTS],
        "response": [*CURVE, "--set", "solver.model=rigid"],
        "ensemble": ["ensemble", str(tmp_path / "e.toml"), "-q", "-j", "1"],
    }[request.param]


def test_a_study_of_many_runs_that_does_not_fit_is_refused_before_anything_is_written(
    command, tmp_path, capsys, monkeypatch
):
    free = shutil.disk_usage(tmp_path)._replace(free=100_000)
    monkeypatch.setattr(fem.results.disk.shutil, "disk_usage", lambda _: free)
    assert main([*command, "--out", str(tmp_path / "f")]) == 2
    message = capsys.readouterr().err
    assert "would write about" in message and "room for 100 kB" in message and "--out DIR" in message
    assert not (tmp_path / "f").exists()


def test_a_full_disk_ends_a_study_of_many_runs_with_3_and_it_goes_on(command, small, capsys):
    command += ["--out", str(small / "f")]
    with unforeseen():
        with open(small / "filler", "wb") as filler:
            filler.write(bytes(ROOM - 6 * 4096))
        assert main(command) == 3
        message = capsys.readouterr().err
        assert "No space left on device" in message and "goes on" in message and "Traceback" not in message
        for file in (small / "f").glob("*.json"):
            json.loads(file.read_text())
        (small / "filler").unlink()
        assert main(command if command[0] == "study" else [*command, "--resume"]) == 0
    assert not list((small / "f").rglob("*.part"))


def test_a_read_only_folder_ends_a_study_of_many_runs_with_3(command, small, capsys):
    remount_read_only(small)
    with unforeseen():
        assert main([*command, "--out", str(small / "f")]) == 3
    message = capsys.readouterr().err
    assert "Read-only file system" in message and "--out DIR" in message


def test_a_folder_of_a_study_that_is_taken_or_removed_is_told(tmp_path, capsys, monkeypatch):
    folder, command = tmp_path / "f", [*TWO_STATEMENTS, "--out", str(tmp_path / "f")]
    with locked_folder(folder):
        assert main(command) == 2
    assert "another run writes there" in capsys.readouterr().err
    tried = fem.paper.run._tried

    def removed(*arguments):
        shutil.rmtree(folder)
        return tried(*arguments)

    monkeypatch.setattr(fem.paper.run, "_tried", removed)
    assert main(command) == 3
    message = capsys.readouterr().err
    assert str(folder) in message and "Traceback" not in message
    assert not folder.exists()


def test_a_report_that_cannot_be_written_ends_with_3_and_names_another_place(
    small, capsys, monkeypatch, tmp_path
):
    assert run(tmp_path / "r", "--set", "output.fields_s=0") == 0
    shutil.copytree(tmp_path / "r", small / "r")
    remount_read_only(small)
    monkeypatch.setattr(fem.report.run_page, "run_report", lambda *_, **__: "<html></html>")  # takes long
    capsys.readouterr()
    assert main(["report", str(small / "r")]) == 3
    message = capsys.readouterr().err
    assert "report.html: cannot be written (Read-only file system)" in message and "--to FILE" in message
    assert main(["report", str(small / "r"), "--to", str(tmp_path / "page.html")]) == 0


def test_modes_and_verification_end_with_3_where_their_folder_is_read_only(small, capsys):
    remount_read_only(small)
    for command in (["modes", "seed_box", "--count", "1"], ["verify", "--room", "statics", "-q"]):
        assert main([*command, "--out", str(small / "m")]) == 3
        message = capsys.readouterr().err
        assert "cannot be written (Read-only file system)" in message and "--out DIR" in message
