"""Runs of loose stacks: what they write, run again from what they resolved, in a batch, with a band."""

import json
import warnings

import numpy as np
import pytest
from cases import named_case
from interrupted_runs import stored_run

import fem
from fem.case.case import read_case, to_toml
from fem.case.columns import BOXES
from fem.results.history import read_history
from fem.results.reader import open_run
from fem.results.run_result import Verdict
from fem.run.summary import plain_summary

#: three boxes that slide on one another
SLIPPERY = {"container.boxes": 3, "container.joints": "loose", "joints.mu_static": 0.2}
SLIPPERY |= {"motion.kind": "harmonic", "motion.peak_acceleration_m_s2": 5.0, "motion.frequency_Hz": 1.0}
SLIPPERY |= {"solver.model": "rigid", "solver.duration_s": 2.0}
SLIPPERY |= {"output.fields_s": 0.5, "output.figures": False}
KEYS = {"max_rotation_rad", "max_slip_m", "residual_slip_m", "max_opening_m", "fell"}


@pytest.fixture(scope="module")
def case():
    return named_case("least", SLIPPERY)


@pytest.fixture(scope="module")
def run(case):
    return fem.compute(case, band=False)


def test_a_run_says_what_each_box_did(case, run, tmp_path):
    stored = stored_run(case, tmp_path / "run", band=False)
    result = json.loads((tmp_path / "run" / "run.json").read_text())
    verdict = result["verdict"]
    assert [set(box) for box in verdict["boxes"]] == [KEYS] * 3
    assert verdict["fell_box"] is None and not any(box["fell"] for box in verdict["boxes"])
    assert verdict["max_slip_m"] == verdict["boxes"][0]["max_slip_m"]
    assert verdict["residual_slip_m"] == verdict["boxes"][0]["residual_slip_m"]
    assert verdict["boxes"][1]["max_slip_m"] > 0.02  # 5 m/s2 against 0.2 g
    assert verdict["outcome"] == "slide" and "slide" in verdict["modes"]
    assert result["joints"] is None
    assert stored.typed_result.verdict.boxes == run.verdict.boxes
    history = read_history(tmp_path / "run" / "history.csv")
    assert history.joints == 0
    assert history.samples.tobytes() == run.history.samples.tobytes()
    assert history.numbers[-10:] == BOXES.names((2, 3))
    assert abs(history["box_2_slip_m"]).max() == pytest.approx(verdict["boxes"][1]["max_slip_m"], rel=1e-2)
    assert history["box_3_z_m"] == pytest.approx(2.5, abs=1e-3)
    assert set(open_run(tmp_path / "run").fields.frame(0).box.tolist()) == {1, 2, 3}


def test_the_resolved_case_runs_again_to_the_same_result(run):
    again = fem.compute(read_case(to_toml(run.case)), band=False)
    assert again.history.samples.tobytes() == run.history.samples.tobytes()
    assert again.verdict.boxes == run.verdict.boxes


def test_a_box_that_slides_off_its_footing_has_fallen(case):
    strong = {"motion.peak_acceleration_m_s2": 9.0, "contact.mu_static": 2.0}
    off = case.replace(strong | {"joints.mu_static": 0.01})
    run = fem.compute(off.replace({"solver.duration_s": 4.0, "motion.frequency_Hz": 0.5}), band=False)
    assert (run.status, run.verdict.outcome) == ("overturned", "overturned")
    assert run.verdict.fell_box in (2, 3)
    fell = run.verdict.boxes[run.verdict.fell_box - 1]
    assert fell.fell and fell.max_slip_m > 0.5 * run.case.container.width_m
    assert run.history["time_s"][-1] <= run.verdict.overturned_at_s + 0.01


#: a pull that takes the lower box with it, from under the upper one; the `full` model of six elements
PULLED = {
    "container": {
        **{"width_m": 1.1, "height_m": 1.0, "section": "solid", "mass_kg": 2500.0, "joints": "loose"},
        "box": [{}, {"height_m": 0.5, "mass_kg": 800.0, "offset_m": 0.5}],
    },
    "contact": {"mu_static": 2.0},
    "joints": {"mu_static": 0.02},
    "motion": {"kind": "pulse", "shape": "rectangular", "peak_acceleration_m_s2": -12.0, "pulse_s": 0.4},
    "solver": {"model": "full", "element_size_m": 0.5, "order": 1, "duration_s": 1.2},
    "output": {"fields_s": 0.1, "figures": False},
}


def test_a_box_of_nodes_falls_and_its_files_say_so(tmp_path):
    case, folder = fem.case_from(PULLED), tmp_path / "run"
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of the rigid check, whose container is of two pieces
        stored_run(case, folder, band=False, check_rigid=True)
    run = open_run(folder)
    verdict, history = run.verdict, run.history
    assert (verdict.outcome, verdict.fell_box, verdict.boxes[1].fell) == ("overturned", 2, True)
    assert f"{verdict.overturned_at_s:.3f} s" in verdict.first_line
    # it loses its footing beyond the edge, half a width from the axis of the lower box
    assert 0.05 < verdict.boxes[1].max_slip_m < 1.1 and {"slide", "slide-rock"} <= set(verdict.modes)
    # the lower box is pulled with 12 m/s2, more than tips it alone, and lifts a corner by its turn
    turn = verdict.boxes[0].max_rotation_rad
    assert verdict.boxes[0].max_opening_m == pytest.approx(1.1 * np.sin(turn), rel=0.02)
    last = run.fields.frame(len(run.fields) - 2)  # the very last is of the end, between two samples
    upper = np.unique(last.cells[last.box == 2])
    middle = (last.points + last.displacement)[upper].mean(axis=0)
    instant = round(last.time / case.output.history_s)
    place = [history[f"box_2_{axis}_m"][instant] for axis in "xz"]
    assert middle - [last.floor_displacement, 0.0] == pytest.approx(place, abs=5e-3)
    assert "ox 2 fell" in plain_summary(run.typed_result, folder=folder)


def test_friction_regularised_in_velocity_slides_boxes_on_one_another_as_the_elastic_stick_does(case, run):
    creeping = fem.compute(case.replace({"contact.friction": "regularised"}), band=False)
    found, stuck = creeping.verdict.boxes, run.verdict.boxes
    assert found[1].max_slip_m == pytest.approx(stuck[1].max_slip_m, rel=0.02)
    # it never sticks: the uppermost box, which rests on the next, creeps by less than the velocity times the time
    assert 0.0 < found[2].max_slip_m < stuck[2].max_slip_m + 2.0 * case.contact.regularisation_velocity_m_s


def test_a_band_tries_the_friction_between_the_boxes(case):
    kinetic = case.replace({"joints.mu_kinetic": 0.1, "solver.duration_s": 1.0, "uncertainty.draws": 2})
    run = fem.compute(kinetic, band=True, margin=False)
    band = run.verdict.band
    tried = [member for member in band.members if "joints.mu_kinetic" in (member.values or {})]
    assert len(tried) >= 4
    assert all(member.error is None and len(member.boxes) == 3 for member in band.members)
    slips = [member.boxes[1].max_slip_m for member in band.members]
    assert band.boxes[1].max_slip_m == (min(slips), max(slips)) and min(slips) < max(slips)
    assert band.members[0].boxes == run.verdict.boxes
    again = Verdict.from_json(json.loads(json.dumps(run.verdict.to_json())))
    assert again.band.boxes == band.boxes and again.band.members == band.members
