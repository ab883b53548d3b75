"""The sentence of a response curve: where it overturned, how far it turned, where two motions coexist."""

from dataclasses import replace

import numpy as np
import pytest

from fem.response.answer import fates_of, response_answer
from fem.response.branches import Coexistence, DropOut, differ, drop_outs, jumps
from fem.response.records import PointRecord, PointRow
from fem.response.result import ResponseResult


def point(
    frequency, direction, ratio, long_time="periodic", status="completed", slip=0.0, motion="rock", reach=0.0
):
    stands = ratio is not None
    return PointRow(
        number=0,
        frequency_Hz=frequency,
        amplitude_m=0.1,
        peak_acceleration_m_s2=1.0,
        began="carried",
        periods=1,
        direction=direction,
        rotation_ratio=ratio,
        slip_stroke_m=slip if stands else None,
        slip_excursion_m=reach if stands else None,
        motion=motion if stands else None,
        long_time=long_time if stands else None,
        status=status if stands or status == "failed" else "overturned",
    )


def curve(*points, status="completed", **found):
    return ResponseResult(asked="", status=status, points=points, **found)


STANDS = (point(0.5, "up", 0.1), point(1.0, "up", 0.62), point(1.0, "down", 0.3), point(0.5, "down", 0.1))
#: 48 mm peak to peak, drifting to the left by 1 mm a period: 96 mm from the start after 48 periods
WALKS = (point(1.0, "down", 0.3, slip=0.048, reach=0.096), point(0.5, "down", 0.1, slip=0.064))
FALL = DropOut(direction="down", from_Hz=0.9, to_Hz=0.5, frequencies=2, carried=True)
TWO = Coexistence(from_Hz=1.0, to_Hz=1.0, frequencies=1, up=("rock",), down=("rest",))


@pytest.mark.parametrize(
    ("result", "sentence"),
    [
        (
            curve(*STANDS, coexisting=(TWO,)),
            "frequency: stood at every frequency tried, 0.5 to 1 Hz, up and down; largest rotation 0.62 of the "
            "slenderness angle, at 1 Hz going up; two motions coexist at 1 Hz",
        ),
        (
            curve(*STANDS[:3], point(0.5, "down", None), drop_outs=(FALL,)),
            "frequency: overturned at 0.9 to 0.5 Hz going down; stood at the other 3 points; largest rotation 0.62 of "
            "the slenderness angle, at 1 Hz going up",
        ),
        (
            curve(point(0.5, "up", None), point(0.5, "down", None), drop_outs=(FALL,)),
            "frequency: overturned at every frequency tried, 0.5 Hz",
        ),
        (
            curve(point(0.5, "up", 0.0, "rest"), point(1.0, "up", None, status="failed"), status="failed"),
            "frequency: stood at every frequency with an outcome, 0.5 Hz, up and down; at rest there; "
            "no outcome at 1 of 2 points",
        ),
        (
            curve(*STANDS[:3], point(0.5, "down", 0.1, slip=0.064)),
            "frequency: stood at every frequency tried, 0.5 to 1 Hz, up and down; largest rotation 0.62 of the "
            "slenderness angle, at 1 Hz going up; slid by up to 64 mm a period, at 0.5 Hz going down",
        ),
        (
            curve(*STANDS[:3], point(0.5, "down", 0.1, motion="invalid")),
            "frequency: not valid at 1 point, the first at 0.5 Hz going down: a corner is destroyed; stood at the "
            "other 3 points; largest rotation 0.62 of the slenderness angle, at 1 Hz going up",
        ),
        (
            curve(point(0.5, "up", 0.1, "rest"), point(0.5, "down", 0.1, motion="invalid")),
            "frequency: not valid at 1 point, the first at 0.5 Hz going down: a corner is destroyed; stood at the "
            "other point; at rest there",
        ),
        (
            curve(
                *STANDS[:3],
                point(0.5, "down", 0.1, slip=0.064),
                request={"limit_slip_m": 0.07, "observe": 48},
            ),
            "frequency: stood at every frequency tried, 0.5 to 1 Hz, up and down; none slid beyond 70 mm within "
            "48 periods; largest rotation 0.62 of the slenderness angle, at 1 Hz going up; slid by up to 64 mm a "
            "period, at 0.5 Hz going down",
        ),
        (
            curve(*STANDS[:2], *WALKS, request={"limit_slip_m": 0.05, "observe": 48}),
            "frequency: slid beyond 50 mm within 48 periods at 2 points, the first at 1 Hz going down (slip there "
            "96 mm); stood at the other 2 points; largest rotation 0.62 of the slenderness angle, at 1 Hz going up",
        ),
        (curve(*STANDS, status="interrupted"), None),
        (curve(point(0.5, "up", None, status="failed"), status="failed"), None),
    ],
)
def test_a_curve_has_one_sentence(result, sentence):
    assert response_answer(result) == sentence


@pytest.mark.parametrize(
    ("points", "limit", "share"),
    [
        (STANDS, None, 0.0),
        ((*STANDS[:3], point(0.5, "down", None)), None, 0.25),
        ((*STANDS[:3], point(0.5, "down", 0.1, motion="invalid")), None, 0.25),
        ((*STANDS[:2], *WALKS), 0.05, 0.5),
        ((STANDS[0], point(0.5, "down", None, status="failed")), None, 0.0),  # no outcome
        ((), None, None),
    ],
)
def test_the_share_that_does_not_stand_counts_points_with_an_outcome(points, limit, share):
    result = curve(*points, request={"observe": 48, "limit_slip_m": limit})
    assert fates_of(result).overturned_share == share


def test_what_destroyed_a_corner_before_it_lay_down_did_not_overturn():
    fallen, destroyed = point(0.5, "up", None), replace(point(0.6, "up", None), motion="invalid")
    empty = np.empty((0, 2))
    rows = [
        PointRecord(row=row, sections=empty, extremes=empty, portrait=empty) for row in (fallen, destroyed)
    ]
    assert [(fall.from_Hz, fall.to_Hz) for fall in drop_outs(rows)] == [(0.5, 0.5)]
    assert response_answer(curve(fallen, destroyed, drop_outs=tuple(drop_outs(rows)))) == (
        "frequency: overturned at 0.5 Hz going up; not valid at 1 point, the first at 0.6 Hz going up: a corner is "
        "destroyed"
    )


def test_a_destroyed_corner_is_no_motion_that_coexists_with_another():
    empty = np.empty((0, 7))

    def record(direction, **changed):
        row = replace(point(0.5, direction, 0.2), **changed)
        return PointRecord(row=row, sections=empty, extremes=empty, portrait=empty)

    resting = record("up", long_time="rest", motion="rest", rotation_ratio=0.0)
    assert differ(resting, record("down"))
    destroyed = record("down", motion="invalid")
    assert not differ(resting, destroyed) and jumps([resting, destroyed, replace(destroyed)]) == []
