"""A finding with any kind of error fails, the suite goes on after a failure, and `verify` says so."""

import json
import math

import pytest
from evidence.findings import Convergence, analytic, at_least, at_most, equal, prediction
from evidence.pages import verification_lines
from verification import suite
from verification.checks import check
from verification.suite import CHECKS as ALL
from verification.suite import chosen_checks

from fem.__main__ import main
from fem.results.json_block import to_json
from fem.runtime.progress import Reporter


def finding(value, *, tolerance=0.01, reference=2.0, relative=False, **optional):
    within = {"relative" if relative else "absolute": tolerance}
    text = "a quantity <b> [m]"
    return analytic("a case", text, value, reference, source="somebody", note="a note", **within, **optional)


def falling(errors, *, at_least=False):
    by_size = {0.1 / 2**k: error for k, error in enumerate(errors)}
    return Convergence("h [m]", by_size, order=2.0, within=0.1, at_least=at_least)


SECOND = falling([1e-2 / 4**k for k in range(4)])


@pytest.mark.parametrize(
    ("found", "holds"),
    [
        (finding(2.01 - 1e-12), True),
        (finding(2.011), False),
        (finding(1.989), False),
        (finding(2.019, relative=True), True),
        (finding(2.021, relative=True), False),
        (finding(-2.019, relative=True, reference=-2.0), True),
        *((at_most("a", value, 1.0), value <= 1.0) for value in (1.0, 1.1, math.nan)),
        *((at_least("a", value, 1.0), value >= 1.0) for value in (1.0, 0.9, math.nan)),
        *((equal("a", value, 1.0, 0.05), value == 1.04) for value in (1.04, 1.06, math.nan)),
        *((finding(one, relative=share), False) for one in (math.nan, math.inf) for share in (True, False)),
        *((prediction("a", 1.0, reference="2 to 3", met=met), met) for met in (True, False, None)),
    ],
)
def test_a_finding_holds_by_its_numbers_or_its_criterion_and_never_with_nan(found, holds):
    assert found.holds is holds


def test_the_observed_order_is_the_slope_and_must_be_the_expected_one():
    assert SECOND.observed == pytest.approx(2.0, abs=1e-12)
    assert SECOND.finest == 1e-2 / 64
    assert SECOND.passed
    assert not falling([1e-2 / 2**k for k in range(4)]).passed
    assert not falling([1e-2 / 8**k for k in range(4)]).passed
    assert falling([1e-2 / 8**k for k in range(4)], at_least=True).passed
    assert not falling([1e-2, 3e-3, 0.0, 1e-4]).passed
    assert finding(2.0, convergence=SECOND).holds and not finding(3.0, convergence=SECOND).holds
    assert not finding(2.0, convergence=falling([1e-2, 1e-2, 1e-2])).holds


def broken():
    yield finding(2.0)
    raise ArithmeticError("no equilibrium")


@pytest.fixture
def small_suite(monkeypatch):
    """Two topics: one that passes, one with a finding that fails and a check that cannot be computed."""
    good = check("cellar", "good")(lambda: [finding(2.0, convergence=SECOND)])
    off = check("attic", "off", quick=False)(lambda: [finding(2.5), finding(2.0)])
    monkeypatch.setattr(suite, "CHECKS", (good, off, check("attic", "broken", quick=False)(broken)))


def computed(*, quick=False):
    """What verify.json holds."""
    document = suite.run_suite(chosen_checks(quick=quick), quick=quick, reporter=Reporter())
    return json.loads(to_json(document))


def test_a_check_that_cannot_be_computed_is_a_finding_that_fails(small_suite):
    document = computed()
    assert (document["count"], document["failures"]) == (4, 2)
    last = document["rows"][-1]
    assert last["passed"] is False and "no equilibrium" in last["note"]
    lines = verification_lines(document)
    assert sum("FAIL" in line for line in lines) == 3 and lines[-1].endswith("2 FAIL")
    assert verification_lines(computed(quick=True))[-1].endswith("all pass")


def test_the_manual_states_every_requirement_with_its_result(small_suite, tmp_path):
    assert main(["verify", "--manual", "--out", str(tmp_path), "-q"]) == 3
    document = json.loads((tmp_path / "verify.json").read_text())
    text = (tmp_path / "manual.html").read_text(encoding="utf-8")
    assert "2 of 4 comparisons fail" in text and text.count(">FAIL<") == 4  # two rows, and their checks
    assert all(f'href="#check-{k}"' in text for k, _ in enumerate(document["checks"], start=1))


def test_every_check_states_what_it_requires():
    assert not [check.title for check in ALL if len(check.requirement.split()) < 3]


@pytest.mark.parametrize(("options", "code"), [(["--quick"], 0), ([], 3), (["--room", "cellar"], 0)])
def test_the_command_ends_with_3_if_a_finding_fails(small_suite, tmp_path, capsys, options, code):
    assert main(["verify", *options, "--out", str(tmp_path), "--json"]) == code
    document = json.loads(capsys.readouterr().out)
    assert document == json.loads((tmp_path / "verify.json").read_text())
    assert document["passed"] is (code == 0)
    assert all(row["room"] == row["topic"] for row in document["rows"] + document["checks"])
    assert (tmp_path / "verify.html").stat().st_size > 1000
