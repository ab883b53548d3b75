"""The report of a run: whole, self-contained, honest about what is missing, and its refusals."""

import re

import pytest

from fem.__main__ import main
from fem.case import read_case
from fem.opening import open_run
from fem.report.run_page import Signature, run_report
from fem.run import run_case

HOSTILE = "</title><script>alert(1)</script> & co"
CASE = f"""
schema = 1
title = "{HOSTILE}"
[container]
width_m = 1.1
height_m = 1.0
boxes = 4
weight_N = 24525.0
wall_m = 0.008
[contact]
mu_static = 0.4
[motion]
kind = "harmonic"
peak_acceleration_m_s2 = 4.0
angular_frequency_rad_s = 6.928
[solver]
duration_s = 1.2
element_size_m = 0.5
order = 1
elastic_modes = 4
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A short run of the shell stack."""
    place = tmp_path_factory.mktemp("report") / "stack"
    run_case(read_case(CASE, name="stack"), case_text=CASE, folder=place)
    return place


@pytest.fixture(scope="module")
def page(folder):
    return run_report(open_run(folder), signature=Signature(author="A. Author <a@b>"))


def sections(page):
    return re.findall(r'<h2 id="([a-z-]+)"', page)


def test_the_page_has_every_part_in_the_order_of_reading(page):
    assert sections(page) == [
        "verdict-title",
        "asked",
        "assumptions",
        "static",
        "motion-title",
        "variations",
        "modes",
        "block",
        "joints",
        "sheet",
        "numerics",
        "provenance",
    ]
    assert page.index("Result: ") < page.index("What was asked")


def test_the_page_loads_nothing_and_fits_into_a_mail(page):
    assert len(page.encode()) < 5_000_000
    assert not re.search(r"""(?:src|href)=["'](?!#|data:,["'])""", page)
    assert "@import" not in page
    assert not re.search(r"url\((?!#)", page)


def test_names_from_the_case_stay_text(page):
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert(1)" in page
    assert 'value="A. Author &lt;a@b&gt;"' in page


def test_the_case_in_the_page_is_the_one_that_was_run(page, folder):
    text = re.search(r"<pre class=\"case\">(.*?)</pre>", page, re.DOTALL)[1]
    for escaped, sign in (("&lt;", "<"), ("&gt;", ">"), ("&#34;", '"'), ("&amp;", "&")):
        text = text.replace(escaped, sign)
    assert read_case(text).resolved() == open_run(folder).case.resolved()


def test_variations_are_kept_beside_the_run(folder, page):
    said = []
    assert (folder / "variations.json").is_file()
    run_report(open_run(folder), told=said.append)
    assert said == []


class TestRefusals:
    def test_a_folder_that_is_not_there(self, tmp_path, capsys):
        assert main(["report", str(tmp_path / "nothing")]) == 2
        assert "no such folder" in capsys.readouterr().err

    def test_a_folder_without_a_run(self, tmp_path, capsys):
        assert main(["report", str(tmp_path)]) == 2
        assert "run.json" in capsys.readouterr().err

    def test_a_damaged_study(self, tmp_path, capsys):
        (tmp_path / "study.json").write_text('{"groups": 3}')
        assert main(["report", str(tmp_path)]) == 2
        assert "not the result of a study" in capsys.readouterr().err
