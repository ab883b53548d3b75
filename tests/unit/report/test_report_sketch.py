"""The sketch and the words of a case: every box as it is given."""

import re

import pytest
from cases import named_case

from fem.model.floor_numbers import drawn_level
from fem.report.sketch import sketch

LOOSE = {"container.joints": "loose", "joints.mu_static": 0.3, "joints.mu_kinetic": 0.25}


def words_of(name, values=None):
    """Texts and name of a sketch."""
    svg = sketch(named_case(name, values), centroid=1.3, peak_acceleration=2.4)
    return re.findall(r">([^<>]+)</text>", svg), re.search(r'aria-label="([^"]*)"', svg)[1]


def test_equal_boxes_have_one_height_and_no_numbers():
    texts, name = words_of("seed_stack_plateau")
    assert "4 × c = 4 × 1 m" in texts
    assert not {"1", "2", "3", "4"} & set(texts)
    assert "4 bolted boxes" in name


def test_boxes_that_differ_are_numbered_and_their_heights_added_up():
    texts, name = words_of("uneven")
    assert {"1", "2", "3"} <= set(texts)
    assert "1 + 0.8 + 1 = 2.8 m" in texts
    # from -0.6 m, the left side of the upper box, to 0.7 m
    assert "3 bolted boxes, 1.3 m wide and 2.8 m high" in name


@pytest.mark.parametrize(("percent", "words"), [(2.0, "falls 2 % →"), (-1.5, "← falls 1.5 %")])
def test_a_floor_that_slopes_is_drawn_level_and_says_how_it_falls(percent, words):
    assert words in words_of("seed_stack", {"floor.slope_percent": percent})[0]
    assert drawn_level(percent).startswith(f"the floor falls {abs(percent):g} % to the ")
    assert not any("falls" in text for text in words_of("seed_stack")[0]) and drawn_level(0.0) == ""


def test_loose_joints_are_marked_with_their_friction():
    texts, name = words_of("seed_stack_plateau", LOOSE)
    assert "loose, μ 0.3 / 0.25" in texts and {"1", "2", "3", "4"} <= set(texts)
    assert "4 loose boxes" in name


HELD = {
    "stop": [
        {"side": side, "height_m": 0.1, "gap_m": 0.1, "stiffness_N_m": 1e8} for side in ("left", "right")
    ],
    "tie": [{"from": "left", "height_m": 0.5, "stiffness_N_m": 1e6}],
}


def test_stops_and_ties_are_drawn():
    free, held = named_case("seed_stack_plateau"), named_case("seed_stack_plateau", HELD)
    drawings = [str(sketch(case, centroid=2.0, peak_acceleration=4.0)) for case in (free, held)]
    assert "2 stops, 1 tie" in drawings[1]
    assert drawings[1].count("<path") > drawings[0].count("<path")
