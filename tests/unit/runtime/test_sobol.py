"""The points by which the unknown inputs of a case are drawn, against those of scipy."""

import numpy as np
import pytest
from scipy.stats import qmc

from fem.case.unknown_inputs import UNKNOWN
from fem.runtime.sobol import MOST_DIMENSIONS, sobol_points


@pytest.mark.parametrize(("count", "bits"), [(1, 0), (2, 1), (5, 3), (32, 5), (1000, 10)])
def test_points_are_those_of_scipy_in_the_middle_of_their_cells(count, bits):
    points = sobol_points(count, MOST_DIMENSIONS)
    reference = qmc.Sobol(MOST_DIMENSIONS, scramble=False).random_base2(bits)[:count]
    np.testing.assert_array_equal(points, reference + 0.5 / 2**bits)
    np.testing.assert_array_equal(points[:, :3], sobol_points(count, 3))


def test_all_unknown_inputs_can_be_drawn_at_once():
    assert len(UNKNOWN) <= MOST_DIMENSIONS
    with pytest.raises(
        ValueError, match=f"at most {MOST_DIMENSIONS} dimensions here, got {MOST_DIMENSIONS + 1}"
    ):
        sobol_points(4, MOST_DIMENSIONS + 1)
