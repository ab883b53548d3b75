"""The changed cases that try the unknown inputs of a case (`unknown_inputs`).

A run repeats itself over these changes (its band); a sweep takes its perturbed copies from them. The numerics are no
input and are always tried, ten times tighter. Friction between loose boxes keeps what the case had where that of the
floor changes (`as_changed`).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import permutations
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from fem.case.case import Case
from fem.case.tables import input_ranges as keys
from fem.case.tables import quantities as q
from fem.case.tables.input_ranges import InputRange, Value, short
from fem.case.tables.links import ROWS
from fem.case.tables.unknown_inputs import QUANTITIES, other_patch, ranges_of

#: static and kinetic friction of the same surfaces
FRICTIONS = ((keys.MU_STATIC, keys.MU_KINETIC), (keys.JOINTS_MU_STATIC, keys.JOINTS_MU_KINETIC))
TIGHTER = 0.1  #: energy tolerance over that of the case
#: stiffness over that of the case at which a flat base must still open, or it does so by softness
STIFF_FLOOR = 30.0
SWEEPS = 5  #: over all pairs of inputs, to remove their correlation


@dataclass(frozen=True, kw_only=True)
class InputChange:
    """A changed case: what one member of a band or one copy of a cell does differently."""

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
        """The change by its keys, the same for the same change."""
        return ", ".join(
            f"{key} = {value:.4g}" if isinstance(value, float) else f'{key} = "{value}"'
            for key, value in self.values.items()
        )


def all_changes(
    case: Case, penalty: float | None, draws: int | None = None
) -> tuple[tuple[InputChange, ...], tuple[InputChange, ...], tuple[InputChange, ...]]:
    """All that is tried of a case, in three parts.

    One input changed at a time, to each end of its range and between, and the numerics ten times tighter. The pairs
    that matter: a smaller fall of friction, half way, that is also a slower one. All inputs drawn at once from their
    ranges, by a Latin hypercube; there the numerics stay as they are.

    Args:
        case, penalty: as for `ranges_of`.
        draws: how many; None: as the case says.
    """
    ranges = ranges_of(case, penalty)
    singles = [
        InputChange(
            kind="one", values={span.key: value}, share=span.share(value) if isinstance(value, float) else 1.0
        )
        for span in ranges
        if span.alone
        for value in (*span.between, *span.ends)
    ]
    tolerance = max(TIGHTER * case.solver.energy_tolerance, q.ENERGY_TOLERANCE.least or 0.0)
    if tolerance < case.solver.energy_tolerance:
        singles.append(InputChange(kind="one", values={keys.TOLERANCE: short(tolerance)}, share=1.0))
    by_key, pairs = {span.key: span for span in ranges}, []
    if keys.MU_KINETIC in by_key and (drawn := by_key[keys.MU_KINETIC].drawn) is not None:
        middle = short(float(drawn(0.5)))
        if middle < case.contact.mu_static:  # at mu_kinetic = mu_static nothing falls
            pairs = [
                InputChange(
                    kind="pair", values={keys.MU_KINETIC: middle, key: by_key[key].ends[-1]}, share=1.0
                )
                for key in (keys.WEAKENING, keys.STRIBECK)
                if key in by_key
            ]
    spans = [span for span in ranges if span.drawn is not None]
    count = case.uncertainty.draws if draws is None else draws
    places = latin_hypercube(count, len(spans)).tolist() if spans else []
    return (
        tuple(singles),
        tuple(pairs),
        tuple(
            InputChange(kind="draw", values=drawn_values(spans, row), share=1.0, place=tuple(row))
            for row in places
        ),
    )


def drawn_values(ranges: Sequence[InputRange], places: Sequence[float]) -> dict[str, Value]:
    """The values at places from 0 to 1 in these ranges, by key.

    A range of kinetic friction holds for the static friction of the case, and scales with it.
    """
    values = {span.key: span.drawn(place) for span, place in zip(ranges, places, strict=True) if span.drawn}
    own = {span.key: span.own for span in ranges}
    for static, kinetic in FRICTIONS:
        if static in values and kinetic in values:
            share = float(values[static]) / float(own[static])
            values[kinetic] = short(share * float(values[kinetic]))
    return values


def as_changed(case: Case, values: Mapping[str, Value]) -> dict[str, Any]:
    """The values that change a case, with those that follow from them.

    Where a static friction changes alone, the kinetic one keeps its share of it, and is never larger. Friction between
    loose boxes does not follow the floor's. A base that touches otherwise has another patch on a slab, and on a rigid
    floor another penalty, which is chosen for it. Where stops, ties or neighbours differ, all change in proportion.
    """
    changed: dict[str, Any] = {}
    for key, value in values.items():
        table, _, name = key.partition(".")
        rows = getattr(case, table) if table in ROWS else ()
        different = [getattr(row, name) for row in rows]
        if len({*different}) <= 1:
            changed[key] = value
            continue
        given = changed.get(table) or [row.model_dump(by_alias=True, exclude_unset=True) for row in rows]
        scaled = (short(number * float(value) / max(different)) for number in different)
        changed[table] = [row | {name: number} for row, number in zip(given, scaled, strict=True)]
    own = {f"contact.{key}": getattr(case.contact, key) for key in ("mu_static", "mu_kinetic")}
    if case.container.is_loose:
        joints = {f"joints.{key}": value for key, value in case.joint_friction.items()}
        own |= joints
        changed = {**joints, **changed}
    for static, kinetic in FRICTIONS:
        if static in own and (static in values or kinetic in values):
            limit = float(changed.get(static, own[static]))
            share = limit / own[static] if own[static] > 0.0 else 1.0
            follows = short(share * own[kinetic]) if kinetic not in values else float(values[kinetic])
            changed[kinetic] = min(follows, limit)
    if keys.SUPPORT in values and case.floor.is_slab:
        changed["floor.corner_patch_m"] = other_patch(case, str(values[keys.SUPPORT]))
    elif not values.keys().isdisjoint((keys.SUPPORT, keys.CAMBER)) and not case.floor.is_slab:
        changed.setdefault(keys.PENALTY, "auto")
    return changed


def stiff_floor(case: Case, penalty: float) -> InputChange:
    """A floor so stiff that a container on a flat base is a rigid block on a rigid floor; arguments as `ranges_of`."""
    own = case.floor.youngs_modulus_Pa
    key, value = (keys.PENALTY, penalty) if own is None else (keys.MODULUS, own)
    most = QUANTITIES[key].most or math.inf
    return InputChange(kind="floor", values={key: min(most, short(STIFF_FLOOR * value))}, share=1.0)


@cache
def latin_hypercube(count: int, dimensions: int) -> NDArray[np.float64]:
    """Points, each coordinate once in the middle of each of `count` cells, shape (count, dimensions).

    Always the same, with the correlation between coordinates removed from their ranks (Owen 1994): at most 0.04 is
    left for 20 inputs in 32 points. Not from `scipy.stats`, whose import takes as long as ten members of a band; the
    first points of Sobol's sequence would draw two inputs as one (0.99).
    """
    middle = 0.5 * (count - 1)
    ranks = np.random.default_rng(0).random((dimensions, count)).argsort(axis=1) - middle
    for first, second in list(permutations(range(dimensions), 2)) * (SWEEPS if count > dimensions else 0):
        shared = (ranks[first] @ ranks[second]) / (ranks[second] @ ranks[second])
        ranks[first] = (ranks[first] - shared * ranks[second]).argsort(kind="stable").argsort() - middle
    points: NDArray[np.float64] = (ranks.T + middle + 0.5) / count
    points.flags.writeable = False
    return points
