"""Claims of Knoedel and Hrabowski (the paper) whose conclusion is known beforehand, by runs of the rigid container."""

import numpy as np
import pytest
from paper import example, quasi_static, rocking, shape, stacking
from paper.claims import Conclusion
from paper.experiments import Experiments
from paper.run import all_claims


@pytest.fixture(scope="module")
def experiments():
    return Experiments()


@pytest.mark.parametrize(
    ("claim", "conclusion"),
    [
        (example.numbers_one_box, Conclusion.BOUNDED),  # with g = 9.81 the utilisation of stiction is 1.019
        (example.numbers_four_boxes, Conclusion.BOUNDED),
        (example.half_width, Conclusion.MISPRINT),  # 550 mm, printed 600
        (quasi_static.kinetic_limit, Conclusion.CONFIRMED),  # Coulomb
        (quasi_static.moments_of_a_tilted_body, Conclusion.CONFIRMED),  # statics: g tan(al - theta)
        (quasi_static.centre_or_base, Conclusion.REMARK),  # a rigid body that sticks moves with the floor
        (quasi_static.sign_beyond_balance, Conclusion.CONFIRMED),  # statics: it falls beyond balance
        (rocking.eq_2, Conclusion.BOUNDED),  # sqrt(3/4) of the block's period at small rotation
        # T p/4 = arccosh(1/(1 - theta/al)), which 2 pi/4 meets near 0.6 al
        pytest.param(rocking.eq_3, Conclusion.BOUNDED, marks=pytest.mark.slow),
        (rocking.control_periods, Conclusion.BOUNDED),  # the same
        # Coulomb: what stands on a box that sticks to the floor slides as one box on a floor with that friction
        (stacking.slip_between_loose_boxes, Conclusion.CONFIRMED),
    ],
)
def test_conclusion_on_a_claim_that_theory_decides(experiments, claim, conclusion):
    finding = claim.check(experiments)
    assert not experiments.failed
    assert finding.conclusion is conclusion


@pytest.mark.slow
@pytest.mark.parametrize("claim", all_claims(), ids=lambda claim: claim.name)
def test_every_claim_is_decided_and_no_run_that_it_needs_fails(experiments, claim):
    assert claim.check(experiments).conclusion is not Conclusion.UNDECIDED


def test_inertia_of_a_cylinder_about_the_edge_of_its_base():
    # Slices of the elevation: chord 2 sqrt(r^2 - x^2) at x, each a rod of height c; midpoint rule.
    radius, height = 0.55, 4.0
    x = (np.arange(20000) + 0.5) / 20000 * 2.0 * radius - radius
    chord = 2.0 * np.sqrt(radius**2 - x**2)
    about_edge = np.average((x + radius) ** 2 + height**2 / 3.0, weights=chord)
    ratio = about_edge / (radius**2 + 0.25 * height**2)
    assert shape.inertia_ratio(cylinder=True) == pytest.approx(ratio, rel=1e-6)
    assert shape.inertia_ratio(cylinder=False) == pytest.approx(4.0 / 3.0, rel=1e-12)
    # a thin wall: all mass at distance r from the axis, whose mean square of x is r^2/2
    wall = (0.5 * radius**2 + radius**2 + height**2 / 3.0) / (radius**2 + 0.25 * height**2)
    assert shape.inertia_ratio(cylinder=True, hollow=True) == pytest.approx(wall, rel=1e-12)
