"""Figures and animation of a loose stack, which show every box, and the animation of an elastic container."""

import math
import re

import numpy as np
import pytest

from fem.figures.cache import drawings_of
from fem.model.model import build_model
from fem.report.animation import animation_of


@pytest.fixture
def run(gallery):
    return gallery.run("loose")


def test_each_box_has_a_curve_of_its_rotation_slip_and_opening(run):
    drawings = drawings_of(run, build_model(run.case).container)
    assert all(
        {"box 1", "box 2"} <= set(re.findall(r"box \d", drawings[name].svg))
        for name in ("rotation", "slip", "uplift")
    )
    assert drawings["slip"].title.startswith("Slip of each box") and "box 2" in drawings["slip"].title
    assert "joints" not in drawings


def test_the_animation_moves_the_boxes_as_the_history_does(run):
    shown = animation_of(build_model(run.case), run.fields)
    last = shown.frames[-1]
    instant = round(last.time / run.case.output.history_s)
    lower, upper = run.history["centre_x_m"][instant], run.history["box_2_x_m"][instant]
    assert last.centre[:, 0] - last.floor[0] == pytest.approx([lower, upper], abs=1e-6)
    assert abs(upper - lower) > 1e-3
    turns = [run.history[name][instant] for name in ("rotation_rad", "box_2_rotation_rad")]
    assert last.rotation == pytest.approx(turns, abs=1e-6) and np.abs(last.elastic).max() < 1e-6
    corners = shown.points[shown.corners[1]] + shown.centroid[1]
    assert corners == pytest.approx(
        np.array([[-0.55, 1.0], [0.55, 1.0], [-0.55, 2.0], [0.55, 2.0]]), abs=1e-9
    )


def test_rigid_motion_and_deformation_make_the_frame_of_an_elastic_container(gallery):
    run = gallery.run("default")
    shown, found = animation_of(build_model(run.case), run.fields), run.fields.frame(len(run.fields) - 1)
    last = shown.frames[-1]
    nodes = [np.hypot(*(found.points - place).T).argmin() for place in shown.points + shown.centroid[0]]
    cosine, sine = math.cos(last.rotation[0]), math.sin(last.rotation[0])
    turned = (shown.points + last.elastic) @ np.array([[cosine, -sine], [sine, cosine]])
    places = (found.points + found.displacement)[nodes]
    assert last.centre[0] + turned == pytest.approx(places, abs=1e-6)
    assert last.rotation[0] == pytest.approx(run.history["rotation_rad"][-1], abs=1e-3)
    assert 1e-5 < np.abs(last.elastic).max() < 0.02
