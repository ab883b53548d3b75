"""How a resting rigid block begins to move, and when it overturns in its first swing, before any impact.

`acceleration_ratio` a is the peak floor acceleration over g al (slender) or g tan al, `frequency_ratio` w is
Omega/p. The slender forms follow from the growing part of phi'' = phi - 1 + a sin(w tau + psi), phi the
rotation over al and tau = p t: the block falls if y = phi + phi' - 1 is not negative when the floor stops.
Uplift is at a sin psi = 1. Thresholds with impacts are not covered: there safe islands lie above
overturning amplitudes. No sliding.
Housner, BSSA 53 (1963); Makris and Roussos, Geotechnique 50 (2000); Zhang and Makris, J. Engng Mech. ASCE 127
(2001).
"""

import math
from collections.abc import Callable

from scipy.integrate import quad
from scipy.optimize import brentq

from contact.reference.planar_block import PlanarMode
from contact.reference.rigid_block import RigidBlock


def rocking_friction(acceleration_ratio: float, slenderness: float) -> float:
    """Friction coefficient a resting block needs to begin to rock without sliding [-].

    Shenton (1996), J. Engng Mech. ASCE 122: [(lam^2 + 4) A + 3 lam]/[(4 lam^2 + 1) + 3 lam A]. Homogeneous
    rectangle, at the instant of uplift (A >= 1/lam; it is 1/lam there); later instants may need more.
    """
    lam, ratio = slenderness, acceleration_ratio
    return ((lam**2 + 4.0) * ratio + 3.0 * lam) / ((4.0 * lam**2 + 1.0) + 3.0 * lam * ratio)


def initiation_mode(
    *, acceleration_ratio: float, slenderness: float, mu_static: float, mu_kinetic: float
) -> PlanarMode:
    """First motion of a resting homogeneous block under a suddenly applied floor acceleration.

    Shenton (1996), extended to mu_kinetic below mu_static: a block that cannot rock without sliding
    slides on its base if mu_kinetic < 1/lam, since sliding friction is then too weak to tilt it.
    """
    upright = acceleration_ratio <= 1.0 / slenderness
    if upright:
        return PlanarMode.REST if acceleration_ratio <= mu_static else PlanarMode.SLIDE
    if mu_static >= rocking_friction(acceleration_ratio, slenderness):
        return PlanarMode.ROCK
    return PlanarMode.SLIDE if mu_kinetic < 1.0 / slenderness else PlanarMode.SLIDE_ROCK


def sustained_sine_threshold_slender(frequency_ratio: float) -> float:
    """Acceleration ratio under a lasting A sin(Omega t): sqrt(1 + w^2) [-].

    y never falls below -1 and grows without bound if a cos psi > w, with a sin psi = 1. Slender block, floor
    motion starting at zero displacement, block moving with the floor; any w.
    """
    return math.hypot(1.0, frequency_ratio)


def half_sine_threshold_slender(frequency_ratio: float) -> float:
    """Acceleration ratio of a half-sine pulse, duration pi/Omega [-].

    a [cos psi + exp(-(pi - psi)/w)] = w. Below the sqrt(1 + w^2) of the lasting sine, which Housner
    (1963) gave for this pulse and Makris and Roussos (2000) corrected. Slender block; any w > 0.
    """
    return _threshold(frequency_ratio, lambda a, psi, w: a * (math.cos(psi) + math.exp(-(math.pi - psi) / w)))


def one_sine_threshold_slender(frequency_ratio: float) -> float:
    """Acceleration ratio of a one-sine pulse, duration 2 pi/Omega, to overturn without impact [-].

    a [cos psi - exp(-(2 pi - psi)/w)] = w: mode 2 of Zhang and Makris (2001). Overturning after one
    impact (their mode 1) can happen below it. Slender block; any w > 0.
    """
    return _threshold(
        frequency_ratio, lambda a, psi, w: a * (math.cos(psi) - math.exp(-(2.0 * math.pi - psi) / w))
    )


def rectangular_pulse_duration(block: RigidBlock, peak: float) -> float:
    """Shortest rectangular pulse of an acceleration that overturns [s]; exact.

    The work of the constant inertia force up to the end of the pulse equals g R (1 - cos al), which gives the
    rotation there: sin(al - theta1) = sin al - (g/a)(1 - cos al); the time to it is a quadrature of the
    energy integral. Any block, peak above g tan al.
    """
    strength = abs(peak) / block.gravity
    angle = block.slenderness_angle
    end = angle - math.asin(math.sin(angle) - (1.0 - math.cos(angle)) / strength)

    def integrand(root: float) -> float:  # rotation = root^2 takes the singularity at the start away
        rotation = root * root
        half = 0.5 * rotation
        # (cos(al - t) - cos al) and (sin al - sin(al - t)) without cancellation, over t
        share = math.sin(half) / half if half > 0.0 else 1.0
        gain = strength * math.cos(angle - half) - math.sin(angle - half)
        return 2.0 / math.sqrt(2.0 * share * gain)

    integral = quad(integrand, 0.0, math.sqrt(end), epsabs=0.0, epsrel=1e-12)
    return float(integral[0]) / block.frequency_parameter


def velocity_step_threshold(block: RigidBlock) -> float:
    """Sudden floor velocity that overturns [m/s]; exact.

    Kinetic energy of the kick, I_O w^2/2 with w = M H v/I_O, against M g R (1 - cos al):
    v^2 = 2 (I_O/(M R^2)) g R (1 - cos al)/cos^2 al. Any block; the corner does not slide.
    """
    kick_per_velocity = block.centroid_height / (block.inertia_ratio * block.radius**2)
    inertia = block.inertia_ratio * block.radius**2
    return math.sqrt(2.0 * block.overturning_energy / inertia) / kick_per_velocity


def _threshold(frequency_ratio: float, growth: Callable[[float, float, float], float]) -> float:
    """The acceleration ratio above 1 at which growth(a, arcsin(1/a), w) = w; growth increases with a."""
    w = frequency_ratio

    def surplus(ratio: float) -> float:
        return growth(ratio, math.asin(1.0 / ratio), w) - w

    high = 2.0
    while surplus(high) < 0.0:
        high *= 2.0
    return float(brentq(surplus, 1.0, high, xtol=1e-15, rtol=1e-14))
