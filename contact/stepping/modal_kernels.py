"""The operations of a `ModalBody` in the stepping, compiled; `contact.stepping.body` defines them."""

import math

import numpy as np

from contact.arrays import FloatArray
from contact.interface.compliance import FEW_POINTS, add_modes, add_turned, condense_modes, turned_compliance
from contact.interface.equilibrium import Stance
from contact.interface.workspace import Contact, Workspace
from contact.jit import compiled, inlined
from contact.stepping import body as interface
from contact.stepping.body import (
    ANGULAR_VELOCITY,
    CENTRE_X,
    CENTRE_Z,
    KINETIC,
    POTENTIAL,
    ROTATION,
    STRAIN,
    VELOCITY_X,
    VELOCITY_Z,
    Boxes,
    Frame,
    Ground,
    State,
    implements,
)
from contact.stepping.modal_body import MODAL, ModalBody
from contact.stepping.scheme import Scheme


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


@compiled(inline=True)
def place_points(
    body: ModalBody, state: State, work: Workspace, ground: Ground, cosine: float, sine: float
) -> None:
    """Base points and their velocities at the iterate, relative to the floor; arms into `body.arm`."""
    floor, floor_velocity, lift, lift_velocity = ground
    m = body.stiffness.size
    rate = state.velocity[2]
    strained, swung = body.moved[0], body.moved[1]
    if m > 0:
        strain_points(body, state.position)
        for a in range(swung.size):
            swung[a] = 0.0
        add_modes(body.across, state.velocity[3:], swung)
    for i in range(body.point.shape[0]):
        x, z, u, w = body.point[i, 0], body.point[i, 1], 0.0, 0.0
        if m > 0:
            x, z, u, w = strained[2 * i], strained[2 * i + 1], swung[2 * i], swung[2 * i + 1]
        body.arm[i, 0] = cosine * x + sine * z
        body.arm[i, 1] = -sine * x + cosine * z
        work.free[i, 0] = state.position[0] + body.arm[i, 0] - floor
        work.free[i, 1] = state.position[1] + body.arm[i, 1] - lift
        work.free_velocity[i, 0] = (
            state.velocity[0] + body.arm[i, 1] * rate + cosine * u + sine * w - floor_velocity
        )
        work.free_velocity[i, 1] = (
            state.velocity[1] - body.arm[i, 0] * rate - sine * u + cosine * w - lift_velocity
        )


@implements(interface.release, *MODAL, inline=True)
def release(
    body: ModalBody, scheme: Scheme, step: float, old: State, new: State, work: Workspace, ground: Ground
) -> None:
    """Base points at the end of the step without contact force, and their compliance."""
    m = body.stiffness.size
    n = body.point.shape[0]
    slot = effective_slot(body, scheme, step)
    inverse = body.inverse[slot]
    now, before = 1.0 - scheme.alpha_f, scheme.alpha_f
    cosine, sine = math.cos(new.position[2]), math.sin(new.position[2])
    place_points(body, new, work, ground, cosine, sine)
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
    change, swung = body.free_change, body.moved[2]
    if m > 0:
        for a in range(swung.size):
            swung[a] = 0.0
        add_modes(body.across, change[3:], swung)
    for i in range(n):
        u, w = 0.0, 0.0
        if m > 0:
            u, w = swung[2 * i], swung[2 * i + 1]
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
    new.energy[KINETIC] = 0.5 * kinetic
    new.energy[STRAIN] = 0.5 * strain
    new.energy[POTENTIAL] = body.mass * body.gravity * (position[1] - lift)
    new.energy[POTENTIAL] -= body.mass * body.downhill * (position[0] - floor)
    new.pose[ROTATION], new.pose[ANGULAR_VELOCITY] = position[2], velocity[2]
    new.pose[CENTRE_X], new.pose[CENTRE_Z] = position[0], position[1]
    new.pose[VELOCITY_X], new.pose[VELOCITY_Z] = velocity[0], velocity[1]


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
