"""Conclusions of section 7 of Knoedel and Hrabowski, with g = 10 and 9.81.

The numbers themselves are rows of the verification checks, topic `statics`.
"""

import pytest
from verification.statics import paper_checks

from fem.case.case import load_case
from fem.model.model import build_model


@pytest.mark.parametrize(
    ("boxes", "gravity", "sticks", "stands", "lateral_force"),
    [
        (1, 10.0, True, True, True),  # "will just remain in the sticking mode and will not tilt"
        (4, 10.0, True, False, False),  # 80 kNm of 55 kNm
        (1, 9.81, False, True, True),  # utilisation 1.019; T = 1.997 s
        (4, 9.81, False, False, False),  # T = 3.336 s
    ],
)
def test_the_static_rule_concludes_as_section_7_does(boxes, gravity, sticks, stands, lateral_force):
    # The lateral force method applies up to 2.0 s: EN 1998-1:2004, 4.3.3.2.1 (2), T <= min(4 T_C, 2.0 s).
    checks = paper_checks(boxes=boxes, gravity=gravity)
    code = checks.code
    found = (
        code.sliding.utilisation <= 1.0 + 1e-12,
        code.overturning.passed,
        checks.by_code.applicability.passed,
    )
    assert found == (sticks, stands, lateral_force)


def test_the_stated_motion_gives_the_box_three_kilonewton_metres_and_not_five():
    # 50 mm at 6.928 rad/s are 2.4 m/s2 on 2500 kg: 6 kN and 3 kNm; Eq. (18) is the plateau's 4 m/s2.
    own = paper_checks(boxes=1, gravity=10.0, peak=2.4).own_motion
    assert own.sliding.demand == pytest.approx(6e3)
    assert own.overturning.demand == pytest.approx(3e3)


@pytest.mark.parametrize(
    ("name", "utilisation"), [("seed_box", 0.2224), ("seed_stack", 0.8896), ("seed_stack_plateau", 1.4828)]
)
def test_shipped_cases_have_the_utilisation_of_the_paper_container(name, utilisation):
    # M x_b'' z_c/(G a/2) = (peak/g) (2 z_c/a): it depends neither on the walls nor on the position of the fill.
    case = load_case(name, ["solver.model=rigid"])
    static = build_model(case).static
    assert static.own_motion.overturning.utilisation == pytest.approx(utilisation, abs=1e-4)
    assert static.weight == pytest.approx(case.container.boxes * 24525.0, rel=1e-9)
