"""Experiments: what is missed comes first, and what is not computed is named; specimens have their mass properties."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from evidence.findings import prediction
from evidence.pages import page_of, validation_lines
from runs import STACK
from validation import contents
from validation.bodies import cross_validated, specimen
from validation.experiments import Experiment, document_of, in_a_sentence
from validation.vote import SHARE, Block, Vote, best_threshold, by_threshold, probabilities, with_neighbours

from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions
from mesh.errors import MeshError

SIZES = {"container.width_m": 0.1, "container.height_m": 0.8, "container.depth_m": 0.7}
BLOCK = STACK.with_values(SIZES | {"container.mass_kg": 350.0, "solver.element_size_m": 0.3})


def experiment(name: str, *met: bool | None, not_computed: str = "") -> Experiment:
    words = {"title": name, "source": "a paper", "licence": "none", "fitted": "nothing"}
    side = partial(prediction, "side", 0.5, reference=1.0)
    findings = tuple(side(criterion="" if one is None else "all", met=one) for one in met)
    return Experiment(name=name, tests=3, findings=findings, not_computed=not_computed, **words)


def test_the_sentence_names_what_is_missed_what_is_not_computed_and_what_tells_most():
    held, lacking = experiment("a", True, None), experiment("b", not_computed="no data")
    off = prediction("restitution", "1.002", reference=0.95, telling=True)
    for experiments, sentence in (
        ([held], "1 of 1 judged predictions meet their criterion; 1 are stated and not judged."),
        (
            [experiment("a", True), experiment("b", False)],
            "1 of 2 judged predictions meet their criterion; missed: b.",
        ),
        ([experiment("a", True), lacking], "; 1 of 2 experiments not computed (b)."),
        ([lacking], "No experiment was computed."),
        (
            [replace(held, findings=(*held.findings, off))],
            "2 are stated and not judged, of which 1 tell most (restitution: measured 0.95, predicted 1.002).",
        ),
    ):
        assert in_a_sentence(experiments).endswith(sentence)


def test_a_vote_is_weighted_by_what_the_blocks_said_of_the_others():
    # Two blocks: the first is right of three records, the second of one; the fourth is asked for.
    falls = np.array([[1, 0, 1, 1], [0, 1, 1, 0]], dtype=float)
    vote = Vote(falls={"all": falls}, overturned=np.array([1, 0, 1, 1], dtype=bool), records=np.arange(4))
    fitted = np.array([1, 1, 1, 0], dtype=bool)
    odds = (0.93 / 0.07) ** 2
    assert vote.votes("all", fitted, ~fitted) == pytest.approx([odds / (1.0 + odds)])
    assert probabilities(np.array([0.0, 0.5, 1.0])) == pytest.approx([0.02, 0.5, 0.98])


def test_two_specimens_that_depart_from_one_block_differ_as_often_as_the_twins():
    # 0.13 of the 582 tests of both rocks: one of the two departs.
    departs = SHARE
    assert 2.0 * departs * (1.0 - departs) == pytest.approx(0.13, abs=0.005)


def test_a_block_says_the_share_of_its_neighbours_in_angle_that_overturn():
    angles = np.linspace(0.04, 0.16, 9)
    blocks = [Block(angle=angle, restitution=one) for one in (1.0, 0.9) for angle in angles]
    falling = np.array([*(angles < 0.08), *(angles < 0.0)])[:, None]
    said = with_neighbours(blocks, falling)[:, 0]
    assert said[:9] == pytest.approx([3 / 4, 3 / 5, 3 / 6, 3 / 7, 2 / 7, 1 / 7, 0.0, 0.0, 0.0])
    assert not said[9:].any()


def test_tests_of_one_record_are_not_in_the_fit_that_predicts_them():
    falls = np.array([[1, 1, 0], [0, 0, 0]], dtype=float)
    vote = Vote(falls={"all": falls}, overturned=np.array([1, 1, 0], dtype=bool), records=np.array([0, 0, 1]))
    every = np.ones(3, dtype=bool)
    found = vote.by_record(every, partial(vote.votes, "all"))
    # both blocks say the third; without the other of its record
    assert found == pytest.approx([0.5, 0.5, 0.0])


def test_the_family_that_predicts_better_is_taken():
    good, bad = np.array([[1, 0, 1, 0]], dtype=bool), np.array([[0, 1, 1, 0]], dtype=bool)
    falls = {"bad": bad.astype(float), "good": good.astype(float)}
    vote = Vote(falls=falls, overturned=good[0], records=np.arange(4))
    assert vote.family(np.ones(4, dtype=bool)) == "good"


def test_a_threshold_is_fitted_to_the_measure_that_separates():
    measures = [np.array([1.0, 2.0, 3.0, 4.0]), np.array([4.0, 1.0, 3.0, 2.0])]
    overturned = np.array([0, 0, 1, 1], dtype=bool)
    assert by_threshold(measures, overturned, np.ones(4, dtype=bool)).tolist() == overturned.tolist()
    assert best_threshold(measures[0], overturned) == (4, 2.5)
    assert best_threshold(measures[1], overturned)[0] == 3


def test_an_experiment_that_is_missed_comes_first_on_the_page_and_in_the_terminal():
    document = document_of([experiment("held", True), experiment("failed", False)])
    text = page_of("validate", document, {"held": [], "failed": []})
    assert text.index('id="failed"') < text.index('id="held"')
    lines = validation_lines(document)
    assert lines.index("failed  (3 tests, 0 s)") < lines.index("held  (3 tests, 0 s)")
    assert any("MISSED" in line for line in lines)


def test_the_json_has_every_finding():
    document = document_of([experiment("a", False, None)])
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


def test_the_published_medians_of_contents_are_one_share_of_a_velocity():
    shares = [one.median / one.velocity for one in contents.read_contents()]
    assert len(shares) == 9
    assert np.mean(shares) == pytest.approx(0.79, abs=0.005) and np.ptp(shares) < 0.07


def test_the_fragility_of_a_bookcase_is_counted_and_a_step_is_refused():
    action = SiteAction(shape=eurocode_shape(1, "C"), reference_acceleration=2.0)
    motions = artificial_motions(action, count=6, seed=1, stationary=10.0, vertical=False)
    tall = contents.read_contents()[4]
    assert contents.fragility(tall, motions).median == pytest.approx(0.88, rel=0.25)
    with pytest.raises(ArithmeticError, match="no curve fits"):
        contents.fragility(tall, motions[:1])
