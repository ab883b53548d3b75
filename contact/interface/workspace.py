"""Data of the contact problem: the constants of the floor, and the arrays of one solution."""

from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.structs import struct


@struct
class Contact(NamedTuple):
    """Properties of the contact with the floor: constants of one run, n contact points."""

    normal_stiffness: FloatArray  #: [N/m]
    tangential_stiffness: FloatArray  #: [N/m]
    cap: FloatArray  #: largest normal force, dashpot included, at which the floor crushes [N]; infinite: it does not
    relaxation_time: float  #: dashpot over spring, of the normal and of the stuck tangential direction [s]
    mu_static: FloatArray  #: (n,) the same for all points of a joint, as the next two
    mu_kinetic: FloatArray  #: (n,)
    weakening: FloatArray  #: (n,) slip over which static falls to kinetic friction [m]
    stribeck_velocity: float  #: slip velocity over which it falls; 0: not with velocity [m/s]
    friction: int  #: one of `laws.FRICTION_LAWS`
    regularisation_velocity: float  #: [m/s]
    force_scale: float  #: weight of the container [N], the scale of negligible forces
    resolution: float  #: rounding of a point's position; times the slope, the least force resolved [m]
    #: step above which held points are first linearised at their old positions [s]
    held_step: float = 0.0
    #: Newton steps in which points that have turned from one limit to the other are spared the line search
    turned_steps: int = 40


@struct
class Workspace(NamedTuple):
    """Arrays of one contact problem, shapes in terms of the n base points."""

    free: FloatArray  #: (n, 2) positions of the points without contact force [m]
    free_velocity: FloatArray  #: (n, 2) and their velocities, relative to the floor [m/s]
    compliance: FloatArray  #: (2 n, 2 n) G [m/N], x and z of a point in turn
    point: FloatArray  #: (n, 2) [m]
    velocity: FloatArray  #: (n, 2) [m/s]
    force: FloatArray  #: (n, 2) [N]
    law: FloatArray  #: (n, 2) force of the laws at `point` [N]
    slope: FloatArray  #: (n, 3) minus its derivatives: tangential by x, tangential by z, normal by z [N/m]
    matrix: FloatArray  #: (2 n, 2 n) factors of the tangent over the active points
    change: FloatArray  #: (2 n,)
    solution: FloatArray  #: (2 n,)
    excess: FloatArray  #: (n, 2) what friction cuts off [N]; minus d/dx of the uncut force [N/m]
    mu: FloatArray  #: (n,) coefficients of friction in this step
    side: IntArray  #: (n,) limit of friction reached in the last iteration: -1, 1; 0: none
    level: IntArray  #: (n,) of the normal force in the last iteration: -1 open, 1 at the cap; 0: elastic
    pivot: IntArray  #: (2 n,) pivots of `matrix`
    factored_slope: FloatArray  #: (n, 3) tangents for which `matrix` was factored
    factored_step: FloatArray  #: (1,) and step size; < 0: none [s]
    factored_count: IntArray  #: (1,) and number of active points
    trial: FloatArray  #: (n, 2)
    active: IntArray  #: (n,) active points, the first `factored_count` entries


def make_workspace(points: int) -> Workspace:
    """Allocate the arrays for so many base points."""
    n = points
    return Workspace(
        free=np.zeros((n, 2)),
        free_velocity=np.zeros((n, 2)),
        compliance=np.zeros((2 * n, 2 * n)),
        point=np.zeros((n, 2)),
        velocity=np.zeros((n, 2)),
        force=np.zeros((n, 2)),
        law=np.zeros((n, 2)),
        slope=np.zeros((n, 3)),
        matrix=np.zeros((2 * n, 2 * n)),
        change=np.zeros(2 * n),
        solution=np.zeros(2 * n),
        excess=np.zeros((n, 2)),
        mu=np.zeros(n),
        side=np.zeros(n, dtype=np.int64),
        level=np.zeros(n, dtype=np.int64),
        pivot=np.zeros(2 * n, dtype=np.int64),
        factored_slope=np.zeros((n, 3)),
        factored_step=np.full(1, -1.0),
        factored_count=np.zeros(1, dtype=np.int64),
        trial=np.zeros((n, 2)),
        active=np.zeros(n, dtype=np.int64),
    )
