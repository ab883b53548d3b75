"""Equilibrium before the motion begins: settled under gravity, or tilted on one corner.

Both need only the rigid body, the contact springs and the elastic compliance at the base points (inertia relief:
gravity is a uniform field and does not strain a free body).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.arrays import FloatArray

#: contact force over the weight below which a point of the settled base counts as open
ROUNDING = 1e-12


class SettlingError(ArithmeticError):
    """The container has no equilibrium on its supporting points."""


@dataclass(frozen=True, kw_only=True)
class Stance:
    """Initial rigid pose, velocity and contact forces; n base points."""

    centre: tuple[float, float]  #: mass centre, x and z above the floor [m]
    rotation: float  #: [rad]
    velocity: tuple[float, float]  #: of the mass centre, relative to the floor [m/s]
    angular_velocity: float  #: [rad/s]
    force: FloatArray  #: (n, 2) tangential and normal [N]

    def turning(self, angular_velocity: float, point: FloatArray) -> "Stance":
        """The same stance with an angular velocity [rad/s]: > 0 about the right corner, < 0 about the left corner.

        `point`: base points relative to the mass centre, sorted by x, shape (n, 2) [m].
        """
        arm = point[-1] if angular_velocity > 0.0 else point[0]
        velocity = (-angular_velocity * float(arm[1]), angular_velocity * float(arm[0]))
        return replace(self, velocity=velocity, angular_velocity=angular_velocity)

    def moving(self, velocity: float, upward: float = 0.0) -> "Stance":
        """The same stance with additional velocities along the floor and upward [m/s]."""
        return replace(self, velocity=(self.velocity[0] + velocity, self.velocity[1] + upward))

    def moved(self, distance: float, upward: float = 0.0) -> "Stance":
        """The same stance shifted along x and upward [m]."""
        return replace(self, centre=(self.centre[0] + distance, self.centre[1] + upward))

    def with_points(self, count: int) -> "Stance":
        """The same stance with `count` contact points; the added points carry no force."""
        force = np.zeros((count, 2))
        force[: len(self.force)] = self.force
        return replace(self, force=force)


def standing(
    *,
    weight: float,
    centroid: tuple[float, float],
    point: FloatArray,
    compliance: FloatArray,
    normal_stiffness: FloatArray,
    shear_ratio: float = 0.0,
) -> Stance:
    """Rest under gravity on unilateral springs; without friction on a level floor.

    Args:
        weight: toward the floor [N]; centroid: of the undeformed container, x from its middle, z above the base [m].
        point: (n, 2) base points relative to the centroid [m].
        compliance: (2n, 2n) elastic compliance in the body's frame, inertia relief [m/N].
        normal_stiffness: (n,) [N/m].
        shear_ratio: friction uphill over the normal force: the slope of a floor that falls toward +x.

    Raises:
        SettlingError: the weight acts outside the supporting points.
    """
    n = point.shape[0]
    vertical = compliance[1::2, 1::2] - shear_ratio * compliance[1::2, 0::2]
    carrying = np.ones(n, dtype=bool)
    for _ in range(2 * n + 2):
        chosen = np.flatnonzero(carrying)
        m = chosen.size
        # Unknowns: normal forces, rise of the centroid above its place in the undeformed container, rotation.
        system = np.zeros((m + 2, m + 2))
        system[:m, :m] = vertical[np.ix_(chosen, chosen)] + np.diag(1.0 / normal_stiffness[chosen])
        system[:m, m] = 1.0
        system[:m, m + 1] = -point[chosen, 0]
        system[m:, :m] = system[:m, m:].T
        system[m + 1, :m] -= shear_ratio * point[chosen, 1]
        right = np.zeros(m + 2)
        right[:m] = -(point[chosen, 1] + centroid[1])
        right[m] = weight
        try:
            solution = np.linalg.solve(system, right)
        except np.linalg.LinAlgError:
            break
        normal = np.zeros(n)
        normal[chosen] = solution[:m]
        gap = point[:, 1] + centroid[1] + solution[m] - solution[m + 1] * point[:, 0] + vertical @ normal
        # A point that just touches keeps its state within rounding; it would otherwise change state for ever.
        wrong = np.where(carrying, normal < -ROUNDING * weight, gap < -ROUNDING * weight / normal_stiffness)
        if not wrong.any():
            normal = np.maximum(normal, 0.0)
            force = np.column_stack([np.zeros(n) - shear_ratio * normal, normal])
            return Stance(
                centre=(centroid[0], centroid[1] + solution[m]),
                rotation=float(solution[m + 1]),
                velocity=(0.0, 0.0),
                angular_velocity=0.0,
                force=force,
            )
        carrying ^= wrong
    raise SettlingError("the weight of the container acts outside its supporting points")


def tilted(
    *,
    rotation: float,
    angular_velocity: float,
    mass: float,
    inertia: float,
    gravity: float,
    downhill: float = 0.0,
    point: FloatArray,
    corner_x: float,
    compliance: FloatArray,
    normal_stiffness: FloatArray,
    mu_static: float,
) -> Stance:
    """Tilted about one corner, with the force that keeps this corner from accelerating; right corner for rotation > 0.

    Args:
        rotation: not 0 [rad]; angular_velocity: about that corner [rad/s].
        mass, inertia: [kg, kg m2].
        gravity: toward the floor; downhill: along a floor that falls toward +x [m/s2].
        point: (n, 2) base points relative to the mass centre, sorted by x [m].
        corner_x: position of that corner on the floor [m].
        compliance: (2n, 2n) elastic compliance in the body's frame, inertia relief [m/N].
        normal_stiffness: (n,) [N/m]; mu_static: limits the friction at the corner.

    Raises:
        SettlingError: the corner would have to pull.
    """
    corner = point.shape[0] - 1 if rotation > 0.0 else 0
    cosine, sine = math.cos(rotation), math.sin(rotation)
    x, z = point[corner]
    arm = np.array([cosine * x + sine * z, -sine * x + cosine * z])
    # Acceleration of the corner: J M^-1 (weight + J^T f) - omega^2 arm = 0.
    jacobian = np.array([[1.0, 0.0, arm[1]], [0.0, 1.0, -arm[0]]])
    inverse = np.diag([1.0 / mass, 1.0 / mass, 1.0 / inertia])
    free = np.array([downhill, -gravity]) - angular_velocity**2 * arm
    force = np.linalg.solve(jacobian @ inverse @ jacobian.T, -free)
    if force[1] <= 0.0:
        raise SettlingError(
            f"the corner would have to pull: at an angular velocity of {angular_velocity} rad/s the container "
            "leaves the floor"
        )
    force[0] = np.clip(force[0], -mu_static * force[1], mu_static * force[1])
    forces = np.zeros_like(point)
    forces[corner] = force
    turn = np.array([[cosine, sine], [-sine, cosine]])
    own = compliance[2 * corner : 2 * corner + 2, 2 * corner : 2 * corner + 2]
    strained = arm + turn @ own @ turn.T @ force  # position of the corner after elastic deformation
    return Stance(
        centre=(corner_x - strained[0], -force[1] / normal_stiffness[corner] - strained[1]),
        rotation=rotation,
        velocity=(-angular_velocity * arm[1], angular_velocity * arm[0]),
        angular_velocity=angular_velocity,
        force=forces,
    )
