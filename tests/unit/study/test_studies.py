"""Every kind of study in its folder: interrupted, killed, resumed, finished, refused, told and reported alike."""

import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest
from small_site import SITE
from small_sweep import SMALL, rows_without_wall, sweep_in

from fem.__main__ import main
from fem.case.case import load_case
from fem.case.validation import CaseError
from fem.cli.console import print_result
from fem.results import kinds
from fem.results.errors import FolderError, OutputError
from fem.results.figures import RUN_COLUMNS
from fem.runtime.progress import Reporter
from fem.study.driver import LoggedRuns
from fem.study.hall import run_hall
from fem.study.hall_file import read_hall
from fem.study.runner import Runner
from fem.study.sweep import check_size, run_sweep
from fem.study.sweep_table import open_sweep
from fem.study.table import line_of, row_of
from fem.study.workers import LocalWorkers

HALL = "name,width_m,boxes\n" + "".join(f"{k},{0.6 + 0.02 * k:.2f},2\n" for k in range(40))
RIGID = ("solver.model=rigid", "contact.mu_static=1", "contact.mu_kinetic=1", "solver.element_size_m=1")


class Interrupting(Reporter):
    """Interrupts at a report of progress: at once, or by Ctrl-C, at the next safe point."""

    def __init__(self, reports, *, ctrl_c=False):
        self.left, self.ctrl_c = reports, ctrl_c

    def tell(self, line):
        self.left -= 1
        if self.left == 0 and self.ctrl_c:
            os.kill(os.getpid(), signal.SIGINT)
        elif self.left == 0:
            raise KeyboardInterrupt


class Removing(Reporter):
    """Removes the folder of the results at every report of progress."""

    def __init__(self, folder):
        self.folder = folder

    def tell(self, line):
        shutil.rmtree(self.folder, ignore_errors=True)


def sweep(tmp_path, other=False):
    asked = sweep_in(tmp_path, SMALL.replace("count = 5", "count = 4") if other else SMALL)
    return lambda folder, **options: run_sweep(asked, folder, **options)


def hall(tmp_path, other=False):
    path = tmp_path / "hall.csv"
    path.write_text(HALL.replace("0.60", "0.59") if other else HALL, encoding="utf-8")
    asked, base = read_hall(path), load_case("seed_stack_plateau", (*RIGID, "solver.duration_s=1.5"))
    return lambda folder, **options: run_hall(asked, base, folder, checks="none", **options)


pytestmark = pytest.mark.usefixtures("undrawn")

STUDIES = pytest.mark.parametrize(
    ("study", "mark", "log"),
    [
        (sweep, "sweep.json", "rows.csv"),
        (hall, "hall.json", "runs.csv"),
    ],
    ids=["sweep", "hall"],
)


@pytest.fixture(scope="module")
def whole(gallery, tmp_path_factory):
    """Folders of the studies that were computed in one go, which tests compare with and copy."""
    place = tmp_path_factory.mktemp("kept")
    hall(place)(place / "whole")
    return {sweep: gallery("sweep"), hall: place / "whole"}


def files_of(folder):
    """Content of the files of a folder, without times, numbers of cores and where the input was."""
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    found = {name: path.read_bytes() for name, path in files.items() if not path.name.startswith(".")}
    found.pop("report.html", None)
    times = rb'"(wall_s|jobs|command)": [^,]*|(?<=,)\d[^,]*(?=,\d+,(true|false),)'
    for name in found.keys() & {"sweep.json", "table.csv", "assess.json", "size.json"}:
        found[name] = re.sub(times, b"", found[name])
    return found


@STUDIES
def test_an_interrupted_study_continues_to_the_same_files(tmp_path, whole, study, mark, log):
    run, folder = study(tmp_path), tmp_path / "interrupted"
    for reports in (1, 20, 30):  # of few chunks, the later ones come to the end
        try:
            run(folder, resume=True, reporter=Interrupting(reports))
        except KeyboardInterrupt:
            assert json.loads((folder / mark).read_text())["status"] == "running"
            with (folder / log).open("ab") as stream:  # half a row, as a kill leaves it
                stream.write(b"2,7,0,0.")
            if reports == 20 or mark != "sweep.json":  # a sweep needs rows
                with pytest.raises(FolderError, match=r"unfinished, with .* --resume continues it"):
                    run(folder)
    run(folder, resume=True)
    assert files_of(folder) == files_of(whole[study])


@STUDIES
def test_a_study_whose_folder_is_removed_ends_in_a_sentence(tmp_path, study, mark, log):
    folder = tmp_path / "out"
    words = "out: the folder was removed during the run; run the command again"
    with pytest.raises(OutputError, match=words):
        study(tmp_path)(folder, reporter=Removing(folder))
    assert not folder.exists()


@STUDIES
def test_an_interrupted_study_says_what_is_missing_in_place_of_an_answer(tmp_path, capsys, study, mark, log):
    run, folder = study(tmp_path), tmp_path / "out"
    result = run(folder, reporter=Interrupting(1, ctrl_c=True), jobs=1)
    kind = next(one for one in kinds.KINDS if one.mark == mark)
    assert print_result(result, kind, folder, "", as_json=False) == 4
    assert re.fullmatch("no answer yet: .*; --resume continues", capsys.readouterr().out.strip())
    found = json.loads((folder / mark).read_text())
    assert (found["status"], found["state"], found["answer"]) == ("interrupted", "interrupted", None)
    assert main(["report", str(folder), "-q"]) == 0
    page = (folder / "report.html").read_text()
    sentence = re.search(r'class="sentence"[^>]*>([^<]*)<', page)[1]
    assert sentence.startswith("No answer yet: ")
    assert 'id="signature"' not in page and "signature</div>" not in page
    assert run(folder, resume=True).state == "finished"
    found = json.loads((folder / mark).read_text())
    assert found["state"] == "finished" and found["answer"]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="process groups of POSIX")
def test_sigterm_to_all_processes_of_an_assessment_ends_it_in_a_sentence(tmp_path):
    """As a batch scheduler ends a job: the workers get the signal with the process that started them."""
    (tmp_path / "hall.toml").write_text(SITE.replace("count = 3", "count = 7"), encoding="utf-8")
    command = [sys.executable, "-m", "fem", "assess", "hall.toml", "-j", "2", "--out", "out"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, cwd=tmp_path, text=True, start_new_session=True, **pipes) as process:
        told = process.stderr.readline()
        os.killpg(process.pid, signal.SIGTERM)
        out, err = process.communicate(timeout=120)
    assert process.returncode == 4 and told, err
    assert out.splitlines()[-1].startswith("no answer yet: ")
    assert "stopping after the current step" in err
    assert not re.search("Traceback|Error|pool|worker|concurrent|multiprocessing|leaked", err)
    found = json.loads((tmp_path / "out" / "assess.json").read_text())
    assert (found["state"], found["answer"]) == ("interrupted", None)


@STUDIES
def test_a_finished_study_is_left_alone_and_another_is_refused(tmp_path, whole, study, mark, log):
    run, folder = study(tmp_path), tmp_path / "out"
    shutil.copytree(whole[study], folder)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    run(folder)
    with pytest.raises(FolderError, match=r"holds the results of another .*--out DIR.*--force"):
        study(tmp_path, other=True)(folder)
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
    study(tmp_path, other=True)(folder, force=True)


def test_results_of_another_program_are_not_continued(tmp_path):
    run, folder, mark = hall(tmp_path), tmp_path / "out", "hall.json"
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


def _logged(path, columns, rows, told=pytest.fail, items=(1, 2), **more):
    """Rows of items that are their first column, in a log."""
    reporter = SimpleNamespace(warning=told)
    runner = SimpleNamespace(reporter=reporter, stop=lambda: False, rows=lambda *_, **kw: rows)
    one = {"what": "", "path": path, "columns": columns, "key": lambda item: [item], "ids": 1}
    runs = LoggedRuns(**one | {"make": None, "model_of": None} | more)
    runs.run(runner, [items])
    return runs


@pytest.mark.parametrize("line", ["2", "2,0.5,7", "2,fast", "x,0.5", "", "\0,1", "2,nan", "2,-inf"])
def test_a_damaged_row_is_left_out_and_told(tmp_path, line):
    path, told = tmp_path / "rows.csv", []
    path.write_text(f"a,b\n1,0.5\n{line}\n3,1.5\n4,")
    runs = _logged(path, {"a": int, "b": float}, [([2], [{"b": 0.25}])], told.append, (1, 2, 3))
    assert runs.lines == {(1,): "1,0.5", (3,): "3,1.5", (2,): "2,0.25"}
    assert path.read_text() == "a,b\n1,0.5\n3,1.5\n2,0.25\n"
    assert told == [f"{path}: damaged rows, which are computed again: 1"]


def test_a_row_that_says_otherwise_of_what_was_run_is_computed_again(tmp_path):
    """What tells runs apart agrees, what they are made of does not; no run is the seventh, nor of another value."""
    path, told, columns = tmp_path / "rows.csv", [], {"of": str, "a": int, "mu": float, "b": float}
    path.write_text("of,a,mu,b\nx,1,0.3,0.5\nx,2,0.4,0.5\nx,7,0.7,0.5\ny,2,0.3,0.5\n")
    made = {"ids": 2, "of": "x,", "key": lambda item: ("x", item, 0.3)}
    runs = _logged(path, columns, [([2], [{"b": 0.25}])], told.append, **made)
    assert runs.lines == {("x", 1): "x,1,0.3,0.5", ("x", 2): "x,2,0.3,0.25"}
    assert path.read_text() == "of,a,mu,b\nx,1,0.3,0.5\ny,2,0.3,0.5\nx,2,0.3,0.25\n"
    assert told == [f"{path}: rows that say otherwise than this study, which are left out: 2"]


def test_work_in_place_of_runs_is_handed_out_one_by_one(tmp_path):
    """It may take an hour."""
    handed = []

    def work(make, items):
        handed.append(items)
        return [{"status": "completed"} for _ in items]

    one = {"what": "", "path": tmp_path / "checks.csv", "columns": {"a": int, "status": str}, "make": None}
    one |= {"key": lambda item: [item], "ids": 1, "model_of": lambda item: "rigid", "work": work}
    with LocalWorkers(1) as workers_of:
        LoggedRuns(**one).run(Runner(workers_of=workers_of), [[1, 2, 3]])
    assert sorted(handed) == [[1], [2], [3]]


def test_a_row_reads_back_with_the_types_of_its_columns():
    samples = {str: "-rock", int: 3, float: 0.1 + 0.2, bool: False, tuple: (0.1, -2.5e-17)}
    assert {*RUN_COLUMNS.values()} == {*samples}
    row = {name: samples[kind] for name, kind in RUN_COLUMNS.items()}
    for values in (row, dict.fromkeys(RUN_COLUMNS)):
        assert row_of(RUN_COLUMNS, line_of(values.values())) == values


def test_the_table_does_not_depend_on_the_jobs(gallery, tmp_path):
    computed = gallery("sweep")
    one, two = open_sweep(computed).info, run_sweep(sweep_in(tmp_path), tmp_path / "two", jobs=2)
    assert one["status"] == two["status"] == "completed"
    assert rows_without_wall(computed) == rows_without_wall(tmp_path / "two")
    assert one["outcomes"] == two["outcomes"]
    assert one["answer"] == two["answer"]
    assert one["answer"].startswith("peak acceleration: stood in every motion tried up to ")
    answers = [(folder / "answers.csv").read_bytes() for folder in (computed, tmp_path / "two")]
    assert answers[0] == answers[1]
    assert answers[0].count(b"\n") == 1 + 2  # a row for each frequency
    assert {"overturned", "rest"} <= set(one["outcomes"])
    assert not (computed / "rows.csv").exists()
    table = open_sweep(computed)
    assert np.array_equal(table["contact.mu_kinetic"], np.full(10, 0.2))
    assert np.array_equal(np.isfinite(table["overturned_at_s"]), table.outcome == "overturned")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_a_sweep_killed_five_times_gives_the_same_table(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.toml").write_text(SMALL.replace("count = 5", "count = 80"), encoding="utf-8")
    choice, folder = random.Random(0), tmp_path / "outputs" / "small"
    command = [sys.executable, "-m", "fem", "sweep", "small.toml", "-j", "2", "-q"]

    def logged():
        return sum(path.stat().st_size for path in folder.glob("*.csv"))  # of the cells and of the copies

    for k in range(5):
        size, deadline = logged(), time.monotonic() + 60.0
        with subprocess.Popen([*command, *["--resume"] * bool(k)]) as process:
            while logged() <= size and process.poll() is None and time.monotonic() < deadline:
                time.sleep(0.005)
            time.sleep(choice.uniform(0.0, 0.3))
            process.kill()
        assert process.returncode == -signal.SIGKILL
    assert main(["sweep", "small.toml", "--resume", "-q"]) == 0
    assert main(["sweep", "small.toml", "-q", "--out", "alone"]) == 0
    assert rows_without_wall(folder) == rows_without_wall(tmp_path / "alone")


def test_another_band_keeps_the_rows(gallery, tmp_path):
    folder = gallery.copy("sweep", tmp_path)
    rows, walls = rows_without_wall(folder), open_sweep(folder)["wall_s"]
    again = run_sweep(sweep_in(tmp_path, SMALL + '[perturbation]\ncells = "none"\n'), folder)
    assert (again["unsure"], again["perturbed"]) == (None, 0)
    kept = rows_without_wall(folder)
    last = kept[0].index("perturbed")
    assert [row[:last] for row in kept] == [row[:last] for row in rows]
    # the wall times are the first computation's: nothing was computed again
    assert np.array_equal(open_sweep(folder)["wall_s"], walls)


def test_a_failed_cell_has_a_reason_and_never_stands(tmp_path):
    # At 4 rad/s the expression has no value; the ends of the range are fine.
    derived = "[derived]", '[derived]\n"container.depth_m" = "1 / (motion.angular_frequency_rad_s - 4)^2"'
    few = SMALL.replace("count = 2", "count = 3").replace("count = 5", "count = 2")
    run_sweep(sweep_in(tmp_path, few.replace(*derived)), tmp_path / "out")
    table = open_sweep(tmp_path / "out")
    middle = table["motion.angular_frequency_rad_s"] == 4.0
    assert np.array_equal(table.outcome == "failed", middle)
    assert np.all(table["outcome"][middle] == "") and np.all(table["unsure"][middle] == 1.0)
    assert all("it divides by zero" in reason for reason in table["reason"][middle])


def test_a_million_cells_need_force_and_name_time_and_disk(tmp_path):
    axes = """"solver.duration_s" = { from = 2.0, to = 6.0, count = 1100 }
"solver.model" = ["rigid", "full"]
"""
    text = "\n".join(line for line in SMALL.splitlines() if not line.startswith('"solver.'))
    text = text.replace("count = 2", "count = 30").replace("count = 5", "count = 20")
    huge = sweep_in(tmp_path, text.replace("[derived]", axes + "[derived]"))
    with pytest.raises(CaseError, match="1320000 cells") as refused:
        check_size(huge, 1, False)
    # half of the cells are of the full model: 660000 x (1 + 4 x 3) s, of which one figure is known
    assert all(words in str(refused.value) for words in ("roughly 2500 h", "GB", "--force"))
    check_size(huge, 1, True)
