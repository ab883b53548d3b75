"""Predictions of laboratory experiments; the motions of the rocks are not part of the project."""

import gzip
import math
from pathlib import Path

import numpy as np
import pytest
from validation import cube, impacts, pulses, rocks
from validation.shake_tests import ROCK, ROCK_MOTIONS, Body, ShakeTest, ShakeTestError, read_series
from validation.suite import document_of, require, run_validation
from validation.vote import Block

from fem.runtime.progress import Reporter

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
