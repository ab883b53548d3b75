"""The answer to a verification, from its runs: what counts by the rule, what governs, where it first overturns."""

from collections.abc import Iterable, Mapping, Sequence

from fem.results.outcome import Outcome
from fem.runtime.intervals import binomial_interval
from fem.runtime.units import RATIO, SHORT_MILLIMETRES
from fem.site_check import result
from fem.site_check.file import SiteRequest
from fem.site_check.rule import RunGroup, groups_of, rule_in_words
from fem.site_check.runs import FURTHER, REFINED, SCAN, SET, RunKey

CONFIDENCE = 0.95


def answer_of(
    request: SiteRequest,
    motions: result.MotionSet,
    runs: Mapping[RunKey, result.SiteRun],
    confirmed: Sequence[result.ConfirmedRun] = (),
) -> result.SiteAnswer:
    """The answer, from all runs."""
    own = [run for key, run in runs.items() if key.stage == SET]
    rule = rule_in_words(motions.count)
    if not motions.valid:
        reasons = "; ".join(motions.reasons)
        return result.SiteAnswer(
            rule=rule,
            sentence=f"Not valid: the set of motions fails its checks and is not used ({reasons}).",
            overturned=0,
            runs=0,
        )
    groups, limits = groups_of(own), request.limits
    overturned, failed = sum(one.overturned for one in groups), sum(one.failed for one in groups)
    found_by_rule = _largest(groups)
    within, short = (
        found_by_rule[name] is not None and found_by_rule[name] <= getattr(limits, name)
        for name in result.LIMITED
    )
    fulfilled = None if failed and not overturned else not overturned and within and short
    return result.SiteAnswer(
        answer={None: None, True: "fulfilled", False: "not fulfilled"}[fulfilled],
        fulfilled=fulfilled,
        rule=rule,
        sentence=_sentence(request, fulfilled, groups, overturned=overturned, failed=failed),
        overturned=overturned,
        runs=len(own),
        **vars(found_by_rule),
        rotation_fulfilled=None if failed and not overturned else not overturned and within,
        slip_fulfilled=None if failed or overturned else short,
        governing=governing_run(request, own),
        factor_at_first_overturning=_first_overturning(runs),
        scan=_scan(runs),
        further=_further(request, runs),
        confirmed=tuple(confirmed),
    )


def no_answer_yet(
    motions: result.MotionSet, own: Sequence[result.SiteRun], missing: str
) -> result.SiteAnswer:
    """What stands in place of the answer of an interrupted verification.

    Args:
        own: the runs of the set that are there.
        missing: what is not, in words.
    """
    return result.SiteAnswer(
        rule=rule_in_words(motions.count),
        sentence=f"No answer yet: {missing}.",
        overturned=sum(run.outcome == Outcome.OVERTURNED for run in own),
        runs=len(own),
    )


def governing_run(request: SiteRequest, runs: Sequence[result.SiteRun]) -> result.SiteRun | None:
    """The run that decides: one that overturned, else the largest of the group that uses most of a limit."""
    fell = [run for run in runs if run.outcome == Outcome.OVERTURNED]
    if fell:
        counts = {id(run): sum(len(groups_of((run, other))) == 1 for other in fell) for run in fell}
        return max(fell, key=lambda run: counts[id(run)])
    known = [group for group in groups_of(runs) if not group.failed]
    if not known:
        return None
    _, name, group = max(
        (
            ((group.by_rule[name] or 0.0) / getattr(request.limits, name), name, group)
            for group in known
            for name in result.LIMITED
        ),
        key=lambda one: one[0],
    )
    return max(group.runs, key=lambda run: run[result.LIMITED[name]] or 0.0)


def _largest(groups: Iterable[RunGroup]) -> result.ByRule:
    """The largest figures of all groups; None where one has none."""
    figures = {name: [group.by_rule[name] for group in groups] for name in result.LIMITED}
    return result.ByRule(
        **{name: None if None in some else max(some, default=None) for name, some in figures.items()}
    )


def _first_overturning(runs: Mapping[RunKey, result.SiteRun]) -> float | None:
    factors = [
        key.factor
        for key, run in runs.items()
        if key.stage in (SET, SCAN, REFINED) and run.outcome == Outcome.OVERTURNED
    ]
    return min(factors, default=None)


def _scan(runs: Mapping[RunKey, result.SiteRun]) -> tuple[result.ScanPoint, ...]:
    by_factor: dict[float, list[result.SiteRun]] = {}
    for key, run in runs.items():
        if key.stage in (SET, SCAN):
            by_factor.setdefault(key.factor, []).append(run)
    points = []
    for factor in sorted(by_factor):
        groups = groups_of(by_factor[factor])
        points.append(
            result.ScanPoint(
                factor=factor,
                runs=len(by_factor[factor]),
                overturned=sum(group.overturned for group in groups),
                **vars(_largest(groups)),
            )
        )
    return tuple(points) if len(points) > 1 else ()


def _further(request: SiteRequest, found: Mapping[RunKey, result.SiteRun]) -> result.FurtherMotions | None:
    """Of the further motions, how many overturn the container, with the worse sign."""
    by_motion: dict[int, list[result.SiteRun]] = {}
    for key, run in found.items():
        if key.stage == FURTHER and run.outcome is not None:
            by_motion.setdefault(key.motion, []).append(run)
    if not by_motion:
        return None
    fell = sum(any(run.outcome == Outcome.OVERTURNED for run in runs) for runs in by_motion.values())
    beyond = sum(any(_beyond(request, run) for run in runs) for runs in by_motion.values())
    return result.FurtherMotions(
        motions=len(by_motion),
        overturned=fell,
        interval=binomial_interval(fell, len(by_motion), CONFIDENCE),
        not_fulfilled=beyond,
    )


def _beyond(request: SiteRequest, run: result.SiteRun) -> bool:
    limited = ((run[figure] or 0.0, getattr(request.limits, name)) for name, figure in result.LIMITED.items())
    return run.outcome == Outcome.OVERTURNED or any(value > limit for value, limit in limited)


def _sentence(
    request: SiteRequest, fulfilled: bool | None, groups: Iterable[RunGroup], *, overturned: int, failed: int
) -> str:
    groups, limits = list(groups), request.limits
    runs = sum(len(group.runs) for group in groups)
    if fulfilled is None:
        return f"No answer: {failed} of {runs} runs failed."
    if overturned:
        return f"Not fulfilled under the rule below: {overturned} of {runs} runs overturned."
    rotation, slip = (_largest(groups)[name] or 0.0 for name in result.LIMITED)
    figures = (
        f"none of {runs} runs overturned; rotation {RATIO.text(rotation)} of the slenderness angle (limit "
        f"{limits.rotation_ratio:g}), slip {_slip_in_words(slip)} (limit {1e3 * limits.slip_m:g} mm)"
    )
    return f"{'Fulfilled' if fulfilled else 'Not fulfilled'} under the rule below: {figures}."


def _slip_in_words(slip: float) -> str:
    least = SHORT_MILLIMETRES.least
    return f"below {1e3 * least:g} mm" if slip < least else SHORT_MILLIMETRES.text(slip)
