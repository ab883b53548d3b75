"""Corner castings: what a landing on their inner edges would leave, and the band that takes it."""

import math
from itertools import pairwise

import numpy as np
import pytest
from cases import named_case

from contact.reference.rigid_block import RigidBlock
from fem.case.tables.unknown_inputs import ranges_of
from fem.model.model import build_model
from fem.run.simulation import run_without_history


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


def test_feet_are_at_rest_on_the_points_that_are_least_crushed():
    """The outer points, which rocking crushes most, bear nothing then: the run ends, and does not wait for them."""
    solid = {"container.section": "solid", "container.post_m": None, "container.corner_post_N": None}
    feet = {"support.kind": "feet", "support.foot_m": 0.2, "support.casting_m": None}
    pulse = {"kind": "pulse", "shape": "sine", "pulse_s": 1.0, "peak_acceleration_m_s2": 3.6}
    soft = {"contact.mu_static": 2.0, "contact.mu_kinetic": 2.0, "floor.bearing_strength_Pa": 7e6}
    solver = {"solver.model": "rigid", "solver.duration_s": "auto", "output.fields_s": 0.0}
    keys = {f"motion.{key}": value for key, value in pulse.items()} | solid | feet | soft | solver
    model = build_model(named_case("stack_on_concrete", keys))
    _, error = run_without_history(model, None)
    assert error is None
    assert model.run.old.crushed[0] > 1e-3
    assert model.run.track[0].max_rotation > 0.4 * model.static.slenderness_angle
    assert float(model.run.clock[0].time) < 0.5 * model.duration
