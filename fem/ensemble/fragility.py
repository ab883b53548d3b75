"""The fragility curve: probability of overturning over the strength of the motion, and a lognormal fit.

p(a) = Phi(ln(a/median)/deviation), by maximum binomial likelihood of the counts: probit regression on ln a.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import bdtr, ndtr

from fem.ensemble.result import Fall
from fem.runtime.arrays import FloatArray

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
