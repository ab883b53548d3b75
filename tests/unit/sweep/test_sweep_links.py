"""A sweep over the gap of kerbs, and its answer."""

import csv
import json

import pytest

from fem.batch.axes import AxisError, field_of
from fem.sweep.file import load_sweep
from fem.sweep.run import run_sweep

SWEEP = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"solver.duration_s" = 6.0
"contact.mu_static" = 0.25
"contact.mu_kinetic" = 0.2
"motion.peak_acceleration_m_s2" = 5.0
"stop" = [
    { side = "left", height_m = 0.1, gap_m = 0.0, stiffness_N_m = 1e8, restitution = 0.5 },
    { side = "right", height_m = 0.1, gap_m = 0.0, stiffness_N_m = 1e8, restitution = 0.5 },
]
[axes]
"motion.frequency_Hz" = [0.6, 1.5]
"stop.gap_m" = [0.1, 10.0]
[perturbation]
cells = "none"
"""


def test_a_sweep_over_the_gap_finds_what_the_kerb_causes(tmp_path):
    (tmp_path / "kerb.toml").write_text(SWEEP, encoding="utf-8")
    run_sweep(load_sweep(tmp_path / "kerb.toml"), folder=tmp_path / "out")
    with (tmp_path / "out" / "table.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    outcomes = {(row["motion.frequency_Hz"], row["stop.gap_m"]): row["outcome"] for row in rows}
    assert outcomes["0.6", "0.1"] == "overturned"
    assert outcomes["0.6", "10.0"] == outcomes["1.5", "10.0"] == "slide"
    answer = json.loads((tmp_path / "out" / "sweep.json").read_text())["answer"]
    assert "overturned up to 0.1 m" in answer
    assert "stood in every case tried from 10 m on" in answer


def test_the_shipped_study_of_a_kerb_can_be_read():
    sweep = load_sweep("kerb_gap")
    assert sweep.shape == (20, 14)


def test_the_shipped_study_of_a_neighbour_can_be_read():
    assert load_sweep("neighbour_gap").shape == (2, 20, 10)


def test_a_key_that_no_stop_has_is_no_axis():
    with pytest.raises(AxisError, match="height_m"):
        field_of("stop.heigth_m")
