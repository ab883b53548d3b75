"""The page of a verification at a site."""

import re
from dataclasses import replace

import pytest
from browser import CHROMIUM, FAINT, Browser
from markupsafe import Markup
from site_answers import brief_page
from site_example import example, write_example

from fem.html.units import formula_markup
from fem.results.errors import FolderError
from fem.site.page import site_report
from fem.site.result import RESULT_FILE


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("sites")
    write_example(place / "fulfilled")
    (place / "fulfilled" / "report.html").write_text(site_report(place / "fulfilled"), encoding="utf-8")
    return place / "fulfilled"


def words_of(page: str) -> str:
    """The text of a page, without its styles, scripts and drawings."""
    body = re.sub(r"<(style|script|svg)\b.*?</\1>", " ", page, flags=re.S)
    return " ".join(Markup(body).striptags().split())


def test_the_answer_has_its_colour():
    doubted = brief_page('answer="not sure", fulfilled=None, reasons=("A limit lies between.",)')
    assert 'class="answer open"' in doubted and 'class="answer open"' not in brief_page("")


def test_every_motion_run_and_method_is_on_the_page(folder):
    page, (result, _) = (folder / "report.html").read_text(encoding="utf-8"), example()
    regions = page.count('aria-label="motion ')
    outcomes = page.count("<td>slide</td>") + page.count("<td>rest</td>")
    # a drawing with its region for each, and the table motion by motion
    assert regions == 2 * 7 + 1
    # in the appendix those that move, and where it governs; the outcome of the confirmed run and over its inputs
    assert outcomes == 56 + 14 + 2
    assert {name for motion in result.set.motions for name in motion.sha256 if name not in page} == set()
    assert {row.name for row in result.methods if row.name.split(",")[0] not in words_of(page)} == set()


def test_a_page_is_green_and_signed_where_somebody_stands_for_every_input(folder):
    for unstated in ((), ("source of friction",)):
        result, _ = example()
        doubted = replace(result, inputs=replace(result.inputs, unstated=unstated))
        page = site_report(folder, doubted, brief=True)
        assert ('class="sign"' in page, 'class="answer stood"' in page) == (not unstated, not unstated)
        assert ("nobody vouches for source of friction" in words_of(page)) is bool(unstated)


@pytest.mark.parametrize("text", [None, "{", '{"status": "completed"}'])
def test_a_result_that_is_missing_or_damaged_is_told(tmp_path, text):
    if text is not None:
        (tmp_path / RESULT_FILE).write_text(text, encoding="utf-8")
    with pytest.raises(FolderError, match=r"assess\.json"):
        site_report(tmp_path)


def test_formulas_are_set():
    for text, expected in {
        "λ a_up ≤ g b/h": "<i>λ</i> <i>a</i><sub>up</sub> ≤ <i>g</i> <i>b</i>/<i>h</i>",
        "max(3, x) r^−4 cm/s": "max(3, <i>x</i>) <i>r</i><sup>−4</sup> cm/s",
        "0.9 G/γ_μ": "0.9 <i>G</i>/<i>γ</i><sub>μ</sub>",
        "r < 2π cos α": "<i>r</i> &lt; 2π cos <i>α</i>",
    }.items():
        assert formula_markup(text) == expected
    assert formula_markup("a peak of a_g <b>", prose=True) == "a peak of <i>a</i><sub>g</sub> &lt;b&gt;"


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium: apt-get install chromium")
def test_the_page_works_in_a_browser_on_a_desk_on_a_telephone_and_on_paper(folder, tmp_path):
    with Browser(tmp_path) as browser:
        for width in (1280, 390):
            browser.window(width, 900)
            browser.open(folder / "report.html")
            assert [browser.errors, len(browser.requests)] == [[], 1]
            assert browser.evaluate("document.documentElement.scrollWidth") <= width
            assert browser.evaluate(FAINT) == []
            clauses = "[...document.querySelectorAll('td.note')].map((cell) => cell.clientWidth)"
            assert min(browser.evaluate(clauses)) >= 100  # no column of single letters
        paper = browser.pdf()
        assert re.search(rb"/MediaBox ?\[0 0 59[45][.\d]* 84[12][.\d]*\]", paper)
