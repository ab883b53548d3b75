"""Two rigid blocks, one on the other, on a moving floor: the reference for the patterns of a loose stack.

Event-driven, friction high enough that nothing slides. Between events the equations of `two_blocks`
are integrated to 1e-12. An interface opens when a normal force that holds it closed becomes negative. When an interface
closes the impact is plastic, everywhere at once: of the footings on which the stack may go on, that one follows whose
impulses push and whose interfaces do not close further. It is unique, being the projection of the velocities before the
impact on those that are admissible, in the metric of the kinetic energy (Moreau 1988); likewise the accelerations
at an opening (Gauss). A stack both of whose ends would leave an interface is outside the model.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from two_blocks import (
    Footing,
    Motion,
    Normals,
    Pattern,
    TwoBlockStack,
    angular_accelerations,
    carried,
    contact_normals,
    normals,
    rates_after_impact,
    velocities,
)

from contact.arrays import FloatArray
from contact.reference.event_driven import (
    MAX_EVENTS,
    REST_ENERGY,
    EventError,
    Guard,
    Passage,
    Piece,
    flow,
    sample,
)
from contact.reference.floor_acceleration import Acceleration, FloorAcceleration

ROUNDING = 1e-9  #: share of a force, impulse or rate that counts as none


@dataclass(frozen=True, kw_only=True)
class TwoBlockMotion:
    """Motion of a stack of two blocks."""

    stack: TwoBlockStack
    impacts: tuple[float, ...]  #: when an interface closes [s]
    pieces: tuple[Piece, ...]
    footings: tuple[Footing, ...]  #: numbered by the regimes of the pieces

    @property
    def patterns(self) -> tuple[Pattern, ...]:
        """Those that it moved in, in order, without repetition."""
        seen = dict.fromkeys(footing.pattern for footing in self.footings)
        return tuple(pattern for pattern in seen if pattern is not Pattern.REST)

    def at(self, times: FloatArray) -> FloatArray:
        """States at given times, shape (n, 4), nan after the end; at an event that after it."""
        return sample(self.pieces, np.asarray(times, dtype=float), 4)[0]


def simulate_two_blocks(
    stack: TwoBlockStack,
    floor: FloorAcceleration,
    *,
    duration: float,
    state: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
) -> TwoBlockMotion:
    """Follow the stack until a block has turned by 90 degrees, it leaves the model, or the duration is over.

    Args:
        state: at the start; an interface is open where its angle, or its rate, is not zero.
        duration: [s].

    Raises:
        EventError: more than 100 000 events.
    """
    values, least, time = np.array(state, dtype=float), least_rate(stack), 0.0
    pieces: list[Piece] = []
    footings: list[Footing] = []
    impacts: list[float] = []
    footing = select(stack, values, floor.just_after(0.0))
    for _ in range(MAX_EVENTS):
        if footing is None:  # it leaves an interface
            break
        passage = _follow(stack, footing, values, time, duration, floor, regime=len(footings))
        footings.append(footing)
        pieces.extend(passage.pieces)
        time, values = passage.time, passage.state.copy()
        if passage.event is None or passage.event in ("overturned", "leaves"):
            break
        acceleration = floor.just_after(time)
        if passage.event != "opens":
            _close(values, footing, passage.event)
            rates = impact(stack, footing, values, acceleration, least)
            if rates is None:
                break
            values[1], values[3] = rates
            impacts.append(time)
        footing = select(stack, values, acceleration)
    else:
        raise EventError(f"t = {time:.6g} s: {MAX_EVENTS} events of two blocks")
    return TwoBlockMotion(stack=stack, impacts=tuple(impacts), pieces=tuple(pieces), footings=tuple(footings))


def least_rate(stack: TwoBlockStack) -> float:
    """Rate of the upper block about an end of the joint with a share of the energy that tips it over [rad/s]."""
    upper = stack.upper
    arm = min(abs(stack.joint_end(side) - stack.offset) for side in (1, -1))
    radius = math.hypot(arm, upper.centroid_height)
    tipping = upper.mass * stack.gravity * (radius - upper.centroid_height)
    return math.sqrt(2.0 * REST_ENERGY * tipping / (upper.inertia + upper.mass * radius**2))


def select(stack: TwoBlockStack, state: FloatArray, floor: Acceleration) -> Footing | None:
    """The footing of a stack with given rotations and rates; None: it would leave an interface.

    An open interface, or one that opens, keeps its side. Of one that is at rest the accelerations decide.
    """
    bend, opening = float(state[2] - state[0]), float(state[3] - state[1])
    base, joint = _sides(state[0], state[1]), _sides(bend, opening)
    least = -ROUNDING * stack.gravity / stack.lower.height  # exactly zero at an opening, but for rounding
    for footing in (Footing(foot, end) for foot in base for end in joint):
        normal, angular = contact_normals(stack, footing, state, floor)
        turning = footing.base * angular[0], footing.joint * (angular[1] - angular[0])
        at_rest = len(base) > 1, len(joint) > 1
        opens = all(turn >= least for turn, still in zip(turning, at_rest, strict=True) if still)
        if opens and min(carried(footing, normal)) >= 0.0:
            return footing
    return None


def impact(
    stack: TwoBlockStack, footing: Footing, state: FloatArray, floor: Acceleration, least: float
) -> tuple[float, float] | None:
    """Rates after a plastic impact [rad/s], None where it would throw a block off an interface.

    Args:
        footing: before the impact.
        state: before it, the angle of the interface that has closed exactly zero.
        floor: acceleration after it.
        least: an interface that would open more slowly stays closed, where it can [rad/s].
    """
    before = velocities(stack, footing, state)
    rates = _projected(stack, before, state)
    if rates is None:
        return None
    turns = (float(state[0]), rates[0]), (float(state[2] - state[0]), rates[1] - rates[0])
    sides = [_sides(angle, rate if abs(rate) >= least else 0.0)[0] for angle, rate in turns]
    trial = state.copy()
    trial[1], trial[3] = held = rates_after_impact(stack, before, Footing(*sides), state)
    return held if select(stack, trial, floor) == Footing(*sides) else rates


def _projected(stack: TwoBlockStack, before: Motion, state: FloatArray) -> tuple[float, float] | None:
    """Rates on the footing whose impulses push and whose closed interfaces do not close further."""
    base, joint = _sides(state[0]), _sides(state[2] - state[0])
    speed = max(abs(before.lower_spin), abs(before.upper_spin))
    for footing in (Footing(foot, end) for foot in base for end in joint):
        rates = rates_after_impact(stack, before, footing, state)
        after = state.copy()
        after[1], after[3] = rates
        change = velocities(stack, footing, after).minus(before)
        impulses = carried(footing, normals(stack, footing, state, change, 0j))
        turning = footing.base * rates[0], footing.joint * (rates[1] - rates[0])
        shut = len(base) > 1, len(joint) > 1
        opens = all(turn >= -ROUNDING * speed for turn, closed in zip(turning, shut, strict=True) if closed)
        if opens and min(impulses) >= -ROUNDING * speed * stack.mass * stack.lower.height:
            return rates
    return None


def _sides(angle: float, rate: float = 0.0) -> tuple[int, ...]:
    """The sides on which an interface may stand: that on which it is open, or any."""
    side = int(np.sign(angle)) or int(np.sign(rate))
    return (side,) if side else (0, 1, -1)


def _follow(
    stack: TwoBlockStack,
    footing: Footing,
    values: FloatArray,
    time: float,
    duration: float,
    floor: FloorAcceleration,
    regime: int,
) -> Passage:
    frequency = math.sqrt(stack.gravity / (stack.lower.height + stack.upper.height))

    def rate(state: FloatArray, acceleration: Acceleration) -> FloatArray:
        lower, upper = angular_accelerations(stack, footing, state, acceleration)
        return np.array([state[1], lower, state[3], upper])

    return flow(
        rate=None if footing.pattern is Pattern.REST else rate,
        guards=list(_guards(stack, footing)),
        state=values,
        start=time,
        end=duration,
        floor=floor,
        scale=np.array([0.1, 0.1 * frequency, 0.1, 0.1 * frequency]),
        regime=regime,
        first_step=_first_step(footing, values, rate(values, floor.just_after(time)), 0.01 / frequency),
    )


def _guards(stack: TwoBlockStack, footing: Footing) -> Iterator[Guard]:
    def push(chosen: Callable[[Normals], float], state: FloatArray, acceleration: Acceleration) -> float:
        return chosen(contact_normals(stack, footing, state, acceleration)[0])

    ends: tuple[tuple[int, Callable[[Normals], float], Callable[[Normals], float]], ...] = (
        (footing.base, lambda n: n.base_right, lambda n: n.base_left),
        (footing.joint, lambda n: n.joint_right, lambda n: n.joint_left),
    )
    for side, right, left in ends:
        if side == 0:
            yield Guard(name="opens", margin=partial(push, right))
            yield Guard(name="opens", margin=partial(push, left))
        else:
            yield Guard(name="leaves", margin=partial(push, right if side == 1 else left))
    if footing.base:
        yield Guard(name="base", margin=lambda state, a: footing.base * float(state[0]))
    if footing.joint:
        yield Guard(name="joint", margin=lambda state, a: footing.joint * float(state[2] - state[0]))
    yield Guard(name="overturned", margin=lambda state, a: 0.5 * math.pi - float(abs(state[[0, 2]]).max()))


def _close(values: FloatArray, footing: Footing, interface: str) -> None:
    """Put the angle of an interface that closes to exactly zero; a joint that was closed stays so."""
    if interface == "base":
        values[2] = values[2] - values[0] if footing.joint else 0.0
        values[0] = 0.0
    else:
        values[2] = values[0]


def _first_step(footing: Footing, values: FloatArray, rate: FloatArray, longest: float) -> float:
    """A step well inside the hop of an interface that has just opened [s]."""
    step = longest
    for side, angle, speed, pull in (
        (footing.base, values[0], values[1], rate[1]),
        (footing.joint, values[2] - values[0], values[3] - values[1], rate[3] - rate[1]),
    ):
        if side and side * angle <= 0.0 and side * speed > 0.0 and side * pull < 0.0:
            step = min(step, 0.5 * abs(speed / pull))
    return step
