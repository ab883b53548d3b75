"""Which values of a key fulfil the rule: scan, refinement, islands, the sentence."""

import json

import pytest
from site_answers import FRICTION, WIDTH, ends, size
from site_example import INPUTS

from fem.results.json_block import to_json
from fem.site.page import draw_size
from fem.site.result import SizeResult


def test_the_least_width_is_found_within_one_per_cent_on_the_side_that_fulfils():
    result = size(WIDTH, lambda width: width >= 1.2345)
    assert 1.2345 <= result.value <= 1.2345 * 1.0101
    assert result.intervals == ((result.value, 2.0),)
    assert result.sentence.startswith("The least width is 1.2")
    assert float(result.sentence.split()[4]) >= result.value
    assert len(result.points) < 25


@pytest.mark.parametrize(("axis", "fulfilled"), [(WIDTH, False), (WIDTH, True), (FRICTION, False)])
def test_a_range_without_a_change_is_not_refined(axis, fulfilled):
    result = size(axis, lambda _: fulfilled)
    assert result.value == (0.8 if fulfilled else None)
    assert len(result.points) == len(axis.values)


def test_the_result_survives_its_file_and_is_drawn():
    result = size(WIDTH, lambda width: width >= 1.5 or 1.0 <= width <= 1.21)
    assert SizeResult.from_json(json.loads(to_json(result.to_json()))) == result
    assert "The least width is" in draw_size(result, INPUTS)
    assert "not standing [%]" in draw_size(ends(overturned=0, invalid=2), INPUTS)
