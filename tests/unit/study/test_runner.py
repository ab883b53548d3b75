"""A list of cases on all cores: each row is the run of its case, whatever runs beside it."""

import signal
import sys

import pytest
from case_rows import run_cases
from worker_tasks import end_the_process, hear_the_group_end, held_back, who_works

from fem.case.case import load_case
from fem.model.model import build_model
from fem.model.recovery import recovery_of
from fem.results.figures import SCALARS
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.run.verdict import verdict_of
from fem.study.containers import ContainerCache, container_key
from fem.study.design import CaseMaker
from fem.study.workers import LocalWorkers, WorkersLostError, hand_out

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


def test_rows_come_in_the_order_of_the_cases_whatever_the_jobs(cases):
    one = run_cases(cases, jobs=1)
    assert without_wall(one) == without_wall(run_cases(cases, jobs=2))
    assert without_wall(one[::-1]) == without_wall(run_cases(cases[::-1], jobs=2))
    assert [row["outcome"] for row in one[:2]] == ["rock", "overturned"]


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


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("contact.mu_static", 0.3),
        ("floor.slope_percent", 1.0),
        ("initial.rotation_rad", 0.01),
        ("output.history_s", 0.01),
        ("container.damping_ratio", 0.1),
        ("support.effective_width", 0.98),
        ("gravity_m_s2", 9.0),
        ("container.mass_kg", 2000.0),
        ("container.centroid_m", 0.49),
        ("support.kind", "flat"),
        ("solver.element_size_m", 0.3),
        ("solver.order", 1),
        ("output.stop_when_overturned", False),
        ("stop", [{"side": "right", "height_m": 0.1, "gap_m": 0.05, "stiffness_N_m": 1e8}]),
    ],
)
def test_a_container_is_taken_again_where_its_key_is_the_same_and_nowhere_else(key, value):
    cache, base = ContainerCache(), load_case("seed_stack_plateau", [*SHORT, "solver.model=rigid"])
    changed = CaseMaker(base)({key: value}) if "." in key else base.with_values({key: value})
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
