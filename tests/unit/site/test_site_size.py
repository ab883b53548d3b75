"""Which values of a key fulfil the rule: scan, refinement, islands, the sentence."""

import json
from dataclasses import replace

import pytest
from site_answers import BOXES, FRICTION, STANDS, STRENGTH, WIDTH, ends, size
from site_example import INPUTS

from fem.results.json_text import to_json
from fem.site.figures import draw_size
from fem.site.size import SizeResult, size_result


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


def test_the_largest_action_is_what_all_weaker_ones_fulfil_as_well():
    result = size(STRENGTH, lambda strength: strength <= 1.7 or 2.2 <= strength <= 3.1)
    assert 1.7 / 1.0101 <= result.value <= 1.7


def test_friction_has_a_window():
    result = size(FRICTION, lambda mu: 0.2 < mu < 0.43)
    assert result.value is None
    ((low, high),) = result.intervals
    assert (low, high) == (pytest.approx(0.2, rel=0.011), pytest.approx(0.43, rel=0.011))


def test_stacks_are_counted_one_by_one():
    result = size(BOXES, lambda boxes: boxes != 4.0)
    assert (result.value, len(result.points)) == (3.0, 6)


@pytest.mark.parametrize(("axis", "fulfilled"), [(WIDTH, False), (WIDTH, True), (FRICTION, False)])
def test_a_range_without_a_change_is_not_refined(axis, fulfilled):
    result = size(axis, lambda _: fulfilled)
    assert result.value == (0.8 if fulfilled else None)
    assert len(result.points) == len(axis.values)


def test_a_least_value_needs_the_end_of_the_range():
    result = size(WIDTH, lambda width: 1.0 <= width <= 1.5)
    assert result.value is None


@pytest.mark.parametrize("answer", [None, "not sure"])
def test_only_fulfilled_is_fulfilled(answer):
    result = size_result(BOXES, dict.fromkeys(BOXES.values, replace(STANDS, answer=answer, fulfilled=None)))
    assert result.intervals == ()
    assert (result.points[0].fulfilled, result.points[0].answer) == (None, answer)


def test_the_result_survives_its_file_and_is_drawn():
    result = size(WIDTH, lambda width: width >= 1.5 or 1.0 <= width <= 1.21)
    assert SizeResult.from_json(json.loads(to_json(result.to_json()))) == result
    assert "The least width is" in draw_size(result, INPUTS)
    assert "not standing [%]" in draw_size(ends(overturned=0, invalid=2), INPUTS)


def test_values_must_rise():
    with pytest.raises(ValueError, match="at least two rising values"):
        replace(WIDTH, values=(1.0, 1.0))
