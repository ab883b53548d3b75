"""What an input that a case may not know is: a number within a range, or a choice."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

from fem.case.tables import quantities as q
from fem.case.tables.links import ROWS

#: dotted keys of the inputs that are named elsewhere, too
MU_STATIC, MU_KINETIC = "contact.mu_static", "contact.mu_kinetic"
WEAKENING, STRIBECK = "contact.weakening_m", "contact.stribeck_velocity_m_s"
JOINTS_MU_STATIC, JOINTS_MU_KINETIC = "joints.mu_static", "joints.mu_kinetic"
JOINTS_DASHPOT, DASHPOT = "joints.damping_ratio", "contact.damping_ratio"
PENALTY, RESTITUTION = "contact.normal_penalty_Pa_m", "contact.restitution_over_housner"
SUPPORT, CAMBER, ROCKING = "support.kind", "support.camber_m", "support.rocking_damping_ratio"
CENTROID, MODULUS = "container.centroid_m", "floor.youngs_modulus_Pa"
PHASE, START, RAMP = "motion.phase_rad", "motion.start", "motion.ramp_cycles"
SLOPE, TOLERANCE = "floor.slope_percent", "solver.energy_tolerance"

Value = float | str
Ends = tuple[float, float]
HELD = ("held", "known")  #: in place of a range


@dataclass(frozen=True, kw_only=True)
class InputRange:
    """The values that an input of a case may have."""

    key: str  #: dotted
    own: Value  #: of the case
    ends: tuple[Value, ...]  #: that differ from the case's own; one after the other, lowest first
    between: tuple[float, ...] = ()  #: tried one at a time, too
    drawn: Callable[[float], Value] | None  #: value at a place from 0 to 1; None: it is not drawn
    alone: bool = True  #: it makes a difference where nothing else is changed

    def share(self, value: float) -> float:
        """How far a value lies on the way from the case's own to the end of the range."""
        assert isinstance(self.own, float)
        ahead = [
            end for end in self.ends if isinstance(end, float) and (end - self.own) * (value - self.own) > 0.0
        ]
        return abs(value - self.own) / abs(ahead[0] - self.own) if ahead else 1.0


class UnknownNumber(NamedTuple):
    """A number that a case may not know: [low, high] in [uncertainty], or "held"."""

    key: str  #: dotted
    name: str  #: in [uncertainty]
    words: str  #: for people
    quantity: q.Quantity  #: what both ends are
    #: unless stated: factors on the case's own value, or both ends from the case and that value
    ends: Ends | Callable[[Any, float], Ends]
    matters: Callable[[Any], bool] = lambda case: True  #: where the case has a value at all
    #: of the draws: with a power above 1 most lie near the lower end; None: logarithmic, unless it begins at zero
    power: float | None = None
    #: values tried between the ends
    between: Callable[[float, float], tuple[float, ...]] = lambda low, high: ()
    alone: Callable[[Any], bool] = lambda case: True  #: where a change of it alone makes a difference
    same: Callable[[float], float] = lambda value: value  #: the value that means the same, of an angle
    varies: Callable[[Any], bool] = lambda case: True  #: where it is drawn with all others
    tried_from: Callable[[Any], float] = lambda case: (
        -math.inf
    )  #: a smaller value, but the lower end, means nothing

    def range_in(self, case: Any, penalty: float | None) -> InputRange | None:
        """The range in a case; None where it makes no difference."""
        own, stated = own_value(case, self.key, penalty), getattr(case.uncertainty, self.name)
        if own is None or not self.matters(case):
            return None
        if stated is not None:
            low, high = (own, own) if stated in HELD else stated
        elif isinstance(self.ends, tuple):
            least, most = self.quantity.least or 0.0, (self.quantity.below or math.inf) * (1.0 - 1e-9)
            low, high = (
                short(max(least, self.ends[0] * own)),
                short(min(most, self.quantity.most or math.inf, self.ends[1] * own)),
            )
        else:
            low, high = self.ends(case, own)
        ends = {self.same(end) for end in (low, high)}
        least = min(high, max(low, self.tried_from(case)))
        between = (value for value in self.between(low, high) if least < value < high and value != own)
        return InputRange(
            key=self.key,
            own=own,
            ends=tuple(end for end in sorted(ends) if not math.isclose(end, own, rel_tol=1e-12)),
            between=tuple(map(self.same, between)),
            drawn=partial(self._drawn, least, high) if self.varies(case) else None,
            alone=self.alone(case),
        )

    def _drawn(self, low: float, high: float, place: float) -> float:
        if self.power is not None:
            return self.same(short(low + (high - low) * place**self.power))
        return short(low * (high / low) ** place if low > 0.0 else high * place)

    def refusal(self, table: Any) -> str:
        """What is wrong with the stated range, "" if nothing: it rises between values that the input may have."""
        ends = getattr(table, self.name)
        if not isinstance(ends, list):
            return ""
        for end in ends:
            try:
                self.quantity.check(end)
            except ValueError as error:
                return str(error)
        if ends[0] <= ends[1]:
            return ""
        return (
            f"must be [low, high] with low at most high, got {ends}; write {ends[::-1]}, "
            'or "held" for the value of the case alone'
        )


class UnknownChoice(NamedTuple):
    """An input that may be otherwise than the case says: true in [uncertainty]; false or "held"."""

    key: str  #: dotted
    name: str  #: in [uncertainty]
    words: str  #: for people
    other: Callable[[Any], Value | None]  #: None where it makes no difference
    unless_stated: bool = True  #: tried where the case does not say
    drawn: bool = True

    def range_in(self, case: Any, penalty: float | None) -> InputRange | None:
        """The range in a case; None where it makes no difference."""
        own, other = own_value(case, self.key, penalty), self.other(case)
        stated = getattr(case.uncertainty, self.name)
        if other is None or stated in (*HELD, False) or (stated is None and not self.unless_stated):
            return None
        drawn = (lambda place: own if place < 0.5 else other) if self.drawn else None
        return InputRange(key=self.key, own=own, ends=(other,), drawn=drawn)


def short(value: float) -> float:
    """Twelve digits: a third of 0.3 is 0.1."""
    return float(f"{value:.12g}")


def own_value(case: Any, key: str, penalty: float | None) -> Any:
    """What a case has of an input, with what follows where the case itself says nothing; None: nothing."""
    table, _, name = key.partition(".")
    if table in ROWS:  # of the largest of its rows, which stands for all in proportion
        return max((getattr(row, name) for row in getattr(case, table)), default=None)
    if key == PENALTY:
        return None if case.floor.is_slab else penalty
    if key == DASHPOT:  # that of a slab matters little where it crushes
        return case.contact_damping_ratio
    if key == JOINTS_DASHPOT:
        return case.joints.dashpot
    if key == RESTITUTION:
        return case.contact.restitution_over_housner or 1.0
    return case.joint_friction[name] if table == "joints" else getattr(getattr(case, table), name)
