"""The answer to a verification in words: what it rests on, and a sentence for all that speaks against it."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from functools import partial
from types import MappingProxyType
from typing import Any

from fem.html.page import text_of
from fem.results.outcome import Outcome
from fem.runtime.intervals import binomial_interval, least_draws
from fem.runtime.units import RATIO, SHORT_MILLIMETRES, DisplayUnit, plain_number
from fem.site.request import WIDTH, SiteRequest
from fem.site.result import (
    BY_RULE,
    FIGURE_OF,
    FOUND_FROM,
    REFINED,
    SCAN,
    SET,
    ActionAnswer,
    ByRule,
    ConfirmedRun,
    FurtherMotions,
    MotionSet,
    RuleRange,
    RunKey,
    ScanPoint,
    SiteAnswer,
    SiteKey,
    SiteRun,
    TwoDirections,
)
from fem.site.rule import (
    CONFIDENCE,
    MEAN_FROM,
    MotionSlips,
    RunGroup,
    further_motions,
    governing_run,
    groups_of,
    margin_factor,
    rule_of,
    rule_range,
    runs_by_factor,
)
from fem.site.tables import LimitsTable

FULFILLED, NOT_FULFILLED, NOT_SURE = "fulfilled", "not fulfilled", "not sure"
EARTHQUAKE, WIND = "earthquake", "wind"
#: probability of overturning under further motions that "fulfilled" bears, and beyond a limit
MOST_OVERTURNING = 0.05
FIGURES = 2  #: of what rocking makes of a motion; more would not be known
#: a sentence of a verification, by its name and what it is about
SAYS = partial(text_of, "site_words.txt.j2")


Reason = tuple[str, str]  #: what speaks against "fulfilled": not fulfilled | not sure, and a sentence


def answer_of(
    request: SiteRequest,
    motions: MotionSet,
    runs: Mapping[RunKey, SiteRun],
    *,
    confirmed: Sequence[ConfirmedRun] = (),
    wind: float | None = None,
    two_directions: TwoDirections | None = None,
    slips_of_further: MotionSlips = MappingProxyType({}),
    in_plane_only: str = "",
    still: int = 0,
    moves_at: float | None = None,
    left_out: str = "",
) -> SiteAnswer:
    """The answer, from all runs and from what is beside them.

    Args:
        request, motions, runs: what was asked, the set and its checks, the runs of all stages.
        confirmed: the deciding runs, repeated.
        wind: utilisation under it; None: it was not asked for.
        two_directions, slips_of_further: None and empty: not asked for, or not known.
        in_plane_only: why these, which were asked for, are not known, in words.
        still: runs that the rigid bound made superfluous.
        moves_at: factor on the motions at which a rigid body first uplifts or slips.
        left_out: stages that were not asked for, in words.
    """
    limits, slip = request.limits, two_directions
    own = [run for key, run in runs.items() if key.stage == SET]
    rule = SAYS(what="rule", motions=motions.count, by_mean=motions.count >= MEAN_FROM, limits=limits)
    if not motions.valid:
        sentence = SAYS(what="no valid set", reasons=motions.reasons)
        return SiteAnswer(rule=rule, sentence=sentence, overturned=0, runs=0)
    groups = groups_of(own)
    tally = rule_of(groups)
    ranged, failed = rule_range(groups, runs)
    further = further_motions(limits, runs, slips_of_further)
    against = [
        *_of_the_set(request, motions.count, groups, ranged, failed),
        *(reason for group in further for reason in _of_further(request, group)),
        *_of_the_deciding(limits, tally, confirmed),
        *(_of_two_directions(slip, limits.slip_m) if slip else ()),
        *[(NOT_SURE, in_plane_only)] * bool(in_plane_only),
    ]
    if left_out := left_out or ("" if request.motions.further else SAYS(what="no further motions")):
        against.append((NOT_SURE, left_out))
    used = tally.utilisation(limits)
    if used is not None and slip is not None:
        used = max(used, slip.slip_largest_m / limits.slip_m)
    unknown = tally.failed > 0 and not tally.not_standing
    judged = None if unknown else gravest(against)
    actions = [ActionAnswer(name=EARTHQUAKE, answer=judged, utilisation=used)]
    if wind is not None:
        judged = NOT_FULFILLED if wind > 1.0 else FULFILLED
        actions.append(ActionAnswer(name=WIND, answer=judged, utilisation=wind))
        against += [(NOT_FULFILLED, SAYS(what="wind", used=_above_one(wind)))] * (wind > 1.0)
    answer = None if unknown else gravest(against)
    against.sort(key=lambda reason: reason[0] != NOT_FULFILLED)
    slid_too_far = slip is not None and slip.slip_largest_m > limits.slip_m
    fails = [margin_factor(limits, runs), slip.margin_factor if slip else None]
    by_factor = runs_by_factor(runs, SET, SCAN, REFINED)
    fell = (
        factor for factor, some in by_factor.items() if any(run.outcome == Outcome.OVERTURNED for run in some)
    )
    scan = [rule_of(groups_of(some), factor) for factor, some in runs_by_factor(runs, SET, SCAN).items()]
    return SiteAnswer(
        answer=answer,
        fulfilled={FULFILLED: True, NOT_FULFILLED: False}.get(answer or ""),
        reasons=tuple(sentence for _, sentence in against),
        rule=rule,
        sentence=_sentence(limits, answer, tally, against, slip),
        still=still,
        **{field.name: tally[field.name] for field in fields(ByRule)},
        exceeded=tuple(
            key for key in FIGURE_OF if key in tally.exceeded(limits) or (key == "slip_m" and slid_too_far)
        ),
        governing=governing_run(limits, own),
        actions=tuple(actions),
        margin_factor=min((factor for factor in fails if factor is not None), default=None),
        factor_at_first_overturning=min(fell, default=None),
        factor_at_first_movement=moves_at,
        two_directions=slip,
        rule_range=ranged,
        scan=tuple(scan) if len(scan) > 1 else (),
        failed_between=sum(key.stage == REFINED and run.outcome is None for key, run in runs.items()),
        further=further,
        confirmed=tuple(confirmed),
    )


def no_answer_yet(
    limits: LimitsTable, motions: MotionSet, own: Sequence[SiteRun], missing: str
) -> SiteAnswer:
    """What stands in place of the answer of an interrupted verification.

    Args:
        own: the runs of the set that are there; missing: what is not, in words.
    """
    return SiteAnswer(
        rule=SAYS(what="rule", motions=motions.count, by_mean=motions.count >= MEAN_FROM, limits=limits),
        sentence=f"No answer yet: {missing}.",
        overturned=sum(run.outcome == Outcome.OVERTURNED for run in own),
        invalid=sum(run.outcome == Outcome.INVALID for run in own),
        runs=len(own),
    )


def gravest(reasons: Iterable[Reason]) -> str:
    """The answer that some reasons leave."""
    answers = {answer for answer, _ in reasons}
    return next((answer for answer in (NOT_FULFILLED, NOT_SURE) if answer in answers), FULFILLED)


def _sentence(
    limits: LimitsTable,
    answer: str | None,
    tally: ScanPoint,
    against: Sequence[Reason],
    slip: TwoDirections | None,
) -> str:
    """The answer in words: what it rests on, or what speaks against it."""
    if answer is None:
        return SAYS(what="no answer", tally=tally)
    if answer != FULFILLED:
        gravest_ones = [sentence for judged, sentence in against if judged == answer]
        return f"{answer.capitalize()}. {' '.join(gravest_ones)}"
    least = SHORT_MILLIMETRES.least
    furthest = max(tally.slip_m or 0.0, slip.slip_largest_m if slip else 0.0)
    slid = f"below {1e3 * least:g} mm" if furthest < least else SHORT_MILLIMETRES.text(furthest)
    return SAYS(what="fulfilled", tally=tally, limits=limits, slid=slid, ratio=RATIO.text)


def _of_the_set(
    request: SiteRequest, motions: int, groups: Sequence[RunGroup], ranged: RuleRange | None, failed: int
) -> Iterator[Reason]:
    """What the set and its repetitions say against it; `failed`: runs of these that did."""
    tally = rule_of(groups)
    if tally.invalid:
        yield NOT_FULFILLED, SAYS(what="destroyed", tally=tally)
    if tally.overturned:
        group = max(groups, key=lambda group: len(group.beyond({})))
        most, place = len(group.beyond({})), where(request, group.first)
        yield NOT_FULFILLED, SAYS(what="overturned", tally=tally, motions=motions, most=most, place=place)
    if tally.not_standing:
        return
    for key, figure in FIGURE_OF.items():
        value, limit = tally[figure], getattr(request.limits, key)
        low, high = (ranged and ranged[figure]) or (value, value)
        if value is None or high <= limit:
            continue
        places = places_of(key, limit, (value, low, high))
        used = [group.by_rule[figure] or 0.0 for group in groups]
        group = groups[used.index(max(used))]
        said = SAYS(
            what="beyond a limit" if low > limit else "at a limit",
            key=key,
            motions=motions,
            by_mean=motions >= MEAN_FROM,
            amount=unit_of(key).text(value, figures=places),
            between=span_in_words(key, low, high, places),
            varies=bool(ranged) and low < high,
            limit=limit,
            clearance=SHORT_MILLIMETRES.text(limit),
            place=where(request, group.first),
            count=len(group.beyond({FOUND_FROM[key]: limit})),
        )
        yield NOT_FULFILLED if low > limit else NOT_SURE, said
    if ranged and ranged.overturned:
        yield NOT_SURE, SAYS(what="repetitions", ranged=ranged)
    if failed:
        yield NOT_SURE, SAYS(what="failed repetitions", failed=failed)


def _of_further(request: SiteRequest, group: FurtherMotions) -> Iterator[Reason]:
    """What the further motions for one container and friction say against it."""
    place = where(request, group)
    if group.failed:
        yield NOT_SURE, SAYS(what="failed motions", group=group, place=place)
    if not group.motions:
        return
    least_beyond, _ = binomial_interval(group.beyond_limits, group.motions, CONFIDENCE)
    what = "too few motions" if group.interval[1] > MOST_OVERTURNING else ""
    if group.overturned + group.invalid and what:
        what = "further overturned"
    elif least_beyond > MOST_OVERTURNING:
        what = "further beyond"
    if what:
        low, high = (plain_number(100.0 * end, FIGURES) for end in group.interval)
        least, most = least_draws(MOST_OVERTURNING, CONFIDENCE), f"{100.0 * MOST_OVERTURNING:g}"
        ends: dict[str, Any] = {"low": low, "high": high, "least": least, "most": most}
        yield NOT_SURE, SAYS(what=what, group=group, place=place, **ends)


def ended(again: Sequence[ConfirmedRun]) -> dict[str, int]:
    """How many of the deciding runs failed, can destroy a corner, and can overturn when they are repeated."""
    outcomes = [(repeated.outcome, *repeated.outcomes) for repeated in again]
    return {
        "failed": sum(repeated.outcome is None for repeated in again),
        "invalid": sum(Outcome.INVALID in one for one in outcomes),
        "fell": sum(Outcome.OVERTURNED in one for one in outcomes),
    }


def _of_the_deciding(
    limits: LimitsTable, tally: ScanPoint, again: Sequence[ConfirmedRun]
) -> Iterator[Reason]:
    """What the elastic model and the unknown inputs make of the deciding runs."""
    counts = ended(again)
    beyond = sum(
        repeated.turned > limits.single_rotation_ratio or repeated.slipped > limits.slip_m
        for repeated in again
    )
    if counts["failed"]:
        yield NOT_SURE, SAYS(what="deciding failed", count=counts["failed"], of=len(again))
    if (bolts := max((repeated.bolt_utilisation or 0.0 for repeated in again), default=0.0)) > 1.0:
        yield NOT_SURE, SAYS(what="bolts", used=_above_one(bolts))
    if counts["invalid"]:
        yield NOT_SURE, SAYS(what="deciding destroyed", count=counts["invalid"], of=len(again))
    if counts["fell"]:
        yield NOT_SURE, SAYS(what="deciding fell", count=counts["fell"], of=len(again))
    elif beyond and not tally.fails(limits):
        yield NOT_SURE, SAYS(what="deciding beyond", count=beyond, of=len(again))


def _of_two_directions(slip: TwoDirections, limit: float) -> Iterator[Reason]:
    """Whether a body that slides in both directions keeps within the clearance, in the set and its repetitions."""
    low, high = slip.slip_range_m or (slip.slip_largest_m, slip.slip_largest_m)
    if high <= limit:
        return
    said = partial(SAYS, slip=slip, place=_period_and_friction(slip), clearance=SHORT_MILLIMETRES.text(limit))
    if low > limit:
        figures = places_of("slip_m", limit, (slip.slip_largest_m,))
        slid = SHORT_MILLIMETRES.text(slip.slip_largest_m, figures=max(figures, SHORT_MILLIMETRES.figures))
        yield NOT_FULFILLED, said(what="slides too far", slips=slid)
    else:
        slips = span_in_words("slip_m", low, high, places_of("slip_m", limit, (low, high)))
        yield NOT_SURE, said(what="may slide too far", slips=slips)


def _above_one(utilisation: float) -> str:
    """A utilisation above 1 with enough figures to be seen above it."""
    return next(
        (words for figures in (2, 3, 4) if (words := f"{utilisation:.{figures}g}") != "1"), "just over 1"
    )


def destroyed(count: int) -> str:
    """What follows the count of those that overturned: how many did not stand otherwise."""
    return f", {count} destroyed a corner" if count else ""


def where(request: SiteRequest, run: SiteKey) -> str:
    """The container and friction of runs: "full, motion along its width of 1.2 m, friction 0.4/0.2"."""
    box = request.container.container
    length = box.width_m if run.elevation == WIDTH else box.depth_m
    return f"{run.mass}, motion along its {run.elevation} of {length:g} m{_period_and_friction(run)}"


def _period_and_friction(run: SiteKey | TwoDirections) -> str:
    """Behind the container, or the motion."""
    period = "" if run.building_period_s is None else f", building {run.building_period_s:g} s"
    return f"{period}, friction {run.mu_static:.3g}/{run.mu_kinetic:.3g}"


def span_in_words(key: str, low: float, high: float, figures: int = FIGURES) -> str:
    """A range of a figure without its unit; nothing but its one number where the ends read alike."""
    ends = [unit_of(key).text(end, figures=figures, bare=True) for end in (low, high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def places_of(key: str, limit: float, values: Sequence[float]) -> int:
    """Figures with which no value reads as its limit."""
    unit = unit_of(key)

    def apart(figures: int) -> bool:
        return all(
            unit.text(value, figures=figures) != unit.text(limit, figures=figures)
            for value in values
            if value != limit
        )

    return next(filter(apart, (FIGURES, FIGURES + 1)), FIGURES + 2)


def unit_of(key: str) -> DisplayUnit:
    """The unit in which people read a figure of the rule."""
    return BY_RULE[FIGURE_OF.get(key, key)].unit
