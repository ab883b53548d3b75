"""The response of the paper's stack, as `python -m fem response` gives it, against the analytic block.

Period-3 motions were found by a separate event-driven program from 120 random states at each of five frequencies.
"""

import csv
import json
import math

import pytest
from floors import sine_floor
from runs import BLOCK

from contact.reference.rocking import simulate_rocking
from fem.__main__ import main

pytestmark = pytest.mark.slow
PEAK = 4.0  #: of the floor, held [m/s2]
#: frequency -> rotation ratio of the motion of period 3
PERIOD_3 = {1.2: 0.465, 1.5: 0.341, 1.8: 0.259, 2.1: 0.201, 2.4: 0.160}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("response") / "r"
    assert main(["response", "--out", str(place), "-q"]) == 0
    return place


@pytest.fixture(scope="module")
def result(folder):
    return json.loads((folder / "response.json").read_text())


@pytest.fixture(scope="module")
def sections(folder):
    """The last section of each motion, by way and frequency."""
    with (folder / "sections.csv").open() as file:
        rows = list(csv.DictReader(file))
    return {(row["direction"], round(float(row["frequency_Hz"]), 6)): row for row in rows}


def rotation_of_block(frequency, section, periods):
    """Largest rotation of the analytic block over its slenderness angle, begun from a section."""
    omega = 2.0 * math.pi * frequency
    exact = simulate_rocking(
        BLOCK,
        sine_floor(amplitude=PEAK / omega**2, angular_frequency=omega, phase=0.5 * math.pi),
        duration=periods / frequency,
        rotation=float(section["rotation_rad"]),
        angular_velocity=float(section["angular_velocity_rad_s"]),
    )
    late = [abs(peak.rotation) for peak in exact.peaks if peak.time > 0.5 * periods / frequency]
    return max(late) / BLOCK.slenderness_angle


def test_every_point_is_valid_or_overturned_with_a_reason(result):
    for point in result["points"]:
        assert point["status"] in ("completed", "overturned") and point["motion"] != "invalid"
        assert point["long_time"] == "periodic" or "overturned in period" in point["reason"]


def test_rotations_are_those_of_the_analytic_block(result, sections):
    standing = [point for point in result["points"] if point["direction"] == "down" and point["long_time"]]
    for point in standing[::3][:8]:
        section = sections["down", round(point["frequency_Hz"], 6)]
        exact = rotation_of_block(point["frequency_Hz"], section, 12)
        assert point["rotation_ratio"] == pytest.approx(exact, rel=0.01)
    assert len(standing[::3]) >= 8


def test_motions_of_period_three_are_found_beside_the_curve(result, sections):
    for frequency, ratio in PERIOD_3.items():
        at = min(result["frequencies"], key=lambda one: abs(one["frequency_Hz"] - frequency))
        largest, curve = at["motions"][0], at["motions"][-1]
        assert largest["period_n"] == 3 and largest["ways"] == [] and curve["ways"] == ["up", "down"]
        # at a frequency up to 0.3 % beside
        assert largest["rotation_ratio"] == pytest.approx(ratio, rel=0.015)
        section = sections["start", round(at["frequency_Hz"], 6)]
        exact = rotation_of_block(at["frequency_Hz"], section, 24)
        assert largest["rotation_ratio"] == pytest.approx(exact, rel=0.01)
