"""The report of a run: whole, self-contained, honest about what is missing, and its refusals."""

import html
import re
from dataclasses import replace

import pytest
from markupsafe import escape

from fem.__main__ import main
from fem.case.case import load_case, read_case
from fem.html.units import typeset
from fem.model.model import build_model
from fem.report import variation_table as variation_table_module
from fem.report.animation import animation_of
from fem.report.run_page import Signature, run_report
from fem.report.variation_table import variation_table, variations_meanwhile
from fem.report.variations import by_importance, variations_of
from fem.results.reader import open_run
from fem.run.run import RunOptions, run_case

SECTIONS = """verdict-title asked assumptions static motion-title variations modes block joints sheet
numerics provenance"""
HOSTILE = "</title><script>alert(1)</script> & co"
COARSE = ("solver.duration_s=1.2", "solver.element_size_m=0.5", "solver.order=1", "solver.elastic_modes=4")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A short run of the shell stack."""
    place = tmp_path_factory.mktemp("report") / "stack"
    case = load_case("seed_stack_plateau", [*COARSE, "floor.kind=rigid"]).model_copy(
        update={"title": HOSTILE}
    )
    run_case(case, case_text=case.text, folder=place)
    return place


@pytest.fixture(scope="module")
def page(folder):
    return run_report(open_run(folder), signature=Signature(author="A. Author <a@b>"), every_variation=True)


def without_band(run):
    """The result of a run whose variations are not known yet."""
    return replace(run.typed_result, verdict=replace(run.typed_result.verdict, band=None))


def test_the_page_has_every_part_in_the_order_of_reading(page):
    assert re.findall(r'<h2 id="([a-z-]+)"', page) == SECTIONS.split()
    assert page.index("Result: ") < page.index("The case")


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
    assert read_case(html.unescape(text)).resolved() == open_run(folder).case.resolved()


def test_the_animation_of_a_rigid_run_has_no_stress(tmp_path):
    case = load_case("seed_stack_plateau", [*COARSE, "solver.model=rigid"])
    run_case(case, case_text=case.text, folder=tmp_path / "r", options=RunOptions(band=False))
    shown = animation_of(build_model(case), open_run(tmp_path / "r").fields)
    assert shown.stress_scale == shown.largest_stress == 0.0
    assert shown.frames[0].von_mises is None and len(shown.frames) == 25


def test_variations_are_kept_beside_the_run(folder, page):
    said, run = [], open_run(folder)
    table = variation_table(run.case, run.place.variations, result=run.typed_result, message=said.append)
    assert said == []
    assert table.left_out == () and all(escape(line.variation.change) in page for line in table.lines)


def test_variations_that_take_long_are_named_and_computed_when_asked_for(folder, tmp_path, monkeypatch):
    run = open_run(folder)
    kept = tmp_path / "variations.json"
    some = [one for one in variations_of(run.case) if one.subject in ("contact damping", "contact penalty")]
    monkeypatch.setattr(variation_table_module, "variations_of", lambda case: some)
    monkeypatch.setattr(variation_table_module, "AFFORDED_S", 0.0)
    short = variation_table(run.case, kept, result=run.typed_result)
    known = {line.variation.command: line.row for line in short.lines}
    assert len(known) == 4  # the run itself and those members of its band that differ in one thing
    assert [one.change for one in short.left_out] == ["ratio 0.5", "× 1/3"]
    again = variation_table(run.case, kept, result=run.typed_result)
    assert again == short  # a second report does not compute them unasked
    full = variation_table(run.case, kept, result=run.typed_result, every=True)
    assert full.left_out == ()
    # A run without known rows gets the same ones.
    bare = without_band(run)
    fresh = variation_table(run.case, tmp_path / "other.json", result=bare, every=True)
    assert [line.row for line in fresh.lines] == [line.row for line in full.lines]


def test_variations_of_a_full_run_begin_with_the_run_as_reduced(folder, tmp_path, monkeypatch):
    run = open_run(folder)
    some = [one for one in variations_of(run.case) if one.subject == "contact penalty"]
    monkeypatch.setattr(variation_table_module, "variations_of", lambda case: some)
    monkeypatch.setattr(variation_table_module, "AFFORDED_S", 0.0)
    case = run.case.with_values({"solver.model": "full"})
    table = variation_table(case, tmp_path / "v.json", result=run.typed_result)
    assert [line.variation.subject for line in table.lines] == ["as computed"]
    assert table.lines[0].row.outcome == run.typed_result.verdict.outcome
    assert list(table.left_out) == some and table.model == "reduced"


def test_who_leaves_a_report_does_not_wait_for_its_variations(folder, tmp_path):
    run, kept = open_run(folder), tmp_path / "variations.json"
    endless = run.case.with_values({"solver.duration_s": 1e4})
    bare = without_band(run)
    with (
        pytest.raises(OSError, match="disk"),
        variations_meanwhile(endless, kept, result=bare, every=True),
    ):
        raise OSError("disk")
    assert not kept.exists()


def test_moderate_variations_of_every_subject_come_first(folder):
    variations = list(variations_of(open_run(folder).case))
    first = [variations[index] for index in by_importance(variations)]
    subjects = {one.subject for one in variations}
    assert {one.subject for one in first[: len(subjects)]} == subjects
    frictions = [one.change.rpartition("× ")[2] for one in first if one.subject == "friction"]
    assert frictions == ["0.75)", "1.25)", "0.5)", "1.5)"]


@pytest.mark.parametrize(
    ("folder", "file", "words"),
    [
        ("nothing", "other.txt", "no such folder"),
        (".", "other.txt", "run.json"),
        (".", "study.json", "not the result of a study"),
    ],
)
def test_a_folder_without_results_or_with_damaged_ones_is_refused(tmp_path, capsys, folder, file, words):
    (tmp_path / file).write_text('{"groups": 3}')
    assert main(["report", str(tmp_path / folder)]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("192.2, -184.3 mm", "192.2, −184.3 mm"),
        ("6.5e-05 of it, 172 m/s2", "6.5 × 10⁻⁵ of it, 172 m/s²"),
        ("2.5e+06 N (-3)", "2.5 × 10⁶ N (−3)"),
        ("EN 1998-1:2004, 2026-11-21, slide-rock", "EN 1998-1:2004, 2026-11-21, slide-rock"),
    ],
)
def test_lines_of_the_summary_are_typeset_in_the_page(line, shown):
    assert typeset(line) == shown
