"""Elastic modes of a free body: orthogonality, completeness, determinism, and the file that shows them."""

from dataclasses import replace

import numpy as np
import pytest
from meshes import grid_mesh

from fem.solid.assembly import assemble
from fem.solid.modes import elastic_modes, rigid_modes


def block(columns, rows, order, *, width=1.1, height=4.0, densities=(7850.0,)):
    """Steel block of unit thickness; `densities` repeat from cell to cell."""
    x, z = np.linspace(-width / 2, width / 2, columns + 1), np.linspace(0.0, height, rows + 1)
    mesh = grid_mesh(x, z, depth=1.0, areal_density=1.0)
    mesh = replace(mesh, areal_density=np.resize(np.asarray(densities, dtype=float), len(mesh.quads)))
    return assemble(mesh, youngs_modulus=2.1e11, poisson_ratio=0.3, order=order)


SMALL = pytest.param((3, 5, 1), id="dense")
LARGE = pytest.param((6, 12, 2), id="lanczos")
SIZES = pytest.mark.parametrize("size", [SMALL, LARGE])


@SIZES
def test_modes_are_orthonormal_in_the_mass_and_diagonal_in_the_stiffness(size):
    elements = block(*size, densities=(7850.0, 2000.0, 500.0))
    modes = elastic_modes(elements, 12)
    vectors = modes.shapes.reshape(12, -1).T
    assert vectors.T @ elements.vector_mass @ vectors == pytest.approx(np.eye(12), abs=1e-12)
    squares = modes.angular_frequencies**2
    modal_stiffness = vectors.T @ elements.stiffness @ vectors
    assert np.abs(modal_stiffness - np.diag(squares)).max() < 1e-9 * squares[-1]
    assert np.all(np.diff(modes.frequencies_Hz) >= 0.0)
    residual = elements.stiffness @ vectors - elements.vector_mass @ vectors * squares
    assert np.linalg.norm(residual, axis=0).max() < 1e-9 * np.linalg.norm(elements.stiffness @ vectors[:, -1])


@SIZES
def test_modes_carry_no_momentum_and_no_angular_momentum(size):
    # Tisserand: the floating frame has all of both.
    elements = block(*size, densities=(7850.0, 2000.0, 500.0))
    modes = elastic_modes(elements, 12)
    velocities = modes.shapes / np.sqrt(np.einsum("kni,kni->k", modes.shapes, modes.shapes))[:, None, None]
    momenta = np.array([elements.mass @ velocity for velocity in velocities])
    arms = elements.nodes - elements.mass.sum(axis=0) @ elements.nodes / elements.mass.sum()
    assert np.abs(momenta.sum(axis=1)).max() < 1e-13 * np.abs(momenta).sum(axis=1).max()
    turning = arms[:, 1] * momenta[:, :, 0] - arms[:, 0] * momenta[:, :, 1]
    assert np.abs(turning.sum(axis=1)).max() < 1e-13 * np.abs(turning).sum(axis=1).max()


def test_positive_rigid_rotation_tilts_toward_plus_x():
    elements = block(3, 5, 1)
    rotation = rigid_modes(elements)[2]
    assert rotation[np.argmax(elements.nodes[:, 1]), 0] > 0.0


@SIZES
def test_modes_are_the_same_to_the_last_bit_every_time(size):
    first, second = (elastic_modes(block(*size), 8) for _ in range(2))
    assert np.array_equal(first.shapes, second.shapes)
    assert np.array_equal(first.frequencies_Hz, second.frequencies_Hz)


def test_all_elastic_modes_together_hold_the_whole_stiffness():
    # With every mode, sum of omega^2 is the trace of M^-1 K: none is missing and none is rigid.
    elements = block(2, 3, 1)
    modes = elastic_modes(elements, elements.unknowns - 3)
    trace = np.trace(np.linalg.solve(elements.vector_mass.toarray(), elements.stiffness.toarray()))
    assert np.sum(modes.angular_frequencies**2) == pytest.approx(trace, rel=1e-6)


def test_slender_bar_bends_at_timoshenkos_frequency():
    # Free-free Euler-Bernoulli bar: 4.730041^2/(2 pi L^2) sqrt(E I/(rho A)). Rotary inertia and shear lower
    # it by (A + B E/(k G)) (h/L)^2/24 to first order, A = 49.4808 and B = 12.3026 the quotients of
    # squared slope over square of the free-free and of the clamped-clamped shape, k = 5 (1 + nu)/(6 + 5 nu)
    # (Timoshenko, Philosophical Magazine 43 (1922) 125).
    height, width = 4.0, 0.08
    euler = 4.730041**2 / (2 * np.pi * height**2) * np.sqrt(2.1e11 * width**2 / 12.0 / 7850.0)
    shear = 2.0 * 1.3 * (6.0 + 5.0 * 0.3) / (5.0 * 1.3)
    lowering = (49.4808 + 12.3026 * shear) / 24.0 * (width / height) ** 2
    assert lowering == pytest.approx(1.44e-3, rel=1e-2)
    modes = elastic_modes(block(2, 60, 2, width=width, height=height), 1)
    assert modes.frequencies_Hz[0] == pytest.approx(euler * (1.0 - lowering), rel=5e-5)
