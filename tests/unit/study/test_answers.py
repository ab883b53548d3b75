"""The answer of a study: from the safe side, over several lines, with islands, failures and unsure values named."""

import pytest

from fem.results.outcome import Ending
from fem.study.answers import Answer, Trial, answer_axis, answer_of, is_rising, sentence_of
from fem.study.axes import Axis, in_words

G = 9.80665
PEAK = Axis(key="motion.peak_acceleration_m_s2", values=(0.2 * G, 0.4 * G, 0.6 * G), unit="m/s2")
WIDTH = Axis(key="container.width_m", values=(0.8, 1.0, 1.1, 1.2), unit="m")
MU = Axis(key="contact.mu_static", values=(0.2, 0.3, 0.4))
KINDS = {"s": Ending.STANDING, "o": Ending.OVERTURNED, "f": Ending.FAILED}


def line(values, kinds, *, number=0, slip=None, unsure=""):
    """Trials of one line, a letter each; `unsure` has an x where one is."""
    marks = unsure or [None] * len(values)
    return [
        Trial(value, number, KINDS[kind], slip, None if mark is None else mark == "x")
        for value, kind, mark in zip(values, kinds, marks, strict=True)
    ]


def said(axis, trials, where=""):
    rising = is_rising(axis, trials)
    return sentence_of(answer_of(trials, rising=rising), axis, rising=rising, where=where)


def test_a_strength_is_told_from_below_in_g_with_the_slip():
    trials = line([G * one for one in (0.1, 0.42, 0.44)], "sso", slip=0.064)
    assert said(PEAK, trials) == (
        "stood in every motion tried up to 0.42 g (slid up to 64 mm); first overturned at 0.44 g (slip there 64 mm)"
    )


def test_a_width_is_told_from_above():
    trials = line(WIDTH.values, "ooss", slip=0.0)
    assert said(WIDTH, trials) == (
        "overturned up to 1 m (no slip there); stood in every case tried from 1.1 m on"
    )


@pytest.mark.parametrize(("kinds", "rising"), [("oos", False), ("sso", True), ("ooo", True), ("sos", True)])
def test_the_safe_side_of_another_key_is_what_its_ends_show(kinds, rising):
    assert is_rising(MU, line(MU.values, kinds)) is rising


def test_islands_failures_and_unsure_values_are_named():
    values = [G * one for one in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)]
    trials = line(values, "ssofsso", unsure="-xx--x-")
    assert said(PEAK, trials) == (
        "stood in every motion tried up to 0.2 g; first overturned at 0.3 g; stood again at 0.5 to 0.6 g; "
        "no outcome at 0.4 g; unsure at 0.2 to 0.3 g, 0.6 g"
    )


def test_a_failed_run_never_stands():
    found = answer_of(line([1.0, 2.0, 3.0], "sfs"), rising=True)
    assert found.stood_to == 1.0
    assert found.overturned_from is None
    assert found.failed == ((2.0, 2.0),)


@pytest.mark.parametrize(
    ("axis", "kinds", "sentence"),
    [
        (PEAK, "sss", "stood in every motion tried up to 0.6 g; none overturned"),
        (PEAK, "ooo", "overturned at the least tried, 0.2 g"),
        (PEAK, "fff", "no outcome at 0.2 to 0.6 g"),
        (WIDTH, "oooo", "overturned even at the largest tried, 1.2 m"),
        (WIDTH, "ssss", "stood in every case tried from 0.8 m on; none overturned"),
        (
            WIDTH,
            "osos",
            "overturned up to 1.1 m; stood in every case tried from 1.2 m on; stood below that at 1 m",
        ),
    ],
)
def test_every_pattern_has_a_sentence(axis, kinds, sentence):
    assert said(axis, line(axis.values, kinds)) == sentence


def test_with_a_limit_what_slides_beyond_it_does_not_stand():
    trials = [
        Trial(value=G * peak, line=0, kind=Ending.STANDING, slip=slip)
        for peak, slip in ((0.2, 0.02), (0.3, 0.09), (0.4, 0.16), (0.5, 2.9))
    ]
    free, limited = (answer_of(trials, rising=True, limit_slip=limit) for limit in (None, 0.1))
    assert sentence_of(free, PEAK, rising=True) == (
        "stood in every motion tried up to 0.5 g (slid up to 2.9 m); none overturned"
    )
    assert (limited.stood_to, limited.overturned_from, limited.slid) == (0.3 * G, 0.4 * G, True)
    assert sentence_of(limited, PEAK, rising=True) == (
        "stood in every motion tried up to 0.3 g (slid up to 90 mm); first slid beyond 100 mm at 0.4 g (slip there "
        "160 mm)"
    )
    mixed = answer_of(
        [*trials, Trial(value=0.4 * G, line=1, kind=Ending.OVERTURNED, slip=0.01)],
        rising=True,
        limit_slip=0.1,
    )
    assert not mixed.slid
    assert mixed.line == 1
    wide = answer_of(trials, rising=True, limit_slip=5.0)
    assert sentence_of(wide, PEAK, rising=True).endswith("none overturned or slid beyond 5 m")


def test_several_lines_stand_where_all_of_them_do():
    """The second line was refined between 2 and 3; what it showed there is not claimed of the first."""
    first = line([1.0, 2.0, 3.0, 4.0, 5.0], "sssss", number=0)
    second = line([1.0, 2.0, 2.5, 2.75, 3.0, 4.0, 5.0], "ssosoos", number=5, slip=0.01)
    found = answer_of([*first, *second], rising=True)
    assert found == Answer(
        stood_to=2.0, overturned_from=2.5, stood_slip=0.01, slip=0.01, line=5, stood_again=((5.0, 5.0),)
    )
    assert said(MU, [*first, *second], where="width 1 m") == (
        "stood in every case tried up to 2 (slid up to 10 mm); first overturned at 2.5 (slip there 10 mm, with "
        "width 1 m); stood again at 5"
    )


def test_many_islands_are_counted():
    values = [0.1 * k for k in range(1, 15)]
    found = said(MU, line(values, "sosososososososo"[:14]))
    assert found.endswith("stood again at 0.3, 0.5, 0.7, 0.9 and 2 more")


@pytest.mark.parametrize(
    ("axes", "key"),
    [
        ((MU, PEAK), PEAK.key),
        ((MU, WIDTH), None),
        ((MU, Axis(key="stop.gap_m", values=(0.0, 0.1))), "stop.gap_m"),
        ((MU,), MU.key),
        ((Axis(key="solver.model", values=("rigid", "reduced")),), None),
        ((Axis(key="motion.scale", values=(-1.0, 1.0)), MU), MU.key),
    ],
)
def test_the_axis_of_the_answer_is_the_strength_or_the_only_one(axes, key):
    found = answer_axis(axes)
    assert (found and found.key) == key


@pytest.mark.parametrize(
    ("axis", "values", "words"),
    [
        (PEAK, [G], "1 g"),
        (WIDTH, [1.0, 1.1], "1 to 1.1 m"),
        (Axis(key="motion.amplitude_m", values=(0.01, 0.05), unit="m"), [0.05], "50 mm"),
        (Axis(key="container.youngs_modulus_Pa", values=(2e9, 2.1e11), unit="Pa"), [2.1e11], "210 GPa"),
        (Axis(key="solver.model", values=("rigid",)), ["rigid"], "rigid"),
    ],
)
def test_values_are_said_in_the_units_of_people(axis, values, words):
    assert in_words(axis, values) == words
