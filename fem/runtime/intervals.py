"""Confidence intervals of a probability estimated from counts.

Independent draws: Clopper and Pearson (Biometrika 26, 1934), which covers the true value with at least the stated
confidence for every number of draws.

Replicates of a randomised point set (a Latin hypercube, a scrambled Sobol sequence): the points of one replicate
depend on one another, so its count is not binomial. The replicates are independent and each mean is an unbiased
estimate (Owen, Ann. Stat. 25, 1997), so their spread gives Student's interval. The README says why that is widened
where almost nothing or almost all overturned.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv, stdtrit

from fem.runtime.arrays import FloatArray

#: events, and non-events, in all replicates from which their spread alone is used
FEW = 10


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A probability with its interval."""

    value: float | None  #: share that overturned of what did not fail; None if everything failed
    low: float
    high: float


def estimate(
    overturned: np.ndarray,
    failed: np.ndarray,
    *,
    replicates: int,
    confidence: float,
    independent: int | None = None,
) -> Estimate:
    """Probability of overturning from the draws of one cell.

    A failed draw has no outcome: the lower end counts it as standing, the upper as overturned.

    Args:
        overturned: (n,) bool; failed: (n,) bool, replicate after replicate.
        replicates: 1 for independent draws.
        confidence: two-sided, such as 0.95.
        independent: draws that count as independent where replicates hold too few events; None: all of them. Where a
            replicate is a motion, it is the number of motions: draws under one motion may all do the same.
    """
    count, lost = int(overturned.sum()), int(failed.sum())
    value = count / (overturned.size - lost) if lost < overturned.size else None
    ends = []
    for counted in (overturned, overturned | failed):
        if replicates == 1:
            ends.append(binomial_interval(int(counted.sum()), counted.size, confidence))
        else:
            means = counted.reshape(replicates, -1).mean(axis=1)
            ends.append(replicate_interval(means, independent or counted.size, confidence))
    return Estimate(value=value, low=ends[0][0], high=ends[1][1])


def binomial_interval(count: int, draws: int, confidence: float) -> tuple[float, float]:
    """Clopper and Pearson's interval of a probability of which `count` of `draws` were seen."""
    outside = 0.5 * (1.0 - confidence)
    low = 0.0 if count == 0 else float(betaincinv(count, draws - count + 1, outside))
    high = 1.0 if count == draws else float(betaincinv(count + 1, draws - count, 1.0 - outside))
    return low, high


def replicate_interval(means: FloatArray, draws: int, confidence: float) -> tuple[float, float]:
    """Student's interval of the mean of replicates, widened where there are few events or non-events.

    Args:
        means: (r,) of the replicates; draws: in all of them together, or those that count as independent.
    """
    mean, count = float(means.mean()), round(float(means.mean()) * draws)
    half = float(stdtrit(means.size - 1, 0.5 + 0.5 * confidence) * means.std(ddof=1)) / math.sqrt(means.size)
    low, high = max(mean - half, 0.0), min(mean + half, 1.0)
    if min(count, draws - count) < FEW:
        binomial = binomial_interval(count, draws, confidence)
        low, high = min(low, binomial[0]), max(high, binomial[1])
    return low, high


def least_draws(probability: float, confidence: float) -> int:
    """Draws from which none overturned puts the upper end of the interval at or below a probability."""
    return math.ceil(math.log(0.5 * (1.0 - confidence)) / math.log1p(-probability))
