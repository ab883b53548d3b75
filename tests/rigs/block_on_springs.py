"""A rigid block on discrete springs: the reference for restitution where Housner's is none, and for corner forces.

Springs and dashpots under the base that never pull, and friction regularised in velocity, all over the mass. It
shares with the program the data of the bed only: no law, no time stepping. x to the right, z up, rotation > 0
tilts toward +x. Psycharis and Jennings, Earthquake Engng Struct. Dyn. 11 (1983) have the bed of springs.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

from contact.reference.rigid_block import RigidBlock
from fem.runtime.arrays import FloatArray

FRICTION = 3.0
CREEP_VELOCITY = 1e-3  #: below which friction is less than its limit [m/s]
#: [s]; a turning point between two steps is missed by less than 1e-6 of the slenderness angle
LONGEST_STEP = 2e-3


def evenly_spaced(width: float, count: int) -> FloatArray:
    """Places of springs that stand for a bed, each in the middle of its share of the width, (count,) [m]."""
    return width * ((np.arange(count) + 0.5) / count - 0.5)


def next_turning_point(
    block: RigidBlock,
    *,
    places: FloatArray,
    stiffness: float,
    relaxation_time: float,
    rotation: float,
    duration: float,
) -> float:
    """|rotation| at the turning point after the first impact [rad], the block released at rest just above its springs.

    `places`: of the springs along the base from its centre, (n,) [m]; `stiffness`: of all together over the mass
    [1/s2]; `relaxation_time`: dashpot over spring [s]; `duration`: until after that turning point [s].
    """
    below, spring = block.centroid_height, stiffness / places.size
    inertia = (block.inertia_ratio - 1.0) * block.radius**2

    def rate(_: float, state: FloatArray) -> FloatArray:
        z, angle, (vx, vz, spin) = state[1], state[2], state[3:]
        cos, sin = math.cos(angle), math.sin(angle)
        # velocity of a point per spin
        arm_x, arm_z = (-places * sin - below * cos, -places * cos + below * sin)
        depth = places * sin + below * cos - z
        pressing = spring * (depth - relaxation_time * (vz + spin * arm_z))
        normal = np.where(depth > 0.0, np.maximum(pressing, 0.0), 0.0)
        shear = -FRICTION * normal * np.tanh((vx + spin * arm_x) / CREEP_VELOCITY)
        moment = float(shear @ arm_x + normal @ arm_z)
        return np.array([vx, vz, spin, shear.sum(), normal.sum() - block.gravity, moment / inertia])

    height = block.half_width * math.sin(abs(rotation)) + below * math.cos(rotation)
    start = [0.0, height, rotation, 0.0, 0.0, 0.0]
    solution = solve_ivp(
        rate, (0.0, duration), start, method="LSODA", rtol=1e-5, atol=1e-10, max_step=LONGEST_STEP
    )
    angles = solution.y[2]
    return float(-(angles * math.copysign(1.0, rotation)).min())


def largest_corner_force(
    block: RigidBlock,
    *,
    mass: float,
    stiffness: float,
    relaxation_time: float,
    friction: float,
    window: float,
    rotation: float,
    duration: float,
    step: float = 8e-6,
) -> float:
    """Largest mean force on a corner over a window that slides with the time [N].

    The block stands on two corners, each a spring with a dashpot that never pulls, and a like one along x that slides
    at `friction` times the force. Explicit steps of one size, no step control.

    Args:
        mass: [kg]; stiffness: of the spring of one corner [N/m]; relaxation_time: dashpot over spring [s].
        window, duration, step: [s].
        rotation: from which the block is released at rest, its corner as deep as it carries the weight [rad].
    """
    below, half = block.centroid_height, block.half_width
    inertia = (block.inertia_ratio - 1.0) * block.radius**2 * mass
    x, turned, vx, vz, spin = 0.0, rotation, 0.0, 0.0, 0.0
    z = half * math.sin(abs(turned)) + below * math.cos(turned) - mass * block.gravity / stiffness
    anchors: list[float | None] = [None, None]
    forces = np.zeros((round(duration / step), 2))
    for row in forces:
        sin, cos = math.sin(turned), math.cos(turned)
        shear = normal = moment = 0.0
        for corner, side in enumerate((-half, half)):
            arm_x, arm_z = side * cos - below * sin, -side * sin - below * cos
            press = stiffness * (-(z + arm_z) - relaxation_time * (vz - spin * arm_x))
            if z + arm_z >= 0.0 or press <= 0.0:
                anchors[corner] = None
                continue
            at, speed = x + arm_x, vx + spin * arm_z
            held = anchors[corner]
            anchor = at if held is None else held
            hold = -stiffness * (at - anchor + relaxation_time * speed)
            if abs(hold) > friction * press:
                hold = math.copysign(friction * press, hold)
                anchor = at + hold / stiffness + relaxation_time * speed
            anchors[corner], row[corner] = anchor, press
            shear, normal, moment = shear + hold, normal + press, moment + hold * arm_z - press * arm_x
        vx, vz, spin = (
            vx + step * shear / mass,
            vz + step * (normal / mass - block.gravity),
            spin + step * moment / inertia,
        )
        x, z, turned = x + step * vx, z + step * vz, turned + step * spin
    count = round(window / step)
    sums = np.cumsum(np.vstack([np.zeros((1, 2)), forces]), axis=0)
    return float((sums[count:] - sums[:-count]).max()) / count
