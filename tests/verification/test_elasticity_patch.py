"""What the elements must reproduce exactly: homogeneous states, rigid motion, a column under its weight."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from fem.solid.assembly import assemble
from fem.solid.elasticity import cauchy_stress, plane_stress_lame

ORDERS = pytest.mark.parametrize("order", [1, 2])
E, NU = 2.1e11, 0.3


def quad_mesh(columns, rows, *, width=1.1, height=4.0, distortion=0.0):
    """Structured block; inner points moved at random by up to `distortion` of a cell."""
    s, t = np.meshgrid(np.linspace(-0.5, 0.5, columns + 1), np.linspace(0.0, 1.0, rows + 1))
    points = np.stack([width * s.ravel(), height * t.ravel()], axis=1)
    inner = (np.abs(s) < 0.499).ravel() & (t > 1e-9).ravel() & (t < 1.0 - 1e-9).ravel()
    cell = np.array([width / columns, height / rows])
    points[inner] += distortion * cell * np.random.default_rng(7).uniform(-1.0, 1.0, (inner.sum(), 2))
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    corner = (j * (columns + 1) + i).ravel()
    quads = np.stack([corner, corner + 1, corner + columns + 2, corner + columns + 1], axis=1)
    full = np.ones(len(quads))
    return SimpleNamespace(
        points=points, quads=quads, region=0 * quads[:, 0], thickness=0.3 * full, areal_density=100.0 * full
    )


def on_boundary(elements):
    x, z = elements.nodes.T
    return (np.abs(x) > x.max() - 1e-9) | (z < 1e-9) | (z > z.max() - 1e-9)


def free_unknowns(held):
    return np.flatnonzero(~np.repeat(held, 2))


@ORDERS
def test_linear_patch_test_on_distorted_quads(order):
    # Boundary moved linearly: the inside must follow, to rounding, whatever the shapes of the cells.
    elements = assemble(quad_mesh(4, 6, distortion=0.3), youngs_modulus=E, poisson_ratio=NU, order=order)
    exact = elements.nodes @ np.array([[1.0, 0.5], [-0.2, 0.7]]).T * 1e-3
    free = free_unknowns(on_boundary(elements))
    displacement = exact.ravel().copy()
    displacement[free] = 0.0
    load = -elements.stiffness @ displacement
    displacement[free] = spsolve(elements.stiffness[free][:, free], load[free])
    assert np.abs(displacement - exact.ravel()).max() < 1e-12 * np.abs(exact).max()


@ORDERS
def test_patch_test_at_finite_strain_and_rotation_on_distorted_quads(order):
    elements = assemble(quad_mesh(4, 6, distortion=0.3), youngs_modulus=E, poisson_ratio=NU, order=order)
    turn = np.array([[np.cos(0.5), np.sin(0.5)], [-np.sin(0.5), np.cos(0.5)]])
    gradient = turn @ np.array([[1.03, 0.02], [-0.01, 0.96]]) - np.eye(2)
    exact = elements.nodes @ gradient.T
    inside = ~on_boundary(elements)
    free = free_unknowns(~inside)
    displacement = exact.copy()
    displacement[inside] += 1e-3 * np.random.default_rng(2).uniform(-1.0, 1.0, displacement[inside].shape)
    for _ in range(8):
        residual = elements.internal_force(displacement).ravel()[free]
        correction = spsolve(elements.tangent(displacement)[free][:, free], residual)
        displacement[inside] -= correction.reshape(-1, 2)
    stress = elements.nodal_stress(displacement)
    expected = cauchy_stress(gradient, plane_stress_lame(E, NU))
    assert np.abs(stress - expected).max() < 1e-12 * np.abs(expected).max()


@ORDERS
@pytest.mark.parametrize("angle", [0.3, -0.3, np.pi / 2])
def test_rigid_rotation_stores_no_strain_energy(order, angle):
    elements = assemble(quad_mesh(4, 6, distortion=0.3), youngs_modulus=E, poisson_ratio=NU, order=order)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    rotated = elements.nodes @ turn.T - elements.nodes
    fake = 0.5 * rotated.ravel() @ elements.stiffness @ rotated.ravel()  # what linear strain makes of it
    assert fake > 1e6
    assert 0.0 <= elements.strain_energy(rotated) <= 1e-10 * fake
    assert (
        np.abs(elements.internal_force(rotated)).max()
        <= 1e-12 * np.abs(elements.stiffness @ rotated.ravel()).max()
    )


@ORDERS
def test_column_shortens_under_its_weight(order):
    # rho g c^2/(2E) with nu = 0, at the nodes exactly for elements that hold one-dimensional bars.
    density, gravity, height, modulus = 100.0 / 0.3, 9.81, 4.0, 1e9
    elements = assemble(quad_mesh(2, 8), youngs_modulus=modulus, poisson_ratio=0.0, order=order)
    held = np.zeros((len(elements.nodes), 2), dtype=bool)
    held[elements.base_nodes, 1] = True
    held[elements.base_nodes[0], 0] = True
    free = np.flatnonzero(~held.ravel())
    weight = np.zeros_like(elements.nodes)
    weight[:, 1] = -gravity * elements.mass.sum(axis=1)
    displacement = np.zeros(elements.unknowns)
    displacement[free] = spsolve(elements.stiffness[free][:, free], weight.ravel()[free])
    z, shortening = elements.nodes[:, 1], displacement.reshape(-1, 2)[:, 1]
    exact = -density * gravity / modulus * (height * z - 0.5 * z * z)
    assert exact.min() == pytest.approx(-density * gravity * height**2 / (2.0 * modulus))
    assert np.abs(shortening - exact).max() < 1e-11 * np.abs(exact).max()
