import math

import numpy as np
import pytest
from floors import still_floor

from contact.reference.event_driven import Guard, first_crossing, flow, sample, turning_point


def crossing_of(margin, start=0.0, end=1.0):
    guard = Guard(name="event", margin=lambda state, a: margin(float(state[0])))
    return first_crossing([guard], lambda t: np.array([t]), lambda t: 0.0, start, end)


def test_a_crossing_is_found_to_rounding_and_on_its_far_side():
    time, name = crossing_of(lambda t: math.cos(3.0 * t))
    assert name == "event"
    assert time == pytest.approx(math.pi / 6.0, abs=1e-15)
    assert math.cos(3.0 * time) < 0.0


@pytest.mark.parametrize("centre", [0.01, 0.3, 0.4375, 0.99])
def test_a_limit_exceeded_between_samples_is_seen(centre):
    # 1e-8 below zero for 2e-4 of the step, an eighth of which lies between samples.
    time, _ = crossing_of(lambda t: (t - centre) ** 2 - 1e-8)
    assert time == pytest.approx(centre - 1e-4, abs=1e-12)


def test_a_margin_that_starts_from_zero_and_rises_is_no_event():
    assert crossing_of(lambda t: t * (2.0 - t)) is None


def test_a_hop_shorter_than_a_sample_is_not_stepped_over():
    time, _ = crossing_of(lambda t: t * (1e-5 - t))
    assert time == pytest.approx(1e-5, rel=1e-12)


def test_a_thrown_body_turns_and_lands_when_the_parabola_says():
    passage = flow(
        rate=lambda state, a: np.array([state[1], -10.0]),
        guards=[Guard(name="lands", margin=lambda state, a: float(state[0]))],
        state=np.array([0.0, 5.0]),
        start=0.0,
        end=5.0,
        floor=still_floor(),
        scale=np.ones(2),
        regime=3,
    )
    assert (passage.event, passage.time) == ("lands", pytest.approx(1.0, abs=1e-13))
    assert passage.state == pytest.approx([0.0, -5.0], abs=1e-12)
    turns = [turning_point(piece, component=1) for piece in passage.pieces]
    (turn,) = [turn for turn in turns if turn is not None]
    assert (turn[0], turn[1][0]) == (pytest.approx(0.5, abs=1e-13), pytest.approx(1.25, abs=1e-13))
    states, regimes = sample(passage.pieces, np.array([-0.1, 0.0, 0.25, 1.1]), 2)
    assert np.isnan(states[[0, 3]]).all()  # no sample is made up outside the motion
    assert states[1] == pytest.approx([0.0, 5.0])
    assert states[2] == pytest.approx([0.9375, 2.5], abs=1e-13)
    assert regimes.tolist() == [-1, 3, 3, -1]
