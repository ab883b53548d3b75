"""Conclusions on the paper follow from numbers; what is kept was found by this version of the program.

Then claims whose conclusion is known beforehand, by runs of the rigid container.
"""

import json
import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from evidence.findings import at_most
from evidence.pages import Picture, study_lines
from paper import example, maps, quasi_static, rocking, shape, stacking
from paper.cases import STACK, PaperCase
from paper.claims import Claim, ClaimResult, Conclusion, conclude
from paper.criteria import MapMotion, contingency, paper_rule, predicted_mode, static_rule
from paper.experiments import Experiments, InterruptedStudyError, VariantBand, VariantResult
from paper.run import all_claims, check_claims, paper_report

from fem.__main__ import main
from fem.case.case import load_case
from fem.results.errors import FolderError

GOOD, BAD = at_most("a", 0.5, 1.0), at_most("a", 2.0, 1.0)
GOOD_OUTSIDE, BAD_OUTSIDE = replace(GOOD, inside=False), replace(BAD, inside=False)


@pytest.mark.parametrize(
    ("comparisons", "bounds", "kind", "conclusion"),
    [
        ((GOOD, GOOD_OUTSIDE), "", "statement", Conclusion.CONFIRMED),
        ((GOOD, GOOD_OUTSIDE), "some", "statement", Conclusion.CONFIRMED),
        ((GOOD, BAD_OUTSIDE), "some", "statement", Conclusion.BOUNDED),
        ((GOOD, BAD_OUTSIDE), "", "statement", Conclusion.REFUTED),
        ((GOOD, BAD), "some", "statement", Conclusion.REFUTED),
        ((BAD, GOOD_OUTSIDE), "some", "statement", Conclusion.REFUTED),
        ((BAD_OUTSIDE,), "some", "statement", Conclusion.REFUTED),
        ((BAD,), "", "statement", Conclusion.REFUTED),
        ((), "some", "statement", Conclusion.UNDECIDED),
        ((GOOD,), "", "print", Conclusion.CONFIRMED),
        ((GOOD, BAD_OUTSIDE), "some", "print", Conclusion.BOUNDED),
        ((BAD,), "", "print", Conclusion.MISPRINT),
        ((), "", "print", Conclusion.UNDECIDED),
        ((), "", "remark", Conclusion.REMARK),
        ((BAD,), "", "remark", Conclusion.REMARK),
    ],
)
def test_the_conclusion_follows_from_the_comparisons(comparisons, bounds, kind, conclusion):
    assert conclude(comparisons, bounds, kind) is conclusion


def band_of(*holds):
    members = [
        VariantResult(what=f"{n}", command="", outcome="rock", value=None if one is None else n, holds=one)
        for n, one in enumerate(holds)
    ]
    return VariantBand(quantity="a ratio", unit="-", criterion="small", members=members)


def test_a_band_counts_how_often_the_criterion_holds_and_leaves_failed_runs_out():
    band = band_of(None, True, False)
    assert (*band.ends, band.holding) == (1.0, 2.0, 1)
    assert band.summary == "holds in 1 of 3, 1 not computed: it depends on deformation, contact or support"
    assert band_of(True, True).summary.endswith("do not change it")
    assert band_of(False, False).summary.endswith("it holds in none of them")
    assert math.isnan(band_of(None).ends[0])


def test_a_band_says_where_the_regime_rests_on_chance():
    first, second = band_of(True, False).members
    rock, slide = replace(first, outcome="rock"), replace(second, outcome="slide-rock")
    regimes = replace(band_of(), members=[rock, slide])
    assert "chance" in replace(regimes, drop=True).summary
    assert "chance" not in regimes.summary  # with mu_k = mu_s the same regimes differ by a little slip
    assert "chance" not in replace(regimes, drop=True, members=[slide, slide]).summary


def test_the_command_of_a_case_runs_the_very_case():
    changes = {"output.stop_when_overturned": True, "solver.model": "rigid"}
    case = STACK.but(changes, support="flat", peak=4.0, frequency=7.1)
    words = case.command.split()
    overrides = [words[n + 1] for n, word in enumerate(words) if word == "--set"]
    typed = load_case(words[4], overrides).with_values({"output.fields_s": 0.0})
    assert words[:5] == ["python", "-m", "fem", "run", "seed_stack"]
    assert typed.resolved() == case.case.resolved() == Experiments().case(case).resolved()


def test_a_contingency_counts_each_cell_once():
    found = contingency([True, True, False, False, True], [True, False, True, False, True])
    assert (found.cells, found.right, found.conservative, found.unconservative) == (5, 3, 1, 1)


@pytest.mark.parametrize(
    ("peak", "angular_frequency", "slenderness", "mu", "tilts", "overturns", "mode"),
    [
        (2.4, 6.928, 3.636, (0.4, 0.2), False, False, "rest"),  # the stack under its stated motion
        (4.0, 6.928, 3.636, (0.4, 0.2), True, False, "rock"),  # .. under the plateau value
        (4.0, 2.0, 3.636, (0.4, 0.2), True, True, "overturned"),
        (4.0, 2.0, 0.909, (0.4, 0.2), False, False, "slide"),  # one box
        (4.0, 2.0, 3.636, (0.2, 0.1), True, False, "slide"),  # it slides before it tilts
    ],
)
def test_the_papers_criteria_say_of_known_motions_what_they_must(
    peak, angular_frequency, slenderness, mu, tilts, overturns, mode
):
    friction = {"mu_static": mu[0], "mu_kinetic": mu[1]}
    motion = MapMotion(angular_frequency=angular_frequency, peak=peak, slenderness=slenderness, **friction)
    assert (static_rule(motion), paper_rule(motion), predicted_mode(motion)) == (tilts, overturns, mode)


def test_cells_beside_a_change_of_outcome_or_close_to_falling_are_perturbed():
    def near(*rows):
        rows = [{"outcome": outcome, "status": status, "rotation_ratio": r} for outcome, status, r in rows]
        return maps.near_change(rows, range(len(rows)), [0.0]).tolist()

    rest, rock = ("rest", "completed", 0.1), ("rock", "completed", 0.1)
    fallen, failed = ("overturned", "overturned", 1.0), (None, "failed", None)
    assert near(rest, rock, rest, rest, fallen, rock) == [False, False, False, True, True, True]
    assert near(("rock", "completed", 0.7), rest) == [True, False]
    assert near(rest, failed) == [True, True]


def result(*comparisons):
    figure, case = Picture(name="a-figure", caption="c", svg="<svg></svg>"), PaperCase(base="seed_box")
    return ClaimResult(comparisons=comparisons, reading="as read", figures=[figure], cases=[case])


@pytest.fixture
def three():
    """One good and one bad claim, one that cannot be computed, and the names of those that were checked.

    They have names of the paper's first claims, under which `study.json` lists them.
    """
    calls = []

    def counted(kind, found, claim):
        def check(experiments):
            calls.append(kind)
            if isinstance(found, BaseException):
                raise found
            return found

        return Claim(name=claim.name, section="0", quote="q", tried="t", check=check)

    results = {
        "good": result(GOOD),
        "bad": result(BAD),
        "broken": ArithmeticError("no balance"),
        "stopped": InterruptedStudyError("stopped"),
    }
    names = all_claims()
    made = [counted(kind, found, names[n]) for n, (kind, found) in enumerate(results.items())]
    return made, calls


def test_a_claim_that_cannot_be_computed_has_no_conclusion_and_ends_as_failed(three, tmp_path):
    claims, _ = three
    document = check_claims(tmp_path / "study", Experiments(), claims=claims[:3])
    assert document["status"] == "failed"
    assert [document["counts"][name] for name in ("confirmed", "refuted", "not computed")] == [1, 1, 1]
    page = (tmp_path / "study" / "study.html").read_text()
    assert "no balance" in page and "as read" in page


def test_the_report_of_a_study_is_signed(three, tmp_path):
    claims, _ = three
    check_claims(tmp_path / "study", Experiments(), claims=claims[:1])
    assert 'name="author" value=""' in (tmp_path / "study" / "study.html").read_text()
    words = ["--author", 'A. "Author" <a@b>', "--checker", "C. Checker", "--revision", "B"]
    assert main(["report", str(tmp_path / "study"), *words]) == 0
    page = (tmp_path / "study" / "report.html").read_text()
    assert 'value="A. &#34;Author&#34; &lt;a@b&gt;"' in page
    assert 'value="C. Checker"' in page and 'value="B"' in page


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [("quote", 1, "is no text"), ("verdict", None, "is missing"), ("comparisons", {}, "is no list")],
)
def test_a_damaged_study_is_refused_with_file_and_key(three, tmp_path, key, value, words):
    document = check_claims(tmp_path, Experiments(), claims=three[0][:1])
    document["groups"][0]["statements"][0][key] = value
    (tmp_path / "study.json").write_text(json.dumps(document))
    with pytest.raises(FolderError, match=rf"study.json: damaged, groups\[0\].statements\[0\].{key} {words}"):
        paper_report(tmp_path)


def test_a_second_call_checks_only_undecided_claims_and_force_checks_all(three, tmp_path):
    claims, calls = three
    for force in (False, False, True):
        check_claims(tmp_path / "study", Experiments(), claims=claims[:3], force=force)
    assert calls == ["good", "bad", "broken", "broken", "good", "bad", "broken"]


@pytest.mark.parametrize("change", ["program", "versions"])
def test_a_claim_that_another_program_decided_is_checked_again(three, tmp_path, change):
    claims, calls = three
    check_claims(tmp_path, Experiments(), claims=claims[:1])
    document = json.loads((tmp_path / "study.json").read_text())
    entry = document["groups"][0]["statements"][0]
    changed, key = (entry, "program") if change == "program" else (document["versions"], "numpy")
    changed[key] = "another"
    (tmp_path / "study.json").write_text(json.dumps(document))
    check_claims(tmp_path, Experiments(), claims=claims[:1])
    assert calls == ["good", "good"]


def test_an_interrupted_study_keeps_the_claims_checked_so_far(three, tmp_path):
    (good, bad, _, stopped), calls = three
    document = check_claims(tmp_path / "study", Experiments(), claims=[good, stopped])
    assert (document["status"], document["statements"]) == ("interrupted", 1)
    assert check_claims(tmp_path / "study", Experiments(), claims=[good, bad])["status"] == "completed"
    assert calls == ["good", "stopped", "bad"]


@pytest.mark.parametrize(
    "content", ["{", '{"study": "seed", "groups": 3}', '{"study": "seed", "groups": [1]}']
)
def test_a_damaged_study_is_refused(tmp_path, content):
    (tmp_path / "study.json").write_text(content)
    with pytest.raises(FolderError, match="damaged"):
        check_claims(tmp_path, Experiments(), claims=[])
    assert (tmp_path / "study.json").read_text() == content


def test_names_of_claims_are_used_once():
    names = [claim.name for claim in all_claims()]
    assert len(set(names)) == len(names) == 42


def test_the_command_writes_page_and_document(tmp_path, capsys):
    names = {
        "numbers-one-box": "confirmed within stated bounds",
        "half-width": "misprint",
        "centre-or-base": "remark",
    }
    only = [word for name in names for word in ("--only", name)]
    assert main(["study", "seed", *only, "--json", "-q", "--out", str(tmp_path / "s")]) == 0
    document = json.loads(capsys.readouterr().out)
    verdicts = {one["name"]: one["verdict"] for group in document["groups"] for one in group["statements"]}
    assert verdicts == names
    assert {name: count for name, count in document["counts"].items() if count} == Counter(names.values())
    first, last = (
        study_lines(document).index(verdict) for verdict in ("confirmed within stated bounds", "remark")
    )
    assert first < last and study_lines(document)[first + 1].endswith("g = 10 m/s²")
    page = (tmp_path / "s" / "study.html").read_text()
    assert page.count('<div class="claim">') == 3
    assert page.index("What does not hold as it is written") < page.index("How a conclusion is reached")
    assert "comparisons of half-width" in page and "comparisons of centre-or-base" not in page
    assert "src=" not in page  # nothing to load
    assert page.count("<script") == 1 and 'id="save"' in page  # what keeps author and checker in a copy


@pytest.fixture(scope="module")
def experiments():
    return Experiments()


@pytest.mark.parametrize(
    ("claim", "conclusion"),
    [
        (example.numbers_one_box, Conclusion.BOUNDED),  # with g = 9.81 the utilisation of stiction is 1.019
        (example.numbers_four_boxes, Conclusion.BOUNDED),
        (example.half_width, Conclusion.MISPRINT),  # 550 mm, printed 600
        (quasi_static.kinetic_limit, Conclusion.CONFIRMED),  # Coulomb
        (quasi_static.moments_of_a_tilted_body, Conclusion.CONFIRMED),  # statics: g tan(al - theta)
        (quasi_static.centre_or_base, Conclusion.REMARK),  # a rigid body that sticks moves with the floor
        (quasi_static.sign_beyond_balance, Conclusion.CONFIRMED),  # statics: it falls beyond balance
        (rocking.eq_2, Conclusion.BOUNDED),  # sqrt(3/4) of the block's period at small rotation
        # T p/4 = arccosh(1/(1 - theta/al)), which 2 pi/4 meets near 0.6 al
        pytest.param(rocking.eq_3, Conclusion.BOUNDED, marks=pytest.mark.slow),
        (rocking.control_periods, Conclusion.BOUNDED),  # the same
        # Coulomb: what stands on a box that sticks to the floor slides as one box on a floor with that friction
        (stacking.slip_between_loose_boxes, Conclusion.CONFIRMED),
    ],
)
def test_conclusion_on_a_claim_that_theory_decides(experiments, claim, conclusion):
    finding = claim.check(experiments)
    assert not experiments.failed
    assert finding.conclusion is conclusion


@pytest.mark.slow
@pytest.mark.parametrize("claim", all_claims(), ids=lambda claim: claim.name)
def test_every_claim_is_decided_and_no_run_that_it_needs_fails(experiments, claim):
    assert claim.check(experiments).conclusion is not Conclusion.UNDECIDED


def test_inertia_of_a_cylinder_about_the_edge_of_its_base():
    # Slices of the elevation: chord 2 sqrt(r^2 - x^2) at x, each a rod of height c; midpoint rule.
    radius, height = 0.55, 4.0
    x = (np.arange(20000) + 0.5) / 20000 * 2.0 * radius - radius
    chord = 2.0 * np.sqrt(radius**2 - x**2)
    about_edge = np.average((x + radius) ** 2 + height**2 / 3.0, weights=chord)
    ratio = about_edge / (radius**2 + 0.25 * height**2)
    assert shape.inertia_ratio(cylinder=True) == pytest.approx(ratio, rel=1e-6)
    assert shape.inertia_ratio(cylinder=False) == pytest.approx(4.0 / 3.0, rel=1e-12)
    # a thin wall: all mass at distance r from the axis, whose mean square of x is r^2/2
    wall = (0.5 * radius**2 + radius**2 + height**2 / 3.0) / (radius**2 + 0.25 * height**2)
    assert shape.inertia_ratio(cylinder=True, hollow=True) == pytest.approx(wall, rel=1e-12)
