"""Many cases on all cores, in processes, in memory, on a cluster: each is the run alone, whatever runs beside it."""

import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from textwrap import dedent
from types import SimpleNamespace

import pytest
from case_rows import run_cases
from small_sweep import SMALL, rows_without_wall
from worker_tasks import end_the_process, hear_the_group_end, held_back, who_works

import fem
import fem.study.runner as many
from fem.__main__ import main
from fem.case.case import CaseError, load_case
from fem.case.overrides import parse_override
from fem.model.model import build_model
from fem.model.recovery import recovery_of
from fem.results.figures import SCALARS
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.run.verdict import verdict_of
from fem.runtime.progress import Reporter
from fem.study.containers import ContainerCache, container_key
from fem.study.design import CaseMaker
from fem.study.workers import LocalWorkers, WorkersLostError, hand_out

UNITS = {"s": 1, "min": 60, "h": 3600}
SHORT = ["solver.duration_s=2", "output.fields_s=0"]
CHANGES = (
    {"solver.model": "rigid"},
    {"solver.model": "rigid", "motion.peak_acceleration_m_s2": 9.0, "motion.angular_frequency_rad_s": 2.0},
    {"solver.model": "rigid", "contact.mu_static": 0.25},
    {"solver.model": "rigid", "container.boxes": 2},
    {"solver.model": "reduced"},
)


@pytest.fixture(scope="module")
def cases():
    base = load_case("seed_stack_plateau", SHORT)
    return [base.with_values(change) for change in CHANGES]


def without_wall(rows):
    return [{name: value for name, value in row.items() if name != "wall_s"} for row in rows]


def test_a_row_is_the_verdict_of_its_case(cases):
    for case, row in zip(cases[-2:], run_cases(cases[-2:], jobs=2), strict=True):
        model = build_model(case)
        recorder = Recorder(model, recovery_of(model))
        ending = simulate(model, recorder)
        stress = None if case.solver.model == "rigid" else recorder.largest_von_mises
        verdict = verdict_of(model, recorder.history(), stress)
        assert row["status"] == ending.status
        assert {name: row[name] for name in SCALARS} == {name: getattr(verdict, name) for name in SCALARS}


def test_processes_give_the_rows_that_threads_give(cases, monkeypatch):
    few = [case for case in cases if case.solver.model == "rigid"]
    assert len(few) > 1
    threads = run_cases(few, jobs=2)
    monkeypatch.setattr("fem.study.workers.WORTH_PROCESSES", {"rigid": 2, "reduced": 2})
    monkeypatch.setattr("fem.study.runner.CASES_AT_A_TIME", {"rigid": 1, "reduced": 1})
    assert without_wall(run_cases(few, jobs=2)) == without_wall(threads)


def test_a_process_that_dies_ends_the_work_with_a_word():
    with pytest.raises(WorkersLostError, match="a worker process died"), LocalWorkers(2) as workers_of:
        list(hand_out(range(4), end_the_process, workers_of("full", 4), at_a_time=1))


def test_workers_that_end_with_the_job_are_not_lost():
    with LocalWorkers(2) as workers_of:
        found = list(hand_out(range(4), hear_the_group_end, workers_of("full", 4), at_a_time=1))
        assert sorted(item for chunk, _ in found for item in chunk) == list(range(4))
    asked = iter([False] * 4)
    with LocalWorkers(2) as workers_of:
        pools = workers_of("full", 4)
        assert (
            list(hand_out(range(4), end_the_process, pools, at_a_time=1, stop=lambda: next(asked, True)))
            == []
        )


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_what_ends_the_group_does_not_meet_a_worker_that_is_starting():
    """Else its interpreter would print a traceback of its imports."""
    with LocalWorkers(2) as workers_of:
        found = list(hand_out(range(2), held_back, workers_of("full", 2), at_a_time=1))
    assert all(held >= {signal.SIGINT, signal.SIGTERM} for _, held in found)
    assert held_back([]).isdisjoint({signal.SIGINT, signal.SIGTERM})


def test_a_stop_ends_the_handing_out():
    stopped = []
    with LocalWorkers(1) as workers_of:
        items = hand_out(
            range(100), who_works, workers_of("rigid", 100), at_a_time=10, stop=lambda: bool(stopped)
        )
        reached = []
        for chunk, _ in items:
            reached += chunk
            stopped.append(True)
    assert reached == list(range(len(reached)))
    assert 10 <= len(reached) <= 20


OF_A_CASE = """
contact.mu_static=0.3 floor.slope_percent=1.0 initial.rotation_rad=0.01 output.history_s=0.01
container.damping_ratio=0.1 support.effective_width=0.98 gravity_m_s2=9.0 container.mass_kg=2000.0
container.centroid_m=0.49 support.kind=flat solver.element_size_m=0.3 solver.order=1 output.stop_when_overturned=false
"""
A_STOP = {"stop": [{"side": "right", "height_m": 0.1, "gap_m": 0.05, "stiffness_N_m": 1e8}]}


@pytest.mark.parametrize("change", [*(dict([parse_override(one)]) for one in OF_A_CASE.split()), A_STOP])
def test_a_container_is_taken_again_where_its_key_is_the_same_and_nowhere_else(change):
    cache, base = ContainerCache(), load_case("seed_stack_plateau", [*SHORT, "solver.model=rigid"])
    changed = CaseMaker(base)(change) if "." in next(iter(change)) else base.with_values(change)
    same = container_key(changed) == container_key(base)
    first = cache.container_of(base)
    assert (cache.container_of(changed) is first) == same
    assert cache.container_of(base) is first


def test_cases_that_differ_in_material_damping_share_their_container():
    # mean-axis modes do not depend on damping; without its own damping a row would be that of the case before
    shell = load_case("rocking", ["solver.element_size_m=0.5", "solver.duration_s=2"])
    ratios = (0.0, 0.02, 0.5)
    cases = [shell.with_values({"container.damping_ratio": ratio}) for ratio in ratios]
    assert len({container_key(case) for case in cases}) == 1
    turned = [row["rotation_ratio"] for row in run_cases(cases, jobs=1)]
    assert len(set(turned)) == len(ratios)


POOLS = dedent(
    """
    import os, sys, threading
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    from fem.study import workers

    def told():
        return getattr(workers, "told", "nothing"), os.getpid() == int(os.environ["PARENT"])

    if __name__ == "__main__":
        os.environ["PARENT"] = str(os.getpid())
        workers.told = "before the start"
        if "beside" in sys.argv:
            threading.Thread(target=threading.Event().wait, daemon=True).start()
        with workers.LocalWorkers(2) as workers_of:
            pools = workers_of("rigid", int(sys.argv[1]))
            print([(*pool.executor.submit(told).result(), pool.count) for pool in pools])
    """
)
BESIDE = ("before the start", True)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere no process is forked")
@pytest.mark.parametrize(
    ("count", "beside", "workers"),
    [
        ("64", [], [("before the start", False, 1), (*BESIDE, 1)]),
        ("64", ["beside"], [(*BESIDE, 2)]),
        pytest.param("2000", ["beside"], [("nothing", False, 1), (*BESIDE, 1)], marks=pytest.mark.slow),
    ],
)
def test_a_process_without_other_threads_is_forked_for_few_cases(tmp_path, count, beside, workers):
    """A new process would take a second or two, and know nothing of what this one has set."""
    script = tmp_path / "script.py"
    script.write_text(POOLS, encoding="utf-8")
    command = [sys.executable, str(script), count, *beside]
    ended = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    assert ended.stdout.strip() == str(workers)


ROOT = Path(__file__).parents[3]
BOX = fem.load_case("seed_box", ["solver.model=rigid", "solver.duration_s=0.5", "output.fields_s=0"])
FRICTIONS = (0.2, 0.3, 0.4)
TIMES = {"wall_s", "cpu_s", "compile_s", "numerics"}

SCRIPT = """
import fem

print("begun")
case = fem.load_case("seed_box", ["solver.model=rigid", "solver.duration_s=0.5", "output.fields_s=0"])


def compute():
    cases = [case.replace({"contact.mu_static": mu}) for mu in (0.2, 0.3)]
    print([run.verdict.outcome for run in fem.compute_many(cases, jobs=2, band=False)])

"""


def figures(run):
    return {key: value for key, value in run.result.items() if key not in TIMES}


def test_each_run_is_the_run_alone_in_the_order_of_the_cases():
    cases = [BOX.replace({"contact.mu_static": mu}) for mu in FRICTIONS]
    cases.insert(1, BOX.replace({"container.width_m": 0.9}))  # of another container
    runs = fem.compute_many(cases, band=False)
    assert [run.case.contact.mu_static for run in runs] == [0.2, 0.4, 0.3, 0.4]
    for case, run in zip(cases, runs, strict=True):
        alone = fem.compute(case, band=False)
        assert figures(run) == figures(alone)
        assert (run.history.samples == alone.history.samples).all()


def test_a_case_that_cannot_be_computed_is_named():
    with pytest.raises(CaseError) as refused:
        fem.compute_many([BOX, BOX.replace({"solver.step_s": 0.5})], band=False)
    assert refused.value.__notes__ == ["case 2 of 2 of compute_many"]
    with pytest.raises(ValueError, match="jobs must be at least 1, got 0"):
        fem.compute_many([BOX], jobs=0)
    assert fem.compute_many([]) == []


#: its walls weigh more than the box; no mesh can be made of it
TOO_LIGHT = BOX.replace({"container.wall_m": 0.05, "container.mass_kg": 900.0})


def test_all_cases_are_looked_at_before_the_first_is_computed(monkeypatch):
    words = "computed before the last case was looked at"
    monkeypatch.setattr(many, "compute_on", lambda *_: pytest.fail(words))
    with pytest.raises(ValueError, match="walls and posts of one box weigh") as refused:
        fem.compute_many([BOX, TOO_LIGHT], 1, band=False)
    assert refused.value.__notes__ == ["case 2 of 2 of compute_many"]


def test_errors_may_be_returned_in_place_of_runs():
    late = BOX.replace({"solver.step_s": 0.5})  # refused by the model alone
    found = fem.compute_many([TOO_LIGHT, BOX, late], 1, band=False, errors="return")
    assert [isinstance(one, ValueError) for one in found] == [True, False, True]
    assert figures(found[1]) == figures(fem.compute(BOX, band=False))
    assert found[2].__notes__ == ["case 3 of 3 of compute_many"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("call", "warned"), [("compute()", True), ('if __name__ == "__main__":\n    compute()', False)]
)
def test_a_script_without_a_guard_is_told_so_and_does_not_start_itself_again(tmp_path, call, warned):
    (tmp_path / "study.py").write_text(SCRIPT + call + "\n", encoding="utf-8")
    command, environment = [sys.executable, "study.py"], os.environ | {"PYTHONPATH": str(ROOT)}
    found = subprocess.run(
        command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=300
    )
    assert found.stdout == "begun\n['slide', 'rest']\n" and "Traceback" not in found.stderr
    assert found.stderr.count('UserWarning: study.py lacks `if __name__ == "__main__":`') == warned


@pytest.fixture(scope="module")
def address():
    distributed = pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
    options = {"n_workers": 1, "threads_per_worker": 2, "processes": False, "dashboard_address": None}
    with distributed.LocalCluster(protocol="tcp", host="127.0.0.1", **options) as local:
        yield local.scheduler_address


@pytest.mark.slow
def test_a_cluster_gives_the_same_table(tmp_path, monkeypatch, capsys, address, undrawn):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.toml").write_text(SMALL, encoding="utf-8")
    assert main(["sweep", "small.toml", "-q", "--scheduler", address]) == 0
    assert main(["sweep", "small.toml", "-q", "--out", "here"]) == 0
    assert rows_without_wall(tmp_path / "outputs" / "small") == rows_without_wall(tmp_path / "here")
    capsys.readouterr()


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_reported_within_seconds(tmp_path, monkeypatch, capsys):
    pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
    monkeypatch.chdir(tmp_path)
    with socket.socket() as silent:  # listens, and says nothing
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        began = time.monotonic()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        assert main(["sweep", "outcome_map", "--scheduler", address]) == 2
        assert time.monotonic() - began < 30.0
    message = capsys.readouterr().err
    assert f"--scheduler {address}: no answer within 5 s" in message
    assert "leave --scheduler out" in message
    assert main(["sweep", "outcome_map", "--scheduler", "nonsense"]) == 2
    assert not (tmp_path / "outputs").exists()


def test_the_time_left_holds_though_the_last_runs_take_ten_times_as_long(monkeypatch):
    # From the first runs alone, it would be five times too low. The clock is that of the runs.
    clock, told = [0.0], []
    monkeypatch.setattr(many, "time", SimpleNamespace(perf_counter=lambda: clock[0]))

    class Listening(Reporter):
        def tell(self, line):
            told.append((clock[0], line()))

    def work(make, numbers):
        rows = [{"status": "", "wall_s": 10.0 if number >= 400 else 1.0} for number in numbers]
        clock[0] += sum(row["wall_s"] for row in rows)
        return rows

    with LocalWorkers(1) as workers_of:
        runner = many.Runner(workers_of=workers_of, reporter=Listening())
        list(runner.rows("runs", range(800), float, lambda number: "rigid", work))
    assert len(told) > 40
    for now, line in told:
        words = re.search(r"[^,]*(?= left)", line)
        left, rest = (
            sum(int(n) * UNITS[unit] for n, unit in re.findall(r"(\d+) (\w+)", words[0])),
            clock[0] - now,
        )
        assert now < 200.0 or rest < 400.0 or 0.5 < left / rest < 2.0, line
