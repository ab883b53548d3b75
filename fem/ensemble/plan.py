"""An ensemble: points on one to three axes, and at each the draws of what is random."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fem.batch.axes import Axis
from fem.batch.case_maker import CaseMaker
from fem.batch.expressions import ExpressionError
from fem.case.case import Case, CaseError
from fem.ensemble.distributions import RandomQuantity, Sampling, draw_shares
from fem.runtime.arrays import FloatArray
from fem.sweep.plan import Derived, value_in

FREE = "free."  #: keys of no case: variables that derived keys refer to


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
    probability: float  #: of overturning by which the points are told apart

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def count(self) -> int:
        """Points."""
        return int(np.prod(self.shape))

    def point(self, cell: int) -> dict[str, Any]:
        """Values of the axes at a point, by key; the last axis is the fastest."""
        places = np.unravel_index(cell, self.shape)
        return {axis.key: axis.values[int(k)] for axis, k in zip(self.axes, places, strict=True)}

    def draw(self, cell: int) -> FloatArray:
        """What is drawn at a point, relative ones as factors, shape (draws, random quantities)."""
        shares = draw_shares(
            self.sampling,
            seed=self.seed,
            cell=cell,
            dimensions=len(self.random),
            draws=self.draws,
            replicates=self.replicates,
        )
        return np.column_stack([one.values(shares[:, k]) for k, one in enumerate(self.random)])

    def cases(self, cell: int) -> list[Case]:
        """The cases of a point, in the order of its draws.

        Raises:
            CaseError: one of them cannot be.
        """
        point = self.point(cell)
        return [self.case_of(point, drawn) for drawn in self.draw(cell)]

    def case_of(self, point: Mapping[str, Any], drawn: FloatArray) -> Case:
        """The case at a point with given draws.

        Raises:
            CaseError: it cannot be.
        """
        return self._make(self.values(point, drawn))

    def values(self, point: Mapping[str, Any], drawn: FloatArray) -> dict[str, Any]:
        """All keys of the case that a point and its draws set.

        Raises:
            CaseError: an expression has no value, or a relative quantity nothing to refer to.
        """
        values = dict(point)
        for one, value in zip(self.random, drawn, strict=True):
            values[one.key] = float(value) * (self._value_of(one.key, values) if one.spread.relative else 1.0)
        for derived in self.derived:
            known = {key: self._value_of(key, values) for key in derived.expression.keys}
            try:
                values[derived.key] = derived.expression.value(known)
            except ExpressionError as error:
                raise CaseError(f"[derived] {derived.key} {error}") from None
        return {key: value for key, value in values.items() if not key.startswith(FREE)}

    @cached_property
    def _make(self) -> CaseMaker:
        return CaseMaker(self.base)

    def _value_of(self, key: str, values: Mapping[str, Any]) -> float:
        if key in values:
            return float(values[key])
        found = None if key.startswith(FREE) else value_in(self.base, key, values)
        if found is None:
            raise CaseError(f"{key!r} has no number here; make it an axis, set it under [set], or draw it")
        return found
