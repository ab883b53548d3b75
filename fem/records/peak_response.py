"""The peaks of oscillators under a sampled acceleration, compiled.

The steps are those of `fem.records.spectrum`, and so are the symbols: q = x' - m* x turns by exp(m h) in a step.
"""

import math
from pathlib import Path

from contact.jit import compiled
from fem.runtime.arrays import FloatArray


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


def _peaks_of(
    values: FloatArray, step: float, damping_ratio: float, steps: FloatArray, peaks: FloatArray
) -> None:
    """Largest |relative displacement| [m] and |absolute acceleration| [m/s2] of oscillators.

    Args:
        values: acceleration of the floor, (n,) [m/s2]; zero after its last sample.
        step: between its samples [s].
        steps: of the oscillators, (k, 10): rate w, parts of a step between samples, and real and imaginary parts of
            the root m, of its factor exp(m h), and of the factors of the accelerations before and after a part h.
        peaks: (k, 2), written.
    """
    for k in range(steps.shape[0]):
        rate, parts, root, damped = steps[k, 0], int(steps[k, 1]), steps[k, 2], steps[k, 3]
        turn_re, turn_im, before_re, before_im = steps[k, 4], steps[k, 5], steps[k, 6], steps[k, 7]
        after_re, after_im = steps[k, 8], steps[k, 9]
        h, double, inverse = step / parts, 2.0 * damping_ratio, 1.0 / damped
        re, im, x, v, y = 0.0, 0.0, 0.0, 0.0, 0.0
        last, slope = values[0], rate * double * values[0]
        most_x, most_y = 0.0, 0.0
        for sample in range(1, values.size):
            begin, rise = values[sample - 1], (values[sample] - values[sample - 1]) / parts
            for part in range(parts):
                now = begin + (part + 1) * rise if part < parts - 1 else values[sample]
                re, im = (
                    turn_re * re - turn_im * im + before_re * last + after_re * now,
                    turn_re * im + turn_im * re + before_im * last + after_im * now,
                )
                x0, v0, y0, slope_0 = x, v, y, slope
                x = im * inverse
                v = re + root * x
                y = -rate * (rate * x + double * v)
                slope = -rate * (rate * v + double * (y - now))
                most_x = _between(h, x0, x, v0, v, most_x)
                most_y = _between(h, y0, y, slope_0, slope, most_y)
                last = now
        free_slope = -rate * (rate * v + double * y)
        peaks[k, 0] = max(most_x, _free(rate, damping_ratio, x, v))
        peaks[k, 1] = max(most_y, _free(rate, damping_ratio, y, free_slope))


peaks_of = compiled(_peaks_of, sources=(Path(__file__),))
