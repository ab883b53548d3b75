"""Static checks: each provision against its own statement in words or in closed form."""

import math

import pytest
from cases import named_case
from hypothesis import given
from hypothesis import strategies as st

from fem.case.case import load_case
from fem.case.tables.run_tables import StaticTable
from fem.case.validation import CaseError
from fem.model.geometry import build_container
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks, static_checks_of
from fem.run.described import code_note

CODE = StaticTable(ground_acceleration_m_s2=1.6, soil_factor=1.5, corner_period_s=0.8, behaviour_factor=1.5)


def code(**changes):
    """The values of the code with some changed."""
    return CODE.model_copy(update=changes)


def block(width=1.0, height=4.0, mass=1000.0, **changes):
    arguments = {
        "mass": mass,
        "centroid": 0.5 * height,
        "inertia": mass * (width**2 + height**2) / 12.0,
        "width": width,
        "gravity": 9.81,
        "mu_static": 0.4,
        "mu_kinetic": 0.2,
        "peak_floor_acceleration": 3.0,
        "code": CODE,
    }
    return static_checks(**(arguments | changes))


def test_uplift_acceleration_is_where_the_own_motion_just_overturns():
    uplift = block().uplift_acceleration
    assert block(peak_floor_acceleration=uplift).own_motion.overturning.utilisation == pytest.approx(1.0)
    assert uplift == pytest.approx(9.81 / 4.0)


SLOPE = math.atan(0.02)


def test_on_a_slope_uplift_and_sliding_begin_earlier():
    # Forces along and normal to a floor that falls by 2 %, the floor accelerated uphill by a: m (a + g sin), m g cos.
    uplift = block(slope=SLOPE).uplift_acceleration
    assert uplift == pytest.approx(9.81 * (math.cos(SLOPE) / 4.0 - math.sin(SLOPE)))
    own = block(slope=SLOPE, peak_floor_acceleration=uplift).own_motion
    assert own.overturning.utilisation == pytest.approx(1.0)
    slides = 9.81 * (0.4 * math.cos(SLOPE) - math.sin(SLOPE))
    own = block(slope=SLOPE, peak_floor_acceleration=slides).own_motion
    assert own.sliding.utilisation == pytest.approx(1.0)


def test_a_vertical_motion_on_a_slope_takes_its_part_of_the_weight_toward_the_floor():
    static = block(slope=SLOPE, peak_vertical_acceleration=2.0)
    assert static.own_motion_vertical.least_weight == pytest.approx(1000.0 * (9.81 * math.cos(SLOPE) - 2.0))
    assert static.own_motion_vertical.sliding.demand == pytest.approx(1000.0 * (3.0 + 9.81 * math.sin(SLOPE)))


def test_plateau_base_shear_of_eq_17():
    # 2500 kg, 1.6 m/s2, S = 1.5, q = 1.5, gamma_I = 1.0: 10 kN; gamma_I 1.4: 14 kN.
    for importance, shear in ((1.0, 10e3), (1.4, 14e3)):
        static = block(mass=2500.0, code=code(importance_factor=importance))
        assert static.code.sliding.demand == pytest.approx(shear)


@given(width=st.floats(0.05, 20.0), height=st.floats(0.05, 20.0))
def test_homogeneous_block_has_housners_closed_forms(width, height):
    # Housner (1963): p^2 = 3 g/(4 R), e = 1 - 3/2 sin^2 al.
    static = block(width=width, height=height)
    arm, angle = math.hypot(width, height) / 2.0, math.atan2(width, height)
    assert static.slenderness_angle == pytest.approx(angle, rel=1e-12)
    assert static.frequency_parameter == pytest.approx(math.sqrt(3 * 9.81 / (4 * arm)), rel=1e-12)
    assert static.housner_restitution == pytest.approx(1.0 - 1.5 * math.sin(angle) ** 2, rel=1e-9, abs=1e-12)
    assert static.housner_credible == (static.housner_restitution >= 0.5)


def test_period_of_a_point_mass_takes_the_initial_rotation_or_half_the_slenderness_angle():
    # Eq. (2): T = 8 sqrt(phi_0 r^2/(a g)); the sign of the rotation plays no part.
    static = block()
    half = 0.5 * static.slenderness_angle
    assert static.period_eq2 == pytest.approx(8.0 * math.sqrt(half * (0.25 + 4.0) / (1.0 * 9.81)))
    assert block(initial_rotation=-half).period_eq2 == static.period_eq2
    assert block(initial_rotation=0.25 * half).period_eq2 == pytest.approx(0.5 * static.period_eq2)


def test_lateral_force_method_is_limited_to_two_seconds_and_four_control_periods():
    # EN 1998-1:2004, 4.3.3.2.1 (2) a): T1 <= 4 T_C and T1 <= 2.0 s.
    for corner_period, limit in ((0.8, 2.0), (0.4, 1.6)):
        applicability = block(code=code(corner_period_s=corner_period)).by_code.applicability
        assert (applicability.demand, applicability.capacity) == (block().period_eq3, limit)


@pytest.mark.parametrize(
    ("horizontal", "vertical", "overturning", "sliding"),
    [
        (2.4, 0.0, 0.8896, 0.6116),
        (2.4, 0.48, 0.9354, 0.6431),
        (2.4, 1.6, 1.0630, 0.7308),
        (0.72, 1.6, 0.3189, 0.2192),
    ],
)
def test_a_vertical_acceleration_takes_from_the_weight(horizontal, vertical, overturning, sliding):
    # ag S = 2.4 m/s2 and avg = 1.6 m/s2, worked by hand: a h/((g - a_v) b) and a/(mu (g - a_v)).
    static = block(width=1.1, peak_floor_acceleration=horizontal, peak_vertical_acceleration=vertical)
    assert static.own_motion_vertical.overturning.utilisation == pytest.approx(overturning, abs=5e-5)
    assert static.own_motion_vertical.sliding.utilisation == pytest.approx(sliding, abs=5e-5)
    assert static.own_motion == block(width=1.1, peak_floor_acceleration=horizontal).own_motion
    assert static.ruling is static.own_motion_vertical


def test_a_floor_that_falls_with_gravity_leaves_no_capacity():
    static = block(peak_vertical_acceleration=12.0)
    assert static.own_motion_vertical.overturning.utilisation == math.inf
    assert static.to_result().own_motion_vertical.least_weight_N == 0.0
    assert block().own_motion_vertical is None


@pytest.mark.parametrize(
    ("name", "utilisation"), [("seed_box", 0.2224), ("seed_stack", 0.8896), ("seed_stack_plateau", 1.4828)]
)
def test_shipped_cases_have_the_utilisation_of_the_paper_container(name, utilisation):
    # M x_b'' z_c/(G a/2) = (peak/g) (2 z_c/a): it depends neither on the walls nor on the position of the fill.
    case = load_case(name)
    static = static_checks_of(case, build_container(case), *peaks_in_run(case, *build_motions(case)))
    assert static.own_motion.overturning.utilisation == pytest.approx(utilisation, abs=1e-4)
    assert static.weight == pytest.approx(case.container.boxes * 24525.0, rel=1e-9)


@pytest.mark.parametrize(("shape", "base"), [("prism", 2.1), ("cylinder", 1.2)])
def test_the_wind_is_a_row_beside_the_static_rules_and_nowhere_else(shape, base):
    # EN 1991-1-4, 7.6, 7.9 and figure 7.36 by hand: 4 x 1.1 m, slenderness 2 x 4/1.1, psi = 0.6 + 0.098 lg 7.27
    keys = {"container.boxes": 4, "container.shape": shape, "wind.peak_velocity_pressure_Pa": 650.0}
    case = named_case("least", keys | {"wind.gamma_mu": 1.3})
    force = 1.5 * base * (0.6 + 0.098 * math.log10(8.0 / 1.1)) * 650.0 * 4.4
    found = static_checks_of(case, build_container(case), 0.0)
    assert found.wind.sliding.utilisation == pytest.approx(force * 1.3 / (0.9 * 98100.0 * 0.4))
    assert found.wind.overturning.utilisation == pytest.approx(force * 2.0 / (0.9 * 98100.0 * 0.55))
    assert "psi_2 of wind is 0" in code_note(found.to_result())
    still = named_case("least", {"container.boxes": 4, "container.shape": shape})
    without = static_checks_of(still, build_container(still), 0.0)
    assert (without.wind, code_note(without.to_result())) == (None, "")
    assert "wind" not in without.to_result().to_json()


def test_a_container_too_high_for_the_wind_is_refused_with_a_sentence():
    case = named_case("least", {"container.boxes": 20, "wind.peak_velocity_pressure_Pa": 650.0})
    with pytest.raises(CaseError, match=r"\[wind\] .* up to 15 m, got 20 m; leave the table out"):
        static_checks_of(case, build_container(case), 0.0)
