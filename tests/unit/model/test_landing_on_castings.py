"""Corner castings: what a landing on their inner edges would leave, and the band that takes it."""

import math
from itertools import pairwise

import numpy as np
import pytest
from cases import named_case

from contact.reference.rigid_block import RigidBlock
from fem.case.case import CaseError
from fem.case.tables.unknown_inputs import ranges_of


@pytest.mark.parametrize("length", [0.05, 0.2, 0.4])
def test_a_plate_is_landed_on_at_its_inner_edge_and_rolled_over(length):
    # one impact after the other, each about a point a little further out: (J + x1 x2)/(J + x2^2)
    block = RigidBlock(half_width=0.55, centroid_height=2.0, gravity=9.81)
    middle = block.inertia_ratio * block.radius**2 - 0.55**2
    places = [-0.55, *np.linspace(0.55 - length, 0.55, 20_001)]
    steps = [(middle + a * b) / (middle + b * b) for a, b in pairwise(places)]
    assert block.restitution_on_plates(length) == pytest.approx(math.prod(steps), abs=1e-5)
    assert block.restitution_on_plates(0.0) == pytest.approx(block.housner_restitution)


def test_the_band_takes_the_restitution_up_to_that_of_plates():
    restitution = "contact.restitution_over_housner"
    solid = {"floor.kind": "rigid", "container.wall_m": None, "container.section": "solid"}
    # at a width equal to the height plates leave 2.1 times Housner's velocity, and the key takes at most twice
    for width, most in ((0.8, None), (1.1, 2.0)):
        box = named_case("seed_box", solid | {"container.width_m": width})
        ends = {one.key: one.ends for one in ranges_of(box, 1e9)}
        block = RigidBlock(half_width=0.5 * width, centroid_height=0.5, gravity=9.81)
        plates = block.restitution_on_plates(0.2) / block.housner_restitution
        assert most is None or plates > most
        assert ends[restitution][1] == pytest.approx(most or plates)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("support.casting_bears", "plate"),
        ("support.casting_tilt_m", 5e-4),
        ("uncertainty.casting_tilt_m", [0.0, 1e-3]),
    ],
)
def test_how_castings_bear_is_no_key_any_more(key, value):
    with pytest.raises(CaseError, match=f"{key.partition('.')[2]} ' is no longer there; castings "):
        named_case("seed_stack_plateau", {key: value})
