"""The explorer of a sweep: its page, and how it answers in a browser."""

import base64
import json
import re

import numpy as np
import pytest
from browser import CHROMIUM, Browser
from small_sweep import sweep_in

import fem
from fem.report.explorer import explorer
from fem.study.sweep import run_sweep
from fem.study.sweep_table import open_sweep

SWEEP = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"solver.duration_s" = 4.0
[axes]
"contact.mu_static" = [0.2, 0.4]
"motion.peak_acceleration_m_s2" = [2.4, 4.0, 9.0]
[derived]
"contact.mu_kinetic" = "contact.mu_static / 2"
[perturbation]
cells = "all"
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    place = tmp_path_factory.mktemp("explorer")
    sweep = sweep_in(place, SWEEP, "boxes")
    run_sweep(sweep, place / "boxes", jobs=1)
    page = place / "explorer.html"
    page.write_text(explorer(sweep, place / "boxes", 1), encoding="utf-8")
    return sweep, page


def test_the_page_holds_the_motion_and_the_outcome_of_every_cell(made):
    sweep, page = made
    data = json.loads(re.search(r'id="explorer">(.*?)</script>', page.read_text(encoding="utf-8"))[1])
    table = open_sweep(page.parent / "boxes")
    outcomes = np.frombuffer(base64.b64decode(data["outcome"]), dtype="u1")
    assert [data["outcomes"][k]["label"] for k in outcomes] == list(table.outcome)
    packed = data["motion"]["rotation"]
    values = np.frombuffer(base64.b64decode(packed["values"]), dtype="<i2")
    rotation = values.reshape(sweep.count, data["samples"]) * packed["largest"] / 32767
    for cell in range(sweep.count):
        run = fem.compute(sweep.make.case(sweep.item(cell)), band=False, margin=False)
        times = np.linspace(0.0, run.history["time_s"][-1], data["samples"])
        own = np.interp(times, run.history["time_s"], run.history["rotation_rad"])
        assert np.abs(rotation[cell] - own).max() <= 0.51 * packed["largest"] / 32767
        assert data["cells"][cell]["first"] == run.verdict.first_line
    assert [axis["marks"] for axis in data["axes"]] == [[1], [0, 1]]  # the paper's


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium: apt-get install chromium")
def test_sliders_and_keys_choose_cells_and_the_motion_plays(made, tmp_path):
    _, page = made
    with Browser(tmp_path / "profile") as browser:
        browser.window(390, 844)  # a phone
        browser.open(page)
        said = "document.getElementById('first').textContent"
        assert browser.evaluate("location.hash") == "#cell=4"  # the paper's friction and plateau
        assert "stands" in browser.evaluate(said)
        assert browser.evaluate("document.documentElement.scrollWidth") <= 390
        browser.evaluate("document.getElementById('axis-1').focus()")
        browser.press("ArrowRight", 39)
        browser.wait("location.hash === '#cell=5'")
        assert browser.evaluate(said) == browser.evaluate("JSON.parse(explorer.textContent).cells[5].first")
        before = browser.evaluate("stage.toDataURL()")
        browser.click("#play")
        browser.wait("parseFloat(document.getElementById('clock').textContent) > 0.4")
        assert browser.evaluate("stage.toDataURL()") != before
        browser.click("#paper")
        assert browser.evaluate("location.hash") == "#cell=4"
        assert (browser.errors, [one for one in browser.requests if not one.startswith("file:")]) == ([], [])
