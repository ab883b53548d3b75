"""A response curve in its folder: tables, figures; stopped or killed it continues to the same bytes."""

import json

import pytest
from small_sweep import rows_of

from contact.stepping.body import CENTRE_Z, ROTATION
from fem.__main__ import main
from fem.case.case import load_case
from fem.model.container import discretise
from fem.model.model import build_model
from fem.report.study_page import response_report
from fem.response.orbit import carry_drive
from fem.response.request import ResponseRequest
from fem.response.run import computed, plan_of, run_response
from fem.runtime.progress import Reporter

CHANGES = ("solver.model=rigid", "contact.mu_static=1", "contact.mu_kinetic=1", "solver.element_size_m=1")


def request_of(*changes, **values):
    case = load_case("seed_stack_plateau", [*CHANGES, *changes])
    chosen = {"first_Hz": 0.6, "last_Hz": 1.4, "count": 3, "settle": 6, "observe": 8} | values
    return ResponseRequest(case=case, **chosen)


def test_what_is_held_is_what_the_case_states():
    assert request_of("motion.peak_acceleration_m_s2=4").held == "acceleration"
    assert request_of("motion.amplitude_m=0.05").held == "displacement"
    held = request_of("motion.amplitude_m=0.05", hold="acceleration")
    assert held.held_value == pytest.approx(0.05 * 6.928**2)


def test_the_command_writes_its_tables_and_figures(tmp_path, capsys):
    line = ["response", "seed_stack_plateau", "--from", "0.9", "--to", "1.1", "--count", "2", "--json", "-q"]
    line += ["--settle", "4", "--observe", "8", "--starts", "2", "--shell", "--out", str(tmp_path / "r")]
    for change in CHANGES:
        line += ["--set", change]
    assert main(line) == 0
    result = json.loads(capsys.readouterr().out)
    assert result == json.loads((tmp_path / "r" / "response.json").read_text())
    rows = rows_of(tmp_path / "r" / "response.csv")
    assert [row["direction"] for row in rows] == ["up", "up", "down", "down"]
    for row, point in zip(rows, result["points"], strict=True):
        assert float(row["rotation_ratio"]) == point["rotation_ratio"]
    assert len(rows_of(tmp_path / "r" / "sections.csv")) >= 4 * 8
    for name, models in (("starts", {"rigid"}), ("shell", {"reduced"})):
        assert {row["model"] for row in rows_of(tmp_path / "r" / f"{name}.csv")} == models
    names = {path.name for path in (tmp_path / "r" / "figures").iterdir()}
    assert names == {"response_curve.svg", "portraits.svg"}


CRUSHING = (
    "floor.corner_patch_m=[0.008, 1.1]",
    "floor.bearing_strength_Pa=2e7",
    "motion.peak_acceleration_m_s2=6",
)


def test_each_frequency_begins_on_a_floor_that_is_whole(tmp_path):
    case = load_case("stack_on_concrete", [*CHANGES, "motion.peak_acceleration_m_s2=3.2"])
    container, before, depths = discretise(case), None, []
    request = ResponseRequest(case=case, first_Hz=1.2, last_Hz=2.0, count=3, settle=6, observe=8)
    for task in plan_of(request)[:3]:
        if before is not None:
            depths.append(float(before.run.old.crushed.max()))
            carried = carry_drive(request.case_at(task.number), container, before).run.old
            assert not carried.crushed.any() and carried.pose[ROTATION] == before.run.old.pose[ROTATION]
            deepest = int(before.run.old.crushed.argmax())
            assert carried.point[deepest, 1] == before.run.old.point[deepest, 1]
            rise = carried.pose[CENTRE_Z] - before.run.old.pose[CENTRE_Z]
            assert rise == pytest.approx(depths[-1], abs=1e-12)
        control = build_model(case, container).run.problem.control
        (point,), before = computed(request, container, task, [], before, control)
        assert point.row.status == "completed" and point.row.reason is None  # the energy balance closes
    assert min(depths) > 1e-5


def test_after_a_destroyed_corner_the_next_frequency_begins_anew(tmp_path):
    case = load_case("stack_on_concrete", [*CHANGES, *CRUSHING])
    request = ResponseRequest(case=case, first_Hz=1.4, last_Hz=1.8, count=3, settle=6, observe=8, starts=1)
    result = run_response(request, folder=tmp_path / "r")
    assert {(point.motion, point.began) for point in result.points} == {("invalid", "case")}
    assert all("crushed by more than" in point.reason for point in result.points)
    assert all(point.rotation_ratio is None for point in result.points)
    assert "not valid at every frequency tried, 1.4 to 1.8 Hz: a corner is destroyed" in result.answer
    drawn = (tmp_path / "r" / "figures" / "response_curve.svg").read_text()
    assert "up: a corner destroyed" in drawn and not (tmp_path / "r" / "figures" / "portraits.svg").exists()
    assert "What lasts" in response_report(tmp_path / "r")


SLIPPING = (
    *("solver.model=rigid", "solver.element_size_m=1"),
    *("contact.mu_static=0.3", "contact.mu_kinetic=0.15", "contact.weakening_m=0.005"),
)


class Killing(Reporter):
    """Ends the curve at its so-manieth period."""

    def __init__(self, periods):
        self.periods = periods

    def update(self, time, rotation_ratio, mode):
        self.periods -= 1
        if self.periods == 0:
            raise KeyboardInterrupt


def files_of(folder):
    return {
        path.name: path.read_bytes() for path in folder.rglob("*") if path.suffix in (".csv", ".json", ".svg")
    }


@pytest.mark.usefixtures("undrawn")
def test_a_slipping_curve_killed_again_and_again_continues_to_the_same_bytes(tmp_path):
    case = load_case("seed_stack_plateau", SLIPPING)
    asked = ResponseRequest(case=case, first_Hz=0.8, last_Hz=2.0, count=3, settle=4, observe=8, starts=2)
    points = run_response(asked, folder=tmp_path / "whole")["points"]
    assert max(point["slip_stroke_m"] for point in points) > 0.01  # it breaks loose
    killed = 0
    while killed < 30:
        try:
            run_response(asked, folder=tmp_path / "killed", resume=True, reporter=Killing(90))
            break
        except KeyboardInterrupt:
            killed += 1
    assert 2 <= killed < 30
    assert files_of(tmp_path / "killed") == files_of(tmp_path / "whole")
