"""Motions of a floor in a building."""

import eqsig
import numpy as np
import pytest

from contact.motion.samples import sampled_motion
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions
from fem.seismic.floor import floor_motion
from fem.seismic.ground_motion import GroundMotion

ACTION = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)


@pytest.fixture(scope="module")
def ground():
    return artificial_motions(ACTION, count=1, seed=4)[0]


def test_on_the_ground_the_motion_is_that_of_the_ground(ground):
    assert floor_motion(ground, height_ratio=0.0, period=0.5) is ground


def test_a_rigid_building_moves_with_its_ground(ground):
    floor = floor_motion(ground, height_ratio=1.0, period=0.02)
    assert floor.peak == pytest.approx(ground.peak, rel=0.25)  # 50 Hz: some amplification remains


def test_a_soft_building_leaves_half_of_the_ground_motion_reversed():
    """Far below its frequency the oscillator stays in place: the top moves with 1 - 1.5 of the ground."""
    times = np.arange(2001) * 0.005
    pulse = np.where(times < 0.1, np.sin(2.0 * np.pi * times / 0.1), 0.0)
    ground = GroundMotion(name="pulse", step=0.005, horizontal=pulse)
    floor = floor_motion(ground, height_ratio=1.0, period=10.0)
    np.testing.assert_allclose(floor.horizontal[:20], -0.5 * pulse[:20], atol=0.06)


def test_an_independent_oscillator_gives_the_same_floor(ground):
    period, ratio = 0.5, 0.6
    floor = floor_motion(ground, height_ratio=ratio, period=period)
    padded = np.concatenate([ground.horizontal, np.zeros(floor.horizontal.size - ground.horizontal.size)])
    relative = eqsig.sdof.response_series(padded, ground.step, np.array([period]), 0.05)
    # Absolute acceleration of the oscillator from its displacement and velocity.
    rate = 2.0 * np.pi / period
    absolute = rate**2 * relative[0][0] + 2.0 * 0.05 * rate * relative[1][0]
    sign = -np.sign(np.corrcoef(absolute, floor.horizontal)[0, 1]) or 1.0
    expected = (1.0 - 1.5 * ratio) * padded - sign * 1.5 * ratio * absolute
    assert np.abs(floor.horizontal - expected).max() < 0.01 * floor.peak


def test_the_floor_of_a_resonant_building_amplifies_and_ends_at_rest(ground):
    floor = floor_motion(ground, height_ratio=1.0, period=0.5)
    assert floor.peak > 2.0 * ground.peak
    assert floor.duration == pytest.approx(
        ground.duration + np.log(100.0) * 0.5 / (2.0 * np.pi * 0.05), abs=0.01
    )
    x, v, _ = sampled_motion(floor.times, floor.horizontal, "acceleration")
    assert abs(v[-1]) < 1e-10 and abs(x[-1]) < 1e-9
    assert floor.vertical.size == floor.horizontal.size
    np.testing.assert_array_equal(floor.vertical[: ground.vertical.size], ground.vertical)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"period": 0.0}, "period of the building"),
        ({"height_ratio": 1.2}, "z/H"),
        ({"damping_ratio": 0.0}, "damping ratio"),
    ],
)
def test_no_building_is_like_that(ground, given, message):
    with pytest.raises(ValueError, match=message):
        floor_motion(ground, **({"height_ratio": 1.0, "period": 0.5} | given))
