"""Reports in a browser: nothing is loaded, the animation plays, keys and slider work, everybody can read them."""

import json
import shutil
import time
from pathlib import Path

import pytest
from browser import CHROMIUM, FAINT, Browser
from site_example import write_example
from small_sweep import sweep_in
from study_folders import ensemble_folder, response_folder

from fem.case.case import load_case
from fem.report.run_page import run_report
from fem.report.study_page import ensemble_report, hall_report, response_report, sweep_report
from fem.results.errors import FolderError
from fem.results.reader import open_run
from fem.site.page import site_report
from fem.study.hall import run_hall
from fem.study.hall_file import read_hall
from fem.study.sweep import run_sweep
from fem.study.sweep_table import open_sweep

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium: apt-get install chromium")

SWEEP = """
case = "seed_stack_plateau"
[set]
"solver.model" = "rigid"
"solver.duration_s" = 0.5
[axes]
"motion.peak_acceleration_m_s2" = { from = 1.0, to = 9.0, count = 5 }
"contact.mu_static" = [0.2, 0.4, 0.6]
[derived]
"contact.mu_kinetic" = "0.5 * contact.mu_static"
[perturbation]
cells = "none"
"""
#: text of others that would act in a page, were it not escaped in its place
HOSTILE = "x\"><img src=x onerror='window.done=1'>\u2028</script><script>window.done=1</script><!--`${window.done=1}"
LIST = f"name,tag,width_m,note\n{HOSTILE[3:]},{HOSTILE[3:]},1.5,<b>\n"
FREE = ("title", "case", "name", "tag")  #: keys of texts that may be anything
CONTROLS = ("button", "slider", "combobox", "checkbox", "textbox", "application", "link", "image", "region")
WIDER = (  #: than the page: tables that scroll within themselves
    "[...document.querySelectorAll('.scroll')].filter((one) => one.scrollWidth > one.clientWidth + 1)"
    ".map((one) => one.ariaLabel)"
)
CLOCK = "parseFloat(document.getElementById('now-clock').textContent)"


def run_report_of(folder):
    return run_report(open_run(folder))


@pytest.fixture(scope="module")
def pages(gallery, tmp_path_factory):
    """A report of a run, a sweep, an ensemble and a response curve."""
    place = tmp_path_factory.mktemp("pages")
    gallery.copy("default", place)
    (place / "run.html").write_text(run_report(gallery.run("default")), encoding="utf-8")
    run_sweep(sweep_in(place, SWEEP, "boxes"), place / "boxes", jobs=1)
    (place / "sweep.html").write_text(sweep_report(place / "boxes"), encoding="utf-8")
    (place / "list.csv").write_text(LIST, encoding="utf-8")
    base = load_case("seed_box", ("solver.model=rigid", "solver.duration_s=1"))
    run_hall(read_hall(place / "list.csv"), base, place / "listed", checks="none")
    write_example(place / "site", building=False)
    counted, swept = ensemble_folder(place / "counted"), response_folder(place / "swept")
    (place / "ensemble.html").write_text(ensemble_report(counted), encoding="utf-8")
    (place / "response.html").write_text(response_report(swept), encoding="utf-8")
    return place


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with Browser(tmp_path_factory.mktemp("profile")) as opened:
        opened.window(1280, 900)
        yield opened


@pytest.fixture
def run_page(browser, pages):
    browser.open(pages / "run.html", "#t=0.5")
    browser.wait("document.querySelectorAll('.cursor').length > 0")
    return browser


@pytest.fixture
def sweep_page(browser, pages):
    browser.open(pages / "sweep.html")
    browser.wait("document.getElementById('command').textContent !== ''")
    return browser


@pytest.mark.parametrize("name", ["run.html", "sweep.html", "ensemble.html", "response.html"])
def test_every_report_loads_nothing_and_can_be_read_by_everybody_on_a_desk_and_a_telephone(
    browser, pages, name
):
    browser.open(pages / name)
    time.sleep(0.3)
    assert (browser.errors, browser.requests) == ([], [(pages / name).as_uri()])
    nodes = browser.call("Accessibility.getFullAXTree")["nodes"]
    controls = [node for node in nodes if not node["ignored"] and node["role"]["value"] in CONTROLS]
    assert len(controls) > 8
    assert [node["role"]["value"] for node in controls if not node.get("name", {}).get("value")] == []
    assert browser.evaluate(FAINT) == []
    browser.window(390, 844)
    try:
        browser.open(pages / name)
        assert browser.evaluate("document.documentElement.scrollWidth") <= 390
        tables = "[...document.querySelectorAll('table')]"
        assert browser.evaluate(f"{tables}.filter((one) => !one.closest('.scroll')).length") == 0
        browser.window(1200, 900)
        assert browser.evaluate(WIDER) == []
    finally:
        browser.window(1280, 900)


def test_a_list_of_long_names_fits_the_page_of_a_desk(browser, tmp_path):
    text, records = (
        "name;count;tag;width_m\nISO container of the supplier behind the gallery;2;hall 3 north;0.5\n",
        [],
    )
    (tmp_path / "list.csv").write_text(text, encoding="utf-8")
    for station in "12":
        records.append(str(tmp_path / f"record_of_station_{station}_north_component.csv"))
        Path(records[-1]).write_text(
            f"time_s,acceleration_m_s2\n0,0\n0.1,{station}\n0.2,-3\n0.3,0\n", encoding="utf-8"
        )
    base = load_case(
        "seed_box", ("solver.model=rigid", "solver.duration_s=1", "motion.unit=m/s2"), motion=records[0]
    )
    run_hall(read_hall(tmp_path / "list.csv"), base, tmp_path / "out", motions=records, checks="none")
    (tmp_path / "hall.html").write_text(hall_report(tmp_path / "out"), encoding="utf-8")
    browser.window(1200, 900)
    try:
        browser.open(tmp_path / "hall.html")
        assert browser.evaluate("document.querySelectorAll('[aria-label=containers] thead th').length") > 8
        assert browser.evaluate(WIDER) == []
    finally:
        browser.window(1280, 900)


def _texts(content):
    """Where a marking file holds texts: the container and the key of each."""
    for key, value in content.items() if isinstance(content, dict) else enumerate(content):
        if isinstance(value, str):
            yield content, key
        elif isinstance(value, dict | list):
            yield from _texts(value)


@pytest.mark.parametrize("share", [1, pytest.param(4, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("name", "report", "count"),  # pages of a run and of a site take a second each
    [
        pytest.param("default/run", run_report_of, 2, marks=pytest.mark.slow),
        pytest.param("site/assess", site_report, 2, marks=pytest.mark.slow),
        ("boxes/sweep", sweep_report, 5),
        ("counted/ensemble", ensemble_report, 5),
        ("swept/response", response_report, 5),
        ("listed/hall", hall_report, 5),
    ],
)
def test_texts_of_others_do_nothing_in_a_page(browser, pages, tmp_path, name, report, count, share):
    folder = shutil.copytree(pages / Path(name).parent, tmp_path / "copy")
    mark = folder / f"{Path(name).name}.json"
    content, kept = json.loads(mark.read_text(encoding="utf-8")), 0
    for place, key in sorted(_texts(content), key=lambda text: text[1] not in FREE)[: share * count]:
        before, place[key] = place[key], HOSTILE
        mark.write_text(json.dumps(content), encoding="utf-8")
        try:
            report(folder)
            kept += 1
        except (FolderError, ValueError, KeyError):  # such as a status, or the name of a motion's file
            place[key] = before
    mark.write_text(json.dumps(content), encoding="utf-8")
    page = folder / "hostile.html"
    page.write_text(report(folder), encoding="utf-8")
    assert kept >= 2 and "window.done" in page.read_text(encoding="utf-8")
    browser.open(page)
    time.sleep(0.3)
    assert browser.evaluate("window.done") is None and browser.evaluate("document.images.length") == 0
    assert (browser.errors, browser.requests) == ([], [page.as_uri()])


class TestTheAnimation:
    def test_plays_pauses_and_takes_the_cursors_along(self, run_page):
        places = "[...document.querySelectorAll('.cursor')].map((mark) => parseFloat(mark.style.left))"
        before, canvas = run_page.evaluate(places), run_page.evaluate("stage.toDataURL()")
        run_page.click("#play")
        run_page.wait(f"{CLOCK} > 0.7")
        run_page.click("#play")
        stopped = run_page.evaluate(CLOCK)
        time.sleep(0.2)
        assert run_page.evaluate(CLOCK) == stopped
        assert run_page.evaluate("stage.toDataURL()") != canvas
        after = run_page.evaluate(places)
        assert len(after) == len(before) >= 5
        assert all(b > a for a, b in zip(before, after, strict=True))
        axes = json.loads(run_page.evaluate("document.querySelector('.cursor').parentElement.dataset.axes"))
        share = (stopped - axes["x"][0]) / (axes["x"][1] - axes["x"][0])
        place = 100.0 * (axes["left"] + share * (axes["right"] - axes["left"]))
        assert after[0] == pytest.approx(place, abs=0.3)

    def test_slider_and_keys_go_through_time(self, run_page):
        run_page.evaluate("document.getElementById('time').focus()")
        run_page.press("ArrowRight", 39)
        assert run_page.evaluate(CLOCK) == pytest.approx(0.505)
        run_page.press(",", 188)
        assert run_page.evaluate(CLOCK) == pytest.approx(0.5)
        run_page.press("l", 76)
        assert run_page.evaluate(CLOCK) == pytest.approx(0.6)
        run_page.press("End", 35)
        assert run_page.evaluate(CLOCK) == pytest.approx(2.0)
        said = "document.getElementById('time').getAttribute('aria-valuetext')"
        assert "rotation" in run_page.evaluate(said)
        run_page.press(" ", 32)  # from the end it plays again from the start
        run_page.wait(f"{CLOCK} < 1.9 && {CLOCK} > 0")
        run_page.press("k", 75)
        assert run_page.evaluate("document.getElementById('play').textContent") == "Play"

    def test_a_click_on_a_curve_goes_to_its_instant(self, run_page):
        axes = json.loads(run_page.evaluate("document.querySelector('[data-axes]').dataset.axes"))
        share = axes["left"] + 0.75 * (axes["right"] - axes["left"])
        run_page.click("[data-axes]", x=share)
        expected = axes["x"][0] + 0.75 * (axes["x"][1] - axes["x"][0])
        assert run_page.evaluate(CLOCK) == pytest.approx(expected, abs=0.01)

    def test_who_asks_for_less_motion_gets_stills(self, run_page):
        reduced = {"name": "prefers-reduced-motion", "value": "reduce"}
        run_page.call("Emulation.setEmulatedMedia", features=[reduced])
        try:
            run_page.click("#play")
            run_page.wait(f"{CLOCK} > 0.5")
            assert run_page.evaluate(CLOCK) in (pytest.approx(1.0), pytest.approx(1.5), pytest.approx(2.0))
        finally:
            run_page.call("Emulation.setEmulatedMedia", features=[])


def test_what_is_typed_is_kept_in_the_copy(run_page):
    run_page.evaluate("document.querySelector('[name=checker]').value = 'C. Checker'")
    run_page.evaluate(
        "window.kept = null;"
        "URL.createObjectURL = (blob) => { blob.text().then((text) => { window.kept = text; }); return '#'; }"
    )
    run_page.click("#save")
    run_page.wait("window.kept !== null")
    assert run_page.evaluate("window.kept.includes('value=\"C. Checker\"')")
    assert not run_page.evaluate('/class="(cursor|spot)"/.test(window.kept)')


class TestTheMap:
    def test_keys_choose_a_cell_and_the_command_runs_it(self, sweep_page, pages):
        sweep_page.evaluate("document.getElementById('map').focus()")
        for _ in range(4):
            sweep_page.press("ArrowLeft", 37)
            sweep_page.press("ArrowDown", 40)
        sweep_page.press("ArrowRight", 39)
        said = sweep_page.evaluate("document.getElementById('command').textContent")
        assert said == (
            f"python -m fem run {pages / 'boxes' / 'base.toml'} --set motion.peak_acceleration_m_s2=3 "
            "--set contact.mu_static=0.2 --set contact.mu_kinetic=0.1"
        )
        table = open_sweep(pages / "boxes")
        assert table["outcome"][3] in sweep_page.evaluate("document.getElementById('said').textContent")

    def test_a_pointer_shows_values_and_a_click_chooses(self, sweep_page):
        before = sweep_page.evaluate("document.getElementById('command').textContent")
        sweep_page.click("#map", x=0.9, y=0.1)
        after = sweep_page.evaluate("document.getElementById('command').textContent")
        assert after != before
        assert "contact.mu_static=0.6" in after
        assert "peak_acceleration_m_s2=9" in after
        assert "rotation ratio" in sweep_page.evaluate("document.getElementById('cell').textContent")
