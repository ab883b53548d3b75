"""A case computed in memory is the run of the command line: the same result, samples and fields, and no file."""

import json

import numpy as np
import pytest
from interrupted_runs import stored_run, without_times
from study_folders import ensemble_folder

import fem
from fem.results.errors import FolderError
from fem.results.fields import FieldError
from fem.results.run_result import Verdict

ROCKING = ("solver.model=rigid", "solver.duration_s=1", "output.fields_s=0.25", "output.figures=false")
STACK = ("solver.duration_s=0.5", "output.fields_s=0.1", "output.figures=false")


@pytest.mark.parametrize(
    ("name", "overrides", "checks"),
    [
        ("free_rocking", ROCKING, {}),  # with its rigid check, and its band
        ("seed_stack_plateau", STACK, {"band": False}),
        ("seed_box", (*STACK, "solver.model=rigid"), {"band": False, "check_rigid": True}),
    ],
)
def test_a_run_in_memory_is_that_of_the_command(tmp_path, monkeypatch, name, overrides, checks):
    case = fem.load_case(name, overrides)
    # the analytic block is for the summary of the command
    stored = stored_run(case, tmp_path / "r", analytic=False, **checks)
    monkeypatch.chdir(tmp_path)
    run = fem.compute(case, **checks)
    assert [path.name for path in tmp_path.iterdir()] == ["r"]
    assert without_times(json.loads(json.dumps(run.result))) == without_times(stored.result)
    assert run.verdict == stored.verdict
    assert (run.status, run.case.resolved()) == (stored.status, stored.case.resolved())
    assert run.history.numbers == stored.history.numbers
    assert (run.history.samples.view(np.int64) == stored.history.samples.view(np.int64)).all()
    assert run.history.modes == stored.history.modes
    assert run.fields.times.tolist() == stored.fields.times.tolist()
    for kept, read in zip(run.fields, stored.fields, strict=True):
        for field in ("points", "cells", "region", "displacement", "velocity", "contact_pressure"):
            assert (getattr(kept, field) == getattr(read, field)).all()
        assert kept.floor_displacement == read.floor_displacement
        assert (kept.von_mises is None) == (read.von_mises is None)
    time = float(run.fields.times[1])
    assert (run.grid(time).points == stored.grid(time).points).all()


def test_what_a_run_in_memory_offers():
    run = fem.compute(fem.load_case("free_rocking", ROCKING), band=False)
    assert repr(run) == "<run 'free_rocking': completed, rock>"
    shown = Verdict(card=("Stands at < 2 & more.", "Margin."))._repr_html_()
    assert shown == "Stands at &lt; 2 &amp; more.<br>Margin." and run.verdict.card[0] in run._repr_html_()
    assert run.verdict["outcome"] == run.verdict.outcome == run.result["verdict"]["outcome"] == "rock"
    assert run.history["rotation_rad"].dtype == np.float64
    with pytest.raises(KeyError, match="no key 'outcomes'; known: outcome, max_rotation_rad"):
        run.verdict["outcomes"]
    with pytest.raises(FieldError, match="frames lie from 0 to 1 s, not at 7 s"):
        run.grid(7.0)
    assert "slip" in run.plot("slip").texts[0].get_text().lower()
    axes = run.plot("rotation").axes[0]
    assert run.plot("slip", ax=axes) is axes.figure and axes.get_ylabel() == "slip [mm]"
    assert run.history.units["rotation_rad"] == "rad"
    without = fem.compute(run.case.replace({"output.fields_s": 0.0}), band=False)
    assert len(without.fields) == 0
    with pytest.raises(ValueError, match=r"there are no frames; compute the case with output\.fields_s > 0"):
        without.frame(0.0)


def test_what_is_chosen_for_auto_is_no_change_of_the_user():
    changes = ["solver.model=rigid", "solver.duration_s=0.5"]
    case = fem.load_case("rocking", changes)
    result = fem.compute(case, band=False, margin=False).result
    assert case.solver.step_s == case.output.fields_s == "auto"
    assert result["overrides"] == changes
    unchanged = fem.load_case("overturning")
    assert fem.compute(unchanged, band=False, margin=False).result.get("overrides") is None


@pytest.mark.parametrize(
    ("every", "times"), [(0.3, [0.0, 0.3, 0.6, 0.9, 1.0]), (0.25, [0.0, 0.25, 0.5, 0.75, 1.0])]
)
def test_the_last_instant_of_a_run_has_a_frame(every, times):
    run = fem.compute(fem.load_case("rocking", ROCKING).replace({"output.fields_s": every}), band=False)
    assert run.fields.times.tolist() == times
    last, moved = run.frame(1.0), run.history["centre_x_m"][-1] - run.history["centre_x_m"][0]
    assert np.mean(last.displacement[:, 0]) - last.floor_displacement == pytest.approx(moved, abs=0.02)


def test_a_folder_of_a_study_opens_as_its_table(tmp_path):
    table = fem.open_run(ensemble_folder(tmp_path / "counted"))
    strengths = table["motion.peak_acceleration_m_s2"]
    assert strengths.dtype == np.float64 and (np.diff(strengths) > 0.0).all()
    assert (table["overturned"] <= table["draws"]).all() and table["region"].dtype.kind == "U"
    assert table.result["ensemble"] and f"{len(strengths)} rows" in repr(table)
    assert table._repr_html_().count("<tr>") == len(strengths)
    damaged = ensemble_folder(tmp_path / "damaged", points=[1, 2])
    with pytest.raises(FolderError, match=r"ensemble\.json: damaged"):
        fem.open_run(damaged)
