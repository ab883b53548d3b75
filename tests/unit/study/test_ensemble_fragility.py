"""Counted probabilities: their intervals, how often these hold the truth, and the lognormal curve made of them."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import log_ndtr
from scipy.stats import binom, qmc

from fem.runtime.intervals import binomial_interval, estimate, least_draws, replicate_interval
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

    options = {"xatol": 1e-9, "fatol": 1e-10}
    best = minimize(loss, [np.log(4.0), np.log(0.5)], method="Nelder-Mead", options=options)
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


@pytest.mark.parametrize(
    ("count", "draws", "low", "high"),
    [(0, 10, 0.0, 0.30850), (10, 10, 0.69150, 1.0), (5, 10, 0.18709, 0.81291), (1, 20, 0.00127, 0.24873)],
)
def test_clopper_and_pearsons_intervals_are_those_of_the_tables(count, draws, low, high):
    # Two-sided 95 per cent limits, as in the tables of Documenta Geigy and from 1 - (0.025)^(1/n) at no event.
    assert binomial_interval(count, draws, 0.95) == pytest.approx((low, high), abs=1e-5)


@pytest.mark.parametrize("probability", [0.01, 0.05, 0.3, 0.5])
def test_they_hold_the_truth_at_least_as_often_as_they_say(probability):
    draws = 60
    counts = np.arange(draws + 1)
    held = [
        low <= probability <= high for low, high in (binomial_interval(int(k), draws, 0.95) for k in counts)
    ]
    assert binom.pmf(counts, draws, probability)[held].sum() >= 0.95


@pytest.mark.slow
@pytest.mark.parametrize("sampling", ["latin-hypercube", "sobol"])
@pytest.mark.parametrize("probability", [0.02, 0.1, 0.5])
def test_intervals_from_replicates_hold_the_truth_about_as_often_as_they_say(sampling, probability):
    # The simplex u + v < sqrt(2 p) has probability p; neither of the two random numbers decides alone.
    replicates, size, studies = 8, 16, 150
    generator = np.random.default_rng(7)
    held = 0
    for _ in range(studies):
        means = []
        for _ in range(replicates):
            make = qmc.Sobol if sampling == "sobol" else qmc.LatinHypercube
            points = make(2, seed=generator).random(size)
            means.append(float((points.sum(axis=1) < np.sqrt(2.0 * probability)).mean()))
        low, high = replicate_interval(np.array(means), replicates * size, 0.95)
        held += low <= probability <= high
    # Three standard errors of the coverage itself, 0.018, below 95 per cent.
    assert held / studies >= 0.896


def test_replicates_that_agree_do_not_make_a_probability_certain():
    low, high = replicate_interval(np.zeros(8), 128, 0.95)
    assert (low, high) == pytest.approx(binomial_interval(0, 128, 0.95))
    assert high > 0.02


def test_a_failed_draw_counts_against_both_ends():
    overturned = np.zeros(100, dtype=bool)
    failed = np.zeros(100, dtype=bool)
    overturned[:10], failed[10:15] = True, True
    found = estimate(overturned, failed, replicates=1, confidence=0.95)
    assert found.value == pytest.approx(10 / 95)
    assert found.low == pytest.approx(binomial_interval(10, 100, 0.95)[0])
    assert found.high == pytest.approx(binomial_interval(15, 100, 0.95)[1])
    all_failed = estimate(np.zeros(20, dtype=bool), np.ones(20, dtype=bool), replicates=1, confidence=0.95)
    assert all_failed.value is None and (all_failed.low, all_failed.high) == (0.0, 1.0)


def test_the_draws_that_are_needed_are_just_enough():
    needed = least_draws(0.05, 0.95)
    assert needed == 72
    assert binomial_interval(0, needed, 0.95)[1] <= 0.05 < binomial_interval(0, needed - 1, 0.95)[1]
