"""The rule of a verification: from the runs of a set of motions to the figures that its limits are on.

For each weight, elevation, building period and pair of frictions: of each motion the worse sign of the vertical; then
of rotations the largest of fewer than seven motions, or the mean of seven and more (EN 1998-1:2004, 4.3.3.4.3 (3), by
analogy), and of slips the largest, since a clearance is used up by one motion. Of these groups the largest counts. Any
overturning means not fulfilled, and no single motion may turn the container further than a second limit: the code is
silent there, so these are the rules of this program.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Self

from fem.results.figures import SLIPPED, TURNED
from fem.results.outcome import ENDINGS, Outcome
from fem.site_check.result import FIGURE_OF, ByRule, SiteRun
from fem.site_check.tables import LimitsTable

MEAN_FROM = 7  #: motions from which the mean counts
SHARE = 0.3  #: of the other horizontal component
Key = tuple[str, str, float | None, float, float]


@dataclass(frozen=True, kw_only=True)
class RunGroup:
    """The runs of one weight, elevation, building period and pair of frictions, and what counts of them."""

    runs: tuple[SiteRun, ...]

    @property
    def first(self) -> SiteRun:
        """One of them: weight, elevation, period and frictions are those of all."""
        return self.runs[0]

    @property
    def key(self) -> Key:
        """Weight, elevation, period and frictions."""
        return _key(self.first)

    @property
    def motions(self) -> int:
        """How many motions."""
        return len({run.motion for run in self.runs})

    @property
    def rests(self) -> bool:
        """Whether nothing moves in any of its runs."""
        return all(run.outcome == Outcome.REST for run in self.runs)

    @property
    def overturned(self) -> int:
        """Runs that overturned."""
        return sum(run.outcome == Outcome.OVERTURNED for run in self.runs)

    @property
    def failed(self) -> int:
        """Runs without an outcome."""
        return sum(run.outcome is None for run in self.runs)

    @property
    def invalid(self) -> int:
        """Runs that destroyed a corner: they do not count as standing, and have no figures."""
        return sum(run.outcome == Outcome.INVALID for run in self.runs)

    @cached_property
    def by_rule(self) -> ByRule:
        """What counts."""
        rotations, slips = self._worst(TURNED), self._worst(SLIPPED)
        if rotations is None or slips is None:
            return ByRule()
        mean = sum(rotations) / len(rotations)
        return ByRule(
            rotation_ratio=mean if len(rotations) >= MEAN_FROM else max(rotations),
            rotation_ratio_largest=max(rotations),
            slip_m=max(slips),
            slip_mean_m=sum(slips) / len(slips),
        )

    def beyond(self, figure: str, limit: float) -> int:
        """Motions of which a figure is beyond a limit with the worse sign, or under which it does not stand."""
        return len(self.beyond_any({figure: limit}))

    def beyond_any(self, limits: Mapping[str, float]) -> set[int]:
        """Motions under which it does not stand, or with one of some figures beyond its limit, of the worse sign."""
        return {
            run.motion
            for run in self.runs
            if run.outcome in ENDINGS or any((run[figure] or 0.0) > limit for figure, limit in limits.items())
        }

    def _worst(self, figure: str) -> list[float] | None:
        """Of each motion the worse sign; None where a run has no such figure."""
        if self.overturned or self.invalid or self.failed:
            return None
        worst: dict[int, float] = {}
        for run in self.runs:
            if run[figure] is None:
                return None
            worst[run.motion] = max(worst.get(run.motion, 0.0), run[figure])
        return list(worst.values())


@dataclass(frozen=True, kw_only=True)
class RuleFound:
    """What the rule finds in the runs of some groups."""

    overturned: int
    failed: int
    invalid: int  #: runs that destroyed a corner
    by_rule: ByRule  #: over the groups the largest; None where one has none

    @classmethod
    def of(cls, groups: Sequence[RunGroup]) -> Self:
        """From the runs of groups."""
        figures = {field.name: [group.by_rule[field.name] for group in groups] for field in fields(ByRule)}
        return cls(
            overturned=sum(group.overturned for group in groups),
            failed=sum(group.failed for group in groups),
            invalid=sum(group.invalid for group in groups),
            by_rule=ByRule(
                **{name: None if None in row else max(row, default=None) for name, row in figures.items()}
            ),
        )

    def exceeded(self, limits: LimitsTable) -> list[str]:
        """The limits that are exceeded, by their keys; where a run overturned none is known to be kept."""
        return [key for key, name in FIGURE_OF.items() if (self.by_rule[name] or 0.0) > getattr(limits, key)]

    def fails(self, limits: LimitsTable) -> bool:
        """Whether the rule is not fulfilled."""
        return self.overturned + self.invalid > 0 or bool(self.exceeded(limits))

    def utilisation(self, limits: LimitsTable) -> float | None:
        """The largest share of a limit; None where a run overturned or failed."""
        used = [
            None if self.by_rule[name] is None else self.by_rule[name] / getattr(limits, key)
            for key, name in FIGURE_OF.items()
        ]
        known = [use for use in used if use is not None]
        return max(known) if len(known) == len(used) else None


def groups_of(runs: Iterable[SiteRun]) -> list[RunGroup]:
    """Runs by weight, elevation, building period and frictions, in the order of their first runs."""
    groups: dict[Key, list[SiteRun]] = {}
    for run in runs:
        groups.setdefault(_key(run), []).append(run)
    return [RunGroup(runs=tuple(members)) for members in groups.values()]


def _key(run: SiteRun) -> Key:
    return run.mass, run.elevation, run.building_period_s, run.mu_static, run.mu_kinetic


def both_directions(groups: Sequence[RunGroup]) -> list[tuple[RunGroup, float]]:
    """Slip under 100 % of one horizontal component and 30 % of the other, where both elevations were run [m].

    EN 1998-1:2004, 4.3.3.5.1 (3), of effects: the slips as vectors. For friction, which is not linear, that is an
    estimate, so it is shown and is no part of the rule.

    Returns:
        The group of the elevation along the width, and the larger of the two combinations.
    """
    combined = []
    for along in groups:
        for across in groups:
            same = replace(across.first, elevation=along.first.elevation)
            if along.first.elevation != "width" or across.first.elevation == "width":
                continue
            one, other = along.by_rule.slip_m, across.by_rule.slip_m
            if _key(same) == along.key and one is not None and other is not None:
                pairs = ((one, other), (other, one))
                combined.append((along, max(math.hypot(whole, SHARE * part) for whole, part in pairs)))
    return combined


def governing_groups(groups: Sequence[RunGroup]) -> list[RunGroup]:
    """Of each weight the group that governs rotation and the one that governs slip, in the order of the groups."""

    def rotation(group: RunGroup) -> tuple[int, float]:
        return group.overturned + group.invalid, max(run.turned for run in group.runs)

    def slip(group: RunGroup) -> float:
        return max(run.slipped for run in group.runs if run.outcome not in ENDINGS)

    chosen: set[int] = set()
    for mass in dict.fromkeys(group.first.mass for group in groups):
        own = [group for group in groups if group.first.mass == mass and not group.failed]
        standing = [group for group in own if group.overturned + group.invalid < len(group.runs)]
        chosen |= {id(max(pool, key=key)) for pool, key in ((own, rotation), (standing, slip)) if pool}
    return [group for group in groups if id(group) in chosen]


def rule_in_words(motions: int, limits: LimitsTable) -> str:
    """The rule in words, for a number of motions."""
    share = "the mean" if motions >= MEAN_FROM else "the largest"
    single = (
        f"no single rotation above {limits.single_rotation_ratio:g} of the slenderness angle; "
        if motions >= MEAN_FROM or limits.single_rotation_ratio < limits.rotation_ratio
        else ""
    )
    return (
        f"for each motion the worse sign of the vertical; of rotations {share} over the {motions} motions, of slips "
        f"the largest; of these the largest over all weights and frictions; {single}any overturning means not fulfilled"
    )
