"""Predictions of laboratory experiments; the motions of the rocks are not part of the project.

Then what is said of experiments: what is missed comes first, and what is not computed is named; the vote of blocks, and
specimens with their mass properties.
"""

import gzip
import math
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from evidence.findings import prediction
from evidence.pages import page_of, validation_lines
from runs import STACK
from validation import contents, cube, impacts, pulses, rocks
from validation.bodies import cross_validated, specimen
from validation.experiments import Experiment, document_of, in_a_sentence
from validation.shake_tests import ROCK, ROCK_MOTIONS, Body, ShakeTest, ShakeTestError, read_series
from validation.suite import require, run_validation
from validation.vote import SHARE, Block, Vote, best_threshold, by_threshold, probabilities, with_neighbours

from fem.runtime.progress import Reporter
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions
from mesh.errors import MeshError

DATA = Path(__file__).parents[3] / "shared" / "experiments"
ROCKS = pytest.mark.skipif(not DATA.is_dir(), reason="the motions of the rocks are not here")


def test_the_cube_rebounds_to_the_side_it_comes_from_where_it_can_slide():
    landing = next(one for one in cube.read_landings() if one.toss == 412)
    assert math.degrees(landing.rebound) == pytest.approx(3.1, abs=0.05)
    found, held = cube.landed(landing, 0.3), cube.landed(landing, 0.3, 0.8)
    assert found.same_side > 5.0 * found.other_side
    assert 0.5 < found.same_side / landing.rebound < 2.0
    assert held.other_side > held.same_side


def test_the_restitution_of_a_point_on_a_dashpot():
    # Without damping it keeps its speed; one of the ratio 1/2 alone keeps exp(-pi 2/(3 sqrt(3)) ..) of it.
    assert cube.restitution_of(1e-9) == pytest.approx(1.0, abs=1e-6)
    half = 0.5 / math.sqrt(1.0 + (0.5 * cube.SIDE) ** 2 / cube.INERTIA)
    assert cube.restitution_of(half) == pytest.approx(math.exp(-2.0 * math.pi / (3.0 * math.sqrt(3.0))))


def test_the_kicked_block():
    size = pulses.BlockSize(angle=0.2, radius=0.05)
    kicks = pulses.read_kicks()
    assert len(kicks) == 65
    right = sum(pulses.predicted(size, kick) == kick.overturned for kick in kicks)
    assert right / len(kicks) > 0.8


def test_on_rubber_the_width_of_the_block_decides_and_on_concrete_it_does_not():
    soft = [impacts.restitution_ratio("rubber", 5.0, width) for width in (0.1, 0.3, 0.5)]
    assert soft[0] > 0.95 > soft[1] > 0.8 > soft[2] > 0.4
    # A deeper strip and a stiffer rubber carry more: less sinking, more left.
    assert impacts.restitution_ratio("rubber", 5.0, 0.5, strip=0.25) > soft[2]
    assert impacts.restitution_ratio("rubber", 5.0, 0.5, modulus=7.1e6) > soft[2]
    hard = [impacts.restitution_ratio("concrete", 3.0, width) for width in (0.1, 0.5)]
    assert hard == pytest.approx([1.01, 1.01], abs=0.01)


def test_a_folder_of_another_kind_is_refused(tmp_path):
    with pytest.raises(ShakeTestError, match=r"neither granite_rock_motions.* nor outcomes.csv"):
        require(tmp_path)
    (tmp_path / ROCK_MOTIONS).write_text("no gzip")
    with pytest.raises(ShakeTestError, match="not a table of rock motions"):
        require(tmp_path)
    with gzip.open(tmp_path / ROCK_MOTIONS, "wt") as file:
        file.write("time,value\n0,1\n")
    with pytest.raises(ShakeTestError, match="not a table of rock motions"):
        require(tmp_path)


BODY = """
mass_kg = 400.0
height_m = 0.8
centroid_m = 0.4
inertia_m2 = 0.055
slenderness_angle_rad = [0.1, 0.3]
unit = "m/s2"
"""


TIMES = np.arange(0.0, 2.0, 0.01)
SINE = np.where(TIMES < 1.5, np.sin(2.0 * np.pi * TIMES / 1.5), 0.0)


def own_tests(folder, rows, body=BODY):
    """A folder of tests on one motion, a sine of 1 m/s2 of 1.5 s, scaled."""
    lines = (f"{t:.2f},{a:.6f}" for t, a in zip(TIMES, SINE, strict=True))
    (folder / "sine.csv").write_text("\n".join(lines))
    (folder / "body.toml").write_text(body)
    (folder / "outcomes.csv").write_text("\n".join(["motion,scale,record,set,overturned", *rows]) + "\n")
    return folder


def outcomes_of(block, scales):
    """What a block of the program does under the sine, as rows of a table."""
    body = Body(mass=400.0, height=0.8, centroid=0.4, inertia=0.055, angles=(0.1, 0.3))
    done = {"name": "", "record": "", "overturned": (), "simulated": (), "fitted": True}
    for scale in scales:
        test = ShakeTest(**done, times=TIMES, acceleration=scale * SINE)
        yield f"sine.csv,{scale:g},{scale:g},,{int(rocks.overturns(body, block, test))}"


def test_a_users_own_tests_are_predicted_and_not_judged(tmp_path, monkeypatch):
    monkeypatch.setattr(rocks, "ANGLES", 9)
    monkeypatch.setattr(rocks, "UPLIFTS", (0.04,))
    rows = list(outcomes_of(Block(angle=0.2), np.linspace(1.0, 6.0, 12)))
    assert {row[-1] for row in rows} == {"0", "1"}
    found = rocks.compute(own_tests(tmp_path, rows))
    agreement, brier = found.findings[:2]
    assert (found.tests, found.missed) == (12, 0)
    assert agreement.holds is None and agreement.value >= 0.8  # the outcomes of a block, by blocks
    assert brier.value < 0.1
    assert "0.2" in found.fitted and found.figures[0].svg.startswith("<?xml")


def test_tests_set_apart_are_predicted_by_the_others(tmp_path, monkeypatch):
    monkeypatch.setattr(rocks, "ANGLES", 5)
    monkeypatch.setattr(rocks, "UPLIFTS", ())
    rows = list(outcomes_of(Block(angle=0.2), np.linspace(1.0, 6.0, 8)))
    rows = [row.replace(",,", ",fit," if k % 2 else ",predict,") for k, row in enumerate(rows)]
    assert rocks.compute(own_tests(tmp_path, rows)).tests == 4


REFUSED_ROWS = {
    "row 2: overturned must be 0 or 1": ["sine.csv,1,,,2"],
    "row 3: .*none.csv": ["sine.csv,1,,,0", "none.csv,1,,,1"],
    "row 2: scale must be finite and not zero": ["sine.csv,0,,,1"],
    "row 2: scale must be a number": ["sine.csv,x,,,1"],
    "row 2: set must be fit or predict": ["sine.csv,1,,both,1"],
    "too few tests": ["sine.csv,1,,,1"],
    "header needs the columns": [],
}
REFUSED_BODIES = {
    "mass_kg is missing": ("mass_kg = 400.0\n", ""),
    "mass_kg must be a positive number, got -4": ("400.0", "-4"),
    "must rise": ("[0.1, 0.3]", "[0.3, 0.1]"),
    r"must be \[least, largest\]": ("[0.1, 0.3]", "0.2"),
    "unknown key mass;": ("mass_kg", "mass"),
    "unit must be text": ('"m/s2"', "3"),
}


@pytest.mark.parametrize("words", [*REFUSED_ROWS, *REFUSED_BODIES])
def test_outcomes_and_a_body_that_cannot_be_used_are_refused(tmp_path, words):
    rows = REFUSED_ROWS.get(words, ["sine.csv,1,,,1", "sine.csv,2,b,,1"])
    with pytest.raises(ShakeTestError, match=words):
        read_series(own_tests(tmp_path, rows, BODY.replace(*REFUSED_BODIES.get(words, ("", "")))))


@pytest.mark.slow
@pytest.mark.parametrize("data", [None, pytest.param(DATA, marks=ROCKS)], ids=["without rocks", "all"])
def test_the_experiments_meet_their_criteria(data):
    document = document_of(run_validation(data, reporter=Reporter()))
    assert document["passed"], document["sentence"]


@ROCKS
def test_a_rock_under_two_table_motions():
    tests = {test.name: test for test in read_series(DATA).tests}
    assert np.abs(tests["test 14"].acceleration).max() / 9.81 == pytest.approx(0.075, abs=5e-4)
    assert not rocks.overturns(ROCK, Block(angle=0.1), tests["test 14"])
    assert rocks.overturns(ROCK, Block(angle=0.1), tests["test 97"])


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
