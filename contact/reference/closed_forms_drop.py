"""A block that drops flat on a bed of springs and dashpots that do not pull: one degree of freedom."""

import math


def damped_drop_restitution(damping_ratio: float) -> float:
    """Ratio of rebound to approach speed on a spring with a dashpot that never pull [-].

    Contact ends where k x + c v = 0, not where the spring is straight again:
    e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2)), for zeta > 1 with arccosh and sqrt(zeta^2 - 1), at 1
    exp(-2). The same as exp(-zeta/s (pi - atan2(2 zeta s, 1 - 2 zeta^2))), s = sqrt(1 - zeta^2): Schwager
    and Poschel, Granular Matter 9 (2007). Gravity is neglected: approach speed far above g sqrt(m/k).

    Args:
        damping_ratio: zeta = c/(2 sqrt(k m)) with the whole bed's k and c [-].
    """
    if not damping_ratio >= 0.0:
        raise ValueError(f"damped drop: damping_ratio must not be negative, got {damping_ratio}")
    if abs(damping_ratio - 1.0) < 1e-8:  # here arccos(zeta)/sqrt(1 - zeta^2) = 1 + O(1 - zeta), but 0/0
        return math.exp(-2.0 * damping_ratio)
    if damping_ratio < 1.0:
        angle = math.acos(damping_ratio) / math.sqrt(1.0 - damping_ratio**2)
    else:
        angle = math.acosh(damping_ratio) / math.sqrt(damping_ratio**2 - 1.0)
    return math.exp(-2.0 * damping_ratio * angle)


def drop_force(*, mass: float, stiffness: float, speed: float, gravity: float) -> float:
    """Largest floor force when a mass lands at a speed on an undamped bed: m g + sqrt((m g)^2 + k m v^2) [N].

    Energy; the bed's whole stiffness [N/m], contact not yet loaded at landing.
    """
    weight = mass * gravity
    return weight + math.sqrt(weight**2 + stiffness * mass * speed**2)
