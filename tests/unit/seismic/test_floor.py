"""Motions of a floor in a building."""

import math

import eqsig
import numpy as np
import pytest
from scipy.linalg import expm

from contact.motion.samples import sampled_motion
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.artificial import artificial_motions
from fem.seismic.floor import floor_motion, is_a_floor, one_mode, storey_modes

ACTION = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)


@pytest.fixture(scope="module")
def ground():
    return artificial_motions(ACTION, count=1, seed=4)[0]


def test_on_the_ground_the_motion_is_that_of_the_ground(ground):
    assert floor_motion(ground, one_mode(height_ratio=0.0, period=0.5)) is ground


def test_an_independent_oscillator_gives_the_same_floor(ground):
    period, ratio = 0.5, 0.6
    floor = floor_motion(ground, one_mode(height_ratio=ratio, period=period))
    padded = np.concatenate([ground.horizontal, np.zeros(floor.horizontal.size - ground.horizontal.size)])
    relative = eqsig.sdof.response_series(padded, ground.step, np.array([period]), 0.05)
    # Absolute acceleration of the oscillator from its displacement and velocity.
    rate = 2.0 * np.pi / period
    absolute = rate**2 * relative[0][0] + 2.0 * 0.05 * rate * relative[1][0]
    sign = -np.sign(np.corrcoef(absolute, floor.horizontal)[0, 1]) or 1.0
    expected = (1.0 - 1.5 * ratio) * padded - sign * 1.5 * ratio * absolute
    assert np.abs(floor.horizontal - expected).max() < 0.01 * floor.peak


def test_the_floor_of_a_resonant_building_amplifies_and_ends_at_rest(ground):
    floor = floor_motion(ground, one_mode(height_ratio=1.0, period=0.5))
    assert floor.peak > 2.0 * ground.peak
    dies = np.log(100.0) * 0.5 / (2.0 * np.pi * 0.05)
    assert floor.duration == pytest.approx(ground.duration + dies, abs=0.01)
    x, v, _ = sampled_motion(floor.times, floor.horizontal, "acceleration")
    assert abs(v[-1]) < 1e-10 and abs(x[-1]) < 1e-9
    assert floor.vertical.size == floor.horizontal.size
    np.testing.assert_array_equal(floor.vertical[: ground.vertical.size], ground.vertical)


@pytest.mark.parametrize(
    ("storeys", "floor", "share"), [(5, 4, 1.150), (5, 5, 1.252), (10, 5, 0.864), (10, 10, 1.267)]
)
def test_a_uniform_shear_building_has_the_closed_form(storeys, floor, share):
    """Mode j of a chain: sin((2j-1) pi i/(2n+1)) at storey i, rate as sin((2j-1) pi/(4n+2))."""
    modes = storey_modes(storeys=storeys, kind="shear", height_ratio=floor / storeys, period=0.5)
    assert modes[0].share == pytest.approx(share, abs=5e-4)
    angle = math.pi / (4 * storeys + 2)
    for j, mode in enumerate(modes, start=1):
        assert mode.period == pytest.approx(0.5 * math.sin(angle) / math.sin((2 * j - 1) * angle), rel=1e-10)
    everything = storey_modes(storeys=storeys, kind="shear", height_ratio=floor / storeys, period=50.0)
    assert sum(mode.share for mode in everything) == pytest.approx(1.0)


def test_a_cantilever_of_many_storeys_is_a_beam():
    # Euler and Bernoulli: rates as 1 : 6.267 : 17.55, first mode 1.566 at the top
    modes = storey_modes(storeys=200, kind="cantilever", height_ratio=1.0, period=10.0)
    assert modes[0].share == pytest.approx(1.566, rel=0.01)
    assert [10.0 / mode.period for mode in modes[1:3]] == pytest.approx([6.267, 17.55], rel=0.02)


def test_modes_beyond_33_hz_follow_the_ground():
    modes = storey_modes(storeys=10, kind="shear", height_ratio=0.5, period=0.2)
    assert 1 < len(modes) < 10
    assert min(mode.period for mode in modes) >= 1.0 / 33.0


def test_nothing_stands_between_floors_or_in_a_building_without_period_or_damping(ground):
    assert [is_a_floor(*at) for at in ((5, 0.5), (10, 0.33), (3, 0.667))] == [False, False, True]
    for period, damping_ratio in ((0.0, 0.05), (0.5, 0.0)):
        with pytest.raises(ValueError, match="must lie between"):
            floor_motion(ground, one_mode(height_ratio=1.0, period=period), damping_ratio=damping_ratio)


@pytest.mark.parametrize(("kind", "period"), [("shear", 0.6), ("cantilever", 3.0)])
def test_the_whole_building_integrated_at_once_has_the_same_floors(ground, kind, period):
    """Masses, stiffness and damping matrix of five storeys, stepped by the matrix exponential."""
    count, ratio = 5, 0.05
    level = np.arange(1.0, count + 1.0)
    lower, upper = np.minimum.outer(level, level), np.maximum.outer(level, level)
    flexibility = lower if kind == "shear" else lower**2 * (3.0 * upper - lower)
    squares, shapes = np.linalg.eigh(np.linalg.inv(flexibility))
    squares *= (2.0 * np.pi / period) ** 2 / squares[0]
    stiffness = shapes @ np.diag(squares) @ shapes.T
    damping = shapes @ np.diag(2.0 * ratio * np.sqrt(squares)) @ shapes.T
    floors = [
        floor_motion(ground, storey_modes(storeys=count, kind=kind, height_ratio=k / count, period=period))
        for k in (3, 5)
    ]
    step = floors[0].step
    base = np.interp(floors[0].times, ground.times, ground.horizontal, right=0.0)
    # x' = A x + b a, with a straight between samples: the exponential of the system with a and its slope beside x
    system = np.zeros((2 * count + 2, 2 * count + 2))
    system[:count, count : 2 * count] = np.eye(count)
    system[count : 2 * count, :count], system[count : 2 * count, count : 2 * count] = -stiffness, -damping
    system[count : 2 * count, -2] = -1.0
    system[-2, -1] = 1.0
    forward = expm(step * system)
    state, absolute = np.zeros(2 * count), np.zeros((base.size, count))
    for k in range(base.size - 1):
        state = (forward @ [*state, base[k], (base[k + 1] - base[k]) / step])[: 2 * count]
        absolute[k + 1] = -stiffness @ state[:count] - damping @ state[count:]
    for floor, number in zip(floors, (3, 5), strict=True):
        assert np.abs(floor.horizontal - absolute[:, number - 1]).max() < 2e-3 * floor.peak
