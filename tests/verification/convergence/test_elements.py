"""The manufactured solution with which the elements are verified."""

import numpy as np
import pytest
from verification.manufactured import (
    gradient_of,
    static_source,
    textbook_stress,
    turned_and_strained,
)

POINTS = np.array([0.3, 0.9]), np.array([0.2, 0.7])


def test_the_gradient_belongs_to_the_manufactured_displacement():
    x, z = POINTS
    h = 1e-5
    along_x = (turned_and_strained(x + h, z, 0.4, 1.3) - turned_and_strained(x - h, z, 0.4, 1.3)) / (2 * h)
    along_z = (turned_and_strained(x, z + h, 0.4, 1.3) - turned_and_strained(x, z - h, 0.4, 1.3)) / (2 * h)
    assert gradient_of(x, z, 0.4, 1.3) == pytest.approx(np.stack([along_x, along_z], axis=1), abs=1e-9)


def test_the_source_is_minus_the_divergence_of_the_stress():
    x, z = POINTS
    h = 1e-4
    along = (textbook_stress(x + h, z, 0.4, 1.0)[:, 0] - textbook_stress(x - h, z, 0.4, 1.0)[:, 0]) / (2 * h)
    up = (textbook_stress(x, z + h, 0.4, 1.0)[:, 1] - textbook_stress(x, z - h, 0.4, 1.0)[:, 1]) / (2 * h)
    assert static_source(x, z, 0.4, 1.0) == pytest.approx(-0.4 * (along + up), abs=1e-7)
