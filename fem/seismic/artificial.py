"""Artificial motions whose spectra match a target: random phases, amplitudes found by iteration.

A motion is a sum of harmonics with random phases under an envelope. Its spectrum is computed with exact oscillators,
each Fourier amplitude is multiplied by target over spectrum at its period, and so on; the phases stay. In each pass
peaks beyond the target's own at zero period are rounded off, a lower one is raised by a short wavelet, and the baseline
is removed, so that velocity and displacement end at zero. After D. A. Gasparini, E. H. Vanmarcke, Simulated earthquake
motions compatible with prescribed response spectra, MIT R76-4 (1976), with the amplitudes found by iteration alone.

The same seed gives the same bits: phases are made of the raw output of a bit generator whose stream numpy keeps.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Required, TypedDict, Unpack

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from fem.records.processing import ZeroEnd
from fem.runtime.arrays import FloatArray
from fem.seismic.action import LAST_PERIOD_ANNEX_A_S, LAST_PERIOD_S, MotionTarget
from fem.seismic.ground_motion import GroundMotion
from fem.seismic.motion_set import LEAST_SHARE, MOST_CORRELATION, check_set, largest_correlation
from fem.seismic.oscillators import pseudo_accelerations

STEP_S = 0.005
#: parts of the envelope beside the stationary one [s]; what the last one ends at, before the taper
RISE_S, DECAY_S = 2.0, 6.0
END_SHARE = 0.05
TAPER_S = 0.5
LEAST_STATIONARY_S = 10.0  #: EN 1998-1, 3.2.3.1.2(3)
MOST_STATIONARY_S = 60.0
SHORTEST_PERIOD_S = 0.02
BEYOND = 1.05  #: the longest period is matched from beyond it
PERIODS_PER_DECADE = 43
#: of a motion of a set, whose spectrum is then 2.7 % off in the root mean square; after 15 it is 3.3 %
PASSES = 25
#: over the length of the motion: that of the transform. Finer harmonics than those of the motion itself shape the
#: longest periods; without them the spectrum is 5 % off there
TRANSFORMED = 3.0
HIGHEST_HZ = 80.0
LOW = 0.4  #: below this frequency times the longest period the first amplitudes fall off
#: of the target at zero period: where peaks are rounded off from, and what they never reach
KNEE, CEILING = 1.045, 1.1
WAVELET_S = 0.03  #: period of the wavelet that raises a peak [s]
MOST_FACTOR = 1.05  #: factor on a whole set, at most, that makes its mean peak and mean spectra suffice

Target = Callable[[FloatArray], FloatArray]  #: periods (n,) [s] -> pseudo-accelerations (n,) [m/s2]


@dataclass(frozen=True, kw_only=True)
class Shaper:
    """What motions of one length share while they are matched."""

    stationary: float  #: stationary part [s]
    longest: float = LAST_PERIOD_S  #: period up to which they are matched [s]

    def __post_init__(self) -> None:
        if not LEAST_STATIONARY_S <= self.stationary <= MOST_STATIONARY_S:
            raise ValueError(
                f"the stationary part must last {LEAST_STATIONARY_S:g} s (EN 1998-1, 3.2.3.1.2(3)) to "
                f"{MOST_STATIONARY_S:g} s, got {self.stationary:g} s"
            )
        if not 1.0 <= self.longest <= LAST_PERIOD_ANNEX_A_S:
            raise ValueError(
                f"motions are matched up to a period of 1 to {LAST_PERIOD_ANNEX_A_S:g} s, got {self.longest:g} s"
            )

    @cached_property
    def times(self) -> FloatArray:
        """Of the samples, shape (n,) [s]."""
        length = RISE_S + self.stationary + DECAY_S
        return np.arange(math.ceil(length / STEP_S - 1e-9) + 1, dtype=np.float64) * STEP_S

    @cached_property
    def periods(self) -> FloatArray:
        """Of the oscillators, shape (k,) [s]."""
        last = BEYOND * self.longest
        count = math.ceil(PERIODS_PER_DECADE * math.log10(last / SHORTEST_PERIOD_S))
        return np.asarray(np.geomspace(SHORTEST_PERIOD_S, last, count), dtype=np.float64)

    @cached_property
    def envelope(self) -> FloatArray:
        """Rise as t^2, one, exponential decay, shape (n,) [-]."""
        t, fall = self.times, self.times - RISE_S - self.stationary
        decay = np.exp(math.log(END_SHARE) * np.maximum(fall, 0.0) / DECAY_S)
        return np.minimum(t / RISE_S, 1.0) ** 2 * decay

    @cached_property
    def taper(self) -> FloatArray:
        """Half a cosine at both ends, shape (n,) [-]."""
        edge = np.minimum(self.times, self.times[::-1]) / TAPER_S
        return 0.5 - 0.5 * np.cos(np.pi * np.minimum(edge, 1.0))

    @cached_property
    def transformed(self) -> int:
        """Samples of the Fourier transform."""
        return int(next_fast_len(math.ceil(TRANSFORMED * self.times.size), real=True))

    @cached_property
    def log_periods(self) -> FloatArray:
        """Of the harmonics, logarithms of their periods within `periods`, shape (h,)."""
        with np.errstate(divide="ignore"):
            periods = 1.0 / np.fft.rfftfreq(self.transformed, STEP_S)
        return np.log(np.clip(periods, self.periods[0], self.periods[-1]))

    @cached_property
    def _zero_end(self) -> ZeroEnd:
        return ZeroEnd(times=self.times)

    def motion(self, target: Target, stream: Sequence[int], passes: int = PASSES) -> FloatArray:
        """One component whose spectrum matches a target, shape (n,) [m/s2].

        Args:
            target: elastic spectrum at 5 %; at zero period, the peak.
            stream: of the random numbers.
            passes: of the iteration.
        """
        peak = float(target(np.zeros(1))[0])
        wanted = target(self.periods)
        raw = np.random.PCG64(np.random.SeedSequence(list(stream))).random_raw(self.log_periods.size)
        phases = np.asarray((raw >> np.uint64(11)) * 2.0**-53)  # over a turn, from 0 to 1
        spectrum = self._amplitudes(wanted) * np.exp(2j * np.pi * phases)
        motion = irfft(spectrum, self.transformed)[: self.times.size] * self.envelope
        motion *= peak / np.abs(motion).max()
        motion = self._finished(motion, peak)
        best, least = motion, math.inf
        for more in reversed(range(passes)):
            ratios = wanted / pseudo_accelerations(STEP_S, motion, self.periods)
            error = float(np.mean((ratios - 1.0) ** 2))
            if error < least:
                best, least = motion, error
            if more:
                gains = np.exp(np.interp(self.log_periods, np.log(self.periods), np.log(ratios)))
                changed = irfft(rfft(motion, self.transformed) * gains, self.transformed)
                motion = self._finished(changed[: self.times.size], peak)
        return best

    def _finished(self, motion: FloatArray, peak: float) -> FloatArray:
        """The motion (n,) as it may be used: with the peak of the target, tapered, ending at rest where it began."""
        tapered = raised(self.times, self.taper * rounded_off(motion, peak), peak)
        return tapered - self._zero_end.baseline(tapered)

    def _amplitudes(self, wanted: FloatArray) -> FloatArray:
        """First guess of the amplitudes of the harmonics, up to a factor, shape (h,)."""
        frequencies = np.fft.rfftfreq(self.transformed, STEP_S)
        low = LOW / self.longest
        shape = np.interp(self.log_periods, np.log(self.periods), wanted) / np.sqrt(
            np.maximum(frequencies, low)
        )
        return np.where(frequencies <= HIGHEST_HZ, shape * np.minimum(frequencies / low, 1.0) ** 2, 0.0)


def rounded_off(motion: FloatArray, peak: float) -> FloatArray:
    """The motion with its values beyond KNEE times the peak bent towards CEILING times the peak."""
    beyond = np.abs(motion) / peak - KNEE
    room, high = CEILING - KNEE, beyond > 0.0
    bent = motion.copy()
    bent[high] = np.sign(motion[high]) * peak * (KNEE + room * np.tanh(beyond[high] / room))
    return bent


def raised(times: FloatArray, motion: FloatArray, peak: float) -> FloatArray:
    """The motion (n,) with a short wavelet on its largest value, where that does not reach the target's peak."""
    index = int(np.argmax(np.abs(motion)))
    missing = peak - abs(float(motion[index]))
    if missing <= 0.0:
        return motion
    after = (times - times[index]) / WAVELET_S
    wavelet = np.exp(-((3.0 * after) ** 2)) * np.cos(2.0 * np.pi * after)
    return motion + math.copysign(missing, motion[index]) * wavelet


class MotionOptions(TypedDict, total=False):
    """What `artificial_set` hands on to `artificial_motions`, whose defaults hold."""

    seed: Required[int]
    stationary: float
    vertical: bool
    second: float


def artificial_motions(
    action: MotionTarget,
    *,
    count: int,
    seed: int,
    stationary: float = 12.0,
    longest: float = LAST_PERIOD_S,
    vertical: bool = True,
    second: float = 0.0,
    first: int = 1,
    passes: int = PASSES,
) -> list[GroundMotion]:
    """Motions that match the elastic spectra of a site, each with phases of its own and by itself.

    Args:
        count: how many; seed: of all of them.
        stationary: stationary part of their envelope, at least 10 s.
        longest: period up to which they are matched [s].
        vertical: with a vertical component of other phases, matched to the vertical spectrum.
        second: with a second horizontal component of other phases, matched to this share of the spectrum; 0: without.
        first: number of the first one. Motion k of a seed does not depend on how many are made.
        passes: in which each component is matched.

    Raises:
        ValueError: a stationary part that is too short or too long, or a period beyond Annex A.
    """
    shaper = Shaper(stationary=stationary, longest=longest)
    return [
        GroundMotion(
            name=f"motion_{number:02d}",
            step=STEP_S,
            horizontal=shaper.motion(action.horizontal, (seed, number, 0), passes),
            vertical=shaper.motion(action.vertical, (seed, number, 1), passes) if vertical else None,
            second=second * shaper.motion(action.horizontal, (seed, number, 2), passes) if second else None,
            origin=f"artificial, seed {seed}, number {number}",
            stationary=stationary,
        )
        for number in range(first, first + count)
    ]


def artificial_set(
    action: MotionTarget, *, count: int, longest: float = LAST_PERIOD_S, **asked: Unpack[MotionOptions]
) -> list[GroundMotion]:
    """Motions to be used together: a motion that is correlated with one before is left out, and the next one taken.

    Where the mean peak or a mean spectrum falls short of EN 1998-1, 3.2.3.1.2(4), a component of all motions is
    multiplied by one factor of up to 1.05. Arguments and errors as for `artificial_motions`.
    """
    kept: list[GroundMotion] = []
    number = 0
    while len(kept) < count:
        number += 1
        (motion,) = artificial_motions(action, count=1, longest=longest, first=number, **asked)
        if largest_correlation([*kept, motion]) <= MOST_CORRELATION:
            kept.append(replace(motion, name=f"motion_{len(kept) + 1:02d}"))
    check = check_set(kept, action, longest=longest)
    upward = LEAST_SHARE / (check.vertical_least_ratio or LEAST_SHARE)
    factors = [min(max(1.0, factor), MOST_FACTOR) for factor in (check.factor_needed, upward)]
    return kept if factors == [1.0, 1.0] else [motion.scaled(*factors) for motion in kept]
