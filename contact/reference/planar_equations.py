"""Equations of a rigid block in the plane that may slide on its base or on one corner while it rocks.

Frame of the floor; all forces per unit mass of the block. The state is (slip, slip velocity, tilt, tilt
rate): `slip` is the sliding of the supporting corner over the floor, positive along +x; `tilt` >= 0 is the
angle from the base about the corner on `side` (+1 right, -1 left), so that rotation = side x tilt. Friction
is positive where it pushes the block toward +x; a slide's direction is the sign of the slip velocity.
A floor that moves up and down changes gravity in its frame to g + a_v.
Shenton and Jones, Base excitation of rigid bodies I: formulation, J. Engng Mech. ASCE 117 (1991).
"""

import math
from dataclasses import dataclass

import numpy as np

from contact.arrays import FloatArray
from contact.reference.floor_acceleration import Acceleration
from contact.reference.rigid_block import RigidBlock


@dataclass(frozen=True, kw_only=True)
class CornerContact:
    """Accelerations and floor reactions of a block on one corner, per unit mass."""

    tilt_acceleration: float  #: [rad/s2]
    slip_acceleration: float  #: [m/s2]
    normal: float  #: compression positive; negative: the block would leave the floor [m/s2]
    friction: float  #: on the block, along +x [m/s2]


def centroidal_ratio(block: RigidBlock) -> float:
    """M/I_G, mass over inertia about the centroid [1/m2]."""
    return 1.0 / ((block.inertia_ratio - 1.0) * block.radius**2)


def rock(block: RigidBlock, side: int, tilt: float, tilt_rate: float, floor: Acceleration) -> CornerContact:
    """The corner does not slide; friction follows from the equations of motion.

    Shenton and Jones (1991), rock mode; equals the rocking equation of `contact.reference.rocking`.
    """
    lean = block.slenderness_angle - tilt
    radius, gravity = block.radius, block.gravity + floor.z
    pull = gravity * math.sin(lean) + side * floor.x * math.cos(lean)
    acceleration = -pull / (block.inertia_ratio * radius)
    return CornerContact(
        tilt_acceleration=acceleration,
        slip_acceleration=0.0,
        normal=gravity + radius * (math.sin(lean) * acceleration - math.cos(lean) * tilt_rate**2),
        friction=floor.x + side * radius * (math.cos(lean) * acceleration + math.sin(lean) * tilt_rate**2),
    )


def slide_rock(
    block: RigidBlock,
    side: int,
    tilt: float,
    tilt_rate: float,
    floor: Acceleration,
    *,
    mu_kinetic: float,
    direction: int,
) -> CornerContact:
    """The corner slides toward `direction`: friction is -mu_k x normal x direction.

    Shenton and Jones (1991), slide-rock mode. Eliminating the normal force leaves a factor
    1 + (M R^2/I_G) sin(lean) (sin(lean) - side direction mu_k cos(lean)); where it is not positive
    (homogeneous: only for mu_k > 4/3) the equations have no unique solution (Painleve): normal is nan.
    """
    lean = block.slenderness_angle - tilt
    sine, cosine = math.sin(lean), math.cos(lean)
    radius, gravity = block.radius, block.gravity + floor.z
    arm = sine - side * direction * mu_kinetic * cosine  # of the reaction about the centroid, over R
    factor = 1.0 + arm * sine / (block.inertia_ratio - 1.0)
    normal = (gravity - radius * cosine * tilt_rate**2) / factor if factor > 0.0 else math.nan
    acceleration = -radius * arm * normal * centroidal_ratio(block)
    friction = -direction * mu_kinetic * normal
    slip_acceleration = friction - floor.x - side * radius * (cosine * acceleration + sine * tilt_rate**2)
    return CornerContact(
        tilt_acceleration=acceleration,
        slip_acceleration=slip_acceleration,
        normal=normal,
        friction=friction,
    )


@dataclass(frozen=True, kw_only=True)
class CornerImpact:
    """Velocities after, and impulses during, an impact of the opposite corner, per unit mass."""

    slip_velocity: float  #: after [m/s]
    tilt_rate: float  #: after, about the new corner; 0: the base lies on the floor [rad/s]
    normal_impulse: float  #: compression positive [m/s]
    friction_impulse: float  #: on the block along +x [m/s]
    slides: bool  #: the impulse of friction stood at its limit


def corner_impact(
    block: RigidBlock,
    side: int,
    slip_velocity: float,
    tilt_rate: float,
    *,
    mu_static: float,
    mu_kinetic: float,
) -> CornerImpact | None:
    """The block turned about the corner on `side` (tilt rate < 0) and its other corner meets the floor.

    Plastic in the normal direction, with Coulomb's law for the impulses (Shenton and Jones 1991). The
    impulse acts at the new corner and brings it to rest if the friction impulse this takes is within mu
    times the normal one: mu_static if the block did not slide before, mu_kinetic if it did. Else friction
    is mu_kinetic times the normal impulse, against the sliding after the impact; so no impact gains energy.
    If the old corner would then move into the floor, both corners take impulses and the block comes to rest
    on its base. None: no consistent impulses exist and the motion is outside the model.
    """
    height, half_width = block.centroid_height, block.half_width
    ratio = centroidal_ratio(block)
    # inverse effective mass of the new corner
    new = -side
    tangential = 1.0 + ratio * height**2
    coupling = new * ratio * height * half_width
    normal = 1.0 + ratio * half_width**2
    approach = 2.0 * half_width * tilt_rate  # normal velocity of the new corner, negative
    spin = side * tilt_rate

    def after(friction_impulse: float, normal_impulse: float, slides: bool) -> CornerImpact:
        turned = spin - ratio * (height * friction_impulse + new * half_width * normal_impulse)
        slipped = slip_velocity + tangential * friction_impulse + coupling * normal_impulse
        return CornerImpact(
            slip_velocity=slipped if slides else 0.0,
            tilt_rate=new * turned,
            normal_impulse=normal_impulse,
            friction_impulse=friction_impulse,
            slides=slides,
        )

    determinant = tangential * normal - coupling**2
    sticking_friction = (-normal * slip_velocity + coupling * approach) / determinant
    sticking_normal = (-tangential * approach + coupling * slip_velocity) / determinant
    limit = mu_static if slip_velocity == 0.0 else mu_kinetic
    candidates = []
    if sticking_normal > 0.0 and abs(sticking_friction) <= limit * sticking_normal:
        candidates.append(after(sticking_friction, sticking_normal, False))
    else:
        first = 1 if slip_velocity >= 0.0 else -1
        for direction in (first, -first):
            effective = normal - direction * mu_kinetic * coupling
            if effective <= 0.0:
                continue
            normal_impulse = -approach / effective
            outcome = after(-direction * mu_kinetic * normal_impulse, normal_impulse, True)
            if direction * outcome.slip_velocity >= 0.0:
                candidates.append(outcome)
    for outcome in candidates:
        if outcome.tilt_rate >= 0.0:
            return outcome
    return _lying_down(block, side, slip_velocity, tilt_rate, limit=limit, mu_kinetic=mu_kinetic)


def _lying_down(
    block: RigidBlock, side: int, slip_velocity: float, tilt_rate: float, *, limit: float, mu_kinetic: float
) -> CornerImpact | None:
    """Impulses at both corners that end the rotation; None if one of them would have to pull."""
    height, half_width = block.centroid_height, block.half_width
    horizontal = slip_velocity + side * height * tilt_rate  # of the centroid, before
    normal_impulse = -half_width * tilt_rate
    sticks = abs(horizontal) <= limit * normal_impulse
    friction_impulse = -horizontal if sticks else -math.copysign(mu_kinetic * normal_impulse, horizontal)
    # moment about the centroid: height x friction + half width x (right - left) takes up the spin
    spin = side * tilt_rate
    difference = (spin / centroidal_ratio(block) - height * friction_impulse) / half_width
    if abs(difference) > normal_impulse:
        return None
    return CornerImpact(
        slip_velocity=0.0 if sticks else horizontal + friction_impulse,
        tilt_rate=0.0,
        normal_impulse=normal_impulse,
        friction_impulse=friction_impulse,
        slides=not sticks,
    )


def energy(block: RigidBlock, side: int, state: FloatArray) -> float:
    """Kinetic energy relative to the floor plus potential energy above rest, per mass [J/kg]."""
    _, slip_velocity, tilt, tilt_rate = (float(value) for value in np.asarray(state))
    lean = block.slenderness_angle - tilt
    horizontal = slip_velocity + side * block.radius * math.cos(lean) * tilt_rate
    vertical = block.radius * math.sin(lean) * tilt_rate
    kinetic = 0.5 * (horizontal**2 + vertical**2 + tilt_rate**2 / centroidal_ratio(block))
    return kinetic + block.gravity * (block.radius * math.cos(lean) - block.centroid_height)
