"""The fragility curve: probability of overturning over the strength of the motion, and a lognormal fit.

p(a) = Phi(ln(a/median)/deviation), by maximum binomial likelihood of the counts: probit regression on ln a.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any, ClassVar, Literal, Self

import numpy as np
from scipy.special import bdtr, ndtr

from fem.results.figures import SLIPPED
from fem.results.json_block import JsonBlock
from fem.results.outcome import COUNTED, NOT_STANDING, Ending, counts_of
from fem.runtime.arrays import FloatArray
from fem.runtime.intervals import estimate
from fem.study.axes import AxisError
from fem.study.design import DesignResult, Ensemble
from fem.study.draws import read_random
from fem.study.table import Columns


@dataclass(frozen=True, kw_only=True)
class Lognormal(JsonBlock):
    """A fitted fragility curve, and how well it describes the counts."""

    median: float  #: strength of motion at which half overturn, unit of the axis
    deviation: float  #: of its logarithm
    levels: int = 0
    levels_missed: int = 0
    missed_by_chance: int = 0
    adequate: bool = False

    def probability(self, strengths: FloatArray) -> FloatArray:
        """Of overturning, shape as given."""
        return np.asarray(ndtr(np.log(strengths / self.median) / self.deviation))


@dataclass(frozen=True, kw_only=True)
class Fragility(JsonBlock):
    """What the only axis of an ensemble shows."""

    axis: str  #: its key
    #: where a stronger motion overturns less often than a weaker one, beyond what the intervals allow
    falls: tuple[dict[str, float], ...]
    lognormal: Lognormal | None = None
    no_lognormal: str | None = None  #: why there is none

    written_where_given = frozenset({"no_lognormal"})


POINT_COLUMNS: Columns = dict.fromkeys(("draws", *COUNTED), int)
POINT_COLUMNS |= dict.fromkeys(("probability", "low", "high"), float) | {"region": str, SLIPPED: float}
#: where the probability of overturning is at most, neither, more than what is asked for
Region = Literal["below", "undecided", "above"]


@dataclass(frozen=True, kw_only=True)
class EnsembleResult(DesignResult):
    """All results of an ensemble."""

    asked: str  #: hash of the request
    ensemble: str = ""  #: its name
    columns_of: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "points": POINT_COLUMNS | {"region": Region},
        "motions": {"file": str} | dict.fromkeys(COUNTED, int),
    }
    needed: ClassVar[frozenset[str]] = frozenset({"low", "high", "region", "file"})
    draws: int = 0  #: at each point
    seed: int = 0
    sampling: str = ""
    replicates: int = 1
    confidence: float
    probability: float
    unknown_inputs: str = ""
    random: dict[str, Any]  #: what is drawn, by key
    drawn_over_uncertainty: tuple[str, ...] = ()
    motions: tuple[dict[str, Any], ...] | None = None  #: measures and counts of each motion of a set
    motion_figures: tuple[str, ...] = ()
    points: tuple[Mapping[str, Any], ...] = ()  #: by the keys of the axes and `statistics.POINT_COLUMNS`
    regions: dict[Region, int] = field(default_factory=dict)
    failed: int = 0
    fragility: Fragility | None = None

    @classmethod
    def from_json(cls, block: Mapping[str, Any]) -> Self:
        """As every block; its points have the keys of the axes, and what is drawn can be."""
        result = super().from_json(block)
        if result.state == "finished" and not result.points:
            raise ValueError("points is missing")
        for axis, (k, point) in product(result.axes, enumerate(result.points)):
            if point.get(axis.key) not in axis.values:
                raise ValueError(f"points[{k}].{axis.key} is none of the values of its axis")
        for key, spread in result.random.items():
            try:
                read_random(key, spread)
            except AxisError as error:
                raise ValueError(f"random.{key} {error}") from None
        return result


SCORINGS = 60  #: of Fisher's method
TIGHT = 1e-9  #: change of the coefficients at convergence
STEEPEST = 200.0  #: 1/deviation beyond which the counts are a step
TAIL = 8.0  #: deviations from the median at which the tails are cut


def fit_lognormal(strengths: FloatArray, overturned: FloatArray, draws: FloatArray) -> Lognormal | None:
    """The lognormal curve of largest likelihood, by Fisher's scoring of the probit regression.

    Positive strengths, how many of how many draws overturned, all (n,). None for a step, no events, a falling curve.
    """
    logarithms = np.log(strengths)
    middle = float(np.average(logarithms, weights=np.maximum(draws, 1e-9)))
    x = logarithms - middle
    slope = 1.0 / max(float(np.std(x)), 1e-9)
    intercept = float(np.clip((np.mean((overturned + 0.5) / (draws + 1.0)) - 0.5) * 2.0, -1.0, 1.0))
    for _ in range(SCORINGS):
        z = np.clip(intercept + slope * x, -TAIL, TAIL)
        density = np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi)
        p = ndtr(z)
        spread = np.maximum(p * ndtr(-z), 1e-300)
        weight, score = draws * density**2 / spread, density * (overturned - draws * p) / spread
        a, b, c = weight.sum(), (weight * x).sum(), (weight * x * x).sum()
        first, second = score.sum(), (score * x).sum()
        determinant = max(a * c - b * b, 1e-300)
        change = np.array([c * first - b * second, a * second - b * first]) / determinant
        change = np.clip(change, -0.5 * (1.0 + abs(slope)), 0.5 * (1.0 + abs(slope)))
        intercept, slope = intercept + float(change[0]), slope + float(change[1])
        if np.abs(change).max() < TIGHT * (1.0 + abs(slope)):
            break
    else:
        return None
    if not 1e-3 < slope < STEEPEST:
        return None
    return Lognormal(median=float(np.exp(-(intercept - slope * middle) / slope)), deviation=1.0 / slope)


def falls(
    strengths: FloatArray, values: FloatArray, low: FloatArray, high: FloatArray
) -> list[dict[str, float]]:
    """Where the curve falls: for each level, the weaker one whose interval lies highest above its own."""
    drops = []
    for k in range(1, len(strengths)):
        before = int(np.argmax(low[:k]))
        if high[k] < low[before]:
            drop = {"weaker": strengths[before], "stronger": strengths[k]}
            drop |= {"probability_weaker": values[before], "probability_stronger": values[k]}
            drops.append({name: float(value) for name, value in drop.items()})
    return drops


def misses(curve: Lognormal, strengths: FloatArray, low: FloatArray, high: FloatArray) -> int:
    """Levels whose interval does not hold the curve."""
    fitted = curve.probability(strengths)
    return int(np.sum((fitted < low) | (fitted > high)))


#: columns of `points.csv` behind those of the axes
PointRow = dict[str, Any]  #: of a point, by the keys of the axes and these columns
FEWEST_FITTED = 4  #: levels from which a curve is fitted
NO_CURVE = "the counts are a step, fall, or hold nothing that overturned or nothing that stood"


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
    row = {"probability": share.value, "low": share.low, "high": share.high, "region": region}
    row |= {SLIPPED: max(map(float, slid), default=None)}
    return ensemble.point(cell) | {"draws": codes.size} | counts_of(codes) | row


def fragility_of(ensemble: Ensemble, codes: np.ndarray, points: Sequence[PointRow]) -> Fragility | None:
    """The curve over the only axis: where it falls, the fitted lognormal; None with more axes.

    `codes`: (points, draws).
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
    counts = np.isin(codes[known], NOT_STANDING).sum(axis=1).astype(float)
    sizes = (codes[known] != Ending.FAILED).sum(axis=1).astype(float)
    curve = fit_lognormal(strengths[known], counts, sizes)
    if curve is None:
        return replace(fragility, no_lognormal=NO_CURVE)
    levels, missed = int(known.sum()), misses(curve, strengths[known], low[known], high[known])
    # that miss a true curve, at most, in nineteen of twenty such studies; not from `scipy.stats`, whose import takes as
    # long as twenty runs of a site
    by_chance = int(np.argmax(bdtr(np.arange(levels + 1), levels, 1.0 - ensemble.confidence) >= 0.95))
    found = {"levels": levels, "levels_missed": missed, "missed_by_chance": by_chance}
    return replace(fragility, lognormal=replace(curve, **found, adequate=missed <= by_chance))
