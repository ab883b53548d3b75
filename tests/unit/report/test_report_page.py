"""The report of a run: whole, self-contained, honest about what is missing; what moves in it, loose boxes, too."""

import html
import json
import math
import re
import shutil

import numpy as np
import pytest

from fem.case.case import read_case
from fem.figures.cache import drawings_of
from fem.html.units import typeset
from fem.model.model import build_model
from fem.report.animation import animation_of
from fem.report.run_page import Signature, run_report
from fem.results.reader import open_run


@pytest.fixture(scope="module")
def folder(gallery):
    """A short run of the shell stack."""
    return gallery("default")


@pytest.fixture(scope="module")
def page(folder):
    return run_report(open_run(folder), signature=Signature(author="A. Author <a@b>"))


def test_the_page_loads_nothing_and_fits_into_a_mail(page):
    assert len(page.encode()) < 5_000_000
    assert not re.search(r"""(?:src|href)=["'](?!#|data:,["'])""", page)
    assert "@import" not in page
    assert not re.search(r"url\((?!#)", page)


def test_the_case_in_the_page_is_the_one_that_was_run(page, folder):
    text = re.search(r"<pre class=\"case\">(.*?)</pre>", page, re.DOTALL)[1]
    assert read_case(html.unescape(text)).resolved() == open_run(folder).case.resolved()


def test_the_animation_of_a_rigid_run_has_no_stress(gallery):
    run = gallery.run("rigid")
    shown = animation_of(build_model(run.case), run.fields)
    assert shown.stress_scale == shown.largest_stress == 0.0
    assert shown.frames[0].von_mises is None and len(shown.frames) == 13


def test_a_run_of_which_no_input_was_varied_is_not_called_sure(folder, tmp_path):
    copied = shutil.copytree(folder, tmp_path / "copied")
    result = json.loads((copied / "run.json").read_text())
    own, *others = result["verdict"]["band"]["members"]
    tighter = [member for member in others if "solver.energy_tolerance" in member["values"]]
    result["verdict"]["band"]["members"], result["verdict"]["sure"] = [own, *tighter], "sure"
    (copied / "run.json").write_text(json.dumps(result))
    page = run_report(open_run(copied), brief=True)
    assert "No input was varied" in page and "no input varied" in page and ">sure<" not in page
    (copied / "run.json").write_text(json.dumps(result | {"status": "interrupted"}))
    assert 'id="signature"' in page and 'id="signature"' not in run_report(open_run(copied), brief=True)


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("192.2, -184.3 mm", "192.2, −184.3 mm"),
        ("6.5e-05 of it, 172 m/s2", "6.5 × 10⁻⁵ of it, 172 m/s²"),
        ("2.5e+06 N (-3)", "2.5 × 10⁶ N (−3)"),
        ("nu = 0.2; 0.2 x 0.4 m: sinks in by 1.1 um", "ν = 0.2; 0.2 × 0.4 m: sinks in by 1.1 µm"),
        ("EN 1998-1:2004, 2026-11-21, slide-rock", "EN 1998-1:2004, 2026-11-21, slide-rock"),
    ],
)
def test_lines_of_the_summary_are_typeset_in_the_page(line, shown):
    assert typeset(line) == shown


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
    places = np.array([[-0.55, 1.0], [0.55, 1.0], [-0.55, 2.0], [0.55, 2.0]])
    assert corners == pytest.approx(places, abs=1e-9)


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
