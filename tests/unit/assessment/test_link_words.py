"""Words of stops, ties and neighbours."""

from dataclasses import replace

import pytest

import fem
from fem.assessment.link_rows import link_rows
from fem.assessment.link_words import links_in_words
from fem.assessment.margin_words import margin_in_words
from fem.assessment.ranges import in_words
from fem.results.run_result import LinkResult, Margin, NeighbourResult, RunResult, Verdict

NEIGHBOUR = {"side": "right", "gap_m": 0.05, "stiffness_N_m": 1e8, "mu": 0.3, "boxes": 2}
STOP = {"side": "left", "height_m": 0.1, "gap_m": 0.02, "stiffness_N_m": 1e8, "strength_N": 5e5}
TIE = {"from": "left", "height_m": 0.5, "stiffness_N_m": 1e6}


def test_each_stop_tie_and_neighbour_of_a_case_is_described():
    held = fem.load_case("seed_box", ["solver.model=rigid"]).with_values({"stop": [STOP], "tie": [TIE]})
    assert link_rows(held) == [
        ("stop", "on the left at 0.1 m, gap 20 mm, 100000 kN/m, breaks at 500 kN"),
        ("tie", "on the left from 0.5 m down to the floor, slack 0 mm, 1000 kN/m"),
    ]
    row = fem.load_case("seed_stack_plateau", ["solver.model=rigid"]).with_values({"neighbour": [NEIGHBOUR]})
    assert link_rows(row) == [
        ("neighbour", "on the right, gap 50 mm, 1.1 x 2 m, 5000 kg, 2 boxes, 100000 kN/m, friction 0.3")
    ]


def test_what_stops_and_ties_did_is_said_of_each():
    hit = LinkResult(side="left", height_m=0.1, max_force_N=2e5, hits=2, largest_closing_velocity_m_s=0.5)
    missed = replace(hit, max_force_N=0.0, hits=0, largest_closing_velocity_m_s=0.0, gap_left_m=0.0123)
    held = replace(hit, neighbour=2, broken_at_s=1.5)
    assert links_in_words(RunResult(status="completed", stops=(hit, missed), ties=(missed, held))) == (
        "the stop on the left at 0.1 m was hit 2 times, at 0.5 m/s at most, with up to 200 kN; the stop on the left at "
        "0.1 m was not touched, 12.3 mm of the gap was left; the tie on the left at 0.1 m stayed slack, 12.3 mm of "
        "the slack was left; the tie of neighbour 2 on the left at 0.1 m carried up to 200 kN, and broke at t = 1.500 s"
    )


def test_a_force_on_what_is_struck_is_said_to_be_that_of_its_spring_and_dashpot():
    struck = RunResult(
        status="completed", verdict=Verdict(stop_force_N=6.76e6, tie_force_N=18.1e3, link_hits=1)
    )
    words = [in_words(struck, key) for key in ("stop_force_N", "tie_force_N", "neighbour_force_N")]
    assert words == [
        "6760 kN; of spring and dashpot, not for design unless both are known",
        "18.1 kN",
        "",
    ]
    missed = RunResult(status="completed", verdict=Verdict(stop_force_N=0.0))
    assert in_words(missed, "stop_force_N") == "0 kN"


BESIDE = NeighbourResult(
    side="right",
    outcome="slide-rock",
    max_rotation_rad=0.06,
    rotation_ratio=0.2394,
    max_slip_m=0.0234,
    residual_slip_m=0.02,
    max_uplift_m=0.05,
    hits=22,
    max_force_N=232e3,
    largest_closing_velocity_m_s=0.89,
    gap_left_m=0.0,
)


def test_a_neighbour_is_said_to_have_done_what_it_did():
    assert links_in_words(RunResult(status="completed", verdict=Verdict(neighbours=(BESIDE,)))) == (
        "neighbour 1 on the right slid and rocked, rotation ratio 0.239, slip 23.4 mm, hit 22 times, at 0.89 m/s at "
        "most, with up to 232 kN"
    )


@pytest.mark.parametrize(
    ("force", "subject"),
    [(None, "the container alone"), (2e5, "the container alone, without stops,")],
)
def test_beside_the_margin_of_a_row_stands_that_of_the_container_alone(force, subject):
    margin = Margin(factor=1.5, stands_up_to=1.4, least_tried=0.2, largest_tried=4.0, runs=9)
    margin = replace(margin, factor_without_links=2.0, without_links_tried_to=4.0)
    row = Verdict(outcome="rock", margin=margin, neighbours=(BESIDE,), stop_force_N=force)
    assert margin_in_words(row) == (
        f"Stands; one of the row overturns first at 1.50 times this motion; {subject} overturns first at 2.00."
    )
