"""What counts in the answer of a response curve; its sentences are in `tests/said/sentences.txt`."""

from dataclasses import replace

import pytest
from study_words import CRUSHED, STANDS, point, record

from fem.response.lasting import (
    coexistences,
    differ,
    drop_outs,
    frequencies_of,
    overturned_share,
    shell_over_rigid,
)


@pytest.mark.parametrize(
    ("points", "share"),
    [
        (STANDS, 0.0),
        ((*STANDS[:3], point(0.5, "down", None)), 0.25),
        ((*STANDS[:3], point(0.5, "down", 0.1, **CRUSHED)), 0.25),
        ((STANDS[0], point(0.5, "down", None, status="failed")), 0.0),  # no outcome
        ((), None),
    ],
)
def test_the_share_that_does_not_stand_counts_points_with_an_outcome(points, share):
    assert overturned_share(points) == share


def test_a_destroyed_corner_neither_overturned_nor_coexists():
    destroyed = point(0.6, "up", None, motion="invalid")
    assert [fall.from_Hz for fall in drop_outs([record(point(0.5, "up", None)), record(destroyed)])] == [0.5]
    resting, rocking = point(0.5, "up", 0.0, long_time="rest"), point(0.5, "down", 0.2)
    assert differ(record(resting), record(rocking))
    assert len(list(coexistences(list(frequencies_of([record(resting), record(rocking)]))))) == 1
    destroyed = replace(rocking, motion="invalid")
    assert list(coexistences(list(frequencies_of([record(resting), record(destroyed)])))) == []


def test_the_shell_is_compared_where_both_rock():
    own = [point(0.5, "up", 0.4), point(0.6, "up", None), point(0.5, "down", 0.2), point(0.6, "down", 0.0)]
    shell = [
        replace(one, model="reduced") for one in (own[0], point(0.6, "up", 0.3), point(0.5, "down", 0.19))
    ]
    assert shell_over_rigid([record(one) for one in own + shell]) == (pytest.approx(0.95), 1.0)
    assert shell_over_rigid([record(one) for one in own]) == ()
