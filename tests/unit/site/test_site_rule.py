"""What counts of the runs of a set: worse sign, then mean or largest, then the largest of the groups."""

from dataclasses import replace

import pytest
from site_example import RUN

from fem.site.result import SiteRun
from fem.site.rule import governing_groups, groups_of, rule_of
from fem.site.tables import LimitsTable

LIMITS = LimitsTable(slip_m=0.1)


def runs(count: int) -> list[SiteRun]:
    """Motions 1 to count with both signs; the sign - rotates twice as much, the sign + slips more."""
    return [
        replace(
            RUN,
            motion=motion,
            vertical_sign=sign,
            rotation_ratio=0.01 * motion * (1 if sign > 0 else 2),
            max_slip_m=0.001 * motion * (3 if sign > 0 else 1),
        )
        for motion in range(1, count + 1)
        for sign in (1, -1)
    ]


def test_of_seven_motions_the_mean_rotation_counts_and_the_largest_slip_of_fewer_the_largest_of_both():
    (group,) = groups_of(runs(6))
    assert (group.by_rule.rotation_ratio, group.by_rule.slip_m) == pytest.approx((0.12, 0.018))
    (group,) = groups_of(runs(7))
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
    assert [(one.first.mass, one.first.mu_static) for one in governing_groups(groups)] == [
        ("full", 0.2),
        ("full", 0.4),
        ("empty", 0.2),
        ("empty", 0.4),
    ]
    fell = [replace(run, outcome="overturned") if run.mu_static == 0.3 else run for run in by_friction]
    assert {one.first.mu_static for one in governing_groups(groups_of(fell))} == {0.2, 0.3}


@pytest.mark.parametrize(("outcome", "overturned", "failed"), [("overturned", 1, 0), (None, 0, 1)])
def test_one_run_that_overturned_or_failed_leaves_no_mean(outcome, overturned, failed):
    first, *others = runs(7)
    (group,) = groups_of([replace(first, outcome=outcome, rotation_ratio=None), *others])
    assert (group.by_rule.overturned, group.by_rule.failed) == (overturned, failed)
    assert (group.by_rule.rotation_ratio, group.by_rule.slip_m) == (None, None)


def test_groups_differ_in_weight_elevation_friction_and_building():
    changes = {
        "mass": "empty",
        "elevation": "depth",
        "mu_static": 0.3,
        "mu_kinetic": 0.1,
        "building_period_s": 0.5,
    }
    for key, value in changes.items():
        assert len(groups_of([RUN, replace(RUN, motion=2), replace(RUN, **{key: value})])) == 2
