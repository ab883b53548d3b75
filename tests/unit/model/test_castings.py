"""Containers on corner castings, with posts and twistlocks."""

import math

import numpy as np
import pytest

import fem
from fem.case.case import CaseError
from fem.model.floor import slab_of
from fem.model.model import build_model

CASTINGS = "support.casting_m=[0.162, 0.178, 0.0]"


def test_castings_and_posts_say_what_a_corner_bears():
    case = fem.load_case("iso_20ft")
    slab = slab_of(case, case.mass)
    assert slab.patch == (0.162, 0.356)  # two castings behind each other
    assert slab.bearing_capacity == pytest.approx(50e6 * 0.162 * 0.356)
    assert slab.cap == slab.steel_capacity == 2.0 * 848e3  # and not 235 MPa on a sheet of 2 mm
    weaker = case.replace({"floor.bearing_strength_Pa": 1e7})
    assert slab_of(weaker, case.mass).cap == pytest.approx(1e7 * 0.162 * 0.356)


@pytest.mark.parametrize("joints", ["", "_two_loose"])
def test_a_container_rocks_about_castings_that_stand_inside_its_sides(joints):
    inset = 0.1
    model = build_model(
        fem.load_case(f"iso_20ft{joints}", [f"support.casting_m=[0.162, 0.178, {inset}]", "floor.kind=rigid"])
    )
    width = 2.438 - 2.0 * inset
    assert np.ptp(model.run.old.point[:2, 0]) == pytest.approx(width, rel=1e-6)
    assert model.static.slenderness_angle == pytest.approx(
        math.atan(0.5 * width / model.container.mesh.centroid[1]), rel=1e-9
    )


def test_the_bolts_of_locked_containers_have_a_utilisation():
    # the upper box is so narrow that it would fall without them
    case = fem.load_case(
        "iso_20ft_two_locked",
        [
            "container.box=[{width_m = 2.438}, {width_m = 0.8}]",
            "motion.kind=pulse",
            "motion.shape=half-sine",
            "motion.pulse_s=0.5",
            "motion.peak_acceleration_m_s2=12",
            "contact.mu_static=1.0",
            "solver.duration_s=1",
        ],
    )
    (joint,) = fem.compute(case).result["joints"]
    tension = max(joint["bolt_tension_left_N"], joint["bolt_tension_right_N"])
    assert tension > 0.0 and joint["bolt_utilisation"] == pytest.approx(tension / 500e3)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (["support.casting_m=[0.162, 0.178]"], "casting_m"),
        (["support.casting_m=[1.3, 0.178, 0.0]"], "does not fit under the base"),
        (["support.casting_m=[162, 178, 0]"], "looks like millimetres"),
        (["support.kind=flat", CASTINGS], 'belongs to support.kind = "corners"'),
        (["floor.corner_patch_m=[0.1, 0.2]", CASTINGS], "keep one of them"),
        (["container.corner_post_N=0"], "corner_post_N"),
        (["container.joints=loose", "container.boxes=2", "joints.bolt_capacity_N=5e5"], "have no bolts"),
        (
            ["support.casting_m=[0.162, 0.178, 0.1]", "solver.model=full"],
            "the full model bears where its nodes are",
        ),
    ],
)
def test_castings_that_make_no_sense_are_refused(values, says):
    with pytest.raises(CaseError, match=says):
        fem.load_case("iso_20ft", values)
