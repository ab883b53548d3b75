"""An ensemble: points on one to three axes, and at each the draws of what is random."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np

from fem.batch.axes import Axis, point_of, shape_of
from fem.batch.case_maker import CaseMaker
from fem.batch.derived import FREE, Derived, number_of, with_derived
from fem.case.case import Case
from fem.case.uncertainty import Value
from fem.ensemble.distributions import RandomQuantity, Sampling, draw_shares

#: unknown inputs that the file does not vary: drawn over [uncertainty] of the case, or held
Unknown = Literal["drawn", "held"]


class Draw(NamedTuple):
    """One draw at a point."""

    cell: int  #: number of the point, the last axis the fastest
    number: int  #: at this point, replicate after replicate
    values: tuple[float, ...]  #: of the random quantities, relative ones as factors
    unknown: Mapping[str, Value] = {}  #: of the unknown inputs, by key


@dataclass(frozen=True, kw_only=True, eq=False)
class Ensemble:
    """What an ensemble file asks for."""

    name: str
    text: str  #: of the file
    title: str
    base: Case  #: with the keys of [set]
    axes: tuple[Axis, ...]
    random: tuple[RandomQuantity, ...]
    derived: tuple[Derived, ...]  #: in an order in which each follows what it refers to
    draws: int  #: at each point
    seed: int
    sampling: Sampling
    replicates: int  #: 1 for independent draws
    confidence: float
    probability: float  #: of overturning, to which the points are compared
    unknown_inputs: Unknown = "drawn"

    @property
    def count(self) -> int:
        """Points."""
        return math.prod(shape_of(self.axes))

    def point(self, cell: int) -> dict[str, Any]:
        """Values of the axes at a point, by key."""
        return point_of(self.axes, cell)

    def draws_at(self, cell: int) -> list[Draw]:
        """The draws of a point."""
        shares = draw_shares(
            self.sampling,
            seed=self.seed,
            cell=cell,
            dimensions=len(self.random),
            draws=self.draws,
            replicates=self.replicates,
        )
        values = np.column_stack([one.values(shares[:, k]) for k, one in enumerate(self.random)])
        return [Draw(cell, number, tuple(drawn)) for number, drawn in enumerate(values.tolist())]

    def case(self, draw: Draw) -> Case:
        """The case of a draw.

        Raises:
            CaseError: it cannot be used.
        """
        return self.case_of(self.point(draw.cell), draw.values, draw.unknown)

    def case_of(
        self, point: Mapping[str, Any], drawn: Sequence[float], unknown: Mapping[str, Value] | None = None
    ) -> Case:
        """The case at a point, of values drawn.

        Raises:
            CaseError: an expression has no value, a relative quantity has no value to scale, a bad case.
        """
        values = dict(point)
        for one, value in zip(self.random, drawn, strict=True):
            scale = number_of(one.key, values, self.base) if one.spread.relative else 1.0
            values[one.key] = value * scale
        values = with_derived(values, self.derived, self.base)
        keys = {key: value for key, value in values.items() if not key.startswith(FREE)}
        return self._make(keys | dict(unknown or {}))

    @cached_property
    def _make(self) -> CaseMaker:
        return CaseMaker(self.base)
