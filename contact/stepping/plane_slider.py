"""A body that slides on a floor that moves in its plane, and up and down: friction in a circle, own steps.

In the frame of the floor, per unit of mass, with the floor's horizontal acceleration a, its vertical one a_v, n = g +
a_v and the sliding velocity w:

    sticks while |a| <= mu_s n;   slides with w' = -a - mu_k n w/|w|;   flies while its gap z > 0: w' = -a, z'' = -n

It begins to slide against the floor's acceleration, -a/|a|. It sticks again where its velocity vanishes and |a| <=
mu_s n; with mu_s n >= |a| > mu_k n it would have to pass through zero velocity exactly, so below `AT_REST` counts as
zero. A body that has left the floor lands without rebound, and friction takes mu_k times its landing velocity, at
most all it has.

All accelerations are linear between samples. Breaking loose is the root of a quadratic, flight is a cubic. Sliding
takes adaptive steps of the stiffly accurate method of order three of R. Alexander, SIAM J. Numer. Anal. 14 (1977)
1006-1021. In its stages W = R - c (a + mu_k n W/|W|) has the solution W = Z max(0, 1 - c mu_k n/|Z|), Z = R - c a
(Moreau): no iteration, no regularised friction, no direction to be chosen at W = 0, and stable where the direction of
the friction follows that of the floor at once, as it does just after the body has broken loose. A straight slide is
exact.
"""

import math

from contact.arrays import FloatArray
from contact.jit import compiled, inlined

STICKS, SLIDES, FLIES = 0, 1, 2
AT_REST = 1e-6  #: sliding velocity that counts as none [m/s]
TOLERANCE = 1e-8  #: of the error of a step [m/s]
SHORTEST, FIRST = 1e-9, 1e-3  #: steps [s]
ROUNDING = 1e-12

#: of Alexander's method: the diagonal, the instant of the middle stage, other weights
DIAGONAL = 0.43586652150845899942
MIDDLE = 0.5 * (1.0 + DIAGONAL)
SECOND = 0.5 * (1.0 - DIAGONAL)
ONE, TWO = -1.5 * DIAGONAL**2 + 4.0 * DIAGONAL - 0.25, 1.5 * DIAGONAL**2 - 5.0 * DIAGONAL + 1.25
#: of the second divided differences of the rate, at the last three and at the first three of the beginning and the
#: stages: what the method differs by from an embedded one of order two
BENT = 0.5 * DIAGONAL * (1.0 - DIAGONAL) ** 2
LATER = (BENT / (SECOND * (1.0 - DIAGONAL)), -BENT / SECOND**2, BENT / (SECOND * (1.0 - DIAGONAL)))
EARLIER = (BENT / (DIAGONAL * MIDDLE), -BENT / (DIAGONAL * SECOND), BENT / (MIDDLE * SECOND))


@inlined
def _bend(first: float, second: float, third: float, weights: tuple[float, float, float]) -> float:
    """A weighted sum that vanishes where the rate is linear."""
    return weights[0] * first + weights[1] * second + weights[2] * third


@inlined
def _shrunk(x: float, y: float, less: float) -> tuple[float, float]:
    """A vector shortened by a length, at most to zero."""
    length = math.hypot(x, y)
    if length <= less:
        return 0.0, 0.0
    share = 1.0 - less / length
    return share * x, share * y


@compiled
def _until_loose(
    x: float, y: float, n: float, slopes: tuple[float, float, float], mu: float, rest: float
) -> float:
    """How long |a| <= mu n still holds, at most `rest` [s]; accelerations now, and their rates of change."""
    c = x * x + y * y - mu * mu * n * n
    if c > 0.0 or n < 0.0:
        return 0.0
    b = 2.0 * (x * slopes[0] + y * slopes[1] - mu * mu * n * slopes[2])
    a = slopes[0] * slopes[0] + slopes[1] * slopes[1] - mu * mu * slopes[2] * slopes[2]
    square = b * b - 4.0 * a * c
    if square <= 0.0 or (b <= 0.0 and a <= 0.0):
        return rest
    root = math.sqrt(square)
    after = -2.0 * c / (b + root) if b > 0.0 else (root - b) / (2.0 * a)
    return min(after, rest)


@compiled
def _until_landing(gap: float, rising: float, n: float, slope: float, rest: float) -> float:
    """When the gap closes, or `rest` where it is open then [s]."""
    low, high = 0.0, rest
    if gap + rest * (rising - rest * (0.5 * n + rest * slope / 6.0)) > 0.0:
        return rest
    while high - low > ROUNDING * rest:
        middle = 0.5 * (low + high)
        if gap + middle * (rising - middle * (0.5 * n + middle * slope / 6.0)) > 0.0:
            low = middle
        else:
            high = middle
    return high


@compiled
def slide_over(
    times: FloatArray,
    acceleration: FloatArray,
    friction: tuple[float, float],
    gravity: float,
    slip: FloatArray,
    velocity: FloatArray,
) -> None:
    """Follow a body that starts at rest on its floor.

    Args:
        times: increasing, (n,) [s]; acceleration: of the floor, rows x, y, upward, (3, n) [m/s2].
        friction: mu_static, mu_kinetic; gravity: [m/s2].
        slip: filled with the displacement over the floor, (n, 2) [m].
        velocity: filled with the sliding velocity at the last sample, (2,) [m/s].
    """
    mu_static, mu_kinetic = friction
    state, step = STICKS, FIRST
    u = v = w = q = gap = rising = 0.0  # displacement (u, v), velocity (w, q)
    slip[0, 0] = slip[0, 1] = 0.0
    for i in range(times.size - 1):
        length = times[i + 1] - times[i]
        dx = (acceleration[0, i + 1] - acceleration[0, i]) / length
        dy = (acceleration[1, i + 1] - acceleration[1, i]) / length
        dn = (acceleration[2, i + 1] - acceleration[2, i]) / length
        s = 0.0
        while length - s > ROUNDING * length:
            rest = length - s
            x, y = acceleration[0, i] + s * dx, acceleration[1, i] + s * dy
            n = gravity + acceleration[2, i] + s * dn
            if n + rest * dn < 0.0 < n and state != FLIES:
                rest = min(rest, -n / dn)
            if state == STICKS:
                s += _until_loose(x, y, n, (dx, dy, dn), mu_static, rest)
                if length - s > ROUNDING * length:
                    state = SLIDES
                continue
            if state == FLIES:
                h = _until_landing(gap, rising, n, dn, rest)
                u += h * (w - h * (0.5 * x + h * dx / 6.0))
                v += h * (q - h * (0.5 * y + h * dy / 6.0))
                w -= h * (x + 0.5 * h * dx)
                q -= h * (y + 0.5 * h * dy)
                gap += h * (rising - h * (0.5 * n + h * dn / 6.0))
                rising -= h * (n + 0.5 * h * dn)
                if h < rest or gap <= 0.0:
                    w, q = _shrunk(w, q, mu_kinetic * max(-rising, 0.0))
                    state, gap, rising = SLIDES, 0.0, 0.0
                s += max(h, ROUNDING * length)
                continue
            if n < -ROUNDING * gravity or (dn < 0.0 and n <= ROUNDING * gravity):
                state = FLIES
                continue
            h = min(step, rest)
            c = DIAGONAL * h
            w1, q1 = _shrunk(
                w - c * (x + c * dx), q - c * (y + c * dy), c * mu_kinetic * max(n + c * dn, 0.0)
            )
            j1, k1 = (w1 - w) / c, (q1 - q) / c
            m, x2, y2 = MIDDLE * h, w + SECOND * h * j1, q + SECOND * h * k1
            w2, q2 = _shrunk(
                x2 - c * (x + m * dx), y2 - c * (y + m * dy), c * mu_kinetic * max(n + m * dn, 0.0)
            )
            j2, k2 = (w2 - x2) / c, (q2 - y2) / c
            x3, y3 = w + h * (ONE * j1 + TWO * j2), q + h * (ONE * k1 + TWO * k2)
            w3, q3 = _shrunk(
                x3 - c * (x + h * dx), y3 - c * (y + h * dy), c * mu_kinetic * max(n + h * dn, 0.0)
            )
            j3, k3 = (w3 - x3) / c, (q3 - y3) / c
            before, speed = math.hypot(w, q), math.hypot(w3, q3)
            error = h * math.hypot(_bend(j1, j2, j3, LATER), _bend(k1, k2, k3, LATER))
            if before > 0.0:  # else it has no direction yet
                grip = mu_kinetic * max(n, 0.0) / before
                early = math.hypot(
                    _bend(-x - grip * w, j1, j2, EARLIER), _bend(-y - grip * q, k1, k2, EARLIER)
                )
                error = max(error, h * early)
            stops_early = speed == 0.0 and before > AT_REST
            if h > SHORTEST and (error > TOLERANCE or stops_early):
                step = 0.5 * h if stops_early else h * max(0.2, 0.9 * (TOLERANCE / error) ** (1.0 / 3.0))
                step = max(step, SHORTEST)
                continue
            growth = 0.9 * (TOLERANCE / max(error, ROUNDING * TOLERANCE)) ** (1.0 / 3.0)
            step = max(step, h * min(4.0, growth))
            u += h * (ONE * w1 + TWO * w2 + DIAGONAL * w3)
            v += h * (ONE * q1 + TWO * q2 + DIAGONAL * q3)
            w, q, s = w3, q3, s + h
            holds = mu_static * max(gravity + acceleration[2, i] + s * dn, 0.0)
            if speed <= AT_REST and math.hypot(x + h * dx, y + h * dy) <= holds:
                state, w, q = STICKS, 0.0, 0.0
        slip[i + 1, 0], slip[i + 1, 1] = u, v
    velocity[0], velocity[1] = w, q
