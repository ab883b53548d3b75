"""Closed forms for a rigid block that slides, rocks or overturns on a moving floor.

Sliding under the floor A sin(Omega t): `friction_ratio` kappa = mu_k g/(A Omega^2), `static_ratio` mu_s/mu_k >= 1; Den
Hartog, Trans. ASME APM-53-9 (1931), and Westermo and Udwadia, Earthquake Engng Struct. Dyn. 11 (1983), for the
sine; Newmark, Geotechnique 15 (1965), for the pulse.

Rocking: exact forms hold at any rotation below the slenderness angle; `slender` ones for sin al ~ al and rotations of
that order, their error being O(al^2). All assume plastic impacts at the corners and no sliding.

Overturning in the first swing, before any impact: `acceleration_ratio` a is the peak floor acceleration over g al
(slender) or g tan al, `frequency_ratio` w is Omega/p. The slender forms follow from the growing part of phi'' =
phi - 1 + a sin(w tau + psi), phi the rotation over al and tau = p t: the block falls if y = phi + phi' - 1 is not
negative when the floor stops. Uplift is at a sin psi = 1. Thresholds with impacts are not covered: there safe islands
lie above overturning amplitudes. Housner, BSSA 53 (1963); Makris and Roussos, Geotechnique 50 (2000); Zhang and Makris,
J. Engng Mech. ASCE 127 (2001).
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from runs import bisected
from scipy.integrate import quad
from scipy.optimize import brentq

from contact.reference.floor_acceleration import FloorAcceleration
from contact.reference.planar_block import PlanarMode
from contact.reference.rigid_block import RigidBlock
from contact.reference.rocking import simulate_rocking


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
    if abs(peak) <= mu_static * gravity:
        return 0.0
    friction = mu_kinetic * gravity
    velocity = abs(peak) * duration
    slip = velocity**2 / (2.0 * friction) * (1.0 - friction / abs(peak))
    return -math.copysign(slip, peak)


def incline_acceleration(*, angle: float, mu_kinetic: float, gravity: float) -> float:
    """Acceleration of a body that slides down an incline: g (sin - mu_k cos) [m/s2]."""
    return gravity * (math.sin(angle) - mu_kinetic * math.cos(angle))


def quarter_period(block: RigidBlock, rotation: float) -> float:
    """Time from release at a rotation at rest to the impact [s].

    (1/p) int_0^U du / sqrt(1 - (k cosh u)^2), k = sin((al - theta0)/2), U = arccosh(sin(al/2)/k): the energy
    integral of Housner's (1963) equation with sin((al - theta)/2) = k cosh u, which takes the
    square-root singularity at the turning point away. Exact for 0 < rotation < al.
    """
    least = math.sin(0.5 * (block.slenderness_angle - abs(rotation)))
    upper = math.acosh(math.sin(0.5 * block.slenderness_angle) / least)

    def integrand(u: float) -> float:
        return 1.0 / math.sqrt(1.0 - (least * math.cosh(u)) ** 2)

    integral = quad(integrand, 0.0, upper, epsabs=0.0, epsrel=1e-12)
    return float(integral[0]) / block.frequency_parameter


def peak_after_impacts(block: RigidBlock, rotation: float, impacts: int, restitution: float) -> float:
    """|rotation| at the turning point after so many impacts of free rocking from rest at `rotation` [rad].

    cos(al - theta_n) - cos al = e^(2n) [cos(al - theta_0) - cos al]: an impact leaves e^2 of the kinetic
    energy. Exact for plastic impacts at the corner, 0 < |rotation| < al; the energy is written as a
    product of sines, so that small peaks keep their digits.
    """
    angle, start = block.slenderness_angle, abs(rotation)
    # cos(al - t) - cos al = 2 sin(t/2) sin(al - t/2)
    share = restitution ** (2 * impacts) * math.sin(0.5 * start) * math.sin(angle - 0.5 * start)
    # sin(t/2) sin(al - t/2) = share  =>  tan(t/2) = x with (x sin al - x^2 cos al)/(1 + x^2) = share
    sine, leading = math.sin(angle), math.cos(angle) + share
    root = math.sqrt(sine**2 - 4.0 * leading * share)
    return 2.0 * math.atan(2.0 * share / (sine + root))


def impact_friction_need(block: RigidBlock) -> float:
    """Least friction coefficient with which the plastic impact of a rocking block does not slide [-].

    Ratio of the horizontal to the vertical impulse, (H/B) (1 - e)/(1 + e); homogeneous:
    3 tan al/(4 + tan^2 al). From Housner's (1963) impact and momentum in both directions. Exact for a
    block that did not slide before the impact, with his restitution e not negative.
    """
    restitution = block.housner_restitution
    return block.centroid_height / block.half_width * (1.0 - restitution) / (1.0 + restitution)


def holding_acceleration(block: RigidBlock, rotation: float) -> float:
    """Constant |floor acceleration| that holds the block at a rotation: g tan(al - |rotation|) [m/s2].

    Moment equilibrium about the corner, unstable. Exact for |rotation| < 90 degrees; zero at al, and
    at rotation 0 the acceleration of uplift (West's formula, quoted by Milne 1885).
    """
    return block.gravity * math.tan(block.slenderness_angle - abs(rotation))


class SymmetricOrbit(NamedTuple):
    """A steady rocking motion with one impact per half period of the floor; scaled by al and al p."""

    impact_phase: float  #: phase of the floor's tilting acceleration at the impact from the left [rad]
    post_impact_speed: float  #: angular velocity after the impact over al p [-]


def symmetric_orbit_slender(
    *, acceleration_ratio: float, frequency_ratio: float, restitution: float
) -> SymmetricOrbit:
    """Steady symmetric orbit of a slender block under a sine.

    Spanos and Koh, J. Engng Mech. ASCE 110 (1984): the linear equation phi'' = phi - 1 + a sin(w tau + psi)
    over one half period, phi = 0 at both ends, velocity -v/e at the end after v at the start. That leaves
    a quadratic for sin psi; of two orbits the one with the larger speed is given. Stability is not
    examined here. 0 < e < 1.
    """
    w = frequency_ratio
    half = math.pi / w
    tangent = math.tanh(0.5 * half)
    size = acceleration_ratio / (1.0 + w * w)  # amplitude of the particular solution
    loss = (1.0 + restitution) / (1.0 - restitution)
    # w size cos psi = tangent - S loss/tangent, S = size sin psi, and S^2 + (size cos psi)^2 = size^2
    a = 1.0 + (loss / (tangent * w)) ** 2
    b = -2.0 * loss / w**2
    c = (tangent / w) ** 2 - size**2
    in_phase = (-b + math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
    in_quadrature = (tangent - in_phase * loss / tangent) / w
    return SymmetricOrbit(
        impact_phase=math.atan2(in_phase, in_quadrature),
        post_impact_speed=2.0 * in_phase * restitution / ((1.0 - restitution) * tangent),
    )


def damped_drop_restitution(damping_ratio: float) -> float:
    """Ratio of rebound to approach speed on a spring with a dashpot that never pull [-].

    Contact ends where k x + c v = 0, not where the spring is straight again:
    e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2)), the same as exp(-zeta/s (pi - atan2(2 zeta s, 1 - 2 zeta^2))),
    s = sqrt(1 - zeta^2): Schwager and Poschel, Granular Matter 9 (2007). Gravity is neglected: approach speed far
    above g sqrt(m/k). zeta = c/(2 sqrt(k m)) < 1, with the whole bed's k and c.
    """
    return math.exp(-2.0 * damping_ratio * math.acos(damping_ratio) / math.sqrt(1.0 - damping_ratio**2))


def drop_force(*, mass: float, stiffness: float, speed: float, gravity: float) -> float:
    """Largest floor force when a mass lands at a speed on an undamped bed: m g + sqrt((m g)^2 + k m v^2) [N].

    Energy; the bed's whole stiffness [N/m], contact not yet loaded at landing.
    """
    weight = mass * gravity
    return weight + math.sqrt(weight**2 + stiffness * mass * speed**2)


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


def first_swing_threshold(
    block: RigidBlock,
    floor_of_peak: Callable[[float], FloorAcceleration],
    *,
    low: float,
    high: float,
    duration: float,
    relative_tolerance: float = 1e-9,
) -> float:
    """Peak floor acceleration from which the block overturns before any impact [m/s2].

    Bisection on the exact motion of the first swing only, where overturning is monotone in the peak of the
    motions considered here; with impacts there are safe islands above it and no single threshold. The peaks `low` and
    `high` [m/s2] do not, and do, overturn; the duration [s] must do to overturn or to come back.
    """

    def overturns(peak: float) -> bool:
        motion = simulate_rocking(block, floor_of_peak(peak), duration=duration, stop_at_impact=True)
        return motion.outcome is PlanarMode.OVERTURNED

    peak = bisected(overturns, low, high, resolution=relative_tolerance)
    if math.isnan(peak):
        raise ValueError(f"first swing: no change from standing to overturned between {low} and {high} m/s2")
    return peak


def _threshold(frequency_ratio: float, growth: Callable[[float, float, float], float]) -> float:
    """The acceleration ratio above 1 at which growth(a, arcsin(1/a), w) = w; growth increases with a."""
    w = frequency_ratio

    def surplus(ratio: float) -> float:
        return growth(ratio, math.asin(1.0 / ratio), w) - w

    high = 2.0
    while surplus(high) < 0.0:
        high *= 2.0
    return float(brentq(surplus, 1.0, high, xtol=1e-15, rtol=1e-14))
