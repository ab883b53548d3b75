"""The answer to a verification, from its runs: what counts by the rule, what governs, where it first overturns."""

from collections.abc import Iterable, Mapping, Sequence

from fem.batch.intervals import binomial_interval
from fem.results.outcome import Outcome
from fem.runtime.units import MILLIMETRES, RATIO, in_figures
from fem.site_check.file import SiteRequest
from fem.site_check.result import (
    ConfirmedRun,
    FurtherMotions,
    MotionSet,
    ScanPoint,
    SiteAnswer,
    SiteRun,
)
from fem.site_check.rule import RunGroup, groups_of, rule_in_words
from fem.site_check.runs import FURTHER, REFINED, SCAN, SET, RunKey

CONFIDENCE = 0.95


def answer_of(
    request: SiteRequest,
    motions: MotionSet,
    found: Mapping[RunKey, SiteRun],
    confirmed: Sequence[ConfirmedRun] = (),
    *,
    expected: int = 0,
) -> SiteAnswer:
    """The answer, from all runs there are; none while fewer than those expected of the set are there."""
    own = [run for key, run in found.items() if key.stage == SET]
    rule = rule_in_words(motions.count)
    if not motions.valid:
        reasons = "; ".join(motions.reasons)
        return SiteAnswer(
            rule=rule,
            sentence=f"Not valid: the set of motions fails its checks and is not used ({reasons}).",
            overturned=0,
            runs=0,
        )
    if len(own) < expected:
        return SiteAnswer(
            rule=rule,
            sentence=f"No answer yet: {len(own)} of {expected} runs are computed.",
            overturned=sum(run.outcome == Outcome.OVERTURNED for run in own),
            runs=len(own),
        )
    groups, limits = groups_of(own), request.limits
    overturned, failed = sum(one.overturned for one in groups), sum(one.failed for one in groups)
    rotation, slip = (_largest(groups, name) for name in ("rotation_ratio", "slip_m"))
    within = rotation is not None and rotation <= limits.rotation_ratio
    short = slip is not None and slip <= limits.slip_m
    fulfilled = None if failed and not overturned else not overturned and within and short
    return SiteAnswer(
        fulfilled=fulfilled,
        rule=rule,
        sentence=_sentence(request, fulfilled, groups, overturned=overturned, failed=failed),
        overturned=overturned,
        runs=len(own),
        rotation_ratio=rotation,
        slip_m=slip,
        rotation_fulfilled=None if failed and not overturned else not overturned and within,
        slip_fulfilled=None if failed or overturned else short,
        governing=governing_run(request, own),
        factor_at_first_overturning=_first_overturning(found),
        scan=_scan(found),
        further=_further(request, found),
        confirmed=tuple(confirmed),
    )


def governing_run(request: SiteRequest, runs: Sequence[SiteRun]) -> SiteRun | None:
    """The run that decides: one that overturned, else the largest of the group that uses most of a limit."""
    fell = [run for run in runs if run.outcome == Outcome.OVERTURNED]
    if fell:
        counts = {id(run): sum(_same_group(run, other) for other in fell) for run in fell}
        return max(fell, key=lambda run: counts[id(run)])
    known = [group for group in groups_of(runs) if not group.failed]
    if not known:
        return None
    limits = request.limits
    _, name, group = max(
        (
            ((getattr(group, name) or 0.0) / limit, name, group)
            for group in known
            for name, limit in (("rotation_ratio", limits.rotation_ratio), ("slip_m", limits.slip_m))
        ),
        key=lambda one: one[0],
    )
    figure = {"rotation_ratio": "rotation_ratio", "slip_m": "max_slip_m"}[name]
    return max(group.runs, key=lambda run: getattr(run, figure) or 0.0)


def _same_group(one: SiteRun, other: SiteRun) -> bool:
    return len(groups_of((one, other))) == 1


def _largest(groups: Sequence[RunGroup], name: str) -> float | None:
    """The largest figure of all groups; None where one has none: a run overturned or failed."""
    figures = [getattr(group, name) for group in groups]
    return None if not figures or None in figures else max(figures)


def _first_overturning(found: Mapping[RunKey, SiteRun]) -> float | None:
    factors = [
        key.factor
        for key, run in found.items()
        if key.stage in (SET, SCAN, REFINED) and run.outcome == Outcome.OVERTURNED
    ]
    return min(factors, default=None)


def _scan(found: Mapping[RunKey, SiteRun]) -> tuple[ScanPoint, ...]:
    by_factor: dict[float, list[SiteRun]] = {}
    for key, run in found.items():
        if key.stage in (SET, SCAN):
            by_factor.setdefault(key.factor, []).append(run)
    points = []
    for factor in sorted(by_factor):
        groups = groups_of(by_factor[factor])
        points.append(
            ScanPoint(
                factor=factor,
                runs=len(by_factor[factor]),
                overturned=sum(group.overturned for group in groups),
                rotation_ratio=_largest(groups, "rotation_ratio"),
                slip_m=_largest(groups, "slip_m"),
            )
        )
    return tuple(points) if len(points) > 1 else ()


def _further(request: SiteRequest, found: Mapping[RunKey, SiteRun]) -> FurtherMotions | None:
    """Of the further motions, how many overturn the container, with the worse sign."""
    by_motion: dict[int, list[SiteRun]] = {}
    for key, run in found.items():
        if key.stage == FURTHER and run.outcome is not None:
            by_motion.setdefault(key.motion, []).append(run)
    if not by_motion:
        return None
    fell = sum(any(run.outcome == Outcome.OVERTURNED for run in runs) for runs in by_motion.values())
    beyond = sum(any(_beyond(request, run) for run in runs) for runs in by_motion.values())
    return FurtherMotions(
        motions=len(by_motion),
        overturned=fell,
        interval=binomial_interval(fell, len(by_motion), CONFIDENCE),
        not_fulfilled=beyond,
    )


def _beyond(request: SiteRequest, run: SiteRun) -> bool:
    return (
        run.outcome == Outcome.OVERTURNED
        or (run.rotation_ratio or 0.0) > request.limits.rotation_ratio
        or (run.max_slip_m or 0.0) > request.limits.slip_m
    )


def _sentence(
    request: SiteRequest, fulfilled: bool | None, groups: Iterable[RunGroup], *, overturned: int, failed: int
) -> str:
    groups, limits = list(groups), request.limits
    runs = sum(len(group.runs) for group in groups)
    if fulfilled is None:
        return f"No answer: {failed} of {runs} runs failed."
    if overturned:
        return f"Not fulfilled under the rule below: {overturned} of {runs} runs overturned."
    rotation, slip = _largest(groups, "rotation_ratio") or 0.0, _largest(groups, "slip_m") or 0.0
    figures = (
        f"none of {runs} runs overturned; rotation {RATIO.text(rotation)} of the slenderness angle (limit "
        f"{limits.rotation_ratio:g}), slip {_slip_in_words(slip)} (limit {1e3 * limits.slip_m:g} mm)"
    )
    return f"{'Fulfilled' if fulfilled else 'Not fulfilled'} under the rule below: {figures}."


def _slip_in_words(slip: float) -> str:
    return (
        f"below {1e3 * MILLIMETRES.least:g} mm"
        if slip < MILLIMETRES.least
        else f"{in_figures(slip, 3, 1e3)} mm"
    )
