"""Laws of the contact at one point of the base: force against motion, each with its tangent beside it.

Penetration is positive when the point is below the floor; the normal force is positive in compression;
slip and tangential force are along x, motion of the container relative to the floor. Forces in N at a
point that carries a stiffness in N/m (its share of the penalty).

Normal: spring and dashpot that never pull (Kelvin-Voigt with a cut-off; Wriggers, Computational Contact
Mechanics, 2006, sec. 6), in series with a plastic slider where the floor crushes at a largest force.
Rolling: the resultant of a cambered base runs ahead of the place where it touches, which takes energy at every speed.
Friction: Coulomb with an elastic stick - a Kelvin-Voigt element in series with a slider, solved by return
mapping - or Coulomb regularised in velocity.
"""

import math

from contact.jit import compiled

ELASTIC_STICK = 0  #: code of the friction law regularised in displacement
REGULARISED = 1  #: code of the friction law regularised in velocity
#: the laws that the kernels handle: name -> code
FRICTION_LAWS = {"elastic-stick": ELASTIC_STICK, "regularised": REGULARISED}


@compiled(inline=True)
def normal_force(
    penetration: float, rate: float, stiffness: float, damping: float, cap: float, step: float
) -> tuple[float, float, float]:
    """Normal force [N] with its derivatives by penetration [N/m] and by rate [N s/m].

    k p + c min(rate, p/step), never negative, zero when open, and at most the cap, at which the floor crushes. The
    point cannot have moved into the floor faster than p/step within a step that began outside: this makes the force
    continuous at first touch. `penetration` [m] is positive below the floor, `rate` is that at the end of the step.
    """
    if penetration <= 0.0:
        return 0.0, 0.0, 0.0
    if rate * step < penetration:
        force, slope, by_rate = stiffness * penetration + damping * rate, stiffness, damping
        if force <= 0.0:
            return 0.0, 0.0, 0.0
    else:
        slope, by_rate = stiffness + damping / step, 0.0
        force = slope * penetration
    if force >= cap:
        return cap, 0.0, 0.0
    return force, slope, by_rate


@compiled(inline=True)
def rolling_lead(rotation: float, rate: float, time: float, radius: float, reach: float) -> float:
    """How far the resultant of a base that rolls is ahead of the place where it touches [m].

    A base of radius R touches at x = R theta from its middle, at most at its edge (`reach`). The resultant is where it
    would touch a time `time` later, so that small rocking has the moment N R (theta + time theta'): a viscous damping
    of the rolling, which vanishes about an edge and never takes the resultant out of the base.
    """
    here = min(max(radius * rotation, -reach), reach)
    return min(max(radius * (rotation + time * rate), -reach), reach) - here


@compiled(inline=True)
def stick_trial(stiffness: float, relaxation_time: float, elongation: float, slip_velocity: float) -> float:
    """Force on a point that sticks, by spring and dashpot [N]; the elongation of the spring is in m."""
    return -stiffness * relaxation_time * slip_velocity - stiffness * elongation


@compiled(inline=True)
def stick_friction(trial: float, limit: float) -> tuple[float, float, float]:
    """Return mapping: tangential force [N] of a trial force within a limit mu N, and its derivatives by both [-]."""
    if trial > limit:
        return limit, 0.0, 1.0
    if trial < -limit:
        return -limit, 0.0, -1.0
    return trial, 1.0, 0.0


@compiled
def relaxed_stick(stick: float, force: float, stiffness: float, relaxation_time: float, step: float) -> float:
    """Elongation [m] of a Kelvin-Voigt element after a step under a constant force: k s + c s' = F, with c/k its time.

    It is integrated exactly, so that large steps end at s = F/k.
    """
    rest = force / stiffness
    if relaxation_time <= 0.0:
        return rest
    return rest + (stick - rest) * math.exp(-step / relaxation_time)


@compiled
def regularised_friction(
    normal: float,
    slip_velocity: float,
    mu_static: float,
    mu_kinetic: float,
    regularisation_velocity: float,
) -> tuple[float, float, float]:
    """Friction [N] opposing the slip velocity, with its derivatives by normal force and slip velocity.

    -N mu(v) tanh(v/v_reg), mu falling from static to kinetic like exp(-(v/10 v_reg)^2) (Stribeck). No true
    stick: under a load s mu N the block creeps at v_reg atanh(s).
    """
    ratio = slip_velocity / regularisation_velocity
    fall = math.exp(-((0.1 * ratio) ** 2))
    mu = mu_kinetic + (mu_static - mu_kinetic) * fall
    mu_slope = -(mu_static - mu_kinetic) * fall * 0.02 * ratio / regularisation_velocity
    sway = math.tanh(ratio)
    sway_slope = (1.0 - sway * sway) / regularisation_velocity
    return -normal * mu * sway, -mu * sway, -normal * (mu_slope * sway + mu * sway_slope)


@compiled(inline=True)
def stribeck_mu(mu_static: float, mu_kinetic: float, stribeck_velocity: float, slip_velocity: float) -> float:
    """Coefficient of friction at a slip velocity: mu_k + (mu_s - mu_k) exp(-(v/v_s)^2), v_s the Stribeck velocity.

    Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30 (1994) 1083, Eq. 7 with exponent 2. Where v_s = 0 the
    coefficient does not depend on the velocity.
    """
    if stribeck_velocity <= 0.0:
        return mu_static
    ratio = slip_velocity / stribeck_velocity
    return mu_kinetic + (mu_static - mu_kinetic) * math.exp(-ratio * ratio)


@compiled
def weakened_mu(mu_static: float, mu_kinetic: float, weakening: float, slid: float) -> float:
    """Coefficient of friction after sliding `slid` [m]: linear from static to kinetic over `weakening` [m]."""
    if slid >= weakening:
        return mu_kinetic
    return mu_static + (mu_kinetic - mu_static) * slid / weakening
