"""What counts of the runs of a set, and what each condition of "fulfilled" asks for; sentences: `said/answers.txt`."""

from dataclasses import replace

import pytest
from site_answers import answer, confirmed, first, further, in_two_directions, repeated, runs
from site_example import RUN

from fem.site.request import load_site
from fem.site.result import REFINED, SCAN, SiteRun
from fem.site.rule import governing_groups, groups_of, margin_factor, rule_of
from fem.site.runs import key_of
from fem.site.tables import LimitsTable


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


def test_a_run_that_destroys_a_corner_is_counted_apart_and_governs():
    assert answer(first(outcome="invalid"), repeated(), further()).governing.outcome == "invalid"
    crushed, failed = (answer(runs(), runs(stage=SCAN, factor=1.5, outcome=one)) for one in ("invalid", None))
    counts = [(point.factor, point.overturned, point.invalid) for point in crushed.scan]
    assert counts == [(1.0, 0, 0), (1.5, 0, 7)] and failed.scan[1].failed == 7


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


LIMITS = LimitsTable(slip_m=0.1)


def doubled(count: int) -> list[SiteRun]:
    """Motions 1 to count with both signs; the sign - rotates twice as much, the sign + slips more."""
    found = []
    for motion in range(1, count + 1):
        one = replace(RUN, motion=motion, rotation_ratio=0.01 * motion, max_slip_m=0.003 * motion)
        found += [
            one,
            replace(one, vertical_sign=-1, rotation_ratio=0.02 * motion, max_slip_m=0.001 * motion),
        ]
    return found


def test_of_seven_motions_the_mean_rotation_counts_and_the_largest_slip_of_fewer_the_largest_of_both():
    (group,) = groups_of(doubled(6))
    assert (group.by_rule.rotation_ratio, group.by_rule.slip_m) == pytest.approx((0.12, 0.018))
    (group,) = groups_of(doubled(7))
    found = group.by_rule
    assert (found.rotation_ratio, found.rotation_ratio_largest) == (pytest.approx(0.08), pytest.approx(0.14))
    assert (found.slip_m, found.slip_mean_m) == (pytest.approx(0.021), pytest.approx(0.012))


def test_a_mean_within_its_limit_does_not_hide_one_motion_near_overturning():
    low = [replace(RUN, motion=motion, rotation_ratio=0.3) for motion in range(1, 7)]
    for largest, exceeded in ((0.79, []), (0.99, ["single_rotation_ratio"])):
        found = rule_of(groups_of([*low, replace(RUN, motion=7, rotation_ratio=largest)]))
        assert found.rotation_ratio < 0.41
        assert found.exceeded(LIMITS) == exceeded
        assert found.fails(LIMITS) == bool(exceeded)


def test_one_slip_beyond_the_clearance_is_not_averaged_away():
    short = [replace(RUN, motion=motion, max_slip_m=0.05) for motion in range(1, 7)]
    found = rule_of(groups_of([*short, replace(RUN, motion=7, max_slip_m=0.11)]))
    assert found.slip_mean_m < 0.06
    assert found.exceeded(LIMITS) == ["slip_m"]


def test_each_weight_has_a_group_that_governs_rotation_and_one_that_governs_slip():
    by_friction = [
        replace(RUN, mass=mass, mu_static=mu, rotation_ratio=0.5 * mu, max_slip_m=0.1 * (1.0 - mu))
        for mass in ("full", "empty")
        for mu in (0.2, 0.3, 0.4)
    ]
    groups = groups_of(by_friction)
    found = [(one.first.mass, one.first.mu_static) for one in governing_groups(groups)]
    assert found == [("full", 0.2), ("full", 0.4), ("empty", 0.2), ("empty", 0.4)]
    fell = [replace(run, outcome="overturned") if run.mu_static == 0.3 else run for run in by_friction]
    assert {one.first.mu_static for one in governing_groups(groups_of(fell))} == {0.2, 0.3}


@pytest.mark.parametrize(("outcome", "overturned", "failed"), [("overturned", 1, 0), (None, 0, 1)])
def test_one_run_that_overturned_or_failed_leaves_no_mean(outcome, overturned, failed):
    first, *others = doubled(7)
    (group,) = groups_of([replace(first, outcome=outcome, rotation_ratio=None), *others])
    assert (group.by_rule.overturned, group.by_rule.failed) == (overturned, failed)
    assert (group.by_rule.rotation_ratio, group.by_rule.slip_m) == (None, None)


def test_groups_differ_in_weight_elevation_friction_and_building():
    changes = {"mass": "empty", "elevation": "depth", "mu_static": 0.3, "mu_kinetic": 0.1}
    for key, value in (changes | {"building_period_s": 0.5}).items():
        assert len(groups_of([RUN, replace(RUN, motion=2), replace(RUN, **{key: value})])) == 2
