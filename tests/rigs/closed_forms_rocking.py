"""Closed forms for a rigid block that rocks without sliding, or lands flat: periods, decay, impact, steady orbit.

Exact forms hold at any rotation below the slenderness angle; `slender` ones for sin al ~ al and rotations of
that order, their error being O(al^2). All assume plastic impacts at the corners and no sliding.
"""

import math
from dataclasses import dataclass

from scipy.integrate import quad

from contact.reference.rigid_block import RigidBlock


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


@dataclass(frozen=True, kw_only=True)
class SymmetricOrbit:
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
    examined here.

    Args:
        acceleration_ratio: A Omega^2/(g al) [-].
        frequency_ratio: w = Omega/p [-].
        restitution: e, above 0 and below 1 [-].
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
    above g sqrt(m/k).

    Args:
        damping_ratio: zeta = c/(2 sqrt(k m)) with the whole bed's k and c, below 1 [-].
    """
    return math.exp(-2.0 * damping_ratio * math.acos(damping_ratio) / math.sqrt(1.0 - damping_ratio**2))


def drop_force(*, mass: float, stiffness: float, speed: float, gravity: float) -> float:
    """Largest floor force when a mass lands at a speed on an undamped bed: m g + sqrt((m g)^2 + k m v^2) [N].

    Energy; the bed's whole stiffness [N/m], contact not yet loaded at landing.
    """
    weight = mass * gravity
    return weight + math.sqrt(weight**2 + stiffness * mass * speed**2)
