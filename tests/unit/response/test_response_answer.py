"""What lasts, judged from sections, and what counts in the answer; its sentences are in `said/sentences.txt`."""

from dataclasses import replace

import numpy as np
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
from fem.response.orbit import GROWTH, amplitude_growth, classify


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


def logistic(rate: float, count: int = 48, settled: int = 3000) -> np.ndarray:
    """Iterates (count, 1) of x -> r x (1 - x), whose periods are known for every r."""
    x, taken = 0.31, []
    for k in range(settled + count):
        x = rate * x * (1.0 - x)
        if k >= settled:
            taken.append([x])
    return np.array(taken)


@pytest.mark.parametrize(("rate", "period"), [(2.8, 1), (3.2, 2), (3.5, 4), (3.55, 8), (3.832, 3)])
def test_the_periods_of_the_logistic_map_are_found(rate, period):
    # Period doubling at r = 3, 3.449, 3.544; the window of period 3 begins at 1 + sqrt(8) = 3.828.
    found = classify(logistic(rate), resting=False)
    assert (found.long_time, found.period_n) == ("periodic", period)
    assert found.pairs_compared == 48 - period


def test_its_chaos_has_no_period():
    found = classify(logistic(4.0), resting=False)
    assert (found.long_time, found.period_n) == ("not periodic", None)
    assert found.scatter > 0.1
    assert found.settling is not None and 0.5 < found.settling < 2.0


def test_an_irrational_rotation_has_no_period():
    angle = 2.0 * np.pi * 0.5 * (np.sqrt(5.0) - 1.0) * np.arange(48)
    found = classify(np.column_stack([np.cos(angle), np.sin(angle)]), resting=False)
    assert found.long_time == "not periodic"


def test_a_spiral_towards_a_fixed_point_is_not_settled():
    spiral = 0.95 ** np.arange(48)[:, None] * np.column_stack([np.cos(np.arange(48)), np.sin(np.arange(48))])
    found = classify(spiral, resting=False)
    assert found.long_time == "not settled"
    assert classify(0.95**200 * spiral, resting=False).long_time == "periodic"


def test_a_period_longer_than_a_third_of_the_window_is_not_claimed():
    sections = np.tile(np.arange(8.0), 3)[:20, None]
    found = classify(sections, resting=False)
    assert found.long_time == "not periodic"


def test_growing_amplitudes_diverge_and_bounded_ones_do_not():
    periods = np.arange(48)
    assert amplitude_growth(0.2 * 1.02**periods) > GROWTH > amplitude_growth(0.2 + 0.01 * np.sin(periods))
    assert amplitude_growth(1e-6 * 1.1**periods) < GROWTH  # of nothing
