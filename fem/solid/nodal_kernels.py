"""Compiled step of the full model, of one body and of a loose stack: every node free to move, no tangent assembled.

The functions that `contact.stepping.body` asks of a body, for `fem.solid.nodal_body`: internal forces cell by cell,
products with mass and stiffness, and one back-substitution for each iteration, with the factors of the turned Newmark
matrix that `FullBody.prepare` computes. Vectors of all unknowns are interleaved, x and z of a node in turn; positions
are absolute.
"""

import math
from pathlib import Path
from typing import NamedTuple

import fem.solid.block_factor
import fem.solid.elasticity
from contact.interface.compliance import add_turned
from contact.interface.workspace import Contact, Workspace
from contact.jit import compiled
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
from contact.stepping.integrator import advance, enter_floor_frame
from contact.stepping.loose_stack import box_of, complete_compiled
from contact.stepping.scheme import Scheme
from contact.structs import struct
from fem.runtime.arrays import FloatArray, IntArray
from fem.solid.block_factor import BlockPattern, substitute_blocks
from fem.solid.elasticity import CellBlocks, element_forces

#: what the machine code depends on besides the sources of `contact`
SOURCES = (Path(__file__), Path(fem.solid.block_factor.__file__), Path(fem.solid.elasticity.__file__))


@struct
class NodalBody(NamedTuple):
    """Constants of the container, the factors at hand, and scratch; n nodes, m cells of k nodes, n_c base points."""

    mass: float  #: [kg]
    inertia: float  #: about the mass centre [kg m2]
    gravity: float  #: toward the floor [m/s2]
    downhill: float  #: along a floor that falls toward +x [m/s2]
    damping: float  #: a of the damping a K in the turned frame [s]
    tolerance: float  #: residual at which the iterations of a step stop [N]
    first: float  #: Lamé pair of plane stress [Pa]
    shear: float
    node: FloatArray  #: (n, 2) reference positions [m]
    nodal_mass: FloatArray  #: (n,) row sums of the mass [kg]
    mass_arm: FloatArray  #: (n, 2) mass times reference position relative to the mass centre [kg m]
    mass_starts: IntArray  #: mass (n, n) by rows [kg]
    mass_columns: IntArray
    mass_values: FloatArray
    stiffness_starts: IntArray  #: linear stiffness (n, n) by rows, in blocks (2, 2) [N/m]
    stiffness_columns: IntArray
    stiffness_values: FloatArray  #: (blocks, 4): xx, xz, zx, zz
    cells: CellBlocks
    base: IntArray  #: (n_c,) supporting nodes, by rising x
    watched: IntArray  #: (n_m,) nodes whose motion is followed
    source: FloatArray  #: (n, 2) further forces on the nodes, set by the caller [N]
    #: factors L D L^T of the turned Newmark matrix, one slot for each step size
    cached_step: FloatArray  #: (slots + 1,) the step [s]; last, the slot to use next
    order: IntArray  #: (2 n,) where an unknown stands in the factors
    pattern: BlockPattern
    lower: FloatArray  #: (slots, blocks, 4) L below its diagonal
    inverse_pivot: FloatArray  #: (slots, n, 4) inverse of D [m/N]
    to_base: FloatArray  #: (slots, 2 n_c, 2 n) displacement under unit forces at the base points, turned frame [m/N]
    base_compliance: FloatArray  #: (slots, 2 n_c, 2 n_c) of the base points, turned frame [m/N]
    #: scratch
    displacement: FloatArray  #: (n, 2) [m]
    internal: FloatArray  #: (n, 2) at the last residual [N]
    turned: FloatArray  #: (2 n,) velocities in the turned frame [m/s]
    damping_force: FloatArray  #: (n, 2) at the last residual [N]
    #: (2 n,) inertia plus internal minus external forces, without the new contact forces [N]
    residual: FloatArray
    permuted: FloatArray  #: (2 n,) right-hand side and solution in the order of the factors
    free_change: FloatArray  #: (2 n,) change of the coordinates without contact force [m]
    turn: FloatArray  #: (2,) cosine and sine of the frame's rotation
    strain_energy: FloatArray  #: (1,) at the last residual [J]
    known: IntArray  #: (2,) the residual belongs to the iterate; residuals so far


@compiled(sources=SOURCES)
def fit(body: NodalBody, position: FloatArray) -> tuple[float, float, float, float]:
    """Mass centre x, z [m], cosine and sine of the mass-weighted best-fit rotation of positions (2 n,)."""
    x, z, along, across = 0.0, 0.0, 0.0, 0.0
    for i in range(body.nodal_mass.size):
        x += body.nodal_mass[i] * position[2 * i]
        z += body.nodal_mass[i] * position[2 * i + 1]
        along += body.mass_arm[i, 0] * position[2 * i] + body.mass_arm[i, 1] * position[2 * i + 1]
        across += body.mass_arm[i, 1] * position[2 * i] - body.mass_arm[i, 0] * position[2 * i + 1]
    size = math.hypot(along, across)
    return x / body.mass, z / body.mass, along / size, across / size


@compiled(sources=SOURCES)
def forces(body: NodalBody, position: FloatArray, velocity: FloatArray) -> None:
    """Internal and damping forces and the strain energy at positions and velocities (2 n,)."""
    cosine, sine = body.turn[0], body.turn[1]
    n = body.nodal_mass.size
    for i in range(n):
        body.displacement[i, 0] = position[2 * i] - body.node[i, 0]
        body.displacement[i, 1] = position[2 * i + 1] - body.node[i, 1]
    body.strain_energy[0] = element_forces(
        body.cells, body.first, body.shear, body.displacement, body.internal
    )
    for i in range(n):
        body.internal[i, 0] -= body.source[i, 0]
        body.internal[i, 1] -= body.source[i, 1]
        x, z = velocity[2 * i], velocity[2 * i + 1]
        body.turned[2 * i], body.turned[2 * i + 1] = cosine * x - sine * z, sine * x + cosine * z
    if body.damping != 0.0:
        for i in range(n):
            xx, xz, zx, zz = 0.0, 0.0, 0.0, 0.0  # four sums, so that none waits for the last term of another
            for at in range(body.stiffness_starts[i], body.stiffness_starts[i + 1]):
                j = 2 * body.stiffness_columns[at]
                along, across = body.turned[j], body.turned[j + 1]
                xx += body.stiffness_values[at, 0] * along
                xz += body.stiffness_values[at, 1] * across
                zx += body.stiffness_values[at, 2] * along
                zz += body.stiffness_values[at, 3] * across
            x, z = xx + xz, zx + zz
            body.damping_force[i, 0] = body.damping * (cosine * x + sine * z)
            body.damping_force[i, 1] = body.damping * (cosine * z - sine * x)
    body.known[1] += 1


@compiled(sources=SOURCES)
def unbalanced(body: NodalBody, scheme: Scheme, old: State, new: State) -> None:
    """Inertia plus internal minus external forces of the step, without its new contact forces."""
    now, before = 1.0 - scheme.alpha_f, scheme.alpha_f
    forces(body, new.position, new.velocity)
    share, rest = 1.0 - scheme.alpha_m, scheme.alpha_m
    mean = body.turned
    for j in range(mean.size):
        mean[j] = share * new.acceleration[j] + rest * old.acceleration[j]
    for i in range(body.nodal_mass.size):
        x, z = 0.0, 0.0
        for at in range(body.mass_starts[i], body.mass_starts[i + 1]):
            j = 2 * body.mass_columns[at]
            x += body.mass_values[at] * mean[j]
            z += body.mass_values[at] * mean[j + 1]
        weight, pull = body.nodal_mass[i] * body.gravity, body.nodal_mass[i] * body.downhill
        x += now * (body.internal[i, 0] + body.damping_force[i, 0] - pull)
        z += now * (body.internal[i, 1] + body.damping_force[i, 1] + weight)
        body.residual[2 * i] = x + before * (old.internal[2 * i] - old.external[2 * i])
        body.residual[2 * i + 1] = z + before * (old.internal[2 * i + 1] - old.external[2 * i + 1])
    body.known[0] = 1


@compiled(sources=SOURCES)
def slot_of(body: NodalBody, step: float) -> int:
    """Where the factors of this step size lie; -1: nowhere."""
    for slot in range(body.cached_step.size - 1):
        if body.cached_step[slot] == step:
            return slot
    return -1


@compiled(sources=SOURCES)
def substitute(body: NodalBody, slot: int) -> None:
    """Solve with the factors in the slot, in place of `body.permuted`."""
    substitute_blocks(body.pattern, body.lower[slot], body.inverse_pivot[slot], body.permuted)


@compiled(sources=SOURCES)
@implements(interface.prepared, NodalBody)
def prepared(body: NodalBody, step: float) -> bool:
    """The factors of this step size are at hand."""
    return slot_of(body, step) >= 0


@implements(interface.weigh, NodalBody)
def weigh(body: NodalBody, contact: Contact, old: State) -> None:
    """The stiffness of the base points does not change."""


@compiled(sources=SOURCES)
@implements(interface.predict, NodalBody)
def predict(body: NodalBody, scheme: Scheme, step: float, old: State, new: State) -> None:
    """Coordinates after `step`, for the last acceleration."""
    for j in range(old.position.size):
        new.position[j] = old.position[j] + step * (old.velocity[j] + 0.5 * step * old.acceleration[j])
        new.velocity[j] = old.velocity[j] + step * old.acceleration[j]
        new.acceleration[j] = old.acceleration[j]
    _, _, body.turn[0], body.turn[1] = fit(body, new.position)
    body.known[0] = 0


@compiled(sources=SOURCES)
@implements(interface.release, NodalBody)
def release(
    body: NodalBody, scheme: Scheme, step: float, old: State, new: State, work: Workspace, ground: Ground
) -> None:
    """Base points at the end of the step without contact force, and their compliance."""
    floor, floor_velocity, lift, lift_velocity = ground
    slot = slot_of(body, step)
    if body.known[0] == 0:
        unbalanced(body, scheme, old, new)
    cosine, sine = body.turn[0], body.turn[1]
    for i in range(body.nodal_mass.size):
        x, z = body.residual[2 * i], body.residual[2 * i + 1]
        body.permuted[body.order[2 * i]] = sine * z - cosine * x
        body.permuted[body.order[2 * i + 1]] = -sine * x - cosine * z
    substitute(body, slot)
    for i in range(body.nodal_mass.size):
        along, across = body.permuted[body.order[2 * i]], body.permuted[body.order[2 * i + 1]]
        body.free_change[2 * i] = cosine * along + sine * across
        body.free_change[2 * i + 1] = cosine * across - sine * along
    slope = scheme.newmark_gamma / (scheme.newmark_beta * step)
    for a in range(body.base.size):
        for c in range(2):
            j = 2 * body.base[a] + c
            work.free[a, c] = new.position[j] + body.free_change[j]
            work.free_velocity[a, c] = new.velocity[j] + slope * body.free_change[j]
        work.free[a, 0] -= floor
        work.free[a, 1] -= lift
        work.free_velocity[a, 0] -= floor_velocity
        work.free_velocity[a, 1] -= lift_velocity
    work.compliance[:, :] = 0.0
    add_turned(body.base_compliance[slot], cosine, sine, 1.0 - scheme.alpha_f, work.compliance)


@compiled(sources=SOURCES)
@implements(interface.respond, NodalBody)
def respond(body: NodalBody, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
    """Apply `work.force` to the iterate; returns the remaining error over its tolerance."""
    slot = slot_of(body, step)
    now = 1.0 - scheme.alpha_f
    cosine, sine = body.turn[0], body.turn[1]
    answer = body.turned
    for j in range(answer.size):
        answer[j] = 0.0
    for a in range(body.base.size):
        x, z = work.force[a, 0], work.force[a, 1]
        if x != 0.0 or z != 0.0:
            along, across = cosine * x - sine * z, sine * x + cosine * z
            for j in range(answer.size):
                answer[j] += along * body.to_base[slot, 2 * a, j] + across * body.to_base[slot, 2 * a + 1, j]
    by_velocity = scheme.newmark_gamma / (scheme.newmark_beta * step)
    by_acceleration = 1.0 / (scheme.newmark_beta * step * step)
    for i in range(body.nodal_mass.size):
        along, across = answer[2 * i], answer[2 * i + 1]
        for c in range(2):
            j = 2 * i + c
            turned = cosine * along + sine * across if c == 0 else cosine * across - sine * along
            change = body.free_change[j] + now * turned
            new.position[j] += change
            new.velocity[j] += by_velocity * change
            new.acceleration[j] += by_acceleration * change
    unbalanced(body, scheme, old, new)
    for a in range(body.base.size):  # for the measure only: what the new contact forces carry is no error
        body.residual[2 * body.base[a]] -= now * work.force[a, 0]
        body.residual[2 * body.base[a] + 1] -= now * work.force[a, 1]
    largest = 0.0
    for j in range(body.residual.size):
        if not abs(body.residual[j]) <= largest:  # so that nan is not passed over
            largest = abs(body.residual[j]) if abs(body.residual[j]) < math.inf else math.inf
    for a in range(body.base.size):
        body.residual[2 * body.base[a]] += now * work.force[a, 0]
        body.residual[2 * body.base[a] + 1] += now * work.force[a, 1]
    return largest / body.tolerance


@compiled(sources=SOURCES)
@implements(interface.complete, NodalBody)
def complete(body: NodalBody, new: State, floor: float, lift: float, lift_velocity: float) -> None:
    """Internal forces, base points, pose and energy at the converged coordinates."""
    position, velocity = new.position, new.velocity
    for i in range(body.nodal_mass.size):
        for c in range(2):
            new.damping[2 * i + c] = body.damping_force[i, c]
            new.internal[2 * i + c] = body.internal[i, c] + body.damping_force[i, c]
            new.external[2 * i + c] = 0.0
        new.internal[2 * i] -= body.nodal_mass[i] * body.downhill
        new.internal[2 * i + 1] += body.nodal_mass[i] * body.gravity
    for a in range(body.base.size):
        j = 2 * body.base[a]
        new.external[j] += new.force[a, 0]  # a node may have several points
        new.external[j + 1] += new.force[a, 1]
        new.point[a, 0], new.point[a, 1] = position[j] - floor, position[j + 1] - lift
    centre_x, centre_z, cosine, sine = fit(body, position)
    along, up, spin, twice = 0.0, 0.0, 0.0, 0.0
    for i in range(body.nodal_mass.size):
        x, z = 0.0, 0.0
        for at in range(body.mass_starts[i], body.mass_starts[i + 1]):
            j = 2 * body.mass_columns[at]
            x += body.mass_values[at] * velocity[j]
            z += body.mass_values[at] * velocity[j + 1]
        along += x
        up += z
        spin += (position[2 * i + 1] - centre_z) * x - (position[2 * i] - centre_x) * z
        twice += x * velocity[2 * i] + z * velocity[2 * i + 1]
    new.pose[ROTATION], new.pose[ANGULAR_VELOCITY] = math.atan2(sine, cosine), spin / body.inertia
    new.pose[CENTRE_X], new.pose[CENTRE_Z] = centre_x, centre_z
    new.pose[VELOCITY_X], new.pose[VELOCITY_Z] = along / body.mass, up / body.mass
    new.energy[KINETIC] = 0.5 * twice + lift_velocity * (0.5 * body.mass * lift_velocity - up)
    new.energy[STRAIN] = body.strain_energy[0]
    new.energy[POTENTIAL] = body.mass * body.gravity * (centre_z - lift)
    new.energy[POTENTIAL] -= body.mass * body.downhill * (centre_x - floor)


@compiled(sources=SOURCES)
@implements(interface.observe, NodalBody)
def observe(body: NodalBody, new: State, floor: float, lift: float) -> None:
    """Displacement and velocity of the monitored points."""
    for a in range(body.watched.size):
        i = body.watched[a]
        for c in range(2):
            new.monitor[a, c] = new.position[2 * i + c] - body.node[i, c]
            new.monitor[a, 2 + c] = new.velocity[2 * i + c]
        new.monitor[a, 0] -= floor
        new.monitor[a, 1] -= lift


@compiled(sources=SOURCES)
@implements(interface.shift_velocity, NodalBody)
def shift_velocity(body: NodalBody, state: State, frame: Frame, boxes: Boxes) -> None:
    """Subtract the velocities of a frame."""
    velocity, lift_velocity, spin = frame
    for i in range(body.nodal_mass.size):
        state.velocity[2 * i] -= velocity + spin * state.position[2 * i + 1]
        state.velocity[2 * i + 1] -= lift_velocity - spin * state.position[2 * i]


@struct
class NodalStack(NamedTuple):
    """The nodes of N boxes."""

    boxes: tuple[NodalBody, ...]
    starts: IntArray  #: (N + 1,) first coordinate of a box
    monitors: IntArray  #: (N, 2) first monitored point of a box, and the one behind its last
    energy: FloatArray  #: (N, 3) scratch


@implements(box_of, NodalStack, inline=True)
def nodal_box(stack: NodalStack, b: int) -> NodalBody:
    """One of the boxes."""
    return stack.boxes[b]


complete_nodal_stack = compiled(complete_compiled.py_func, sources=SOURCES)
advance_nodal = compiled(advance, sources=SOURCES)
enter_floor_frame_nodal = compiled(enter_floor_frame, sources=SOURCES)
