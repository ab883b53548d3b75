"""How a resting block begins to move, and when its base begins to open.

`acceleration_ratio` is |floor acceleration|/g, `slenderness` is height over width of a homogeneous block.
"""

from contact.reference.planar_motion import PlanarMode
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


def edge_opening_acceleration(block: RigidBlock) -> float:
    """|Floor acceleration| at which the edge of a flat base on an elastic bed opens: g B/(3 H) [m/s2].

    The resultant leaves the middle third of the base (Navier); rigid block on uniform springs
    that take no tension, statically. Uplift of the body as a whole is at three times this.
    """
    return block.uplift_acceleration / 3.0
