"""The rule of a verification: from the runs of a set of motions to one number for each limit.

For each weight, elevation, building period and pair of frictions: of each motion the worse sign of the vertical; then
the largest of fewer than seven motions, or the mean of seven and more (EN 1998-1:2004, 4.3.3.4.3 (3), by analogy). Of
these groups the largest counts. Any overturning means not fulfilled: the code is silent
there, so this is the rule of this program.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from fem.results.outcome import Outcome
from fem.site_check.result import LIMITED, ByRule, SiteRun

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
    def motions(self) -> int:
        """How many motions."""
        return len({run.motion for run in self.runs})

    @property
    def overturned(self) -> int:
        """Runs that overturned."""
        return sum(run.outcome == Outcome.OVERTURNED for run in self.runs)

    @property
    def failed(self) -> int:
        """Runs without an outcome."""
        return sum(run.outcome is None for run in self.runs)

    @cached_property
    def by_rule(self) -> ByRule:
        """What counts."""
        return ByRule(**{limit: self._counted(figure) for limit, figure in LIMITED.items()})

    def _counted(self, figure: str) -> float | None:
        if self.overturned or self.failed:
            return None
        worst: dict[int, float] = {}
        for run in self.runs:
            if run[figure] is None:
                return None
            worst[run.motion] = max(worst.get(run.motion, 0.0), run[figure])
        return sum(worst.values()) / len(worst) if len(worst) >= MEAN_FROM else max(worst.values())


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
            if _key(same) == _key(along.first) and one is not None and other is not None:
                pairs = ((one, other), (other, one))
                combined.append((along, max(math.hypot(whole, SHARE * part) for whole, part in pairs)))
    return combined


def rule_in_words(motions: int) -> str:
    """The rule in words, for a number of motions."""
    share = "the mean" if motions >= MEAN_FROM else "the largest"
    return (
        f"for each motion the worse sign of the vertical, then {share} over the {motions} motions; the largest over "
        "all weights and frictions; any overturning means not fulfilled"
    )
