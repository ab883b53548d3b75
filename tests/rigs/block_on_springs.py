"""A rigid block on discrete springs, integrated by scipy: the reference for restitution where Housner's is none.

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
    """|rotation| at the turning point after the first impact [rad].

    Args:
        places: of the springs along the base from its centre, (n,) [m].
        stiffness: of all springs together over the mass [1/s2].
        relaxation_time: dashpot over spring [s].
        rotation: from which the block is released at rest, its corner just above the springs [rad].
        duration: until after that turning point [s].
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
