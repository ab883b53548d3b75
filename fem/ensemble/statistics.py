"""The results of an ensemble: a row a point, and the fragility curve of all points."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fem.batch.intervals import Estimate, estimate
from fem.ensemble.fragility import BOOTSTRAPS, bootstrap_fits, falls, fit_lognormal, misses, misses_by_chance
from fem.ensemble.plan import Ensemble
from fem.results.outcome import COUNTED, Ending
from fem.runtime.arrays import FloatArray

#: columns of `points.csv` behind those of the axes
POINT_COLUMNS = ("draws", *COUNTED, "probability", "low", "high", "region")
FEWEST_FITTED = 4  #: levels from which a curve is fitted
FEWEST_RESAMPLED = 0.9  #: share of the resamples that must have a curve, else there is no band


@dataclass(frozen=True, kw_only=True)
class PointResult:
    """One point of an ensemble."""

    values: dict[str, Any]  #: of the axes
    stood: int
    overturned: int
    failed: int
    estimate: Estimate
    region: str  #: below | above | undecided: the probability of overturning against the limit asked for

    def row(self) -> dict[str, Any]:
        """By the axes' keys and `POINT_COLUMNS`."""
        return self.values | {
            "draws": self.stood + self.overturned + self.failed,
            "stood": self.stood,
            "overturned": self.overturned,
            "failed": self.failed,
            "probability": self.estimate.value,
            "low": self.estimate.low,
            "high": self.estimate.high,
            "region": self.region,
        }


def count_point(ensemble: Ensemble, cell: int, codes: np.ndarray) -> PointResult:
    """The result of a point from the endings (draws,) of its draws."""
    overturned, failed = codes == Ending.OVERTURNED, codes == Ending.FAILED
    found = estimate(
        overturned,
        failed,
        replicates=ensemble.replicates,
        confidence=ensemble.confidence,
        independent=None if ensemble.motions is None else ensemble.replicates,
    )
    region = "undecided"
    if found.high <= ensemble.probability:
        region = "below"
    elif found.low > ensemble.probability:
        region = "above"
    return PointResult(
        values=ensemble.point(cell),
        stood=int((codes == Ending.STANDING).sum()),
        overturned=int(overturned.sum()),
        failed=int(failed.sum()),
        estimate=found,
        region=region,
    )


def fragility_of(
    ensemble: Ensemble, codes: np.ndarray, points: Sequence[PointResult]
) -> dict[str, Any] | None:
    """The curve over the only axis: where it falls, the fitted lognormal, its band; None with more axes.

    Args:
        codes: (points, draws).
    """
    if len(ensemble.axes) != 1:
        return None
    strengths = np.array(ensemble.axes[0].values, dtype=float)
    low, high, values = (
        np.array([getattr(point.estimate, name) for point in points], dtype=float)
        for name in ("low", "high", "value")
    )
    known = np.isfinite(values)
    result: dict[str, Any] = {
        "axis": ensemble.axes[0].key,
        "falls": [asdict(one) for one in falls(strengths[known], values[known], low[known], high[known])],
        "lognormal": None,
    }
    if strengths[0] <= 0.0 or known.sum() < FEWEST_FITTED:
        result["no_lognormal"] = (
            "the axis goes through zero" if strengths[0] <= 0.0 else f"fewer than {FEWEST_FITTED} levels"
        )
        return result
    counts, sizes = _by_replicate(ensemble, codes[known])
    result |= _lognormal(ensemble, strengths[known], counts, sizes, low[known], high[known])
    return result


def _lognormal(
    ensemble: Ensemble,
    strengths: FloatArray,
    counts: FloatArray,
    sizes: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> dict[str, Any]:
    curve = fit_lognormal(strengths, counts.sum(axis=1), sizes.sum(axis=1))
    if curve is None:
        return {
            "no_lognormal": "the counts are a step, fall, or hold nothing that overturned or nothing that stood"
        }
    medians, deviations = bootstrap_fits(
        strengths,
        counts,
        sizes,
        seed=ensemble.seed,
        independent=ensemble.replicates == 1,
        common=ensemble.motions is not None,
    )
    outside = 50.0 * (1.0 - ensemble.confidence)
    fitted: dict[str, Any] = {"median": curve.median, "deviation": curve.deviation, "levels": len(strengths)}
    fitted["levels_missed"] = misses(curve, strengths, low, high)
    fitted["missed_by_chance"] = misses_by_chance(len(strengths), ensemble.confidence)
    fitted["adequate"] = fitted["levels_missed"] <= fitted["missed_by_chance"]
    enough = len(medians) >= FEWEST_RESAMPLED * BOOTSTRAPS
    for name, found in (("median", medians), ("deviation", deviations)):
        ends = np.percentile(found, [outside, 100.0 - outside]).tolist() if enough else None
        fitted[f"{name}_interval"] = ends
    if enough:
        fitted["resampled"] = {"median": medians.tolist(), "deviation": deviations.tolist()}
    return {"lognormal": fitted}


def _by_replicate(ensemble: Ensemble, codes: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """Overturned, and draws with an outcome, in each replicate, shapes (points, replicates)."""
    blocks = codes.reshape(len(codes), ensemble.replicates, -1)
    fallen, known = blocks == Ending.OVERTURNED, blocks != Ending.FAILED
    return fallen.sum(axis=2).astype(float), known.sum(axis=2).astype(float)
