"""A rigid block on two plates of many elastoplastic points, by semi-implicit Euler with steps of microseconds.

Nothing of the program's stepping is in it: each point has a spring with a dashpot that never pulls, in series with a
plastic slider, and a stuck spring along the floor that slides at its friction.
"""

import math

import numpy as np
from numba import njit


@njit(cache=True)
def _rock(
    mass, inertia, height, gravity, x, rise, k, tau, cap, mu, peak, period, duration, step
):  # pragma: no cover - compiled
    n = x.size
    place_x, place_z, turn = 0.0, height - mass * gravity / k.sum(), 0.0
    speed_x, speed_z, rate = 0.0, 0.0, 0.0
    crushed, stick, largest, time = np.zeros(n), np.zeros(n), 0.0, 0.0
    for _ in range(int(duration / step)):
        floor = peak * math.sin(2.0 * math.pi * time / period) if time < period else 0.0
        along, up, moment = 0.0, 0.0, 0.0
        cosine, sine = math.cos(turn), math.sin(turn)
        for i in range(n):
            arm_x = x[i] * cosine + (rise[i] - height) * sine
            arm_z = -x[i] * sine + (rise[i] - height) * cosine
            slip, climb = speed_x + rate * arm_z, speed_z - rate * arm_x
            sunk = -(place_z + arm_z)
            if sunk <= crushed[i]:
                stick[i] = 0.0
                continue
            normal = k[i] * (sunk - crushed[i] - tau * climb)
            if normal > cap[i]:  # the spring holds the cap and relaxes; the rest stays in the floor
                normal, crushed[i] = cap[i], max(crushed[i], sunk - cap[i] / k[i])
            normal = max(normal, 0.0)
            stick[i] += slip * step
            force = -k[i] * (stick[i] + tau * slip)
            if abs(force) > mu * normal:
                force = math.copysign(mu * normal, force)
                stick[i] = -force / k[i]
            along, up, moment = along + force, up + normal, moment + arm_z * force - arm_x * normal
        speed_x += step * (along / mass - floor)
        speed_z += step * (up / mass - gravity)
        rate += step * moment / inertia
        place_x, place_z, turn = place_x + step * speed_x, place_z + step * speed_z, turn + step * rate
        time += step
        largest = max(largest, abs(turn))
        if largest > 1.5:
            break
    return largest


def largest_rotation(
    *,
    mass,
    inertia,
    half_width,
    height,
    plate,
    stiffness,
    cap,
    relaxation_time,
    mu,
    peak,
    period,
    duration,
    tilt=0.0,
    points=21,
    step=4e-6,
):
    """Largest rotation under one sine of the floor's acceleration [rad]; 1.5 and more: it falls.

    Args:
        plate: length of the plates under both ends [m]; stiffness, cap: of one plate [N/m], [N].
        tilt: how far the outer edges of the plates stand higher than the inner ones [m].
        points: of a plate, evenly spaced, those at its ends with half a share.
    """
    inward = np.linspace(0.0, plate, points)
    share = np.full(points, 1.0 / (points - 1))
    share[[0, -1]] *= 0.5
    x = np.concatenate([inward - half_width, half_width - inward])
    rise = -tilt * (half_width - np.abs(x)) / plate
    both = np.tile(share, 2)
    return _rock(
        mass, inertia, height, 9.81, x, rise - rise.min(), stiffness * both, relaxation_time, cap * both, mu,
        peak, period, duration, step,
    )  # fmt: skip
