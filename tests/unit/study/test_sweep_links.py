"""A sweep over the gap of kerbs, and its answer."""

import csv
import json

import pytest

from fem.study.file import load_sweep
from fem.study.sweep import run_sweep

ROW = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"solver.duration_s" = 4.0
"contact.mu_static" = 0.6
"contact.mu_kinetic" = 0.6
"motion.kind" = "pulse"
"motion.shape" = "rectangular"
"motion.pulse_s" = 0.8
"neighbour" = [{ side = "right", gap_m = 1.0, stiffness_N_m = 1e8, width_m = 0.5, mu = 0.2 }]
"stop" = [{ side = "left", height_m = 0.1, gap_m = 0.05, stiffness_N_m = 1e8, strength_N = 1.0 }]
[axes]
"motion.peak_acceleration_m_s2" = [0.5, 1.6, 2.2]
[perturbation]
cells = "none"
"""


def test_the_table_of_a_row_says_who_overturned_and_what_its_links_carried(tmp_path):
    (tmp_path / "row.toml").write_text(ROW, encoding="utf-8")
    run_sweep(load_sweep(tmp_path / "row.toml"), folder=tmp_path / "out")
    with (tmp_path / "out" / "table.csv").open(newline="") as stream:
        still, weak, strong = csv.DictReader(stream)
    assert still["row_outcomes"] == "rest, rest" and still["fell_in_row"] == ""
    assert [float(still[key]) for key in ("stop_force_N", "neighbour_force_N", "link_hits")] == [0.0] * 3
    assert 0.0 < float(still["link_slack_m"]) <= 0.05
    assert weak["row_outcomes"] == "rock, overturned" and weak["fell_in_row"] == "neighbour 1"
    assert strong["fell_in_row"] == "container" and strong["link_broken_at_s"]
    # what breaks at 1 N carries no more
    assert float(strong["stop_force_N"]) == pytest.approx(1.0) and float(strong["link_velocity_m_s"]) > 0.0
    answer = json.loads((tmp_path / "out" / "sweep.json").read_text())["answer"]
    assert "first overturned at 0.163 g (first to overturn: neighbour 1, slip there" in answer
