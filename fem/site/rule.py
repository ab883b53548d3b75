"""The rule of a verification: from the runs of a set of motions to the figures that its limits are on.

For each weight, elevation, building period and pair of frictions: of each motion the worse sign of the vertical; then
of rotations the largest of fewer than seven motions, or the mean of seven and more (EN 1998-1:2004, 4.3.3.4.3 (3), by
analogy), and of slips the largest, since a clearance is used up by one motion. Of these groups the largest counts. Any
overturning means not fulfilled, and no single motion may turn the container further than a second limit: the code is
silent there, so these are the rules of this program.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import groupby
from typing import Any

from fem.results.figures import SLIPPED, TURNED
from fem.results.outcome import ENDINGS, Outcome
from fem.runtime.intervals import binomial_interval
from fem.site.result import (
    BY_RULE,
    FIGURE_OF,
    FOUND_FROM,
    FURTHER,
    REFINED,
    REPEATED,
    SCAN,
    SET,
    FurtherMotions,
    RuleRange,
    RunKey,
    ScanPoint,
    SiteKey,
    SiteRun,
)
from fem.site.tables import LimitsTable

MEAN_FROM = 7  #: motions from which the mean counts
CONFIDENCE = 0.95
#: largest slip [m] under both horizontal components, by motion, period of the building and friction
MotionSlips = Mapping[tuple[int, float | None, float, float], float]


@dataclass(frozen=True, kw_only=True)
class RunGroup:
    """The runs of one weight, elevation, building period and pair of frictions, and what counts of them."""

    runs: tuple[SiteRun, ...]

    @property
    def first(self) -> SiteRun:
        """One of them: weight, elevation, period and frictions are those of all."""
        return self.runs[0]

    @property
    def by_motion(self) -> list[tuple[int, list[SiteRun]]]:
        """Its runs motion by motion, the sign + first."""
        ordered = sorted(self.runs, key=lambda run: (run.motion, -run.vertical_sign))
        return [(motion, list(runs)) for motion, runs in groupby(ordered, lambda run: run.motion)]

    @property
    def rests(self) -> bool:
        """Whether nothing moves in any of its runs."""
        return all(run.outcome == Outcome.REST for run in self.runs)

    @cached_property
    def by_rule(self) -> ScanPoint:
        """What counts: of each motion the worse sign; no figure where a run has none."""
        ends = Counter(run.outcome for run in self.runs)
        found = ScanPoint(
            factor=self.first.factor,
            runs=len(self.runs),
            overturned=ends[Outcome.OVERTURNED],
            invalid=ends[Outcome.INVALID],
            failed=ends[None],
        )
        if found.overturned or found.invalid or found.failed:
            return found
        worst: dict[str, dict[int, float]] = {TURNED: {}, SLIPPED: {}}
        for figure, of_motions in worst.items():
            for run in self.runs:
                if run[figure] is None:
                    return found
                of_motions[run.motion] = max(of_motions.get(run.motion, 0.0), run[figure])
        rotations, slips = ([*of_motions.values()] for of_motions in worst.values())
        mean = sum(rotations) / len(rotations)
        return replace(
            found,
            rotation_ratio=mean if len(rotations) >= MEAN_FROM else max(rotations),
            rotation_ratio_largest=max(rotations),
            slip_m=max(slips),
            slip_mean_m=sum(slips) / len(slips),
        )

    def beyond(self, limits: Mapping[str, float]) -> set[int]:
        """Motions under which it does not stand, or with one of some figures beyond its limit, of the worse sign."""
        return {
            run.motion
            for run in self.runs
            if run.outcome in ENDINGS or any((run[figure] or 0.0) > limit for figure, limit in limits.items())
        }


def rule_of(groups: Sequence[RunGroup], factor: float = 1.0) -> ScanPoint:
    """What the rule finds in the runs of some groups, at a factor on the motions: the largest over the groups."""
    figures = {name: [group.by_rule[name] for group in groups] for name in BY_RULE}
    found: dict[str, Any] = {
        name: None if None in row else max(row, default=None) for name, row in figures.items()
    }
    for name in ("runs", "overturned", "invalid", "failed"):
        found[name] = sum(group.by_rule[name] for group in groups)
    return ScanPoint(factor=factor, **found)


def groups_of(runs: Iterable[SiteRun]) -> list[RunGroup]:
    """Runs by weight, elevation, building period and frictions, in the order of their first runs."""
    groups: dict[Any, list[SiteRun]] = {}
    for run in runs:
        groups.setdefault(run.group, []).append(run)
    return [RunGroup(runs=tuple(members)) for members in groups.values()]


def governing_groups(groups: Sequence[RunGroup]) -> list[RunGroup]:
    """Of each weight the group that governs rotation and the one that governs slip, in the order of the groups."""

    def rotation(group: RunGroup) -> tuple[int, float]:
        return group.by_rule.not_standing, max(run.turned for run in group.runs)

    def slip(group: RunGroup) -> float:
        return max(run.slipped for run in group.runs if run.outcome not in ENDINGS)

    chosen: set[int] = set()
    for mass in dict.fromkeys(group.first.mass for group in groups):
        own = [group for group in groups if group.first.mass == mass and not group.by_rule.failed]
        standing = [group for group in own if group.by_rule.not_standing < len(group.runs)]
        chosen |= {id(max(pool, key=key)) for pool, key in ((own, rotation), (standing, slip)) if pool}
    return [group for group in groups if id(group) in chosen]


def governing_run(limits: LimitsTable, runs: Sequence[SiteRun]) -> SiteRun | None:
    """The run that decides: one that did not stand, else the largest of the group that uses most of a limit."""
    fell = [run for run in runs if run.outcome in ENDINGS]
    if fell:
        counts = {id(run): sum(len(groups_of((run, other))) == 1 for other in fell) for run in fell}
        return max(fell, key=lambda run: counts[id(run)])
    uses = [
        ((group.by_rule[name] or 0.0) / getattr(limits, key), FOUND_FROM[key], group)
        for group in groups_of(runs)
        if not group.by_rule.failed
        for key, name in FIGURE_OF.items()
    ]
    if not uses:
        return None
    _, figure, group = max(uses, key=lambda use: use[0])
    return max(group.runs, key=lambda run: run[figure] or 0.0)


def runs_by_factor(runs: Mapping[RunKey, SiteRun], *stages: str) -> dict[float, list[SiteRun]]:
    """The runs of these stages, by rising factor."""
    by_factor: dict[float, list[SiteRun]] = {}
    for key, run in runs.items():
        if key.stage in stages:
            by_factor.setdefault(key.factor, []).append(run)
    return dict(sorted(by_factor.items()))


def rule_range(groups: Sequence[RunGroup], runs: Mapping[RunKey, SiteRun]) -> tuple[RuleRange | None, int]:
    """The rule over the set and its repetitions, and how many of their runs failed; None: there are no repetitions.

    In each repetition the groups that were run again replace those of the set.
    """
    again = runs_by_factor(runs, REPEATED)
    if not again:
        return None, 0
    tallies = [rule_of(groups)]
    for rerun in again.values():
        repeated = {group.first.group: group for group in groups_of(rerun)}
        tallies.append(rule_of([repeated.get(group.first.group, group) for group in groups]))
    ranges = {}
    for name in FIGURE_OF.values():
        known = [tally[name] for tally in tallies if tally[name] is not None]
        ranges[name] = (min(known), max(known)) if known else ()
    fell = sum(repetition.not_standing > 0 for repetition in tallies[1:])
    span = RuleRange(**ranges, repetitions=len(again), overturned=fell)
    return span, sum(run.outcome is None for rerun in again.values() for run in rerun)


def further_motions(
    limits: LimitsTable, runs: Mapping[RunKey, SiteRun], slips: MotionSlips
) -> tuple[FurtherMotions, ...]:
    """Of the further motions, how many overturn each container, or go beyond a limit, with the worse sign.

    Args:
        slips: under both horizontal components.
    """
    counted = []
    for group in groups_of(run for key, run in runs.items() if key.stage == FURTHER):
        failed, first = {run.motion for run in group.runs if run.outcome is None}, group.first
        known = RunGroup(runs=tuple(run for run in group.runs if run.motion not in failed))
        motions, fell = {run.motion for run in known.runs}, len(known.beyond({}))
        ends = Counter(outcome for outcome, _ in {(run.outcome, run.motion) for run in known.runs})
        pair = first.building_period_s, first.mu_static, first.mu_kinetic
        slid = {motion: slips[motion, *pair] for motion in motions if (motion, *pair) in slips}
        beyond = known.beyond({TURNED: limits.single_rotation_ratio, SLIPPED: limits.slip_m})
        too_far = {motion for motion, slip in slid.items() if slip > limits.slip_m}
        counted.append(
            FurtherMotions(
                **{field.name: first[field.name] for field in fields(SiteKey)},
                motions=len(motions),
                overturned=ends[Outcome.OVERTURNED],
                invalid=ends[Outcome.INVALID],
                beyond_limits=len(beyond | too_far),
                slip_largest_m=max(slid.values(), default=None),
                slid_too_far=len(too_far),
                interval=binomial_interval(fell, len(motions), CONFIDENCE) if motions else (),
                failed=len(failed),
            )
        )
    return tuple(counted)


def margin_factor(limits: LimitsTable, runs: Mapping[RunKey, SiteRun]) -> float | None:
    """The least factor on the motions, of those tried, at which the rule fails; None: it fails at none."""
    by_factor = runs_by_factor(runs, SET, SCAN, REFINED)
    whole = max((len(group.runs) for group in groups_of(by_factor.get(1.0, ()))), default=0)

    def fails(factor: float) -> bool:
        # Between factors some runs of a group may be there alone: they have no mean.
        return any(
            group.by_rule.not_standing or (len(group.runs) == whole and group.by_rule.fails(limits))
            for group in groups_of(by_factor[factor])
        )

    return min((factor for factor in by_factor if fails(factor)), default=None)
