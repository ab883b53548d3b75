"""A row of containers as a run: the fall of a neighbour is not taken for one of the container itself."""

from dataclasses import replace

import pytest

import fem
from fem.model.geometry import build_container
from fem.model.model import build_model
from fem.model.motion import build_motions
from fem.run.compute import resolve
from fem.run.described import governing
from fem.run.summary import run_found

SQUAT = {
    "container": {"width_m": 4.0, "height_m": 1.5, "depth_m": 1.1, "mass_kg": 1e4},
    "contact": {"mu_static": 3.0},
    "motion": {"kind": "pulse", "shape": "rectangular", "peak_acceleration_m_s2": 2.5, "pulse_s": 1.2},
    "solver": {"model": "rigid", "duration_s": 6.0},
    "neighbour": [
        {
            "side": "right",
            "gap_m": 3.0,
            "stiffness_N_m": 1e8,
            "width_m": 0.4,
            "height_m": 3.0,
            "mass_kg": 2000.0,
        }
        | {"centroid_m": 1.5}
    ],
}


@pytest.fixture(scope="module")
def fallen():
    return fem.compute(fem.case_from(SQUAT), band=False, margin=True)


def test_what_falls_is_named_and_the_container_is_compared_with_its_own_rule(fallen):
    assert fallen.verdict.outcome == "overturned"
    assert fallen.verdict.neighbours[0].outcome == "overturned" and fallen.verdict.rotation_ratio < 0.001
    leant = replace(fallen.verdict, rotation_ratio=4.9)
    assert "ratio < 0.001" in run_found(fallen.verdict, "overturning")
    assert "ratio 4.9" in run_found(leant, "overturning")
    assert governing(fallen.typed_result) == []


def test_the_margin_begins_below_what_the_most_slender_of_the_row_bears(fallen):
    margin = fallen.verdict.margin
    assert margin.least_tried < 0.4 / 3.0 * 9.81 / 2.5  # its static limit over the peak
    assert margin.factor is not None and 0.5 < margin.factor < 1.0
    assert margin.factor_without_links is None and margin.without_links_tried_to == 4.0


def test_the_rigid_floor_of_a_row_is_one_whichever_of_its_containers_is_the_first():
    def penalties(case):
        equilibrium = build_model(case).equilibrium
        return [one.penalty for one in equilibrium.row or (equilibrium,)]

    first = fem.case_from(
        SQUAT
    )  # its neighbour is slender, and sinks too far into a floor that is soft enough for it
    names = ("width_m", "height_m", "mass_kg", "centroid_m")
    other = first.with_values({f"container.{name}": SQUAT["neighbour"][0][name] for name in names})
    beside = dict(SQUAT["neighbour"][0], width_m=4.0, height_m=1.5, mass_kg=1e4, centroid_m=0.75)
    row_of_other = other.with_values({"neighbour": [beside]})
    alone = [penalties(case.with_values({"neighbour": []}))[0] for case in (first, other)]
    assert alone[0] < 0.2 * alone[1]
    for row in (first, row_of_other):
        resolved = resolve(row, build_container(row), build_motions(row))
        assert penalties(row) == penalties(resolved) == [max(alone)] * 2
