"""A run at the level of its folder: statuses, exit codes, what is kept, what is reproduced, how it ends."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from floors import still_floor
from interrupted_runs import run_command, stored_run
from typed_results import RESULT

import fem.model.equilibrium
import fem.model.step_size
import fem.run.run
import fem.run.verdict
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking
from fem.__main__ import main
from fem.case.case import load_case
from fem.results.history import History, read_history
from fem.results.kinds import read_result
from fem.results.reader import OpenedRun
from fem.run.summary import plain_summary

QUICK = ("solver.model=rigid", "output.fields_s=0", "output.figures=false")
ANGLE = math.atan(1.1 / 4.0)  #: slenderness angle of the shipped stack [rad]


def run(folder: Path, name: str, *overrides: str, **options) -> OpenedRun:
    case = load_case(name, [*QUICK, *overrides])
    return stored_run(case, folder, **{"margin": False} | options)


def command(folder: Path, name: str, *overrides: str) -> int:
    return main([*run_command(name, folder, *QUICK, *overrides), "--no-band"])


def history_of(folder: Path) -> History:
    return read_history(folder / "history.csv")


class TestEnd:
    def test_a_completed_run_leaves_its_files_and_exits_with_0(self, tmp_path, capsys):
        folder = tmp_path / "r"
        assert command(folder, "rocking", "solver.duration_s=2") == 0
        result = read_result(folder / "run.json")
        assert result["status"] == "completed"
        assert result["verdict"]["outcome"] == "slide-rock"
        files = {path.name for path in folder.iterdir()}
        assert {"case.toml", "resolved.toml", "run.json", "summary.txt", "history.csv"} <= files
        brief = capsys.readouterr().out
        assert len(brief.splitlines()) <= 40 and str(folder / "summary.txt") in brief
        again = run_command("rocking", folder, *QUICK, "solver.duration_s=2")
        assert main([*again, "--no-band", "--full"]) == 0
        assert (folder / "summary.txt").read_text() == capsys.readouterr().out
        assert len(history_of(folder).modes) == 401
        assert set(result["versions"]) >= {"python", "numpy", "numba", "unanchored"}

    def test_a_step_that_cannot_be_solved_ends_with_3_and_says_when_and_what_to_try(
        self, tmp_path, monkeypatch, capsys
    ):
        # One step size only, and a tolerance finer than rounding: the first step that fails is the smallest there is.
        monkeypatch.setattr(fem.model.step_size, "SMALLEST_SHARE", 1.0)
        monkeypatch.setattr(fem.model.equilibrium, "POINT_TOLERANCE", 1e-40)
        folder = tmp_path / "r"
        assert command(folder, "free_rocking") == 3
        result = read_result(folder / "run.json")
        assert result["status"] == "failed"
        assert result["verdict"]["outcome"] is None
        assert result["verdict"]["band"] is None
        kept = history_of(folder)
        assert 0.0 < kept["time_s"][-1] < 10.0
        error = result["error"]
        assert error.startswith("step ")
        instant = float(error.split("t = ")[1].split(" s")[0])
        assert kept["time_s"][-1] <= instant <= kept["time_s"][-1] + 0.1
        assert "did not converge at the smallest step (0.005 s)" in error and "softer" in error
        page = capsys.readouterr().out
        assert "No verdict:" in page and "did not overturn" not in page

    def test_an_energy_balance_beyond_its_limits_fails_the_run_which_has_no_checks_then(
        self, tmp_path, monkeypatch
    ):
        monkeypatch.setattr(fem.run.verdict, "GAIN_LIMIT", -1.0)
        found = run(tmp_path / "r", "rocking", "solver.duration_s=1", check_rigid=True, band=True)
        assert found.status == "failed"
        assert "of the energy to overturn" in found.result["error"]
        assert "solver.step_s" in found.result["error"]
        assert found.result["verdict"]["outcome"] is None
        assert found.result["verdict"]["band"] is None
        assert "rigid_check" not in found.result


class TestAftermath:
    def test_a_container_left_beyond_its_slenderness_angle_is_followed_until_it_falls(self, tmp_path):
        # Released at rest a little beyond the unstable balance, the run over long before it is down; the rigid
        # block's own equation of motion says when it is.
        start = 1.06 * ANGLE
        folder = tmp_path / "r"
        leaning = (f"initial.rotation_rad={start!r}", "solver.duration_s=0.2")
        found = run(folder, "free_rocking", *leaning, band=False)
        block = RigidBlock.homogeneous(width=1.1, height=4.0)
        falls_at = simulate_rocking(block, still_floor(), duration=20.0, rotation=start).overturned_at
        assert falls_at > 1.5
        assert found.status == "overturned"
        assert found.result["verdict"]["overturned_at_s"] == pytest.approx(falls_at, rel=2e-3)
        assert history_of(folder)["time_s"][-1] > 2.0

    def test_one_that_comes_back_is_followed_until_it_has_on_a_floor_that_stands_still(self, tmp_path):
        initial = (f"initial.rotation_rad={1.06 * ANGLE!r}", "initial.angular_velocity_rad_s=-0.2")
        found = run(tmp_path / "back", "free_rocking", *initial, "solver.duration_s=0.02", band=False)
        assert (found.status, found.result["verdict"]["outcome"]) == ("completed", "rock")
        history = history_of(tmp_path / "back")
        assert history["time_s"][-1] > 0.02
        assert abs(history["rotation_rad"][-1]) < ANGLE
        falls = run(tmp_path / "falls", "overturning", "solver.duration_s=1.5", band=False)
        assert falls.status == "overturned"
        history = history_of(tmp_path / "falls")
        after = history["time_s"] > 1.5 + 1e-9
        assert after.sum() > 5
        assert np.ptp(history["base_velocity_m_s"][after]) == 0.0
        assert not history["base_acceleration_m_s2"][after].any()

    def test_a_run_that_is_not_to_stop_continues_with_the_container_on_its_side(self, tmp_path):
        folder = tmp_path / "r"
        # a slab crushes under the upper edge
        lying = ("floor.kind=rigid", "output.stop_when_overturned=false")
        found = run(folder, "overturning", *lying, "solver.duration_s=4", band=False)
        assert found.status == "overturned"
        history = history_of(folder)
        assert history["time_s"][-1] == pytest.approx(4.0)
        assert found.result["verdict"]["overturned_at_s"] < 3.0
        assert history.modes[-1] == "overturned"
        # On its side the mass centre is half a width above the floor.
        assert abs(history["rotation_rad"][-1]) == pytest.approx(0.5 * math.pi, abs=0.1)
        assert history["centre_z_m"][-1] == pytest.approx(0.55, abs=0.1)


class TestAgain:
    def test_a_finished_run_is_not_computed_again_unless_forced(self, tmp_path, monkeypatch, capsys):
        folder = tmp_path / "r"
        run(folder, "rocking", "solver.duration_s=1", band=False)
        before = (folder / "run.json").read_bytes()
        (folder / "history.csv").write_text("unchanged")
        monkeypatch.setattr(fem.run.run, "discretise", lambda *_: pytest.fail("set up again"))
        words = run_command("rocking", folder, *QUICK, "solver.duration_s=1")
        assert main([*(word for word in words if word != "-q"), "--no-band"]) == 0
        assert "--force" in "".join(capsys.readouterr())
        assert (folder / "run.json").read_bytes() == before
        assert (folder / "history.csv").read_text() == "unchanged"
        monkeypatch.undo()
        run(folder, "rocking", "solver.duration_s=1", force=True, band=False)
        assert len(history_of(folder).modes) == 201


class TestChecks:
    def test_what_a_finished_run_lacks_is_added_without_computing_it_again(self, tmp_path):
        folder = tmp_path / "r"
        first = run(folder, "rocking", "solver.duration_s=2", band=False)
        assert "rigid_check" not in first.result
        written = (folder / "history.csv").read_text().splitlines()
        again = run(folder, "rocking", "solver.duration_s=2", check_rigid=True, band=True)
        beside = (folder / "history.csv").read_text().splitlines()
        # the block's rotation, and nothing else
        assert [line.rpartition(",")[0] for line in beside] == written
        assert again.result["numerics"] == first.result["numerics"]  # the band does not count as stepping
        kept = json.loads((folder / "run.json").read_text())
        assert kept["verdict"]["band"]["outcomes"] == again.result["verdict"]["band"]["outcomes"]
        assert kept["rigid_check"]["reference"] == "rigid block that does not slide"
        assert kept["wall_s"] == first.result["wall_s"]
        assert (folder / "rigid_check.csv").is_file()


@pytest.mark.parametrize("name", ["short", "a folder with words", "long-" * 40])
def test_summary_says_what_to_open_with_unbroken_paths(tmp_path, name):
    folder = tmp_path / name
    (folder / "fields").mkdir(parents=True)
    (folder / "fields" / "run.pvd").write_text("")
    text = plain_summary(RESULT, folder=folder)
    for file in ("fields/run.pvd", "history.csv", "run.json"):
        assert str(folder / file) in text
