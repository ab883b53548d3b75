"""Words of stops, ties and neighbours."""

import fem
from fem.assessment.link_rows import link_rows
from fem.assessment.link_words import links_in_words
from fem.results.run_result import NeighbourResult, RunResult, Verdict

NEIGHBOUR = {"side": "right", "gap_m": 0.05, "stiffness_N_m": 1e8, "mu": 0.3, "boxes": 2}
STOP = {"side": "left", "height_m": 0.1, "gap_m": 0.02, "stiffness_N_m": 1e8, "strength_N": 5e5}
TIE = {"from": "left", "height_m": 0.5, "stiffness_N_m": 1e6}


def test_each_stop_tie_and_neighbour_of_a_case_is_described():
    held = fem.load_case("seed_box", ["solver.model=rigid"]).with_values({"stop": [STOP], "tie": [TIE]})
    assert link_rows(held) == [
        ("stop", "on the left at 0.1 m, gap 20 mm, 1e+05 kN/m, breaks at 500 kN"),
        ("tie", "on the left from 0.5 m down to the floor, slack 0 mm, 1000 kN/m"),
    ]
    row = fem.load_case("seed_stack_plateau", ["solver.model=rigid"]).with_values({"neighbour": [NEIGHBOUR]})
    assert link_rows(row) == [
        ("neighbour", "on the right, gap 50 mm, 1.1 x 2 m, 5000 kg, 2 boxes, 1e+05 kN/m, friction 0.3")
    ]


def test_a_neighbour_is_said_to_have_done_what_it_did():
    one = NeighbourResult(
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
    assert links_in_words(RunResult(status="completed", verdict=Verdict(neighbours=(one,)))) == (
        "neighbour 1 on the right slid and rocked, rotation ratio 0.239, slip 23.4 mm, hit 22 times, at 0.89 m/s at "
        "most, with up to 232 kN"
    )
