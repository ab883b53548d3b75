"""The default penalty: as soft as accuracy allows, because a soft contact permits long steps.

It is a numerical choice, not the stiffness of concrete. For two corners the static penetration, and with it
the tilt when standing on one corner, must be small compared with the motion. A base of many points needs more: near
uplift the whole weight is on a narrow strip at the edge, the bed opens from the other side, softens, and
may resonate with the drive far below uplift. Therefore the tilt near uplift is limited.
"""

import math

PENETRATION_OVER_HEIGHT = 1e-5
PENETRATION_OVER_SWING = 6e-5  #: over width times slenderness angle
NEAR_UPLIFT = 0.9  #: share of the restoring moment at which the tilt of a wide base is limited
TILT_OVER_SLENDERNESS = 1e-3
STIFFEST = 3.0  #: times E/h: above it the contact, not the container, determines the time step


def choose_normal_penalty(
    kind: str,
    *,
    weight: float,
    width: float,
    height: float,
    depth: float,
    slenderness_angle: float,
    youngs_modulus: float,
    element_size: float,
    foot: float = 0.0,
) -> float:
    """Penalty [Pa/m] for `corners`, `feet` or `flat`; lengths in m, weight in N, modulus in Pa, angle in rad.

    `height` is that of the stack; `foot` the length of one, for feet only.
    """
    limit = STIFFEST * youngs_modulus / element_size
    if kind == "corners":
        penetration = min(
            PENETRATION_OVER_HEIGHT * height, PENETRATION_OVER_SWING * width * slenderness_angle
        )
        return min(weight / (penetration * width * depth), limit)
    # Triangular pressure over a strip of length s at the edge, resultant at NEAR_UPLIFT of the half width:
    # s = 3 (1 - NEAR_UPLIFT) width/2, edge pressure 2 weight/(s depth), tilt = edge pressure/(penalty s).
    strip = 1.5 * (1.0 - NEAR_UPLIFT) * width
    if kind == "feet":
        strip = min(strip, foot)
    tilt = TILT_OVER_SLENDERNESS * slenderness_angle
    return min(2.0 * weight / (depth * strip**2 * tilt), limit)


def relaxation_time(damping_ratio: float, mass: float, base_stiffness: float) -> float:
    """Dashpot over spring of the contact [s]: the damping ratio is of the mass [kg] on half the stiffness [N/m]."""
    return 2.0 * damping_ratio * math.sqrt(mass / (0.5 * base_stiffness))


def restitution_of(damping_ratio: float) -> float:
    """Velocity that a mass keeps which runs against a spring with a dashpot that does not pull [-].

    It leaves where the force vanishes: with zeta = sin(beta), exp(-tan(beta) (pi - 2 beta)); with zeta = cosh(y),
    exp(-2 y coth(y)).
    """
    if damping_ratio < 1.0:
        angle = math.asin(damping_ratio)
        return math.exp(-math.tan(angle) * (math.pi - 2.0 * angle))
    argument = math.acosh(damping_ratio)
    return math.exp(-2.0 * argument / math.tanh(argument)) if argument > 0.0 else math.exp(-2.0)


def damping_ratio_of(restitution: float) -> float:
    """The damping ratio with this `restitution_of`, in (0, 1] [-]; by bisection, for it falls with the ratio."""
    low, high = 0.0, 1.0
    while restitution_of(high) > restitution:
        high *= 2.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if restitution_of(middle) > restitution else (low, middle)
    return high


def contact_frequency(mass: float, base_stiffness: float) -> float:
    """Bounce frequency of the container on all contact points [Hz]."""
    return math.sqrt(base_stiffness / mass) / (2.0 * math.pi)
