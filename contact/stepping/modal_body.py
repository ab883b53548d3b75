"""A body in a floating frame: three rigid coordinates and elastic modes; with no mode, the rigid body.

Coordinates: mass centre x, z [m], rotation [rad, > 0 toward +x] and modal amplitudes q [m sqrt(kg)]. A point
at X in the undeformed body, relative to the mass centre, is at c + R (X + Phi q), R = [[cos, sin], [-sin, cos]].
The frame is the mean-axis (Tisserand) one: the modes are mass-normalised and orthogonal to the rigid
motions, so the mass matrix is diag(m, m, I, 1, ..). Terms of the order (rotation rate / omega_1)^2 - centrifugal
stretching, change of inertia with q - are dropped. Shabana, Dynamics of Multibody Systems, ch. 5;
Canavin and Likins, J. Spacecraft 14 (1977) 724.
"""

import math
from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.interface.compliance import FEW_POINTS, add_modes, add_turned, condense_modes, turned_compliance
from contact.interface.equilibrium import Stance
from contact.interface.workspace import Contact, Workspace
from contact.jit import compiled, inlined
from contact.stepping import body as interface
from contact.stepping.body import Boxes, Frame, Ground, State, implements
from contact.stepping.scheme import Scheme
from contact.structs import struct

STEP_SLOTS = 16  #: number of step sizes whose effective masses are cached
SLOTS_OF_MODES = 64  #: number whose compliance of the modes is cached: about as many as a run has


@struct
class ModalBody(NamedTuple):
    """Constants of the body; n base points, m elastic modes, k monitored points."""

    mass: float  #: [kg]
    inertia: float  #: about the mass centre [kg m2]
    gravity: float  #: toward the floor [m/s2]
    downhill: float  #: along a floor that falls toward +x [m/s2]
    point: FloatArray  #: (n, 2) base points relative to the mass centre, sorted by x [m]
    shape: FloatArray  #: (n, 2, m) mode shapes there [1/sqrt(kg)]
    across: FloatArray  #: (m, 2 n) the same, mode by mode
    rest: FloatArray  #: (2,) mass centre of the undeformed container on the floor at x = 0 [m]
    monitor: FloatArray  #: (k, 2) monitored points relative to the mass centre [m]
    monitor_shape: FloatArray  #: (k, 2, m)
    stiffness: FloatArray  #: (m,) squares of the angular frequencies [1/s2]
    damping: FloatArray  #: (m,) damping over mass, 2 zeta omega [1/s]
    tolerance: float  #: error of a base point at which an iteration stops [m]
    #: scratch of the stepping, for each cached step size ..
    cached_step: FloatArray  #: (slots + 1,) the step [s]; last, the slot to use next
    recent: IntArray  #: (1,) the slot used last
    inverse: FloatArray  #: (slots, 3 + m) inverse effective masses
    elastic_compliance: FloatArray  #: (slots, 2 n, 2 n) effective compliance of the modes, body's frame [m/N]
    arm: FloatArray  #: (n, 2) base points relative to the mass centre, turned
    #: (3, 2 n) base points and their elastic velocity in the body's frame, and a displacement
    moved: FloatArray
    free_change: FloatArray  #: (3 + m,)


def by_modes(shape: FloatArray) -> FloatArray:
    """Mode shapes (.., n, 2, m) as rows (.., m, 2 n)."""
    points, modes = shape.shape[-3], shape.shape[-1]
    return np.ascontiguousarray(np.moveaxis(shape, -1, -3).reshape(*shape.shape[:-3], modes, 2 * points))


def make_modal_body(
    *,
    mass: float,
    inertia: float,
    gravity: float,
    downhill: float = 0.0,
    point: FloatArray,
    rest: tuple[float, float] = (0.0, 0.0),
    shape: FloatArray | None = None,
    frequencies: FloatArray | None = None,
    damping_ratios: FloatArray | None = None,
    monitor: FloatArray | None = None,
    monitor_shape: FloatArray | None = None,
    tolerance: float,
) -> ModalBody:
    """Make a body of what `ModalBody` says; without modes it is rigid.

    `shape`: (n, 2, m) mass-normalised mode shapes; `frequencies`: (m,) angular [rad/s]; `damping_ratios`: (m,) [-].
    """
    n = point.shape[0]
    omega = np.zeros(0) if frequencies is None else np.asarray(frequencies, dtype=float)
    zeta = np.zeros(omega.size) if damping_ratios is None else np.asarray(damping_ratios, dtype=float)
    watched = np.zeros((0, 2)) if monitor is None else monitor
    m = omega.size
    slots = SLOTS_OF_MODES if m > 0 else STEP_SLOTS
    shape = np.zeros((n, 2, 0)) if shape is None else np.array(shape, dtype=float, order="C")
    return ModalBody(
        mass=float(mass),
        inertia=float(inertia),
        gravity=float(gravity),
        downhill=float(downhill),
        point=np.array(point, dtype=float, order="C"),
        rest=np.array(rest, dtype=float),
        shape=shape,
        across=by_modes(shape),
        monitor=np.array(watched, dtype=float, order="C"),
        monitor_shape=np.zeros((len(watched), 2, m))
        if monitor_shape is None
        else np.array(monitor_shape, dtype=float, order="C"),
        stiffness=omega**2,
        damping=2.0 * zeta * omega,
        tolerance=float(tolerance),
        cached_step=np.append(np.full(slots, -1.0), 0.0),
        recent=np.zeros(1, dtype=np.int64),
        inverse=np.zeros((slots, 3 + m)),
        elastic_compliance=np.zeros((slots, 2 * n, 2 * n)),
        arm=np.zeros((n, 2)),
        moved=np.zeros((3, 2 * n)),
        free_change=np.zeros(3 + m),
    )


@struct
class BlockOnCorners(ModalBody):
    """A rigid body on two contact points, stepped in registers: see `integrator.advance_in_registers`."""


class LocalBlock(BlockOnCorners):
    """A rigid body on two contact points whose arrays are in registers, see `integrator.advance_in_registers`."""


MODAL = (ModalBody, BlockOnCorners, LocalBlock)


#: fields of a `ModalBody` that are written in a step
SCRATCH = ("cached_step", "recent", "inverse", "elastic_compliance", "arm", "moved", "free_change")


def own_scratch(body: ModalBody) -> ModalBody:
    """The same body, or boxes of a stack, with scratch arrays of its own."""
    own = body._replace(**{name: np.empty_like(getattr(body, name)) for name in SCRATCH})
    own.cached_step[:], own.recent[:] = -1.0, 0
    own.cached_step[..., -1] = 0.0
    return own


@implements(interface.weigh, *MODAL, inline=True)
def weigh(body: ModalBody, contact: Contact, old: State) -> None:
    """The stiffness of the base points does not change."""


@implements(interface.predict, *MODAL, inline=True)
def predict(body: ModalBody, scheme: Scheme, step: float, old: State, new: State) -> None:
    """Coordinates after `step`, for the last acceleration."""
    for j in range(old.position.size):
        new.position[j] = old.position[j] + step * (old.velocity[j] + 0.5 * step * old.acceleration[j])
        new.velocity[j] = old.velocity[j] + step * old.acceleration[j]
        new.acceleration[j] = old.acceleration[j]
    # Only the rotation is nonlinear: a better guess saves iterations.
    change = step * old.jerk[2]
    new.position[2] += scheme.newmark_beta * step * step * change
    new.velocity[2] += scheme.newmark_gamma * step * change
    new.acceleration[2] += change


@inlined
def mass_of(body: ModalBody, j: int) -> float:
    """Mass that belongs to a coordinate; the modes are mass-normalised."""
    if j < 2:
        return body.mass
    return body.inertia if j == 2 else 1.0


@compiled(inline=True)
def effective_slot(body: ModalBody, scheme: Scheme, step: float) -> int:
    """Slot of the inverse effective masses and the elastic compliance for this step size; computed if missing."""
    if body.cached_step[body.recent[0]] == step:
        return body.recent[0]
    slots = body.cached_step.size - 1
    for slot in range(slots):
        if body.cached_step[slot] == step:
            body.recent[0] = slot
            return slot
    slot = int(body.cached_step[slots]) if slots > 1 else 0  # replaces the oldest
    body.cached_step[slots] = (slot + 1) % slots
    body.cached_step[slot], body.recent[0] = step, slot
    m = body.stiffness.size
    now = 1.0 - scheme.alpha_f
    inertial = (1.0 - scheme.alpha_m) / (scheme.newmark_beta * step * step)
    viscous = now * scheme.newmark_gamma / (scheme.newmark_beta * step)
    body.inverse[slot, 0] = 1.0 / (inertial * body.mass)
    body.inverse[slot, 1] = body.inverse[slot, 0]
    body.inverse[slot, 2] = 1.0 / (inertial * body.inertia)
    for k in range(m):
        body.inverse[slot, 3 + k] = 1.0 / (inertial + viscous * body.damping[k] + now * body.stiffness[k])
    if m > 0:
        condense_modes(body.across, body.inverse[slot, 3:], body.elastic_compliance[slot])
    return slot


@compiled(inline=True)
def strain_points(body: ModalBody, position: FloatArray) -> None:
    """Base points in the body's frame, strained by the modes, into `body.moved`."""
    strained = body.moved[0]
    for i in range(body.point.shape[0]):
        strained[2 * i], strained[2 * i + 1] = body.point[i, 0], body.point[i, 1]
    add_modes(body.across, position[3:], strained)


@implements(interface.release, *MODAL, inline=True)
def release(
    body: ModalBody, scheme: Scheme, step: float, old: State, new: State, work: Workspace, ground: Ground
) -> None:
    """Base points without contact force after the step, their compliance; their arms into `body.arm`, for `respond`."""
    m, n = body.stiffness.size, body.point.shape[0]
    slot = effective_slot(body, scheme, step)
    inverse = body.inverse[slot]
    now, before = 1.0 - scheme.alpha_f, scheme.alpha_f
    cosine, sine, rate = math.cos(new.position[2]), math.sin(new.position[2]), new.velocity[2]
    floor, floor_velocity, lift, lift_velocity = ground
    strained, swung = body.moved[0], body.moved[1]
    if m > 0:
        strain_points(body, new.position)
        for a in range(swung.size):
            swung[a] = 0.0
        add_modes(body.across, new.velocity[3:], swung)
    for i in range(n):
        x, z, u, w = body.point[i, 0], body.point[i, 1], 0.0, 0.0
        if m > 0:
            x, z, u, w = strained[2 * i], strained[2 * i + 1], swung[2 * i], swung[2 * i + 1]
        body.arm[i, 0] = cosine * x + sine * z
        body.arm[i, 1] = -sine * x + cosine * z
        work.free[i, 0] = new.position[0] + body.arm[i, 0] - floor
        work.free[i, 1] = new.position[1] + body.arm[i, 1] - lift
        work.free_velocity[i, 0] = (
            new.velocity[0] + body.arm[i, 1] * rate + cosine * u + sine * w - floor_velocity
        )
        work.free_velocity[i, 1] = (
            new.velocity[1] - body.arm[i, 0] * rate - sine * u + cosine * w - lift_velocity
        )
    for j in range(3 + m):
        force = before * (old.external[j] - old.internal[j])
        if j == 0:
            force += now * body.mass * body.downhill
        elif j == 1:
            force -= now * body.mass * body.gravity
        elif j > 2:
            force -= now * (body.damping[j - 3] * new.velocity[j] + body.stiffness[j - 3] * new.position[j])
        force -= mass_of(body, j) * (
            (1.0 - scheme.alpha_m) * new.acceleration[j] + scheme.alpha_m * old.acceleration[j]
        )
        body.free_change[j] = inverse[j] * force
    slope = scheme.newmark_gamma / (scheme.newmark_beta * step)
    change, swayed = body.free_change, body.moved[2]
    if m > 0:
        for a in range(swayed.size):
            swayed[a] = 0.0
        add_modes(body.across, change[3:], swayed)
    for i in range(n):
        u, w = 0.0, 0.0
        if m > 0:
            u, w = swayed[2 * i], swayed[2 * i + 1]
        moved_x = change[0] + body.arm[i, 1] * change[2] + cosine * u + sine * w
        moved_z = change[1] - body.arm[i, 0] * change[2] - sine * u + cosine * w
        work.free[i, 0] += moved_x
        work.free[i, 1] += moved_z
        work.free_velocity[i, 0] += slope * moved_x
        work.free_velocity[i, 1] += slope * moved_z
    drift, turn = now * inverse[0], now * inverse[2]
    if n > FEW_POINTS and m > 0:
        turned_compliance(
            body.elastic_compliance[slot], body.arm, cosine, sine, now, drift, turn, work.compliance
        )
        return
    for i in range(n):
        for j in range(n):
            work.compliance[2 * i, 2 * j] = drift + turn * body.arm[i, 1] * body.arm[j, 1]
            work.compliance[2 * i, 2 * j + 1] = -turn * body.arm[i, 1] * body.arm[j, 0]
            work.compliance[2 * i + 1, 2 * j] = -turn * body.arm[i, 0] * body.arm[j, 1]
            work.compliance[2 * i + 1, 2 * j + 1] = drift + turn * body.arm[i, 0] * body.arm[j, 0]
    if m > 0:
        add_turned(body.elastic_compliance[slot], cosine, sine, now, work.compliance)


@compiled(inline=True)
def gather_force(
    body: ModalBody, force: FloatArray, rotation: float, arm: FloatArray, out: FloatArray
) -> None:
    """Generalised contact force J^T f into `out`."""
    m = body.stiffness.size
    cosine, sine = 1.0, 0.0
    if m > 0:
        cosine, sine = math.cos(rotation), math.sin(rotation)
    for j in range(3 + m):
        out[j] = 0.0
    for i in range(force.shape[0]):
        tangential, normal = force[i, 0], force[i, 1]
        if tangential != 0.0 or normal != 0.0:
            out[0] += tangential
            out[1] += normal
            out[2] += arm[i, 1] * tangential - arm[i, 0] * normal
            along, across = cosine * tangential - sine * normal, sine * tangential + cosine * normal
            for k in range(m):
                out[3 + k] += body.shape[i, 0, k] * along + body.shape[i, 1, k] * across


@implements(interface.respond, *MODAL, inline=True)
def respond(body: ModalBody, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
    """Apply `work.force` to the iterate; returns the remaining error over its tolerance."""
    m = body.stiffness.size
    now = 1.0 - scheme.alpha_f
    gather_force(body, work.force, new.position[2], body.arm, new.external)
    inverse = body.inverse[body.recent[0]]  # that of `release`
    by_velocity = scheme.newmark_gamma / (scheme.newmark_beta * step)
    by_acceleration = 1.0 / (scheme.newmark_beta * step * step)
    turned = 0.0
    for j in range(3 + m):
        change = body.free_change[j] + now * inverse[j] * new.external[j]
        new.position[j] += change
        new.velocity[j] += by_velocity * change
        new.acceleration[j] += by_acceleration * change
        if j == 2:
            turned = abs(change)
    # The points were moved along the tangents of their circles: error of this linearisation.
    reach = abs(body.arm[0, 0]) + abs(body.arm[0, 1])
    return turned * (0.5 * turned * reach) / body.tolerance


@compiled
@implements(interface.complete, *MODAL, inline=True)
def complete(body: ModalBody, new: State, floor: float, lift: float, lift_velocity: float) -> None:
    """Internal forces, base points, pose and energy at the converged coordinates."""
    m = body.stiffness.size
    position, velocity = new.position, new.velocity
    cosine, sine = math.cos(position[2]), math.sin(position[2])
    if m > 0:
        strain_points(body, position)
    for i in range(body.point.shape[0]):
        x, z = body.point[i, 0], body.point[i, 1]
        if m > 0:
            x, z = body.moved[0, 2 * i], body.moved[0, 2 * i + 1]
        body.arm[i, 0], body.arm[i, 1] = cosine * x + sine * z, -sine * x + cosine * z
        new.point[i, 0] = position[0] + body.arm[i, 0] - floor
        new.point[i, 1] = position[1] + body.arm[i, 1] - lift
    new.internal[0], new.internal[1] = 0.0 - body.mass * body.downhill, body.mass * body.gravity
    new.internal[2] = 0.0
    rise = velocity[1] - lift_velocity
    kinetic = body.mass * (velocity[0] ** 2 + rise**2) + body.inertia * velocity[2] ** 2
    strain = 0.0
    for k in range(m):
        q, rate = position[3 + k], velocity[3 + k]
        new.damping[3 + k] = body.damping[k] * rate
        new.internal[3 + k] = new.damping[3 + k] + body.stiffness[k] * q
        kinetic += rate * rate
        strain += body.stiffness[k] * q * q
    new.energy[interface.KINETIC] = 0.5 * kinetic
    new.energy[interface.STRAIN] = 0.5 * strain
    new.energy[interface.POTENTIAL] = body.mass * body.gravity * (position[1] - lift)
    new.energy[interface.POTENTIAL] -= body.mass * body.downhill * (position[0] - floor)
    new.pose[interface.ROTATION], new.pose[interface.ANGULAR_VELOCITY] = position[2], velocity[2]
    new.pose[interface.CENTRE_X], new.pose[interface.CENTRE_Z] = position[0], position[1]
    new.pose[interface.VELOCITY_X], new.pose[interface.VELOCITY_Z] = velocity[0], velocity[1]


@implements(interface.observe, *MODAL, inline=True)
def observe(body: ModalBody, new: State, floor: float, lift: float) -> None:
    """Displacement and velocity of the monitored points."""
    m = body.stiffness.size
    position, velocity = new.position, new.velocity
    cosine, sine = math.cos(position[2]), math.sin(position[2])
    rate = velocity[2]
    for i in range(body.monitor.shape[0]):
        x, z = body.monitor[i, 0], body.monitor[i, 1]
        u, w = 0.0, 0.0
        for k in range(m):
            x += body.monitor_shape[i, 0, k] * position[3 + k]
            z += body.monitor_shape[i, 1, k] * position[3 + k]
            u += body.monitor_shape[i, 0, k] * velocity[3 + k]
            w += body.monitor_shape[i, 1, k] * velocity[3 + k]
        arm_x, arm_z = cosine * x + sine * z, -sine * x + cosine * z
        new.monitor[i, 0] = position[0] + arm_x - floor - body.rest[0] - body.monitor[i, 0]
        new.monitor[i, 1] = position[1] + arm_z - lift - body.rest[1] - body.monitor[i, 1]
        new.monitor[i, 2] = velocity[0] + arm_z * rate + cosine * u + sine * w
        new.monitor[i, 3] = velocity[1] - arm_x * rate - sine * u + cosine * w


@implements(interface.shift_velocity, *MODAL, inline=True)
def shift_velocity(body: ModalBody, state: State, frame: Frame, boxes: Boxes) -> None:
    """Subtract the velocities of a frame; the modes are orthogonal to them."""
    velocity, lift_velocity, spin = frame
    state.velocity[0] -= velocity + spin * state.position[1]
    state.velocity[1] -= lift_velocity - spin * state.position[0]
    state.velocity[2] -= spin


@implements(interface.prepared, *MODAL, inline=True)
def prepared(body: ModalBody, step: float) -> bool:
    """A modal body can take a step of any size."""
    return True


def place(body: ModalBody, state: State, stance: Stance) -> None:
    """Write the initial coordinates: the stance's rigid pose, strained by its contact forces."""
    cosine, sine = math.cos(stance.rotation), math.sin(stance.rotation)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    state.position[:2], state.position[2] = stance.centre, stance.rotation
    state.velocity[:] = 0.0
    state.velocity[:3] = *stance.velocity, stance.angular_velocity
    state.position[3:] = np.einsum("ij,ijk->k", stance.force @ turn, body.shape) / body.stiffness


@compiled
def start(body: ModalBody, state: State, floor: float, lift: float, lift_velocity: float) -> None:
    """Complete the initial state from its coordinates and contact forces, with the acceleration."""
    complete(body, state, floor, lift, lift_velocity)
    gather_force(body, state.force, state.position[2], body.arm, state.external)
    for j in range(state.acceleration.size):
        state.acceleration[j] = (state.external[j] - state.internal[j]) / mass_of(body, j)
