"""Coefficients of the Newmark family: conditions of its authors; and how large a step may be."""

import numpy as np
import pytest
from block_on_floor import Block, rig

from contact.stepping.control import allowed_imbalance
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


def test_a_step_that_gains_energy_by_damping_is_allowed_no_more_than_one_that_loses_none():
    # in a step much longer than the last one, the extrapolated acceleration of a fast mode may be a thousand times the
    # true one: the mode gains 44 kJ that the step after takes away, and of which a share would excuse itself
    run = rig(Block()).run
    step = run.problem.control.largest_step
    lossless, gains, loses = (allowed_imbalance.py_func(run, step, lost) for lost in (0.0, -44e3, 44e3))
    assert np.isfinite(lossless)
    assert gains == lossless
    assert loses > lossless
