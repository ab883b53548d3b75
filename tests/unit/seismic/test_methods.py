"""Simplified methods against numbers worked by hand for container K1 on site S1."""

import math
from dataclasses import replace

import pytest
from site_example import ACTION, PEAK_VELOCITY, SLIP, k1

from fem.seismic import methods as rules
from fem.seismic.body import FloorAction, MethodQuantity, MethodRow
from fem.seismic.methods import methods_of, rows_with_factors
from fem.seismic.wind import german_pressure, terrain_pressure, wind_force, wind_rows

K1 = k1()


def rows_of(methods, action: FloorAction) -> list[MethodRow]:
    return [row for method in methods for row in method(action)]


def utilisations(rows: list[MethodRow]) -> dict[MethodQuantity, float]:
    return {row.quantity: row.utilisation for row in rows}


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
        found = utilisations(rules.peak_rows(body, ACTION, horizontal=pair[0], vertical=pair[1]))
        assert found[MethodQuantity.OVERTURNING] == pytest.approx(overturning, abs=5.1e-5)
        assert found[MethodQuantity.SLIDING] == pytest.approx(expected, abs=5.1e-5)


def test_both_directions_add_up_in_friction_alone():
    square = utilisations(rules.both_directions_rows(K1, ACTION))
    assert square[MethodQuantity.OVERTURNING] == pytest.approx(0.8896, abs=5.1e-5)
    assert square[MethodQuantity.SLIDING] == pytest.approx(0.6116 * math.sqrt(1.09), abs=1e-4)
    # a quarter as deep as wide: 0.3/0.25 of the demand about the long edge
    flat = utilisations(rules.both_directions_rows(replace(K1, depth=0.275), ACTION))
    assert flat[MethodQuantity.OVERTURNING] == pytest.approx(0.8896 * 1.2, abs=1e-4)


def test_a_vertical_peak_of_gravity_leaves_no_capacity():
    rows = rules.peak_rows(K1, replace(ACTION, vertical_peak=9.81), horizontal=1.0, vertical=1.0)
    assert all(math.isinf(row.utilisation) and not row.fulfilled for row in rows)


@pytest.mark.parametrize(("q", "expected"), [(1.0, 2.224), (1.5, 1.483), (2.0, 1.112)])
def test_plateau_of_the_design_spectrum(q, expected):
    found = utilisations(rules.plateau_rows(K1, ACTION, behaviour_factor=q))
    assert found[MethodQuantity.OVERTURNING] == pytest.approx(expected, abs=5.1e-4)


@pytest.mark.parametrize(
    ("height_ratio", "expected"),
    [(0.0, [2.4, 4.56, 6.0, 2.4]), (0.5, [4.2, 7.44, 9.6, 4.2]), (1.0, [6.0, 10.32, 13.2, 6.0])],
)
def test_force_on_an_element_of_a_floor(height_ratio, expected):
    for period_ratio, acceleration in zip((0.0, 0.5, 1.0, 2.0), expected, strict=True):
        assert 2.4 * rules.floor_factor(height_ratio, period_ratio) == pytest.approx(acceleration)
        row = rules.element_rows(K1, ACTION, height_ratio=height_ratio, period_ratio=period_ratio)[0]
        assert row.demand == pytest.approx(acceleration)
        assert row.capacity == pytest.approx(2.69775)


def test_velocity_of_housner():
    assert ACTION.spectral_velocity == pytest.approx(0.7639, abs=5.1e-5)
    assert pytest.approx(0.3809, abs=5.1e-5) == PEAK_VELOCITY
    row = rules.housner_row(K1, ACTION)
    assert row.capacity == pytest.approx(1.3979, abs=5.1e-5)
    assert row.utilisation == pytest.approx(0.55, abs=5.1e-3)
    assert row.median


@pytest.mark.parametrize(
    ("ratio", "peak", "velocity", "expected"),
    [(0.8175, 2.4, PEAK_VELOCITY, 0.00825), (0.5, 3.924, 0.6, 0.0917), (0.1, 2.0, 0.3, 1.35)],
)
def test_sliding_block_of_newmark(ratio, peak, velocity, expected):
    assert rules.newmark_slip(ratio, peak, velocity) == pytest.approx(expected, rel=0.006)


def test_the_sliding_block_stands_against_the_slip_that_is_allowed():
    assert rules.newmark_row(K1, SLIP, ACTION).utilisation == pytest.approx(0.0825, rel=2e-3)
    assert rules.newmark_row(k1(mu_kinetic=0.4), SLIP, ACTION).utilisation == 0.0


def test_peak_velocity_pressure():
    assert terrain_pressure(category="II", basic_velocity=25.0, height=4.0) == pytest.approx(703.3, abs=0.05)
    with pytest.raises(ValueError, match="one of 0, I, II, III, IV"):
        terrain_pressure(category="V", basic_velocity=25.0, height=4.0)


def test_simplified_german_pressures_have_limits():
    zones = {
        (1, "inland", 4.0): 500.0,
        (2, "inland", 10.0): 650.0,
        (2, "inland", 10.5): 800.0,
        (3, "coast", 25.0): 1300.0,
        (4, "North Sea islands", 8.0): 1400.0,
    }
    for (zone, place, height), expected in zones.items():
        assert german_pressure(zone=zone, place=place, height=height) == expected
    for zone, place, height in ((1, "coast", 5.0), (2, "inland", 26.0), (4, "North Sea islands", 12.0)):
        with pytest.raises(ValueError, match="wind pressure"):
            german_pressure(zone=zone, place=place, height=height)
    with pytest.raises(ValueError, match="up to 15 m"):
        wind_force(replace(K1, height=16.0), 650.0)


def test_wind_force_and_what_it_uses():
    for pressure, overturning in {650.0: 0.2540, 500.0: 0.1954, 800.0: 0.3126, 950.0: 0.3712}.items():
        assert wind_rows(K1, pressure)[0].utilisation == pytest.approx(overturning, abs=5.1e-5)
    coefficient, _, force = wind_force(K1, 650.0)
    assert (coefficient, force) == (pytest.approx(1.4373, abs=5.1e-5), pytest.approx(4111.0, abs=0.5))
    assert wind_rows(K1, 650.0)[1].utilisation == pytest.approx(0.1746, abs=5.1e-5)
    low = wind_rows(k1(mu_static=0.2), 650.0, gamma_mu=1.3)[1]
    assert low.utilisation == pytest.approx(0.4540, abs=5.1e-5)
    least_weight = 1.5 * 4111.0 * 2.0 / (0.9 * 0.55)
    light = replace(K1, mass=least_weight / 9.81)
    assert wind_rows(light, 650.0)[0].utilisation == pytest.approx(1.0, abs=1e-3)
    assert light.weight == pytest.approx(24910.0, abs=10.0)


def test_only_what_may_be_cited_is_called_a_clause():
    rows = rows_of(methods_of(K1, SLIP, behaviour_factor=1.5), ACTION) + wind_rows(K1, 650.0)
    cited = {row.source.partition(",")[0] for row in rows if "derived here" not in row.source}
    assert cited == {"EN 1998-1:2004", "EN 1991-1-4:2005", "Newmark (1965)"}
    named = {row.name.partition(",")[0] for row in rows if "derived here" not in row.source}
    assert named == {"element on a floor", "Newmark (1965)", "wind"}


@pytest.mark.parametrize(
    ("height_ratio", "grey"), [(0.0, set()), (0.8, {"plateau of the", "Housner", "Newmark (1965)"})]
)
def test_on_a_floor_what_is_of_the_ground_is_out_of_its_range_and_a_median_is_marked(height_ratio, grey):
    methods = methods_of(K1, SLIP, behaviour_factor=1.5, height_ratio=height_ratio)
    rows = rows_of(methods, replace(ACTION, in_building=height_ratio > 0.0))
    assert {row.name.partition(",")[0].partition(" design")[0] for row in rows if row.beyond} == grey
    assert len([row for row in rows if row.name.startswith("plateau")]) == 4
    assert [row.name for row in rows if row.median] == ["Housner, spectral velocity"]


def test_capacity_over_strength_is_where_a_method_is_used_up():
    methods = methods_of(K1, SLIP, behaviour_factor=1.5)
    found = rows_with_factors(methods, ACTION)
    assert [row for row, _ in found] == rows_of(methods, ACTION)
    assert found[0][1] == pytest.approx(1.0 / 0.8896, rel=1e-4)
    name = "static rule, 1 horizontal, 1 vertical"
    with_vertical = next(factor for row, factor in found if row.name == name)
    # 2.4 f h = (g - 1.6 f) b
    assert with_vertical == pytest.approx(9.81 * 0.55 / (2.4 * 2.0 + 1.6 * 0.55), rel=1e-6)
    for k, (_, factor) in enumerate(found):
        assert rows_of(methods, ACTION.scaled(0.999 * factor))[k].fulfilled
        assert not rows_of(methods, ACTION.scaled(1.001 * factor))[k].fulfilled
