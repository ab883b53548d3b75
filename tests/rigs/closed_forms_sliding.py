"""Closed forms for a rigid slider with Coulomb friction under simple floor motions.

`friction_ratio` is kappa = mu_k g/(A Omega^2), `static_ratio` is mu_s/mu_k >= 1; the floor moves as
A sin(Omega t) for ever. Den Hartog, Trans. ASME APM-53-9 (1931), and Westermo and Udwadia, Earthquake Engng
Struct. Dyn. 11 (1983), for the sine; Newmark, Geotechnique 15 (1965), for the pulse.
"""

import math

from scipy.optimize import brentq


def sticks(*, peak_acceleration: float, mu_static: float, gravity: float) -> bool:
    """Whether a slider never moves: peak floor acceleration <= mu_s g. Any floor motion."""
    return abs(peak_acceleration) <= mu_static * gravity


def never_stops_ratio(static_ratio: float) -> float:
    """Friction ratio up to which the steady motion slides without stops: 1/sqrt((mu_s/mu_k)^2 + pi^2/4) [-].

    At it the slip reverses just where the floor acceleration reaches mu_s g.
    """
    return 1.0 / math.hypot(static_ratio, 0.5 * math.pi)


def steady_stroke(*, friction_ratio: float, static_ratio: float) -> float:
    """Slip per half cycle over A, equal to the peak to peak of the steady slip over A [-].

    Without stops below `never_stops_ratio`: 2 sqrt(1 - (pi kappa/2)^2). Above: the slider breaks loose at
    sin x0 = mu_s g/(A Omega^2), stops where cos x0 - kappa (x1 - x0) = cos x1, and sticks until the
    opposite phase; stroke cos x0 (x1 - x0) - kappa (x1 - x0)^2/2 - (sin x1 - sin x0). Zero where it sticks.
    """
    kappa = friction_ratio
    if static_ratio * kappa >= 1.0:
        return 0.0
    if kappa <= never_stops_ratio(static_ratio):
        return 2.0 * math.sqrt(1.0 - (0.5 * math.pi * kappa) ** 2)
    x0 = math.asin(static_ratio * kappa)

    def slip_velocity(x: float) -> float:
        return math.cos(x0) - kappa * (x - x0) - math.cos(x)

    # the slip velocity is largest where the floor acceleration has fallen to mu_k g
    x1 = float(brentq(slip_velocity, math.pi - math.asin(kappa), math.pi + x0, xtol=1e-15))
    return math.cos(x0) * (x1 - x0) - 0.5 * kappa * (x1 - x0) ** 2 - (math.sin(x1) - math.sin(x0))


def pulse_slip(*, peak: float, duration: float, mu_static: float, mu_kinetic: float, gravity: float) -> float:
    """Signed slip left by a rectangular pulse of the floor acceleration [m].

    V^2/(2 mu_k g) (1 - mu_k g/a0) against the floor's acceleration, V = a0 t0: Newmark (1965), one way.
    Zero where a0 <= mu_s g. The floor keeps the velocity V.
    """
    if sticks(peak_acceleration=peak, mu_static=mu_static, gravity=gravity):
        return 0.0
    friction = mu_kinetic * gravity
    velocity = abs(peak) * duration
    slip = velocity**2 / (2.0 * friction) * (1.0 - friction / abs(peak))
    return -math.copysign(slip, peak)


def incline_acceleration(*, angle: float, mu_kinetic: float, gravity: float) -> float:
    """Acceleration of a body that slides down an incline: g (sin - mu_k cos) [m/s2]."""
    return gravity * (math.sin(angle) - mu_kinetic * math.cos(angle))
