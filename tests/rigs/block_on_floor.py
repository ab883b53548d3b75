"""A homogeneous block on a moving floor, put together from the contact package alone.

No mesh and no finite elements: a fault that these tests find is in the time stepping or in the contact.
SI units; x to the right, z up, rotation > 0 toward +x.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.arrays import FloatArray
from contact.interface.equilibrium import Stance, standing
from contact.interface.laws import ELASTIC_STICK
from contact.interface.penalty import relaxation_time
from contact.interface.workspace import Contact
from contact.motion.base_motion import HarmonicMotion, NoMotion, PulseMotion
from contact.motion.kernel import PIECEWISE, FloorMotion, as_floor_motion, floor_motion
from contact.reference.rigid_block import RigidBlock
from contact.stepping.body import make_state
from contact.stepping.control import most_attempts
from contact.stepping.modal_body import ModalBody, make_modal_body, place, start
from contact.stepping.outcome import advance_compiled
from contact.stepping.scheme import Scheme, generalised_alpha
from contact.stepping.state import ROW_ROTATION, ROW_SLIP, Control, RunState, make_run, make_samples

GRAVITY = 9.81
Motion = FloorMotion | HarmonicMotion | PulseMotion | NoMotion
LOOSE = 1e30  #: a tolerance that never shortens a step


def contact_of(springs: FloatArray, *, force_scale: float, mu: float = 0.0, **named: Any) -> Contact:
    """Contact points with the plainest laws: springs (n,) [N/m], one coefficient of friction, no dashpots, no caps.

    What a test needs besides, it names.
    """
    n = springs.size
    plain: dict[str, Any] = {
        "normal_stiffness": springs,
        "tangential_stiffness": springs.copy(),
        "cap": np.full(n, math.inf),
        "mu_static": np.full(n, mu),
        "mu_kinetic": np.full(n, mu),
        "stribeck_velocity": 0.0,
        "friction": ELASTIC_STICK,
        "regularisation_velocity": 1e-3,
        "force_scale": force_scale,
        "resolution": 1e-15,
    }
    zeros = {name: np.zeros(n) for name in ("cap_growth", "relaxation_time", "weakening", "camber")}
    return Contact(**plain | zeros | named)


@dataclass(frozen=True, kw_only=True)
class Block:
    """Width a, height c and mass of a homogeneous block on two corners, and the level floor under it."""

    width: float = 1.1  #: [m]
    height: float = 4.0  #: [m]
    mass: float = 10_000.0  #: [kg]
    gravity: float = GRAVITY  #: [m/s2]
    bounce_frequency: float = 117.0  #: sqrt(k/m)/(2 pi), k of the whole base [Hz]
    damping_ratio: float = 2.0  #: c/(2 sqrt(k m)), the whole mass on one corner
    mu_static: float = 0.4
    mu_kinetic: float = 0.4
    impact_share: float = 1.0  #: of the angular momentum that an exchange of the pivot leaves

    @property
    def rigid(self) -> RigidBlock:
        """The same block as an analytic reference, at normal gravity."""
        return RigidBlock.homogeneous(width=self.width, height=self.height, gravity=GRAVITY)

    @property
    def inertia(self) -> float:
        return self.mass * (self.width**2 + self.height**2) / 12.0

    @property
    def slenderness_angle(self) -> float:
        return self.rigid.slenderness_angle

    @property
    def reference_energy(self) -> float:
        """To overturn [J]."""
        return self.mass * self.rigid.overturning_energy

    @property
    def base_stiffness(self) -> float:
        return self.mass * (2.0 * math.pi * self.bounce_frequency) ** 2

    @property
    def relaxation_time(self) -> float:
        return relaxation_time(self.damping_ratio, self.mass, self.base_stiffness)

    @property
    def point(self) -> FloatArray:
        return 0.5 * np.array([[-self.width, -self.height], [self.width, -self.height]])

    def contact(self) -> Contact:
        return contact_of(
            np.full(2, 0.5 * self.base_stiffness),
            force_scale=self.mass * GRAVITY,
            relaxation_time=np.full(2, self.relaxation_time),
            mu_static=np.full(2, self.mu_static),
            mu_kinetic=np.full(2, self.mu_kinetic),
            resolution=1e-15 * (self.width + self.height),
        )

    def standing(self) -> Stance:
        """Settled under gravity, in the middle of a floor at x = 0."""
        return standing(
            weight=self.mass * self.gravity,
            centroid=(0.0, 0.5 * self.height),
            point=self.point,
            compliance=np.zeros((4, 4)),
            normal_stiffness=self.contact().normal_stiffness,
            camber=np.zeros(2),
        )


@dataclass(frozen=True, eq=False)
class Rig:
    """A block with its run, ready to be stepped."""

    block: Block
    body: ModalBody
    run: RunState

    def advance(self, until: float) -> "Rig":
        """Step to `until` [s] or just beyond (no step is shortened for it)."""
        limit = most_attempts(self.run.problem.control, until)
        self.clock.attempt_limit = limit
        status = advance_compiled(self.body, self.run, until)
        assert status == 0, f"stopped with status {status} at {self.time} s"
        assert self.clock.steps + self.clock.rejected < limit, f"makes no progress at {self.time} s"
        assert self.time >= until, f"no room for more samples at {self.time} s"
        return self

    @property
    def clock(self) -> Any:
        return self.run.clock[0]

    @property
    def track(self) -> Any:
        return self.run.track[0]

    @property
    def joint(self) -> Any:
        return self.run.joints[0]

    @property
    def time(self) -> float:
        return float(self.clock.time)

    @property
    def times(self) -> FloatArray:
        """Of the samples [s]."""
        return self.run.buffers.history.interval * np.arange(self.clock.samples)

    @property
    def rotation(self) -> FloatArray:
        return self.run.buffers.history.columns[: self.clock.samples, ROW_ROTATION]

    @property
    def slip(self) -> FloatArray:
        return self.run.buffers.history.columns[: self.clock.samples, ROW_SLIP]

    @property
    def force(self) -> FloatArray:
        """Contact forces at the samples, shape (n_samples, 2, 2) [N]."""
        return self.run.buffers.history.force[: self.clock.samples]


def rig(
    block: Block,
    *,
    motion: Motion = NoMotion(),  # noqa: B008 - frozen
    vertical: Motion = NoMotion(),  # noqa: B008
    stance: Stance | None = None,
    scheme: Scheme = generalised_alpha(0.5),  # noqa: B008 - a tuple
    largest_step: float = 5e-3,
    fixed_step: bool = False,
    energy_scale: float = 1.0,
    sampled: float = 5e-3,
    breaks: FloatArray | None = None,
    shape: FloatArray | None = None,
    frequencies: FloatArray | None = None,
    damping_ratios: FloatArray | None = None,
    amplitudes: FloatArray | float = 0.0,
    rates: FloatArray | float = 0.0,
) -> Rig:
    """Put a block on its floor at t = 0, where it moves with the floor along x and upward; settled, if not in a stance.

    With `fixed_step` every step has the largest size [s], whatever its energy error, whose tolerances `energy_scale`
    multiplies. The history has room for 8000 samples, one every `sampled` [s]. A step must end at `breaks` [s].
    Elastic modes as in `make_modal_body`, with initial amplitudes and rates (m,).
    """
    body = make_modal_body(
        mass=block.mass,
        inertia=block.inertia,
        gravity=block.gravity,
        point=block.point,
        rest=(0.0, 0.5 * block.height),
        shape=shape,
        frequencies=frequencies,
        damping_ratios=damping_ratios,
        tolerance=1e-6 * GRAVITY / (2.0 * math.pi * block.bounce_frequency) ** 2,
    )
    along, upward = (one if isinstance(one, FloorMotion) else one.compiled() for one in (motion, vertical))
    (x, velocity_x, _), (z, velocity_z, _) = floor_motion(along, 0.0), floor_motion(upward, 0.0)
    contact = block.contact()
    old = make_state(3 + body.stiffness.size, 2, 0)
    stance = (block.standing() if stance is None else stance).moved(x, z).moving(velocity_x, velocity_z)
    old.force[:] = stance.force
    old.stick[:] = -stance.force[:, 0] / contact.tangential_stiffness
    place(body, old, stance)
    old.position[3:] += amplitudes
    old.velocity[3:] = rates
    start(body, old, x, z, velocity_z)
    run = make_run(
        scheme=scheme,
        contact=contact,
        motion=along,
        vertical=upward,
        breaks=np.zeros(0) if breaks is None else breaks,
        control=limits_of(block, largest_step, fixed_step, energy_scale),
        old=old,
        history=make_samples(sampled, 8000, 2, columns=True),
        frames=make_samples(math.inf, 4, 2),
    )
    run.joints["impact_share"] = block.impact_share
    return Rig(block, body, run)


def piecewise_motion(knots: list[float], accelerations: list[float], *, velocity: float = 0.0) -> FloorMotion:
    """A floor of constant accelerations [m/s2], each from its knot [s] on; before the first it moves evenly [m/s]."""
    displacement, rows = 0.0, [[0.0, velocity, 0.0, 0.0]]
    for s, acceleration in zip(np.diff(knots, append=knots[-1:]), accelerations, strict=True):
        rows.append([displacement, velocity, acceleration, 0.0])
        displacement += s * (velocity + 0.5 * s * acceleration)
        velocity += s * acceleration
    return as_floor_motion(PIECEWISE, breaks=np.array(knots), coefficients=np.array(rows))


def limits_of(block: Block, largest_step: float, fixed_step: bool, energy_scale: float) -> Control:
    """The limits that a case gets by default; or none, for steps of one size."""
    rigid, reference = block.rigid, block.reference_energy
    scale = LOOSE if fixed_step else energy_scale
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
        energy_rate=scale * 1e-5 * rigid.frequency_parameter,
        energy_floor=scale * 2e-7,
        energy_share=scale * 4e-3,
        recent_share=scale * 2e-2,
        recent_time=0.1 / rigid.frequency_parameter,
        closing_share=scale * 2e-3 * max(1.0 - rigid.housner_restitution**2, 0.02),
        mass=block.mass,
        inertia=block.inertia,
        gravity=GRAVITY,
        downhill=0.0,
        force_window=0.01 / rigid.frequency_parameter,
        frequency_parameter=rigid.frequency_parameter,
        resting_energy=block.mass * block.gravity * 0.5 * block.height,
        slowest_rocking=rigid.frequency_parameter,
        slenderness_angle=rigid.slenderness_angle,
        width=block.width,
        near=0.25 * block.width,
        stop_when_overturned=True,
        contents_cutoff=200.0,
        top_monitors=0,
        base_points=2,
        rolls=False,
        eager=False,
    )
