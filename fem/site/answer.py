"""The answer to a verification in words: what it rests on, and a sentence for all that speaks against it."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from fem.results.outcome import Outcome
from fem.runtime.intervals import binomial_interval, least_draws
from fem.runtime.units import RATIO, SHORT_MILLIMETRES, DisplayUnit, plain_number
from fem.site.request import WIDTH, SiteRequest
from fem.site.result import (
    BY_RULE,
    FIGURE_OF,
    FOUND_FROM,
    REFINED,
    SET,
    ActionAnswer,
    ConfirmedRun,
    FurtherMotions,
    MotionSet,
    RuleRange,
    RunKey,
    SiteAnswer,
    SiteKey,
    SiteRun,
    TwoDirections,
)
from fem.site.rule import (
    CONFIDENCE,
    MEAN_FROM,
    MotionSlips,
    RuleFound,
    RunGroup,
    first_overturning,
    further_motions,
    governing_run,
    groups_of,
    margin_factor,
    rule_range,
    scan_of,
)
from fem.site.tables import LimitsTable

FULFILLED, NOT_FULFILLED, NOT_SURE = "fulfilled", "not fulfilled", "not sure"
EARTHQUAKE, WIND = "earthquake", "wind"
#: probability of overturning under further motions that "fulfilled" bears, and beyond a limit
MOST_OVERTURNING = 0.05
ALIKE = "in which the motions differ by 1 in 10 000 at most"
FIGURES = 2  #: of what rocking makes of a motion; more would not be known
NO_FURTHER = "No further motions were asked for: how often such motions overturn it is not known."
AGAIN = "deciding runs, repeated with the elastic model over their unknown inputs,"


class _Reason(NamedTuple):
    """What speaks against "fulfilled"."""

    answer: str  #: not fulfilled | not sure
    sentence: str


@dataclass(frozen=True, kw_only=True)
class Beside:
    """What the answer rests on beside the runs of its stages."""

    confirmed: Sequence[ConfirmedRun] = ()  #: the deciding runs, repeated
    wind: float | None = None  #: utilisation under wind; None: it was not asked for
    two_directions: TwoDirections | None = None  #: None: not asked for, or not known
    slips_of_further: MotionSlips = field(default_factory=dict)  #: empty: not asked for, or not known
    in_plane_only: str = ""  #: why the slip in two directions, which was asked for, is not known, in words
    still: int = 0  #: runs that the rigid bound made superfluous
    moves_at: float | None = None  #: factor on the motions at which a rigid body first uplifts or slips
    left_out: str = ""  #: stages that were not asked for, in words


def answer_of(
    request: SiteRequest, motions: MotionSet, runs: Mapping[RunKey, SiteRun], beside: Beside
) -> SiteAnswer:
    """The answer, from all runs and from what is beside them."""
    limits, slip, wind = request.limits, beside.two_directions, beside.wind
    own = [run for key, run in runs.items() if key.stage == SET]
    rule = _rule_in_words(motions.count, limits)
    if not motions.valid:
        sentence = (
            f"Not valid: the set of motions fails its checks and is not used ({'; '.join(motions.reasons)})."
        )
        return SiteAnswer(rule=rule, sentence=sentence, overturned=0, runs=0)
    groups = groups_of(own)
    tally = RuleFound.of(groups)
    ranged, failed = rule_range(groups, runs)
    further = further_motions(limits, runs, beside.slips_of_further)
    against = [
        *_of_the_set(request, motions.count, groups, ranged, failed),
        *(reason for group in further for reason in of_further(request, group)),
        *_of_the_deciding(limits, tally, beside.confirmed),
        *(_of_two_directions(slip, limits.slip_m) if slip else ()),
        *([_Reason(NOT_SURE, beside.in_plane_only)] if beside.in_plane_only else ()),
    ]
    if left_out := beside.left_out or ("" if request.motions.further else NO_FURTHER):
        against.append(_Reason(NOT_SURE, left_out))
    used = tally.utilisation(limits)
    if used is not None and slip is not None:
        used = max(used, slip.slip_largest_m / limits.slip_m)
    unknown = tally.failed > 0 and not tally.overturned + tally.invalid
    judged = None if unknown else gravest(against)
    actions = [ActionAnswer(name=EARTHQUAKE, answer=judged, utilisation=used)]
    if wind is not None:
        actions.append(
            ActionAnswer(name=WIND, answer=NOT_FULFILLED if wind > 1.0 else FULFILLED, utilisation=wind)
        )
    if wind is not None and wind > 1.0:
        words = f"Wind uses {_above_one(wind)} times the resistance of the lightest container."
        against.append(_Reason(NOT_FULFILLED, words))
    answer = None if unknown else gravest(against)
    against.sort(key=lambda reason: reason.answer != NOT_FULFILLED)
    slid_too_far = slip is not None and slip.slip_largest_m > limits.slip_m
    fails = [margin_factor(limits, runs), slip.margin_factor if slip else None]
    return SiteAnswer(
        answer=answer,
        fulfilled={FULFILLED: True, NOT_FULFILLED: False}.get(answer or ""),
        reasons=tuple(reason.sentence for reason in against),
        rule=rule,
        sentence=_sentence(limits, answer, tally, against, slip, runs=len(own)),
        overturned=tally.overturned,
        invalid=tally.invalid,
        runs=len(own),
        still=beside.still,
        **vars(tally.by_rule),
        exceeded=tuple(
            key for key in FIGURE_OF if key in tally.exceeded(limits) or (key == "slip_m" and slid_too_far)
        ),
        governing=governing_run(limits, own),
        actions=tuple(actions),
        margin_factor=min((factor for factor in fails if factor is not None), default=None),
        factor_at_first_overturning=first_overturning(runs),
        factor_at_first_movement=beside.moves_at,
        two_directions=slip,
        rule_range=ranged,
        scan=scan_of(runs),
        failed_between=sum(key.stage == REFINED and run.outcome is None for key, run in runs.items()),
        further=further,
        confirmed=tuple(beside.confirmed),
    )


def no_answer_yet(
    limits: LimitsTable, motions: MotionSet, own: Sequence[SiteRun], missing: str
) -> SiteAnswer:
    """What stands in place of the answer of an interrupted verification.

    Args:
        own: the runs of the set that are there; missing: what is not, in words.
    """
    return SiteAnswer(
        rule=_rule_in_words(motions.count, limits),
        sentence=f"No answer yet: {missing}.",
        overturned=sum(run.outcome == Outcome.OVERTURNED for run in own),
        invalid=sum(run.outcome == Outcome.INVALID for run in own),
        runs=len(own),
    )


def gravest(reasons: Iterable[_Reason]) -> str:
    """The answer that some reasons leave."""
    answers = {reason.answer for reason in reasons}
    return next((answer for answer in (NOT_FULFILLED, NOT_SURE) if answer in answers), FULFILLED)


def _sentence(
    limits: LimitsTable,
    answer: str | None,
    tally: RuleFound,
    against: Sequence[_Reason],
    slip: TwoDirections | None,
    *,
    runs: int,
) -> str:
    """The answer in words: what it rests on, or what speaks against it."""
    if answer is None:
        return f"No answer: {tally.failed} of {runs} runs failed."
    if answer != FULFILLED:
        gravest_ones = [reason.sentence for reason in against if reason.answer == answer]
        return f"{answer.capitalize()}. {' '.join(gravest_ones)}"
    figures, least = tally.by_rule, SHORT_MILLIMETRES.least
    furthest = max(figures.slip_m or 0.0, slip.slip_largest_m if slip else 0.0)
    slid = f"below {1e3 * least:g} mm" if furthest < least else SHORT_MILLIMETRES.text(furthest)
    return (
        f"Fulfilled under the rule below: none of {runs} runs overturned; rotation "
        f"{RATIO.text(figures.rotation_ratio)} of the slenderness angle (limit {limits.rotation_ratio:g}), of a single "
        f"motion {RATIO.text(figures.rotation_ratio_largest)} (limit {limits.single_rotation_ratio:g}), largest slip "
        f"{slid} (limit {1e3 * limits.slip_m:g} mm)."
    )


def _rule_in_words(motions: int, limits: LimitsTable) -> str:
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


def _of_the_set(
    request: SiteRequest, motions: int, groups: Sequence[RunGroup], ranged: RuleRange | None, failed: int
) -> Iterator[_Reason]:
    """What the set and its repetitions say against it; `failed`: runs of these that did."""
    tally, runs = RuleFound.of(groups), sum(len(group.runs) for group in groups)
    if tally.invalid:
        yield _Reason(
            NOT_FULFILLED,
            f"{tally.invalid} of {runs} runs destroyed a corner: beyond that a run is not valid, and does not count as "
            "standing.",
        )
    if tally.overturned:
        most = max(groups, key=lambda group: len(group.beyond({})))
        yield _Reason(
            NOT_FULFILLED,
            f"{tally.overturned} of {runs} runs overturned: up to {len(most.beyond({}))} of {motions} motions overturn "
            f"it ({where(request, most.first)}).",
        )
    if tally.overturned + tally.invalid:
        return
    for key in FIGURE_OF:
        yield from _of_a_limit(key, request, motions, groups, ranged)
    if ranged and ranged.overturned:
        yield _Reason(
            NOT_SURE,
            f"In {ranged.overturned} of {ranged.repetitions} repetitions {ALIKE}, a run overturned or destroyed a "
            "corner.",
        )
    if failed:
        yield _Reason(NOT_SURE, f"Runs of the repetitions that failed: {failed}.")


def _of_a_limit(
    key: str, request: SiteRequest, motions: int, groups: Sequence[RunGroup], ranged: RuleRange | None
) -> Iterator[_Reason]:
    """Whether a limit is kept, by the set and by its repetitions."""
    figure, limit = FIGURE_OF[key], getattr(request.limits, key)
    value = RuleFound.of(groups).by_rule[figure]
    if value is None:
        return
    low, high = (ranged and ranged[figure]) or (value, value)
    if high <= limit:
        return
    share = "mean" if motions >= MEAN_FROM else "largest"
    words, bound = {
        "slip_m": ("The largest slip", f"the clearance of {SHORT_MILLIMETRES.text(limit)}"),
        "single_rotation_ratio": (
            "The largest rotation of a single motion",
            f"this program's own limit of {limit:g}",
        ),
    }.get(key, (f"The {share} rotation of the {motions} motions", f"the limit of {limit:g}"))
    places = places_of(key, limit, (value, low, high))
    amount = unit_of(key).text(value, figures=places) + (
        "" if key == "slip_m" else " of the slenderness angle"
    )
    group = max(groups, key=lambda group: group.by_rule[figure] or 0.0)
    place = where(request, group.first)
    between = span_in_words(key, low, high, places)
    if low > limit:
        again = f", {between} in all repetitions" if ranged and low < high else ""
        count = len(group.beyond({FOUND_FROM[key]: limit}))
        single = "" if key == "rotation_ratio" else f"; {count} of {motions} motions beyond it"
        yield _Reason(NOT_FULFILLED, f"{words} is {amount}{again}, beyond {bound} ({place}{single}).")
    else:
        sentence = (
            f"{words} is {amount}, and {between} in repetitions {ALIKE}: {bound} lies between ({place})."
        )
        yield _Reason(NOT_SURE, sentence)


def of_further(request: SiteRequest, group: FurtherMotions) -> Iterator[_Reason]:
    """What the further motions for one container and friction say against it."""
    place = where(request, group)
    if group.failed:
        words = f"{group.failed} of {group.failed + group.motions} further motions failed ({place})."
        yield _Reason(NOT_SURE, words)
    if not group.motions:
        return
    per_cent = f"{100.0 * MOST_OVERTURNING:g} %"
    beyond = f"{group.beyond_limits} went beyond a limit of a single motion{both_ways(group)}"
    least_beyond, _ = binomial_interval(group.beyond_limits, group.motions, CONFIDENCE)
    if group.overturned + group.invalid and group.interval[1] > MOST_OVERTURNING:
        low, high = (plain_number(100.0 * end, FIGURES) for end in group.interval)
        yield _Reason(
            NOT_SURE,
            f"{group.overturned} of {group.motions} further motions overturned it{destroyed(group.invalid)} and "
            f"{beyond} ({place}): under {low} to {high} % of such motions it does not stand, which may be more "
            f"than {per_cent}.",
        )
    elif least_beyond > MOST_OVERTURNING:
        yield _Reason(
            NOT_SURE,
            f"Of {group.motions} further motions {beyond} ({place}): of such motions more than {per_cent} do.",
        )
    elif group.interval[1] > MOST_OVERTURNING:
        yield _Reason(
            NOT_SURE,
            f"{group.motions} further motions cannot show that at most {per_cent} overturn it: at least "
            f"{least_draws(MOST_OVERTURNING, CONFIDENCE)} can.",
        )


def ended(again: Sequence[ConfirmedRun]) -> dict[str, int]:
    """How many of the deciding runs failed, can destroy a corner, and can overturn when they are repeated."""
    outcomes = [(repeated.outcome, *repeated.outcomes) for repeated in again]
    return {
        "failed": sum(repeated.outcome is None for repeated in again),
        "invalid": sum(Outcome.INVALID in one for one in outcomes),
        "fell": sum(Outcome.OVERTURNED in one for one in outcomes),
    }


def _of_the_deciding(
    limits: LimitsTable, tally: RuleFound, again: Sequence[ConfirmedRun]
) -> Iterator[_Reason]:
    """What the elastic model and the unknown inputs make of the deciding runs."""
    counts = ended(again)
    beyond = sum(
        repeated.turned > limits.single_rotation_ratio or repeated.slipped > limits.slip_m
        for repeated in again
    )
    if counts["failed"]:
        yield _Reason(NOT_SURE, f"{counts['failed']} of {len(again)} {AGAIN} failed.")
    if (bolts := max((repeated.bolt_utilisation or 0.0 for repeated in again), default=0.0)) > 1.0:
        yield _Reason(
            NOT_SURE,
            f"In a deciding run the bolts carry {_above_one(bolts)} times their capacity: the stack does not stay one "
            "body.",
        )
    if counts["invalid"]:
        yield _Reason(NOT_SURE, f"{counts['invalid']} of {len(again)} {AGAIN} can destroy a corner.")
    if counts["fell"]:
        yield _Reason(NOT_SURE, f"{counts['fell']} of {len(again)} {AGAIN} can overturn.")
    elif beyond and not tally.fails(limits):
        yield _Reason(
            NOT_SURE,
            "Deciding runs that go beyond a limit of a single motion, repeated with the elastic model: "
            f"{beyond} of {len(again)}.",
        )


def _of_two_directions(slip: TwoDirections, limit: float) -> Iterator[_Reason]:
    """Whether a body that slides in both directions keeps within the clearance, in the set and its repetitions."""
    low, high = slip.slip_range_m or (slip.slip_largest_m, slip.slip_largest_m)
    if high <= limit:
        return
    place = f"(motion {slip.motion}{_period_and_friction(slip)}; a body that does not rock)."
    clearance = f"the clearance of {SHORT_MILLIMETRES.text(limit)}"
    words = "Under both horizontal components at once the largest slip is"
    if low > limit:
        figures = places_of("slip_m", limit, (slip.slip_largest_m,))
        slid = SHORT_MILLIMETRES.text(slip.slip_largest_m, figures=max(figures, SHORT_MILLIMETRES.figures))
        yield _Reason(NOT_FULFILLED, f"{words} {slid}, beyond {clearance} {place}")
    else:
        slips = span_in_words("slip_m", low, high, places_of("slip_m", limit, (low, high)))
        yield _Reason(
            NOT_SURE, f"{words} {slips} mm in repetitions {ALIKE}: {clearance} lies between {place}"
        )


def _above_one(utilisation: float) -> str:
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
