"""A homogeneous block on a moving floor, put together from the contact package alone.

No mesh and no finite elements: what these tests find wrong is wrong in the time stepping or in the contact.
SI units; x to the right, z up, rotation > 0 toward +x.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.interface.equilibrium import Stance, standing
from contact.interface.laws import ELASTIC_STICK
from contact.interface.solver import Contact, make_workspace
from contact.motion.base_motion import HarmonicMotion, PulseMotion
from contact.motion.kernel import PIECEWISE, UNIFORM, FloatArray, FloorMotion, as_floor_motion, floor_motion
from contact.stepping.body import make_state
from contact.stepping.control import most_attempts
from contact.stepping.integrator import advance_compiled
from contact.stepping.modal_body import ModalBody, make_modal_body
from contact.stepping.modal_kernels import place, start
from contact.stepping.scheme import Scheme, generalised_alpha
from contact.stepping.state import ROW_ROTATION, ROW_SLIP, Control, RunState, make_run, make_samples

GRAVITY = 9.81
LOOSE = 1e30  #: a tolerance that never cuts a step


@dataclass(frozen=True, kw_only=True)
class Block:
    """Width a, height c and mass of a homogeneous block on two corners, and the floor under it."""

    width: float = 1.1  #: [m]
    height: float = 4.0  #: [m]
    mass: float = 10_000.0  #: [kg]
    gravity: float = GRAVITY  #: [m/s2]
    bounce_frequency: float = 117.0  #: sqrt(k/m)/(2 pi), k of the whole base [Hz]
    damping_ratio: float = 2.0  #: c/(2 sqrt(k m)), the whole mass on one corner
    mu_static: float = 0.4
    mu_kinetic: float = 0.4
    tangential_ratio: float = 1.0
    friction: int = ELASTIC_STICK
    regularisation_velocity: float = 1e-3  #: [m/s]
    weakening: float = 0.0  #: [m]

    @property
    def inertia(self) -> float:
        return self.mass * (self.width**2 + self.height**2) / 12.0

    @property
    def radius(self) -> float:
        return 0.5 * math.hypot(self.width, self.height)

    @property
    def slenderness_angle(self) -> float:
        return math.atan2(self.width, self.height)

    @property
    def frequency_parameter(self) -> float:
        return math.sqrt(0.75 * self.gravity / self.radius)

    @property
    def base_stiffness(self) -> float:
        return self.mass * (2.0 * math.pi * self.bounce_frequency) ** 2

    @property
    def relaxation_time(self) -> float:
        return 2.0 * self.damping_ratio * math.sqrt(self.mass / (0.5 * self.base_stiffness))

    @property
    def reference_energy(self) -> float:
        return self.mass * self.gravity * self.radius * (1.0 - math.cos(self.slenderness_angle))

    @property
    def point(self) -> FloatArray:
        return 0.5 * np.array([[-self.width, -self.height], [self.width, -self.height]])

    @property
    def centroid(self) -> tuple[float, float]:
        return 0.0, 0.5 * self.height

    def contact(self) -> Contact:
        springs = np.full(2, 0.5 * self.base_stiffness)
        return Contact(
            normal_stiffness=springs,
            tangential_stiffness=self.tangential_ratio * springs,
            relaxation_time=self.relaxation_time,
            mu_static=self.mu_static,
            mu_kinetic=self.mu_kinetic,
            weakening=self.weakening,
            friction=self.friction,
            regularisation_velocity=self.regularisation_velocity,
            force_scale=self.mass * GRAVITY,
            resolution=1e-15 * (self.width + self.height),
        )

    def standing(self) -> Stance:
        """Settled under gravity, in the middle of a floor at x = 0."""
        return standing(
            weight=self.mass * self.gravity,
            centroid=self.centroid,
            point=self.point,
            compliance=np.zeros((4, 4)),
            normal_stiffness=self.contact().normal_stiffness,
        )


@dataclass(frozen=True, eq=False)
class Rig:
    """A block with its run, ready to be stepped."""

    block: Block
    body: ModalBody
    run: RunState

    def advance(self, until: float) -> "Rig":
        """Step to `until` [s] or, as no step is cut for it, just beyond."""
        limit = most_attempts(self.run.control, until)
        self.clock.attempt_limit = limit
        status = advance_compiled(self.body, self.run, until)
        assert status == 0, f"stopped with status {status} at {self.time} s"
        assert self.clock.steps + self.clock.rejected < limit, f"makes no headway at {self.time} s"
        assert self.time >= until, f"no room for more samples at {self.time} s"
        return self

    @property
    def clock(self) -> Any:
        return self.run.clock[0]

    @property
    def track(self) -> Any:
        return self.run.track[0]

    @property
    def time(self) -> float:
        return float(self.clock.time)

    @property
    def times(self) -> FloatArray:
        """Of the samples [s]."""
        return self.run.history.interval * np.arange(self.clock.samples)

    @property
    def rotation(self) -> FloatArray:
        return self.run.history.columns[: self.clock.samples, ROW_ROTATION]

    @property
    def slip(self) -> FloatArray:
        return self.run.history.columns[: self.clock.samples, ROW_SLIP]

    @property
    def force(self) -> FloatArray:
        """Contact forces at the samples, shape (n_samples, 2, 2) [N]."""
        return self.run.history.force[: self.clock.samples]

    @property
    def slip_velocity(self) -> float:
        """Of the mass centre against the floor, now [m/s]."""
        return float(self.run.old.velocity[0] - floor_motion(self.run.motion, self.time)[1])


def rig(
    block: Block,
    *,
    motion: FloorMotion | HarmonicMotion | PulseMotion | None = None,
    stance: Stance | None = None,
    start_moving: bool = True,
    scheme: Scheme | None = None,
    largest_step: float = 5e-3,
    fixed_step: bool = False,
    energy_scale: float = 1.0,
    sampled: float = 5e-3,
    samples: int = 4100,
    breaks: FloatArray | None = None,
    shape: FloatArray | None = None,
    frequencies: FloatArray | None = None,
    damping_ratios: FloatArray | None = None,
    amplitudes: FloatArray | None = None,
    rates: FloatArray | None = None,
) -> Rig:
    """Put a block on its floor at t = 0.

    Args:
        block: with its floor.
        motion: of the floor; None: it rests.
        stance: the initial one; None: settled.
        start_moving: the block moves with the floor at first.
        scheme: None: generalised-alpha, spectral radius 0.5.
        largest_step: [s]; fixed_step: every step is this one, whatever the ledger says.
        energy_scale: of the ledger's tolerances.
        sampled: interval of the history [s]; samples: room for so many.
        breaks: instants at which a step must end [s].
        shape, frequencies, damping_ratios: of elastic modes, see `make_modal_body`.
        amplitudes, rates: (m,) initial modal amplitudes and their rates.
    """
    point = block.point
    body = make_modal_body(
        mass=block.mass,
        inertia=block.inertia,
        gravity=block.gravity,
        point=point,
        rest=block.centroid,
        shape=shape,
        frequencies=frequencies,
        damping_ratios=damping_ratios,
        tolerance=1e-6 * GRAVITY / (2.0 * math.pi * block.bounce_frequency) ** 2,
    )
    compiled_motion = as_motion(motion)
    floor, floor_velocity, _ = floor_motion(compiled_motion, 0.0)
    contact = block.contact()
    old, new = (make_state(3 + body.stiffness.size, 2, 0) for _ in range(2))
    stance = (block.standing() if stance is None else stance).moved(floor)
    old.force[:] = stance.force
    old.stick[:] = -stance.force[:, 0] / contact.tangential_stiffness
    place(body, old, stance, floor_velocity if start_moving else 0.0)
    if amplitudes is not None:
        old.position[3:] = amplitudes
    if rates is not None:
        old.velocity[3:] = rates
    start(body, old, floor)
    run = make_run(
        scheme=generalised_alpha(0.5) if scheme is None else scheme,
        contact=contact,
        motion=compiled_motion,
        breaks=np.zeros(0) if breaks is None else breaks,
        control=_control(block, largest_step, fixed_step, energy_scale),
        old=old,
        new=new,
        work=make_workspace(2),
        history=make_samples(sampled, samples, 2, columns=True),
        frames=make_samples(math.inf, 4, 2),
    )
    return Rig(block, body, run)


def as_motion(motion: FloorMotion | HarmonicMotion | PulseMotion | None) -> FloorMotion:
    if motion is None:
        return as_floor_motion(UNIFORM, (0.0, 0.0, 0.0))
    return motion if isinstance(motion, FloorMotion) else motion.compiled()


def piecewise_motion(
    knots: list[float], accelerations: list[float], velocity: float = 0.0, displacement: float = 0.0
) -> FloorMotion:
    """A floor of constant accelerations [m/s2], each from its knot [s] on; before the first it coasts.

    `velocity` [m/s] and `displacement` [m] are those at the first knot.
    """
    rows = [[displacement, velocity, 0.0, 0.0]]
    for i, acceleration in enumerate(accelerations):
        rows.append([displacement, velocity, acceleration, 0.0])
        if i + 1 < len(knots):
            s = knots[i + 1] - knots[i]
            displacement += s * (velocity + 0.5 * s * acceleration)
            velocity += s * acceleration
    return FloorMotion(PIECEWISE, np.zeros(0), np.array(knots, dtype=float), np.array(rows))


def _control(block: Block, largest_step: float, fixed_step: bool, energy_scale: float) -> Control:
    """The limits that a case gets by default; or none, for steps of one size."""
    rate = math.sqrt(0.75 * GRAVITY / block.radius)
    reference = block.mass * GRAVITY * block.radius * (1.0 - math.cos(block.slenderness_angle))
    scale = LOOSE if fixed_step else energy_scale
    restitution = 1.0 - 1.5 * math.sin(block.slenderness_angle) ** 2
    spring, half = 0.5 * block.base_stiffness, 0.5 * block.width
    struck = 1.0 / (1.0 / block.mass + half * half / block.inertia)
    closing_step = 0.02 / (
        spring * block.relaxation_time / struck + 0.2 * math.sqrt(2.0 * spring / block.mass)
    )
    return Control(
        largest_step=largest_step,
        smallest_step=1e-7 * largest_step,
        event_step=largest_step if fixed_step else 0.05 * largest_step,
        closing_step=largest_step if fixed_step else closing_step,
        closing_speed=math.sqrt(1e-6 * reference / block.mass),
        reference_energy=reference,
        energy_rate=scale * 1e-5 * rate,
        energy_floor=scale * 2e-7,
        energy_share=scale * 4e-3,
        recent_share=scale * 2e-2,
        recent_time=0.1 / rate,
        closing_share=scale * 2e-3 * max(1.0 - restitution**2, 0.02),
        mass=block.mass,
        gravity=GRAVITY,
        frequency_parameter=rate,
        resting_energy=block.mass * block.gravity * 0.5 * block.height,
        slenderness_angle=block.slenderness_angle,
        width=block.width,
        stop_when_overturned=True,
        top_monitors=0,
        base_points=2,
    )
