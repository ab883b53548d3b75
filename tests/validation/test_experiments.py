"""Predictions of laboratory experiments; the motions of the rocks are not part of the project."""

import gzip
import math
from pathlib import Path

import numpy as np
import pytest

from fem.evidence.validation import cube, impacts, pulses, rocks
from fem.evidence.validation.suite import run_validation

DATA = Path(__file__).parents[3] / "shared" / "experiments"


def test_the_cube_rebounds_to_the_side_it_comes_from():
    landing = next(one for one in cube.read_landings() if one.toss == 412)
    assert math.degrees(landing.rebound) == pytest.approx(3.1, abs=0.05)
    found = cube.landed(landing, 0.3)
    assert found.same_side > 5.0 * found.other_side
    assert 0.5 < found.same_side / landing.rebound < 2.0


def test_friction_decides_the_side():
    landing = next(one for one in cube.read_landings() if one.toss == 412)
    found = cube.landed(landing, 0.3, 0.8)
    assert found.other_side > found.same_side


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


def test_measured_restitutions():
    found = impacts.compute()
    assert found.tests == 3
    assert not found.missed
    judged = [one for one in found.findings if one.holds is not None]
    assert [one.reference for one in judged] == [0.67]
    assert "fitted" in judged[0].what


def test_a_folder_of_another_kind_is_refused(tmp_path):
    with pytest.raises(rocks.MotionFolderError, match="no granite_rock_motions"):
        run_validation(tmp_path)
    (tmp_path / rocks.MOTIONS).write_text("no gzip")
    with pytest.raises(rocks.MotionFolderError, match="not a table of rock motions"):
        run_validation(tmp_path)
    with gzip.open(tmp_path / rocks.MOTIONS, "wt") as file:
        file.write("time,value\n0,1\n")
    with pytest.raises(rocks.MotionFolderError, match="not a table of rock motions"):
        run_validation(tmp_path)


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="the motions of the rocks are not here")
def test_the_experiments_meet_their_criteria():
    result = run_validation(DATA)
    assert result.failures == 0, result.sentence


@pytest.mark.skipif(not DATA.is_dir(), reason="the motions of the rocks are not here")
def test_a_rock_under_two_table_motions():
    tests = {test.number: test for test in rocks.read_tests(DATA)}
    assert np.abs(tests[14].acceleration).max() / 9.81 == pytest.approx(0.075, abs=5e-4)
    assert not rocks.overturns(tests[14], 0.1)
    assert rocks.overturns(tests[97], 0.1)
