"""The fragility curve: probability of overturning over the strength of the motion, and a lognormal fit.

p(a) = Phi(ln(a/median)/deviation), by maximum binomial likelihood of the counts: probit regression on ln a.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.special import bdtr, ndtr

from fem.results.figures import SLIPPED
from fem.results.json_block import JsonBlock
from fem.results.outcome import COUNTED, NOT_STANDING, Ending, counts_of
from fem.runtime.arrays import FloatArray
from fem.runtime.intervals import estimate
from fem.study.axes import Axis, AxisResult
from fem.study.design import Ensemble
from fem.study.driver import StudyResult
from fem.study.table import Columns


@dataclass(frozen=True, kw_only=True)
class Fall(JsonBlock):
    """A stronger motion that overturns less often than a weaker one, beyond what the intervals allow."""

    weaker: float
    stronger: float
    probability_weaker: float
    probability_stronger: float


@dataclass(frozen=True, kw_only=True)
class Resampled(JsonBlock):
    """The curves of the resamples."""

    median: tuple[float, ...]
    deviation: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class FittedLognormal(JsonBlock):
    """The fitted curve, and how well it describes the counts."""

    median: float
    deviation: float
    levels: int
    levels_missed: int
    missed_by_chance: int
    adequate: bool
    median_interval: tuple[float, ...] | None = None  #: None where too few resamples have a curve
    deviation_interval: tuple[float, ...] | None = None
    resampled: Resampled | None = None

    written_where_given = frozenset({"resampled"})


@dataclass(frozen=True, kw_only=True)
class Fragility(JsonBlock):
    """What the only axis of an ensemble shows."""

    axis: str  #: its key
    falls: tuple[Fall, ...]
    lognormal: FittedLognormal | None = None
    no_lognormal: str | None = None  #: why there is none

    written_where_given = frozenset({"no_lognormal"})


@dataclass(frozen=True, kw_only=True)
class EnsembleResult(StudyResult):
    """All results of an ensemble."""

    asked: str  #: hash of the request
    ensemble: str = ""  #: its name
    title: str = ""
    case: str = ""  #: name of the base case
    model: str = ""
    duration_s: float | str = "auto"
    motion_covered: str | None = None  #: the part of the motion that the runs cover, where they end before it
    draws: int = 0  #: at each point
    seed: int = 0
    sampling: str = ""
    replicates: int = 1
    confidence: float
    probability: float
    unknown_inputs: str = ""
    #: beyond which a draw does not stand, and counts as one that overturned
    limit_slip_m: float | None = None
    axes: tuple[AxisResult, ...]
    random: dict[str, Any]  #: what is drawn, by key
    derived: dict[str, str] = field(default_factory=dict)
    drawn_over_uncertainty: tuple[str, ...] = ()
    held: str = ""
    motions: tuple[dict[str, Any], ...] | None = None  #: measures and counts of each motion of a set
    motion_figures: tuple[str, ...] = ()
    points: tuple[Mapping[str, Any], ...] = ()  #: by the keys of the axes and `statistics.POINT_COLUMNS`
    regions: dict[str, int] = field(default_factory=dict)
    failed: int = 0
    fragility: Fragility | None = None

    @property
    def point_axes(self) -> tuple[Axis, ...]:
        """The axes, to name places on them."""
        return tuple(axis.axis for axis in self.axes)


BOOTSTRAPS = 1000
SCORINGS = 60  #: of Fisher's method
TIGHT = 1e-9  #: change of the coefficients at convergence
STEEPEST = 200.0  #: 1/deviation beyond which the counts are a step
TAIL = 8.0  #: deviations from the median at which the tails are cut


@dataclass(frozen=True, kw_only=True)
class Lognormal:
    """A fitted fragility curve."""

    median: float  #: strength of motion at which half overturn, unit of the axis
    deviation: float  #: of its logarithm

    def probability(self, strengths: FloatArray) -> FloatArray:
        """Of overturning, shape as given."""
        return np.asarray(ndtr(np.log(strengths / self.median) / self.deviation))


def fit_lognormal(strengths: FloatArray, overturned: FloatArray, draws: FloatArray) -> Lognormal | None:
    """The lognormal curve of largest likelihood; None where there is none (a step, no events, a falling curve).

    Args:
        strengths: (n,) positive; overturned: (n,) counts; draws: (n,) of which.
    """
    slopes, intercepts, sound = _probit(np.log(strengths), overturned[None], draws)
    if not sound[0]:
        return None
    return Lognormal(median=float(np.exp(-intercepts[0] / slopes[0])), deviation=float(1.0 / slopes[0]))


def bootstrap_fits(
    strengths: FloatArray,
    counts: FloatArray,
    sizes: FloatArray,
    *,
    seed: int,
    independent: bool,
    common: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Medians and deviations of curves fitted to resampled counts, shape (k,), k the resamples that have a fit.

    Independent draws are resampled draw by draw, replicates as a whole.

    Args:
        strengths: (n,); counts: (n, r) overturned in each replicate; sizes: (n, r) draws that have an outcome.
        seed: of the resampling.
        independent: each replicate's draws are independent of one another.
        common: a replicate is the same motion at every strength, so that all strengths are resampled alike.
    """
    generator = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(2**32 - 1,)))
    totals = sizes.sum(axis=1)
    if independent:
        shares = np.divide(counts.sum(axis=1), totals, out=np.zeros(len(totals)), where=totals > 0.0)
        drawn = generator.binomial(totals.astype(int), shares, size=(BOOTSTRAPS, len(totals))).astype(float)
    else:
        levels_resampled = 1 if common else counts.shape[0]
        picked = generator.integers(counts.shape[1], size=(BOOTSTRAPS, levels_resampled, counts.shape[1]))
        levels = np.arange(len(totals))[:, None]
        # Replicates lack the draws that failed; a resampled one counts as if it lacked the average number.
        share = np.divide(counts, sizes, out=np.zeros_like(counts), where=sizes > 0.0)
        drawn = share[levels, picked].mean(axis=2) * totals
    slopes, intercepts, sound = _probit(np.log(strengths), drawn, totals)
    return np.exp(-intercepts[sound] / slopes[sound]), 1.0 / slopes[sound]


def falls(strengths: FloatArray, values: FloatArray, low: FloatArray, high: FloatArray) -> list[Fall]:
    """Where the curve falls: for each level, the weaker one whose interval lies highest above its own."""
    drops = []
    for k in range(1, len(strengths)):
        before = int(np.argmax(low[:k]))
        if high[k] < low[before]:
            drops.append(
                Fall(
                    weaker=float(strengths[before]),
                    stronger=float(strengths[k]),
                    probability_weaker=float(values[before]),
                    probability_stronger=float(values[k]),
                )
            )
    return drops


def misses(curve: Lognormal, strengths: FloatArray, low: FloatArray, high: FloatArray) -> int:
    """Levels whose interval does not hold the curve."""
    fitted = curve.probability(strengths)
    return int(np.sum((fitted < low) | (fitted > high)))


def misses_by_chance(levels: int, confidence: float) -> int:
    """Levels that miss a true curve, at most, in nineteen of twenty such studies."""
    # not from `scipy.stats`, whose import takes as long as twenty runs of a site
    return int(np.argmax(bdtr(np.arange(levels + 1), levels, 1.0 - confidence) >= 0.95))


def _probit(
    logarithms: FloatArray, overturned: FloatArray, draws: FloatArray
) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Probit regressions p = Phi(intercept + slope x) side by side, by Fisher's scoring.

    Args:
        logarithms: (n,); overturned: (k, n); draws: (n,).

    Returns:
        Slopes (k,), intercepts (k,), and which of them are sound: converged, rising, and no step.
    """
    middle = float(np.average(logarithms, weights=np.maximum(draws, 1e-9)))
    x = logarithms - middle
    share = (overturned + 0.5) / (draws + 1.0)
    count = len(overturned)
    slope, intercept = np.full(count, 1.0 / max(float(np.std(x)), 1e-9)), np.zeros(count)
    intercept += np.clip((share.mean(axis=1) - 0.5) * 2.0, -1.0, 1.0)
    converged = np.zeros(count, dtype=bool)
    for _ in range(SCORINGS):
        z = np.clip(intercept[:, None] + slope[:, None] * x, -TAIL, TAIL)
        density = np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi)
        p = ndtr(z)
        spread = np.maximum(p * ndtr(-z), 1e-300)
        weight = draws * density**2 / spread
        score = density * (overturned - draws * p) / spread
        a, b, c = weight.sum(axis=1), (weight * x).sum(axis=1), (weight * x * x).sum(axis=1)
        first, second = score.sum(axis=1), (score * x).sum(axis=1)
        determinant = np.maximum(a * c - b * b, 1e-300)
        change = np.array([(c * first - b * second) / determinant, (a * second - b * first) / determinant])
        change = np.clip(change, -0.5 * (1.0 + np.abs(slope)), 0.5 * (1.0 + np.abs(slope)))
        intercept, slope = intercept + change[0], slope + change[1]
        converged = np.abs(change).max(axis=0) < TIGHT * (1.0 + np.abs(slope))
        if converged.all():
            break
    sound = converged & (slope > 1e-3) & (slope < STEEPEST)
    return slope, intercept - slope * middle, sound


#: columns of `points.csv` behind those of the axes
POINT_COLUMNS: Columns = dict.fromkeys(("draws", *COUNTED), int)
POINT_COLUMNS |= dict.fromkeys(("probability", "low", "high"), float) | {"region": str, SLIPPED: float}
PointRow = dict[str, Any]  #: of a point, by the keys of the axes and these columns
FEWEST_FITTED = 4  #: levels from which a curve is fitted
NO_CURVE = "the counts are a step, fall, or hold nothing that overturned or nothing that stood"
FEWEST_RESAMPLED = 0.9  #: share of the resamples that must have a curve, else there is no band


def count_point(
    ensemble: Ensemble, cell: int, codes: np.ndarray, slips: FloatArray | None = None
) -> PointRow:
    """A point from the endings (draws,) of its draws, and their slips [m], nan for none."""
    share = estimate(
        np.isin(codes, NOT_STANDING),
        codes == Ending.FAILED,
        replicates=ensemble.replicates,
        confidence=ensemble.confidence,
        independent=None if ensemble.motions is None else ensemble.replicates,
    )
    region = "undecided"
    if share.high <= ensemble.probability:
        region = "below"
    elif share.low > ensemble.probability:
        region = "above"
    slid = () if slips is None else slips[(codes == Ending.STANDING) & np.isfinite(slips)]
    return (
        ensemble.point(cell)
        | {"draws": codes.size}
        | counts_of(codes)
        | {"probability": share.value, "low": share.low, "high": share.high, "region": region}
        | {SLIPPED: max(map(float, slid), default=None)}
    )


def fragility_of(ensemble: Ensemble, codes: np.ndarray, points: Sequence[PointRow]) -> Fragility | None:
    """The curve over the only axis: where it falls, the fitted lognormal, its band; None with more axes.

    Args:
        codes: (points, draws).
    """
    if len(ensemble.axes) != 1:
        return None
    strengths = np.array(ensemble.axes[0].values, dtype=float)
    low, high, values = (
        np.array([point[name] for point in points], dtype=float) for name in ("low", "high", "probability")
    )
    known = np.isfinite(values)
    fallen = falls(strengths[known], values[known], low[known], high[known])
    fragility = Fragility(axis=ensemble.axes[0].key, falls=tuple(fallen))
    if strengths[0] <= 0.0:
        return replace(fragility, no_lognormal="the axis goes through zero")
    if known.sum() < FEWEST_FITTED:
        return replace(fragility, no_lognormal=f"fewer than {FEWEST_FITTED} levels")
    # what does not stand, and draws with an outcome, in each replicate: (points, replicates)
    blocks = codes[known].reshape(int(known.sum()), ensemble.replicates, -1)
    counts = np.isin(blocks, NOT_STANDING).sum(axis=2).astype(float)
    sizes = (blocks != Ending.FAILED).sum(axis=2).astype(float)
    fitted = _lognormal(ensemble, strengths[known], counts, sizes, low[known], high[known])
    return replace(fragility, lognormal=fitted, no_lognormal=None if fitted else NO_CURVE)


def _lognormal(
    ensemble: Ensemble,
    strengths: FloatArray,
    counts: FloatArray,
    sizes: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FittedLognormal | None:
    curve = fit_lognormal(strengths, counts.sum(axis=1), sizes.sum(axis=1))
    if curve is None:
        return None
    medians, deviations = bootstrap_fits(
        strengths,
        counts,
        sizes,
        seed=ensemble.seed,
        independent=ensemble.replicates == 1,
        common=ensemble.motions is not None,
    )
    missed, by_chance = (
        misses(curve, strengths, low, high),
        misses_by_chance(len(strengths), ensemble.confidence),
    )
    fitted = FittedLognormal(
        median=curve.median,
        deviation=curve.deviation,
        levels=len(strengths),
        levels_missed=missed,
        missed_by_chance=by_chance,
        adequate=missed <= by_chance,
    )
    if len(medians) < FEWEST_RESAMPLED * BOOTSTRAPS:
        return fitted
    outside = 50.0 * (1.0 - ensemble.confidence)
    ends = [outside, 100.0 - outside]
    return replace(
        fitted,
        median_interval=tuple(np.percentile(medians, ends).tolist()),
        deviation_interval=tuple(np.percentile(deviations, ends).tolist()),
        resampled=Resampled(median=tuple(medians.tolist()), deviation=tuple(deviations.tolist())),
    )
