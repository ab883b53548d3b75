"""Intensity measures of a motion: peaks, Arias intensity, significant duration.

The acceleration is linear between its samples and zero outside them; velocity and displacement start at zero.
"""

import math
from dataclasses import dataclass

import numpy as np

from contact.motion.samples import sampled_motion
from fem.records.units import STANDARD_GRAVITY
from fem.runtime.arrays import FloatArray

#: shares of the Arias intensity between which a motion is significant
SIGNIFICANT = (0.05, 0.95)


@dataclass(frozen=True, kw_only=True)
class Intensity:
    """Intensity measures of a motion; peaks are magnitudes."""

    peak_acceleration_m_s2: float
    peak_velocity_m_s: float
    peak_displacement_m: float
    arias_m_s: float
    significant_s: float  #: D5-95: from 5 % to 95 % of the Arias intensity


def intensity(times_s: FloatArray, acceleration: FloatArray) -> Intensity:
    """Intensity measures of an acceleration [m/s2] at rising times [s], both of shape (n,).

    Arias (1970): pi/(2 g) times the integral of a^2. Trifunac and Brady (1975): the significant duration. Peaks of
    velocity between samples count; the displacement is that at samples.
    """
    steps = np.diff(times_s)
    before, after = acceleration[:-1], acceleration[1:]
    squares = np.cumsum(steps * (before**2 + before * after + after**2) / 3.0)
    displacement, velocity, _ = sampled_motion(times_s, acceleration, "acceleration")
    # Where the acceleration passes through zero the velocity turns.
    through = before * after < 0.0
    turning = velocity[:-1][through] + 0.5 * before[through] ** 2 * steps[through] / (before - after)[through]
    begin, end = np.interp(np.array(SIGNIFICANT) * squares[-1], np.append(0.0, squares), times_s).tolist()
    return Intensity(
        peak_acceleration_m_s2=float(np.abs(acceleration).max()),
        peak_velocity_m_s=float(max(np.abs(velocity).max(), np.abs(turning).max(initial=0.0))),
        peak_displacement_m=float(np.abs(displacement).max()),
        arias_m_s=math.pi / (2.0 * STANDARD_GRAVITY) * float(squares[-1]),
        significant_s=end - begin if squares[-1] > 0.0 else 0.0,
    )
