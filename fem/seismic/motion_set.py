"""Checks of a set of motions against a site: EN 1998-1:2004, 3.2.3.1.2(4), and that its motions are independent.

A rocking body has no fundamental period T_1, so the band 0.2 T_1 to 2 T_1 of the clause is taken as the whole range of
the code's spectrum that matters to it: 0.05 s to 4 s, and on to the longest period of the body where that is longer.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from fem.records.spectrum import response_spectrum
from fem.runtime.arrays import FloatArray
from fem.seismic.action import LAST_PERIOD_S, MotionTarget
from fem.seismic.ground_motion import GroundMotion, sampled_at

LEAST_MOTIONS = 3  #: (4)a
#: (4)c
LEAST_SHARE = 0.9
#: of accelerations, at no shift; between motions, and between the components of one (ASCE/SEI 43-05 asks the latter)
MOST_CORRELATION = 0.3
#: from which two motions are one and the same, shifted, reversed in time or scaled
COPY_CORRELATION = 0.8
FIRST_PERIOD_S = 0.05
PERIODS_SHOWN = 100
SHORTEST_SHOWN_S = 0.02
#: largest shortfall that is rounding
ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class ComponentSpectra:
    """Spectra of one component of a set, 5 % damping."""

    target: FloatArray  #: (k,) [m/s2]
    motions: FloatArray  #: (m, k) [m/s2]

    @property
    def mean(self) -> FloatArray:
        """Of the motions, shape (k,) [m/s2]."""
        return np.asarray(self.motions.mean(axis=0))

    def least(self, within: np.ndarray) -> tuple[float, int]:
        """Least ratio of mean to target among the periods of a mask (k,), and its index."""
        ratios = np.where(within, self.mean / self.target, np.inf)
        place = int(np.argmin(ratios))
        return float(ratios[place]), place


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionSetCheck:
    """What the checks of a set found."""

    periods: FloatArray  #: of the spectra, shape (k,) [s]
    band: tuple[float, float]  #: of periods in which the mean spectrum was checked [s]
    horizontal: ComponentSpectra
    vertical: ComponentSpectra | None
    count: int
    mean_peak: float  #: mean of the horizontal peaks [m/s2]
    wanted_peak: float  #: a_g S [m/s2]
    least_ratio: float  #: of mean to target, horizontal [-]
    least_ratio_period: float  #: [s]
    vertical_least_ratio: float | None
    vertical_least_ratio_period: float | None
    second_least_ratio: float | None  #: as the vertical's, of the second horizontal components
    second_least_ratio_period: float | None
    largest_correlation: float
    stationary: float | None  #: least stationary part of artificial motions [s]; None: recorded
    reasons: tuple[str, ...]  #: why the set may not be used; empty: it may

    @property
    def peak_fulfilled(self) -> bool:
        """(4)b."""
        return self.mean_peak >= self.wanted_peak * (1.0 - ROUNDING)

    @property
    def spectrum_fulfilled(self) -> bool:
        """(4)c."""
        return self.least_ratio >= LEAST_SHARE * (1.0 - ROUNDING)

    @property
    def vertical_fulfilled(self) -> bool:
        """As (4)c, for the vertical spectrum; true without one."""
        return _suffices(self.vertical_least_ratio)

    @property
    def second_fulfilled(self) -> bool:
        """As (4)c, for the second horizontal components; true without any."""
        return _suffices(self.second_least_ratio)

    @property
    def valid(self) -> bool:
        """Whether the set may be used."""
        return not self.reasons


def _suffices(ratio: float | None) -> bool:
    return ratio is None or ratio >= LEAST_SHARE * (1.0 - ROUNDING)


def check_set(
    motions: Sequence[GroundMotion],
    action: MotionTarget,
    *,
    longest: float = LAST_PERIOD_S,
    second: float = 1.0,
) -> MotionSetCheck:
    """Check a set of motions against the elastic spectra of a site.

    Args:
        motions: at least one; longest: end of the band of periods [s].
        second: share of the horizontal spectrum that the second horizontal components are for.

    The spectra of the vertical and of the second component are required of artificial motions (3.2.3.1.2(1)P) and
    shown of recorded ones, whose components keep their proportion.
    """
    periods = periods_of_check(longest)
    inside = (periods >= FIRST_PERIOD_S) & (periods <= longest * (1.0 + 1e-9))
    horizontal = ComponentSpectra(
        target=action.horizontal(periods), motions=_spectra(motions, [m.horizontal for m in motions], periods)
    )
    ratio, place = horizontal.least(inside)
    vertical, upward = None, [m.vertical for m in motions if m.vertical is not None]
    upright: tuple[float, int] | None = None
    if len(upward) == len(motions):
        vertical = ComponentSpectra(
            target=action.vertical(periods), motions=_spectra(motions, upward, periods)
        )
        upright = vertical.least(inside)
    across: tuple[float, int] | None = None
    others = [motion.second for motion in motions if motion.second is not None]
    if len(others) == len(motions):
        across = ComponentSpectra(
            target=second * horizontal.target, motions=_spectra(motions, others, periods)
        ).least(inside)
    peak = float(np.mean([motion.peak for motion in motions]))
    correlation = largest_correlation(motions)
    stationary = [motion.stationary for motion in motions if motion.stationary is not None]
    artificial = len(stationary) == len(motions)
    reasons = [
        (
            len(motions) < LEAST_MOTIONS,
            f"{len(motions)} motions, at least {LEAST_MOTIONS} are needed (3.2.3.1.2(4)a)",
        ),
        (
            peak < action.surface_acceleration * (1.0 - ROUNDING),
            f"the mean peak, {peak:.3g} m/s², is below that of the target, {action.surface_acceleration:.3g} m/s² "
            "(3.2.3.1.2(4)b)",
        ),
        (
            ratio < LEAST_SHARE * (1.0 - ROUNDING),
            f"the mean spectrum is {ratio:.2f} of the target at {periods[place]:.3g} s, at least "
            f"{LEAST_SHARE:g} is needed (3.2.3.1.2(4)c)",
        ),
        (
            artificial and upright is not None and upright[0] < LEAST_SHARE * (1.0 - ROUNDING),
            f"the mean vertical spectrum is {upright[0] if upright else 0.0:.2f} of its target at "
            f"{periods[upright[1]] if upright else 0.0:.3g} s, at least {LEAST_SHARE:g} is needed",
        ),
        (
            artificial and across is not None and not _suffices(across[0]),
            f"the mean spectrum of the second components is {across[0] if across else 0.0:.2f} of its target at "
            f"{periods[across[1]] if across else 0.0:.3g} s, at least {LEAST_SHARE:g} is needed",
        ),
        (
            0 < len(upward) < len(motions),
            "some motions have a vertical component and some have none",
        ),
        (
            correlation > MOST_CORRELATION,
            f"two accelerations of the set have a correlation of {correlation:.2f}, at most "
            f"{MOST_CORRELATION:g} is taken as independent",
        ),
    ]
    same = [
        (f"{one.name} and {other.name} are one motion", copied)
        for one, other in combinations(motions, 2)
        if (copied := copy_correlation(one, other)) >= COPY_CORRELATION
    ]
    return MotionSetCheck(
        periods=periods,
        band=(FIRST_PERIOD_S, longest),
        horizontal=horizontal,
        vertical=vertical,
        count=len(motions),
        mean_peak=peak,
        wanted_peak=action.surface_acceleration,
        least_ratio=ratio,
        least_ratio_period=float(periods[place]),
        vertical_least_ratio=upright[0] if upright else None,
        vertical_least_ratio_period=float(periods[upright[1]]) if upright else None,
        second_least_ratio=across[0] if across else None,
        second_least_ratio_period=float(periods[across[1]]) if across else None,
        largest_correlation=correlation,
        stationary=min(stationary) if artificial else None,
        reasons=(
            *(reason for applies, reason in reasons if applies),
            *(f"{words}, shifted, reversed or scaled (correlation {copied:.2f})" for words, copied in same),
        ),
    )


def periods_of_check(longest: float) -> FloatArray:
    """Periods at which spectra are compared, from 0.02 s, shape (k,) [s]."""
    return np.geomspace(SHORTEST_SHOWN_S, max(longest, LAST_PERIOD_S), PERIODS_SHOWN)


def largest_correlation(motions: Sequence[GroundMotion]) -> float:
    """Largest |correlation coefficient| at no shift: between horizontal components, and within a motion [-]."""
    pairs = [(one, one.horizontal, other, other.horizontal) for one, other in combinations(motions, 2)]
    within = [
        (one, a, one, b)
        for one in motions
        for a, b in combinations((one.horizontal, one.vertical, one.second), 2)
        if a is not None and b is not None
    ]
    return max(
        (_correlation(one.step, a, other.step, b) for one, a, other, b in [*pairs, *within]), default=0.0
    )


def copy_correlation(one: GroundMotion, other: GroundMotion) -> float:
    """Largest |correlation| of two horizontal components over all shifts, also against one reversed in time [-]."""
    step = min(one.step, other.step)
    a, b = sampled_at(step, one.step, one.horizontal), sampled_at(step, other.step, other.horizontal)
    size = math.sqrt(float(a @ a) * float(b @ b))
    if size == 0.0:
        return 0.0
    length = a.size + b.size
    first, second = np.fft.rfft(a, length), np.fft.rfft(b, length)
    products = (np.fft.irfft(first * factor, length) for factor in (second, second.conj()))
    return float(max(np.abs(product).max() for product in products)) / size


def _correlation(step: float, a: FloatArray, other_step: float, b: FloatArray) -> float:
    finest = min(step, other_step)
    one, two = sampled_at(finest, step, a), sampled_at(finest, other_step, b)
    length = min(one.size, two.size)
    one, two = one[:length] - one[:length].mean(), two[:length] - two[:length].mean()
    size = math.sqrt(float(one @ one) * float(two @ two))
    return abs(float(one @ two)) / size if size > 0.0 else 0.0


def _spectra(
    motions: Sequence[GroundMotion], components: Sequence[FloatArray], periods: FloatArray
) -> FloatArray:
    return np.array(
        [
            response_spectrum(motion.step, component, periods).pseudo_acceleration_m_s2
            for motion, component in zip(motions, components, strict=True)
        ]
    )
