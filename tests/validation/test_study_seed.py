"""Statements of the seed paper whose verdict is known beforehand, tried by runs of the rigid container."""

import numpy as np
import pytest

from fem.paper import numbers, quasi_static, rocking, shape
from fem.paper.claims import Verdict
from fem.paper.experiments import Laboratory


@pytest.fixture(scope="module")
def laboratory():
    return Laboratory()


@pytest.mark.parametrize(
    ("examine", "verdict"),
    [
        (numbers.one_box, Verdict.BOUNDED),  # with g = 9.81 the utilisation of stiction is 1.019
        (numbers.four_boxes, Verdict.BOUNDED),
        (numbers.half_width, Verdict.REFUTED),  # 550 mm, printed 600
        (quasi_static.kinetic_limit, Verdict.CONFIRMED),  # Coulomb
        (quasi_static.moments_of_a_tilted_body, Verdict.CONFIRMED),  # statics: g tan(al - theta)
        (quasi_static.sign_beyond_balance, Verdict.REFUTED),  # the sign of a cosine
        (rocking.eq_2, Verdict.BOUNDED),  # sqrt(3/4) of the block's period at small rotation
        (rocking.eq_3, Verdict.BOUNDED),  # T p/4 = arccosh(1/(1 - theta/al)), which 2 pi/4 meets near 0.6 al
        (rocking.control_periods, Verdict.BOUNDED),  # the same
    ],
)
def test_verdict_on_a_statement_that_theory_decides(laboratory, examine, verdict):
    finding = examine(laboratory)
    assert not laboratory.failed
    assert finding.verdict is verdict


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
