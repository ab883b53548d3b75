"""Which values of a key fulfil the rule: scan, refinement, islands, the sentence."""

import json
from dataclasses import replace

import pytest
from site_example import INPUTS

from fem.results.files import to_json
from fem.site.figures import draw_size
from fem.site.result import SiteAnswer
from fem.site.size import SizeAxis, SizeResult, next_values, size_result, spaced

ANSWER = SiteAnswer(
    answer="fulfilled",
    fulfilled=True,
    rule="",
    sentence="",
    overturned=0,
    runs=28,
    rotation_ratio=0.1,
    slip_m=0.01,
)
FELL = replace(
    ANSWER, answer="not fulfilled", fulfilled=False, overturned=3, rotation_ratio=None, slip_m=None
)
WIDTH = SizeAxis(
    key="container.width_m", words="width", unit="m", wanted="least", values=spaced(0.8, 2.0, 13)
)
STRENGTH = SizeAxis(
    key="site.reference_acceleration_m_s2",
    words="reference acceleration",
    unit="m/s2",
    wanted="largest",
    values=spaced(0.2, 6.0, 15),
)
FRICTION = SizeAxis(
    key="contact.mu_static", words="static friction", unit="", wanted="window", values=spaced(0.1, 0.8, 15)
)
BOXES = SizeAxis(
    key="container.boxes",
    words="number of boxes",
    unit="",
    wanted="largest",
    values=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
    whole=True,
)


def size(axis: SizeAxis, fulfils) -> SizeResult:
    """The result where `fulfils(value)` says which values do; every value is asked for once."""
    found: dict[float, SiteAnswer] = {}
    while values := next_values(axis, found):
        assert not set(values) & set(found)
        found |= {value: ANSWER if fulfils(value) else FELL for value in values}
    return size_result(axis, found)


def test_the_least_width_is_found_within_one_per_cent_on_the_side_that_fulfils():
    result = size(WIDTH, lambda width: width >= 1.2345)
    assert 1.2345 <= result.value <= 1.2345 * 1.0101
    assert result.intervals == ((result.value, 2.0),)
    assert result.sentence.startswith("The least width is 1.2")
    assert float(result.sentence.split()[4]) >= result.value
    assert len(result.points) < 25


def test_an_island_below_does_not_count_and_is_told():
    result = size(WIDTH, lambda width: width >= 1.5 or 1.0 <= width <= 1.21)
    assert 1.5 <= result.value <= 1.515
    assert [low for low, _ in result.intervals] == pytest.approx([1.0, 1.5], rel=0.011)
    assert "; also from 1" in result.sentence
    assert "an island that does not count" in result.sentence


def test_a_narrow_island_has_the_figures_that_tell_its_ends_apart():
    points = {0.8: FELL, 1.103125: ANSWER, 1.1075: ANSWER, 1.12: FELL, 1.5: ANSWER, 2.0: ANSWER}
    result = size_result(replace(WIDTH, values=(0.8, 2.0)), points)
    assert result.sentence == (
        "The least width is 1.5 m: the rule is fulfilled from there to 2 m (below: it overturns); also from 1.104 m to "
        "1.107 m, an island that does not count."
    )


def test_the_largest_action_is_what_all_weaker_ones_fulfil_as_well():
    result = size(STRENGTH, lambda strength: strength <= 1.7 or 2.2 <= strength <= 3.1)
    assert 1.7 / 1.0101 <= result.value <= 1.7
    assert result.sentence.startswith("The largest reference acceleration is 1.6")
    assert "m/s2 to there (above: it overturns); also from 2.2" in result.sentence


def test_friction_has_a_window():
    result = size(FRICTION, lambda mu: 0.2 < mu < 0.43)
    assert result.value is None
    ((low, high),) = result.intervals
    assert (low, high) == (pytest.approx(0.2, rel=0.011), pytest.approx(0.43, rel=0.011))
    assert "for a static friction from 0.2" in result.sentence


def test_stacks_are_counted_one_by_one():
    result = size(BOXES, lambda boxes: boxes != 4.0)
    assert (result.value, len(result.points)) == (3.0, 6)
    assert result.sentence == (
        "The largest number of boxes is 3: the rule is fulfilled from 1 to there (above: it overturns); also from 5 "
        "to 6, an island that does not count."
    )


@pytest.mark.parametrize(
    ("axis", "fulfilled", "words"),
    [
        (WIDTH, False, "not fulfilled at any width tried from 0.8 m to 2 m"),
        (WIDTH, True, "fulfilled at every width tried from 0.8 m to 2 m"),
        (FRICTION, False, "not fulfilled at any static friction tried"),
    ],
)
def test_a_range_without_a_change_is_told(axis, fulfilled, words):
    result = size(axis, lambda _: fulfilled)
    assert words in result.sentence
    assert result.value == (0.8 if fulfilled else None)
    assert len(result.points) == len(axis.values)


def test_a_least_value_needs_the_end_of_the_range():
    result = size(WIDTH, lambda width: 1.0 <= width <= 1.5)
    assert result.value is None
    assert "The rule is fulfilled for a width from 1" in result.sentence


@pytest.mark.parametrize(
    ("exceeded", "words"),
    [
        (("rotation_ratio",), "(above: rotation is beyond the limit)."),
        (("single_rotation_ratio",), "(above: the rotation of one motion is beyond the limit)."),
        (("slip_m",), "(above: slip is beyond the limit)."),
        (("rotation_ratio", "slip_m"), "(above: rotation and slip are beyond the limit)."),
        ((), "(above: the wind moves it)."),
    ],
)
def test_what_fails_beyond_is_told(exceeded, words):
    beyond = replace(ANSWER, answer="not fulfilled", fulfilled=False, exceeded=exceeded)
    assert size_result(BOXES, {1.0: ANSWER, 6.0: beyond}).sentence.endswith(words)
    assert "from 1 to 6: it overturns or " in size_result(BOXES, {1.0: FELL, 6.0: beyond}).sentence


def test_a_value_that_is_refused_for_destroyed_corners_says_so():
    crushed = replace(FELL, overturned=0, invalid=2)
    result = size_result(BOXES, {1.0: ANSWER, 6.0: crushed})
    assert result.sentence.endswith("(above: a corner is destroyed).")
    assert "not standing [%]" in draw_size(result, INPUTS)


@pytest.mark.parametrize(("answer", "words"), [(None, "there is no answer"), ("not sure", "it is not sure")])
def test_only_fulfilled_is_fulfilled(answer, words):
    found = replace(ANSWER, answer=answer, fulfilled=None)
    result = size_result(BOXES, dict.fromkeys(BOXES.values, found))
    assert result.intervals == () and words in result.sentence
    assert (result.points[0].fulfilled, result.points[0].answer) == (None, answer)


def test_the_result_survives_its_file_and_is_drawn():
    result = size(WIDTH, lambda width: width >= 1.5 or 1.0 <= width <= 1.21)
    assert SizeResult.from_json(json.loads(to_json(result.to_json()))) == result
    assert "The least width is" in draw_size(result, INPUTS)


def test_values_must_rise():
    with pytest.raises(ValueError, match="at least two rising values"):
        replace(WIDTH, values=(1.0, 1.0))
