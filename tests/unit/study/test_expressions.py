"""Derived keys: arithmetic, and nothing that could be code."""

import math
import warnings

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fem.study.derived import ExpressionError, parse_expression

VALUES = {"contact.mu_static": 0.4, "gravity_m_s2": 9.81, "free.lambda": 3.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.5 * contact.mu_static", 0.2),
        ("1 + 2 * 3 - 4 / 2", 5.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2 ** -1", 0.5),
        ("10 - 4 - 3", 3.0),
        ("(1 + 2) * 3", 9.0),
        ("max(1e-3, min(gravity_m_s2, 2.))", 2.0),
        ("sqrt(2) * sin(pi / 4)", 1.0),
        ("\n2 *\tfree.lambda ^ 2", 18.0),  # a key may be one of Python's words
    ],
)
def test_values(text, value):
    assert parse_expression(text).value(VALUES) == pytest.approx(value, rel=1e-15)


@given(st.text(alphabet="0123456789.eE+-*/^() ,abcdefg_pisqrtmuxn", max_size=60))
def test_any_text_is_an_expression_or_refused(text):
    try:
        parsed = parse_expression(text)
    except ExpressionError:
        return
    values = dict.fromkeys(parsed.keys, 0.7)
    try:
        assert math.isfinite(parsed.value(values))
    except ExpressionError:
        return


@pytest.mark.parametrize("text", ["1if", "0x1in", "1jor", "1or 2", "(1)(2)", "'a'(1)"])
def test_a_doubt_of_python_is_told_in_words_and_not_printed(text):
    with warnings.catch_warnings(record=True) as caught, pytest.raises(ExpressionError):
        warnings.simplefilter("always")
        parse_expression(text)
    assert not caught
