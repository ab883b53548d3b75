"""How often a year: the hazard of a site, and what the container does at levels of the motion.

Each level has artificial motions of its own, as strong as the target at that level. Recorded motions of one strength
scatter about their median: the hazard of what acts is that of the site spread by this scatter, so that the counts need
no draws of it. Below the level at which a rigid body first moves nothing happens.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from fem.model.resting import KEPT, BodyAtRest
from fem.results.outcome import ENDINGS
from fem.runtime.intervals import binomial_interval
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.hazard import ACCELERATION, YEARS, CountedRate, HazardCurve, counted_rate, probability_in
from fem.seismic.two_directions import largest_slip
from fem.site_check.file import SiteRequest
from fem.site_check.reasons import CONFIDENCE
from fem.site_check.result import AnnualRates, HazardLevel, SiteBody, SiteRun, TwoDirections
from fem.site_check.rule import RunGroup
from fem.site_check.runs import HAZARD, SET, RunKey, key_of
from fem.site_check.screening import moves_at
from fem.study.fragility import fit_lognormal

LEVELS = 7
#: as `KEPT`, on a floor that gives way, where a container rocks before a side would lift off a rigid one: under the
#: motions of the shipped site the stack of four turns on compacted gravel by at most 0.006 of its slenderness angle at
#: 0.4 of that, 0.19 at 0.5 and 0.51 at 0.9, and on asphalt, which does not, by 0.0004 at 0.9
KEPT_ON_SOFT = 0.4
#: of the levels, weakest and strongest, over the factor at which a rigid body first rocks
SPAN = (1.15, 5.5)
#: of the hazard of what acts: points a decade, and how far they reach beyond the levels
POINTS, REACH = 60, 20.0


def rocks_from(body: SiteBody, motions: Sequence[GroundMotion]) -> float:
    """The factor on some motions below which none of them lets a body rock."""
    slenderness = math.tan(body.slenderness_angle_rad)
    resting = BodyAtRest(gravity=body.gravity_m_s2, slenderness=slenderness, slope=0.0)
    kept = KEPT_ON_SOFT if body.gives_way else KEPT
    return kept * min(moves_at(resting, motion, sign, math.inf) for motion in motions for sign in (1, -1))


def slides_from(body: SiteBody, mu_static: float, motions: Sequence[GroundMotion]) -> float:
    """The factor on some motions below which none of them slides a body in any direction."""
    strongest = 0.0
    for motion in motions:
        along = motion.horizontal if motion.second is None else np.hypot(motion.horizontal, motion.second)
        lift = 0.0 if motion.vertical is None else np.abs(motion.vertical)
        strongest = max(strongest, float(np.max(along + mu_static * lift)))
    return KEPT * mu_static * body.gravity_m_s2 / strongest if strongest > 0.0 else math.inf


def hazard_motions(request: SiteRequest) -> int:
    """Motions of all levels, each of which is one run; none where no hazard is given."""
    return LEVELS * request.hazard.motions if request.hazard else 0


def hazard_runs(
    groups: Sequence[RunGroup], bodies: Sequence[SiteBody], floor: Sequence[GroundMotion], motions: int
) -> list[RunKey]:
    """Runs at every level with motions of their own, for the container and friction that rock most in the set.

    Args:
        groups: of the set; bodies: of all containers; floor: motions of the set on the floor of that group's building.
        motions: at each level, half of them with the vertical reversed.
    """
    first = rocking_most(groups, bodies).first
    body = _body_of(bodies, first)
    begin = rocks_from(body, floor) / KEPT  # below the first uplift on a floor that gives way
    signs = (1, -1) if first.vertical_sign else (0,)
    return [
        key_of(first)._replace(
            stage=HAZARD,
            motion=level * motions + k + 1,
            vertical_sign=signs[k % len(signs)],
            factor=float(f"{begin * share:.6g}"),
        )
        for level, share in enumerate(np.geomspace(*SPAN, LEVELS).tolist())
        for k in range(motions)
    ]


def _body_of(bodies: Sequence[SiteBody], run: SiteRun) -> SiteBody:
    return next(body for body in bodies if (body.mass, body.elevation) == (run.mass, run.elevation))


def rocking_most(groups: Sequence[RunGroup], bodies: Sequence[SiteBody]) -> RunGroup:
    """The group in which most runs do not stand, then of the largest rotation.

    Where nothing rocks, that of the most slender body with the highest friction.
    """

    def rocking(group: RunGroup) -> tuple[float, ...]:
        first = group.first
        fell, turned = group.overturned + group.invalid, max(run.turned for run in group.runs)
        slender = -_body_of(bodies, first).slenderness_angle_rad
        return fell, turned, slender, first.mu_static, first.mu_kinetic

    return max(groups, key=rocking)


def annual_rates(
    request: SiteRequest,
    runs: Mapping[RunKey, SiteRun],
    made: Mapping[str, GroundMotion],
    bodies: Sequence[SiteBody],
    slid: TwoDirections | None,
    peak_velocity: float,
) -> AnnualRates | None:
    """Rates per year of overturning, and of slip beyond the limit; None: no hazard was given, or no run is there.

    Args:
        runs: all of them; made: motions by the stems of their files.
        bodies: of all containers.
        peak_velocity: mean of the motions of the set on the ground [m/s].
        slid: slip in two directions of the set, whose friction is taken for that of the levels; None: that of the
            largest slip of its runs.
    """
    hazard = request.hazard_curve
    own = {key: run for key, run in runs.items() if key.stage == HAZARD}
    if hazard is None or all(run.outcome is None for run in own.values()):
        return None
    body = _body_of(bodies, next(iter(own.values())))
    limit, gravity = request.limits.slip_m, request.container.gravity_m_s2
    first = next(iter(own))
    stood = [run for key, run in runs.items() if key.stage == SET and run.outcome not in (*ENDINGS, None)]
    furthest = slid or max(stood, key=lambda run: run.slipped, default=first)
    pair = furthest.mu_static, furthest.mu_kinetic
    sloping = bool(request.container.floor.slope_percent)

    def too_far(key: RunKey, run: SiteRun) -> bool:
        if sloping or run.slipped > limit:  # a body without a preferred direction would also creep downhill
            return run.slipped > limit
        return largest_slip(made[key.stem].scaled(key.factor), pair, gravity=gravity) > limit

    # the strength of the site's own motions, in the unit of the hazard
    action = request.action
    unit = action.ground_acceleration / action.topographic_factor
    if hazard.measure != ACCELERATION:
        unit = peak_velocity
    levels = []
    for factor in sorted({key.factor for key in own}):
        every = {key: run for key, run in own.items() if key.factor == factor}
        there = {key: run for key, run in every.items() if run.outcome is not None}
        levels.append(
            HazardLevel(
                strength=factor * unit,
                factor=factor,
                motions=len(there),
                overturned=sum(run.outcome in ENDINGS for run in there.values()),
                slipped=sum(too_far(key, run) for key, run in there.items()),
                failed=len(every) - len(there),
            )
        )
    motions = [made[key.stem] for key in own]
    acting = scattered(hazard, request.motions.scatter, [level.strength for level in levels])
    falls = _rate(acting, levels, [level.overturned for level in levels], unit * rocks_from(body, motions))
    slips = _rate(
        acting, levels, [level.slipped for level in levels], unit * slides_from(body, pair[0], motions)
    )
    parts = iter(falls.parts)  # of the levels that have counts
    levels = [
        replace(
            level,
            rate_per_year=hazard.rate(level.strength),
            interval=binomial_interval(level.overturned, level.motions, CONFIDENCE) if level.motions else (),
            overturning_per_year=next(parts) if level.motions else 0.0,
        )
        for level in levels
    ]
    counts = [(level.strength, level.overturned, level.motions) for level in levels if level.motions]
    fit = fit_lognormal(*np.array(counts, dtype=float).T)
    beta = None if fit is None else math.hypot(fit.deviation, request.motions.scatter)
    return AnnualRates(
        mass=first.mass,
        elevation=first.elevation,
        building_period_s=first.building_period_s,
        mu_static=first.mu_static,
        mu_kinetic=first.mu_kinetic,
        scatter=request.motions.scatter,
        measure=hazard.measure,
        strengths=tuple(hazard.strengths.tolist()),
        rates_per_year=tuple(hazard.rates.tolist()),
        levels=tuple(levels),
        overturning_per_year=falls.rate,
        beyond_per_year=falls.parts[-1],
        interval=(falls.low, falls.high),
        in_50_years=probability_in(YEARS, falls.rate),
        most_from=falls.most_from[0] if falls.share else None,
        most_to=falls.most_from[1] if falls.share and math.isfinite(falls.most_from[1]) else None,
        share=falls.share,
        slip_per_year=None if sloping else slips.rate,
        slip_interval=() if sloping else (slips.low, slips.high),
        median=None if fit is None else fit.median,
        beta=beta,
        fit_per_year=None if fit is None or beta is None else hazard.lognormal(fit.median, beta),
        closed_form_per_year=None if fit is None or beta is None else closed_form(hazard, fit.median, beta),
    )


def scattered(hazard: HazardCurve, scatter: float, levels: Sequence[float]) -> HazardCurve:
    """The hazard of what acts: motions of one strength in the hazard scatter about it, lognormally.

    The rate at which s is exceeded is that of an event whose probability is 1/2 at s, with the scatter as its beta.
    """
    if scatter == 0.0:
        return hazard
    ends = levels[0] / REACH, levels[-1] * REACH
    strengths = np.geomspace(*ends, math.ceil(POINTS * math.log10(ends[1] / ends[0])))
    rates = [hazard.lognormal(strength, scatter) for strength in strengths.tolist()]
    return HazardCurve(strengths=strengths, rates=np.array(rates))


def closed_form(hazard: HazardCurve, median: float, beta: float) -> float:
    """H(median) exp(k^2 beta^2/2) with the exponent of the hazard at the median [1/year] (EN 1998-1:2004, 2.1 (4))."""
    exponent = -math.log(hazard.rate(1.01 * median) / hazard.rate(median)) / math.log(1.01)
    return hazard.rate(median) * math.exp(0.5 * (exponent * beta) ** 2)


def _rate(
    hazard: HazardCurve, levels: Sequence[HazardLevel], events: Sequence[int], never_below: float
) -> CountedRate:
    """The rate by counts; failed runs count into its upper end alone, as if the event happened in each."""

    def counted(failed: Sequence[int]) -> CountedRate:
        rows = [
            (level.strength, happened + more, level.motions + more)
            for level, happened, more in zip(levels, events, failed, strict=True)
            if level.motions + more
        ]
        strengths, counts, motions = zip(*rows, strict=True)
        return counted_rate(
            hazard, strengths, counts, motions, never_below=min(never_below, 0.99 * strengths[0])
        )

    rate = counted([0] * len(levels))
    failed = [level.failed for level in levels]
    return replace(rate, high=counted(failed).high) if any(failed) else rate
