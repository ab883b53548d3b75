"""The sentence of a response curve: the largest motion that lasts, what falls, where motions coexist."""

from dataclasses import replace

import numpy as np
import pytest

from fem.response.answer import fell_share, lasting_in_words, overturned_share, response_answer
from fem.response.lasting import ResponseResult, coexistences, differ, drop_outs, frequencies_of
from fem.response.records import PointRecord, PointRow


def point(frequency, direction, ratio, long_time="periodic", status="completed", slip=0.0, motion="rock"):
    stands = ratio is not None
    return PointRow(
        number=round(10 * frequency),
        frequency_Hz=frequency,
        amplitude_m=0.1,
        peak_acceleration_m_s2=1.0,
        began="random" if direction == "start" else "carried",
        periods=1,
        direction=direction,
        rotation_ratio=ratio,
        median_rotation_ratio=ratio,
        slip_stroke_m=slip if stands else None,
        motion=motion if stands else None,
        long_time=long_time if stands and motion != "invalid" else None,
        period_n=1,
        status=status if stands or status == "failed" else "overturned",
    )


def record(row):
    return PointRecord(
        row=row, sections=np.zeros((1, 4)), extremes=np.zeros((1, 7)), portrait=np.zeros((1, 2))
    )


def curve(*points, status="completed", **found):
    records = [record(row) for row in points]
    frequencies = tuple(frequencies_of(records))
    return ResponseResult(
        asked="",
        status=status,
        points=tuple(row for row in points if row.direction != "start"),
        frequencies=frequencies,
        coexisting=tuple(coexistences(frequencies)),
        drop_outs=tuple(drop_outs(records)),
        starts_fell_share=fell_share(frequencies),
        **found,
    )


STANDS = (point(0.5, "up", 0.1), point(1.0, "up", 0.62), point(1.0, "down", 0.3), point(0.5, "down", 0.1))
STARTS = (
    point(1.0, "start", 0.9),
    point(1.0, "start", 0.62),
    point(1.0, "start", None),
    point(0.5, "start", None),
)
UP = "largest lasting motion 0.62 of the slenderness angle, rock of period 1 at 1 Hz (going up)"
EVERY = "stood at every frequency tried, 0.5 to 1 Hz, up and down"


@pytest.mark.parametrize(
    ("result", "sentence"),
    [
        (curve(*STANDS), f"{UP}; {EVERY}; motions coexist at 1 Hz"),
        (
            curve(*STANDS, *STARTS),
            "largest lasting motion 0.9 of the slenderness angle, rock of period 1 at 1 Hz, which neither sweep meets "
            f"(1 of 3 starts); 50 % of 4 random starts overturn; {EVERY}; motions coexist at 1 Hz",
        ),
        (
            curve(*STANDS[:3], point(0.5, "down", None)),
            f"{UP}; overturned at 0.5 Hz going down; stood at the other 3 points; motions coexist at 1 Hz",
        ),
        (
            curve(point(0.5, "up", None), point(0.5, "down", None)),
            "overturned at every frequency tried, 0.5 Hz",
        ),
        (
            curve(point(0.5, "up", 0.0, "rest"), point(1.0, "up", None, status="failed"), status="failed"),
            "at rest wherever it stands; stood at every frequency with an outcome, 0.5 Hz, up and down; no outcome at "
            "1 of 2 points",
        ),
        (
            curve(*STANDS[:2], point(0.5, "down", 0.1, slip=0.064)),
            f"{UP}; {EVERY}; slid by up to 64 mm a period, at 0.5 Hz going down; motions coexist at 0.5 Hz",
        ),
        (
            curve(*STANDS[:2], point(0.5, "down", 0.1, motion="invalid")),
            f"{UP}; not valid at 1 point, the first at 0.5 Hz going down: a corner is destroyed; stood at the other 2 "
            "points",
        ),
        (
            curve(point(0.5, "up", 0.1, motion="invalid"), point(1.0, "start", 0.1, motion="invalid")),
            "100 % of 1 random starts overturn or destroy a corner; not valid at every frequency tried, 0.5 Hz: a "
            "corner is destroyed",
        ),
        (curve(*STANDS, status="interrupted"), None),
        (curve(point(0.5, "up", None, status="failed"), status="failed"), None),
    ],
)
def test_a_curve_has_one_sentence(result, sentence):
    assert response_answer(result) == (sentence and f"frequency: {sentence}")


@pytest.mark.parametrize(
    ("points", "share"),
    [
        (STANDS, 0.0),
        ((*STANDS[:3], point(0.5, "down", None)), 0.25),
        ((*STANDS[:3], point(0.5, "down", 0.1, motion="invalid")), 0.25),
        ((STANDS[0], point(0.5, "down", None, status="failed")), 0.0),  # no outcome
        ((), None),
    ],
)
def test_the_share_that_does_not_stand_counts_points_with_an_outcome(points, share):
    assert overturned_share(points) == share


def test_what_lasts_is_listed_with_what_leads_to_it():
    assert [words for _, words in lasting_in_words(curve(*STANDS, *STARTS))] == [
        "0.100 rock of period 1 (up, down); 1 of 1 starts overturn",
        "0.900 rock of period 1 (1 of 3 starts); 0.620 rock of period 1 (up, 1 of 3 starts); 0.300 rock of period 1 "
        "(down); 1 of 3 starts overturn",
    ]


def test_a_destroyed_corner_neither_overturned_nor_coexists():
    destroyed = replace(point(0.6, "up", None), motion="invalid")
    assert [fall.from_Hz for fall in drop_outs([record(point(0.5, "up", None)), record(destroyed)])] == [0.5]
    resting, rocking = point(0.5, "up", 0.0, "rest"), point(0.5, "down", 0.2)
    assert differ(record(resting), record(rocking))
    assert len(list(coexistences(list(frequencies_of([record(resting), record(rocking)]))))) == 1
    destroyed = replace(rocking, motion="invalid")
    assert list(coexistences(list(frequencies_of([record(resting), record(destroyed)])))) == []
