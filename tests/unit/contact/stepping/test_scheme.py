"""Coefficients of the Newmark family: consistency, order and stability conditions of its authors."""

import numpy as np
import pytest

from contact.stepping.scheme import generalised_alpha, newmark

RADII = [0.0, 0.2, 0.5, 0.8, 1.0]


@pytest.mark.parametrize("radius", RADII)
def test_generalised_alpha_fulfils_the_conditions_of_chung_and_hulbert(radius):
    # Second order: gamma = 1/2 - alpha_m + alpha_f (their Eq. 17); unconditionally stable:
    # alpha_m <= alpha_f <= 1/2 and beta >= 1/4 + (alpha_f - alpha_m)/2 (Eq. 18).
    scheme = generalised_alpha(radius)
    assert scheme.newmark_gamma == pytest.approx(0.5 - scheme.alpha_m + scheme.alpha_f, rel=1e-15)
    assert scheme.alpha_m <= scheme.alpha_f <= 0.5
    assert scheme.newmark_beta >= 0.25 + 0.5 * (scheme.alpha_f - scheme.alpha_m) - 1e-15


def test_the_default_radius_gives_the_printed_coefficients():
    # rho = 1/2: alpha_m = 0, alpha_f = 1/3, beta = 4/9, gamma = 5/6.
    assert generalised_alpha(0.5) == pytest.approx((4.0 / 9.0, 5.0 / 6.0, 0.0, 1.0 / 3.0))


@pytest.mark.parametrize(
    ("beta", "gamma"),
    [(0.0, 0.5), (1.0 / 6.0, 0.5), (0.25, 0.49), (0.25, 0.6), (np.nan, 0.5), (0.25, np.nan)],
)
def test_newmark_that_is_only_conditionally_stable_is_refused(beta, gamma):
    # Central differences and linear acceleration are members of the family, but not stable at every step.
    with pytest.raises(ValueError, match="2 beta >= gamma >= 1/2"):
        newmark(beta, gamma)
