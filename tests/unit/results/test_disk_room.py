"""Room on the disk: told and asked for ahead, and what happens on a file system that is really full."""

import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from interrupted_runs import files_of, require_readable, run_command
from small_sweep import SMALL

import fem.results.disk
import fem.results.folder
from fem.__main__ import main
from fem.case.case import load_case
from fem.model.geometry import build_container, node_count
from fem.run.preview import required_disk

COMMON = ("solver.model=rigid", "solver.duration_s=2", "output.figures=false", "output.fields_s=0.05")
BESIDE = 4e6  #: told for a report, figures and a checkpoint, none of which are written here [bytes]
#: of the small file system [bytes]: less than the run's two megabytes, more than its beginning
ROOM = 400_000


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


def run(folder: Path, *options: str) -> int:
    return main([*run_command("rocking", folder, *COMMON), "--no-band", *options])


def told_of(name: str) -> float:
    case = load_case(name, COMMON)
    return required_disk(case, node_count(build_container(case), case.solver.order), duration=2.0)


def test_what_a_run_writes_is_told_ahead(tmp_path, capsys):
    told = told_of("rocking")
    assert run(tmp_path / "r") == 0
    written = sum(map(len, files_of(tmp_path / "r").values()))
    assert written < told < 1.6 * written + BESIDE
    capsys.readouterr()
    assert main(["check", "rocking", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["numerics"]["output_bytes"] > written
    assert main(["run", "rocking", "--dry-run", "--out", str(tmp_path)]) == 0
    page = capsys.readouterr().out
    assert "room for" in page and "about" in page


def test_results_that_are_replaced_make_room(tmp_path, monkeypatch):
    assert run(tmp_path / "r") == 0
    size = sum(map(len, files_of(tmp_path / "r").values()))
    free = shutil.disk_usage(tmp_path)._replace(free=int(told_of("rocking") - 0.9 * size))
    monkeypatch.setattr(fem.results.disk.shutil, "disk_usage", lambda _: free)
    assert run(tmp_path / "r", "--force") == 0
    assert run(tmp_path / "other") == 2


COMMANDS = {
    "run": f"run rocking --no-band {' '.join(f'--set {one}' for one in COMMON)}",
    "sweep": "sweep small.toml -j 1",
}


@pytest.fixture(params=COMMANDS)
def command(request, tmp_path, monkeypatch) -> list[str]:
    """Something that writes a folder of results."""
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(SMALL + '[perturbation]\ncells = "none"\n')
    return [*COMMANDS[request.param].split(), "-q"]


def test_results_that_do_not_fit_are_refused_before_anything_is_written(
    command, tmp_path, capsys, monkeypatch
):
    free = shutil.disk_usage(tmp_path)._replace(free=100_000)
    monkeypatch.setattr(fem.results.disk.shutil, "disk_usage", lambda _: free)
    assert main([*command, "--out", str(tmp_path / "f")]) == 2
    message = capsys.readouterr().err
    assert "would write about" in message and "room for 100 kB" in message and "--out DIR" in message
    assert not (tmp_path / "f").exists()


def test_a_full_disk_ends_with_3_and_what_was_written_is_continued(command, small, capsys):
    command += ["--out", str(small / "f")]
    with pytest.MonkeyPatch.context() as patch:  # as when others fill the disk while the run is under way
        patch.setattr(fem.results.folder, "free_disk", lambda *_: None)
        with open(small / "filler", "wb") as filler:
            filler.write(bytes(ROOM - 6 * 4096))
        assert main(command) == 3
        message = capsys.readouterr().err
        assert "No space left on device" in message and str(small / "f") in message
        assert "Traceback" not in message
        for file in (small / "f").glob("*.json"):
            json.loads(file.read_text())
        if command[0] == "run":
            require_readable(small / "f")
        (small / "filler").unlink()
        if command[0] == "run":  # the whole run does not fit
            return
        assert main([*command, "--resume"]) == 0
    assert not list((small / "f").rglob(".part-*"))
