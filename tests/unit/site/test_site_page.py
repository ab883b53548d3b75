"""The page of a verification at a site."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from browser import CHROMIUM, FAINT, Browser
from markupsafe import Markup
from site_example import example, write_example

from fem.cli.assess import page_of as lines_of
from fem.html.formula import formula_markup
from fem.html.page import Page, html_of
from fem.results.errors import FolderError
from fem.results.files import to_json
from fem.site.figures import draw_spectra
from fem.site.page import shown, site_report
from fem.site.result import RESULT_FILE, FloorResult, SiteResult, TwoDirections

ANSWERS = {
    "fulfilled": ({}, "Fulfilled under the rule below"),
    "not fulfilled": ({"overturned": 9}, "Not fulfilled under the rule below: 9 of 112 runs overturned"),
    "in a building": ({"building": True}, "Fulfilled under the rule below"),
    "not valid": ({"valid": False}, "Not valid: the set of motions fails its checks"),
}


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    place = tmp_path_factory.mktemp("sites")
    for name, (changes, _) in ANSWERS.items():
        write_example(place / name, **changes)
        with pytest.MonkeyPatch.context() as patch:
            if name != "fulfilled":
                patch.setattr("fem.site.page.MOST_DRAWN", 1)
            (place / name / "report.html").write_text(site_report(place / name), encoding="utf-8")
    return place


def page_of(folders, name: str) -> str:
    return (folders / name / "report.html").read_text(encoding="utf-8")


def page_with(result: SiteResult) -> str:
    """The two sheets of a result."""
    page = Page(kind="", title="", name="", hash="", signature=None)
    return html_of(page, "site.html.j2", **shown(result, Path(), brief=True))


def box_of(result: SiteResult) -> str:
    """The answer alone."""
    page = page_with(result)
    return page[page.index('<section class="answer') : page.index('<section aria-labelledby="inputs"')]


def words_of(page: str) -> str:
    """The text of a page, without its styles, scripts and drawings."""
    body = re.sub(r"<(style|script|svg)\b.*?</\1>", " ", page, flags=re.S)
    return " ".join(Markup(body).striptags().split())


def test_the_result_survives_its_file():
    result, _ = example()
    assert SiteResult.from_json(json.loads(to_json(result.to_json()))) == result


@pytest.mark.parametrize("name", ANSWERS)
def test_the_first_sentence_is_the_answer_and_never_says_safe(folders, name):
    words = words_of(page_of(folders, name))
    assert ANSWERS[name][1] in words
    assert not re.search(r"\b(safe|safely|verified)\b", words.replace("to be verified by", ""))


def test_what_the_answer_rests_on_stands_on_the_page(folders):
    words = words_of(page_of(folders, "fulfilled"))
    for statement in (
        "T1 does not exist for a rocking body",
        "ag S = 1.778 × 1.35 = 2.400 m/s²",
        "least mean over target, 0.05 to 4 s",
        "That any overturning means not fulfilled, the limit of a single rotation, and the largest slip against",
        "names no number of motions, no limit of rotation or slip and no partial factor",
        "two horizontal components",
        "Of 100 further motions none overturned it (95 % interval 0 to 3.6 %) and 2 went beyond a limit of a single",
        "for building structures in special cases and applied here by analogy",
        "the rule first fails at1.62 × the set",
        "first overturned at1.75 × the set",
        "earthquake: fulfilled (utilisation 0.0420); wind: fulfilled (utilisation 0.254).",
        "python -m fem assess site.toml",
        "prepared: name, date, signature",
        'container = "my-stack.toml"',
    ):
        assert statement in words, statement


def test_every_motion_run_and_method_is_on_the_page(folders):
    page, (result, _) = page_of(folders, "fulfilled"), example()
    regions = page.count('aria-label="motion ')
    outcomes = page.count("<td>slide</td>") + page.count("<td>rest</td>")
    # a drawing with its region for each, and the table motion by motion
    assert regions == 2 * 7 + 1
    # in the appendix those that move, and where it governs; the outcome of the confirmed run and over its inputs
    assert outcomes == 56 + 14 + 2
    words = words_of(page)
    assert "28 of 56 rows are left out, in which the container rests" in words
    assert "4 of 8 combinations of weight, elevation and friction rest in every motion." in words
    assert {name for motion in result.set.motions for name in motion.sha256 if name not in page} == set()
    assert {row.name for row in result.methods if row.name.split(",")[0] not in words_of(page)} == set()


def test_in_a_building_the_floor_stands_beside_the_ground(folders):
    words = words_of(page_of(folders, "in a building"))
    assert "floor at z/H = 1 of a building with T1 = 0.425, 0.5, 0.575 s" in words
    assert "The floor in the building" in words
    assert "element on a floor, z/H = 1, Ta/T1 = 1" in words
    assert page_of(folders, "in a building").count('<td class="number">0.425</td>') == 4 + 7 * 4


def test_a_floor_that_moves_less_than_its_ground_is_explained():
    result, _ = example()
    floor = FloorResult(
        z_over_h=0.5,
        building="10 storeys",
        building_periods_s=(2.0,),
        damping_ratio=0.05,
        peak_m_s2=1.9,
        peak_velocity_m_s=0.5,
        mean_m_s2=(),
    )
    ridge = replace(result.action, topographic_factor=1.2)
    words = words_of(page_with(replace(result, floor=floor, action=ridge)))
    assert "a building (10 storeys) with T1 = 2 s" in words
    assert "below that of the ground" in words and "modes act against each other" in words
    assert "ST = 1.2 for topography" in words
    high = words_of(page_with(replace(result, floor=replace(floor, peak_m_s2=9.0))))
    assert "below that of the ground" not in high
    given = replace(
        floor, z_over_h=None, building="its spectrum", building_periods_s=(), vertical_peak_m_s2=1.0
    )
    words = words_of(page_with(replace(result, floor=given))).replace("\xa0", " ")
    assert "given by its spectrum: mean peak 1.900 m/s², 1.000 m/s² vertically" in words
    assert "no building, storey, importance or element factor" in words
    drawn = {
        source: draw_spectra(result.action, replace(result.set, source=source), given)
        for source in ("artificial", "floor")
    }
    assert all(
        "Response spectra of the floor" in one and "at the ground" not in one for one in drawn.values()
    )
    assert "90 % of the target" in drawn["artificial"] and "90 %" not in drawn["floor"]
    assert "nothing is demanded of their mean" in drawn["floor"]


def test_a_short_page_has_the_sheet_that_is_signed_and_what_the_runs_found(folders):
    words = words_of(site_report(folders / "fulfilled", brief=True))
    assert "prepared: name, date, signature" in words and "What the runs found" in words
    assert "Appendix" not in words and "Rules of thumb" not in words


def test_of_many_motions_the_first_are_drawn(folders, monkeypatch):
    monkeypatch.setattr("fem.site.page.MOST_DRAWN", 2)
    page = site_report(folders / "fulfilled")
    assert page.count('aria-label="motion ') == 2 * 2 + 1
    assert "The curves of the other 5 motions are in their files." in page


def test_a_set_that_is_not_valid_shows_no_runs(folders):
    words = words_of(page_of(folders, "not valid"))
    assert "The set of motions: not valid" in words
    assert "Reasons: the mean spectrum is" in words
    assert "What the runs found" not in words
    assert "no runs" in words


CONFIRMED = example()[0].result.confirmed[0]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            {},
            "none overturns, largest rotation ratio 0.00400, largest slip 4.10 mm; in the set {own}. The answer rests "
            "on the set: a single rotation is chaotic with either model, and a repetition counts where it overturns, "
            "destroys a corner, fails or, with the inputs as given, goes beyond a limit of a single motion.",
        ),
        (
            {"rotation_ratio_range": (0.001, 0.31), "max_slip_m_range": (0.002, 0.12)},
            "largest slip 4.10 mm; over its unknown inputs none overturns, either, with rotation ratios up to 0.310 "
            "and slips up to 120 mm; in the set {own}. The answer rests on the set: a single rotation is chaotic with "
            "either model, and a repetition counts where it overturns, destroys a corner, fails or, with the inputs as "
            "given, goes beyond a limit of a single motion.",
        ),
        ({"outcomes": ("rock", "overturned")}, "1 can overturn, 0 failed."),
        ({"outcome": None}, "0 can overturn, 1 failed."),
    ],
)
def test_what_decides_is_repeated(change, words):
    result, _ = example()
    once = replace(CONFIRMED.run, rotation_ratio=0.47, max_slip_m=0.0052)
    answer = replace(result.result, confirmed=(replace(CONFIRMED, run=once, **change),))
    own = "largest rotation ratio 0.470, largest slip 5.20 mm"
    assert words.format(own=own) in words_of(box_of(replace(result, result=answer)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"bolt_tension_N": 18_200.0}, "18 kN of tension there; the capacity of a bolt is not given."),
        (
            {"bolt_tension_N": 18_200.0, "bolt_utilisation": 0.073},
            "18 kN of tension there, 7.3 % of their capacity.",
        ),
    ],
)
def test_the_bolts_of_the_deciding_runs_are_told(change, words):
    result, _ = example()
    assert "bolts" not in words_of(box_of(result))
    answer = replace(result.result, confirmed=(replace(CONFIRMED, **change),))
    assert words in words_of(box_of(replace(result, result=answer)))


def test_destroyed_corners_are_named_beside_the_runs_that_overturned():
    result, _ = example()
    runs = [replace(run, outcome="invalid", rotation_ratio=None) for run in result.runs[:2]]
    further = replace(result.result.further[0], invalid=7, interval=(0.0286, 0.139))
    answer = replace(result.result, invalid=2, further=(further,))
    crushed = replace(result, result=answer, runs=(*runs, *result.runs[2:]))
    words = words_of(box_of(crushed))
    assert "0 of 112 runs, 2 destroyed a corner" in words
    assert "none overturned it, 7 destroyed a corner (95 % interval of both 2.9 to 14 %)" in words
    assert "further    0 of 100 motions overturn it, 7 destroyed a corner" in "\n".join(
        lines_of(crushed, Path("out"))
    )
    assert "of 14, 1 destroyed a corner" in words_of(page_with(crushed))


def test_a_factor_of_which_no_smaller_was_tried_is_at_most_that():
    result, _ = example()
    least = result.result.scan[0].factor
    answer = replace(result.result, margin_factor=least, factor_at_first_overturning=None)
    printed = "\n".join(lines_of(replace(result, result=answer), Path("out")))
    assert f"first fails: at most {least:g}, first overturning: none" in printed
    assert f"at most {least:g}" in words_of(box_of(replace(result, result=answer)))


def test_where_a_run_overturned_no_slip_in_the_plane_is_named():
    result, _ = example()
    both = TwoDirections(
        slip_mean_m=0.4,
        slip_largest_m=0.5,
        slip_mean_in_plane_m=0.2,
        mu_static=0.3,
        mu_kinetic=0.15,
        motion=1,
    )
    answer = replace(
        result.result, answer="not fulfilled", slip_m=None, slip_mean_m=None, further=(), two_directions=both
    )
    words = words_of(box_of(replace(result, result=answer)))
    assert "under both horizontal components" in words and "in the plane –" not in words
    assert "Its largest slip is held against the clearance, too. A container" in words


def test_a_page_is_green_and_signed_where_somebody_stands_for_every_input():
    result, _ = example()
    open_result = replace(result, inputs=replace(result.inputs, unstated=("source of friction",)))
    for of, signed in ((result, True), (open_result, False)):
        page = page_with(of)
        assert ('class="sign"' in page, 'class="answer stood"' in page) == (signed, signed)
        assert ("nobody stands for source of friction" in words_of(page)) is not signed


def test_runs_that_failed_at_other_factors_are_told():
    result, _ = example()
    scan = [replace(point, failed=2 if point.factor > 2.0 else 0) for point in result.result.scan]
    told = "Runs that failed at other factors on the set: 2 at 2.5, 2 at 4. The margin does not know how they end."
    assert told in words_of(box_of(replace(result, result=replace(result.result, scan=tuple(scan)))))
    assert "failed" not in words_of(box_of(result))


def test_runs_that_failed_between_the_factors_of_the_scan_are_told():
    result, _ = example()
    told = "Runs that failed at factors between those of the scan: 3. The margin does not know how they end."
    assert told in words_of(box_of(replace(result, result=replace(result.result, failed_between=3))))


def test_what_speaks_against_the_answer_stands_in_the_box_and_the_answer_has_its_colour():
    result, _ = example()
    reason = "3 of 100 further motions overturned it."
    doubted = replace(
        result.result,
        answer="not sure",
        fulfilled=None,
        reasons=("The limit lies between.", reason),
        sentence="Not sure. The limit lies between.",
    )
    page = box_of(replace(result, result=doubted))
    assert 'class="answer open"' in page
    assert words_of(page).count("The limit lies between.") == 1 and reason in words_of(page)


def test_a_container_that_never_moves_is_told_so():
    result, _ = example()
    answer = replace(result.result, still=112, factor_at_first_movement=1.9)
    words = words_of(box_of(replace(result, result=answer)))
    assert "Nothing moves up to 1.9 × the set: all 112 runs stay below uplift and slip" in words


def test_text_of_users_is_escaped(folders):
    assert "<hall 3>" not in page_of(folders, "fulfilled")
    assert "Mercury containers &lt;hall 3&gt;" in page_of(folders, "fulfilled")


def test_an_unfinished_verification_is_told(tmp_path):
    (tmp_path / RESULT_FILE).write_text('{"status": "running", "asked": "ab"}', encoding="utf-8")
    with pytest.raises(FolderError, match="continue it with --resume"):
        site_report(tmp_path)


@pytest.mark.parametrize("text", [None, "{", '{"status": "completed"}'])
def test_a_result_that_is_missing_or_damaged_is_told(tmp_path, text):
    if text is not None:
        (tmp_path / RESULT_FILE).write_text(text, encoding="utf-8")
    with pytest.raises(FolderError, match=r"assess\.json"):
        site_report(tmp_path)


def test_a_motion_that_is_missing_is_told(tmp_path):
    result = write_example(tmp_path / "site")
    (tmp_path / "site" / result.set.motions[3].files[1]).unlink()
    with pytest.raises(FolderError, match="motion_04_v"):
        site_report(tmp_path / "site")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("λ a_up ≤ g b/h", "<i>λ</i> <i>a</i><sub>up</sub> ≤ <i>g</i> <i>b</i>/<i>h</i>"),
        ("max(3, x) r^−4 cm/s", "max(3, <i>x</i>) <i>r</i><sup>−4</sup> cm/s"),
        ("0.9 G/γ_μ", "0.9 <i>G</i>/<i>γ</i><sub>μ</sub>"),
        ("r < 2π cos α", "<i>r</i> &lt; 2π cos <i>α</i>"),
    ],
)
def test_formulas_are_set(text, expected):
    assert formula_markup(text) == expected


def test_prose_keeps_its_letters():
    assert formula_markup("a peak of a_g <b>", prose=True) == "a peak of <i>a</i><sub>g</sub> &lt;b&gt;"


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium: apt-get install chromium")
def test_the_page_works_in_a_browser_on_a_desk_on_a_telephone_and_on_paper(folders, tmp_path):
    with Browser(tmp_path) as browser:
        for width in (1280, 390):
            browser.window(width, 900)
            browser.open(folders / "fulfilled" / "report.html")
            assert [browser.errors, len(browser.requests)] == [[], 1]
            assert browser.evaluate("document.documentElement.scrollWidth") <= width
            assert browser.evaluate(FAINT) == []
            clauses = "[...document.querySelectorAll('td.note')].map((cell) => cell.clientWidth)"
            assert min(browser.evaluate(clauses)) >= 100  # no column of single letters
        paper = browser.pdf()
        assert re.search(rb"/MediaBox ?\[0 0 59[45][.\d]* 84[12][.\d]*\]", paper)
