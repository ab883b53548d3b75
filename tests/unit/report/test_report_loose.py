"""The page, the figures and the picture of a loose stack: every box is seen, and the first line says what they did."""

import re

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
