"""Acceleration of the contents: a causal low-pass Butterworth filter of two poles, applied while stepping.

    y'' + sqrt(2) w y' + w^2 y = w^2 v,    filtered acceleration a = y'

with v the velocity of a monitored point and w = 2 pi f the cut-off, where the amplitude falls by 3 dB (12 dB per octave
above). Filtering the velocity makes the answer to an impact the filter's impulse response, whatever the step. Before
t = 0 the velocity is taken as constant.

The points are observed at the first step end after each twentieth of 1/f, or at every step end where steps are longer.
In between v is the quadratic with the velocities at both ends and the displacement between them, so that vibration
faster than the interval is averaged, not aliased; the filter's answer to it is exact, for any interval.
"""

import math
from typing import Any

from contact.arrays import FloatArray
from contact.jit import compiled, inlined
from contact.stepping.body import observe
from contact.stepping.state import RunState

#: interval between two observations, and between two instants at which a maximum is looked for, over 1/w
OBSERVED, EVALUATED = 2.0 * math.pi / 20.0, 2.0 * math.pi / 60.0
#: rows of `RunState.contents`: position and velocity at the last observation, filtered velocity, its rate
POSITION, VELOCITY, FILTERED, ACCELERATION = 0, 1, 2, 3
#: rows of scratch: slope and bend of the velocity within the interval, and at its beginning its excess over the
#: filtered velocity and the acceleration
SLOPE, BEND, APART, BEGINNING = 4, 5, 6, 7


@inlined
def follow_contents(body: Any, run: RunState, step: float) -> None:
    """Follow the monitored points through the step about to be accepted; not where the run keeps no history."""
    clock, control = run.clock[0], run.problem.control
    if run.buffers.history.columns.shape[1] == 0:
        return
    if clock.steps == 0:
        observe(body, run.old, run.floor[0, 0], run.lift[0, 0])
        begin_contents(
            run.contents, run.old.monitor[control.top_monitors :], (run.floor[0, 0], run.lift[0, 0])
        )
        run.track[0].max_top_displacement = largest_sway(run.old.monitor[: control.top_monitors], 0.0)
    clock.unobserved += step
    if clock.unobserved * control.contents_cutoff < OBSERVED:
        return
    observe(body, run.attempt.new, run.floor[1, 0], run.lift[1, 0])
    monitor, top = run.attempt.new.monitor, control.top_monitors
    track = run.track[0]
    track.max_top_displacement = largest_sway(monitor[:top], track.max_top_displacement)
    track.max_acceleration = filter_contents(
        run.contents,
        monitor[top:],
        (run.floor[1, 0], run.lift[1, 0]),
        clock.unobserved,
        control.contents_cutoff,
        track.max_acceleration,
    )
    clock.unobserved = 0.0


@compiled
def largest_sway(monitor: FloatArray, largest: float) -> float:
    """Largest horizontal displacement of monitored points (n, 4) relative to the floor, or `largest` [m]."""
    for i in range(monitor.shape[0]):
        largest = max(largest, abs(monitor[i, 0]))
    return largest


@compiled
def begin_contents(contents: FloatArray, monitor: FloatArray, floor: tuple[float, float]) -> None:
    """Start the filter from the monitored points at t = 0; `floor` is its displacement along x and upward [m]."""
    for i in range(monitor.shape[0]):
        for k in range(2):
            contents[POSITION, 2 * i + k] = monitor[i, k] + floor[k]
            contents[VELOCITY, 2 * i + k] = monitor[i, 2 + k]
            contents[FILTERED, 2 * i + k] = monitor[i, 2 + k]
            contents[ACCELERATION, 2 * i + k] = 0.0


@compiled
def shift_contents(contents: FloatArray, velocity: tuple[float, float]) -> None:
    """Change to a frame that moves with this velocity along x and upward [m/s]."""
    for j in range(contents.shape[1]):
        contents[VELOCITY, j] -= velocity[j % 2]
        contents[FILTERED, j] -= velocity[j % 2]


@compiled
def filter_contents(
    contents: FloatArray,
    monitor: FloatArray,
    floor: tuple[float, float],
    step: float,
    cutoff: float,
    largest: float,
) -> float:
    """Advance the filter by one interval [s], in place; returns the largest filtered acceleration so far [m/s2].

    `contents`: (8, 2 n) of x and z of each point in turn; `monitor`: (n, 4) displacement relative to the floor [m]
    and velocity [m/s] at its end; `floor`: its displacement then, along x and upward [m]; `cutoff`: w [rad/s].
    """
    decay, per_step = cutoff / math.sqrt(2.0), 1.0 / step  # the poles are at decay (-1 +- i)
    lag = 1.0 / decay
    fading, ratio = math.exp(-decay * step), lag * per_step
    c, s = fading * math.cos(decay * step), fading * math.sin(decay * step)
    # Exact answer to v - y at the beginning, to slope and bend of v, and to the acceleration at the beginning.
    direct, trailing = 1.0 - c - s, step - s * lag
    by_slope = trailing - lag * direct
    by_bend = lag * (1.0 + ratio) * direct - (1.0 + 2.0 * ratio) * trailing + step
    rate_direct, rate_trailing = 2.0 * decay * s, 1.0 - c + s
    rate_by_slope = rate_trailing - lag * rate_direct
    rate_by_bend = lag * (1.0 + ratio) * rate_direct - (1.0 + 2.0 * ratio) * rate_trailing + 2.0
    for i in range(monitor.shape[0]):
        reach = 0.0
        for k in range(2):
            j = 2 * i + k
            x = monitor[i, k] + floor[k]
            before, after = contents[VELOCITY, j], monitor[i, 2 + k]
            filtered, acceleration = contents[FILTERED, j], contents[ACCELERATION, j]
            slope = (after - before) * per_step
            bend = 3.0 * (before + after - 2.0 * per_step * (x - contents[POSITION, j])) * per_step
            apart = before - filtered
            new = filtered + direct * apart + by_slope * slope + by_bend * bend + s * lag * acceleration
            rate = rate_direct * apart + rate_by_slope * slope + rate_by_bend * bend + (c - s) * acceleration
            size = abs(acceleration) + abs(rate)
            change = cutoff * (abs(apart) + abs(after - new)) + math.sqrt(2.0) * size
            reach += (size + 0.25 * cutoff * step * change) ** 2
            contents[SLOPE, j], contents[BEND, j], contents[APART, j] = slope, bend, apart
            contents[BEGINNING, j] = acceleration
            contents[POSITION, j], contents[VELOCITY, j] = x, after
            contents[FILTERED, j], contents[ACCELERATION, j] = new, rate
        # Search only where the acceleration may exceed the largest one: at an end, or from there at its rate of change.
        if reach > largest * largest:
            largest = _search(contents[:, 2 * i], contents[:, 2 * i + 1], step, cutoff, largest)
    return largest


@compiled
def _search(x: FloatArray, z: FloatArray, step: float, cutoff: float, largest: float) -> float:
    """Largest acceleration of a point within the interval whose scratch values these are, or `largest` [m/s2]."""
    decay, count = cutoff / math.sqrt(2.0), math.ceil(step * cutoff / EVALUATED)
    lag, part = 1.0 / decay, step / count
    fading = math.exp(-decay * part)
    cosine, sine = fading * math.cos(decay * part), fading * math.sin(decay * part)
    c, s, square = 1.0, 0.0, 0.0
    # The acceleration is q + 2 r t and a rest that decays from u, with v towards -u - v.
    qx = x[SLOPE] - (1.0 + 2.0 * lag / step) * x[BEND]
    qz = z[SLOPE] - (1.0 + 2.0 * lag / step) * z[BEND]
    ux, uz = x[BEGINNING] - qx, z[BEGINNING] - qz
    vx = ux + 2.0 * (x[SLOPE] - decay * x[APART] - (1.0 + lag / step) * x[BEND])
    vz = uz + 2.0 * (z[SLOPE] - decay * z[APART] - (1.0 + lag / step) * z[BEND])
    for k in range(1, count + 1):
        c, s = c * cosine - s * sine, s * cosine + c * sine
        ax = qx + 2.0 * x[BEND] * k / count + c * ux - s * vx
        az = qz + 2.0 * z[BEND] * k / count + c * uz - s * vz
        square = max(square, ax * ax + az * az)
    return max(largest, math.sqrt(square))
