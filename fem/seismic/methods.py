"""All simplified methods side by side, and the factor on the action that each allows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from fem.seismic.body import FloorAction, Limits, LooseBody
from fem.seismic.method import MethodQuantity, MethodRow
from fem.seismic.sliding_rules import sliding_rows
from fem.seismic.static_rules import COMBINATIONS, both_directions_rows, element_rows, peak_rows, plateau_rows
from fem.seismic.velocity_rules import velocity_rows

#: factors on the action between which a capacity is looked for
SMALLEST_FACTOR, LARGEST_FACTOR = 0.01, 100.0
BISECTIONS = 30
#: a method, or methods that share their numbers, for one body: action of its floor -> rows
Method = Callable[[FloorAction], Sequence[MethodRow]]


@dataclass(frozen=True, kw_only=True)
class MethodCapacity:
    """The action at which the utilisation of a method is 1, over the action given: capacity over strength."""

    name: str
    quantity: MethodQuantity
    factor: float  #: SMALLEST_FACTOR where it is used up by less, LARGEST_FACTOR where not by that


def methods_of(
    body: LooseBody, limits: Limits, *, behaviour_factor: float, height_ratio: float | None = 0.0
) -> list[Method]:
    """Every method but the wind, for one body on one floor.

    Args:
        behaviour_factor: q of the plateau of the design spectrum; q = 1 stands beside it.
        height_ratio: z/H of the floor in its building; 0: on the ground; None: the motion of the floor is given, which
            no formula for elements on floors may raise again, and to which the plateau of the ground says nothing.
    """
    pairs = [partial(peak_rows, body, horizontal=h, vertical=v) for h, v in COMBINATIONS]
    elements = [
        partial(element_rows, body, height_ratio=height_ratio, period_ratio=period_ratio)
        for period_ratio in ((0.0, 1.0) if height_ratio else (0.0,))
        if height_ratio is not None
    ]
    plateaus = [
        partial(plateau_rows, body, behaviour_factor=q, height_ratio=height_ratio)
        for q in sorted({behaviour_factor, 1.0})[::-1]
        if height_ratio is not None
    ]
    return [
        *pairs,
        partial(both_directions_rows, body),
        *elements,
        *plateaus,
        partial(velocity_rows, body),
        partial(sliding_rows, body, limits),
    ]


def method_rows(methods: Sequence[Method], action: FloorAction) -> list[MethodRow]:
    """The rows of all methods for an action."""
    return [row for method in methods for row in method(action)]


def method_capacities(methods: Sequence[Method], action: FloorAction) -> list[MethodCapacity]:
    """For each row of `method_rows`, the factor on the action at which its utilisation reaches 1.

    A method that is fulfilled under a motion is fulfilled under a weaker one, so bisection finds it.
    """
    return [
        MethodCapacity(name=row.name, quantity=row.quantity, factor=_limit(method, k, action))
        for method in methods
        for k, row in enumerate(method(action))
    ]


def _limit(method: Method, row: int, action: FloorAction) -> float:
    def fulfilled(factor: float) -> bool:
        return method(action.scaled(factor))[row].fulfilled

    low, high = SMALLEST_FACTOR, LARGEST_FACTOR
    if not fulfilled(low):
        return low
    if fulfilled(high):
        return high
    for _ in range(BISECTIONS):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if fulfilled(middle) else (low, middle)
    return (low * high) ** 0.5
