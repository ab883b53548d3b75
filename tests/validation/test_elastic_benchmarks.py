"""Published elastic benchmarks: Cook's membrane, NAFEMS LE1 and FV32, the elastica, the free square.

Sources: `fem.verification.elastic_problems`, where they are computed; here and in the verification table.
"""

import numpy as np
import pytest

from fem.verification.elastic_problems import (
    cook_deflection,
    elastica_tip,
    free_square_frequencies,
    fv32_frequencies,
    le1_stress,
)


@pytest.mark.parametrize(("cells", "printed"), [(2, 11.80), (4, 18.29), (8, 22.08), (16, 23.43)])
def test_cooks_membrane_with_bilinear_quads(cells, printed):
    # Bilinear quads without locking remedies, integrated exactly; computed independently, to two decimals.
    assert cook_deflection(1, cells) == pytest.approx(printed, abs=0.005)


def test_cooks_membrane_converges_to_the_known_limit():
    # 23.965: converged value, computed independently; the error of the corners' singularity halves or better.
    deflections = np.array([cook_deflection(2, cells) for cells in (8, 16, 32)])
    assert deflections[-1] == pytest.approx(23.965, abs=0.005)
    errors = 23.965 - deflections
    assert errors[1] < 0.5 * errors[0]


def test_nafems_le1_elliptic_membrane():
    # Quarter of an elliptic plate with an elliptic hole, 10 MPa outward on the outer edge:
    # sigma_zz at D = (2, 0) is 92.7 MPa.
    assert le1_stress() == pytest.approx(92.7e6, abs=0.05e6)


def test_nafems_fv32_cantilevered_tapered_membrane():
    # First six in-plane frequencies, plane stress; printed to five digits at most.
    printed = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44]
    assert fv32_frequencies() == pytest.approx(printed, rel=1e-3)


def test_free_square_vibrates_at_the_known_frequencies():
    # omega L sqrt(rho/E) of the free-free unit square, nu = 0.3, plane stress; computed independently.
    assert free_square_frequencies() == pytest.approx([2.43265, 2.59096, 2.59096, 2.75536, 3.13163], abs=2e-5)


def test_cantilever_under_end_load_follows_the_elastica():
    exact = np.array([[0.301721, 0.056433], [0.493457, 0.160642], [0.713792, 0.387628]])
    # A bar of finite thickness also shears and stretches, by shares of the order of (h/L)^2; two thicknesses
    # extrapolate to the elastica, which has none.
    thick, thin = (elastica_tip([1.0, 2.0, 5.0], slenderness) for slenderness in (25, 50))
    assert (thick - exact) / (thin - exact) == pytest.approx(np.full((3, 2), 4.0), abs=0.1)
    assert (4.0 * thin - thick) / 3.0 == pytest.approx(exact, rel=1e-5)
