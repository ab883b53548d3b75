"""What counts in the answer of a study; its sentences are in `tests/said/sentences.txt`."""

import pytest
from study_words import KINDS, MU, PEAK, WIDTH, G, ensemble_of, over

from fem.study.answers import Answer, Trial, answer_axis, answer_of, is_rising
from fem.study.axes import Axis


def line(values, kinds, *, number=0, slip=None):
    """Trials of one line, a letter each."""
    return [Trial(value, number, KINDS[kind], slip, None) for value, kind in zip(values, kinds, strict=True)]


@pytest.mark.parametrize(("kinds", "rising"), [("oos", False), ("sso", True), ("ooo", True), ("sos", True)])
def test_the_safe_side_of_another_key_is_what_its_ends_show(kinds, rising):
    assert is_rising(MU, line(MU.values, kinds)) is rising


def test_several_lines_stand_where_all_of_them_do():
    """The second line was refined between 2 and 3; what it showed there is not claimed of the first."""
    first = line([1.0, 2.0, 3.0, 4.0, 5.0], "sssss", number=0)
    second = line([1.0, 2.0, 2.5, 2.75, 3.0, 4.0, 5.0], "ssosoos", number=5, slip=0.01)
    assert answer_of([*first, *second], rising=True) == Answer(
        stood_to=2.0, overturned_from=2.5, stood_slip=0.01, slip=0.01, line=5, stood_again=((5.0, 5.0),)
    )


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
    ("shares", "peak"),
    [((0.0, 0.8, 0.3), 0.2 + 0.2 * 0.5 / 0.8), ((0.0, None, 1.0), 0.4)],
    ids=["an island does not move the first crossing", "a point without outcome is left out"],
)
def test_half_of_the_draws_overturn_where_straight_lines_between_the_shares_cross(shares, peak):
    assert ensemble_of(*over(PEAK, *shares)).rows[0].found.value == pytest.approx(peak * G)


def test_a_boundary_has_a_row_for_each_value_of_the_other_axis_and_an_unfinished_ensemble_no_answer():
    points = (*over(PEAK, 0.0, 0.25, 0.75, mu=0.3), *over(PEAK, 0.0, 0.5, 1.0, mu=0.6))
    assert [row.found.value for row in ensemble_of(*points).rows] == pytest.approx([0.5 * G, 0.4 * G])
    assert ensemble_of(*points, status="interrupted") is None
