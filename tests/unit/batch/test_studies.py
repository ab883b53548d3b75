"""Sweeps, ensembles and response curves in their folders: interrupted, resumed, finished, refused alike."""

import json
import re

import pytest
from small_sweep import SMALL

from fem.__main__ import main
from fem.case.case import load_case
from fem.ensemble.file import load_ensemble
from fem.ensemble.run import run_ensemble
from fem.response.request import ResponseRequest
from fem.response.run import run_response
from fem.results.errors import FolderError
from fem.runtime.progress import SilentReporter
from fem.sweep.file import load_sweep
from fem.sweep.run import run_sweep

ENSEMBLE = """
case = "seed_stack_plateau"
draws = 16
confidence = 0.9
probability = 0.5
[set]
"solver.model" = "rigid"
"solver.duration_s" = 1.5
[axes]
"motion.peak_acceleration_m_s2" = [2.0, 6.0, 12.0]
[random]
"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2 }
"""
RIGID = ("solver.model=rigid", "contact.mu_static=1", "contact.mu_kinetic=1", "solver.element_size_m=1")


class Interrupting(SilentReporter):
    """Interrupts at a report of progress."""

    def __init__(self, reports):
        self.left = reports

    def tell(self, line):
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt

    def update(self, time, rotation_ratio, mode):
        self.tell(lambda: "")


def sweep(tmp_path, other=False):
    path = tmp_path / "small.toml"
    path.write_text(SMALL.replace("count = 5", "count = 4") if other else SMALL, encoding="utf-8")
    asked = load_sweep(path)
    return lambda folder, **options: run_sweep(asked, folder, **options)


def ensemble(tmp_path, other=False):
    path = tmp_path / "small.toml"
    path.write_text(ENSEMBLE.replace("16", "24") if other else ENSEMBLE, encoding="utf-8")
    asked = load_ensemble(path)
    return lambda folder, **options: run_ensemble(asked, folder=folder, **options)


def response(tmp_path, other=False):
    case = load_case("seed_stack_plateau", RIGID)
    asked = ResponseRequest(
        case=case, first_Hz=0.6, last_Hz=1.4, count=3, settle=6, observe=9 if other else 8
    )
    return lambda folder, **options: run_response(asked, folder=folder, **options)


STUDIES = pytest.mark.parametrize(
    ("study", "mark", "log"),
    [
        (sweep, "sweep.json", "rows.csv"),
        (ensemble, "ensemble.json", "draws.csv"),
        (response, "response.json", "state.npz"),
    ],
    ids=["sweep", "ensemble", "response"],
)


pytestmark = pytest.mark.usefixtures("undrawn")


def files_of(folder):
    """Content of the files of a folder, without times and numbers of cores."""
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    found = {name: path.read_bytes() for name, path in files.items() if not path.name.startswith(".")}
    for name in found.keys() & {"sweep.json", "table.csv"}:
        found[name] = re.sub(rb'"(wall_s|jobs)": [^,]*|(?<=,)\d[^,]*(?=,\d+,(true|false),)', b"", found[name])
    return found


@STUDIES
def test_an_interrupted_study_continues_to_the_same_files(tmp_path, study, mark, log):
    run, folder = study(tmp_path), tmp_path / "interrupted"
    run(tmp_path / "whole")
    for reports in (1, 20, 30):  # of few chunks, the later ones come to the end
        try:
            run(folder, resume=True, reporter=Interrupting(reports))
        except KeyboardInterrupt:
            assert json.loads((folder / mark).read_text())["status"] == "running"
            if log.endswith("csv"):
                with (folder / log).open("ab") as stream:  # half a row, as a kill leaves it
                    stream.write(b"2,7,0,0.")
            if reports == 20 or mark != "sweep.json":  # a sweep needs rows
                with pytest.raises(FolderError, match=r"unfinished, with .* --resume continues it"):
                    run(folder)
    run(folder, resume=True)
    assert files_of(folder) == files_of(tmp_path / "whole")


@STUDIES
def test_a_finished_study_is_left_alone_and_another_is_refused(tmp_path, study, mark, log):
    run, folder = study(tmp_path), tmp_path / "out"
    run(folder)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    run(folder)
    with pytest.raises(FolderError, match=r"holds the results of another .*--out DIR.*--force"):
        study(tmp_path, other=True)(folder)
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
    study(tmp_path, other=True)(folder, force=True)


@STUDIES
def test_results_of_another_program_are_not_continued(tmp_path, study, mark, log):
    run, folder = study(tmp_path), tmp_path / "out"
    with pytest.raises(KeyboardInterrupt):
        run(folder, reporter=Interrupting(1))
    found = json.loads((folder / mark).read_text())
    for change, words in (
        ({"program": "other"}, "another version of the program"),
        ({"versions": found["versions"] | {"numpy": "1.0"}}, r"another version of numpy \(1.0, here "),
    ):
        (folder / mark).write_text(json.dumps(found | change))
        with pytest.raises(FolderError, match=rf"{words}.*--force"):
            run(folder, resume=True)


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (["sweep", "nowhere.toml"], "no sweep file"),
        (["sweep", "outcome_map", "-j", "0"], "-j"),
        (["ensemble", "fragilty"], "did you mean 'fragility'"),
        (["ensemble", "fragility", "-j", "0"], "-j"),
        (["response", "--from", "2", "--to", "1"], "--from must be less than --to"),
        (["response", "--from", "1", "--to", "2", "--count", "2.5"], "--count: a whole number is needed"),
    ],
)
def test_bad_input_ends_with_2_and_no_folder(tmp_path, monkeypatch, capsys, command, words):
    monkeypatch.chdir(tmp_path)
    assert main(command) == 2
    assert words in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
