"""The text of a number: its figures, its range, its unit."""

import pytest

from fem.html.units import number
from fem.runtime.units import PERCENT, DisplayUnit, in_figures, visible_number


@pytest.mark.parametrize(
    ("value", "reach", "words"),
    [
        (0.2217, (0.00134, 0.3965), "0.22 (0.0013 to 0.40) kN"),
        (1400.3, (102.2, 1524.9), "1400 (100 to 1500) kN"),
        (192.13, (190.0, 195.0), "192.1 (190 to 195) kN"),
        (192.13, (192.13, 192.13), "192.1 kN"),
        (192.13, None, "192.1 kN"),
        (-0.0996, (-0.0996, -0.05), "-0.10 (-0.10 to -0.050) kN"),
        (None, (1.0, 2.0), ""),
    ],
)
def test_a_number_has_the_figures_that_its_range_allows(value, reach, words):
    assert DisplayUnit(name="kN").text(value, reach) == words


@pytest.mark.parametrize(
    ("value", "figures", "words"),
    [(9.96, 2, "10"), (0.0996, 2, "0.10"), (123456.0, 2, "120000"), (0.0, 2, "0"), (2e-5, 4, "0.00002")],
)
def test_figures_are_rounded_without_an_exponent(value, figures, words):
    assert in_figures(value, figures) == words


def test_a_share_beyond_a_whole_is_seen_to_be():
    assert PERCENT.text(0.999, (0.994, 1.029)) == "100 (99 to 103) %"
    assert PERCENT.text(0.64, (0.0014, 1.043)) == "64 (0.14 to 104) %"


@pytest.mark.parametrize("moment", [53954.99999999999, 53955.0, 53955.00000000001])
def test_half_a_digit_is_rounded_alike_everywhere(moment):
    assert visible_number(moment, 1e-3) == in_figures(moment, 4, 1e-3) == number(moment, 1e-3) == "53.95"
