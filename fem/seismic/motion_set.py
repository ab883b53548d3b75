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

CLAUSE = "EN 1998-1:2004, 3.2.3.1.2"
LEAST_MOTIONS = 3  #: (4)a
LEAST_SHARE = 0.9  #: (4)c
#: of accelerations, at no shift; between motions, and between the components of one (ASCE/SEI 43-05 asks the latter)
MOST_CORRELATION = 0.3
COPY_CORRELATION = 0.8  #: from which two motions are one and the same, shifted, reversed in time or scaled
FIRST_PERIOD_S = 0.05
PERIODS_SHOWN = 100
SHORTEST_SHOWN_S = 0.02
ROUNDING = 1e-9  #: largest shortfall that is rounding
ENOUGH = LEAST_SHARE * (1.0 - ROUNDING)


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
        index = int(np.argmin(ratios))
        return float(ratios[index]), index


@dataclass(frozen=True, kw_only=True)
class Requirement:
    """One requirement on a set of motions."""

    name: str
    found: float
    demanded: str  #: in words
    unit: str = ""
    fulfilled: bool
    clause: str = ""  #: empty where it is this program's own
    reason: str = ""  #: why a set that does not fulfil it may not be used; empty: it may all the same
    fits: bool = True  #: it is about the fit to a target


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
    largest_correlation: float
    stationary: float | None  #: least stationary part of artificial motions [s]; None: recorded
    requirements: tuple[Requirement, ...]
    reasons: tuple[str, ...]  #: why the set may not be used; empty: it may

    @property
    def valid(self) -> bool:
        """Whether the set may be used."""
        return not self.reasons

    @property
    def factor_needed(self) -> float:
        """Least factor on the set with which its mean peak and mean spectrum fulfil the code."""
        return max(self.wanted_peak / self.mean_peak, LEAST_SHARE / self.least_ratio)


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

    def spectra(target: FloatArray, name: str) -> ComponentSpectra:
        pairs = ((motion.step, getattr(motion, name)) for motion in motions)
        found = [response_spectrum(*pair, periods) for pair in pairs]
        return ComponentSpectra(target=target, motions=np.array(found))

    horizontal = spectra(action.horizontal(periods), "horizontal")
    vertical, across = (
        spectra(target, name) if all(getattr(motion, name) is not None for motion in motions) else None
        for target, name in ((action.vertical(periods), "vertical"), (second * horizontal.target, "second"))
    )
    ratio, index = horizontal.least(inside)
    upright, sideways = (None if part is None else part.least(inside) for part in (vertical, across))
    peak, wanted = float(np.mean([motion.peak for motion in motions])), action.surface_acceleration
    correlation = largest_correlation(motions)
    stationary = [motion.stationary for motion in motions if motion.stationary is not None]
    artificial = len(stationary) == len(motions)
    requirements = [
        Requirement(
            name="number of motions",
            found=float(len(motions)),
            demanded=f"at least {LEAST_MOTIONS}",
            fulfilled=len(motions) >= LEAST_MOTIONS,
            clause=f"{CLAUSE} (4) a)",
            reason=f"{len(motions)} motions, at least {LEAST_MOTIONS} are needed (3.2.3.1.2(4)a)",
            fits=False,
        ),
        Requirement(
            name="mean of the zero-period values",
            found=peak,
            demanded=f"at least {wanted:.4g} m/s2",
            unit="m/s2",
            fulfilled=peak >= wanted * (1.0 - ROUNDING),
            clause=f"{CLAUSE} (4) b)",
            reason=f"the mean peak, {peak:.3g} m/s², is below that of the target, {wanted:.3g} m/s² (3.2.3.1.2(4)b)",
        ),
        Requirement(
            name=f"least mean over target, {FIRST_PERIOD_S:g} to {longest:.3g} s, at {periods[index]:.3g} s",
            found=ratio,
            demanded=f"at least {LEAST_SHARE:g}",
            fulfilled=ratio >= ENOUGH,
            clause=f"{CLAUSE} (4) c)",
            reason=f"the mean spectrum is {ratio:.2f} of the target at {periods[index]:.3g} s, at least "
            f"{LEAST_SHARE:g} is needed (3.2.3.1.2(4)c)",
        ),
        Requirement(
            name="largest correlation of two accelerations",
            found=correlation,
            demanded=f"at most {MOST_CORRELATION:g}",
            fulfilled=correlation <= MOST_CORRELATION,
            reason=f"two accelerations of the set have a correlation of {correlation:.2f}, at most "
            f"{MOST_CORRELATION:g} is taken as independent",
            fits=False,
        ),
    ]
    beside = (
        ("vertical", "vertical spectrum", upright, f"{CLAUSE} (1)P; 0.9 as in (4) c)"),
        ("second horizontal", "spectrum of the second components", sideways, ""),
    )
    requirements += [
        Requirement(
            name=f"{name}: least mean over target, at {periods[least[1]]:.3g} s",
            found=least[0],
            demanded=f"at least {LEAST_SHARE:g}" if artificial else "shown only: recorded components",
            fulfilled=least[0] >= ENOUGH or not artificial,
            clause=clause if artificial else "",
            reason=f"the mean {spectrum} is {least[0]:.2f} of its target at {periods[least[1]]:.3g} s, at least "
            f"{LEAST_SHARE:g} is needed",
        )
        for name, spectrum, least, clause in beside
        if least is not None
    ]
    if artificial:
        requirements.append(
            Requirement(
                name="stationary part",
                found=min(stationary),
                demanded="at least 10 s",
                unit="s",
                fulfilled=min(stationary) >= 10.0,
                clause=f"{CLAUSE} (3)",
            )
        )
    reasons = [
        requirement.reason for requirement in requirements if requirement.reason and not requirement.fulfilled
    ]
    if 0 < sum(motion.vertical is not None for motion in motions) < len(motions):
        reasons.append("some motions have a vertical component and some have none")
    reasons += [
        f"{one.name} and {other.name} are one motion, shifted, reversed or scaled (correlation {copied:.2f})"
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
        wanted_peak=wanted,
        least_ratio=ratio,
        least_ratio_period=float(periods[index]),
        vertical_least_ratio=upright[0] if upright else None,
        vertical_least_ratio_period=float(periods[upright[1]]) if upright else None,
        second_least_ratio=sideways[0] if sideways else None,
        largest_correlation=correlation,
        stationary=min(stationary) if artificial else None,
        requirements=tuple(requirements),
        reasons=tuple(reasons),
    )


def periods_of_check(longest: float) -> FloatArray:
    """Periods at which spectra are compared, from 0.02 s, shape (k,) [s]."""
    return np.geomspace(SHORTEST_SHOWN_S, max(longest, LAST_PERIOD_S), PERIODS_SHOWN)


def largest_correlation(motions: Sequence[GroundMotion]) -> float:
    """Largest |correlation coefficient| at no shift: between horizontal components, and within a motion [-]."""
    pairs = [(one, one.horizontal, other, other.horizontal) for one, other in combinations(motions, 2)]
    within = [
        (motion, a, motion, b)
        for motion in motions
        for a, b in combinations((motion.horizontal, motion.vertical, motion.second), 2)
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
    first, second = sampled_at(finest, step, a), sampled_at(finest, other_step, b)
    length = min(first.size, second.size)
    first, second = first[:length] - first[:length].mean(), second[:length] - second[:length].mean()
    size = math.sqrt(float(first @ first) * float(second @ second))
    return abs(float(first @ second)) / size if size > 0.0 else 0.0
