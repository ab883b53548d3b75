"""Why a verification is not fulfilled, or not sure: a sentence with its count for all that speaks against it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from fem.results.figures import SLIPPED, TURNED
from fem.results.outcome import Outcome
from fem.runtime.intervals import binomial_interval, least_draws
from fem.runtime.units import SHORT_MILLIMETRES, DisplayUnit, plain_number
from fem.site_check.result import BY_RULE, FIGURE_OF, ConfirmedRun, FurtherMotions, RuleRange, SiteRun
from fem.site_check.rule import MEAN_FROM, RuleFound, RunGroup
from fem.site_check.tables import LimitsTable

NOT_FULFILLED, NOT_SURE = "not fulfilled", "not sure"
CONFIDENCE = 0.95
#: probability of overturning under further motions that "fulfilled" bears, and beyond a limit
MOST_OVERTURNING = 0.05
ALIKE = "in which the motions differ by 1 in 10 000 at most"
FIGURES = 2  #: of what rocking makes of a motion; more would not be known


class Reason(NamedTuple):
    """What speaks against "fulfilled"."""

    answer: str  #: not fulfilled | not sure
    sentence: str


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """What the answer to the earthquake rests on."""

    limits: LimitsTable
    motions: int
    groups: Sequence[RunGroup]  #: of the set
    rule: RuleFound  #: of the set
    range: RuleRange | None
    repetitions_failed: int
    further: Sequence[FurtherMotions]
    confirmed: Sequence[ConfirmedRun]

    def reasons(self) -> Iterator[Reason]:
        """All of them, in the order of the evidence."""
        runs = sum(len(group.runs) for group in self.groups)
        if self.rule.invalid:
            yield Reason(
                NOT_FULFILLED,
                f"{self.rule.invalid} of {runs} runs destroyed a corner: beyond that a run is not valid, and does not "
                "count as standing.",
            )
        if self.rule.overturned:
            most = max(self.groups, key=lambda group: len(group.beyond_any({})))
            yield Reason(
                NOT_FULFILLED,
                f"{self.rule.overturned} of {runs} runs overturned: up to {len(most.beyond_any({}))} of "
                f"{self.motions} motions overturn it ({where(most.first)}).",
            )
        if not self.rule.overturned + self.rule.invalid:
            for key in FIGURE_OF:
                yield from self._limit(key)
            yield from self._repetitions()
        for group in self.further:
            yield from against(group)
        yield from self._confirmed()

    def _limit(self, key: str) -> Iterator[Reason]:
        """Whether a limit is kept, by the set and by its repetitions."""
        figure, limit = FIGURE_OF[key], getattr(self.limits, key)
        value = self.rule.by_rule[figure]
        if value is None:
            return
        low, high = (self.range and self.range[figure]) or (value, value)
        if high <= limit:
            return
        words, bound = self._words(key)
        places = places_of(key, limit, (value, low, high))
        amount = in_words(key, value, places)
        group = max(self.groups, key=lambda group: group.by_rule[figure] or 0.0)
        if low > limit:
            again = (
                f", {span(key, low, high, places)} in all repetitions" if self.range and low < high else ""
            )
            single = "" if key == "rotation_ratio" else f"; {self._count(key, group)}"
            yield Reason(
                NOT_FULFILLED, f"{words} is {amount}{again}, beyond {bound} ({where(group.first)}{single})."
            )
        else:
            yield Reason(
                NOT_SURE,
                f"{words} is {amount}, and {span(key, low, high, places)} in repetitions {ALIKE}: {bound} lies between "
                f"({where(group.first)}).",
            )

    def _words(self, key: str) -> tuple[str, str]:
        """A figure and its limit."""
        limit = getattr(self.limits, key)
        if key == "slip_m":
            return "The largest slip", f"the clearance of {SHORT_MILLIMETRES.text(limit)}"
        if key == "single_rotation_ratio":
            return "The largest rotation of a single motion", f"this program's own limit of {limit:g}"
        share = "mean" if self.motions >= MEAN_FROM else "largest"
        return f"The {share} rotation of the {self.motions} motions", f"the limit of {limit:g}"

    def _count(self, key: str, group: RunGroup) -> str:
        beyond = group.beyond(SLIPPED if key == "slip_m" else TURNED, getattr(self.limits, key))
        return f"{beyond} of {self.motions} motions beyond it"

    def _repetitions(self) -> Iterator[Reason]:
        if self.range and self.range.overturned:
            yield Reason(
                NOT_SURE,
                f"In {self.range.overturned} of {self.range.repetitions} repetitions {ALIKE}, a run overturned or "
                "destroyed a corner.",
            )
        if self.repetitions_failed:
            yield Reason(NOT_SURE, f"Runs of the repetitions that failed: {self.repetitions_failed}.")

    def _confirmed(self) -> Iterator[Reason]:
        """What the elastic model and the unknown inputs make of the deciding runs."""
        again = self.confirmed
        failed = sum(repeated.outcome is None for repeated in again)
        invalid = sum(Outcome.INVALID in (repeated.outcome, *repeated.outcomes) for repeated in again)
        fell = sum(Outcome.OVERTURNED in (repeated.outcome, *repeated.outcomes) for repeated in again)
        beyond = sum(
            repeated.turned > self.limits.single_rotation_ratio or repeated.slipped > self.limits.slip_m
            for repeated in again
        )
        words = "deciding runs, repeated with the elastic model over their unknown inputs,"
        if failed:
            yield Reason(NOT_SURE, f"{failed} of {len(again)} {words} failed.")
        if (bolts := max((repeated.bolt_utilisation or 0.0 for repeated in again), default=0.0)) > 1.0:
            yield Reason(
                NOT_SURE,
                f"In a deciding run the bolts carry {above_one(bolts)} times their capacity: the stack does not stay "
                "one body.",
            )
        if invalid:
            yield Reason(NOT_SURE, f"{invalid} of {len(again)} {words} can destroy a corner.")
        if fell:
            yield Reason(NOT_SURE, f"{fell} of {len(again)} {words} can overturn.")
        elif beyond and not self.rule.fails(self.limits):
            yield Reason(
                NOT_SURE,
                "Deciding runs that go beyond a limit of a single motion, repeated with the elastic model: "
                f"{beyond} of {len(again)}.",
            )


def against(group: FurtherMotions) -> Iterator[Reason]:
    """What the further motions for one container and friction say against it."""
    if group.failed:
        yield Reason(
            NOT_SURE,
            f"{group.failed} of {group.failed + group.motions} further motions failed ({where(group)}).",
        )
    if not group.motions:
        return
    per_cent = f"{100.0 * MOST_OVERTURNING:g} %"
    beyond = f"{group.beyond_limits} went beyond a limit of a single motion{both_ways(group)}"
    least_beyond, _ = binomial_interval(group.beyond_limits, group.motions, CONFIDENCE)
    if group.overturned + group.invalid and group.interval[1] > MOST_OVERTURNING:
        low, high = (plain_number(100.0 * end, FIGURES) for end in group.interval)
        yield Reason(
            NOT_SURE,
            f"{group.overturned} of {group.motions} further motions overturned it{destroyed(group.invalid)} and "
            f"{beyond} ({where(group)}): under {low} to {high} % of such motions it does not stand, which may be "
            f"more than {per_cent}.",
        )
    elif least_beyond > MOST_OVERTURNING:
        yield Reason(
            NOT_SURE,
            f"Of {group.motions} further motions {beyond} ({where(group)}): of such motions more than {per_cent} do.",
        )
    elif group.interval[1] > MOST_OVERTURNING:
        yield Reason(
            NOT_SURE,
            f"{group.motions} further motions cannot show that at most {per_cent} overturn it: at least "
            f"{least_draws(MOST_OVERTURNING, CONFIDENCE)} can.",
        )


def above_one(utilisation: float) -> str:
    """A utilisation above 1 with enough figures to be seen above it."""
    return next(
        (words for figures in (2, 3, 4) if (words := f"{utilisation:.{figures}g}") != "1"), "just over 1"
    )


def both_ways(group: FurtherMotions) -> str:
    """How many of those beyond a limit slid too far under both horizontal components."""
    return f", {group.slid_too_far} by slip under both horizontal components" if group.slid_too_far else ""


def destroyed(count: int) -> str:
    """What follows the count of those that overturned: how many did not stand otherwise."""
    return f", {count} destroyed a corner" if count else ""


def where(run: SiteRun | FurtherMotions) -> str:
    """The container and friction of runs: "full, friction 0.4/0.2"."""
    side = "" if run.elevation == "width" else f", {run.elevation} along the motion"
    period = "" if run.building_period_s is None else f", building {run.building_period_s:g} s"
    return f"{run.mass}{side}{period}, friction {run.mu_static:.3g}/{run.mu_kinetic:.3g}"


def in_words(key: str, value: float, figures: int = FIGURES) -> str:
    """A figure of the rule with its unit."""
    of_it = "" if key == "slip_m" else " of the slenderness angle"
    return unit_of(key).text(value, figures=figures) + of_it


def span(key: str, low: float, high: float, figures: int = FIGURES) -> str:
    """A range of a figure without its unit; nothing but its one number where the ends read alike."""
    ends = [unit_of(key).text(end, figures=figures, bare=True) for end in (low, high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def places_of(key: str, limit: float, values: Sequence[float]) -> int:
    """Figures with which no value reads as its limit."""
    unit = unit_of(key)
    return next(
        (
            figures
            for figures in (FIGURES, FIGURES + 1)
            if all(
                unit.text(value, figures=figures) != unit.text(limit, figures=figures)
                for value in values
                if value != limit
            )
        ),
        FIGURES + 2,
    )


def unit_of(key: str) -> DisplayUnit:
    """The unit in which people read a figure of the rule."""
    return BY_RULE[FIGURE_OF.get(key, key)].unit
