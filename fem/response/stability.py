"""The long-time motion, judged from sections once a period, with the figures that decide; the README defines them.

Sections are compared in units of the slenderness angle, of that times the frequency parameter, of the floor's peak
velocity and of its amplitude.
"""

from dataclasses import dataclass

import numpy as np

from fem.runtime.arrays import FloatArray

LARGEST_PERIOD = 16  #: tried, in periods of the drive; and at most a third of the window
REPEATS = 3  #: of a period within the window, at least
#: of a section against the one n periods before; an elastic container that slides and rings scatters by 3e-3
TOLERANCE = 5e-3
#: distances over the second half of the window less than this share of those over the first: still settling
SETTLING = 0.5
#: growth of the largest amplitude from the first half to the second beyond which amplitudes diverge
GROWTH = 0.1
NEGLIGIBLE = 0.01  #: of the slenderness angle: smaller amplitudes do not grow

Decay = tuple[str, float | None]  #: fate of a motion without its drive, and time [s]


@dataclass(frozen=True, kw_only=True)
class LongTime:
    """Long-time motion, with the figures that decide."""

    kind: str  #: rest | periodic | not periodic | not settled
    period: int | None  #: n of a periodic motion, in periods of the drive
    scatter: float  #: largest distance of sections n apart; of the best n where none was good enough
    compared: int  #: pairs of sections behind it
    settling: float | None  #: distances over the second half by those over the first; None where periodic


def classify(
    sections: FloatArray, *, resting: bool, tolerance: float = TOLERANCE, largest_period: int = LARGEST_PERIOD
) -> LongTime:
    """Judge a window of sections.

    Args:
        sections: (n, k), n at least 4, scaled to order one.
        resting: nothing moved beyond the limits of a verdict.
        tolerance: of the largest coordinate.
        largest_period: tried; at most a third of the window.
    """
    count = len(sections)
    looked_for = min(largest_period, count // REPEATS)
    scatters = np.array([distances(sections, n).max() for n in range(1, looked_for + 1)])
    repeating = np.flatnonzero(scatters <= tolerance)
    n = int(repeating[0]) + 1 if repeating.size else int(np.argmin(scatters)) + 1
    period = ratio = None
    if resting:
        kind = "rest"
    else:
        # a spiral toward a motion of period m comes back to itself first after a multiple of m
        tried = [m for m in range(1, n) if n % m == 0] if repeating.size else range(1, looked_for + 1)
        ratio = min((approach(sections, m) for m in tried), default=None)
        if ratio is not None and ratio < SETTLING:
            kind = "not settled"
        elif repeating.size:
            kind, period, ratio = "periodic", n, None
        else:
            kind = "not periodic"
    return LongTime(
        kind=kind, period=period, scatter=float(scatters[n - 1]), compared=count - n, settling=ratio
    )


def distances(sections: FloatArray, n: int) -> FloatArray:
    """Largest coordinate of the difference of each section to the one n before, shape (count - n,)."""
    return np.asarray(np.abs(sections[n:] - sections[:-n]).max(axis=1))


def approach(sections: FloatArray, n: int) -> float:
    """Mean distance of sections n apart in the second half of the window over that in the first."""
    apart = distances(sections, n)
    half = apart.size // 2
    return float(apart[-half:].mean() / max(apart[:half].mean(), 1e-300))


def amplitude_growth(amplitudes: FloatArray) -> float:
    """Largest amplitude in the second half of the window over that in the first, less one [-].

    Args:
        amplitudes: (n,) largest |rotation| of each period, over the slenderness angle.
    """
    half = amplitudes.size // 2
    first, second = float(amplitudes[:half].max()), float(amplitudes[-half:].max())
    return (second - first) / max(first, NEGLIGIBLE)


def amplitudes_diverge(amplitudes: FloatArray) -> bool:
    """Whether the amplitudes grow by more than those of a bounded motion."""
    return amplitude_growth(amplitudes) > GROWTH
