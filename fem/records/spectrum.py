"""Response spectra and oscillator histories of an acceleration that is linear between its samples.

An oscillator of period T and damping ratio d follows x'' + 2 d w x' + w^2 x = -a, with x relative to the floor; it
starts at rest. The step is exact, that of Nigam and Jennings (1969), and written for q = x' - m* x, with m the root
-d w + i w sqrt(1 - d^2) and m* its conjugate: q' = m q - a. The acceleration is zero after its last sample; the free
vibration that follows counts. The steps of `_peaks_of`, compiled, are the same: q turns by exp(m h).
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from contact.jit import compiled
from fem.runtime.arrays import FloatArray

SAMPLES_PER_PERIOD = 10.0  #: from which the peaks between samples are found within 0.05 %
LEAST_STEPS = 2.0  #: of the shortest period that the samples describe
DAMPING_RATIO = 0.05  #: usual for spectra
EQUAL = 1e-3  #: share of their mean within which intervals count as equal
MOST_SAMPLES = 2_000_000  #: of a motion whose intervals differ
MOST_GROWTH = 7.0  #: exponent by which the sums of a block may grow: three of sixteen digits

ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True, eq=False)  # arrays have no single truth value
class OscillatorHistory:
    """Response of one oscillator at the samples of the motion, each of shape (n,)."""

    displacement_m: FloatArray  #: relative to the floor
    velocity_m_s: FloatArray  #: relative to the floor
    acceleration_m_s2: FloatArray  #: absolute


def log_spaced_periods(step_s: float, longest_s: float = 4.0) -> FloatArray:
    """Periods for a curve, shape (100,) [s]: evenly spaced logarithms, from 0.02 s or what the step resolves."""
    return np.geomspace(max(0.02, LEAST_STEPS * step_s), longest_s, 100)


def evenly_sampled(times_s: FloatArray, acceleration: FloatArray) -> tuple[float, FloatArray]:
    """Step [s] and accelerations of a motion for its spectrum.

    Where its intervals differ, the straight lines between its samples are sampled at half of the shortest.
    """
    steps, length = np.diff(times_s), float(np.ptp(times_s))
    step = length / steps.size
    if np.abs(steps - step).max() <= EQUAL * step:
        return step, acceleration
    count = min(math.ceil(2.0 * length / float(steps.min()) * (1.0 - EQUAL)), MOST_SAMPLES)
    even = np.linspace(times_s[0], times_s[-1], count + 1)
    return length / count, np.asarray(np.interp(even, times_s, acceleration))


def response_spectrum(
    step_s: float, acceleration: FloatArray, periods_s: FloatArray, damping_ratio: float = DAMPING_RATIO
) -> FloatArray:
    """Largest pseudo-accelerations of oscillators, w^2 times the displacement, w = 2 pi / period, shape (k,) [m/s2].

    Exact for the straight lines through the samples.

    Args:
        step_s: between samples [s].
        acceleration: of the floor, shape (n,) [m/s2].
        periods_s: of the oscillators, shape (k,), at least two steps, below which the samples say nothing [s].
        damping_ratio: of the oscillators, below 1.

    Raises:
        ValueError: any of them is out of range.

    Nigam and Jennings (1969), Bulletin of the Seismological Society of America 59. Peaks between samples count: below
    ten samples a period the lines are sampled more densely, and each peak is that of a cubic.
    """
    values, periods = _checked(step_s, acceleration, periods_s, damping_ratio)
    steps = np.empty((periods.size, 10))
    for k, period in enumerate(periods.tolist()):
        parts = _parts(step_s, period)
        root, before, after = _step(step_s / parts, period, damping_ratio)
        factors = np.array([root, complex(np.exp(root * step_s / parts)), before, after])
        steps[k] = 2.0 * math.pi / period, parts, *factors.view(np.float64)
    peaks = np.empty(periods.size)
    _peaks_of(values, step_s, damping_ratio, steps, peaks)
    return (2.0 * math.pi / periods) ** 2 * peaks


def oscillator_response(
    step_s: float, acceleration: FloatArray, period_s: float, damping_ratio: float = DAMPING_RATIO
) -> OscillatorHistory:
    """Response of one oscillator at the samples; arguments and errors as `response_spectrum`."""
    values, _ = _checked(step_s, acceleration, np.array([period_s]), damping_ratio)
    parts, count = _parts(step_s, period_s), values.size - 1
    if parts > 1:  # the straight lines, sampled as densely
        values = np.asarray(np.interp(np.arange(count * parts + 1) / parts, np.arange(count + 1), values))
    root, before, after = _step(step_s / parts, period_s, damping_ratio)
    impulses = np.zeros(values.size, dtype=np.complex128)
    impulses[1:] = before * values[:-1] + after * values[1:]
    q = _summed_up(impulses, root * (step_s / parts))
    x = q.imag / root.imag
    v, rate = q.real + root.real * x, 2.0 * math.pi / period_s
    x, v = x[::parts], v[::parts]
    return OscillatorHistory(
        displacement_m=x, velocity_m_s=v, acceleration_m_s2=-rate * (rate * x + 2.0 * damping_ratio * v)
    )


def _checked(
    step_s: float, acceleration: FloatArray, periods_s: FloatArray, damping_ratio: float
) -> tuple[FloatArray, FloatArray]:
    values = np.ascontiguousarray(acceleration, dtype=np.float64)
    periods = np.atleast_1d(np.asarray(periods_s, dtype=np.float64))
    if not 0.0 < step_s < math.inf:
        raise ValueError(f"response spectrum: the step between samples must be positive, got {step_s} s")
    if not 0.0 <= damping_ratio < 1.0:
        raise ValueError(f"response spectrum: the damping ratio must lie in [0, 1), got {damping_ratio}")
    if values.ndim != 1 or values.size < 2:
        raise ValueError(f"response spectrum: two samples or more are needed, got an array {values.shape}")
    if not np.isfinite(values).all():
        sample = int(np.flatnonzero(~np.isfinite(values))[0])
        raise ValueError(f"response spectrum: sample {sample + 1} is not a finite number ({values[sample]})")
    shortest = LEAST_STEPS * step_s * (1.0 - 1e-9)
    wrong = periods[~((periods >= shortest) & (periods < math.inf))]
    if wrong.size:
        raise ValueError(
            f"response spectrum: a period of {wrong[0]:g} s is out of range: samples {step_s:g} s apart describe "
            f"periods from {LEAST_STEPS * step_s:g} s, two steps"
        )
    return values, periods


def _parts(step: float, period: float) -> int:
    """Into how many parts a step is divided, so that a period has enough of them."""
    return max(1, math.ceil(SAMPLES_PER_PERIOD * step / period * (1.0 - 1e-12)))


def exact_recursion(step: float, period: float, damping_ratio: float) -> tuple[list[float], list[float]]:
    """Numerator and denominator, three numbers each, of the filter that makes relative displacements of accelerations.

    For an acceleration that rises from zero in the step before its first sample.
    """
    root, before, after = _step(step, period, damping_ratio)
    decay = complex(np.exp(root * step))
    numerator = [after, before - after * decay.conjugate(), -before * decay.conjugate()]
    return [term.imag / root.imag for term in numerator], [1.0, -2.0 * decay.real, abs(decay) ** 2]


def _step(step: float, period: float, damping_ratio: float) -> tuple[complex, complex, complex]:
    """The root m, and the factors of the accelerations before and after a step in its impulse."""
    rate = 2.0 * math.pi / period
    root = rate * complex(-damping_ratio, math.sqrt(1.0 - damping_ratio**2))
    turn = root * step
    first = complex(np.expm1(turn)) / turn
    second = (first - 1.0) / turn
    return root, -step * (first - second), -step * second


def _summed_up(impulses: ComplexArray, turn: complex) -> ComplexArray:
    """q_k = exp(turn) q_k-1 + impulse_k from q = 0, shape (n,).

    Within a block it is exp(k turn) times the sum of the impulses times exp(-k turn), which must not grow too much.
    """
    count = impulses.size
    length = min(count, max(1, int(MOST_GROWTH / max(-turn.real, 1e-300))))
    blocks = np.zeros((-(-count // length), length), dtype=np.complex128)
    blocks.reshape(-1)[:count] = impulses
    turns = np.exp(turn * np.arange(length))
    np.cumsum(blocks * np.exp(-turn * np.arange(length)), axis=1, out=blocks)
    before, over = 0.0 + 0.0j, complex(np.exp(turn))
    for block in blocks:
        block += before
        before = over * complex(block[-1] * turns[-1])
    return (blocks * turns).reshape(-1)[:count]


@compiled(inline=True)
def _between(step: float, y0: float, y1: float, m0: float, m1: float, largest: float) -> float:
    """The largest magnitude so far, that of the cubic through two samples and its turning point included."""
    largest = max(largest, abs(y1))
    if m0 * m1 < 0.0:
        s = m0 / (m0 - m1)  # the slope is nearly linear there, and an error of s counts only squared
        t = 1.0 - s
        turning = t * t * ((1.0 + 2.0 * s) * y0 + s * step * m0) + s * s * (
            (1.0 + 2.0 * t) * y1 - t * step * m1
        )
        largest = max(largest, abs(turning))
    return largest


@compiled(inline=True)
def _free(rate: float, damping_ratio: float, value: float, slope: float) -> float:
    """Magnitude at the first turning point of free vibration."""
    decay, damped = damping_ratio * rate, rate * math.sqrt(1.0 - damping_ratio**2)
    angle = math.atan2(slope * damped, decay * slope + rate**2 * value)
    angle += math.pi if angle < 0.0 else 0.0
    swing = value * math.cos(angle) + (slope + decay * value) / damped * math.sin(angle)
    return abs(math.exp(-decay * angle / damped) * swing)


@compiled(sources=(Path(__file__),))
def _peaks_of(
    values: FloatArray, step: float, damping_ratio: float, steps: FloatArray, peaks: FloatArray
) -> None:
    """Largest |relative displacement| of oscillators.

    Args:
        values: acceleration of the floor, (n,) [m/s2]; zero after its last sample.
        step: between its samples [s].
        steps: of the oscillators, (k, 10): rate w, parts of a step between samples, and real and imaginary parts of
            the root m, of its factor exp(m h), and of the factors of the accelerations before and after a part h.
        peaks: (k,), written [m].
    """
    for k in range(steps.shape[0]):
        rate, parts, root, damped = steps[k, 0], int(steps[k, 1]), steps[k, 2], steps[k, 3]
        turn_re, turn_im, before_re, before_im = steps[k, 4], steps[k, 5], steps[k, 6], steps[k, 7]
        after_re, after_im = steps[k, 8], steps[k, 9]
        h, inverse = step / parts, 1.0 / damped
        re, im, x, v = 0.0, 0.0, 0.0, 0.0
        last, most = values[0], 0.0
        for sample in range(1, values.size):
            begin, rise = values[sample - 1], (values[sample] - values[sample - 1]) / parts
            for part in range(parts):
                now = begin + (part + 1) * rise if part < parts - 1 else values[sample]
                re, im = (
                    turn_re * re - turn_im * im + before_re * last + after_re * now,
                    turn_re * im + turn_im * re + before_im * last + after_im * now,
                )
                x0, v0 = x, v
                x = im * inverse
                v = re + root * x
                most = _between(h, x0, x, v0, v, most)
                last = now
        peaks[k] = max(most, _free(rate, damping_ratio, x, v))
