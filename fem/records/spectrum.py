"""Response spectra and oscillator histories of an acceleration that is linear between its samples.

An oscillator of period T and damping ratio z follows x'' + 2 z w x' + w^2 x = -a, with x relative to the floor; it
starts at rest. The exact step of Nigam and Jennings (1969) becomes a recursion over two samples, so there is no error
of integration. The acceleration is zero after its last sample; the free vibration that follows counts.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm
from scipy.signal import lfilter

from fem.runtime.arrays import FloatArray

#: samples of a period from which the peaks between samples are found within 0.05 %
SAMPLES_PER_PERIOD = 10.0
#: steps of the shortest period that the samples describe
LEAST_STEPS = 2.0
DAMPING_RATIO = 0.05  #: usual for spectra


@dataclass(frozen=True, kw_only=True, eq=False)  # arrays have no single truth value
class Spectrum:
    """Largest magnitudes of the response of oscillators, each of shape (k,)."""

    periods_s: FloatArray
    damping_ratio: float
    displacement_m: FloatArray  #: relative to the floor
    pseudo_velocity_m_s: FloatArray  #: w times the displacement
    pseudo_acceleration_m_s2: FloatArray  #: w^2 times the displacement
    acceleration_m_s2: FloatArray  #: absolute


@dataclass(frozen=True, kw_only=True, eq=False)
class OscillatorHistory:
    """Response of one oscillator at the samples of the motion, each of shape (n,)."""

    displacement_m: FloatArray  #: relative to the floor
    velocity_m_s: FloatArray  #: relative to the floor
    acceleration_m_s2: FloatArray  #: absolute


@dataclass(frozen=True, kw_only=True)
class OscillatorStep:
    """Exact step of an oscillator under an acceleration that is linear within the step."""

    rate: float  #: angular frequency times the step [rad]
    damping_ratio: float
    displacement: tuple[
        float, float, float, float
    ]  #: from displacement, velocity x step, forcing before and after
    velocity: tuple[float, float, float, float]  #: times the step; from the same

    @property
    def recursion(self) -> tuple[list[float], list[float]]:
        """Numerator and denominator of displacement over forcing."""
        a11, a12, b1, c1 = self.displacement
        a21, a22, b2, c2 = self.velocity
        numerator = [c1, b1 - a22 * c1 + a12 * c2, a12 * b2 - a22 * b1]
        return numerator, [1.0, -(a11 + a22), a11 * a22 - a12 * a21]


def log_spaced_periods(
    step_s: float, shortest_s: float = 0.02, longest_s: float = 4.0, count: int = 100
) -> FloatArray:
    """Periods for a curve, shape (count,) [s]: evenly spaced logarithms, from what the step resolves."""
    return np.geomspace(max(shortest_s, LEAST_STEPS * step_s), longest_s, count)


def response_spectrum(
    step_s: float, acceleration: FloatArray, periods_s: FloatArray, damping_ratio: float = DAMPING_RATIO
) -> Spectrum:
    """Response spectrum of a sampled acceleration; exact for the straight lines through its samples.

    Args:
        step_s: between samples [s].
        acceleration: of the floor, shape (n,) [m/s2].
        periods_s: of the oscillators, shape (k,) [s].
        damping_ratio: of the oscillators, below 1.

    Raises:
        ValueError: a step, damping ratio or acceleration that is none; a period shorter than two steps, which the
            samples do not describe.

    Nigam and Jennings (1969), Bulletin of the Seismological Society of America 59. Peaks between samples count: below
    ten samples a period the lines are sampled more densely, and each peak is that of a cubic.
    """
    values, periods = _checked(step_s, acceleration, periods_s, damping_ratio)
    denser: dict[int, FloatArray] = {}
    displacement, absolute = np.empty(periods.size), np.empty(periods.size)
    for k, period in enumerate(periods.tolist()):
        parts = _parts(step_s, period)
        if parts not in denser:
            denser[parts] = _denser(values, parts)
        displacement[k], absolute[k] = _peaks(step_s / parts, denser[parts], period, damping_ratio)
    rates = 2.0 * math.pi / periods
    return Spectrum(
        periods_s=periods,
        damping_ratio=damping_ratio,
        displacement_m=displacement,
        pseudo_velocity_m_s=rates * displacement,
        pseudo_acceleration_m_s2=rates**2 * displacement,
        acceleration_m_s2=absolute,
    )


def oscillator_response(
    step_s: float, acceleration: FloatArray, period_s: float, damping_ratio: float = DAMPING_RATIO
) -> OscillatorHistory:
    """Response of one oscillator at the samples; arguments and errors as `response_spectrum`."""
    values, _ = _checked(step_s, acceleration, np.array([period_s]), damping_ratio)
    parts = _parts(step_s, period_s)
    step = step_s / parts
    x, v = _displacement_and_velocity(
        exact_oscillator(step, period_s, damping_ratio), step, _denser(values, parts)
    )
    x, v, rate = x[::parts], v[::parts] / step, 2.0 * math.pi / period_s
    return OscillatorHistory(
        displacement_m=x,
        velocity_m_s=v,
        acceleration_m_s2=-rate * (rate * x + 2.0 * damping_ratio * v),
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
            f"response spectrum: a period of {wrong[0]:g} s is asked; samples {step_s:g} s apart describe periods from "
            f"{LEAST_STEPS * step_s:g} s, two steps"
        )
    return values, periods


def _parts(step: float, period: float) -> int:
    """Into how many parts a step is divided, so that a period has enough of them."""
    return max(1, math.ceil(SAMPLES_PER_PERIOD * step / period * (1.0 - 1e-12)))


def _denser(values: FloatArray, parts: int) -> FloatArray:
    """The straight lines through samples, sampled `parts` times as densely."""
    if parts == 1:
        return values
    count = values.size - 1
    return np.asarray(np.interp(np.arange(count * parts + 1) / parts, np.arange(count + 1), values))


def exact_oscillator(step: float, period: float, damping_ratio: float) -> OscillatorStep:
    """The step from the exponential of the system of displacement, velocity, forcing and its slope over one step."""
    rate = 2.0 * math.pi * step / period
    system = np.zeros((4, 4))
    system[0, 1] = system[1, 2] = system[2, 3] = 1.0
    system[1, :2] = -(rate**2), -2.0 * damping_ratio * rate
    (a11, a12, b1, s1), (a21, a22, b2, s2) = expm(system)[:2].tolist()
    return OscillatorStep(
        rate=rate,
        damping_ratio=damping_ratio,
        displacement=(a11, a12, b1 - s1, s1),
        velocity=(a21, a22, b2 - s2, s2),
    )


def _displacement_and_velocity(
    oscillator: OscillatorStep, step: float, values: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Displacement, and velocity times the step, at the samples [m], shapes (n,)."""
    force = -(step**2) * values
    numerator, denominator = oscillator.recursion
    a11, a12, b1, c1 = oscillator.displacement
    # What the filter holds before the first sample, so that it begins at rest although the acceleration may not.
    held = [-numerator[0] * force[0], (b1 - numerator[1]) * force[0]]
    x = lfilter(numerator, denominator, force, zi=held)[0]
    v = np.empty_like(x)
    v[:-1] = (x[1:] - a11 * x[:-1] - b1 * force[:-1] - c1 * force[1:]) / a12
    before = np.array([x[-2], v[-2], force[-2], force[-1]])
    v[-1] = before @ np.array(oscillator.velocity)
    return x, v


def _peaks(step: float, values: FloatArray, period: float, damping_ratio: float) -> tuple[float, float]:
    """Largest |relative displacement| [m] and |absolute acceleration| [m/s2] of an oscillator."""
    oscillator = exact_oscillator(step, period, damping_ratio)
    x, v = _displacement_and_velocity(oscillator, step, values)
    rate = oscillator.rate
    # Absolute acceleration times the step squared, and its slope over a step.
    y = -rate * (rate * x + 2.0 * damping_ratio * v)
    slope = -rate * (rate * v + 2.0 * damping_ratio * (y - step**2 * values))
    free_slope = -rate * (rate * v[-1] + 2.0 * damping_ratio * y[-1])
    displacement = max(_largest(x, v), _largest_free(oscillator, float(x[-1]), float(v[-1])))
    absolute = max(_largest(y, slope), _largest_free(oscillator, float(y[-1]), float(free_slope)))
    return displacement, absolute / step**2


def _largest(values: FloatArray, slopes: FloatArray) -> float:
    """Largest magnitude of the cubics through values and slopes (over one step) at the samples."""
    turning = np.flatnonzero(slopes[:-1] * slopes[1:] < 0.0)
    y0, y1, m0, m1 = values[turning], values[turning + 1], slopes[turning], slopes[turning + 1]
    s = m0 / (m0 - m1)  # the slope is nearly linear there, and an error of s counts only squared
    t = 1.0 - s
    peaks = t * t * ((1.0 + 2.0 * s) * y0 + s * m0) + s * s * ((1.0 + 2.0 * t) * y1 - t * m1)
    return float(max(np.abs(values).max(), np.abs(peaks).max(initial=0.0)))


def _largest_free(oscillator: OscillatorStep, value: float, slope: float) -> float:
    """Magnitude at the first turning point of free vibration; `slope` over one step."""
    decay = oscillator.damping_ratio * oscillator.rate
    damped = oscillator.rate * math.sqrt(1.0 - oscillator.damping_ratio**2)
    angle = math.atan2(slope * damped, decay * slope + oscillator.rate**2 * value) % math.pi
    swing = value * math.cos(angle) + (slope + decay * value) / damped * math.sin(angle)
    return abs(math.exp(-decay * angle / damped) * swing)
