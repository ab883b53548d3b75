"""Experiments: what is missed comes first, and what is not computed is named; specimens have their mass properties."""

import pytest

from fem.evidence.findings import prediction
from fem.evidence.validation.bodies import cross_validated, specimen
from fem.evidence.validation.experiments import Experiment, ValidationResult
from fem.evidence.validation.page import lines_of, page_of
from fem.evidence.verification.runs import STACK
from mesh.errors import MeshError

BLOCK = STACK.with_values(
    {
        "container.width_m": 0.1,
        "container.height_m": 0.8,
        "container.depth_m": 0.7,
        "container.mass_kg": 350.0,
        "solver.element_size_m": 0.3,
    }
)


def experiment(name: str, *met: bool | None, not_computed: str = "") -> Experiment:
    return Experiment(
        name=name,
        title=name,
        source="a paper",
        licence="none",
        tests=3,
        fitted="nothing",
        findings=tuple(
            prediction("side", 0.5, reference=1.0, criterion="" if one is None else "all", met=one)
            for one in met
        ),
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
    text = page_of(result)
    assert text.index('id="failed"') < text.index('id="held"')
    lines = lines_of(result)
    assert lines.index("failed  (3 tests, 0 s)") < lines.index("held  (3 tests, 0 s)")
    assert any("MISSED" in line for line in lines)


def test_the_json_has_every_finding():
    result = ValidationResult(experiments=(experiment("a", False, None),))
    document = result.to_dict()
    assert (document["passed"], document["missed"], document["judged"]) == (False, 1, 1)
    assert [one["passed"] for one in document["experiments"][0]["findings"]] == [False, None]


@pytest.mark.parametrize(("centroid", "inertia"), [(0.3, 0.0526), (0.4, 0.06), (0.45, 0.04)])
def test_a_specimen_has_its_mass_centre_and_inertia(centroid, inertia):
    mesh = specimen(BLOCK, centroid=centroid, inertia_ratio=inertia).mesh
    assert mesh.mass == pytest.approx(350.0)
    assert mesh.centroid == pytest.approx((0.0, centroid))
    assert mesh.inertia / mesh.mass == pytest.approx(inertia)


def test_an_impossible_inertia_is_refused():
    with pytest.raises(MeshError, match="no body of"):
        specimen(BLOCK, centroid=0.4, inertia_ratio=1.0)


def test_each_test_is_predicted_by_a_fit_on_the_others():
    halves = cross_validated([1, 2, 3, 4, 5], sum)
    assert halves == [(9, [2, 4]), (6, [1, 3, 5])]
