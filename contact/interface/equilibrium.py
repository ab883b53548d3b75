"""Equilibrium before the motion begins: settled under gravity, tilted on one corner, or stacked.

Both need only the rigid body, the contact springs and the elastic compliance at the base points (inertia relief:
gravity is a uniform field and does not strain a free body).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.arrays import BoolArray, FloatArray
from contact.interface.faces import CORNERS, Faces, linearise_points, points_of_joint

#: contact force over the weight below which a point of the settled base counts as open
ROUNDING = 1e-12
ROUNDING_OF_CAMBER = 1e-9  #: the same of a cambered base, whose springs are stiff beside its heights
#: steps in which points that carry change all at once without fewer being wrong; steps in all, for each point
SPARE, MOST_STEPS = 3, 10
MOST_ROUNDS, MOST_ROUNDS_OF_STACK = 100, 50
ROUNDING_OF_PLACES = 1e-14  #: of a corner, over its distance from the origin


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
        """The same stance turning [rad/s]: > 0 about the right corner, < 0 about the left one of the points (n, 2)."""
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
    camber: FloatArray,
    shear_ratio: float = 0.0,
) -> Stance:
    """Rest under gravity on unilateral springs; without friction on a level floor.

    Args:
        weight: toward the floor [N]; centroid: of the undeformed container, x from its middle, z above the base [m].
        point: (n, 2) base points relative to the centroid [m].
        compliance: (2n, 2n) elastic, in the body's frame, inertia relief [m/N].
        normal_stiffness: (n,) [N/m]; camber: (n,) height above the lowest point of an upright base [m].
        shear_ratio: friction uphill over the normal force: the slope of a floor that falls toward +x.

    Raises:
        SettlingError: the weight acts outside the supporting points.
    """
    n = point.shape[0]
    carrying, rounding = np.ones(n, dtype=bool), ROUNDING
    if camber.any():  # the load is on few of many points: begin with those beside the mass centre
        beside = np.searchsorted(point[:, 0], 0.0, side="right")
        carrying, rounding = np.isin(np.arange(n), (beside - 1, beside)), ROUNDING_OF_CAMBER
    normal, (rise, rotation) = pressed(
        weight,
        point[:, 1] + camber + centroid[1],
        compliance[1::2, 1::2] - shear_ratio * compliance[1::2, 0::2],
        normal_stiffness,
        lever=(-point[:, 0], -point[:, 0] - shear_ratio * point[:, 1]),
        carrying=carrying,
        rounding=rounding,
        refusal="the weight of the container acts outside its supporting points",
    )
    return Stance(
        centre=(centroid[0], centroid[1] + rise),
        rotation=float(rotation),
        velocity=(0.0, 0.0),
        angular_velocity=0.0,
        force=np.column_stack([np.zeros(n) - shear_ratio * normal, normal]),
    )


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
    camber: FloatArray,
    mu_static: float,
) -> Stance:
    """Tilted about one corner, with the force that keeps this corner from accelerating; right corner for rotation > 0.

    A cambered base touches elsewhere, at one point or two, until it has rolled to its edge; it is held there.

    Args:
        rotation: not 0 [rad]; angular_velocity: about that corner [rad/s].
        gravity: toward the floor; downhill: along a floor that falls toward +x [m/s2].
        corner_x: position of that corner of a level base on the floor [m].
        point, compliance, normal_stiffness, camber: as of `standing`; mu_static: limits the friction at the corner.

    Raises:
        SettlingError: the corner would have to pull.
    """
    cosine, sine = math.cos(rotation), math.sin(rotation)
    turn = np.array([[cosine, sine], [-sine, cosine]])

    def held(arm: FloatArray) -> FloatArray:
        # Acceleration of the place that is held: J M^-1 (weight + J^T f) - omega^2 arm = 0.
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
        return np.asarray(force)

    corner = point.shape[0] - 1 if rotation > 0.0 else 0
    forces = np.zeros_like(point)
    if camber.any():
        refusal = "the tilted base does not settle on its points"
        share, rise = np.zeros(len(point)), 0.0
        share[corner] = 1.0
        turned, arms = np.kron(np.eye(len(point)), turn), point @ turn.T
        own = turned @ compliance @ turned.T
        for _ in range(MOST_ROUNDS):
            arm, before = share @ arms, share
            force = held(arm)
            vertical = own[1::2, 1::2] + force[0] / force[1] * own[1::2, 0::2]
            normal, (rise,) = pressed(
                float(force[1]),
                arms[:, 1] + camber,
                vertical,
                normal_stiffness,
                rounding=ROUNDING_OF_CAMBER,
                refusal=refusal,
            )
            share = normal / force[1]
            if np.abs(share - before).max() <= ROUNDING_OF_CAMBER:
                break
        else:
            raise SettlingError(refusal)
        forces[:] = share[:, None] * force
        place = corner_x + share @ (point[:, 0] - point[corner, 0])  # on the floor, after it has rolled there
        centre = place - share @ (arms[:, 0] + (own @ forces.ravel())[0::2]), float(rise)
    else:
        x, z = point[corner]
        arm = np.array([cosine * x + sine * z, -sine * x + cosine * z])
        force = held(arm)
        forces[corner] = force
        own = compliance[2 * corner : 2 * corner + 2, 2 * corner : 2 * corner + 2]
        strained = arm + turn @ own @ turn.T @ force  # position of the corner after elastic deformation
        centre = corner_x - strained[0], -force[1] / normal_stiffness[corner] - strained[1]
    return Stance(
        centre=centre,
        rotation=rotation,
        velocity=(-angular_velocity * arm[1], angular_velocity * arm[0]),
        angular_velocity=angular_velocity,
        force=forces,
    )


def pressed(
    load: float,
    height: FloatArray,
    compliance: FloatArray,
    stiffness: FloatArray,
    *,
    rounding: float,
    refusal: str,
    lever: tuple[FloatArray, FloatArray] | None = None,
    carrying: BoolArray | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Normal forces [N] on unilateral springs under a load, and how it moves.

    Points change between carrying and open until none is in tension or below the floor: all that are wrong at once;
    where that does not make them fewer, one at a time, the deepest first, for the points of a cambered base may
    otherwise alternate for ever.

    Args:
        load: [N]; height: (n,) of the points above the load's own place [m].
        compliance: (n, n) elastic [m/N]; stiffness: (n,) of the springs [N/m].
        rounding: force over the load within which a point that just touches keeps its state.
        refusal: text of the error.
        lever: (n,) rise of the points by a rotation, and moments of their forces [m]; None: the load does not turn.
        carrying: (n,) the points to begin with; None: the lowest.

    Returns:
        (n,) forces; (1,) rise [m], or (2,) rise and rotation [rad] with `lever`.

    Raises:
        SettlingError: the points do not carry the load.
    """
    n = height.size
    rises = moments = np.ones((1, n))
    if lever is not None:
        rises, moments = np.vstack([rises, lever[0]]), np.vstack([moments, lever[1]])
    free = len(rises)
    carrying = height <= height.min() if carrying is None else carrying
    fewest: float = math.inf
    spare = SPARE
    for _ in range(MOST_STEPS * n):
        chosen = np.flatnonzero(carrying)
        m = chosen.size
        # Unknowns: normal forces, and how the load moves.
        system, right = np.zeros((m + free, m + free)), np.zeros(m + free)
        system[:m, :m] = compliance[np.ix_(chosen, chosen)] + np.diag(1.0 / stiffness[chosen])
        system[:m, m:], system[m:, :m] = rises[:, chosen].T, moments[:, chosen]
        right[:m], right[m] = -height[chosen], load
        try:
            solution = np.linalg.solve(system, right)
        except np.linalg.LinAlgError:
            break
        normal, gap = np.zeros(n), height
        normal[chosen] = solution[:m]
        for rise, moved in zip(rises, solution[m:], strict=True):
            gap = gap + rise * moved
        gap = gap + compliance @ normal
        # A point that just touches would change its state for ever.
        wrong = np.where(carrying, normal < -rounding * load, gap < -rounding * load / stiffness)
        if not wrong.any():
            return np.maximum(normal, 0.0), np.asarray(solution[m:], dtype=float)
        count = int(np.count_nonzero(wrong))
        fewest, spare = (count, SPARE) if count < fewest else (fewest, spare - 1)
        if spare < 0:
            below = (wrong & ~carrying).any()
            wrong = np.arange(n) == np.argmin(np.where(carrying, np.inf, gap) if below else normal)
        carrying = carrying ^ wrong
    raise SettlingError(refusal)


@dataclass(frozen=True, kw_only=True)
class StackedStances:
    """Poses and contact forces of N boxes at rest; n contact points."""

    centre: FloatArray  #: (N, 2) mass centres above the floor [m]
    rotation: FloatArray  #: (N,) [rad]
    force: FloatArray  #: (n, 2) tangential and normal [N]
    corner_force: FloatArray  #: (4 N, 2) along x and z [N]


def stacked(
    *,
    faces: Faces,
    centre: FloatArray,
    point: FloatArray,
    compliance: FloatArray,
    load: FloatArray,
) -> StackedStances:
    """Rest of a stack on the springs of its contact points, each joint with just the friction that it needs.

    The friction of a joint is shared in proportion to the normal forces. Centres stay where they are along x.

    Args:
        faces: the contact points; those of no weight and those of sides carry nothing.
        centre: (N, 2) of the boxes in the undeformed stack [m]; point: (N, 4, 2) corners from there [m].
        compliance: (N, 8, 8) elastic at the corners, inertia relief [m/N].
        load: (N, 2) forces on the mass centres, along x and upward [N].

    Raises:
        SettlingError: what is above a joint acts outside the face below.
    """
    boxes, n = len(centre), faces.weight.size
    joint = np.zeros(n, dtype=np.int64)
    for j in range(boxes):
        joint[points_of_joint(j)] = j
    standing = points_of_joint(boxes - 1).stop
    springs = faces.weight * faces.normal_stiffness
    springs[standing:] = 0.0
    carrying = springs > 0.0
    height: FloatArray = centre[:, 1].copy()
    rotation: FloatArray = np.zeros(boxes)
    ratio: FloatArray = np.zeros(boxes)
    force, corner_force = np.zeros((n, 2)), np.zeros((CORNERS * boxes, 2))
    weight, stiffest, place = float(np.abs(load).sum()), float(springs.max()), np.zeros((n, 2))
    force[:standing, 1] = weight / standing
    for _ in range(MOST_ROUNDS_OF_STACK):
        cosine, sine = np.cos(rotation), np.sin(rotation)
        turn = np.moveaxis(np.array([[cosine, sine], [-sine, cosine]]), -1, 0)  # of each box
        bend = np.einsum("bij,bcjdk,blk->bcidl", turn, compliance.reshape(-1, CORNERS, 2, CORNERS, 2), turn)
        bend = bend.reshape(boxes, 2 * CORNERS, 2 * CORNERS)
        elastic = np.einsum("bij,bj->bi", bend, corner_force.reshape(boxes, -1)).reshape(boxes, CORNERS, 2)
        arm = point @ np.swapaxes(turn, 1, 2) + elastic
        middle = np.column_stack([centre[:, 0], height])
        corner = (middle[:, None] + arm).reshape(-1, 2)
        linearise_points(faces, corner, place)
        gradient = np.zeros((n, 2, CORNERS * boxes, 2))  # of the points by all corners
        for i in range(n):
            for corner_of_point in range(faces.parts[i]):
                gradient[i, :, faces.corner[i, corner_of_point]] += faces.gradient[i, :, corner_of_point]
        # how corners move with their box: along x, upward, and as it turns
        rigid = np.zeros((boxes, CORNERS, 2, boxes, 3))
        for b in range(boxes):
            rigid[b, :, 0, b, 0] = rigid[b, :, 1, b, 1] = 1.0
            rigid[b, :, 0, b, 2], rigid[b, :, 1, b, 2] = arm[b, :, 1], -arm[b, :, 0]
        by_rigid = np.tensordot(gradient, rigid.reshape(CORNERS * boxes, 2, 3 * boxes), 2)  # (n, 2, 3 N)
        pulled = gradient.reshape(n, 2, boxes, -1)
        by_force = np.einsum("nabi,bij,mcbj->namc", pulled, bend, pulled)
        # Unknowns: normal forces, heights and rotations, ratios of friction to normal force.
        chosen = np.flatnonzero(carrying)
        m = chosen.size
        along = np.zeros((n, boxes))
        along[np.arange(n), joint] = 1.0
        system, right = np.zeros((m + 3 * boxes, m + 3 * boxes)), np.zeros(m + 3 * boxes)
        columns = [3 * b + k for k in (1, 2) for b in range(boxes)]
        tangential = ratio[joint]
        gaps = by_force[:, 1, :, 1] + by_force[:, 1, :, 0] * tangential  # of the normal forces
        shear = np.einsum("nm,m,mb->nb", by_force[:, 1, :, 0], force[:, 1], along)
        system[:m, :m] = gaps[np.ix_(chosen, chosen)] + np.diag(1.0 / springs[chosen])
        system[:m, m : m + 2 * boxes] = by_rigid[chosen, 1][:, columns]
        system[:m, m + 2 * boxes :] = shear[chosen]
        present = np.einsum("nmc,mc->n", by_force[:, 1], force)
        right[:m] = present[chosen] - place[chosen, 1] + shear[chosen] @ ratio
        balance = by_rigid[:, 1] + by_rigid[:, 0] * tangential[:, None]
        system[m:, :m] = balance[chosen].T
        moved = (by_rigid[:, 0] * force[:, 1, None]).T @ along
        system[m:, m + 2 * boxes :] = moved
        right[m:] = -np.column_stack([load, np.zeros(boxes)]).ravel() + moved @ ratio
        # Equations in newtons, unknowns in multiples of the weight and of its deflection: gaps in metres beside
        # forces in newtons have a condition of the stiffness squared, and the rounding of the solution decided.
        rows = np.concatenate([np.full(m, stiffest), np.ones(3 * boxes)]) / weight
        units = np.concatenate([np.full(m, weight), np.full(2 * boxes, weight / stiffest), np.ones(boxes)])
        try:
            solution = units * np.linalg.solve(rows[:, None] * system * units, rows * right)
        except np.linalg.LinAlgError:
            break
        normal = np.zeros(n)
        normal[chosen] = solution[:m]
        change = solution[m : m + 2 * boxes].reshape(2, boxes)
        ratio = np.asarray(solution[m + 2 * boxes :], dtype=float)
        before, force = force, np.column_stack([ratio[joint] * normal, normal])
        gap = place[:, 1] + by_rigid[:, 1][:, columns] @ solution[m : m + 2 * boxes]
        gap += np.einsum("nmc,mc->n", by_force[:, 1], force) - present
        height, rotation = height + change[0], rotation + change[1]
        corner_force = np.tensordot(force, gradient, 2)
        wrong = np.where(carrying, normal < -ROUNDING * weight, springs * gap < -ROUNDING * weight)
        carrying = carrying ^ wrong
        # Springs see the rounding of the positions.
        rounding = max(ROUNDING * weight, ROUNDING_OF_PLACES * float(np.abs(corner).max()) * stiffest)
        if not wrong.any() and np.abs(force - before).max() <= rounding:
            return StackedStances(
                centre=np.column_stack([centre[:, 0], height]),
                rotation=rotation,
                force=force,
                corner_force=corner_force,
            )
    raise SettlingError("what stands on a box acts outside the face below it")
