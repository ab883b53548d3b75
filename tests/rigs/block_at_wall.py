"""A rigid block that falls back from a tilt on its two corners and against a wall at its top, by explicit steps.

It has the springs, dashpots and friction of the program at three points, and nothing else of it: semi-implicit Euler
with steps far below every period. The wall stands where the block touches it as it lies flat, so that its other
corner lands and its top strikes at once: no sequence of impacts says what follows, only the stiffness of both.
"""

import math

import numba
import numpy as np


@numba.njit(cache=True)
def fall_back(half_width, middle, mass, tilt, floor, mu, wall, step, duration, gravity=9.81):
    """When the other corner lands [s], and the largest rotation later than `SETTLED` after it [rad].

    Args:
        half_width, middle: b and height of the mass centre, half the height [m].
        tilt: at the start, to the right; at rest on the right corner [rad].
        floor, wall: stiffness of a point [N/m] and dashpot over spring [s]; the wall is smooth.
        mu: of the floor, whose tangential springs and dashpots are as the normal ones.
    """
    inertia = mass * (half_width**2 + middle**2) / 3.0
    px, pz = np.array([-half_width, half_width, -half_width]), np.array([-middle, -middle, middle])
    x = half_width - (half_width * math.cos(tilt) - middle * math.sin(tilt))
    z = middle * math.cos(tilt) + half_width * math.sin(tilt) - mass * gravity / floor[0]
    turn, u, w, spin, stick = tilt, 0.0, 0.0, 0.0, np.zeros(2)
    landed, rebound = math.inf, 0.0
    for k in range(int(duration / step)):
        cosine, sine = math.cos(turn), math.sin(turn)
        force_x, force_z, moment = 0.0, -mass * gravity, 0.0
        for i in range(3):
            rx, rz = cosine * px[i] + sine * pz[i], cosine * pz[i] - sine * px[i]
            vx, vz = u + spin * rz, w - spin * rx
            depth = -(z + rz) if i < 2 else -(x + rx + half_width)
            if depth <= 0.0:
                if i < 2:
                    stick[i] = 0.0
                continue
            if i == 2:
                across, normal = max(wall[0] * (depth - wall[1] * vx), 0.0), 0.0
            else:
                normal, before = max(floor[0] * (depth - floor[1] * vz), 0.0), stick[i]
                stick[i] += step * vx
                across = -floor[0] * (stick[i] + floor[1] * vx)
                if abs(across) > mu * normal:
                    across = math.copysign(mu * normal, across)
                    rest = -across / floor[0]
                    stick[i] = rest + (before - rest) * math.exp(-step / floor[1])
                if i == 0:
                    landed = min(landed, k * step)
            force_x += across
            force_z += normal
            moment += rz * across - rx * normal
        u += step * force_x / mass
        w += step * force_z / mass
        spin += step * moment / inertia
        x += step * u
        z += step * w
        turn += step * spin
        if k * step > landed + SETTLED:
            rebound = max(rebound, turn)
    return landed, rebound


SETTLED = 0.02  #: after a landing, of its springs [s]
