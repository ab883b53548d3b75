"""A row of a simplified method: demand, capacity, conclusion and source."""

import math
from dataclasses import KW_ONLY, dataclass
from enum import StrEnum


class MethodQuantity(StrEnum):
    """What a method is about."""

    OVERTURNING = "overturning"
    SLIDING = "sliding"  #: whether it slides at all
    SLIP = "slip"  #: how far it slides


def derived(work: str) -> str:
    """A source after which something was derived here; only a clause that was checked is cited as one."""
    return f"after {work}; derived here, not the text of a clause"


def length_in_words(length: float) -> str:
    """A length [m] in mm, or in m from 1 m on."""
    return f"{1000.0 * length:.3g} mm" if length < 1.0 else f"{length:.3g} m"


def utilisation(demand: float, capacity: float) -> float:
    """Demand over capacity [-]; infinite where a demand meets no capacity, 0 without demand."""
    if demand == 0.0:
        return 0.0
    return demand / capacity if capacity > 0.0 else math.inf


@dataclass(frozen=True)
class MethodRow:
    """One simplified method, applied."""

    name: str
    formula: str  #: symbols; an index after an underscore
    numbers: str  #: the formula with numbers
    demand: float  #: infinite where the method finds no position of rest below overturning
    capacity: float
    unit: str
    says: str
    source: str  #: standard and clause, authors with the year, or `derived` from these
    validity: str
    _: KW_ONLY
    quantity: MethodQuantity
    median: bool = False  #: what half of such motions or bodies exceed: no statement on one of them
    beyond: str = ""  #: why it does not hold here; empty: it does

    @property
    def utilisation(self) -> float:
        """See `utilisation`."""
        return utilisation(self.demand, self.capacity)

    @property
    def fulfilled(self) -> bool:
        """Whether the demand is at most the capacity."""
        return self.utilisation <= 1.0
