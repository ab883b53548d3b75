"""Simplified methods beside what the runs found."""

from dataclasses import replace

import numpy as np
import pytest
from site_example import INPUTS, LIMITS, PERIODS, SITE, site_body, site_motion

from fem.site.methods import floor_action, loose_body, site_methods
from fem.site.result import FloorResult


def rows_of(bodies, inputs, floor=None):
    """The methods for some bodies, under one motion."""
    motion, periods = site_motion(1)[0], PERIODS.tolist()
    own = {"site": SITE, "motions": [motion], "periods_s": periods, "floor": floor}
    return site_methods(bodies=bodies, inputs=inputs, limits=LIMITS, runs=[], **own)


def test_a_body_keeps_its_inertia_and_has_the_least_friction():
    body = loose_body(site_body("empty"), INPUTS)
    assert body.block.inertia_ratio == pytest.approx(4.0 / 3.0)
    assert (body.mu_static, body.mu_kinetic, body.mass) == (0.2, 0.1, pytest.approx(1600.0))


def test_in_a_building_the_methods_take_the_motion_of_the_floor():
    motions = [site_motion(1)[0]]
    values = np.full(PERIODS.size, 7.0)
    floor = FloorResult(
        z_over_h=1.0,
        building_periods_s=(0.425, 0.5, 0.575),
        damping_ratio=0.05,
        peak_m_s2=5.0,
        peak_velocity_m_s=0.9,
        mean_m_s2=tuple(values.tolist()),
    )
    action = floor_action(SITE, motions, PERIODS.tolist(), floor)
    assert (action.peak, action.peak_velocity, action.ground_peak) == (5.0, 0.9, pytest.approx(2.4))
    found = action.spectrum(np.array([0.0, 0.01, 1.0]))
    np.testing.assert_allclose(found, [5.0, 6.0, 7.0])
    rows = rows_of([site_body("full")], replace(INPUTS, wind_pressure_Pa=None), floor)
    elements = [row for row in rows if row.name.startswith("element") and row.quantity == "overturning"]
    assert [row.demand for row in elements] == pytest.approx([6.0, 13.2])
    assert {row.found for row in rows} == {"no runs"}


def test_on_a_given_floor_no_formula_raises_its_motion_again_and_the_vertical_is_its_own():
    motions = [site_motion(1)[0]]
    floor = FloorResult(
        peak_m_s2=5.0,
        peak_velocity_m_s=0.9,
        mean_m_s2=tuple(np.full(PERIODS.size, 7.0).tolist()),
        vertical_peak_m_s2=2.0,
        vertical_mean_m_s2=tuple(np.full(PERIODS.size, 4.0).tolist()),
    )
    action = floor_action(SITE, motions, PERIODS.tolist(), floor)
    assert (action.peak, action.vertical_peak) == (5.0, 2.0)
    rows = rows_of([site_body("full")], replace(INPUTS, wind_pressure_Pa=None), floor)
    assert rows and not [row for row in rows if row.name.startswith(("element", "plateau"))]


def test_the_wind_is_on_the_lightest_body():
    rows = rows_of([site_body("full"), site_body("empty")], INPUTS)
    wind = [row for row in rows if row.name == "wind"]
    assert [row.mass for row in wind] == ["empty", "empty"]
    assert wind[0].utilisation == pytest.approx(0.2540 / 0.16, rel=1e-3)
