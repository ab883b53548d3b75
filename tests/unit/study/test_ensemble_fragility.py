"""The lognormal fragility curve: found again from counts made of one, and refused where there is none."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import log_ndtr

from fem.study.fragility import Lognormal, falls, fit_lognormal, misses

STRENGTHS = np.linspace(2.0, 10.0, 17)
TRUTH = Lognormal(median=5.0, deviation=0.3)
DRAWS = np.full(17, 200.0)


def test_exact_shares_give_the_curve_back():
    found = fit_lognormal(STRENGTHS, 200.0 * TRUTH.probability(STRENGTHS), DRAWS)
    assert (found.median, found.deviation) == (pytest.approx(5.0, rel=1e-6), pytest.approx(0.3, rel=1e-6))


def test_the_fit_has_the_largest_likelihood():
    counts = np.random.default_rng(3).binomial(200, TRUTH.probability(STRENGTHS)).astype(float)

    def loss(parameters):
        z = (np.log(STRENGTHS) - parameters[0]) / np.exp(parameters[1])
        return -np.sum(counts * log_ndtr(z) + (200.0 - counts) * log_ndtr(-z))

    best = minimize(
        loss, [np.log(4.0), np.log(0.5)], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-10}
    )
    found = fit_lognormal(STRENGTHS, counts, DRAWS)
    assert np.log(found.median) == pytest.approx(best.x[0], abs=1e-6)
    assert np.log(found.deviation) == pytest.approx(best.x[1], abs=1e-5)


@pytest.mark.parametrize(
    "shares",
    [np.zeros(17), np.ones(17), (STRENGTHS > 5.0).astype(float), 1.0 - TRUTH.probability(STRENGTHS)],
    ids=["none", "all", "step", "falling"],
)
def test_where_there_is_no_lognormal_curve_none_is_given(shares):
    assert fit_lognormal(STRENGTHS, 200.0 * shares, DRAWS) is None


def test_an_island_of_standing_is_reported_and_misses_the_curve():
    values = TRUTH.probability(STRENGTHS)
    values[12] = 0.4
    low, high = values - 0.05, values + 0.05
    (fall,) = falls(STRENGTHS, values, low, high)
    assert (fall["stronger"], fall["probability_stronger"]) == (STRENGTHS[12], 0.4)
    assert fall["weaker"] < fall["stronger"] and fall["probability_weaker"] > 0.9
    assert misses(TRUTH, STRENGTHS, low, high) == 1
    assert falls(STRENGTHS, TRUTH.probability(STRENGTHS), low * 0.0, high * 0.0 + 1.0) == []
