"""The calibration table of contact damping, and what is read from it."""

import math

import numpy as np
import pytest

from fem.case.case import case_from
from fem.case.uncertainty import all_changes, as_changed
from fem.model.model import build_model
from fem.model.restitution import Calibration, apparent_restitution


def housner(slenderness: float) -> float:
    """1 - 1.5 sin^2(slenderness angle), homogeneous block of that height over width."""
    return 1.0 - 1.5 * math.sin(math.atan(1.0 / slenderness)) ** 2


def on_corners(slenderness: float, damping_ratio: float = 2.0) -> float | None:
    return apparent_restitution(
        support="corners",
        foot_over_width=None,
        slenderness=slenderness,
        damping_ratio=damping_ratio,
        housner=housner(slenderness),
    )


# Housner's 0.5385, 0.7, 0.7931, 0.8945 for c/a = 1.5, 2, 2.5, 3.64; what penalty springs with tiny steps give at
# damping ratio 2 on two corners: 0.5386, 0.6999, 0.7929, 0.8940.
@pytest.mark.parametrize(
    ("slenderness", "expected"), [(1.5, 0.5386), (2.0, 0.6999), (2.5, 0.7929), (4.0 / 1.1, 0.8940)]
)
def test_two_corners_with_strong_damping_are_housners_block(slenderness, expected):
    assert on_corners(slenderness) == pytest.approx(expected, abs=1.5e-3)


@pytest.mark.parametrize(
    "outside",
    [
        *({"slenderness": value} for value in (1.0, 9.0)),
        *({"damping_ratio": value} for value in (0.1, 0.0, 50.0)),
        *({"support": "feet", "foot_over_width": value} for value in (0.4, 0.01)),
    ],
)
def test_outside_the_table_there_is_no_value(outside):
    inside = {"support": "corners", "foot_over_width": None, "slenderness": 3.0, "damping_ratio": 2.0}
    assert apparent_restitution(**inside, housner=0.85) is not None
    assert apparent_restitution(**(inside | outside), housner=0.85) is None


def test_between_entries_the_loss_is_linear_in_each_direction():
    calibration = Calibration(
        foot=np.array([0.1, 0.3]),
        slenderness=np.array([2.0, 4.0]),
        damping_ratio=np.array([0.5, 2.0]),
        loss=np.array([[[0.2, 0.4], [0.6, 0.8]], [[1.0, 1.2], [1.4, 1.6]]]),
    )
    assert calibration.loss_at(0.1, 2.0, 0.5) == pytest.approx(0.2)
    assert calibration.loss_at(0.3, 4.0, 2.0) == pytest.approx(1.6)
    assert calibration.loss_at(0.2, 2.0, 0.5) == pytest.approx(0.6)
    assert calibration.loss_at(0.1, 3.0, 0.5) == pytest.approx(0.4)
    assert calibration.loss_at(0.1, 2.0, 1.0) == pytest.approx(0.3)  # 1 is halfway in the logarithm


def test_another_distribution_of_mass_keeps_the_share_of_housners_loss():
    flat = {"support": "flat", "foot_over_width": None, "slenderness": 3.0, "damping_ratio": 2.0}
    heavy = apparent_restitution(**flat, housner=0.80)
    homogeneous = apparent_restitution(**flat, housner=housner(3.0))
    assert (1.0 - heavy) / 0.2 == pytest.approx((1.0 - homogeneous) / (1.0 - housner(3.0)))


@pytest.mark.parametrize(
    "box",
    [
        {"section": "solid", "centroid_m": 1.05},
        {"section": "solid", "centroid_m": 1.95},
        {"wall_m": 0.008, "mass_kg": 239.0},
    ],
    ids=["low", "high", "empty"],
)
def test_every_restitution_of_the_range_can_be_run_wherever_the_mass_lies(box):
    # Its upper end follows from a homogeneous block; a slender container loses less by up to a ninth.
    container = {"width_m": 0.3, "height_m": 3.0, "mass_kg": 800.0} | box
    tables = {"container": container, "contact": {"mu_static": 0.4}, "motion": {"kind": "none"}}
    case = case_from(tables | {"solver": {"model": "rigid"}})
    singles, _, draws = all_changes(case, build_model(case).penalty)
    factors = [change for change in singles if "contact.restitution_over_housner" in change.values]
    assert len(factors) == 2 and len(draws) == 32
    for change in (*factors, *draws):
        build_model(case.with_values(as_changed(case, change.values)))
