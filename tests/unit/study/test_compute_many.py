"""Many runs in memory: each is the run alone, whoever computed it, and no script starts itself again."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import fem
import fem.study.runner as many
from fem.case.case import CaseError

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
    monkeypatch.setattr(
        many, "compute_on", lambda *_: pytest.fail("computed before the last case was looked at")
    )
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
