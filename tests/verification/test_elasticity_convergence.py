"""Manufactured solution at finite strain and rotation: observed orders of the total-Lagrangian elements.

The solution and its source stand in `fem.verification.manufactured`, written from the textbook's law.
"""

import numpy as np
import pytest

from fem.verification.manufactured import (
    gradient_of,
    moving_body_error,
    static_error,
    static_source,
    textbook_stress,
    turned_and_strained,
)
from fem.verification.time_stepping import SCHEMES

POINTS = np.array([0.3, 0.9]), np.array([0.2, 0.7])


def test_gradient_belongs_to_the_exact_field():
    # Against differences of the displacement: else a slip could hide.
    x, z = POINTS
    h = 1e-5
    along_x = (turned_and_strained(x + h, z, 0.4, 1.3) - turned_and_strained(x - h, z, 0.4, 1.3)) / (2 * h)
    along_z = (turned_and_strained(x, z + h, 0.4, 1.3) - turned_and_strained(x, z - h, 0.4, 1.3)) / (2 * h)
    assert gradient_of(x, z, 0.4, 1.3) == pytest.approx(np.stack([along_x, along_z], axis=1), abs=1e-9)


def test_source_is_minus_the_divergence_of_the_stress():
    x, z = POINTS
    h = 1e-4
    along = (textbook_stress(x + h, z, 0.4, 1.0)[:, 0] - textbook_stress(x - h, z, 0.4, 1.0)[:, 0]) / (2 * h)
    up = (textbook_stress(x, z + h, 0.4, 1.0)[:, 1] - textbook_stress(x, z - h, 0.4, 1.0)[:, 1]) / (2 * h)
    assert static_source(x, z, 0.4, 1.0) == pytest.approx(-0.4 * (along + up), abs=1e-7)


@pytest.mark.parametrize(("order", "cells"), [(1, (4, 8, 16, 32)), (2, (3, 6, 12, 24))])
def test_displacement_converges_with_one_order_more_than_the_element_has(order, cells):
    errors = [static_error(order, n) for n in cells]
    orders = -np.diff(np.log(errors)) / np.diff(np.log(cells))
    assert orders[-1] == pytest.approx(order + 1, abs=0.05)
    assert np.all(orders > order + 0.8)


@pytest.mark.parametrize("scheme", ["generalised-alpha 0.5", "trapezoidal rule"])
def test_a_body_that_turns_far_is_stepped_to_second_order(scheme):
    errors = [moving_body_error(SCHEMES[scheme], 0.5 / count) for count in (20, 40, 80)]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders == pytest.approx([2.0, 2.0], abs=0.1)
