"""What a set of motions did: worse sign, counts, means without falls, intervals, words."""

import pytest

from fem.results.outcome import Ending
from fem.runtime.intervals import binomial_interval
from fem.study.axes import read_axis, sign_axes
from fem.study.motion_outcomes import MotionOutcome, by_motion, motions_at, set_in_words, set_row
from fem.study.sweep_table import RunShown


def did(motion, ratio, slip=0.01, kind=Ending.STANDING):
    words = {Ending.STANDING: "rock", Ending.OVERTURNED: "overturned", Ending.FAILED: None}
    return MotionOutcome(motion=motion, kind=kind, outcome=words[kind], rotation_ratio=ratio, max_slip_m=slip)


def test_worst_and_mean_of_a_set_that_stands():
    row = set_row([did("a", 0.2, 0.02), did("b", 0.6, 0.01), did("c", 0.1, 0.06)])
    assert (row["worst_motion"], row["worst_rotation_ratio"]) == ("b", 0.6)
    assert (row["worst_slip_motion"], row["worst_slip_m"]) == ("c", 0.06)
    assert (row["mean_rotation_ratio"], row["mean_slip_m"]) == (pytest.approx(0.3), pytest.approx(0.03))
    assert (row["overturned_share"], row["low"]) == (0.0, 0.0)
    assert row["high"] == binomial_interval(0, 3, 0.95)[1]
    assert set_in_words(row) == (
        "none of 3 motions overturns (0 to 71 % of such motions at 95 % confidence); worst b, rock, rotation ratio "
        "0.600; largest slip 60.0 mm, c; mean of 3: rotation ratio 0.300, slip 30.0 mm"
    )


def test_a_slip_of_metres_is_told_without_powers_of_ten():
    assert "largest slip 1130 mm, a" in set_in_words(set_row([did("a", 0.2, 1.1304)]))


def test_no_mean_includes_a_fall():
    row = set_row([did("a", 0.2, 0.02), did("b", 5.8, 0.3, Ending.OVERTURNED), did("c", 0.4, 0.04)])
    assert (row["stood"], row["overturned"], row["worst_motion"]) == (2, 1, "b")
    assert row["mean_rotation_ratio"] == pytest.approx(0.3)
    assert row["low"] == binomial_interval(1, 3, 0.95)[0]
    assert "1 of 3 motions overturns" in set_in_words(row)
    assert "mean of 2 that stood, 1 overturned: rotation ratio 0.300, slip 30.0 mm" in set_in_words(row)


def test_a_failed_motion_is_neither_standing_nor_fallen():
    row = set_row([did("a", 0.2), did("b", None, None, Ending.FAILED)])
    assert (row["stood"], row["failed"], row["overturned_share"]) == (1, 1, 0.0)
    assert row["high"] == binomial_interval(1, 2, 0.95)[1]  # it may have overturned
    assert "1 failed" in set_in_words(row)
    nothing = set_row([did("b", None, None, Ending.FAILED)])
    assert (nothing["worst_motion"], nothing["mean_rotation_ratio"], nothing["overturned_share"]) == (
        None,
    ) * 3


def test_a_motion_counts_once_with_the_worse_of_its_signs():
    axes = [
        read_axis("contact.mu_static", [0.3, 0.4]),
        read_axis("vertical.scale", [1.0, -1.0]),
        read_axis("motion.file", ["a", "b"]),
    ]

    def shown(ratio, slip=0.0, kind=Ending.STANDING):
        return RunShown(kind=kind, outcome="rock", rotation_ratio=ratio, max_slip_m=slip)

    cells = [
        *(
            shown(0.1, 0.05),
            shown(0.2),
            shown(0.3, 0.02),
            shown(None, None, Ending.FAILED),
        ),  # 0.3: +a, +b, -a, -b
        *(shown(7.0, 0.01, Ending.OVERTURNED), shown(0.2), shown(0.4), shown(0.1)),
    ]
    first, second = motions_at(axes, dict(enumerate(cells)))
    assert first[0] == {"contact.mu_static": 0.3}
    a, b = first[1]
    assert (a.motion, a.rotation_ratio, a.max_slip_m) == ("a", 0.3, 0.05)
    assert b.kind == Ending.FAILED  # the sign that has no outcome may have overturned
    assert [one.kind for one in second[1]] == [Ending.OVERTURNED, Ending.STANDING]
    counts = by_motion([first[1], second[1]])
    assert counts["a"] == {
        "stood": 1,
        "overturned": 1,
        "invalid": 0,
        "failed": 0,
        "max_rotation_ratio": 0.3,
        "max_slip_m": 0.05,
    }
    assert counts["b"]["failed"] == 1


def test_values_of_other_magnitudes_are_no_signs():
    factors, signs = read_axis("motion.scale", [1.0, -2.0]), read_axis("vertical.scale", [-1.0, 1.0])
    assert sign_axes([factors, signs]) == [signs]
