"""Where a container touches the floor, and the penalty that `auto` chooses, against what is promised."""

import math

import numpy as np
import pytest
from scipy.optimize import fsolve

from contact.interface.penalty import choose_normal_penalty, relaxation_time
from contact.interface.support import choose_support, tributary_lengths

UNEVEN = np.array([-0.55, -0.52, -0.40, -0.15, 0.20, 0.41, 0.55])


def with_middles(x: np.ndarray) -> np.ndarray:
    """Nodes of second-order elements: ends and middles."""
    return np.sort(np.concatenate([x, 0.5 * (x[1:] + x[:-1])]))


@pytest.mark.parametrize("order", [1, 2])
def test_tributary_lengths_integrate_what_the_elements_can_represent(order):
    x = UNEVEN if order == 1 else with_middles(UNEVEN)
    lengths = tributary_lengths(x, order)
    assert lengths.sum() == pytest.approx(1.1, rel=1e-14)
    assert lengths @ x == pytest.approx(0.5 * (x[-1] ** 2 - x[0] ** 2), abs=1e-14)
    if order == 2:
        assert lengths @ x**2 == pytest.approx((x[-1] ** 3 - x[0] ** 3) / 3.0, rel=1e-14)
    assert (lengths > 0.0).all()


def test_feet_are_the_nodes_within_their_length_and_nothing_between():
    support = choose_support("feet", UNEVEN, depth=0.8, order=1, feet=(0.15, 0.14))
    assert support.index.tolist() == [0, 1, 2, 5, 6]
    assert support.length == pytest.approx([0.015, 0.075, 0.06, 0.07, 0.07])


STACK = {
    "weight": 98_100.0,
    "width": 1.1,
    "height": 4.0,
    "depth": 1.1,
    "slenderness_angle": math.atan2(1.1, 4.0),
    "youngs_modulus": 2.1e11,
    "element_size": 0.1,
}


def test_corners_sink_by_the_smaller_of_two_lengths():
    # 6e-5 of width x slenderness angle is the smaller one for the stack: 6e-5 x 1.1 x 0.2684 m.
    stiffness = choose_normal_penalty("corners", **STACK) * 1.1 * 1.1
    assert STACK["weight"] / stiffness == pytest.approx(1.771e-5, rel=1e-3)
    # For the single box it is 1e-5 of the height.
    box = STACK | {"weight": 24_525.0, "height": 1.0, "slenderness_angle": math.atan2(1.1, 1.0)}
    stiffness = choose_normal_penalty("corners", **box) * 1.1 * 1.1
    assert box["weight"] / stiffness == pytest.approx(1e-5, rel=1e-12)


@pytest.mark.parametrize("kind", ["corners", "feet", "flat"])
def test_the_penalty_is_never_stiffer_than_three_times_the_material(kind):
    soft = STACK | {"youngs_modulus": 1e6}
    assert choose_normal_penalty(kind, **soft, foot=0.15) == pytest.approx(3.0 * 1e6 / 0.1)


def tilt_on_a_bed(x: np.ndarray, stiffness: np.ndarray, weight: float, arm: float) -> float:
    """Tilt [rad] of a rigid base on springs that do not pull, the weight `arm` [m] right of its middle."""

    def residual(unknown: np.ndarray) -> np.ndarray:
        force = stiffness * np.maximum(0.0, unknown[0] + unknown[1] * x)
        return np.array([force.sum() / weight - 1.0, (force @ x) / (weight * arm) - 1.0])

    strip = 3.0 * (0.5 * np.ptp(x) - arm)
    edge = 2.0 * weight / (stiffness.mean() * x.size * strip / np.ptp(x))
    guess = np.array([-edge * (x[-1] - strip) / strip, edge / strip])
    scale = np.abs(guess)
    solution, _, status, message = fsolve(
        lambda u: residual(u * scale), guess / scale, full_output=True, xtol=1e-13
    )
    assert status == 1, message
    return float(solution[1] * scale[1])


@pytest.mark.parametrize("kind", ["flat", "feet"])
def test_a_wide_base_near_uplift_tilts_by_a_thousandth_of_the_slenderness_angle(kind):
    # 0.9 of the restoring moment; a bed summed in 40 000 strips, no formula for the length that carries.
    x = np.linspace(-0.55, 0.55, 40_001)
    x = 0.5 * (x[1:] + x[:-1])
    foot = 0.2  # longer than the strip that still carries, 0.165 m
    penalty = choose_normal_penalty(kind, **STACK, foot=foot)
    springs = np.full(x.size, penalty * 1.1 * 1.1 / x.size)
    if kind == "feet":
        springs[np.abs(x) < 0.55 - foot] = 0.0
        x, springs = x[springs > 0.0], springs[springs > 0.0]
        springs_per_length = penalty * 1.1
        assert springs.sum() == pytest.approx(springs_per_length * 2.0 * foot, rel=1e-3)
    tilt = tilt_on_a_bed(x, springs, STACK["weight"], 0.9 * 0.55)
    assert tilt == pytest.approx(1e-3 * STACK["slenderness_angle"], rel=1e-3)


def test_the_damping_ratio_is_that_of_the_whole_mass_on_one_corner():
    mass, base = 1e4, 5.4e9
    corner = 0.5 * base
    time = relaxation_time(2.0, mass, base)
    assert corner * time / (2.0 * math.sqrt(corner * mass)) == pytest.approx(2.0, rel=1e-14)
    assert relaxation_time(0.0, mass, base) == 0.0
