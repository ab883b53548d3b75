"""Homogeneous boxes on one another and on a moving floor, put together from the contact package alone."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from block_on_floor import GRAVITY, Block, Motion, contact_of, limits_of

from contact.arrays import FloatArray
from contact.interface.faces import points_of_joint
from contact.motion.base_motion import NoMotion
from contact.motion.kernel import FloorMotion, floor_motion
from contact.stepping.body import make_state
from contact.stepping.control import most_attempts
from contact.stepping.loose_stack import LooseStack, make_stack, settle_stack
from contact.stepping.modal_body import make_modal_body
from contact.stepping.outcome import advance_compiled
from contact.stepping.scheme import generalised_alpha
from contact.stepping.state import ROW_COLUMNS, RunState, make_joints, make_run, make_samples


@dataclass(frozen=True, kw_only=True)
class Box:
    """One of the boxes."""

    width: float = 1.1  #: [m]
    height: float = 1.0  #: [m]
    mass: float = 2500.0  #: [kg]
    offset: float = 0.0  #: from the axis of the box below [m]


@dataclass(frozen=True, eq=False)
class StackRig:
    """A loose stack with its run, ready to be stepped."""

    stack: LooseStack
    run: RunState
    whole: Block  #: all boxes as one

    def advance(self, until: float) -> int:
        """Step to `until` [s] or just beyond, or to a fall; returns the status."""
        self.run.clock[0].attempt_limit = most_attempts(self.run.problem.control, until)
        return advance_compiled(self.stack, self.run, until)

    @property
    def joints(self) -> Any:
        return self.run.joints

    @property
    def columns(self) -> FloatArray:
        """Samples so far."""
        return self.run.buffers.history.columns[: self.run.clock[0].samples]

    def box(self, k: int, column: int) -> FloatArray:
        """A column of box k >= 1."""
        return self.columns[:, ROW_COLUMNS + 5 * (k - 1) + column]


def stack_rig(
    boxes: Sequence[Box],
    *,
    motion: Motion = NoMotion(),  # noqa: B008 - frozen
    mu: float = 0.4,
    joint_mu: float | None = None,
    sampled: float = 5e-3,
    elastic: tuple[FloatArray, FloatArray, float] | None = None,
) -> StackRig:
    """Put boxes on one another, from the floor up, and on a floor, settled; the floor's laws hold in the joints.

    `elastic`: mode shapes (4, 2, m), frequencies (m,) [rad/s] and damping ratio of every box.
    """
    n, points = len(boxes), 4 * len(boxes) - 2
    mass, height = sum(box.mass for box in boxes), sum(box.height for box in boxes)
    whole = Block(width=boxes[0].width, height=height, mass=mass, mu_static=mu, mu_kinetic=mu)
    springs = np.full(points, 0.5 * whole.base_stiffness)
    bodies, x, z = [], 0.0, 0.0
    for box in boxes:
        x += box.offset
        half_x, half_z = 0.5 * box.width, 0.5 * box.height
        shape, frequencies, ratio = (None, None, 0.0) if elastic is None else elastic
        bodies.append(
            make_modal_body(
                mass=box.mass,
                inertia=box.mass * (box.width**2 + box.height**2) / 12.0,
                gravity=GRAVITY,
                point=np.array([[-half_x, -half_z], [half_x, -half_z], [-half_x, half_z], [half_x, half_z]]),
                rest=(x, z + half_z),
                shape=shape,
                frequencies=frequencies,
                damping_ratios=None if frequencies is None else np.full(len(frequencies), ratio),
                tolerance=1e-6 * GRAVITY / (2.0 * math.pi * whole.bounce_frequency) ** 2,
            )
        )
        z += box.height
    stack = make_stack(bodies, springs, springs)
    along = motion if isinstance(motion, FloorMotion) else motion.compiled()
    place, velocity, _ = floor_motion(along, 0.0)
    old = make_state(n * (3 + stack.body.modes), points, 0, n)
    mus = np.full(points, mu)
    mus[2:] = mu if joint_mu is None else joint_mu
    contact = contact_of(
        springs.copy(),
        force_scale=mass * GRAVITY,
        relaxation_time=np.full(points, whole.relaxation_time),
        mu_static=mus,
        mu_kinetic=mus.copy(),
        resolution=1e-15 * (whole.width + height),
    )
    settle_stack(stack, contact, old, gravity=GRAVITY, place=(place, 0.0), velocity=(velocity, 0.0))
    run = make_run(
        scheme=generalised_alpha(0.5),
        contact=contact,
        motion=along,
        breaks=np.zeros(0),
        control=limits_of(whole, 5e-3, False, 1.0),
        old=old,
        history=make_samples(sampled, 8000, points, columns=True, boxes=n),
        frames=make_samples(math.inf, 4, points),
        joints=make_joints(
            [box.mass for box in boxes],
            [body.inertia for body in bodies],
            [box.width for box in boxes],
            whole.slenderness_angle,
        ),
    )
    return StackRig(stack, run, whole)


def joint_force(rig: StackRig, joint: int) -> FloatArray:
    """Tangential and normal force of a joint now [N]."""
    return rig.run.old.force[points_of_joint(joint)].sum(axis=0)
