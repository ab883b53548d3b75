"""Equilibrium of boxes that stand on one another, before the motion begins."""

from dataclasses import dataclass

import numpy as np

from contact.arrays import FloatArray
from contact.interface.contact_points import points_of_joint
from contact.interface.equilibrium import ROUNDING, SettlingError
from contact.interface.faces import CORNERS, Faces, linearise_points

MOST_ROUNDS = 50
ROUNDING_OF_PLACES = 1e-14  #: of a corner, over its distance from the origin


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
        centre: (N, 2) mass centres of the boxes in the undeformed stack on the floor [m].
        point: (N, 4, 2) corners relative to the mass centre of their box [m].
        compliance: (N, 8, 8) elastic compliance of the boxes at their corners, inertia relief [m/N].
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
    for _ in range(MOST_ROUNDS):
        cosine, sine = np.cos(rotation), np.sin(rotation)
        turn = np.moveaxis(np.array([[cosine, sine], [-sine, cosine]]), -1, 0)  # of each box
        bend = np.einsum("bij,bcjdk,blk->bcidl", turn, _by_point(compliance), turn)
        bend = bend.reshape(boxes, 2 * CORNERS, 2 * CORNERS)
        elastic = np.einsum("bij,bj->bi", bend, corner_force.reshape(boxes, -1)).reshape(boxes, CORNERS, 2)
        arm = point @ np.swapaxes(turn, 1, 2) + elastic
        middle = np.column_stack([centre[:, 0], height])
        corner = (middle[:, None] + arm).reshape(-1, 2)
        linearise_points(faces, corner, place)
        gradient = _dense_gradient(faces, boxes)  # (n, 2, 4 N, 2)
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


def _by_point(compliance: FloatArray) -> FloatArray:
    """(N, 8, 8) as (N, 4, 2, 4, 2)."""
    return compliance.reshape(-1, CORNERS, 2, CORNERS, 2)


def _dense_gradient(faces: Faces, boxes: int) -> FloatArray:
    """Derivatives of the contact points by all corners, (n, 2, 4 N, 2)."""
    n = faces.weight.size
    dense = np.zeros((n, 2, CORNERS * boxes, 2))
    for i in range(n):
        for k in range(faces.parts[i]):
            dense[i, :, faces.corner[i, k]] += faces.gradient[i, :, k]
    return dense
