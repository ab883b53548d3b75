"""The three answers: what each condition of "fulfilled" asks for; the sentences are in `said/answers.txt`."""

from dataclasses import replace

import pytest
from site_answers import answer, confirmed, first, further, in_two_directions, repeated, runs
from site_example import RUN

from fem.site.request import load_site
from fem.site.result import FURTHER, REFINED, SCAN
from fem.site.rule import margin_factor
from fem.site.runs import key_of


def test_fulfilled_needs_the_set_its_repetitions_the_further_motions_and_the_deciding_runs():
    found = answer(runs(), repeated(), further(), confirmed=confirmed(), wind=0.6)
    assert (found.answer, found.fulfilled, found.reasons) == ("fulfilled", True, ())
    actions = [(one.name, one.answer) for one in found.actions]
    assert actions == [("earthquake", "fulfilled"), ("wind", "fulfilled")]
    assert found.actions[0].utilisation == pytest.approx(0.2)  # rotation 0.1 of 0.5
    assert (found.rule_range.repetitions, found.rotation_ratio_largest) == (5, 0.1)
    assert found.rule_range.rotation_ratio == pytest.approx((0.1, 0.1))


def test_the_limit_of_a_single_rotation_governs_where_most_of_it_is_used():
    """0.5 of 0.8 by one motion of the empty container; of the full one slip 0.06 of 0.1 m."""
    empty = [replace(run, mass="empty") for run in first(rotation_ratio=0.5)]
    found = answer(runs(max_slip_m=0.06) + empty, repeated(), further())
    assert found.actions[0].utilisation == pytest.approx(0.5 / 0.8)
    assert (found.governing.mass, found.governing.motion) == ("empty", 1)


def test_what_further_motions_can_show():
    """0 of 72 and 1 of 110 put the upper end of the 95 % interval at 5 %."""
    for motions, overturned, sure in ((72, 0, True), (109, 1, False), (110, 1, True), (200, 3, True)):
        found = answer(runs(), repeated(), further(motions, overturned=overturned))
        assert (found.answer == "fulfilled") == sure, (motions, overturned)
    found = answer(runs(), repeated(), further(100, beyond=10))
    assert found.answer == "fulfilled" and found.further[0].beyond_limits == 10


def test_a_run_that_destroys_a_corner_does_not_count_as_standing_and_is_counted_apart():
    found = answer(first(outcome="invalid"), repeated(), further())
    assert (found.answer, found.overturned, found.invalid) == ("not fulfilled", 0, 1)
    assert found.governing.outcome == "invalid"
    crushed, failed = (answer(runs(), runs(stage=SCAN, factor=1.5, outcome=one)) for one in ("invalid", None))
    counts = [(point.factor, point.overturned, point.invalid) for point in crushed.scan]
    assert counts == [(1.0, 0, 0), (1.5, 0, 7)] and failed.scan[1].failed == 7
    found = answer(runs(), repeated(), further(99) + runs((100,), FURTHER, outcome="invalid"))
    assert (found.answer, found.further[0].overturned, found.further[0].invalid) == ("not sure", 0, 1)


def test_the_margin_is_the_least_factor_at_which_any_limit_fails():
    limits = load_site("site").with_value("limits.slip_m", 0.1).limits

    def margin(*more):
        scan = [
            *runs(stage=SCAN, factor=1.25, max_slip_m=0.12),
            *runs(stage=SCAN, factor=1.5, outcome="overturned"),
        ]
        return margin_factor(limits, {key_of(run): run for run in [*runs(), *scan, *more]})

    assert margin() == 1.25
    between = runs(stage=REFINED, factor=1.125, max_slip_m=0.11)
    assert margin(*between) == 1.125
    # A part of a group has no mean: of one run that turns far nothing follows, of one that overturns it does.
    part = replace(RUN, stage=REFINED, factor=1.0625, rotation_ratio=0.7)
    assert margin(*between, part) == 1.125
    assert margin(*between, replace(part, outcome="overturned")) == 1.0625


@pytest.mark.parametrize(
    ("slip", "factor", "expected", "used"),
    [(0.12, 1.0, "not fulfilled", 1.2), (0.08, 1.5, "fulfilled", 0.8)],
)
def test_the_slip_in_two_directions_is_compared_with_the_clearance(slip, factor, expected, used):
    found = answer(runs(), repeated(), further(), two_directions=in_two_directions(slip, factor))
    assert (found.answer, found.margin_factor) == (expected, factor)
    assert ("slip_m" in found.exceeded) == (slip > 0.1)
    assert found.actions[0].utilisation == pytest.approx(used)
