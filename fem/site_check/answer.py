"""The answer to a verification, from its runs: what counts by the rule, what speaks against it, and the margin."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from fem.results.figures import SLIPPED, TURNED
from fem.results.outcome import ENDINGS, Outcome
from fem.runtime.intervals import binomial_interval
from fem.runtime.units import RATIO, SHORT_MILLIMETRES
from fem.site_check import result
from fem.site_check.file import SiteRequest
from fem.site_check.reasons import (
    ALIKE,
    CONFIDENCE,
    NOT_FULFILLED,
    NOT_SURE,
    Evidence,
    Reason,
    above_one,
    places_of,
    span,
)
from fem.site_check.rule import RuleFound, RunGroup, groups_of, rule_in_words
from fem.site_check.runs import FURTHER, REFINED, REPEATED, SCAN, SET, RunKey, runs_by_factor

FULFILLED = "fulfilled"
EARTHQUAKE, WIND = "earthquake", "wind"
NO_FURTHER = "No further motions were asked for: how often such motions overturn it is not known."
#: largest slip [m] under both horizontal components, by motion, period of the building and friction
MotionSlips = Mapping[tuple[int, float | None, float, float], float]
FIGURES = ("rotation_ratio", "rotation_ratio_largest", "slip_m")  #: of the rule, of which the range is given


@dataclass(frozen=True, kw_only=True)
class Beside:
    """What the answer rests on beside the runs of its stages."""

    confirmed: Sequence[result.ConfirmedRun] = ()  #: the deciding runs, repeated
    wind: float | None = None  #: utilisation under wind; None: it was not asked for
    two_directions: result.TwoDirections | None = None  #: None: not asked for, or not known
    slips_of_further: MotionSlips = field(default_factory=dict)  #: empty: not asked for, or not known
    in_plane_only: str = ""  #: why the slip in two directions, which was asked for, is not known, in words
    still: int = 0  #: runs that the rigid bound made superfluous
    moves_at: float | None = None  #: factor on the motions at which a rigid body first uplifts or slips
    left_out: str = ""  #: stages that were not asked for, in words


def answer_of(
    request: SiteRequest,
    motions: result.MotionSet,
    runs: Mapping[RunKey, result.SiteRun],
    beside: Beside | None = None,
) -> result.SiteAnswer:
    """The answer, from all runs and from what is beside them."""
    beside, limits = beside or Beside(), request.limits
    own = [run for key, run in runs.items() if key.stage == SET]
    rule = rule_in_words(motions.count, limits)
    if not motions.valid:
        reasons = "; ".join(motions.reasons)
        return result.SiteAnswer(
            rule=rule,
            sentence=f"Not valid: the set of motions fails its checks and is not used ({reasons}).",
            overturned=0,
            runs=0,
        )
    groups = groups_of(own)
    tally = RuleFound.of(groups)
    span, failed = rule_range(groups, runs)
    evidence = Evidence(
        limits=limits,
        motions=motions.count,
        groups=groups,
        rule=tally,
        range=span,
        repetitions_failed=failed,
        further=further_motions(request, runs, beside.slips_of_further),
        confirmed=beside.confirmed,
    )
    against = list(evidence.reasons())
    slip = beside.two_directions
    if slip is not None:
        against += two_directions_reasons(slip, limits.slip_m)
    if beside.in_plane_only:
        against.append(Reason(NOT_SURE, beside.in_plane_only))
    if not request.motions.further and not beside.left_out:
        against.append(Reason(NOT_SURE, NO_FURTHER))
    if beside.left_out:
        against.append(Reason(NOT_SURE, beside.left_out))
    used = tally.utilisation(limits)
    if used is not None and slip is not None:
        used = max(used, slip.slip_largest_m / limits.slip_m)
    unknown = tally.failed > 0 and not tally.overturned + tally.invalid
    judged = None if unknown else gravest(against)
    actions = [result.ActionAnswer(name=EARTHQUAKE, answer=judged, utilisation=used)]
    if beside.wind is not None:
        withstood = NOT_FULFILLED if beside.wind > 1.0 else FULFILLED
        actions.append(result.ActionAnswer(name=WIND, answer=withstood, utilisation=beside.wind))
        if beside.wind > 1.0:
            words = f"Wind uses {above_one(beside.wind)} times the resistance of the lightest container."
            against.append(Reason(NOT_FULFILLED, words))
    answer = None if unknown else gravest(against)
    against.sort(key=lambda reason: reason.answer != NOT_FULFILLED)
    return result.SiteAnswer(
        answer=answer,
        fulfilled={FULFILLED: True, NOT_FULFILLED: False}.get(answer or ""),
        reasons=tuple(reason.sentence for reason in against),
        rule=rule,
        sentence=_sentence(request, answer, tally, against, slip, runs=len(own)),
        overturned=tally.overturned,
        invalid=tally.invalid,
        runs=len(own),
        still=beside.still,
        **vars(tally.by_rule),
        exceeded=tuple(
            key
            for key in result.FIGURE_OF
            if key in tally.exceeded(limits)
            or (key == "slip_m" and slip is not None and slip.slip_largest_m > limits.slip_m)
        ),
        governing=governing_run(request, own),
        actions=tuple(actions),
        margin_factor=_least(margin_factor(request, runs), slip.margin_factor if slip else None),
        factor_at_first_overturning=_first_overturning(runs),
        factor_at_first_movement=beside.moves_at,
        two_directions=slip,
        rule_range=span,
        scan=_scan(runs),
        failed_between=sum(key.stage == REFINED and run.outcome is None for key, run in runs.items()),
        further=tuple(evidence.further),
        confirmed=tuple(beside.confirmed),
    )


def two_directions_reasons(slip: result.TwoDirections, limit: float) -> Iterator[Reason]:
    """Whether a body that slides in both directions keeps within the clearance, in the set and its repetitions."""
    low, high = slip.slip_range_m or (slip.slip_largest_m, slip.slip_largest_m)
    if high <= limit:
        return
    period = "" if slip.building_period_s is None else f", building {slip.building_period_s:g} s"
    where = (
        f"(motion {slip.motion}{period}, friction {slip.mu_static:.3g}/{slip.mu_kinetic:.3g}; a body that does not "
        "rock)."
    )
    clearance = f"the clearance of {SHORT_MILLIMETRES.text(limit)}"
    words = "Under both horizontal components at once the largest slip is"
    if low > limit:
        figures = places_of("slip_m", limit, (slip.slip_largest_m,))
        slid = SHORT_MILLIMETRES.text(slip.slip_largest_m, figures=max(figures, SHORT_MILLIMETRES.figures))
        yield Reason(NOT_FULFILLED, f"{words} {slid}, beyond {clearance} {where}")
    else:
        places = places_of("slip_m", limit, (low, high))
        slips = span("slip_m", low, high, places)
        yield Reason(NOT_SURE, f"{words} {slips} mm in repetitions {ALIKE}: {clearance} lies between {where}")


def _least(*factors: float | None) -> float | None:
    return min((factor for factor in factors if factor is not None), default=None)


def gravest(reasons: Iterable[Reason]) -> str:
    """The answer that some reasons leave."""
    answers = {reason.answer for reason in reasons}
    return next((answer for answer in (NOT_FULFILLED, NOT_SURE) if answer in answers), FULFILLED)


def no_answer_yet(
    request: SiteRequest, motions: result.MotionSet, own: Sequence[result.SiteRun], missing: str
) -> result.SiteAnswer:
    """What stands in place of the answer of an interrupted verification.

    Args:
        own: the runs of the set that are there.
        missing: what is not, in words.
    """
    return result.SiteAnswer(
        rule=rule_in_words(motions.count, request.limits),
        sentence=f"No answer yet: {missing}.",
        overturned=sum(run.outcome == Outcome.OVERTURNED for run in own),
        invalid=sum(run.outcome == Outcome.INVALID for run in own),
        runs=len(own),
    )


def governing_run(request: SiteRequest, runs: Sequence[result.SiteRun]) -> result.SiteRun | None:
    """The run that decides: one that did not stand, else the largest of the group that uses most of a limit."""
    fell = [run for run in runs if run.outcome in ENDINGS]
    if fell:
        counts = {id(run): sum(len(groups_of((run, other))) == 1 for other in fell) for run in fell}
        return max(fell, key=lambda run: counts[id(run)])
    known = [group for group in groups_of(runs) if not group.failed]
    if not known:
        return None
    _, figure, group = max(
        (
            ((group.by_rule[name] or 0.0) / getattr(request.limits, limit.key), limit.of, group)
            for group in known
            for name, limit in result.LIMITS.items()
        ),
        key=lambda use: use[0],
    )
    return max(group.runs, key=lambda run: run[figure] or 0.0)


def rule_range(
    groups: Sequence[RunGroup], runs: Mapping[RunKey, result.SiteRun]
) -> tuple[result.RuleRange | None, int]:
    """The rule over the set and its repetitions, and how many of their runs failed; None: there are no repetitions.

    In each repetition the groups that were run again replace those of the set.
    """
    again: dict[float, list[result.SiteRun]] = {}
    for key, run in runs.items():
        if key.stage == REPEATED:
            again.setdefault(key.factor, []).append(run)
    if not again:
        return None, 0
    tallies = [RuleFound.of(groups)]
    for rerun in again.values():
        repeated = {group.key: group for group in groups_of(rerun)}
        tallies.append(RuleFound.of([repeated.get(group.key, group) for group in groups]))
    ranges = {}
    for name in FIGURES:
        known = [tally.by_rule[name] for tally in tallies if tally.by_rule[name] is not None]
        ranges[name] = (min(known), max(known)) if known else ()
    repetitions = tallies[1:]
    span = result.RuleRange(
        **ranges,
        repetitions=len(repetitions),
        overturned=sum(repetition.overturned + repetition.invalid > 0 for repetition in repetitions),
    )
    return span, sum(run.outcome is None for rerun in again.values() for run in rerun)


def further_motions(
    request: SiteRequest, runs: Mapping[RunKey, result.SiteRun], slips: MotionSlips
) -> tuple[result.FurtherMotions, ...]:
    """Of the further motions, how many overturn each container, or go beyond a limit, with the worse sign.

    Args:
        slips: under both horizontal components.
    """
    limits = request.limits
    counted = []
    for group in groups_of(run for key, run in runs.items() if key.stage == FURTHER):
        failed = {run.motion for run in group.runs if run.outcome is None}
        known = RunGroup(runs=tuple(run for run in group.runs if run.motion not in failed))
        fell = len(known.beyond_any({}))
        first = group.first
        pair = first.building_period_s, first.mu_static, first.mu_kinetic
        slid = {
            motion: slips[motion, *pair]
            for motion in {run.motion for run in known.runs}
            if (motion, *pair) in slips
        }
        beyond = known.beyond_any({TURNED: limits.single_rotation_ratio, SLIPPED: limits.slip_m})
        too_far = {motion for motion, slip in slid.items() if slip > limits.slip_m}
        counted.append(
            result.FurtherMotions(
                mass=first.mass,
                elevation=first.elevation,
                building_period_s=first.building_period_s,
                mu_static=first.mu_static,
                mu_kinetic=first.mu_kinetic,
                motions=known.motions,
                overturned=len({run.motion for run in known.runs if run.outcome == Outcome.OVERTURNED}),
                invalid=len({run.motion for run in known.runs if run.outcome == Outcome.INVALID}),
                beyond_limits=len(beyond | too_far),
                slip_largest_m=max(slid.values(), default=None),
                slid_too_far=len(too_far),
                interval=binomial_interval(fell, known.motions, CONFIDENCE) if known.motions else (),
                failed=len(failed),
            )
        )
    return tuple(counted)


def margin_factor(request: SiteRequest, runs: Mapping[RunKey, result.SiteRun]) -> float | None:
    """The least factor on the motions, of those tried, at which the rule fails; None: it fails at none."""
    by_factor = runs_by_factor(runs, SET, SCAN, REFINED)
    whole = max((len(group.runs) for group in groups_of(by_factor.get(1.0, ()))), default=0)

    def fails(factor: float) -> bool:
        # Between factors some runs of a group may be there alone: they have no mean.
        return any(
            group.overturned + group.invalid
            or (len(group.runs) == whole and RuleFound.of([group]).fails(request.limits))
            for group in groups_of(by_factor[factor])
        )

    return min((factor for factor in by_factor if fails(factor)), default=None)


def _first_overturning(runs: Mapping[RunKey, result.SiteRun]) -> float | None:
    factors = [
        key.factor
        for key, run in runs.items()
        if key.stage in (SET, SCAN, REFINED) and run.outcome == Outcome.OVERTURNED
    ]
    return min(factors, default=None)


def _scan(runs: Mapping[RunKey, result.SiteRun]) -> tuple[result.ScanPoint, ...]:
    by_factor = runs_by_factor(runs, SET, SCAN)
    points = []
    for factor, own in by_factor.items():
        tally = RuleFound.of(groups_of(own))
        points.append(
            result.ScanPoint(
                factor=factor,
                runs=len(own),
                overturned=tally.overturned,
                invalid=tally.invalid,
                failed=tally.failed,
                **vars(tally.by_rule),
            )
        )
    return tuple(points) if len(points) > 1 else ()


def _sentence(
    request: SiteRequest,
    answer: str | None,
    tally: RuleFound,
    against: Sequence[Reason],
    slip: result.TwoDirections | None,
    *,
    runs: int,
) -> str:
    """The answer in words: what it rests on, or what speaks against it."""
    if answer is None:
        return f"No answer: {tally.failed} of {runs} runs failed."
    if answer != FULFILLED:
        gravest_ones = [reason.sentence for reason in against if reason.answer == answer]
        return f"{answer.capitalize()}. {' '.join(gravest_ones)}"
    limits, figures = request.limits, tally.by_rule
    furthest = max(figures.slip_m or 0.0, slip.slip_largest_m if slip else 0.0)
    return (
        f"Fulfilled under the rule below: none of {runs} runs overturned; rotation "
        f"{RATIO.text(figures.rotation_ratio)} of the slenderness angle (limit {limits.rotation_ratio:g}), of a single "
        f"motion {RATIO.text(figures.rotation_ratio_largest)} (limit {limits.single_rotation_ratio:g}), largest slip "
        f"{_slip_in_words(furthest)} (limit {1e3 * limits.slip_m:g} mm)."
    )


def _slip_in_words(slip: float) -> str:
    least = SHORT_MILLIMETRES.least
    return f"below {1e3 * least:g} mm" if slip < least else SHORT_MILLIMETRES.text(slip)
