"""The unknown inputs of a case: the range of each, and the changed cases that try them.

This module alone knows the ranges. A run repeats itself over these changes (its band); a sweep takes its perturbed
copies from them. Where the case says nothing in its table [uncertainty], a range follows the case: friction falls from
`mu_static` by an amount and a way not measured for this floor; the stiffness of a rigid floor is known within a factor
of nine downwards (the point of a corner) and three upwards (a casting), stiffness and strength of a slab and damping
within a factor of two either way; and a harmonic motion begins in one of several ways. The numerics are no input and
are always tried, ten times tighter.

Friction between loose boxes is not that of the floor: other surfaces meet there. Where [joints] does not give it, a
case takes the floor's, but a changed case keeps what its case had (`apart_from_floor`), and the joints have ranges of
their own: `mu_static` within a factor of two unless it is given, its fall as on the floor.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fem.case import quantities as q
from fem.case.case import Case
from fem.case.motion_rules import LEAST_RAMP
from fem.case.rules import longest_time

SOFTEST, STIFFEST = 1.0 / 9.0, 3.0  #: contact stiffness over that of the case
DAMPING = (0.5, 2.0)  #: contact and material damping over those of the case
SLAB = (0.5, 2.0)  #: Young's modulus and bearing strength of a slab over those of the case
JOINTS = (0.5, 2.0)  #: static friction between loose boxes over that of the case, where this has the floor's
LOSS = (0.8, 1.5)  #: loss at an impact, 1 - e, over that of the case where its restitution is given
WEAKENING_M, STRIBECK_M_S = 5e-3, 0.3  #: largest slip and velocity over which friction falls
WEAKENINGS_BETWEEN_M = (1e-4, 1e-3)
RAMP_CYCLES = 2.0
TIGHTER = 0.1  #: energy tolerance over that of the case
STIFF_FLOOR = (
    30.0  #: stiffness over that of the case at which a flat base must still open, or it does so by softness
)
TURN = 2.0 * math.pi
MOVES = 1e-9  #: cosine of the phase of a floor that starts at rest

MU_KINETIC, WEAKENING, STRIBECK = "contact.mu_kinetic", "contact.weakening_m", "contact.stribeck_velocity_m_s"
#: between loose boxes
JOINTS_MU_STATIC, JOINTS_MU_KINETIC = "joints.mu_static", "joints.mu_kinetic"
JOINTS_WEAKENING = "joints.weakening_m"
START, RAMP, TOLERANCE = "motion.start", "motion.ramp_cycles", "solver.energy_tolerance"
PENALTY, DASHPOT, RESTITUTION, MATERIAL = (
    "contact.normal_penalty_Pa_m",
    "contact.damping_ratio",
    "contact.restitution_over_housner",
    "container.damping_ratio",
)
STRENGTH, MODULUS = "floor.bearing_strength_Pa", "floor.youngs_modulus_Pa"
#: every input that may vary, those first that decide most often
INPUTS = (
    *(MU_KINETIC, WEAKENING, STRIBECK, JOINTS_MU_STATIC, JOINTS_MU_KINETIC, JOINTS_WEAKENING, START, RAMP),
    *(PENALTY, STRENGTH, MODULUS, DASHPOT, RESTITUTION, MATERIAL, TOLERANCE),
)

Value = float | str


@dataclass(frozen=True, kw_only=True)
class InputChange:
    """A changed case: what one member of a band, or one copy of a cell, does differently."""

    kind: Literal["one", "floor", "pair", "draw"]
    values: Mapping[str, Value]  #: dotted key -> value
    share: float  #: how far it goes from the case to the end of the range; of a draw 1
    place: tuple[float, ...] = ()  #: of a draw in the ranges of `inputs`, 0 to 1

    @property
    def inputs(self) -> tuple[str, ...]:
        """The inputs that it belongs to."""
        return tuple(self.values)

    @property
    def label(self) -> str:
        """The change in words, the same for the same change."""
        return ", ".join(
            f"{key} = {value:.4g}" if isinstance(value, float) else f'{key} = "{value}"'
            for key, value in self.values.items()
        )


@dataclass(frozen=True, kw_only=True)
class InputRange:
    """The values that an input may have."""

    key: str  #: dotted
    own: Value  #: of the case
    ends: tuple[Value, ...]  #: that differ from the case's own; one after the other, lowest first
    between: tuple[float, ...] = ()  #: tried one at a time, too
    drawn: Callable[[float], Value]  #: value at a place from 0 to 1

    def share(self, value: float) -> float:
        """How far a value lies on the way from the case's own to the end of the range."""
        assert isinstance(self.own, float)
        ahead = [
            end for end in self.ends if isinstance(end, float) and (end - self.own) * (value - self.own) > 0.0
        ]
        return abs(value - self.own) / abs(ahead[0] - self.own) if ahead else 1.0


def ranges_of(case: Case, penalty: float | None) -> tuple[InputRange, ...]:
    """The ranges of all unknown inputs, in the order of `INPUTS` and without the numerics.

    Args:
        case: with its table [uncertainty].
        penalty: normal stiffness of its contact, chosen where the case says "auto" [Pa/m]; None: leave it out.
    """
    return tuple(one for one in _ranges(case, penalty) if one.ends)


def changes_of(case: Case, penalty: float | None) -> tuple[InputChange, ...]:
    """One input changed at a time, to each end of its range and between, and the numerics ten times tighter."""
    changes = [
        InputChange(
            kind="one", values={one.key: value}, share=one.share(value) if isinstance(value, float) else 1.0
        )
        for one in ranges_of(case, penalty)
        for value in (*one.between, *one.ends)
    ]
    tolerance = max(TIGHTER * case.solver.energy_tolerance, q.ENERGY_TOLERANCE.least or 0.0)
    if tolerance < case.solver.energy_tolerance:
        changes.append(InputChange(kind="one", values={TOLERANCE: _short(tolerance)}, share=1.0))
    return tuple(changes)


def pairs_of(case: Case) -> tuple[InputChange, ...]:
    """The pairs that matter: a smaller fall of friction that is also a slower one.

    At `mu_kinetic = mu_static` nothing falls, so the pair is tried half way.
    """
    ranges = {one.key: one for one in ranges_of(case, None)}
    if MU_KINETIC not in ranges:
        return ()
    friction = ranges[MU_KINETIC]
    middle = _short(float(friction.drawn(0.5)))
    slower = [(key, ranges[key].ends[-1]) for key in (WEAKENING, STRIBECK) if key in ranges]
    if middle >= case.contact.mu_static:
        return ()
    return tuple(
        InputChange(kind="pair", values={MU_KINETIC: middle, key: end}, share=1.0) for key, end in slower
    )


def draws_of(case: Case, penalty: float | None, count: int | None = None) -> tuple[InputChange, ...]:
    """All inputs drawn at once from their ranges, by Sobol's points; the numerics stay as they are.

    Args:
        case, penalty: as for `ranges_of`.
        count: of draws; None: as the case says.
    """
    ranges = ranges_of(case, penalty)
    if not ranges:
        return ()
    places = sobol_points(case.uncertainty.draws if count is None else count, len(ranges))
    return tuple(
        InputChange(kind="draw", values=drawn_values(ranges, row), share=1.0, place=tuple(row))
        for row in places.tolist()
    )


def drawn_values(ranges: Sequence[InputRange], places: Sequence[float]) -> dict[str, Value]:
    """The values at places from 0 to 1 in these ranges, by key.

    A range of `joints.mu_kinetic` holds for the `joints.mu_static` of the case, and scales with it.
    """
    values = {one.key: one.drawn(place) for one, place in zip(ranges, places, strict=True)}
    own = {one.key: one.own for one in ranges}
    if JOINTS_MU_STATIC in values and JOINTS_MU_KINETIC in values:
        share = float(values[JOINTS_MU_STATIC]) / float(own[JOINTS_MU_STATIC])
        values[JOINTS_MU_KINETIC] = _short(share * float(values[JOINTS_MU_KINETIC]))
    return values


def apart_from_floor(case: Case, values: Mapping[str, Value]) -> dict[str, Value]:
    """The values that change a case, with those of friction between its loose boxes, which do not follow the floor's.

    Where `joints.mu_static` changes alone, `joints.mu_kinetic` keeps its share of it.
    """
    if not case.container.is_loose:
        return dict(values)
    own = {f"joints.{key}": value for key, value in case.joint_friction.items()}
    if JOINTS_MU_STATIC in values and own[JOINTS_MU_STATIC] > 0.0:
        own[JOINTS_MU_KINETIC] *= float(values[JOINTS_MU_STATIC]) / own[JOINTS_MU_STATIC]
    changed = {**own, **values}
    changed[JOINTS_MU_KINETIC] = min(float(changed[JOINTS_MU_KINETIC]), float(changed[JOINTS_MU_STATIC]))
    return changed


def stiff_floor(case: Case, penalty: float) -> InputChange:
    """A floor so stiff that a container on a flat base is a rigid block on a rigid floor; arguments as `ranges_of`."""
    own = case.floor.youngs_modulus_Pa
    key, value = (PENALTY, penalty) if own is None else (MODULUS, own)
    most = QUANTITIES[key].most or math.inf
    return InputChange(kind="floor", values={key: min(most, _short(STIFF_FLOOR * value))}, share=1.0)


def sobol_points(count: int, dimensions: int) -> NDArray[np.float64]:
    """The first points of Sobol's sequence, each in the middle of its cell, shape (count, dimensions).

    Direction numbers of Joe and Kuo, SIAM J. Sci. Comput. 30 (2008) 2635, for at most twelve dimensions. (The sequence
    of scipy is the same; importing it takes longer than a run.)
    """
    bits = math.ceil(math.log2(max(count, 1)))
    number = np.arange(count)
    gray = number ^ (number >> 1)
    points = np.zeros((count, dimensions), dtype=np.int64)
    for column in range(dimensions):
        for bit, direction in enumerate(_directions(column, bits)):
            points[:, column] ^= np.where(gray >> bit & 1, direction, 0)
    return (points + 0.5) / 2**bits


#: of each further dimension: the inner coefficients of a primitive polynomial, and the first direction numbers
POLYNOMIALS = (
    (0, (1,)),
    (1, (1, 3)),
    (1, (1, 3, 1)),
    (2, (1, 1, 1)),
    (1, (1, 1, 3, 3)),
    (4, (1, 3, 5, 13)),
    (2, (1, 1, 5, 5, 17)),
    (4, (1, 1, 5, 5, 5)),
    (7, (1, 1, 7, 11, 19)),
    (11, (1, 1, 5, 1, 1)),
    (13, (1, 1, 1, 3, 11)),
)


def _directions(column: int, bits: int) -> list[int]:
    """Direction numbers of one dimension, each shifted to `bits` binary digits."""
    if column == 0:
        return [1 << (bits - 1 - k) for k in range(bits)]
    inner, first = POLYNOMIALS[column - 1]
    degree, numbers = len(first), list(first)
    for k in range(degree, bits):
        number = numbers[k - degree] ^ numbers[k - degree] << degree
        for j in range(1, degree):
            if inner >> (degree - 1 - j) & 1:
                number ^= numbers[k - j] << j
        numbers.append(number)
    return [number << (bits - 1 - k) if k < bits else 0 for k, number in enumerate(numbers[:bits])]


def _ranges(case: Case, penalty: float | None) -> Iterator[InputRange]:
    contact, container, stated = case.contact, case.container, case.uncertainty
    friction = (contact.mu_kinetic, contact.mu_static)
    yield _kinetic(MU_KINETIC, stated.mu_kinetic, friction)
    falls = contact.mu_kinetic < contact.mu_static or isinstance(stated.mu_kinetic, list)
    between = case.joint_friction
    slips = between["mu_kinetic"] < between["mu_static"] or isinstance(stated.joints_mu_kinetic, list)
    slips = slips and container.is_loose
    if contact.friction == "elastic-stick" and falls:
        yield _weakening(WEAKENING, contact.weakening_m, stated.weakening_m)
    if contact.friction == "elastic-stick" and (falls or slips):
        velocity = contact.stribeck_velocity_m_s
        yield _numbers(
            STRIBECK, velocity, stated.stribeck_velocity_m_s, (0.0, max(STRIBECK_M_S, velocity)), power=2.0
        )
    if container.is_loose:
        given = case.joints.mu_static is not None
        yield _factors(
            JOINTS_MU_STATIC, between["mu_static"], stated.joints_mu_static, (1.0, 1.0) if given else JOINTS
        )
        yield _kinetic(
            JOINTS_MU_KINETIC, stated.joints_mu_kinetic, (between["mu_kinetic"], between["mu_static"])
        )
        if contact.friction == "elastic-stick" and slips:
            yield _weakening(JOINTS_WEAKENING, between["weakening_m"], stated.joints_weakening_m)
    yield from _beginnings(case)
    yield from _impacts(case, penalty)
    if case.solver.model != "rigid":
        yield _factors(MATERIAL, container.damping_ratio, stated.material_damping_ratio, DAMPING)


def _kinetic(key: str, stated: Sequence[float] | str | None, friction: tuple[float, float]) -> InputRange:
    """The range of kinetic friction: unless stated, from that of the case to static friction."""
    own = friction[0]
    low, high = _ends(stated, own, friction)
    return _numbers(key, own, stated, friction, (_short(0.5 * (low + high)),))


def _weakening(key: str, own: float, stated: Sequence[float] | str | None) -> InputRange:
    return _numbers(key, own, stated, (0.0, max(WEAKENING_M, own)), WEAKENINGS_BETWEEN_M, power=3.0)


def _impacts(case: Case, penalty: float | None) -> Iterator[InputRange]:
    """What decides an impact: stiffness and strength of a slab; else those of the contact, or its restitution."""
    contact, stated = case.contact, case.uncertainty
    ratio = contact.restitution_over_housner
    if ratio is not None:
        box = case.container
        half_width, centroid = 0.5 * box.width_m, 0.5 * (box.total_height - box.height_m) + box.centroid_m
        housner = 1.0 - 1.5 * half_width**2 / (half_width**2 + centroid**2)  # of a homogeneous block
        less, more = ((1.0 - share * (1.0 - ratio * housner)) / housner for share in (LOSS[1], LOSS[0]))
        least = q.RESTITUTION.least or 0.0
        yield _numbers(
            RESTITUTION, ratio, stated.restitution_over_housner, (_short(max(least, less)), _short(more))
        )
        return
    floor = case.floor
    if floor.bearing_strength_Pa is not None and floor.youngs_modulus_Pa is not None:  # a slab
        yield _factors(STRENGTH, floor.bearing_strength_Pa, stated.bearing_strength_Pa, SLAB)
        yield _factors(MODULUS, floor.youngs_modulus_Pa, stated.floor_youngs_modulus_Pa, SLAB)
        if case.contact_damping_ratio is not None:  # else its own, which matters little where it crushes
            yield _factors(DASHPOT, case.contact_damping_ratio, stated.damping_ratio, DAMPING)
        return
    if penalty is not None:
        yield _factors(PENALTY, penalty, stated.normal_penalty_Pa_m, (SOFTEST, STIFFEST))
    yield _factors(DASHPOT, contact.dashpot, stated.damping_ratio, DAMPING)


def _beginnings(case: Case) -> Iterator[InputRange]:
    """Of a harmonic motion: with the floor or at rest, at once or by a ramp."""
    motion, stated = case.motion, case.uncertainty
    if motion.kind != "harmonic":
        return
    jerks = motion.ramp_cycles == 0.0 and abs(math.cos(motion.phase_rad)) > MOVES
    if stated.start in (None, True) and jerks:
        yield _either(START, motion.start, "rest" if motion.start == "moving" else "moving")
    if stated.ramp in (None, True):
        cycles = motion.cycles or longest_time(case) / motion.period
        ramp = min(RAMP_CYCLES, _short(0.5 * cycles * (1.0 - 1e-9))) if motion.ramp_cycles == 0.0 else 0.0
        if ramp == 0.0 or ramp >= LEAST_RAMP:
            yield _either(RAMP, motion.ramp_cycles, ramp)


def _either(key: str, own: Value, other: Value) -> InputRange:
    return InputRange(key=key, own=own, ends=(other,), drawn=lambda place: own if place < 0.5 else other)


def _numbers(
    key: str,
    own: float,
    stated: Sequence[float] | str | None,
    default: tuple[float, float],
    between: Sequence[float] = (),
    power: float = 1.0,
) -> InputRange:
    """A range on a linear scale; with a power, most of the draws lie near its lower end."""
    low, high = _ends(stated, own, default)
    return InputRange(
        key=key,
        own=own,
        ends=_others((low, high), own),
        between=tuple(value for value in between if low < value < high and value != own),
        drawn=lambda place: _short(low + (high - low) * place**power),
    )


def _factors(
    key: str, own: float, stated: Sequence[float] | str | None, factors: tuple[float, float]
) -> InputRange:
    """A range on a logarithmic scale, unless it begins at zero."""
    quantity = QUANTITIES[key]
    least, most = quantity.least or 0.0, (quantity.below or math.inf) * (1.0 - 1e-9)
    default = (max(least, factors[0] * own), min(most, quantity.most or math.inf, factors[1] * own))
    low, high = _ends(stated, own, default)

    def drawn(place: float) -> Value:
        return _short(low * (high / low) ** place if low > 0.0 else high * place)

    return InputRange(key=key, own=own, ends=_others((low, high), own), drawn=drawn)


QUANTITIES = {
    JOINTS_MU_STATIC: q.FRICTION,
    PENALTY: q.PENALTY,
    STRENGTH: q.BEARING_STRENGTH,
    MODULUS: q.FLOOR_STIFFNESS,
    DASHPOT: q.CONTACT_DAMPING,
    MATERIAL: q.MATERIAL_DAMPING,
}


def _ends(
    stated: Sequence[float] | str | None, own: float, default: tuple[float, float]
) -> tuple[float, float]:
    if stated is None:
        return default
    return (own, own) if isinstance(stated, str) else (stated[0], stated[1])


def _others(ends: tuple[float, float], own: float) -> tuple[float, ...]:
    """The ends, each once and without the case's own value."""
    return tuple(end for end in sorted(set(ends)) if not math.isclose(end, own, rel_tol=1e-12))


def _short(value: float) -> float:
    """Twelve digits: a third of 0.3 is 0.1."""
    return float(f"{value:.12g}")
