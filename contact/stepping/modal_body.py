"""A body in a floating frame: three rigid coordinates and elastic modes; with no mode, the rigid body.

Coordinates: mass centre x, z [m], rotation [rad, > 0 toward +x] and modal amplitudes q [m sqrt(kg)]. A point
at X in the undeformed body, relative to the mass centre, is at c + R (X + Phi q), R = [[cos, sin], [-sin, cos]].
The frame is the mean-axis (Tisserand) one: the modes are mass-normalised and orthogonal to the rigid
motions, so the mass matrix is diag(m, m, I, 1, ..). Terms of the order (rotation rate / omega_1)^2 - centrifugal
stretching, change of inertia with q - are dropped. Shabana, Dynamics of Multibody Systems, ch. 5;
Canavin and Likins, J. Spacecraft 14 (1977) 724.

`contact.stepping.modal_kernels` steps it.
"""

from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
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
    """Make a body; without modes it is rigid.

    Args:
        mass: [kg]; inertia: about the mass centre [kg m2].
        gravity: toward the floor; downhill: along a floor that falls toward +x [m/s2].
        point: (n, 2) base points relative to the mass centre [m], sorted by x.
        rest: mass centre of the undeformed container standing on the floor [m].
        shape: (n, 2, m) mass-normalised mode shapes; frequencies: (m,) angular [rad/s]; damping_ratios: (m,) [-].
        monitor: (k, 2) points whose motion is followed; monitor_shape: (k, 2, m).
        tolerance: error of a base point at which the iterations of a step stop [m].
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
    """A rigid body on two contact points, stepped in registers: see `contact.stepping.block_on_corners`."""


class LocalBlock(BlockOnCorners):
    """A rigid body on two contact points whose arrays are in registers, see `contact.stepping.block_on_corners`."""


MODAL = (ModalBody, BlockOnCorners, LocalBlock)


#: fields of a `ModalBody` that are written in a step
SCRATCH = ("cached_step", "recent", "inverse", "elastic_compliance", "arm", "moved", "free_change")


def own_scratch(body: ModalBody) -> ModalBody:
    """The same body, or boxes of a stack, with scratch arrays of its own."""
    own = body._replace(**{name: np.empty_like(getattr(body, name)) for name in SCRATCH})
    own.cached_step[:], own.recent[:] = -1.0, 0
    own.cached_step[..., -1] = 0.0
    return own


def with_own_scratch(body: ModalBody) -> ModalBody:
    """The same body with scratch arrays of its own; a rigid body on two points becomes a `BlockOnCorners`."""
    if body.stiffness.size == 0 and body.point.shape[0] == 2:  # the rest of its scratch is in registers
        return BlockOnCorners(*body._replace(arm=np.empty_like(body.arm)))
    return own_scratch(body)
