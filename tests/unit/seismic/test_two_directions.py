"""Slip under two horizontal components: the public function, and sets of motions."""

import math
from dataclasses import replace

import numpy as np
import pytest

import fem
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions, artificial_set
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.motion_set import largest_correlation
from fem.seismic.two_directions import largest_slips

STRONG = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.8)
TIMES = np.arange(0.0, 1.0, 0.01)
STILL = np.zeros_like(TIMES)


@pytest.fixture(scope="module")
def motions():
    return artificial_set(STRONG, count=7, seed=1, second=1.0)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"ax_m_s2": STILL[1:]}, "one length"),
        ({"time_s": TIMES[::-1]}, "increase"),
        ({"ay_m_s2": np.where(TIMES > 0.5, np.nan, 0.0)}, "finite"),
        ({"mu_static": 0.0}, "mu_static must be positive"),
        ({"mu_kinetic": 0.4}, "mu_kinetic"),
        ({"gravity_m_s2": 0.0}, "gravity"),
    ],
)
def test_what_cannot_be_is_refused(changed, words):
    given = {"time_s": TIMES, "ax_m_s2": STILL, "ay_m_s2": STILL, "mu_static": 0.3} | changed
    with pytest.raises(ValueError, match=words):
        fem.slide_in_plane(**given)


def test_a_second_component_leaves_the_others_as_they_are_and_is_independent_of_them(motions):
    (alone,) = artificial_motions(STRONG, count=1, seed=1)
    np.testing.assert_array_equal(motions[0].horizontal, alone.horizontal)
    np.testing.assert_array_equal(motions[0].vertical, alone.vertical)
    assert largest_correlation(motions) <= 0.3
    for motion in motions:
        assert np.abs(motion.second).max() == pytest.approx(STRONG.surface_acceleration, rel=0.11)
        assert abs(np.corrcoef(motion.horizontal, motion.second)[0, 1]) < 0.3


@pytest.mark.parametrize(
    ("mu", "plane", "factor"), [(0.15, 102.0, 1.7), (0.20, 45.0, 2.1), (0.25, 16.0, 2.9)]
)
def test_two_components_slide_two_to_four_times_as_far_as_one(motions, mu, plane, factor):
    """Against an independent block under the same first components and other second ones, mean of seven [mm]."""
    both, alone = (
        largest_slips(some, [(mu, mu)])[mu, mu].mean()
        for some in (motions, [replace(motion, second=None) for motion in motions])
    )
    assert 1e3 * alone == pytest.approx(plane, rel=0.01)
    assert both / alone == pytest.approx(factor, rel=0.15)


def test_the_largest_slip_is_that_of_the_worse_sign(motions):
    pairs = [(0.3, 0.15), (0.3, 0.3)]

    def slid(one, sign, pair):
        along = one.times, one.horizontal, one.second, sign * one.vertical
        return np.hypot(*fem.slide_in_plane(*along, mu_static=pair[0], mu_kinetic=pair[1]).T).max()

    for pair, found in largest_slips(motions[:3], pairs).items():
        worse = [max(slid(one, sign, pair) for sign in (1.0, -1.0)) for one in motions[:3]]
        assert found == pytest.approx(worse, rel=1e-6)


def test_a_body_that_slides_when_the_motion_ends_is_followed_until_it_stops():
    times = np.arange(0.0, 0.2 + 1e-9, 0.01)
    along, across = np.full(times.size, 6.0), np.full(times.size, 2.0)
    motion = GroundMotion(name="push", step=0.01, horizontal=along, second=across)
    (found,) = largest_slips([motion], [(0.3, 0.3)])[0.3, 0.3]
    speed = (math.hypot(6.0, 2.0) - 0.3 * 9.81) * 0.2
    assert found == pytest.approx(0.1 * speed + speed**2 / (2.0 * 0.3 * 9.81), rel=1e-6)
