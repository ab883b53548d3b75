"""Forces in the joints between the boxes of a stack that moves as one body.

Formulas and signs: README.md of this folder. Forces are means over an interval of the history, from the momentum
at its ends; o is the joint's centre in the middle of the interval, where normal and shear are taken along the
container's axes. In a floating frame terms of the order of the strain times the inertia are dropped, as in its
equations of motion.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array

from contact.stepping.body import ANGULAR_VELOCITY, ROTATION, State
from fem.case.tables.links import held_above
from fem.model.model import Model
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.assembly import FiniteElements

#: columns of a joint's motion: momentum [kg m/s], angular momentum about their own mass centre [kg m2/s] and mass
#: centre of the boxes above [m], the joint's centre [m], the container's rotation [rad]
MOMENTUM, SPIN, CENTRE, JOINT, TURN = slice(0, 2), 2, slice(3, 5), slice(5, 7), 7
MOTION_COLUMNS = 8
#: over the time scale of rocking: interval around t = 0 on which the initial acceleration acts
INSTANT = 1e-4


@dataclass(frozen=True, kw_only=True, eq=False)
class Joints:
    """The J joints of a container, from the floor up, and their forces from its coordinates."""

    height: FloatArray  #: (J,) above the floor, undeformed [m]
    mass: FloatArray  #: (J,) of what is above [kg]
    gravity: float  #: toward the floor [m/s2]
    downhill: float  #: along a floor that falls toward +x [m/s2]
    full: bool  #: coordinates are positions of nodes, else those of a floating frame
    #: for positions of nodes:
    layers: tuple[csr_array, ...]  #: J consistent masses (n, n), from each joint up to the next [kg]
    ends: IntArray  #: (J, 2) nodes at the left and the right end of the joint
    #: for a floating frame with m modes, relative to the mass centre of the container, in its frame:
    centre: FloatArray  #: (J, 2) mass centre of what is above [m]
    middle: FloatArray  #: (J, 2) of the joint [m]
    inertia: FloatArray  #: (J,) of what is above, about its mass centre [kg m2]
    mean_shape: FloatArray  #: (m, J, 2) mean of each mode over what is above [1/sqrt(kg)]
    spin_shape: FloatArray  #: (m, J) angular momentum of each mode there, about its mass centre, per rate [m sqrt(kg)]
    middle_shape: FloatArray  #: (m, J, 2) mean of each mode at both ends of the joint [1/sqrt(kg)]

    def motion(self, position: FloatArray, velocity: FloatArray, rotation: FloatArray) -> FloatArray:
        """Momenta and positions at k instants, (k, J, 8), from coordinates and rates (k, n_d) and rotations (k,)."""
        out = np.empty((len(rotation), self.height.size, MOTION_COLUMNS))
        out[:, :, TURN] = rotation[:, None]
        if not self.full:
            cosine, sine = np.cos(position[:, 2:3]), np.sin(position[:, 2:3])
            spin = velocity[:, 2][:, None]

            def turned(vector: FloatArray) -> FloatArray:
                x, z = vector[:, :, 0], vector[:, :, 1]
                return np.stack([cosine * x + sine * z, cosine * z - sine * x], axis=2)

            arm = self.centre + np.tensordot(position[:, 3:], self.mean_shape, axes=1)
            rate = np.tensordot(velocity[:, 3:], self.mean_shape, axes=1)
            rate[:, :, 0] += spin * arm[:, :, 1]
            rate[:, :, 1] -= spin * arm[:, :, 0]
            out[:, :, MOMENTUM] = self.mass[:, None] * (velocity[:, None, :2] + turned(rate))
            out[:, :, SPIN] = spin * self.inertia + velocity[:, 3:] @ self.spin_shape
            out[:, :, CENTRE] = position[:, None, :2] + turned(arm)
            middle = self.middle + np.tensordot(position[:, 3:], self.middle_shape, axes=1)
            out[:, :, JOINT] = position[:, None, :2] + turned(middle)
            return out
        for k in range(len(rotation)):
            place, rate = position[k].reshape(-1, 2), velocity[k].reshape(-1, 2)
            origin = place[self.ends].mean(axis=(0, 1))
            arm = place - origin
            for j, layer in enumerate(self.layers):
                momentum, first = layer @ rate, layer @ arm
                out[k, j, MOMENTUM], out[k, j, CENTRE] = momentum.sum(axis=0), first.sum(axis=0)
                out[k, j, SPIN] = np.sum(arm[:, 1] * momentum[:, 0] - arm[:, 0] * momentum[:, 1])
            out[k, :, : JOINT.start] = _summed_from_above(out[k, :, : JOINT.start])
            out[k, :, CENTRE] /= self.mass[:, None]
            out[k, :, SPIN] -= _moment(out[k, :, CENTRE], out[k, :, MOMENTUM])
            out[k, :, CENTRE] += origin
            out[k, :, JOINT] = place[self.ends].mean(axis=1)
        return out

    def forces(self, motion: FloatArray, interval: float) -> FloatArray:
        """Mean normal force [N], shear [N] and moment [Nm], (k, J, 3), between instants of a motion (k + 1, J, 8)."""
        before, after = motion[:-1], motion[1:]
        mean = 0.5 * (before + after)
        weight, pull = self.mass * self.gravity, self.mass * self.downhill
        force = (after[:, :, MOMENTUM] - before[:, :, MOMENTUM]) / interval
        force[:, :, 0] -= pull
        force[:, :, 1] += weight
        place = mean[:, :, JOINT]
        moment = (_about(place, after) - _about(place, before)) / interval
        arm = mean[:, :, CENTRE] - place
        moment -= weight * arm[:, :, 0] + pull * arm[:, :, 1]
        cosine, sine = np.cos(mean[:, :, TURN]), np.sin(mean[:, :, TURN])
        normal = sine * force[:, :, 0] + cosine * force[:, :, 1]
        shear = cosine * force[:, :, 0] - sine * force[:, :, 1]
        return np.stack([normal, shear, moment], axis=2)

    def initial_forces(self, state: State, time_scale: float) -> FloatArray:
        """Forces at the initial state, from its acceleration, shape (J, 3); `time_scale` of the motion [s]."""
        half = INSTANT * time_scale
        ahead = np.array([[-half], [half]])
        position = state.position + ahead * state.velocity + 0.5 * half**2 * state.acceleration
        velocity = state.velocity + ahead * state.acceleration
        rotation = state.pose[ROTATION] + ahead[:, 0] * state.pose[ANGULAR_VELOCITY]
        return self.forces(self.motion(position, velocity, rotation), 2.0 * half)[0]

    def in_moving_frame(self, motion: FloatArray, velocity: tuple[float, float]) -> FloatArray:
        """The same motion, shape (.., J, 8), seen from a frame with this velocity along x and upward [m/s]."""
        seen = motion.copy()
        seen[..., MOMENTUM] -= self.mass[:, None] * np.asarray(velocity)
        return seen


def joints_of(model: Model, heights: FloatArray | None = None) -> Joints | None:
    """The joints of a model's stack; None for a single box, for boxes without bolts, and where links hold upper boxes.

    `heights`: (J,) of mesh lines taken for joints; those between the boxes, if not given [m].
    """
    container = model.container
    mesh, elements, shapes = container.mesh, container.elements, container.basis.shapes
    bottoms = [box.bottom for box in model.case.stack[1:]]
    lines = np.asarray(bottoms if heights is None else heights, dtype=float)
    if lines.size == 0 or model.case.container.is_loose or held_above(model.case):
        return None
    middle = mesh.elevation.areas_and_centroids[1][:, 1]
    layers = tuple(
        elements.mass_of(np.flatnonzero((low < middle) & (middle < high)), mesh.areal_density)
        for low, high in pairwise([*lines, np.inf])
    )
    arm = elements.nodes - np.asarray(mesh.centroid)
    spin = np.column_stack([arm[:, 1], -arm[:, 0]])  # velocities of a unit rotation
    nodal = _summed_from_above(np.array([layer @ np.ones(len(arm)) for layer in layers]))
    weighted = _summed_from_above(np.array([layer @ spin for layer in layers]))
    total = nodal.sum(axis=1)
    centre = nodal @ arm / total[:, None]
    mean_shape = np.einsum("jn,mnd->mjd", nodal, shapes) / total[:, None]
    ends = np.array([_ends(elements, height) for height in lines])
    return Joints(
        height=lines,
        mass=total,
        gravity=model.run.problem.control.gravity,
        downhill=model.run.problem.control.downhill,
        full=model.case.solver.model == "full",
        layers=layers,
        ends=ends,
        centre=centre,
        middle=arm[ends].mean(axis=1),
        inertia=np.tensordot(weighted, spin, axes=2) - total * np.sum(centre**2, axis=1),
        mean_shape=mean_shape,
        spin_shape=np.einsum("jnd,mnd->mj", weighted, shapes) - total * _moment(centre, mean_shape),
        middle_shape=shapes[:, ends].mean(axis=2),
    )


def _summed_from_above(values: FloatArray) -> FloatArray:
    """Cumulative sums over the first axis, from the uppermost layer down."""
    return np.cumsum(values[::-1], axis=0)[::-1]


def _moment(arm: FloatArray, momentum: FloatArray) -> FloatArray:
    """z p_x - x p_z over the last axis, > 0 toward +x."""
    return arm[..., 1] * momentum[..., 0] - arm[..., 0] * momentum[..., 1]


def _about(place: FloatArray, motion: FloatArray) -> FloatArray:
    """Angular momentum about places (k, J, 2), > 0 toward +x [kg m2/s]."""
    return motion[:, :, SPIN] + _moment(motion[:, :, CENTRE] - place, motion[:, :, MOMENTUM])


def _ends(elements: FiniteElements, height: float) -> tuple[int, int]:
    """The outermost nodes of a mesh line that cells above and below it share."""
    nodes, cells = elements.nodes, elements.cells
    z = nodes[:, 1]
    line = np.flatnonzero(np.abs(z - height) <= 1e-6 * np.ptp(z))
    above = z[cells].mean(axis=1) > height
    if above.any() and not above.all():  # else a face of the whole stack
        line = line[np.isin(line, cells[above]) & np.isin(line, cells[~above])]
    x = nodes[line, 0]
    return int(line[np.argmin(x)]), int(line[np.argmax(x)])


def edge_forces(
    normal: FloatArray, moment: FloatArray, width: float | FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Compression at the left and the right edge of a joint of rigid faces [N]; negative: tension."""
    return 0.5 * normal + moment / width, 0.5 * normal - moment / width
