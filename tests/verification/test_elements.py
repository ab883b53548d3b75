"""What the elements must reproduce exactly, and the manufactured solution that they are verified with."""

import numpy as np
import pytest

from fem.verification.elasticity import distorted_block, turn
from fem.verification.manufactured import gradient_of, static_source, textbook_stress, turned_and_strained

POINTS = np.array([0.3, 0.9]), np.array([0.2, 0.7])


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("angle", [-0.3, np.pi / 2])
def test_rigid_rotation_causes_neither_strain_energy_nor_internal_forces(order, angle):
    elements = distorted_block(order)
    rotated = elements.nodes @ turn(angle).T - elements.nodes
    linear = elements.stiffness @ rotated.ravel()  # forces by linear strain
    energy = 0.5 * rotated.ravel() @ linear
    assert energy > 1e6
    assert 0.0 <= elements.strain_energy(rotated) <= 1e-10 * energy
    assert np.abs(elements.internal_force(rotated)).max() <= 1e-12 * np.abs(linear).max()


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
