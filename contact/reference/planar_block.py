"""The rigid block that rests, slides, rocks or slide-rocks: the reference for the regime of motion.

Event-driven: in each state the equations are integrated to 1e-12 until the contact changes (slip begins or ends, a
corner meets the floor, the base lifts). The frame is that of the floor: one that moves up and down changes gravity to
g + a_v. All forces are per unit mass. Free flight is detected and reported, but not integrated.

The state is (slip, slip velocity, tilt, tilt rate): `slip` is the sliding of the supporting corner over the floor,
positive along +x, so that rocking alone does not slip; `tilt` >= 0 is the angle from the base about the corner on
`side` (+1 right, -1 left), so that rotation = side x tilt, positive toward +x. Friction is positive where it pushes the
block toward +x; a slide's direction is the sign of the slip velocity.

Shenton and Jones, J. Engng Mech. ASCE 117 (1991), parts I and II; Shenton, Criteria for initiation of slide,
rock, and slide-rock rigid-body modes, ibid. 122 (1996).
"""

import math
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray
from contact.reference.event_driven import (
    MAX_EVENTS,
    REST_ENERGY,
    EventError,
    Guard,
    Piece,
    flow,
    sample,
    turning_point,
)
from contact.reference.floor_acceleration import Acceleration, FloorAcceleration
from contact.reference.rigid_block import RigidBlock


class PlanarMode(Enum):
    """Mode of a planar block at an instant, or the reason for which the integration ends."""

    REST, SLIDE, ROCK, SLIDE_ROCK = "rest", "slide", "rock", "slide-rock"
    OVERTURNED = "overturned"
    OUTSIDE = "outside the model"  #: it left the floor, or contact forces are not unique


@dataclass(frozen=True, kw_only=True)
class PlanarState:
    """A mode with its corner and direction of sliding."""

    mode: PlanarMode
    side: int = 0  #: +1 right corner, -1 left, 0 the base lies on the floor
    direction: int = 0  #: sign of the slip velocity; 0: sticks


@dataclass(frozen=True, kw_only=True)
class PlanarImpact:
    """A corner meets the floor and becomes the pivot; velocities after it are zero where the block comes to rest."""

    time: float  #: [s]
    velocity_before: float  #: angular velocity, positive toward +x [rad/s]
    velocity_after: float  #: [rad/s]
    slip_velocity_before: float = 0.0  #: [m/s]
    slides: bool = False  #: the friction impulse stood at its limit


@dataclass(frozen=True, kw_only=True)
class PlanarMotion:
    """Motion of a planar block."""

    states: tuple[PlanarState, ...]  #: entered one after the other; numbered by the regimes of the pieces
    impacts: tuple[PlanarImpact, ...]
    end: float  #: duration asked for, or when it overturned or left the model [s]
    largest_rotation: float  #: largest |rotation| [rad]
    pieces: tuple[Piece, ...]

    @property
    def modes(self) -> frozenset[PlanarMode]:
        """Every mode seen."""
        return frozenset(state.mode for state in self.states)

    @property
    def outcome(self) -> PlanarMode:
        """Overturned or outside the model if it ended so, else the most general mode."""
        last = self.states[-1].mode
        if last in (PlanarMode.OVERTURNED, PlanarMode.OUTSIDE):
            return last
        if PlanarMode.SLIDE_ROCK in self.modes or {PlanarMode.SLIDE, PlanarMode.ROCK} <= self.modes:
            return PlanarMode.SLIDE_ROCK
        return next((m for m in (PlanarMode.SLIDE, PlanarMode.ROCK) if m in self.modes), PlanarMode.REST)

    def at(self, times: FloatArray) -> "PlanarHistory":
        """The motion at given times, nan after the end."""
        values, regimes = sample(self.pieces, np.asarray(times, dtype=float), 4)
        sides = np.array([*(state.side for state in self.states), 0])[regimes]
        return PlanarHistory(
            rotation=sides * values[:, 2],
            angular_velocity=sides * values[:, 3],
            slip=values[:, 0],
        )


class PlanarHistory(NamedTuple):
    """Samples of a planar motion; every array has the shape of the times asked for."""

    rotation: FloatArray  #: [rad]
    angular_velocity: FloatArray  #: [rad/s]
    slip: FloatArray  #: [m]


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


@dataclass(frozen=True, kw_only=True)
class PlanarBlock:
    """A rigid block with Coulomb friction under its corners; ValueError: a coefficient out of range."""

    body: RigidBlock
    mu_static: float  #: [-]
    mu_kinetic: float  #: [-]

    def __post_init__(self) -> None:
        for name, value in (("mu_static", self.mu_static), ("mu_kinetic", self.mu_kinetic)):
            if not 0.0 <= value < math.inf:
                raise ValueError(f"{name} must be finite and not negative, got {value}")
        if self.mu_kinetic > self.mu_static:
            raise ValueError(
                f"mu_kinetic must not exceed mu_static, got {self.mu_kinetic} > {self.mu_static}; "
                "otherwise a body could neither stick nor slide"
            )

    @property
    def slides_flat(self) -> bool:
        """Whether it can slide with its whole base on the floor: mu_k H <= B."""
        return self.mu_kinetic * self.body.centroid_height <= self.body.half_width

    def select(self, values: FloatArray, side: int, acceleration: Acceleration) -> PlanarState:
        """The next state of a block with these values: slip, slip velocity, tilt, tilt rate.

        `side`: the corner it stands or turns on; 0 where the base lies on the floor.
        """
        slip_velocity = float(values[1])
        direction = int(np.sign(slip_velocity))
        if side:
            return self._on_corner(values, side, direction, acceleration)
        if self.pressure(acceleration) < 0.0:  # the floor falls away
            return PlanarState(mode=PlanarMode.OUTSIDE)
        if direction:
            if self.slides_flat:
                return PlanarState(mode=PlanarMode.SLIDE, direction=direction)
            return self._on_corner(values, direction, direction, acceleration)
        if self.rest_margin(acceleration) >= 0.0:
            return PlanarState(mode=PlanarMode.REST)
        pushed = -int(np.sign(acceleration.x))  # against the acceleration of the floor
        if abs(acceleration.x) > self.body.uplift_acceleration * self._share_of_gravity(acceleration):
            rocking = self._on_corner(values, pushed, 0, acceleration)
            if rocking.mode is PlanarMode.ROCK or not self.slides_flat:
                return rocking
        return PlanarState(mode=PlanarMode.SLIDE, direction=pushed)

    def pressure(self, acceleration: Acceleration) -> float:
        """Normal force on the whole base per mass; negative: the floor falls faster than the block [m/s2]."""
        return self.body.gravity + acceleration.z

    def rest_margin(self, acceleration: Acceleration) -> float:
        """Margin of the floor acceleration for rest on the whole base [m/s2]."""
        limit = min(self.mu_static * self.body.gravity, self.body.uplift_acceleration)
        return limit * self._share_of_gravity(acceleration) - abs(acceleration.x)

    def _share_of_gravity(self, acceleration: Acceleration) -> float:
        """(g + a_v)/g [-]."""
        return 1.0 + acceleration.z / self.body.gravity

    def stick_margin(self, contact: CornerContact) -> float:
        """Margin of friction at a sticking corner, per mass [m/s2]."""
        return self.mu_static * contact.normal - abs(contact.friction)

    def contact(self, state: PlanarState, values: FloatArray, acceleration: Acceleration) -> CornerContact:
        """Accelerations and reactions of a block on one corner."""
        tilt, rate = float(values[2]), float(values[3])
        if state.direction == 0:
            return rock(self.body, state.side, tilt, rate, acceleration)
        return slide_rock(
            self.body,
            state.side,
            tilt,
            rate,
            acceleration,
            mu_kinetic=self.mu_kinetic,
            direction=state.direction,
        )

    def _on_corner(
        self, values: FloatArray, side: int, direction: int, acceleration: Acceleration
    ) -> PlanarState:
        state = PlanarState(mode=PlanarMode.ROCK, side=side)
        if direction == 0:
            sticking = self.contact(state, values, acceleration)
            if sticking.normal >= 0.0 and self.stick_margin(sticking) >= 0.0:
                return state
            direction = -int(np.sign(sticking.friction)) or 1
        state = PlanarState(mode=PlanarMode.SLIDE_ROCK, side=side, direction=direction)
        if not self.contact(state, values, acceleration).normal >= 0.0:  # flight, or no unique force
            return PlanarState(mode=PlanarMode.OUTSIDE, side=side)
        return state


def simulate_planar_block(
    block: PlanarBlock,
    floor: FloorAcceleration,
    *,
    duration: float,
    rotation: float = 0.0,
    angular_velocity: float = 0.0,
    slip_velocity: float = 0.0,
) -> PlanarMotion:
    """Integrate until the block has overturned, left the model, or the duration [s] is over.

    Args:
        rotation: at the start, positive about the right corner [rad].
        angular_velocity: about that corner; at rotation 0 its sign chooses the corner [rad/s].
        slip_velocity: of that corner, or of the base, over the floor [m/s]; a block at rest on a floor that
            starts with velocity v has -v.

    Raises:
        ValueError: a start beyond 90 degrees, a duration that is not positive.
        EventError: more than 100 000 changes of state.
    """
    if not 0.0 < duration < math.inf:
        raise ValueError(f"planar block: duration must be positive and finite, got {duration} s")
    if not abs(rotation) < 0.5 * math.pi:
        raise ValueError(f"planar block: the start must lie below 90 degrees, got {rotation} rad")
    body = block.body
    angle, frequency = body.slenderness_angle, body.frequency_parameter
    inertia = body.inertia_ratio * body.radius**2
    least_rate = math.sqrt(2.0 * REST_ENERGY * body.overturning_energy / inertia)
    pieces: list[Piece] = []
    states: list[PlanarState] = []
    impacts: list[PlanarImpact] = []

    time = 0.0
    side = int(np.sign(rotation)) or int(np.sign(angular_velocity))
    values = np.array([0.0, slip_velocity, side * rotation, side * angular_velocity])
    state = block.select(values, side, floor.just_after(0.0))
    for _ in range(MAX_EVENTS):
        states.append(state)
        if state.mode in (PlanarMode.OVERTURNED, PlanarMode.OUTSIDE):
            break
        first_step = None
        if state.side and values[2] <= 0.0:  # well inside the hop that follows an impact
            fall = abs(block.contact(state, values, floor.just_after(time)).tilt_acceleration)
            hop = 0.5 * values[3] / fall if fall * values[3] > 0.0 else math.inf
            first_step = min(0.01 / frequency, hop)
        passage = flow(
            rate=None if state.mode is PlanarMode.REST else partial(_rate, block, state),
            guards=_guards(block, state),
            state=values,
            start=time,
            end=duration,
            floor=floor,
            scale=np.array([body.half_width, body.half_width * frequency, angle, angle * frequency]),
            regime=len(states) - 1,
            first_step=first_step,
        )
        pieces.extend(passage.pieces)
        time, values = passage.time, passage.state.copy()
        if passage.event is None:
            break
        event, acceleration = passage.event, floor.just_after(time)
        side = state.side
        if event == "overturned":
            state = PlanarState(mode=PlanarMode.OVERTURNED, side=side)
            continue
        if event == "leaves the floor":
            state = PlanarState(mode=PlanarMode.OUTSIDE, side=side)
            continue
        if event == "stops":
            values[1] = 0.0
        if event == "impact":
            impact = corner_impact(
                body,
                side,
                float(values[1]),
                float(values[3]),
                mu_static=block.mu_static,
                mu_kinetic=block.mu_kinetic,
            )
            if impact is None:
                state = PlanarState(mode=PlanarMode.OUTSIDE, side=side)  # no consistent impulses
                continue
            rate = impact.tilt_rate
            if rate < least_rate:  # its base may lie on the floor
                if impact.slip_velocity != 0.0:
                    lies = block.slides_flat
                else:
                    lies = block.select(np.zeros(4), 0, acceleration).side == 0
                rate = 0.0 if lies else rate
            impacts.append(
                PlanarImpact(
                    time=time,
                    velocity_before=side * float(values[3]),
                    velocity_after=-side * rate,
                    slip_velocity_before=float(values[1]),
                    slides=impact.slides,
                )
            )
            side = -side if rate > 0.0 else 0
            values = np.array([values[0], impact.slip_velocity, 0.0, rate])
        state = block.select(values, side, acceleration)
    else:
        raise EventError(f"t = {time:.6g} s: {MAX_EVENTS} changes of state")
    turns = ((states[piece.regime].side, turning_point(piece, component=3)) for piece in pieces)
    peaks = [abs(side * float(turn[1][2])) for side, turn in turns if turn is not None]
    tilts = [float(piece.interpolant(t)[2]) for piece in pieces for t in (piece.start, piece.end)]
    return PlanarMotion(
        states=tuple(states),
        impacts=tuple(impacts),
        end=time,
        largest_rotation=max([float(values[2]), *tilts, *peaks]),
        pieces=tuple(pieces),
    )


def _guards(block: PlanarBlock, state: PlanarState) -> tuple[Guard, ...]:
    if state.mode is PlanarMode.REST:
        return (Guard(name="breaks loose", margin=lambda values, a: block.rest_margin(a)),)
    stops = Guard(name="stops", margin=lambda values, a: state.direction * float(values[1]))
    if state.mode is PlanarMode.SLIDE:
        return (stops, Guard(name="leaves the floor", margin=lambda values, a: block.pressure(a)))

    def stick(values: FloatArray, acceleration: Acceleration) -> float:
        return block.stick_margin(block.contact(state, values, acceleration))

    def normal(values: FloatArray, acceleration: Acceleration) -> float:
        return block.contact(state, values, acceleration).normal

    corner = (
        Guard(name="impact", margin=lambda values, a: float(values[2])),
        Guard(name="overturned", margin=lambda values, a: 0.5 * math.pi - float(values[2])),
    )
    if state.mode is PlanarMode.ROCK:
        return (*corner, Guard(name="slips", margin=stick))
    return (*corner, stops, Guard(name="leaves the floor", margin=normal))


def _rate(
    block: PlanarBlock, state: PlanarState, values: FloatArray, acceleration: Acceleration
) -> FloatArray:
    """Time derivative of slip, slip velocity, tilt, tilt rate."""
    if state.mode is PlanarMode.SLIDE:
        friction = -state.direction * block.mu_kinetic * block.pressure(acceleration)
        return np.array([values[1], friction - acceleration.x, 0.0, 0.0])
    contact = block.contact(state, values, acceleration)
    return np.array([values[1], contact.slip_acceleration, values[3], contact.tilt_acceleration])
