"""Verdicts of a study follow from numbers; what is kept is what this very program found."""

import json
import math

import numpy as np
import pytest

from fem.__main__ import main
from fem.case.case import load_case
from fem.paper.cases import STACK, harmonic
from fem.paper.claims import (
    Band,
    Comparison,
    Drawing,
    Finding,
    Member,
    Setup,
    Statement,
    Verdict,
    verdict_of,
)
from fem.paper.criteria import Motion, contingency, mode_said, paper_criteria, static_rule
from fem.paper.experiments import InterruptedStudyError, Laboratory
from fem.paper.index import all_statements
from fem.paper.maps import near_change
from fem.paper.run import conduct
from fem.results.run_folder import FolderError


def compared(measured, relation="<=", limit=1.0, *, tolerance=0.0, inside=True):
    return Comparison(
        what="a number",
        measured=measured,
        relation=relation,
        limit=limit,
        unit="-",
        tolerance=tolerance,
        inside=inside,
    )


@pytest.mark.parametrize(
    ("measured", "relation", "tolerance", "holds"),
    [
        (1.0, "<=", 0.0, True),
        (1.1, "<=", 0.0, False),
        (1.0, ">=", 0.0, True),
        (0.9, ">=", 0.0, False),
        (1.04, "=", 0.05, True),
        (1.06, "=", 0.05, False),
        (math.nan, "<=", 0.0, False),
        (math.nan, ">=", 0.0, False),
        (math.nan, "=", 1.0, False),
    ],
)
def test_a_comparison_holds_by_its_numbers_and_never_with_nan(measured, relation, tolerance, holds):
    assert compared(measured, relation, tolerance=tolerance).holds is holds


GOOD, BAD = compared(0.5), compared(2.0)
GOOD_OUTSIDE, BAD_OUTSIDE = compared(0.5, inside=False), compared(2.0, inside=False)


@pytest.mark.parametrize(
    ("comparisons", "bounds", "verdict"),
    [
        ((GOOD, GOOD_OUTSIDE), "", Verdict.CONFIRMED),
        ((GOOD, GOOD_OUTSIDE), "some", Verdict.CONFIRMED),
        ((GOOD, BAD_OUTSIDE), "some", Verdict.BOUNDED),
        ((GOOD, BAD_OUTSIDE), "", Verdict.REFUTED),
        ((GOOD, BAD), "some", Verdict.REFUTED),
        ((BAD, GOOD_OUTSIDE), "some", Verdict.REFUTED),
        ((BAD_OUTSIDE,), "some", Verdict.REFUTED),
        ((BAD,), "", Verdict.REFUTED),
        ((), "some", Verdict.UNDECIDED),
    ],
)
def test_the_verdict_follows_from_the_comparisons(comparisons, bounds, verdict):
    assert verdict_of(comparisons, bounds) is verdict


def band_of(*holds):
    members = tuple(
        Member(what=f"{n}", command="", outcome="rock", value=None if one is None else float(n), holds=one)
        for n, one in enumerate(holds)
    )
    return Band(quantity="a ratio", unit="-", criterion="small", members=members)


def test_a_band_says_how_often_it_holds_and_leaves_failed_members_out():
    band = band_of(None, True, False)
    assert (band.low, band.high, band.holding) == (1.0, 2.0, 1)
    assert band.summary == "holds in 1 of 3, 1 not computed: it depends on deformation, contact or support"
    assert band_of(True, True).summary.endswith("do not change it")
    assert band_of(False, False).summary.endswith("it holds in none of them")
    assert math.isnan(band_of(None).low)


def test_a_band_takes_a_truth_of_any_kind(monkeypatch):
    laboratory = Laboratory()
    row = {"status": "completed", "outcome": "rock", "rotation_ratio": 0.4}
    monkeypatch.setattr(laboratory, "variants", lambda setup: [setup])
    monkeypatch.setattr(laboratory, "attempts", lambda setups: [row])
    band = laboratory.band(
        STACK,
        quantity="a ratio",
        unit="-",
        value=lambda row: row["rotation_ratio"],
        criterion="small",
        holds=lambda row: np.float64(row["rotation_ratio"]) < 0.5,  # a truth of numpy's
    )
    assert band.holding == 1


def test_the_command_of_a_setup_runs_the_very_case():
    setup = STACK.but(
        {
            **harmonic(4.0, 7.1),
            "support.kind": "flat",
            "output.stop_when_overturned": True,
            "solver.model": "rigid",
        }
    )
    words = setup.command.split()
    overrides = [words[n + 1] for n, word in enumerate(words) if word == "--set"]
    typed = load_case(words[4], overrides).with_values({"output.fields_s": 0.0})
    assert words[:5] == ["python", "-m", "fem", "run", "seed_stack"]
    assert typed.resolved() == setup.case.resolved()


def test_every_setup_of_the_laboratory_is_the_case_of_its_command():
    setup = STACK.but({**harmonic(4.0, 7.1), "contact.mu_static": 0.3, "contact.mu_kinetic": 0.15})
    assert Laboratory().case(setup).resolved() == setup.case.resolved()


def test_a_contingency_counts_each_cell_once():
    found = contingency([True, True, False, False, True], [True, False, True, False, True])
    assert (found.cells, found.right, found.conservative, found.unconservative) == (5, 3, 1, 1)
    assert sum(found.shares) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("peak", "amplitude", "slenderness", "mu", "tilts", "overturns", "mode"),
    [
        (2.4, 0.05, 3.636, (0.4, 0.2), False, False, "rest"),  # the stack under its stated motion
        (4.0, 0.083, 3.636, (0.4, 0.2), True, False, "rock"),  # .. under the plateau value
        (4.0, 1.0, 3.636, (0.4, 0.2), True, True, "overturned"),
        (4.0, 1.0, 0.909, (0.4, 0.2), False, False, "slide"),  # one box
        (4.0, 1.0, 3.636, (0.2, 0.1), True, False, "slide"),  # it slides before it tilts
    ],
)
def test_the_papers_criteria_say_of_known_motions_what_they_must(
    peak, amplitude, slenderness, mu, tilts, overturns, mode
):
    motion = Motion(
        peak=peak, amplitude=amplitude, slenderness=slenderness, mu_static=mu[0], mu_kinetic=mu[1]
    )
    assert (static_rule(motion), paper_criteria(motion), mode_said(motion)) == (tilts, overturns, mode)


def test_cells_beside_a_change_of_outcome_or_close_to_falling_are_perturbed():
    def row(outcome, ratio=0.1, status="completed"):
        return {"outcome": outcome, "status": status, "rotation_ratio": ratio}

    rows = [row("rest"), row("rock"), row("rest"), row("rest"), row("overturned"), row("rock")]
    assert near_change(rows, 6) == [False, False, False, True, True, True]
    assert near_change([row("rock", 0.7), row("rest")], 2) == [True, False]
    assert near_change([row("rest"), row(None, None, "failed")], 2) == [True, True]


def statement(name, examine):
    return "The printed numbers", Statement(name=name, section="0", quote="q", tried="t", examine=examine)


def finding(*comparisons):
    return Finding(
        comparisons=comparisons,
        reading="as read",
        drawings=(Drawing(name="a-figure", caption="c", svg="<svg></svg>"),),
        setups=(Setup(base="seed_box"),),
    )


@pytest.fixture
def three(monkeypatch):
    """A catalogue of one good, one bad and one statement that cannot be computed."""
    calls = []

    def counted(name, result):
        def examine(laboratory):
            calls.append(name)
            if isinstance(result, Exception):
                raise result
            return result

        return statement(name, examine)

    pairs = [
        counted("good", finding(GOOD)),
        counted("bad", finding(BAD)),
        counted("broken", ArithmeticError("no balance")),
    ]
    groups = {"The printed numbers": tuple(one for _, one in pairs)}
    monkeypatch.setattr("fem.paper.run.GROUPS", groups)
    return pairs, calls


def test_what_cannot_be_computed_is_no_verdict_and_ends_as_failed(three, tmp_path):
    pairs, _ = three
    document = conduct(tmp_path / "study", Laboratory(), statements=pairs)
    assert document["status"] == "failed"
    assert document["counts"] == {
        "confirmed": 1,
        "confirmed within stated bounds": 0,
        "refuted": 1,
        "not computed": 1,
    }
    page = (tmp_path / "study" / "study.html").read_text()
    assert "no balance" in page and "as read" in page


def test_a_study_is_signed_in_its_report(three, tmp_path):
    pairs, _ = three
    conduct(tmp_path / "study", Laboratory(), statements=pairs[:1])
    assert 'name="author" value=""' in (tmp_path / "study" / "study.html").read_text()
    words = ["--author", 'A. "Author" <a@b>', "--checker", "C. Checker", "--revision", "B"]
    assert main(["report", str(tmp_path / "study"), *words]) == 0
    page = (tmp_path / "study" / "report.html").read_text()
    assert 'value="A. &#34;Author&#34; &lt;a@b&gt;"' in page
    assert 'value="C. Checker"' in page and 'value="B"' in page


def test_a_second_call_tries_only_what_is_not_decided_and_force_tries_all(three, tmp_path):
    pairs, calls = three
    for force in (False, False, True):
        conduct(tmp_path / "study", Laboratory(), statements=pairs, force=force)
    assert calls == ["good", "bad", "broken", "broken", "good", "bad", "broken"]


def test_what_another_program_found_is_tried_again(three, tmp_path, monkeypatch):
    pairs, calls = three
    conduct(tmp_path / "study", Laboratory(), statements=pairs[:1])
    monkeypatch.setattr("fem.paper.run.fingerprint", lambda: "another")
    conduct(tmp_path / "study", Laboratory(), statements=pairs[:1])
    assert calls == ["good", "good"]


def test_an_interrupted_study_keeps_what_it_has(three, tmp_path):
    pairs, calls = three

    def stopped(laboratory):
        raise InterruptedStudyError("stopped")

    both = [pairs[0], statement("bad", stopped)]
    document = conduct(tmp_path / "study", Laboratory(), statements=both)
    assert (document["status"], document["statements"]) == ("interrupted", 1)
    assert conduct(tmp_path / "study", Laboratory(), statements=pairs[:2])["status"] == "completed"
    assert calls == ["good", "bad"]


def test_a_folder_that_holds_something_else_is_refused(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(FolderError, match="holds no study"):
        conduct(tmp_path, Laboratory(), statements=[])
    (tmp_path / "study.json").write_text("{")
    with pytest.raises(FolderError, match="damaged"):
        conduct(tmp_path, Laboratory(), statements=[])


def test_names_of_statements_and_figures_are_used_once():
    names = [one.name for _, one in all_statements()]
    assert len(names) == len(set(names))


def test_the_command_writes_page_and_document(tmp_path, capsys):
    arguments = ["study", "seed", "--only", "numbers-one-box", "--only", "half-width", "--json", "-q"]
    assert main([*arguments, "--out", str(tmp_path / "s")]) == 0
    document = json.loads(capsys.readouterr().out)
    verdicts = {one["name"]: one["verdict"] for group in document["groups"] for one in group["statements"]}
    assert verdicts == {"numbers-one-box": "confirmed within stated bounds", "half-width": "refuted"}
    page = (tmp_path / "s" / "study.html").read_text()
    assert page.count("<article") == 2
    assert "src=" not in page  # nothing to load
    assert page.count("<script") == 1 and 'id="save"' in page  # what keeps author and checker in a copy


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["study", "seeds"], "did you mean 'seed'"),
        (["study", "seed", "--only", "half-widht"], "did you mean 'half-width'"),
        (["study", "seed", "-j", "0"], "at least one core"),
    ],
)
def test_bad_input_is_refused_with_a_way_out(arguments, said, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
