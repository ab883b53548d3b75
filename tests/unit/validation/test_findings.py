"""Findings: what is missed comes first, and what is not computed is named."""

import pytest

from fem.evidence.validation.findings import Experiment, Prediction, ValidationResult
from fem.evidence.validation.page import page, table_lines


def finding(passed: bool | None) -> Prediction:
    return Prediction(
        quantity="side", measured=1.0, predicted=0.5, criterion="" if passed is None else "all", passed=passed
    )


def experiment(name: str, *passed: bool | None, not_computed: str = "") -> Experiment:
    return Experiment(
        name=name,
        title=name,
        source="a paper",
        licence="none",
        tests=3,
        fitted="nothing",
        findings=tuple(map(finding, passed)),
        not_computed=not_computed,
    )


@pytest.mark.parametrize(
    ("experiments", "sentence"),
    [
        ([experiment("a", True, None)], "All 1 predictions meet their criterion."),
        ([experiment("a", True), experiment("b", False)], "1 of 2 predictions miss their criterion (b)."),
        (
            [experiment("a", True), experiment("b", not_computed="no data")],
            "; 1 of 2 experiments not computed.",
        ),
        ([experiment("b", not_computed="no data")], "No experiment was computed."),
    ],
)
def test_the_sentence_names_what_is_missed_and_what_is_not_computed(experiments, sentence):
    assert ValidationResult(experiments=tuple(experiments)).sentence.endswith(sentence)


def test_an_experiment_that_is_missed_comes_first_on_the_page_and_in_the_terminal():
    result = ValidationResult(experiments=(experiment("held", True), experiment("failed", False)))
    text = page(result)
    assert text.index('id="failed"') < text.index('id="held"')
    lines = table_lines(result)
    assert lines.index("failed  (3 tests, 0 s)") < lines.index("held  (3 tests, 0 s)")
    assert any("MISSED" in line for line in lines)


def test_the_json_has_every_finding():
    result = ValidationResult(experiments=(experiment("a", False, None),))
    document = result.to_dict({"fem": "1"})
    assert (document["passed"], document["missed"], document["judged"]) == (False, 1, 1)
    assert [one["passed"] for one in document["experiments"][0]["findings"]] == [False, None]
