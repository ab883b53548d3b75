"""The largest stress of many samples, found without looking at all of them."""

import numpy as np
import pytest

from fem.case.case import load_case
from fem.model.model import build_model
from fem.model.recovery import recovery_of


@pytest.fixture(scope="module")
def recovery():
    case = load_case("seed_box", ["solver.elastic_modes=6", "solver.element_size_m=0.25", "solver.order=1"])
    return recovery_of(build_model(case))


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
    # the sample of the most strain energy need not be that of the largest stress
    energies = np.linalg.norm(modal * recovery.angular_frequencies, axis=1)
    assert np.all(each <= recovery._bounds * energies[:, None] * (1.0 + 1e-9))


def test_a_bound_is_reached_by_the_worst_shape(recovery):
    # The singular vector of a node's stress per root of energy: no other shape of that energy stresses it more.
    node = int(np.argmax(recovery._bounds))
    size = 1e-3
    random = np.random.default_rng(0)
    shapes = random.standard_normal((4000, len(recovery.angular_frequencies)))
    shapes *= size / np.linalg.norm(shapes, axis=1)[:, None]
    found = recovery.largest_von_mises(
        np.column_stack([np.zeros((4000, 3)), shapes / recovery.angular_frequencies])
    )
    assert 0.8 * size * recovery._bounds[node] < found <= size * recovery._bounds[node] * (1.0 + 1e-9)
