"""The rigid block that rests, slides, rocks or slide-rocks: the reference for the regime of motion.

Event-driven: in each state the equations of `contact.reference.planar_equations` are integrated to 1e-12 until the
contact changes (slip begins or ends, a corner meets the floor, the base lifts). Rotation and slip are
positive toward +x. A floor that moves up and down changes gravity in its frame to g + a_v. Free flight is detected and
reported, but not integrated.
Shenton and Jones, J. Engng Mech. ASCE 117 (1991), parts I and II; Shenton, Criteria for initiation of slide,
rock, and slide-rock rigid-body modes, ibid. 122 (1996).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contact.arrays import FloatArray
from contact.reference.event_driven import (
    MAX_EVENTS,
    REST_ENERGY,
    EventError,
    Guard,
    Passage,
    Piece,
    Rate,
    flow,
    turning_point,
)
from contact.reference.floor_acceleration import Acceleration, FloorAcceleration
from contact.reference.planar_equations import CornerContact, corner_impact, rock, slide_rock
from contact.reference.planar_motion import (
    PlanarImpact,
    PlanarMode,
    PlanarMotion,
    PlanarState,
    PlanarTransition,
)
from contact.reference.rigid_block import RigidBlock


@dataclass(frozen=True, kw_only=True)
class PlanarBlock:
    """A rigid block with Coulomb friction under its corners.

    Raises:
        ValueError: a negative or infinite coefficient, or mu_kinetic above mu_static.
    """

    body: RigidBlock
    mu_static: float  #: [-]
    mu_kinetic: float  #: [-]

    def __post_init__(self) -> None:
        check_friction(self.mu_static, self.mu_kinetic)

    @property
    def slides_flat(self) -> bool:
        """Whether it can slide with its whole base on the floor: mu_k H <= B."""
        return self.mu_kinetic * self.body.centroid_height <= self.body.half_width

    def select(self, values: FloatArray, side: int, acceleration: Acceleration) -> PlanarState:
        """The next state of a block with given position and velocities.

        Args:
            values: slip, slip velocity, tilt, tilt rate.
            side: the corner it stands or turns on; 0 where the base lies on the floor.
            acceleration: of the floor [m/s2].
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
    """Integrate until the block has overturned, left the model, or the duration is over.

    Args:
        duration: [s].
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
    inertia = body.inertia_ratio * body.radius**2
    least_rate = math.sqrt(2.0 * REST_ENERGY * body.overturning_energy / inertia)
    pieces: list[Piece] = []
    states: list[PlanarState] = []
    transitions: list[PlanarTransition] = []
    impacts: list[PlanarImpact] = []

    time, reason = 0.0, "start"
    side = int(np.sign(rotation)) or int(np.sign(angular_velocity))
    values = np.array([0.0, slip_velocity, side * rotation, side * angular_velocity])
    state = block.select(values, side, floor.just_after(0.0))
    for _ in range(MAX_EVENTS):
        transitions.append(PlanarTransition(time=time, state=state, reason=reason))
        if state.mode in (PlanarMode.OVERTURNED, PlanarMode.OUTSIDE):
            break
        passage = _follow(block, state, values, time, duration, floor, regime=len(states))
        states.append(state)
        pieces.extend(passage.pieces)
        time, values = passage.time, passage.state.copy()
        if passage.event is None:
            break
        reason, acceleration = passage.event, floor.just_after(time)
        side = state.side
        if reason == "overturned":
            state = PlanarState(mode=PlanarMode.OVERTURNED, side=side)
            continue
        if reason == "leaves the floor":
            state = PlanarState(mode=PlanarMode.OUTSIDE, side=side)
            continue
        if reason == "stops":
            values[1] = 0.0
        if reason == "impact":
            impact = corner_impact(
                body,
                side,
                float(values[1]),
                float(values[3]),
                mu_static=block.mu_static,
                mu_kinetic=block.mu_kinetic,
            )
            if impact is None:
                state, reason = PlanarState(mode=PlanarMode.OUTSIDE, side=side), "no consistent impulses"
                continue
            rate = impact.tilt_rate
            if rate < least_rate and _can_lie(block, impact.slip_velocity, acceleration):
                rate = 0.0
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
    return _motion(transitions, impacts, pieces, states, values, time)


def _follow(
    block: PlanarBlock,
    state: PlanarState,
    values: FloatArray,
    time: float,
    duration: float,
    floor: FloorAcceleration,
    regime: int,
) -> Passage:
    body = block.body
    angle, frequency = body.slenderness_angle, body.frequency_parameter
    first_step = None
    if state.side and values[2] <= 0.0:  # well inside the hop that follows an impact
        fall = abs(block.contact(state, values, floor.just_after(time)).tilt_acceleration)
        first_step = min(0.01 / frequency, 0.5 * values[3] / fall if fall * values[3] > 0.0 else math.inf)
    return flow(
        rate=None if state.mode is PlanarMode.REST else _rate(block, state),
        guards=_guards(block, state),
        state=values,
        start=time,
        end=duration,
        floor=floor,
        scale=np.array([body.half_width, body.half_width * frequency, angle, angle * frequency]),
        regime=regime,
        first_step=first_step,
    )


def check_friction(mu_static: float, mu_kinetic: float) -> None:
    """Refuse coefficients that are negative or not finite, and mu_kinetic above mu_static."""
    for name, value in (("mu_static", mu_static), ("mu_kinetic", mu_kinetic)):
        if not 0.0 <= value < math.inf:
            raise ValueError(f"{name} must be finite and not negative, got {value}")
    if mu_kinetic > mu_static:
        raise ValueError(
            f"mu_kinetic must not exceed mu_static, got {mu_kinetic} > {mu_static}; "
            "otherwise a body could neither stick nor slide"
        )


def _rate(block: PlanarBlock, state: PlanarState) -> Rate:
    def slide(values: FloatArray, acceleration: Acceleration) -> FloatArray:
        friction = -state.direction * block.mu_kinetic * block.pressure(acceleration)
        return np.array([values[1], friction - acceleration.x, 0.0, 0.0])

    def turn(values: FloatArray, acceleration: Acceleration) -> FloatArray:
        contact = block.contact(state, values, acceleration)
        return np.array([values[1], contact.slip_acceleration, values[3], contact.tilt_acceleration])

    return slide if state.mode is PlanarMode.SLIDE else turn


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


def _can_lie(block: PlanarBlock, slip_velocity: float, acceleration: Acceleration) -> bool:
    """Whether the base of a block that does not turn may lie on the floor."""
    if slip_velocity != 0.0:
        return block.slides_flat
    return block.select(np.array([0.0, 0.0, 0.0, 0.0]), 0, acceleration).side == 0


def _motion(
    transitions: Sequence[PlanarTransition],
    impacts: Sequence[PlanarImpact],
    pieces: Sequence[Piece],
    states: Sequence[PlanarState],
    values: FloatArray,
    time: float,
) -> PlanarMotion:
    turns = ((states[piece.regime].side, turning_point(piece, component=3)) for piece in pieces)
    peaks = [(turn[0], side * float(turn[1][2])) for side, turn in turns if turn is not None]
    tilts = [float(piece.interpolant(t)[2]) for piece in pieces for t in (piece.start, piece.end)]
    return PlanarMotion(
        transitions=tuple(transitions),
        impacts=tuple(impacts),
        peaks=tuple(peaks),
        end=time,
        largest_rotation=max([float(values[2]), *tilts, *(abs(rotation) for _, rotation in peaks)]),
        pieces=tuple(pieces),
        states=tuple(states),
    )
