"""The results of an ensemble: a row a point, and the fragility curve of all points."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fem.batch.table import Columns
from fem.ensemble.fragility import BOOTSTRAPS, bootstrap_fits, falls, fit_lognormal, misses, misses_by_chance
from fem.ensemble.plan import Ensemble
from fem.ensemble.result import FittedLognormal, Fragility, Resampled
from fem.results.figures import SLIPPED
from fem.results.outcome import COUNTED, NOT_STANDING, Ending, counts_of
from fem.runtime.arrays import FloatArray
from fem.runtime.intervals import estimate

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
    counts, sizes = _by_replicate(ensemble, codes[known])
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


def _by_replicate(ensemble: Ensemble, codes: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """What does not stand, and draws with an outcome, in each replicate, shapes (points, replicates)."""
    blocks = codes.reshape(len(codes), ensemble.replicates, -1)
    fallen, known = np.isin(blocks, NOT_STANDING), blocks != Ending.FAILED
    return fallen.sum(axis=2).astype(float), known.sum(axis=2).astype(float)
