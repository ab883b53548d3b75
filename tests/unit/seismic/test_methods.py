"""Simplified methods against numbers worked by hand for container K1 on site S1."""

import math
from dataclasses import replace

import numpy as np
import pytest
from running_example import ACTION, LIMITS, PEAK_VELOCITY, SITE, k1

from contact.reference.rigid_block import RigidBlock
from fem.seismic.body import FloorAction, Limits, LooseBody
from fem.seismic.method import MethodQuantity, MethodRow, MethodSource, SourceStanding
from fem.seismic.methods import method_capacities, method_rows, methods_of
from fem.seismic.sliding_rules import RULES, sliding_rows
from fem.seismic.static_rules import both_directions_rows, element_rows, floor_factor, peak_rows, plateau_rows
from fem.seismic.velocity_rules import (
    contents_row,
    contents_velocity,
    displacement_row,
    housner_row,
    ishiyama_row,
    kaneko_hayashi_row,
    velocity_step,
    velocity_step_row,
)
from fem.seismic.wind import german_pressure, terrain_pressure, wind_force, wind_rows

K1 = k1()
LEVEL = replace(ACTION, vertical_peak=0.0)  # no vertical component


def utilisations(rows: list[MethodRow]) -> dict[MethodQuantity, float]:
    return {row.quantity: row.utilisation for row in rows}


# ---- static rules ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pair", "overturning", "sliding", "sliding_low"),
    [
        ((1.0, 0.0), 0.8896, 0.6116, 1.2232),
        ((1.0, 0.3), 0.9354, 0.6431, 1.2862),
        ((1.0, 1.0), 1.0630, 0.7308, 1.4616),
        ((0.3, 1.0), 0.3189, 0.2192, 0.4385),
    ],
)
def test_static_rule_with_shares_of_both_components(pair, overturning, sliding, sliding_low):
    for body, expected in ((K1, sliding), (k1(mu_static=0.2), sliding_low)):
        found = utilisations(peak_rows(body, ACTION, horizontal=pair[0], vertical=pair[1]))
        assert found[MethodQuantity.OVERTURNING] == pytest.approx(overturning, abs=5.1e-5)
        assert found[MethodQuantity.SLIDING] == pytest.approx(expected, abs=5.1e-5)


def test_both_directions_add_up_in_friction_alone():
    square = utilisations(both_directions_rows(K1, ACTION))
    assert square[MethodQuantity.OVERTURNING] == pytest.approx(0.8896, abs=5.1e-5)
    assert square[MethodQuantity.SLIDING] == pytest.approx(0.6116 * math.sqrt(1.09), abs=1e-4)
    # a quarter as deep as wide: 0.3/0.25 of the demand about the long edge
    flat = utilisations(both_directions_rows(replace(K1, depth=0.275), ACTION))
    assert flat[MethodQuantity.OVERTURNING] == pytest.approx(0.8896 * 1.2, abs=1e-4)


def test_a_vertical_peak_of_gravity_leaves_no_capacity():
    rows = peak_rows(K1, replace(ACTION, vertical_peak=9.81), horizontal=1.0, vertical=1.0)
    assert all(math.isinf(row.utilisation) and not row.fulfilled for row in rows)


@pytest.mark.parametrize(("q", "expected"), [(1.0, 2.224), (1.5, 1.483), (2.0, 1.112)])
def test_plateau_of_the_design_spectrum(q, expected):
    found = utilisations(plateau_rows(K1, ACTION, behaviour_factor=q))
    assert found[MethodQuantity.OVERTURNING] == pytest.approx(expected, abs=5.1e-4)


@pytest.mark.parametrize(
    ("height_ratio", "expected"),
    [(0.0, [2.4, 4.56, 6.0, 2.4]), (0.5, [4.2, 7.44, 9.6, 4.2]), (1.0, [6.0, 10.32, 13.2, 6.0])],
)
def test_force_on_an_element_of_a_floor(height_ratio, expected):
    for period_ratio, acceleration in zip((0.0, 0.5, 1.0, 2.0), expected, strict=True):
        assert 2.4 * floor_factor(height_ratio, period_ratio) == pytest.approx(acceleration)
        row = element_rows(K1, ACTION, height_ratio=height_ratio, period_ratio=period_ratio)[0]
        assert row.demand == pytest.approx(acceleration)
        assert row.capacity == pytest.approx(2.69775)


def test_the_force_on_an_element_is_at_least_that_of_the_ground():
    assert floor_factor(0.0, 5.0) == 1.0


# ---- velocity, energy, displacement --------------------------------------------------------------------------------


def test_velocity_and_displacement_rules():
    assert ACTION.spectral_velocity == pytest.approx(0.7639, abs=5.1e-5)
    assert pytest.approx(0.3809, abs=5.1e-5) == PEAK_VELOCITY
    housner = housner_row(K1, ACTION)
    assert housner.capacity == pytest.approx(1.3979, abs=5.1e-5)
    assert housner.utilisation == pytest.approx(0.55, abs=5.1e-3)
    assert velocity_step(K1) == pytest.approx(1.4454, abs=5.1e-5)
    assert velocity_step_row(K1, ACTION).utilisation == pytest.approx(0.26, abs=5.1e-3)
    displacement = displacement_row(K1, ACTION)
    assert displacement.demand == pytest.approx(0.24317, abs=1.1e-5)
    assert 0.5 * displacement.utilisation == pytest.approx(0.33, abs=5.1e-3)


def test_ishiyama_needs_acceleration_and_velocity():
    by_velocity = ishiyama_row(K1, ACTION.scaled(1.2))
    assert (by_velocity.demand, by_velocity.capacity) == pytest.approx((1.2 * PEAK_VELOCITY, 0.55))
    by_acceleration = ishiyama_row(K1, replace(ACTION, peak_velocity=1.0))
    assert (by_acceleration.demand, by_acceleration.capacity) == pytest.approx((2.4, 2.69775))


def test_kaneko_and_hayashi():
    row = kaneko_hayashi_row(K1, ACTION)
    assert (100.0 * row.capacity, row.says) == (pytest.approx(636.0, abs=1.0), "2.6 % overturn")
    assert "F_e = 1.003 Hz, F_b = 0.5418 Hz" in row.numbers


#: width and height [m], median velocity [m/s] of the nine unanchored contents of FEMA P-58 (fragility.csv of the
#: NHERI-SimCenter library, second edition: E.20.22.102a to 106a, 112a, 114a, 124a, 125a)
CONTENTS = (
    (0.3207, 0.7366, 0.724),
    (0.3207, 1.0414, 0.493),
    (0.3207, 1.4224, 0.361),
    (0.3207, 1.8034, 0.290),
    (0.3207, 2.0637, 0.251),
    (0.3810, 0.6096, 1.229),
    (0.3810, 1.3208, 0.498),
    (0.4724, 1.3335, 0.688),
    (0.4724, 1.7208, 0.526),
)


def test_contents_of_fema_p_58():
    ratios = [contents_velocity(width, height) / median for width, height, median in CONTENTS]
    assert min(ratios) > 0.97 and max(ratios) < 1.06
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.01)
    row = contents_row(K1, ACTION)
    assert row.median and row.utilisation == pytest.approx(PEAK_VELOCITY / contents_velocity(1.1, 4.0))


def test_a_regression_below_its_ratio_is_marked():
    for mu, beyond in ((0.05, "r = 0.2"), (0.2, "")):
        row = next(
            row
            for row in sliding_rows(k1(mu_static=mu, mu_kinetic=mu), LIMITS, ACTION)
            if row.name.startswith("Richards")
        )
        assert row.beyond.startswith(beyond) and bool(row.beyond) == bool(beyond)


def test_the_branches_of_kaneko_and_hayashi_meet():
    bound = 15.6 / 20.0 * 1.275**-1.5
    ends = [
        kaneko_hayashi_row(K1, replace(ACTION, peak_velocity=2.4 / (2.0 * math.pi * bound * side))).capacity
        for side in (1.0 - 1e-6, 1.0 + 1e-6)
    ]
    assert ends[0] == pytest.approx(ends[1], rel=2e-3)  # the published constants are rounded


# ---- sliding distances -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ratio", "peak", "velocity", "expected"),
    [
        (0.8175, 2.4, PEAK_VELOCITY, [0.00825, 0.01178, 0.00103, 0.00134, 0.00041, 0.00155]),
        (0.5, 3.924, 0.6, [0.0917, 0.1277, 0.0309, 0.0293, 0.0088, 0.0476]),
    ],
)
def test_sliding_regressions(ratio, peak, velocity, expected):
    found = [rule.slip(ratio, peak, velocity) for rule in RULES]
    np.testing.assert_allclose(found, expected, rtol=0.006, atol=5e-6)


def test_sliding_rows_stand_against_the_slip_that_is_allowed():
    rows = sliding_rows(K1, LIMITS, ACTION)
    assert [row.utilisation for row in rows[:2]] == pytest.approx([0.0825, 0.1178], rel=2e-3)
    assert all(row.utilisation == 0.0 for row in sliding_rows(k1(mu_kinetic=0.4), LIMITS, ACTION))


# ---- wind ------------------------------------------------------------------------------------------------------------


def test_peak_velocity_pressure():
    assert terrain_pressure(category="II", basic_velocity=25.0, height=4.0) == pytest.approx(703.3, abs=0.05)
    with pytest.raises(ValueError, match="one of 0, I, II, III, IV"):
        terrain_pressure(category="V", basic_velocity=25.0, height=4.0)


@pytest.mark.parametrize(
    ("zone", "place", "height", "expected"),
    [
        (1, "inland", 4.0, 500.0),
        (2, "inland", 10.0, 650.0),
        (2, "inland", 10.5, 800.0),
        (3, "coast", 25.0, 1300.0),
        (4, "North Sea islands", 8.0, 1400.0),
    ],
)
def test_simplified_german_pressures(zone, place, height, expected):
    assert german_pressure(zone=zone, place=place, height=height) == expected


@pytest.mark.parametrize(
    ("zone", "place", "height"), [(1, "coast", 5.0), (2, "inland", 26.0), (4, "North Sea islands", 12.0)]
)
def test_simplified_german_pressures_have_limits(zone, place, height):
    with pytest.raises(ValueError, match="wind pressure"):
        german_pressure(zone=zone, place=place, height=height)


@pytest.mark.parametrize(
    ("pressure", "overturning"), [(650.0, 0.2540), (500.0, 0.1954), (800.0, 0.3126), (950.0, 0.3712)]
)
def test_overturning_by_wind(pressure, overturning):
    assert wind_rows(K1, pressure)[0].utilisation == pytest.approx(overturning, abs=5.1e-5)


def test_wind_force_and_sliding_by_wind():
    wind = wind_force(K1, 650.0)
    assert wind.coefficient == pytest.approx(1.4373, abs=5.1e-5)
    assert wind.force == pytest.approx(4111.0, abs=0.5)
    assert wind_rows(K1, 650.0)[1].utilisation == pytest.approx(0.1746, abs=5.1e-5)
    low = wind_rows(k1(mu_static=0.2), 650.0, gamma_mu=1.3)[1]
    assert low.utilisation == pytest.approx(0.4540, abs=5.1e-5)
    least_weight = 1.5 * 4111.0 * 2.0 / (0.9 * 0.55)
    light = replace(K1, mass=least_weight / 9.81)
    assert wind_rows(light, 650.0)[0].utilisation == pytest.approx(1.0, abs=1e-3)
    assert light.weight == pytest.approx(24910.0, abs=10.0)


def test_a_tall_body_has_no_wind_row():
    with pytest.raises(ValueError, match="up to 15 m"):
        wind_force(replace(K1, height=16.0), 650.0)


# ---- side by side ----------------------------------------------------------------------------------------------------


def test_all_methods_have_their_formula_numbers_source_and_validity():
    rows = method_rows(methods_of(K1, LIMITS, behaviour_factor=1.5, height_ratio=0.5), ACTION)
    assert len({(row.name, row.quantity) for row in rows}) == len(rows) == 30
    for row in rows:
        assert row.formula and row.numbers and row.says and row.validity and str(row.source)
        assert row.unit
        assert "safe" not in f"{row.says} {row.validity}"


def test_only_what_may_be_cited_is_called_a_clause():
    rows = method_rows(methods_of(K1, LIMITS, behaviour_factor=1.5), ACTION) + wind_rows(K1, 650.0)
    cited = {row.source.work for row in rows if row.source.standing is SourceStanding.CLAUSE}
    assert cited == {"EN 1998-1:2004", "EN 1991-1-4:2005"}
    with pytest.raises(ValueError, match="it may be cited"):
        MethodSource(work="ASCE/SEI 43-05", clause="A.1", standing=SourceStanding.UNCHECKED)


def test_a_behaviour_factor_of_one_is_one_row():
    rows = method_rows(methods_of(K1, LIMITS, behaviour_factor=1.0), ACTION)
    assert sum(row.name.startswith("plateau") for row in rows) == 2  # overturning and sliding


@pytest.mark.parametrize(("height_ratio", "grey"), [(0.0, False), (0.8, True)])
def test_on_a_floor_the_plateau_of_the_ground_is_out_of_its_range(height_ratio, grey):
    rows = method_rows(methods_of(K1, LIMITS, behaviour_factor=1.5, height_ratio=height_ratio), ACTION)
    plateau = [row for row in rows if row.name.startswith("plateau")]
    assert len(plateau) == 4 and all(bool(row.beyond) is grey for row in plateau)
    assert not any(row.beyond for row in rows if row.name.startswith("element"))


def test_capacity_over_strength_is_where_a_method_is_used_up():
    methods = methods_of(K1, LIMITS, behaviour_factor=1.5)
    found = method_capacities(methods, ACTION)
    rows = method_rows(methods, ACTION)
    assert [one.name for one in found] == [row.name for row in rows]
    assert found[0].factor == pytest.approx(1.0 / 0.8896, rel=1e-4)
    with_vertical = next(one for one in found if one.name == "static rule, 1 horizontal, 1 vertical")
    # 2.4 f h = (g - 1.6 f) b
    assert with_vertical.factor == pytest.approx(9.81 * 0.55 / (2.4 * 2.0 + 1.6 * 0.55), rel=1e-6)
    for k, one in enumerate(found):
        assert method_rows(methods, ACTION.scaled(0.999 * one.factor))[k].fulfilled
        assert not method_rows(methods, ACTION.scaled(1.001 * one.factor))[k].fulfilled


@pytest.mark.parametrize(
    "make",
    [
        lambda: Limits(slip=math.nan),
        lambda: replace(K1, mass=-1.0),
        lambda: replace(ACTION, peak=math.inf),
    ],
)
def test_numbers_out_of_range_are_refused(make):
    with pytest.raises(ValueError, match="must be"):
        make()


def test_a_body_that_is_not_homogeneous_keeps_its_inertia():
    heavy_base = LooseBody(
        block=RigidBlock(half_width=0.55, centroid_height=1.5, gravity=9.81, inertia_ratio=1.5),
        width=1.1,
        height=4.0,
        depth=1.1,
        mass=10_000.0,
        mu_static=0.4,
        mu_kinetic=0.2,
    )
    assert velocity_step(heavy_base) > velocity_step(K1)


def test_the_action_on_the_ground_is_that_of_the_site():
    assert (ACTION.peak, ACTION.vertical_peak) == pytest.approx((2.4, 1.6))
    assert FloorAction.on_ground(SITE.times(2.0), 0.0).ground_peak == pytest.approx(4.8)
