"""Data of the contact problem: the constants of the floor, and the arrays of one solution."""

from typing import Annotated, NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.layout import zeros_of
from contact.structs import struct


@struct
class Contact(NamedTuple):
    """Properties of the contact with the floor: constants of one run, n contact points."""

    normal_stiffness: FloatArray  #: [N/m]
    tangential_stiffness: FloatArray  #: [N/m]
    #: (n,) largest normal force, dashpot included, at which the intact floor crushes [N]; infinite: it does not
    cap: FloatArray
    #: (n,) by which it grows with the indentation, over that of the intact floor [1/m]
    cap_growth: FloatArray
    #: (n,) dashpot over spring, of the normal and of the stuck tangential direction [s]
    relaxation_time: FloatArray
    mu_static: FloatArray  #: (n,) the same for all points of a joint, as the next two
    mu_kinetic: FloatArray  #: (n,)
    weakening: FloatArray  #: (n,) slip over which static falls to kinetic friction [m]
    stribeck_velocity: float  #: slip velocity over which it falls; 0: not with velocity [m/s]
    camber: FloatArray  #: (n,) height of the points above the lowest one of an upright base [m]
    friction: int  #: one of `laws.FRICTION_LAWS`
    regularisation_velocity: float  #: [m/s]
    force_scale: float  #: weight of the container [N], the scale of negligible forces
    resolution: float  #: rounding of a point's position; times the slope, the least force resolved [m]
    #: step above which held points are first linearised at their old positions [s]
    held_step: float = 0.0
    #: Newton steps in which points that have turned from one limit to the other are spared the line search
    turned_steps: int = 40
    #: of a base that rolls, see `laws.rolling_lead`: how far it leads in time [s]; 0: no rolling resistance
    rolling_time: float = 0.0
    rolling_radius: float = 0.0  #: of its camber [m]
    rolling_reach: float = 0.0  #: half its width [m]


@struct
class Workspace(NamedTuple):
    """Arrays of one contact problem, shapes in terms of the n base points."""

    free: Annotated[FloatArray, "n", 2]  #: positions of the points without contact force [m]
    free_velocity: Annotated[FloatArray, "n", 2]  #: and their velocities, relative to the floor [m/s]
    compliance: Annotated[FloatArray, "2n", "2n"]  #: G [m/N], x and z of a point in turn
    point: Annotated[FloatArray, "n", 2]  #: [m]
    velocity: Annotated[FloatArray, "n", 2]  #: [m/s]
    force: Annotated[FloatArray, "n", 2]  #: [N]
    law: Annotated[FloatArray, "n", 2]  #: force of the laws at `point` [N]
    #: minus its derivatives: tangential by x, tangential by z, normal by z [N/m]
    slope: Annotated[FloatArray, "n", 3]
    cap: Annotated[FloatArray, "n"]  #: largest normal force in this step [N]
    matrix: Annotated[FloatArray, "2n", "2n"]  #: factors of the tangent over the active points
    change: Annotated[FloatArray, "2n"]
    solution: Annotated[FloatArray, "2n"]
    excess: Annotated[FloatArray, "n", 2]  #: what friction cuts off [N]; minus d/dx of the uncut force [N/m]
    mu: Annotated[FloatArray, "n"]  #: coefficients of friction in this step
    side: Annotated[IntArray, "n"]  #: limit of friction reached in the last iteration: -1, 1; 0: none
    #: of the normal force in the last iteration: -1 open, 1 at the cap; 0: elastic
    level: Annotated[IntArray, "n"]
    pivot: Annotated[IntArray, "2n"]  #: pivots of `matrix`
    factored_slope: Annotated[FloatArray, "n", 3]  #: tangents for which `matrix` was factored
    factored_step: Annotated[FloatArray, 1]  #: and step size; < 0: none [s]
    factored_count: Annotated[IntArray, 1]  #: and number of active points
    trial: Annotated[FloatArray, "n", 2]
    active: Annotated[IntArray, "n"]  #: active points, the first `factored_count` entries


def make_workspace(points: int) -> Workspace:
    """Allocate the arrays for so many base points, on a floor that does not crush."""
    work = Workspace(**zeros_of(Workspace, **{"n": points, "2n": 2 * points}))
    work.factored_step[0] = -1.0
    work.cap[:] = np.inf
    return work
