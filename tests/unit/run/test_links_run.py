"""A run with a stop and a tie, from the case file to its files and sentences."""

import json
import re

import numpy as np
import pytest

import fem
from fem.case.case import CaseError, load_case
from fem.cli.check import check
from fem.model.model import build_model
from fem.run.run import RunOptions, run_case

KEYS = (
    *("solver.model=rigid", "solver.element_size_m=0.5", "solver.order=1", "solver.duration_s=3"),
    *("output.fields_s=0", "output.figures=false"),
    *("contact.mu_static=0.2", "contact.mu_kinetic=0.15", "motion.peak_acceleration_m_s2=6"),
    "stop=[{side = 'right', height_m = 0.1, gap_m = 0.02, stiffness_N_m = 1e8, mu = 0.3}, "
    "{side = 'left', height_m = 0.1, gap_m = 2.0, stiffness_N_m = 1e8}]",
    "tie=[{from = 'left', height_m = 0.5, slack_m = 0.001, stiffness_N_m = 1e6, strength_N = 1e3}]",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("links") / "run"
    case = load_case("rocking", KEYS)
    run_case(case, case_text=case.text, folder=place, options=RunOptions(band=False))
    return place


def test_the_result_holds_forces_hits_and_what_broke(folder):
    found, history = json.loads((folder / "run.json").read_text()), fem.open_run(folder).history
    (kerb, far), (tie,) = found["stops"], found["ties"]
    assert kerb["hits"] > 0
    assert kerb["largest_closing_velocity_m_s"] > 0.0
    assert kerb["gap_left_m"] == 0.0
    assert kerb["broken_at_s"] is None
    assert 0.0 < history["stop_1_force_N"].max() <= kerb["max_force_N"] * (1.0 + 1e-9)
    assert (far["hits"], far["max_force_N"]) == (0, 0.0)
    assert far["gap_left_m"] > 1.0
    assert tie["max_force_N"] == pytest.approx(1e3)
    assert tie["gap_left_m"] is None
    assert not history["tie_1_force_N"][history["time_s"] > tie["broken_at_s"] + 0.01].any()
    # the forces on the container and its inertia: what stands in the history is in balance where no one strikes
    assert np.isfinite(history["slip_m"]).all()


def test_a_tilt_that_overlaps_a_stop_is_refused():
    case = load_case("rocking", [*KEYS, "initial.rotation_rad=0.1", "stop.height_m=1.0"])
    said = r"stop 1: gap_m = 0\.02 m is overlapped by (0\.0\d+) m"
    with pytest.raises(CaseError, match=said) as built:
        build_model(case)
    with pytest.raises(CaseError, match=said) as checked:
        check("rocking", overrides=[*KEYS, "initial.rotation_rad=0.1", "stop.height_m=1.0"])
    first, other = (float(re.search(said, str(one.value)).group(1)) for one in (built, checked))
    assert first == pytest.approx(other, abs=1e-3)
    wide = ["stop.gap_m=0.2", "tie.slack_m=0.2"]
    check("rocking", overrides=[*KEYS, "initial.rotation_rad=0.1", "stop.height_m=1.0", *wide])
