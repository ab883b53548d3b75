"""How often a year: a hazard curve times the probability of an event at each strength of the motion.

The rate of an event is the integral of p(a) |dH(a)|, H the annual rate at which the strength a is exceeded. Between its
points H is a straight line of the logarithms, beyond them the line through the last two goes on: a power law k_0 a^-k
in each piece. For a lognormal p, and for one that is straight over ln a, the integral over a piece has a closed form,
so that nothing depends on a number of steps. With one power law over all strengths that is H(median) exp(k^2 beta^2/2)
(C. A. Cornell, Calculating building seismic performance reliability, 11WCEE 1996, paper 2115).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.special import log_ndtr

from fem.runtime.arrays import FloatArray
from fem.runtime.intervals import binomial_interval
from fem.seismic.point_files import read_points

ACCELERATION, VELOCITY, RATE = "acceleration_m_s2", "velocity_m_s", "rate_per_year"
YEARS = 50.0  #: of the probability that is printed


@dataclass(frozen=True, kw_only=True, eq=False)
class HazardCurve:
    """Annual rates at which strengths of the motion are exceeded.

    Raises:
        ValueError: fewer than two points, numbers that are not positive and finite, strengths that do not rise or
            rates that do not fall.
    """

    strengths: FloatArray  #: rising, (n,) [m/s2, or the unit of another measure]
    rates: FloatArray  #: falling, (n,) [1/year]
    measure: str = ACCELERATION  #: of the strength

    def __post_init__(self) -> None:
        for name in ("strengths", "rates"):
            object.__setattr__(self, name, np.array(getattr(self, name), dtype=np.float64))
        strengths, rates = self.strengths, self.rates
        if strengths.ndim != 1 or strengths.shape != rates.shape or strengths.size < 2:
            raise ValueError(
                f"a hazard curve needs two points or more, strengths and rates of one length, got {strengths.shape} "
                f"and {rates.shape}"
            )
        if not (np.isfinite([strengths, rates]).all() and strengths.min() > 0.0 and rates.min() > 0.0):
            raise ValueError("strengths and rates of a hazard curve must be positive and finite")
        if not ((np.diff(strengths) > 0.0).all() and (np.diff(rates) < 0.0).all()):
            raise ValueError("from point to point of a hazard curve strengths must rise and rates must fall")

    @classmethod
    def from_return_periods(cls, points: Sequence[tuple[float, float]]) -> "HazardCurve":
        """From return periods [years] and strengths; raises as the class."""
        ordered = sorted(points)
        return cls(
            strengths=np.array([strength for _, strength in ordered]),
            rates=np.array([1.0 / years for years, _ in ordered]),
        )

    @cached_property
    def exponents(self) -> FloatArray:
        """k of each piece between two points, (n - 1,) [-]."""
        return np.asarray(-np.diff(np.log(self.rates)) / np.diff(np.log(self.strengths)))

    def rate(self, strength: float) -> float:
        """Annual rate at which a strength is exceeded [1/year]."""
        piece = self._piece(strength)
        return float(self.rates[piece] * (self.strengths[piece] / strength) ** self.exponents[piece])

    def lognormal(self, median: float, beta: float) -> float:
        """Annual rate of an event whose probability is Phi(ln(a/median)/beta) [1/year]; a step with beta = 0.

        Raises:
            ValueError: a median that is not positive, or a beta that is negative.
        """
        if not 0.0 < median < math.inf:
            raise ValueError(f"the median must be positive and finite, got {median}")
        if not 0.0 <= beta < math.inf:
            raise ValueError(f"beta must be finite and not negative, got {beta}")
        if beta == 0.0:
            return self.rate(median)
        # By parts, the integral is that of H over the density of ln a: normal, and shifted by k beta^2 in each piece.
        edges = np.concatenate([[-np.inf], np.log(self.strengths[1:-1] / median), [np.inf]])
        k = self.exponents
        at_median = np.log(self.rates[:-1]) + k * np.log(self.strengths[:-1] / median)
        ends = (edges[:-1] + k * beta**2) / beta, (edges[1:] + k * beta**2) / beta
        # in logarithms: in a steep piece the exponential overflows where the share is next to nothing
        return float(np.sum(np.exp(at_median + 0.5 * (k * beta) ** 2 + _log_share(*ends))))

    def straight(self, low: float, high: float, at_low: float, at_high: float) -> float:
        """Annual rate of an event from strengths low to high, its probability straight over ln a [1/year].

        Args:
            low, high: 0 < low < high, which may be inf where both probabilities are equal.
            at_low, at_high: probabilities there.
        """
        inner = self.strengths[(self.strengths > low) & (self.strengths < high)].tolist()
        slope = (at_high - at_low) / math.log(high / low) if at_high != at_low else 0.0
        total = 0.0
        for begin, end in zip([low, *inner], [*inner, high], strict=True):
            first, last = self.rate(begin), self.rate(end) if math.isfinite(end) else 0.0
            p = at_low + slope * math.log(begin / low)
            q = at_low + slope * math.log(end / low) if slope else p
            k = self.exponents[self._piece(begin)]
            total += p * first - q * last + slope * (first - last) / k
        return float(total)

    def _piece(self, strength: float) -> int:
        """Number of the piece that holds a strength, or goes on to it; at a point the piece above it."""
        return int(
            np.clip(np.searchsorted(self.strengths, strength, side="right") - 1, 0, self.rates.size - 2)
        )


def read_hazard(path: Path) -> HazardCurve:
    """The curve of a CSV file: a line that names its columns, acceleration_m_s2 or velocity_m_s, and rate_per_year.

    Raises:
        ValueError: as `read_points`, or numbers that are no hazard curve.
    """
    columns = read_points(path, [(measure, RATE) for measure in (ACCELERATION, VELOCITY)])
    measure = next(iter(columns))
    ordered = np.array(sorted(zip(columns[measure], columns[RATE], strict=True)))
    return HazardCurve(strengths=ordered[:, 0], rates=ordered[:, 1], measure=measure)


def _log_share(low: FloatArray, high: FloatArray) -> FloatArray:
    """Logarithm of the normal probability between low and high, shape as given."""
    upper = low > 0.0
    less, more = log_ndtr(np.where(upper, -high, low)), log_ndtr(np.where(upper, -low, high))
    return np.asarray(more + np.log1p(-np.exp(less - more)))


def annual_rate(
    acceleration_m_s2: FloatArray, rate_per_year: FloatArray, *, median_m_s2: float, beta: float
) -> float:
    """Annual rate of an event with a lognormal fragility under a hazard curve [1/year].

    Args:
        acceleration_m_s2: of the hazard curve, rising, (n,), n at least 2.
        rate_per_year: at which these are exceeded, falling, (n,). Between the points the logarithms are straight,
            beyond them they go on as a power law.
        median_m_s2: acceleration at which half of the motions cause the event.
        beta: standard deviation of its logarithm; 0: a step.

    Returns:
        The integral in closed form: it does not depend on a step.

    Raises:
        ValueError: a curve of fewer than two points, or that does not rise and fall; numbers that are not positive.
    """
    return HazardCurve(strengths=acceleration_m_s2, rates=rate_per_year).lognormal(median_m_s2, beta)


def probability_in(years: float, rate: float) -> float:
    """Of at least one event in a number of years, the events being independent (Poisson)."""
    return -math.expm1(-rate * years)


@dataclass(frozen=True, kw_only=True)
class CountedRate:
    """Annual rate of an event from counts at several strengths."""

    rate: float  #: [1/year]
    #: [1/year]: with the ends of all the counts' intervals at once, none and all of what is stronger than counted
    low: float
    high: float
    #: the strengths between which most of `rate` arises; the last end is inf where that is beyond all counts
    most_from: tuple[float, float]
    share: float  #: of `rate` that arises there; 0 where nothing happened
    #: of `rate`, up to each strength from the one before, and beyond the last [1/year]
    parts: tuple[float, ...]


def counted_rate(
    hazard: HazardCurve,
    strengths: Sequence[float],
    events: Sequence[int],
    motions: Sequence[int],
    *,
    never_below: float,
    confidence: float = 0.95,
) -> CountedRate:
    """Annual rate of an event from counts of motions at several strengths.

    Between the strengths the share is straight over ln a. Beyond the last the counted share stays, at least its lower
    end and at most all. Below the first it falls to zero at `never_below`; its upper bound stays that of the first.

    Args:
        strengths: rising, (n,) [as the hazard's]; events: of motions, (n,).
        never_below: strength below which the event cannot happen, positive.
        confidence: of the interval of each count (Clopper and Pearson).

    Raises:
        ValueError: no strengths, or such that do not rise from above `never_below`.
    """
    if not strengths or not 0.0 < never_below < strengths[0] or not (np.diff(strengths) > 0.0).all():
        raise ValueError(f"strengths must rise from above {never_below:g}, got {list(strengths)}")
    shares = [k / n for k, n in zip(events, motions, strict=True)]
    ends = [binomial_interval(k, n, confidence) for k, n in zip(events, motions, strict=True)]
    edges = [never_below, *strengths, math.inf]

    def parts(inner: Sequence[float], before: float, beyond: float) -> list[float]:
        starts, stops = [before, *inner[:-1], beyond], [*inner, beyond]
        return [hazard.straight(*piece) for piece in zip(edges[:-1], edges[1:], starts, stops, strict=True)]

    rates = parts(shares, 0.0, shares[-1])
    lows, highs = [low for low, _ in ends], [high for _, high in ends]
    most = int(np.argmax(rates))
    total = sum(rates)
    return CountedRate(
        rate=total,
        low=sum(parts(lows, 0.0, lows[-1])[1:]),
        high=sum(parts(highs, highs[0], 1.0)),
        most_from=(edges[most], edges[most + 1]),
        share=rates[most] / total if total > 0.0 else 0.0,
        parts=tuple(rates),
    )
