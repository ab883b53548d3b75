"""The verification table: a row with any kind of error fails, and the command says so."""

import errno
import json
import math
import os

import pytest

import fem.results.files
from fem.__main__ import main
from fem.evidence.verification import suite
from fem.evidence.verification.page import convergence_plot, page, table_lines
from fem.evidence.verification.rows import analytic, check, convergence
from fem.evidence.verification.suite import run_suite


def row(value, *, tolerance=0.01, reference=2.0, **optional):
    within = {"relative" if optional.pop("relative", False) else "absolute": tolerance}
    text = "a quantity <b> [m]"
    return analytic("a case", text, value, reference, source="somebody", note="a note", **within, **optional)


def falling(errors, *, at_least=False):
    by_size = {0.1 / 2**k: error for k, error in enumerate(errors)}
    return convergence("h [m]", by_size, order=2.0, within=0.1, at_least=at_least)


def test_a_row_passes_within_its_tolerance_and_not_beyond():
    assert row(2.01 - 1e-12).passed
    assert not row(2.011).passed
    assert not row(1.989).passed
    assert row(2.019, relative=True).passed
    assert not row(2.021, relative=True).passed
    assert row(-2.019, relative=True, reference=-2.0).passed


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_value_that_is_not_finite_fails(value):
    assert not row(value).passed
    assert not row(value, relative=True).passed
    assert row(value).to_dict()["value"] is None


def test_the_observed_order_is_the_slope_and_must_be_the_expected_one():
    second = falling([1e-2 / 4**k for k in range(4)])
    assert second.observed == pytest.approx(2.0, abs=1e-12)
    assert second.passed
    assert not falling([1e-2 / 2**k for k in range(4)]).passed
    assert not falling([1e-2 / 8**k for k in range(4)]).passed
    assert falling([1e-2 / 8**k for k in range(4)], at_least=True).passed
    assert not falling([1e-2, 3e-3, 0.0, 1e-4]).passed


def test_a_row_with_an_order_needs_both():
    good, bad = falling([1e-2 / 4**k for k in range(3)]), falling([1e-2, 1e-2, 1e-2])
    assert row(2.0, convergence=good).passed
    assert not row(2.0, convergence=bad).passed
    assert not row(3.0, convergence=good).passed
    assert row(good.finest, reference=0.0, tolerance=None, convergence=good).passed
    assert good.finest == 1e-2 / 16


def broken():
    yield row(2.0)
    raise ArithmeticError("no equilibrium")


@pytest.fixture
def small_suite(monkeypatch):
    """Two topics: one that passes, one with a row that fails and a check that cannot be computed."""
    good = check("cellar", "good")(lambda: [row(2.0, convergence=falling([1e-2 / 4**k for k in range(3)]))])
    off = check("attic", "off", quick=False)(lambda: [row(2.5), row(2.0)])
    monkeypatch.setattr(suite, "CHECKS", (good, off, check("attic", "broken", quick=False)(broken)))


def test_a_check_that_cannot_be_computed_is_a_row_that_fails(small_suite):
    found = run_suite(quick=False)
    assert (found.count, found.failures) == (4, 2)
    last = list(found.rows)[-1][1]
    assert not last.passed
    assert "no equilibrium" in last.note


def test_the_terminal_names_what_fails(small_suite):
    lines = table_lines(run_suite(quick=False))
    assert sum("FAIL" in line for line in lines) == 3
    assert lines[-1].endswith("2 FAIL")
    assert any("no equilibrium" in line for line in lines)
    assert table_lines(run_suite(quick=True))[-1].endswith("all pass")


def test_the_page_needs_nothing_from_elsewhere(small_suite):
    text = page(run_suite(quick=False))
    assert text.count("<svg") == 1
    assert "a quantity &lt;b&gt; [m]" in text
    assert "src=" not in text
    assert text.count("<link") == text.count('<link rel="icon" href="data:,">') == 1
    assert "default-src 'none'" in text
    assert "<script" not in text


def test_a_plot_is_the_same_bytes_again():
    errors = falling([1e-2, 3e-3, 6e-4])
    assert convergence_plot(errors) == convergence_plot(errors)


@pytest.mark.parametrize(("options", "code"), [(["--quick"], 0), ([], 3), (["--room", "cellar"], 0)])
def test_the_command_ends_with_3_if_a_row_fails(small_suite, tmp_path, capsys, options, code):
    assert main(["verify", *options, "--out", str(tmp_path), "--json"]) == code
    document = json.loads(capsys.readouterr().out)
    assert document == json.loads((tmp_path / "verify.json").read_text())
    assert document["passed"] is (code == 0)
    assert all(row["room"] == row["topic"] for row in document["rows"] + document["checks"])
    assert (tmp_path / "verify.html").stat().st_size > 1000


def test_an_unknown_topic_is_bad_input(small_suite, tmp_path, capsys):
    assert main(["verify", "--room", "celar", "--out", str(tmp_path)]) == 2
    assert "did you mean 'cellar'" in capsys.readouterr().err


def test_a_place_that_cannot_be_written_is_named_and_no_partial_table_is_left(
    small_suite, tmp_path, capsys, monkeypatch
):
    (tmp_path / "file").write_text("")
    assert main(["verify", "--out", str(tmp_path / "file"), "-q"]) == 2
    assert "file is a file, not a folder; choose another place" in capsys.readouterr().err

    def no_room(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(fem.results.files.os, "fsync", no_room)
    assert main(["verify", "--out", str(tmp_path / "v"), "-q"]) == 3
    message = capsys.readouterr().err
    assert "verify.json: cannot be written (No space left on device)" in message and "--out DIR" in message
    assert list((tmp_path / "v").iterdir()) == []
