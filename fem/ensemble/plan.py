"""An ensemble: points on one to three axes, and at each the draws of what is random."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple, Self

import numpy as np

from fem.batch.axes import MOTION_FILE, Axis, point_of, shape_of, with_following
from fem.batch.case_maker import CaseMaker
from fem.batch.derived import FREE, Derived, number_of, with_derived
from fem.case.case import Case
from fem.case.tables.input_ranges import Value
from fem.case.uncertainty import as_changed
from fem.ensemble.distributions import RandomChoice, RandomQuantity, Sampling, draw_shares

#: unknown inputs that the file does not vary: drawn over [uncertainty] of the case, or held
Unknown = Literal["drawn", "held"]


class Draw(NamedTuple):
    """One draw at a point."""

    cell: int  #: number of the point, the last axis the fastest
    number: int  #: at this point, replicate after replicate
    values: tuple[Any, ...]  #: of the random quantities, relative ones as factors
    unknown: Mapping[str, Value] = {}  #: of the unknown inputs, by key
    following: Mapping[str, str | None] = {}  #: keys that its motion sets, of a set


def sets_among(random: Iterable[RandomQuantity | RandomChoice]) -> list[Axis]:
    """The set of motions among what is random, as a list of one or none."""
    choices = (quantity for quantity in random if isinstance(quantity, RandomChoice))
    return [choice.axis for choice in choices if choice.key == MOTION_FILE]


@dataclass(frozen=True, kw_only=True, eq=False)
class Ensemble:
    """What an ensemble file asks for."""

    name: str
    text: str  #: of the file
    title: str
    base: Case  #: with the keys of [set]
    axes: tuple[Axis, ...]
    random: tuple[RandomQuantity | RandomChoice, ...]
    derived: tuple[Derived, ...]  #: in an order in which each follows what it refers to
    draws: int  #: at each point
    seed: int
    sampling: Sampling
    replicates: int  #: 1 for independent draws; of a set of motions one for each
    confidence: float
    probability: float  #: of overturning, to which the points are compared
    unknown_inputs: Unknown = "drawn"
    limit_slip_m: float | None = None  #: beyond which a draw does not stand
    copy_motions: bool | None = None  #: into the results; None: those of small sets

    @property
    def count(self) -> int:
        """Points."""
        return math.prod(shape_of(self.axes))

    def point(self, cell: int) -> dict[str, Any]:
        """Values of the axes at a point, by key."""
        return point_of(self.axes, cell)

    @property
    def motions(self) -> Axis | None:
        """The set of motions that are drawn; None where there is one motion."""
        return next(iter(sets_among(self.random)), None)

    def draws_at(self, cell: int) -> list[Draw]:
        """The draws of a point; each motion of a set is drawn equally often, and is a replicate."""
        spread = [quantity for quantity in self.random if quantity.key != MOTION_FILE]
        shares = np.empty((self.draws, 0))
        if spread:
            shares = draw_shares(
                self.sampling,
                seed=self.seed,
                cell=cell,
                dimensions=len(spread),
                draws=self.draws,
                replicates=self.replicates,
            )
        columns: dict[str, Sequence[Any]] = {
            quantity.key: np.asarray(quantity.values(shares[:, k]), dtype=object).tolist()
            for k, quantity in enumerate(spread)
        }
        each, following = self.draws // self.replicates, [dict[str, str | None]()] * self.replicates
        if self.motions is not None:
            columns[MOTION_FILE] = np.repeat(self.motions.values, each).tolist()
            keys, rows = self.motions.following, zip(*self.motions.following.values(), strict=True)
            following = [dict(zip(keys, row, strict=True)) for row in rows] or following
        draws = zip(*(columns[quantity.key] for quantity in self.random), strict=True)
        return [
            Draw(cell, number, drawn, following=following[number // each])
            for number, drawn in enumerate(draws)
        ]

    def case(self, draw: Draw) -> Case:
        """The case of a draw.

        Raises:
            CaseError: it cannot be used.
        """
        following = {key: value for key, value in draw.following.items() if value is not None}
        return self.case_of(self.point(draw.cell) | following, draw.values, draw.unknown)

    @property
    def of_draws(self) -> Self:
        """The ensemble without text and list of motions: small enough to be sent with every task."""
        random = tuple(
            replace(quantity, axis=replace(quantity.axis, values=(), following={}))
            if isinstance(quantity, RandomChoice) and quantity.key == MOTION_FILE
            else quantity
            for quantity in self.random
        )
        return replace(self, random=random, text="")

    def case_of(
        self, point: Mapping[str, Any], drawn: Sequence[Any], unknown: Mapping[str, Value] | None = None
    ) -> Case:
        """The case at a point, of values drawn.

        Raises:
            CaseError: an expression has no value, a relative quantity has no value to scale, a bad case.
        """
        values = dict(point)
        for quantity, value in zip(self.random, drawn, strict=True):
            if isinstance(quantity, RandomChoice):
                values |= with_following([quantity.axis], {quantity.key: value})
            else:
                scale = number_of(quantity.key, values, self.base) if quantity.relative else 1.0
                values[quantity.key] = value * scale
        values = with_derived(values, self.derived, self.base)
        keys = {key: value for key, value in values.items() if not key.startswith(FREE)}
        if unknown and keys.get("container.joints", self.base.container.joints) == "loose":
            unknown = as_changed(self._make(keys), unknown)
        return self._make(keys | dict(unknown or {}))

    @cached_property
    def _make(self) -> CaseMaker:
        return CaseMaker(self.base)
