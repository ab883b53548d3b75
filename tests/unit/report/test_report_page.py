"""The report of a run: whole, self-contained, honest about what is missing, and its refusals."""

import html
import json
import re
import shutil

import pytest

from fem.case.case import read_case
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
