"""What counts of the runs of a set: worse sign, then mean or largest, then the largest of the groups."""

from dataclasses import replace

import pytest
from site_example import RUN

from fem.site_check.result import SiteRun
from fem.site_check.rule import both_directions, groups_of, rule_in_words


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


def test_fewer_than_seven_motions_count_by_the_largest():
    (group,) = groups_of(runs(6))
    assert (group.motions, group.by_rule.rotation_ratio, group.by_rule.slip_m) == (
        6,
        pytest.approx(0.12),
        pytest.approx(0.018),
    )
    assert "the largest over the 6 motions" in rule_in_words(6)


def test_seven_motions_count_by_the_mean_of_the_worse_signs():
    (group,) = groups_of(runs(7))
    assert (group.by_rule.rotation_ratio, group.by_rule.slip_m) == (pytest.approx(0.08), pytest.approx(0.012))
    assert "the mean over the 7 motions" in rule_in_words(7)


@pytest.mark.parametrize(("outcome", "overturned", "failed"), [("overturned", 1, 0), (None, 0, 1)])
def test_one_run_that_overturned_or_failed_leaves_no_mean(outcome, overturned, failed):
    first, *others = runs(7)
    (group,) = groups_of([replace(first, outcome=outcome, rotation_ratio=None), *others])
    assert (group.overturned, group.failed) == (overturned, failed)
    assert (group.by_rule.rotation_ratio, group.by_rule.slip_m) == (None, None)


@pytest.mark.parametrize(
    "change",
    [
        {"mass": "empty"},
        {"elevation": "depth"},
        {"mu_static": 0.3},
        {"mu_kinetic": 0.1},
        {"building_period_s": 0.5},
    ],
)
def test_groups_differ_in_weight_elevation_friction_and_building(change):
    assert len(groups_of([RUN, replace(RUN, motion=2), replace(RUN, **change)])) == 2


def test_slips_of_both_elevations_add_up_as_vectors_with_100_and_30_per_cent():
    along = [replace(RUN, max_slip_m=0.03), replace(RUN, mass="empty", max_slip_m=0.02)]
    across = replace(RUN, elevation="depth", max_slip_m=0.04)
    ((group, slip),) = both_directions(groups_of([*along, across]))
    assert (group.first.mass, slip) == ("full", pytest.approx((0.04**2 + 0.009**2) ** 0.5))
    assert both_directions(groups_of(along)) == []
