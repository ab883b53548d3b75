"""The numbers of the seed paper's section 7, printed with g = 10, and the same with g = 9.81.

Printed values carry the paper's own rounding (two or three figures); the tolerance is half a unit of the
last digit printed. With g = 9.81 the mass is kept and the weight follows; those values are closed forms.
"""

import pytest

from fem.case.case import load_case
from fem.cli.check import peak_floor_acceleration
from fem.model.geometry import build_container
from fem.model.static_checks import static_checks_of
from fem.verification.statics import seed_checks


def test_one_box_of_the_paper():
    # Eqs. (14) to (19): 10 kN, 13,8 kNm (13.75 in full), 5 kN, 10 kN, 5 kNm, 1,98 s.
    checks = seed_checks(boxes=1, gravity=10.0)
    assert checks.weight == pytest.approx(25e3)
    assert checks.sliding_limit_static == pytest.approx(10e3, abs=0.5)
    assert checks.sliding_limit_kinetic == pytest.approx(5e3, abs=0.5)
    assert checks.restoring_moment == pytest.approx(13.75e3, abs=0.5)
    assert checks.code.sliding.demand == pytest.approx(10e3, abs=0.5)
    assert checks.code.overturning.demand == pytest.approx(5e3, abs=0.5)
    assert checks.period_eq3 == pytest.approx(1.98, abs=0.005)


def test_one_box_of_the_paper_just_remains_sticking_and_does_not_tilt():
    # Section 7: "the body will just remain in the sticking mode and will not tilt".
    code = seed_checks(boxes=1, gravity=10.0).code
    assert code.sliding.utilisation == pytest.approx(1.0, abs=1e-12)
    assert code.overturning.passed


def test_four_boxes_of_the_paper():
    # Section 7: 40 kN (and 20 kN kinetic, four times 5 kN), 55,0 kNm, 40 kN, 80 kNm, 3,30 s.
    checks = seed_checks(boxes=4, gravity=10.0)
    assert checks.sliding_limit_static == pytest.approx(40e3, abs=0.5)
    assert checks.sliding_limit_kinetic == pytest.approx(20e3, abs=0.5)
    assert checks.restoring_moment == pytest.approx(55.0e3, abs=0.5)
    assert checks.code.sliding.demand == pytest.approx(40e3, abs=0.5)
    assert checks.code.overturning.demand == pytest.approx(80e3, abs=0.5)
    assert checks.period_eq3 == pytest.approx(3.30, abs=0.005)
    assert not checks.code.overturning.passed


@pytest.mark.parametrize(
    ("boxes", "weight", "period", "frequency", "restitution"),
    [(1, 24525.0, 1.997, 3.14617, 0.17873), (4, 98100.0, 3.336, 1.88337, 0.89454)],
)
def test_the_same_containers_with_g_of_9_81(boxes, weight, period, frequency, restitution):
    # Closed forms, homogeneous block: mu G, Eq. (3), p = sqrt(3 g/(4 R)), e = 1 - 1.5 sin^2 al.
    checks = seed_checks(boxes=boxes, gravity=9.81)
    assert checks.sliding_limit_static == pytest.approx(0.4 * weight, rel=1e-12)
    assert checks.code.sliding.utilisation == pytest.approx(1.019, abs=5e-4)
    assert not checks.code.sliding.passed
    assert checks.period_eq3 == pytest.approx(period, abs=5e-4)
    assert checks.frequency_parameter == pytest.approx(frequency, abs=5e-6)
    assert checks.housner_restitution == pytest.approx(restitution, abs=5e-6)


def test_the_stated_motion_gives_the_box_three_kilonewton_metres_and_not_five():
    # 50 mm at 6.928 rad/s are 2.4 m/s2 on 2500 kg: 6 kN and 3 kNm; Eq. (18) is the plateau's 4 m/s2.
    own = seed_checks(boxes=1, gravity=10.0, peak=2.4).own_motion
    assert own.sliding.demand == pytest.approx(6e3)
    assert own.overturning.demand == pytest.approx(3e3)


def test_the_static_rule_lets_the_stack_stand_under_its_stated_motion():
    # 2.40/2.698 = 0.89 with g = 9.81: under the floor's own acceleration the rule does not say "overturns".
    checks = seed_checks(boxes=4, gravity=9.81, peak=0.05 * 6.928**2)
    assert checks.uplift_acceleration == pytest.approx(2.698, abs=5e-4)
    assert checks.own_motion.overturning.utilisation == pytest.approx(0.89, abs=0.005)


def test_the_static_rule_overturns_the_stack_at_the_plateau_value():
    # 4.0/2.698 = 1.483.
    own = seed_checks(boxes=4, gravity=9.81, peak=4.0).own_motion
    assert own.overturning.utilisation == pytest.approx(1.483, abs=5e-4)


def test_the_lateral_force_method_applies_to_the_box_and_not_to_the_stack():
    # EN 1998-1:2004, 4.3.3.2.1 (2): T <= min(4 T_C, 2.0 s); 1.997 s and 3.336 s.
    assert seed_checks(boxes=1, gravity=9.81).applicability.passed
    assert not seed_checks(boxes=4, gravity=9.81).applicability.passed


def test_eq_2_and_eq_3_of_the_paper_disagree_on_the_period_of_the_stack():
    # Eq. (2) at half the slenderness angle, r = 2.074 m, g = 10: T = 8 sqrt(0.1342 x 4.3025/(1.1 x 10)),
    # 1.833 s, against 3.304 s of Eq. (3): a point mass, and a bar that hangs.
    checks = seed_checks(boxes=4, gravity=10.0)
    assert checks.period_eq2 == pytest.approx(1.833, abs=5e-4)
    assert checks.period_eq3 == pytest.approx(3.304, abs=5e-4)


@pytest.mark.parametrize(
    ("name", "utilisation"), [("seed_box", 0.2224), ("seed_stack", 0.8896), ("seed_stack_plateau", 1.4828)]
)
def test_shipped_seed_cases_have_the_utilisation_of_the_paper_container(name, utilisation):
    # M x_b'' z_c/(G a/2) = (peak/g) (2 z_c/a): it depends neither on the walls nor on where the fill lies.
    case = load_case(name)
    static = static_checks_of(case, build_container(case), peak_floor_acceleration(case))
    assert static.own_motion.overturning.utilisation == pytest.approx(utilisation, abs=1e-4)
    assert static.weight == pytest.approx(case.container.boxes * 24525.0, rel=1e-9)
