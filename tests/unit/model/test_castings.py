"""Containers on corner castings, with posts and twistlocks: what bears, what a landing on inner edges leaves."""

import math
from itertools import pairwise

import numpy as np
import pytest
from cases import named_case
from runs import pulse

import fem
from contact.reference.rigid_block import RigidBlock
from fem.case.case import CaseError
from fem.case.tables.unknown_inputs import ranges_of
from fem.model.container import discretise
from fem.model.floor import slab_of
from fem.model.model import build_model
from fem.model.peaks import counted_nodes
from fem.run.simulation import run_without_history


def test_castings_and_posts_say_what_a_corner_bears():
    case = fem.load_case("iso_20ft")
    slab = slab_of(case, case.mass)
    assert slab.patch == (0.162, 0.356)  # two castings behind each other
    assert slab.bearing_capacity == pytest.approx(50e6 * 0.162 * 0.356)
    assert slab.cap == slab.steel_capacity == 2.0 * 848e3  # and not 235 MPa on a sheet of 2 mm
    weaker = case.replace({"floor.bearing_strength_Pa": 1e7})
    assert slab_of(weaker, case.mass).cap == pytest.approx(1e7 * 0.162 * 0.356)


def test_the_strength_of_posts_follows_from_their_section_unless_it_is_given():
    # EN 10210-2, 120 x 8: 35.2 cm2; of S355 1250 kN
    case = fem.load_case("rocking")
    assert slab_of(case, case.mass).cap == pytest.approx(2.0 * 35.2e-4 * 355e6, rel=2e-3)
    given = case.replace({"container.corner_post_N": 900e3})
    assert slab_of(given, case.mass).cap == 2.0 * 900e3
    flat = case.replace({"support.kind": "flat"})  # their section stays, but no corner stands on them
    assert slab_of(flat, case.mass).steel_capacity is None and flat.container.post_m == (0.12, 0.008)
    wall = case.replace({"floor.corner_patch_m": [0.008, 1.1]})  # which bears then
    assert slab_of(wall, case.mass).steel_capacity == pytest.approx(235e6 * 0.008 * 1.1)
    weak = case.replace({"container.post_m": [0.12, 1e-4]})
    with pytest.raises(CaseError, match="post_m: a corner must carry"):
        build_model(weak)


def test_the_stress_beyond_the_castings_does_not_depend_on_the_mesh():
    stresses, peaks = [], []
    for size in (0.1, 0.05):
        case = fem.load_case("rocking", [f"solver.element_size_m={size}"])
        container = discretise(case)
        pushed = container.elements.nodal_von_mises(1e6 * container.response.displacement[-1])
        counted = counted_nodes(case, container.elements)
        stresses.append(pushed[counted].max())
        peaks.append(pushed.max())
        corner = np.abs(container.elements.nodes[counted] - [0.55, 0.0]).max(axis=1)
        assert corner.min() == pytest.approx(0.2, abs=0.06) and corner.min() > 0.199
    assert stresses[0] == pytest.approx(stresses[1], rel=0.02)
    assert min(peaks) > 5.0 * max(stresses)


@pytest.mark.parametrize("joints", ["", "_two_loose"])
def test_a_container_rocks_about_castings_that_stand_inside_its_sides(joints):
    inset = 0.1
    keys = [f"support.casting_m=[0.162, 0.178, {inset}]", "floor.kind=rigid"]
    model = build_model(fem.load_case(f"iso_20ft{joints}", keys))
    width = 2.438 - 2.0 * inset
    assert np.ptp(model.run.old.point[:2, 0]) == pytest.approx(width, rel=1e-6)
    angle = math.atan(0.5 * width / model.container.mesh.centroid[1])
    assert model.static.slenderness_angle == pytest.approx(angle, rel=1e-9)


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
    soft = {"contact.mu_static": 2.0, "contact.mu_kinetic": 2.0, "floor.bearing_strength_Pa": 7e6}
    solver = {"solver.model": "rigid", "solver.duration_s": "auto", "output.fields_s": 0.0}
    keys = pulse(3.6, 1.0, "sine") | solid | feet | soft | solver
    model = build_model(named_case("stack_on_concrete", keys))
    _, error = run_without_history(model, None)
    assert error is None
    assert model.run.old.crushed[0] > 1e-3
    assert model.run.track[0].max_rotation > 0.4 * model.static.slenderness_angle
    assert float(model.run.clock[0].time) < 0.5 * model.duration
