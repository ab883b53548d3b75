"""Annual rates: closed forms, public examples, and what happens between the points."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

import fem
from fem.seismic.hazard import HazardCurve, counted_rate, probability_in

#: Sa(1 s) [g] and annual rate of exceedance, J. W. Baker, B. A. Bradley, P. J. Stafford, Seismic Hazard and Risk
#: Analysis, Cambridge 2021, listing illustrate_fragility.m of its chapter 9 (MIT licence)
BOOK_STRENGTHS = np.append(np.geomspace(0.001, 2.0, 100), 2.1)
BOOK_RATES = np.array(
    [
        0.0251695, 0.0243006, 0.02343655, 0.02257925, 0.02173052, 0.02089208, 0.02006557, 0.01925248,
        0.0184542, 0.01767197, 0.0169069, 0.01615998, 0.01543203, 0.01472377, 0.01403575, 0.01336844,
        0.01272213, 0.01209706, 0.01149332, 0.01091091, 0.01034975, 0.009809682, 0.009290474, 0.008791831,
        0.008313407, 0.007854812, 0.007415617, 0.006995366, 0.006593577, 0.00620975, 0.005843375, 0.00549393,
        0.005160892, 0.004843736, 0.004541939, 0.004254981, 0.00398235, 0.003723539, 0.003478052, 0.003245401,
        0.003025107, 0.002816703, 0.002619731, 0.002433744, 0.002258307, 0.002092991, 0.001937381, 0.00179107,
        0.001653661, 0.001524766, 0.001404008, 0.001291016, 0.00118543, 0.0010869, 0.0009950808, 0.0009096399,
        0.0008302514, 0.0007565988, 0.0006883742, 0.0006252785, 0.0005670218, 0.0005133231, 0.0004639106, 0.0004185216,
        0.0003769032, 0.0003388115, 0.0003040125, 0.0002722816, 0.0002434039, 0.0002171744, 0.0001933974, 0.0001718872,
        0.0001524675, 0.0001349716, 0.0001192419, 0.0001051304, 9.249785e-05, 8.121391e-05, 7.115683e-05, 6.221319e-05,
        5.42776e-05, 4.725241e-05, 4.104743e-05, 3.557953e-05, 3.077235e-05, 2.655595e-05, 2.286643e-05, 1.96456e-05,
        1.684063e-05, 1.440366e-05, 1.229151e-05, 1.04653e-05, 8.890149e-06, 7.534844e-06, 6.371542e-06, 5.375483e-06,
        4.52471e-06, 3.799815e-06, 3.183688e-06, 2.661298e-06, 1e-09,
    ]
)  # fmt: skip
#: peak acceleration [g] and rate, MASTODON, examples/ex08 (LGPL): a plant as assessed in 2006 and in 2015
PLANT_2006 = np.array(
    [
        (0.04, 4.85e-2), (0.11, 1.23e-2), (0.21, 3.21e-3), (0.42, 5.94e-4), (0.64, 1.86e-4), (0.87, 7.56e-5),
        (1.09, 3.58e-5), (1.52, 1.08e-5), (2.17, 2.72e-6), (3.26, 4.78e-7), (4.34, 1.21e-7), (6.51, 1.52e-8),
    ]
)  # fmt: skip
PLANT_2015 = np.array(
    [
        (0.01, 6.59e-2), (0.02, 3.59e-2), (0.05, 1.04e-2), (0.10, 3.29e-3), (0.20, 8.03e-4), (0.30, 3.06e-4),
        (0.50, 8.13e-5), (0.70, 3.21e-5), (1.00, 1.17e-5), (2.00, 1.52e-6), (3.00, 4.32e-7), (5.00, 8.44e-8),
        (10.0, 8.73e-9),
    ]
)  # fmt: skip


def integrated(curve, median, beta, count):
    """The rate by `count` trapezoids over ln a, far beyond the points on both sides."""
    x = np.linspace(math.log(median) - 12.0 * beta - 3.0, math.log(median) + 12.0 * beta + 3.0, count)
    rates = np.array([curve.rate(float(one)) for one in np.exp(x)])
    density = np.exp(-0.5 * ((x - math.log(median)) / beta) ** 2) / (beta * math.sqrt(2.0 * math.pi))
    return float(np.trapezoid(rates * density, x))


@pytest.mark.parametrize(
    ("ratio", "rate", "percent"), [(1.5, 1.2815e-3, 6.207), (2.0, 5.4064e-4, 2.667), (3.0, 1.6019e-4, 0.798)]
)
def test_a_power_law_has_the_closed_form(ratio, rate, percent):
    """EN 1998-1:2004, 2.1 (4), k = 3: H(median) exp(k^2 beta^2/2), worked by hand."""
    curve = [1.6, 1.6 * 10.0], [1.0 / 475.0, 1.0 / 475.0 / 1000.0]
    found = fem.annual_rate(*curve, median_m_s2=1.6 * ratio, beta=0.4)
    assert found == pytest.approx(rate, rel=5e-5)
    assert 100.0 * probability_in(50.0, found) == pytest.approx(percent, abs=5e-4)


@pytest.mark.parametrize(("ratio", "exponent"), [(1.8, 2.808), (2.0, 2.381)])
def test_two_points_of_a_map_give_the_exponent(ratio, exponent):
    curve = HazardCurve.from_return_periods([(2475.0, ratio), (475.0, 1.0)])
    assert curve.exponents == pytest.approx([exponent], abs=5e-4)
    assert curve.rate(1.0) == pytest.approx(1.0 / 475.0)
    assert curve.rate(ratio**2) == pytest.approx(475.0 / 2475.0**2)


def test_points_on_one_power_law_change_nothing():
    strengths = np.geomspace(0.5, 8.0, 9)
    many = fem.annual_rate(strengths, 1e-3 * strengths**-2.6, median_m_s2=2.2, beta=0.5)
    two = fem.annual_rate(strengths[[2, 7]], 1e-3 * strengths[[2, 7]] ** -2.6, median_m_s2=2.2, beta=0.5)
    assert many == pytest.approx(two, rel=1e-12)


def test_a_step_is_the_hazard_itself():
    assert fem.annual_rate([1.0, 2.0], [1e-2, 1e-3], median_m_s2=1.5, beta=0.0) == pytest.approx(
        fem.annual_rate([1.0, 2.0], [1e-2, 1e-3], median_m_s2=1.5, beta=1e-6), rel=1e-6
    )


@pytest.mark.parametrize(
    ("points", "median", "beta", "expected"),
    [(PLANT_2006, 1.31, 0.4494, 5.021e-5), (PLANT_2015, 2.11, 0.5022, 3.749e-6)],
)
def test_two_assessments_of_a_plant_are_converged(points, median, beta, expected):
    """The example itself prints 5.266e-5 and 5.195e-6, from ten intervals: 5 and 39 % above what they converge to."""
    found = fem.annual_rate(*points.T, median_m_s2=median, beta=beta)
    assert found == pytest.approx(expected, rel=1e-3)
    curve = HazardCurve(strengths=points[:, 0], rates=points[:, 1])
    errors = [abs(integrated(curve, median, beta, count) / found - 1.0) for count in (400, 6400)]
    assert errors[1] < 1e-5 < errors[0]


@pytest.mark.parametrize(
    ("median", "left_sum", "converged"), [(0.5, 5.56856e-5, 5.9455e-5), (0.6, 4.03644e-5, 4.3199e-5)]
)
def test_the_curves_of_a_book_and_what_they_converge_to(median, left_sum, converged):
    """The book adds the probability at the left of each interval, with 101 points, and ends at 2.1 g.

    The sum is its own, so it is repeated here; the integral is 7 % larger, since the probability rises within an
    interval. The drop to 1e-9 at 2.1 g, which closes the sum, is no point of the curve.
    """
    probability = ndtr(np.log(BOOK_STRENGTHS / median) / 0.4)
    assert float(np.sum(probability * -np.diff([*BOOK_RATES, 0.0]))) == pytest.approx(left_sum, rel=1e-5)
    found = fem.annual_rate(BOOK_STRENGTHS[:-1], BOOK_RATES[:-1], median_m_s2=median, beta=0.4)
    assert found == pytest.approx(converged, rel=1e-4)
    curve = HazardCurve(strengths=BOOK_STRENGTHS[:-1], rates=BOOK_RATES[:-1])
    assert integrated(curve, median, 0.4, 4000) == pytest.approx(found, rel=1e-5)


def test_an_example_by_hand():
    """Rates .06, .016, .003, and from each on probabilities .1, .4, .6 (the same book): .0044 + .0052 + .0018."""
    curve = HazardCurve(strengths=[0.1, 0.2, 0.3], rates=[0.06, 0.016, 0.003])
    parts = [curve.straight(0.1, 0.2, 0.1, 0.1), curve.straight(0.2, 0.3, 0.4, 0.4)]
    parts.append(curve.straight(0.3, math.inf, 0.6, 0.6))
    assert parts == pytest.approx([0.0044, 0.0052, 0.0018])
    assert sum(parts) == pytest.approx(0.0114)
    assert probability_in(1.0, sum(parts)) == pytest.approx(0.011335, abs=5e-7)


def test_a_straight_probability_is_integrated_exactly():
    curve = HazardCurve(strengths=[0.8, 1.5, 4.0], rates=[1e-2, 2e-3, 5e-5])
    a = np.geomspace(1.0, 6.0, 20_001)
    rates = np.array([curve.rate(float(one)) for one in a])
    middle = 0.1 + 0.7 * np.log(np.sqrt(a[1:] * a[:-1])) / math.log(6.0)
    assert curve.straight(1.0, 6.0, 0.1, 0.8) == pytest.approx(
        float(np.sum(middle * -np.diff(rates))), rel=1e-8
    )


def test_counts_of_a_lognormal_fragility_give_its_rate():
    curve = HazardCurve(strengths=[1.6, 3.0], rates=[1.0 / 475.0, 1.0 / 2475.0])
    strengths = np.geomspace(0.6, 12.0, 80)
    motions = [10_000] * strengths.size
    events = np.rint(10_000 * ndtr(np.log(strengths / 3.2) / 0.4)).astype(int)
    found = counted_rate(curve, strengths.tolist(), events.tolist(), motions, never_below=0.5)
    assert found.rate == pytest.approx(curve.lognormal(3.2, 0.4), rel=3e-3)
    assert found.low < found.rate < found.high < 1.5 * found.rate
    assert found.most_from[0] < 2.755 < found.most_from[1]  # there phi/Phi = k beta
    assert 0.0 < found.share < 0.2


def test_the_tails_are_bounds():
    """One strength: nothing beyond it is counted, so all and its lower end bound it; below `never_below` is nothing."""
    curve = HazardCurve(strengths=[1.0, 2.0], rates=[1e-2, 1e-3])
    found = counted_rate(curve, [2.0], [5], [10], never_below=1.0)
    assert found.low == pytest.approx(1e-3 * 0.18709, rel=1e-4)  # Clopper and Pearson for 5 of 10
    assert found.high == pytest.approx(1e-3 + (1e-2 - 1e-3) * 0.81291, rel=1e-4)
    assert found.rate == pytest.approx(1e-3 * 0.5 + curve.straight(1.0, 2.0, 0.0, 0.5))


def test_where_nothing_fell_the_rate_is_none_and_its_upper_end_is_not():
    curve = HazardCurve(strengths=[1.0, 2.0], rates=[1e-2, 1e-3])
    found = counted_rate(curve, [1.0, 2.0], [0, 0], [100, 100], never_below=0.9)
    assert (found.rate, found.low, found.share) == (0.0, 0.0, 0.0)
    assert found.high > curve.rate(2.0)


@pytest.mark.parametrize(
    ("strengths", "rates", "words"),
    [
        ([1.0], [1e-3], "two points"),
        ([1.0, 2.0], [1e-3], "one length"),
        ([2.0, 1.0], [1e-2, 1e-3], "rise"),
        ([1.0, 2.0], [1e-3, 1e-3], "fall"),
        ([0.0, 2.0], [1e-2, 1e-3], "positive"),
        ([1.0, math.nan], [1e-2, 1e-3], "finite"),
    ],
)
def test_what_is_no_hazard_curve_is_refused(strengths, rates, words):
    with pytest.raises(ValueError, match=words):
        fem.annual_rate(strengths, rates, median_m_s2=1.0, beta=0.4)


@pytest.mark.parametrize(("median", "beta"), [(0.0, 0.4), (math.inf, 0.4), (1.0, -0.1), (1.0, math.nan)])
def test_what_is_no_fragility_is_refused(median, beta):
    with pytest.raises(ValueError, match=r"median|beta"):
        fem.annual_rate([1.0, 2.0], [1e-2, 1e-3], median_m_s2=median, beta=beta)
