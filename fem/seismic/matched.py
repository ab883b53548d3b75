"""Recorded motions made to fit a site: scaled, or matched to its spectrum by wavelets.

Scaling keeps a record as it is but for one factor on both components. Matching levels gross differences by a gain that
is smooth over frequency, then adds short wavelets at the instants of the peaks of oscillators until their spectrum is
the target: L. Al Atik, N. Abrahamson, An improved method for nonstationary spectral matching, Earthquake Spectra 26
(2010) 601-617. Their tapered cosine needs no correction of the baseline within a record; one is made where a wavelet is
cut at its ends.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.signal import lfilter

from fem.records.processing import ZeroEnd
from fem.records.spectrum import exact_recursion, response_spectrum
from fem.runtime.arrays import FloatArray
from fem.seismic.action import DAMPING_RATIO, LAST_PERIOD_S, MotionTarget
from fem.seismic.artificial import Target
from fem.seismic.ground_motion import GroundMotion, sampled_at
from fem.seismic.motion_set import FIRST_PERIOD_S, check_set, periods_of_check
from fem.seismic.oscillators import pseudo_accelerations

LARGEST_STEP_S = 0.005  #: records are sampled at least this densely while they are matched [s]
SHORTEST_PERIOD_S = 0.02
MATCHED_PERIODS = 70
LEVELLING_PASSES, PASSES = 4, 14
#: periods over which the gain is smooth, and length of its transform over that of the record
SMOOTHED, LENGTHENED = 7, 2
#: of the corrections found, in one pass, and of what one wavelet does to the oscillators of others
SHARE_OF_A_PASS, SHARE_OF_OTHERS = 0.8, 0.7


def scaled_records(
    records: Sequence[GroundMotion], action: MotionTarget, *, longest: float = LAST_PERIOD_S
) -> list[GroundMotion]:
    """Records scaled so that they fulfil 3.2.3.1.2(4)b and c together, and by no more than that.

    Each record is first scaled to the target in the mean of the logarithms over the band of periods; then one factor
    for all raises or lowers the set to the least that fulfils both.

    Args:
        records: as recorded; longest: end of the band of periods [s].
    """
    periods = periods_of_check(longest)
    periods = periods[(periods >= FIRST_PERIOD_S) & (periods <= longest * (1.0 + 1e-9))]
    target = action.horizontal(periods)
    scaled = []
    for record in records:
        spectrum = response_spectrum(record.step, record.horizontal, periods)
        scaled.append(record.scaled(math.exp(float(np.mean(np.log(target / spectrum))))))
    needed = check_set(scaled, action, longest=longest).factor_needed
    return [record.scaled(needed) for record in scaled]


def matched_records(
    records: Sequence[GroundMotion],
    action: MotionTarget,
    *,
    longest: float = LAST_PERIOD_S,
    second: float = 1.0,
) -> list[GroundMotion]:
    """Records whose components are matched by wavelets to the horizontal and the vertical spectrum.

    Args:
        records: as recorded; longest: period up to which they are matched [s].
        second: share of the horizontal spectrum for their second horizontal components, where there are any.

    A common factor above 1 follows where the set would miss 3.2.3.1.2(4)b or c without it.
    """
    matched = []
    for record in records:
        upward = across = None
        if record.vertical is not None:
            upward = _matched(record.step, record.vertical, action.vertical, longest)
        if record.second is not None and second > 0.0:
            across = second * _matched(record.step, record.second, action.horizontal, longest)
        matched.append(
            replace(
                record,
                step=min(record.step, LARGEST_STEP_S),
                horizontal=_matched(record.step, record.horizontal, action.horizontal, longest),
                vertical=upward,
                second=across,
                origin=f"{record.origin}, matched",
            )
        )
    needed = max(1.0, check_set(matched, action, longest=longest).factor_needed)
    return [record.scaled(needed) for record in matched]


@lru_cache(maxsize=2)
def _bank(
    step: float, count: int, longest: float
) -> tuple[FloatArray, list[tuple[FloatArray, FloatArray]], FloatArray]:
    """Periods (m,) [s], recursions from acceleration to pseudo-acceleration, responses to a unit sample (m, n)."""
    periods = np.geomspace(max(SHORTEST_PERIOD_S, 2.0 * step), longest, MATCHED_PERIODS)
    recursions, impulses = [], []
    unit = np.zeros(count)
    unit[0] = 1.0
    for period in periods.tolist():
        numerator, denominator = exact_recursion(step, period, DAMPING_RATIO)
        square = (2.0 * math.pi / period) ** 2
        recursions.append((square * np.array(numerator), np.array(denominator)))
        impulses.append(lfilter(*recursions[-1], unit))
    return periods, recursions, np.array(impulses)


def _matched(present_step: float, recorded: FloatArray, target: Target, longest: float) -> FloatArray:
    """The acceleration (n,) with wavelets added until its spectrum is the target, at `LARGEST_STEP_S` or finer."""
    step = min(present_step, LARGEST_STEP_S)
    acceleration = sampled_at(step, present_step, recorded)
    periods, recursions, impulses = _bank(step, acceleration.size, longest)
    times = np.arange(acceleration.size, dtype=np.float64) * step
    zero_end, wanted = ZeroEnd(times=times), target(periods)
    present = _levelled(step, acceleration, wanted, periods)
    present = present - zero_end.baseline(present)
    best, least = present, math.inf
    for _ in range(PASSES):
        responses = np.array([lfilter(*recursion, present) for recursion in recursions])
        samples, peaks = _peaks(responses)
        error = float(np.mean((np.abs(peaks) / wanted - 1.0) ** 2))
        if error < least:
            best, least = present, error
        waves = _wavelets(periods, times, samples)
        # of wavelet j on oscillator i at its sample (m, m)
        pairs = zip(impulses, samples.tolist(), strict=True)
        influence = np.array([waves[:, : sample + 1] @ impulse[sample::-1] for impulse, sample in pairs])
        own = np.diag(influence).copy()
        influence = SHARE_OF_OTHERS * influence / own
        np.fill_diagonal(influence, 1.0)
        missing = np.sign(peaks) * (wanted - np.abs(peaks))
        sizes = np.linalg.solve(influence, SHARE_OF_A_PASS * missing) / own
        present = present + sizes @ waves
        present = present - zero_end.baseline(present)
    return best


def _levelled(step: float, acceleration: FloatArray, wanted: FloatArray, periods: FloatArray) -> FloatArray:
    """The acceleration (n,) with a smooth gain over frequency that takes its spectrum near the target (m,).

    A wavelet lowers one peak of an oscillator; where a record has far too much of a frequency, many peaks follow.
    """
    length = next_fast_len(LENGTHENED * acceleration.size, real=True)
    with np.errstate(divide="ignore"):
        log_periods = np.log(np.clip(1.0 / np.fft.rfftfreq(length, step), periods[0], periods[-1]))
    weights = np.ones(SMOOTHED) / SMOOTHED
    for _ in range(LEVELLING_PASSES):
        ratios = np.log(wanted / pseudo_accelerations(step, acceleration, periods))
        smooth = np.convolve(np.pad(ratios, SMOOTHED // 2, mode="edge"), weights, mode="valid")
        gains = np.exp(np.interp(log_periods, np.log(periods), smooth))
        acceleration = irfft(rfft(acceleration, length) * gains, length)[: acceleration.size]
    return acceleration


def _peaks(responses: FloatArray) -> tuple[np.ndarray, FloatArray]:
    """Sample of the largest magnitude of each response (m, n), and the peak of the parabola through it, signed."""
    samples = np.argmax(np.abs(responses), axis=1)
    rows, last = np.arange(len(responses)), responses.shape[1] - 1
    before, at, after = (responses[rows, np.clip(samples + k, 0, last)] for k in (-1, 0, 1))
    curvature = before - 2.0 * at + after
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(curvature * at < 0.0, -((after - before) ** 2) / (8.0 * curvature), 0.0)
    return samples, at + rise


def _wavelets(periods: FloatArray, times: FloatArray, samples: np.ndarray) -> FloatArray:
    """A tapered cosine for each oscillator whose response to it peaks at its sample, shape (m, n) [-]."""
    damped = 2.0 * math.pi / periods * math.sqrt(1.0 - DAMPING_RATIO**2)
    lag = math.atan(math.sqrt(1.0 - DAMPING_RATIO**2) / DAMPING_RATIO) / damped
    width = 1.178 * periods**0.93
    shifted = times[None, :] - (times[samples] - lag)[:, None]
    waves = np.zeros_like(shifted)
    near = np.abs(shifted) < 5.0 * width[:, None]
    rates, widths = (np.broadcast_to(values[:, None], near.shape)[near] for values in (damped, width))
    waves[near] = np.cos(rates * shifted[near]) * np.exp(-((shifted[near] / widths) ** 2))
    return waves
