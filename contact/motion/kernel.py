"""Displacement, velocity and acceleration of the floor at one instant, as a compiled function.

Displacement is absolute and positive toward +x [m]; velocity [m/s] and acceleration [m/s2] are its exact
derivatives. At a jump of the acceleration the value after the jump is given. The motion is data (`FloorMotion`), so
that compiled stepping handles every kind; the classes of `contact.motion.base_motion` make these data.
"""

import math
from functools import partial
from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray
from contact.jit import compiled
from contact.structs import struct

# Meaning of `FloorMotion.kind`.
UNIFORM, HARMONIC, RECTANGULAR, HALF_SINE, SINE, PIECEWISE, SUM = 0, 1, 2, 3, 4, 5, 6
PART = 6  #: numbers of a part of a SUM in its parameters: its kind, and five parameters


@struct
class FloorMotion(NamedTuple):
    """A base motion as numbers and arrays for compiled code.

    `kind` chooses the formula and the meaning of `parameters`:

    - UNIFORM: time, displacement there, velocity; a floor at rest or coasting;
    - HARMONIC: amplitude, angular frequency, phase, length of each ramp, end of the drive;
    - RECTANGULAR, HALF_SINE, SINE: peak acceleration (signed), length, delay;
    - PIECEWISE: none; `breaks` are the knots, shape (k,) [s], and `coefficients`, shape (k + 1, 4), hold
      displacement, velocity, acceleration and jerk: row 0 before the first knot (referred to it), row i from
      knot i - 1 on;
    - SUM: kind and parameters of each part, harmonic or a pulse, one behind the other; besides a PIECEWISE one, where
      there are breaks.
    """

    kind: int
    parameters: FloatArray
    breaks: FloatArray
    coefficients: FloatArray


@partial(compiled, inline=True)
def _window(u: float) -> tuple[float, float, float]:
    """Smooth step from 0 at u <= 0 to 1 at u >= 1, and its first two derivatives; C2 (quintic Hermite)."""
    if u <= 0.0:
        return 0.0, 0.0, 0.0
    if u >= 1.0:
        return 1.0, 0.0, 0.0
    v = 1.0 - u
    return u * u * u * (10.0 - 15.0 * u + 6.0 * u * u), 30.0 * u * u * v * v, 60.0 * u * v * (v - u)


@partial(compiled, inline=True)
def _harmonic(parameters: FloatArray, time: float) -> tuple[float, float, float]:
    amplitude, omega, phase, ramp, end = parameters
    if time >= end:
        # A tapered drive has come back to zero; an untapered one stops where its velocity is zero.
        return (0.0 if ramp > 0.0 else amplitude * math.sin(omega * end + phase)), 0.0, 0.0
    sine, cosine = math.sin(omega * time + phase), math.cos(omega * time + phase)
    if ramp <= 0.0:
        return amplitude * sine, amplitude * omega * cosine, -amplitude * omega * omega * sine
    rise, rise_1, rise_2 = _window(time / ramp)
    fall, fall_1, fall_2 = _window((end - time) / ramp)
    w = rise * fall
    w_1 = (rise_1 * fall - rise * fall_1) / ramp
    w_2 = (rise_2 * fall - 2.0 * rise_1 * fall_1 + rise * fall_2) / (ramp * ramp)
    return (
        amplitude * w * sine,
        amplitude * (w_1 * sine + w * omega * cosine),
        amplitude * (w_2 * sine + 2.0 * w_1 * omega * cosine - w * omega * omega * sine),
    )


@compiled
def _pulse(kind: int, parameters: FloatArray, time: float) -> tuple[float, float, float]:
    peak, length, delay = parameters
    # The end is compared as delay + length, exactly the instant of `PulseMotion.break_times`.
    during = time < delay + length
    inside = min(max(time - delay, 0.0), length)
    if kind == RECTANGULAR:
        displacement, velocity, acceleration = 0.5 * peak * inside * inside, peak * inside, peak
    else:
        omega = (math.pi if kind == HALF_SINE else 2.0 * math.pi) / length
        half = math.sin(0.5 * omega * inside)
        velocity = 2.0 * peak / omega * half * half  # peak/omega (1 - cos), without the cancellation
        displacement = peak / omega * (inside - math.sin(omega * inside) / omega)
        acceleration = peak * math.sin(omega * inside)
    if not during:
        displacement += velocity * (time - delay - inside)
    return displacement, velocity, acceleration if during and time >= delay else 0.0


@compiled(inline=True)
def _row_at(breaks: FloatArray, time: float) -> int:
    """Number of breaks up to `time`; found at once where they are evenly spaced, as in a record."""
    count = breaks.size
    first, last = breaks[0], breaks[count - 1]
    if time < first:
        return 0
    if not time < last:
        return count
    row = min(int((time - first) / (last - first) * (count - 1)) + 1, count - 1)
    if time < breaks[row - 1]:
        row -= 1
    elif time >= breaks[row]:
        row += 1
    if breaks[row - 1] <= time < breaks[row]:
        return row
    row = 0  # by bisection: numba takes half a second for numpy's
    while row < count:
        middle = (row + count) // 2
        if breaks[middle] <= time:
            row = middle + 1
        else:
            count = middle
    return row


@compiled
def _piecewise(breaks: FloatArray, coefficients: FloatArray, time: float) -> tuple[float, float, float]:
    row = _row_at(breaks, time)
    x, v, a, jerk = coefficients[row, 0], coefficients[row, 1], coefficients[row, 2], coefficients[row, 3]
    s = time - breaks[max(row - 1, 0)]
    return (
        x + s * (v + s * (0.5 * a + s * jerk / 6.0)),
        v + s * (a + 0.5 * s * jerk),
        a + s * jerk,
    )


@compiled
def _sum(motion: FloorMotion, time: float) -> tuple[float, float, float]:
    x, v, a = 0.0, 0.0, 0.0
    if motion.breaks.size > 0:
        x, v, a = _piecewise(motion.breaks, motion.coefficients, time)
    for k in range(motion.parameters.size // PART):
        kind, own = int(motion.parameters[PART * k]), motion.parameters[PART * k + 1 : PART * (k + 1)]
        if kind == HARMONIC:
            part_x, part_v, part_a = _harmonic(own, time)
        else:
            part_x, part_v, part_a = _pulse(kind, own[:3], time)
        x, v, a = x + part_x, v + part_v, a + part_a
    return x, v, a


@partial(compiled, inline=True)
def floor_motion(motion: FloorMotion, time: float) -> tuple[float, float, float]:
    """Displacement [m], velocity [m/s] and acceleration [m/s2] of the floor at `time` [s]."""
    if motion.kind == HARMONIC:
        return _harmonic(motion.parameters, time)
    if motion.kind == PIECEWISE:
        return _piecewise(motion.breaks, motion.coefficients, time)
    if motion.kind == UNIFORM:
        start, displacement, velocity = motion.parameters
        return displacement + velocity * (time - start), velocity, 0.0
    if motion.kind == SUM:
        return _sum(motion, time)
    return _pulse(motion.kind, motion.parameters, time)


@compiled
def rare_motion(motion: FloorMotion, time: float) -> tuple[float, float, float]:
    """`floor_motion` by a call, where it is seldom needed."""
    return floor_motion(motion, time)


@compiled
def _fill_history(motion: FloorMotion, times: FloatArray, history: FloatArray) -> None:
    for i in range(times.size):
        history[0, i], history[1, i], history[2, i] = floor_motion(motion, times[i])


def floor_history(motion: FloorMotion, times: FloatArray) -> FloatArray:
    """`floor_motion` at many times: rows displacement, velocity, acceleration, shape (3, n_times)."""
    times = np.ascontiguousarray(times, dtype=np.float64)
    history = np.empty((3, times.size))
    _fill_history(motion, times, history)
    return history


def as_floor_motion(
    kind: int,
    parameters: tuple[float, ...] = (),
    *,
    breaks: FloatArray | None = None,
    coefficients: FloatArray | None = None,
) -> FloorMotion:
    """Make a motion with the array types of the compiled functions (contiguous float64)."""
    return FloorMotion(
        kind,
        np.array(parameters, dtype=np.float64),
        np.array(() if breaks is None else breaks, dtype=np.float64),
        np.array(np.zeros((1, 4)) if coefficients is None else coefficients, dtype=np.float64, order="C"),
    )
