"""All simplified methods side by side, each with the factor on the action that it allows."""

from collections.abc import Callable, Sequence
from functools import partial

from fem.seismic.body import FloorAction, LooseBody
from fem.seismic.hand_rules import housner_row, newmark_row
from fem.seismic.method import MethodRow
from fem.seismic.static_rules import COMBINATIONS, both_directions_rows, element_rows, peak_rows, plateau_rows

#: factors on the action between which a capacity is looked for
SMALLEST_FACTOR, LARGEST_FACTOR = 0.01, 100.0
BISECTIONS = 30
#: a method, or methods that share their numbers, for one body: action of its floor -> rows
Method = Callable[[FloorAction], Sequence[MethodRow]]


def methods_of(
    body: LooseBody, slip_limit: float, *, behaviour_factor: float, height_ratio: float | None = 0.0
) -> list[Method]:
    """Every method but the wind, for one body on one floor.

    Args:
        slip_limit: the clearance [m].
        behaviour_factor: q of the plateau of the design spectrum; q = 1 stands beside it.
        height_ratio: z/H of the floor in its building; 0: on the ground; None: the motion of the floor is given, which
            no formula for elements on floors may raise again, and to which the plateau of the ground says nothing.
    """
    methods: list[Method] = [
        partial(peak_rows, body, horizontal=horizontal, vertical=vertical)
        for horizontal, vertical in COMBINATIONS
    ]
    methods.append(partial(both_directions_rows, body))
    if height_ratio is not None:
        methods += [
            partial(element_rows, body, height_ratio=height_ratio, period_ratio=period_ratio)
            for period_ratio in ((0.0, 1.0) if height_ratio else (0.0,))
        ]
        methods += [
            partial(plateau_rows, body, behaviour_factor=q, height_ratio=height_ratio)
            for q in sorted({behaviour_factor, 1.0})[::-1]
        ]
    return [*methods, lambda action: [housner_row(body, action), newmark_row(body, slip_limit, action)]]


def rows_with_factors(methods: Sequence[Method], action: FloorAction) -> list[tuple[MethodRow, float]]:
    """The rows of all methods, each with the factor on the action at which its utilisation reaches 1.

    A method that is fulfilled under a motion is fulfilled under a weaker one, so bisection finds it. The factor is
    `SMALLEST_FACTOR` where a method is used up by less, `LARGEST_FACTOR` where not by that.
    """
    return [(row, _factor(method, k, action)) for method in methods for k, row in enumerate(method(action))]


def _factor(method: Method, row: int, action: FloorAction) -> float:
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
