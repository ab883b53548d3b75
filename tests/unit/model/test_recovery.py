"""The largest stress of many samples, found without looking at all of them."""

import numpy as np
import pytest

from fem.case.case import load_case
from fem.model.model import build_model
from fem.model.recovery import recovery_of


@pytest.fixture(scope="module")
def recovery():
    case = load_case("seed_box", ["solver.elastic_modes=6", "solver.element_size_m=0.25", "solver.order=1"])
    return recovery_of(build_model(case)).bodies[0].body


@pytest.mark.parametrize("seed", range(4))
def test_the_largest_stress_is_that_of_all_nodes_in_all_samples(recovery, seed):
    # Amplitudes so spread that bounds leave out some samples, and not spread so much that they leave out all others.
    random = np.random.default_rng(seed)
    count, modes = 40, len(recovery.angular_frequencies)
    modal = (
        random.standard_normal((count, modes))
        * random.uniform(0.5, 1.5, (count, 1))
        / recovery.angular_frequencies
    )
    positions = np.column_stack([np.zeros((count, 3)), modal])
    each = [recovery.frame(row, np.zeros_like(row)).von_mises for row in positions]
    assert recovery.largest_von_mises(positions) == pytest.approx(np.max(each), rel=1e-12)
