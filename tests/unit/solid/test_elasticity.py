"""Plane-stress laws as pure functions, against closed forms; their derivatives: `test_assembly.py`."""

import numpy as np
import pytest

from fem.solid import elasticity

E, NU = 2.1e11, 0.3
STEEL = elasticity.plane_stress_lame(E, NU)


def rotation(angle):
    """Rotation > 0 tilts toward +x, that is clockwise."""
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


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


def test_true_stress_turns_with_the_body():
    # Objectivity: sigma(Q F) = Q sigma(F) Q^T.
    gradient, Q = np.array([[0.02, 0.01], [0.03, -0.03]]), rotation(0.8)
    xx, zz, xz = elasticity.cauchy_stress(gradient, STEEL)
    expected = Q @ np.array([[xx, xz], [xz, zz]]) @ Q.T
    turned = elasticity.cauchy_stress(Q @ (np.eye(2) + gradient) - np.eye(2), STEEL)
    assert turned == pytest.approx([expected[0, 0], expected[1, 1], expected[0, 1]], rel=1e-12)


def test_true_stress_carries_the_force_of_a_pulled_bar_on_its_narrowed_section():
    # Pulled to 1.1: E_xx = 0.105, S_xx = E E_xx, force per old section S_xx * 1.1. Across and through the
    # thickness alike the bar shrinks to sqrt(1 - 2 nu E_xx).
    across = np.sqrt(1 - 2 * NU * 0.105)
    stress = elasticity.cauchy_stress(np.diag([0.1, across - 1.0]), STEEL)
    assert stress[0] == pytest.approx(E * 0.105 * 1.1 / across**2, rel=1e-12)
    assert np.abs(stress[1:]).max() < 1e-12 * E
