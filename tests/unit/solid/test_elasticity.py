"""Plane-stress laws as pure functions: against closed forms, and tangents against central differences."""

import numpy as np
import pytest

from fem.solid import elasticity

E, NU = 2.1e11, 0.3
STEEL = elasticity.plane_stress_lame(E, NU)


def rotation(angle):
    """Rotation > 0 tilts toward +x, that is clockwise."""
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def rotated_gradients(size, count=20, seed=1):
    """Random strains of the given size, each under its own large rotation, shape (2, 2, count)."""
    draw = np.random.default_rng(seed)
    stretch = np.eye(2) + size * draw.uniform(-1.0, 1.0, (count, 2, 2))
    turned = np.stack([rotation(angle) for angle in draw.uniform(-3.0, 3.0, count)]) @ stretch
    return np.moveaxis(turned - np.eye(2), 0, -1)


def energy(gradient):
    """Strain energy per reference volume of gradients (2, 2, ...) [J/m3]."""
    return elasticity.stress_and_energy(*gradient.reshape(4, -1), *STEEL)[4]


def first_stress(gradient):
    """First Piola-Kirchhoff stress P, shape (2, 2, ...), force axis first [Pa]."""
    return np.stack(elasticity.stress_and_energy(*gradient.reshape(4, -1), *STEEL)[:4]).reshape(
        gradient.shape
    )


def test_plane_stress_pair_gives_hookes_law_of_a_thin_sheet():
    # Pulled along x and free across: stress E eps along, none across.
    strain = np.array([1e-4, -NU * 1e-4, 0.0])
    assert elasticity.second_stress(strain, STEEL) == pytest.approx([E * 1e-4, 0.0, 0.0], rel=1e-14, abs=1e-7)
    # Sheared: stress G gamma, the tensor's component being gamma/2.
    shear = elasticity.second_stress(np.array([0.0, 0.0, 0.5e-4]), STEEL)
    assert shear == pytest.approx([0.0, 0.0, E / (2 * (1 + NU)) * 1e-4], rel=1e-14)


@pytest.mark.parametrize(
    ("modulus", "ratio", "message"),
    [(value, NU, "Young's modulus") for value in (0.0, -1.0, np.nan, np.inf)]
    + [(E, value, "Poisson's ratio") for value in (-1.0, 0.51, np.nan)],
)
def test_impossible_elastic_constants_are_refused(modulus, ratio, message):
    with pytest.raises(ValueError, match=message):
        elasticity.plane_stress_lame(modulus, ratio)


def test_strain_of_a_stretch_under_rotation_is_that_of_the_stretch():
    # (s^2 - 1)/2 along the stretched axis of the body, whatever the rotation.
    gradient = rotation(1.2) @ np.diag([1.1, 0.95]) - np.eye(2)
    assert elasticity.green_strain(gradient) == pytest.approx([0.105, -0.04875, 0.0], abs=1e-15)


@pytest.mark.parametrize("size", [1e-4, 1e-3, 1e-2, 1e-1])
def test_first_stress_is_the_derivative_of_the_energy(size):
    gradient, step = rotated_gradients(size), 1e-3 * size
    stress = first_stress(gradient)
    scale = np.abs(stress).max()
    for i, j in np.ndindex(2, 2):
        change = np.zeros((2, 2, 1))
        change[i, j] = step
        ahead, behind = (energy(gradient + s * change) for s in (1, -1))
        # The energy is of fourth degree: the difference errs by step^2 E and by rounding of the energy.
        assert np.abs((ahead - behind) / (2 * step) - stress[i, j]).max() < 3e-6 * scale


@pytest.mark.parametrize("size", [1e-6, 1e-4, 1e-3, 1e-2, 1e-1])
def test_first_stress_tangent_is_the_derivative_of_the_first_stress(size):
    gradient, step = rotated_gradients(size), 1e-5
    tangent = elasticity.first_stress_tangent(gradient, STEEL)
    for k, l in np.ndindex(2, 2):  # noqa: E741 - the indices of the tensor
        change = np.zeros((2, 2, 1))
        change[k, l] = step
        ahead, behind = (first_stress(gradient + s * change) for s in (1, -1))
        # Cubic in the gradient: the difference errs by step^2 E and by eps/step E.
        assert np.abs((ahead - behind) / (2 * step) - tangent[:, :, k, l]).max() < 1e-9 * E


def test_stress_turns_with_the_body():
    # Objectivity: P(Q F) = Q P(F) and sigma(Q F) = Q sigma(F) Q^T.
    gradient = np.array([[0.02, 0.01], [0.03, -0.03]])
    Q = rotation(0.8)
    turned = Q @ (np.eye(2) + gradient) - np.eye(2)
    assert first_stress(turned) == pytest.approx(Q @ first_stress(gradient), rel=1e-12)
    xx, zz, xz = elasticity.cauchy_stress(gradient, STEEL)
    expected = Q @ np.array([[xx, xz], [xz, zz]]) @ Q.T
    assert elasticity.cauchy_stress(turned, STEEL) == pytest.approx(
        [expected[0, 0], expected[1, 1], expected[0, 1]], rel=1e-12
    )


def test_true_stress_carries_the_force_of_a_pulled_bar_on_its_narrowed_section():
    # Pulled to 1.1: E_xx = 0.105, S_xx = E E_xx, force per old section S_xx * 1.1. Across and through the
    # thickness alike the bar shrinks to sqrt(1 - 2 nu E_xx).
    across = np.sqrt(1 - 2 * NU * 0.105)
    stress = elasticity.cauchy_stress(np.diag([0.1, across - 1.0]), STEEL)
    assert stress[0] == pytest.approx(E * 0.105 * 1.1 / across**2, rel=1e-12)
    assert np.abs(stress[1:]).max() < 1e-12 * E
