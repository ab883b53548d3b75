"""Accelerations of floors for the analytic references: at rest, sines, pulses."""

import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from contact.arrays import FloatArray
from contact.reference.floor_acceleration import FloorAcceleration


def integrated(times: FloatArray, accelerations: FloatArray, until: float = math.inf) -> FloatArray:
    """Displacement [m] and velocity [m/s] at `until` [s] of a floor from rest, integrated knot by knot (n,)."""

    def rates(time: float, state: FloatArray) -> list[float]:
        return [state[1], float(np.interp(time, times, accelerations))]

    state = np.zeros(2)
    for low, high in zip(times[:-1], np.minimum(times[1:], until), strict=True):
        if high > low:
            state = solve_ivp(rates, (low, high), state, rtol=1e-12, atol=1e-14, method="DOP853").y[:, -1]
    return state


def still_floor() -> FloorAcceleration:
    """A floor that does not move, or moves at constant velocity."""
    return FloorAcceleration(function=lambda time: 0.0, longest_step=math.inf)


def sine_floor(*, amplitude: float, angular_frequency: float, phase: float = 0.0) -> FloorAcceleration:
    """Acceleration of a floor at x = A sin(Omega t + phase), in m, rad/s, rad: -A Omega^2 sin(Omega t + phase)."""
    peak = amplitude * angular_frequency**2
    return FloorAcceleration(
        function=lambda time: -peak * math.sin(angular_frequency * time + phase),
        longest_step=0.25 * math.pi / angular_frequency,
    )


def rectangular_pulse(*, peak: float, duration: float, delay: float = 0.0) -> FloorAcceleration:
    """Constant acceleration `peak` [m/s2] for `duration` [s] from `delay` [s] on, zero before and after."""
    return _pulse(lambda share: peak, duration, delay, math.inf)


def half_sine_pulse(*, peak: float, duration: float, delay: float = 0.0) -> FloorAcceleration:
    """peak x sin(pi t/duration) for half a period, zero before and after [m/s2]."""
    return _pulse(lambda share: peak * math.sin(math.pi * share), duration, delay, 0.25 * duration)


def one_sine_pulse(*, peak: float, duration: float) -> FloorAcceleration:
    """peak x sin(2 pi t/duration) for one period, zero before and after [m/s2]."""
    return _pulse(lambda share: peak * math.sin(2.0 * math.pi * share), duration, 0.0, 0.125 * duration)


def _pulse(
    shape: Callable[[float], float], duration: float, delay: float, longest_step: float
) -> FloorAcceleration:
    end = delay + duration

    def acceleration(time: float) -> float:
        return shape((time - delay) / duration) if delay <= time < end else 0.0

    return FloorAcceleration(function=acceleration, break_times=(delay, end), longest_step=longest_step)
