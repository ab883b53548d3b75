"""Simplified methods beside what the runs found."""

from dataclasses import replace

import numpy as np
import pytest
from running_example import ACTION, SITE, SLIP, k1
from site_example import INPUTS, PERIODS, RUN, site_body, site_motion

from fem.seismic.method import MethodQuantity
from fem.seismic.methods import methods_of
from fem.seismic.static_rules import peak_rows
from fem.site.methods import floor_action, found_by_runs, loose_body, site_methods
from fem.site.result import FloorResult
from fem.site.tables import LimitsTable

BY_RULE = LimitsTable(slip_m=0.1)  # 0.5, 0.8 of the angle
STOOD = replace(RUN, mu_static=0.2, mu_kinetic=0.1, rotation_ratio=0.2, max_slip_m=0.004)
FELL = replace(STOOD, motion=2, outcome="overturned", rotation_ratio=3.0)
BEYOND = replace(STOOD, rotation_ratio=0.6)  # the limit is 0.5
OVERTURNING, SLIDING = peak_rows(k1(mu_static=0.2), ACTION, horizontal=1.0, vertical=0.0)
STRONGER = peak_rows(k1(mu_static=0.2), ACTION.scaled(1.5), horizontal=1.0, vertical=0.0)[0]


def rows_of(bodies, inputs, floor=None):
    """The methods for some bodies, under one motion."""
    motion, periods = site_motion(1)[0], PERIODS.tolist()
    return site_methods(
        bodies=bodies, inputs=inputs, site=SITE, motions=[motion], periods_s=periods, floor=floor, runs=[]
    )


@pytest.mark.parametrize(
    ("row", "runs", "words", "compared"),
    [
        (OVERTURNING, [STOOD], "none of 1 overturned; by the rule 0.2 of the angle", "agrees"),
        (OVERTURNING, [STOOD, FELL], "1 of 2 overturned", "not conservative"),
        (
            OVERTURNING,
            [STOOD, replace(FELL, outcome="invalid")],
            "none of 2 overturned, 1 destroyed a corner",
            "not conservative",
        ),
        (OVERTURNING, [BEYOND], "none of 1 overturned; by the rule 0.6 of the angle", "not conservative"),
        (STRONGER, [STOOD], "none of 1 overturned; by the rule 0.2 of the angle", "conservative"),
        (OVERTURNING, [replace(STOOD, rotation_ratio=0.001)], "none of 1 overturned; none rocks", "agrees"),
        (STRONGER, [FELL], "1 of 1 overturned", "agrees"),
        (SLIDING, [STOOD], "largest 4 mm, mean 4 mm", "agrees"),
        (SLIDING, [replace(STOOD, max_slip_m=1e-6)], "none slides", "conservative"),
        (
            SLIDING,
            [STOOD, replace(STOOD, motion=2, max_slip_m=0.002)],
            "largest 4 mm, mean 3 mm",
            "agrees",
        ),
        (
            SLIDING,
            [STOOD, replace(STOOD, mu_static=0.4, max_slip_m=0.5)],
            "largest 4 mm, mean 4 mm",
            "agrees",
        ),
        (SLIDING, [replace(STOOD, outcome=None)], "no runs", ""),
        (OVERTURNING, [replace(FELL, stage="scan", factor=2.0)], "no runs", ""),
        (replace(OVERTURNING, median=True), [FELL], "1 of 1 overturned", ""),
        (replace(OVERTURNING, beyond="on a floor"), [FELL], "1 of 1 overturned", ""),
    ],
)
def test_what_the_rule_counts_beside_a_method(row, runs, words, compared):
    assert found_by_runs(row, runs, width=1.1, limits=BY_RULE) == (words, compared)


def test_a_method_is_compared_with_the_mean_that_the_rule_counts_and_not_with_one_motion():
    seven = [replace(STOOD, motion=number, rotation_ratio=0.3) for number in range(1, 7)]
    seven.append(replace(STOOD, motion=7, rotation_ratio=0.7))  # beyond the limit by itself
    words, compared = found_by_runs(OVERTURNING, seven, width=1.1, limits=BY_RULE)
    assert words == "none of 7 overturned; by the rule 0.36 of the angle, at most 0.7"
    assert compared == "agrees"


def test_a_slip_is_compared_with_the_largest_as_the_rule_does():
    row = replace(SLIDING, quantity=MethodQuantity.SLIP, demand=0.106)
    for slip, compared in ((0.01, "conservative"), (0.11, "agrees"), (0.2, "not conservative")):
        runs = [replace(STOOD, max_slip_m=slip)]
        assert found_by_runs(row, runs, width=1.1, limits=BY_RULE)[1] == compared


def test_rules_made_of_ground_motions_do_not_hold_on_a_floor_and_medians_are_marked():
    methods = methods_of(k1(mu_static=0.2), SLIP, behaviour_factor=1.5)
    on_ground, on_floor = (
        [row for method in methods for row in method(replace(ACTION, in_building=floor))]
        for floor in (False, True)
    )
    assert [row.name for row in on_ground if row.median] == ["Housner, spectral velocity"]
    assert not any(row.beyond for row in on_ground)
    out = {row.name for row in on_floor if row.beyond}
    assert out == {"Housner, spectral velocity", "Newmark (1965)"}


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
