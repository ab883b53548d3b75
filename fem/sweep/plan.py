"""A sweep: the product of its axes over one base case, cell by cell.

Cells are numbered from 0 in the order of the axes, the last one fastest.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import Field

from fem.batch.axes import Axis
from fem.batch.case_maker import CaseMaker
from fem.batch.expressions import Expression, ExpressionError
from fem.case.case import Case
from fem.case.tables import TABLES, CaseTable
from fem.case.validation import CaseError, known_keys
from fem.sweep.perturbation import Perturbation
from fem.sweep.threshold import Threshold

#: cells whose perturbed copies are remembered
REMEMBERED = 4096
#: tables and keys that make another container, or another way of computing it: see `running.container_key`
OF_THE_CONTAINER = (
    "gravity_m_s2",
    "container.",
    "support.",
    "solver.model",
    "solver.elastic_modes",
    "solver.element_size_m",
    "solver.order",
    "output.stop_when_overturned",
)


@dataclass(frozen=True, kw_only=True)
class Derived:
    """A key that follows the axes."""

    key: str  #: dotted
    expression: Expression


class MapChoice(CaseTable):
    """Which axes span the maps."""

    x: str | None = Field(default=None, description="key of an axis; default: one with the most values")
    y: str | None = Field(default=None, description="key of another axis")
    fixed: dict[str, Any] = Field(
        default={}, description="values at which further axes are held; the rest has a panel each"
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """What a sweep file asks for."""

    name: str  #: stem of the file, or name of the shipped sweep
    text: str  #: of the file
    title: str
    base: Case  #: with the keys of [set]
    axes: tuple[Axis, ...]
    derived: tuple[Derived, ...]  #: in an order in which each follows what it refers to
    perturbation: Perturbation
    threshold: Threshold | None
    maps: MapChoice

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def count(self) -> int:
        """Cells."""
        return math.prod(self.shape)

    @property
    def folder(self) -> Path:
        """Where mesh and motion files are looked for."""
        return self.base.folder

    def indices(self, cell: int) -> tuple[int, ...]:
        """Place of a cell on each axis."""
        places = []
        for size in reversed(self.shape):
            cell, place = divmod(cell, size)
            places.append(place)
        return tuple(reversed(places))

    def point(self, cell: int) -> dict[str, Any]:
        """Values of the axes in a cell, by key."""
        return {axis.key: axis.values[k] for axis, k in zip(self.axes, self.indices(cell), strict=True)}

    def values(self, point: Mapping[str, Any]) -> dict[str, Any]:
        """All keys that a point on the axes sets, derived ones included.

        Raises:
            CaseError: an expression has no value there.
        """
        values = dict(point)
        for one in self.derived:
            known = {key: self._value_of(key, values) for key in one.expression.keys}
            try:
                found = one.expression.value(known)
            except ExpressionError as error:
                raise CaseError(f"[derived] {one.key} {error}") from None
            values[one.key] = int(found) if one.key in _WHOLE_KEYS and found == int(found) else found
        return values

    def case_at(self, point: Mapping[str, Any], more: Mapping[str, Any] | None = None) -> Case:
        """The case at a point on the axes, with further keys set.

        Raises:
            CaseError: it cannot be used.
        """
        return self._make(self.values(point) | dict(more or {}))

    def case(self, cell: int) -> Case:
        """The case of a cell."""
        return self.case_at(self.point(cell))

    def member_changes(self, cell: int) -> list[dict[str, Any]]:
        """The keys that each perturbed copy of a cell sets besides."""
        found = self._changes.get(cell)
        if found is None:
            found = self.perturbation.members(self.case(cell))
            if len(self._changes) >= REMEMBERED:
                self._changes.clear()
            self._changes[cell] = found
        return found

    def member_case(self, item: tuple[int, int]) -> Case:
        """The case of a perturbed copy: cell and number of the copy."""
        cell, member = item
        return self.case_at(self.point(cell), self.member_changes(cell)[member])

    def tried_case(self, item: tuple[int, float]) -> Case:
        """The case between cells that a threshold tries: a cell of the line, and the value on the axis."""
        cell, value = item
        return self.case_at(self.point(cell) | {self.threshold_axis.key: value})

    @property
    def threshold_axis(self) -> Axis:
        """The axis along which changes of outcome are closed in on; only where that is asked for."""
        assert self.threshold is not None
        return next(axis for axis in self.axes if axis.key == self.threshold.axis)

    def by_container(self, cells: Iterable[int]) -> list[int]:
        """The cells in an order in which those of one container stand together."""
        moving = {axis.key for axis in self.axes} | {one.key for one in self.derived}
        if not any(key.startswith(OF_THE_CONTAINER) for key in moving):
            return sorted(cells)
        # A derived key of the container follows any axis: then the values themselves tell.
        own = [k for k, axis in enumerate(self.axes) if axis.key.startswith(OF_THE_CONTAINER)]
        if any(one.key.startswith(OF_THE_CONTAINER) for one in self.derived):
            return sorted(cells, key=lambda cell: (self._container_values(cell), cell))
        return sorted(cells, key=lambda cell: ([self.indices(cell)[k] for k in own], cell))

    def _container_values(self, cell: int) -> str:
        values = self.values(self.point(cell))
        return repr([value for key, value in values.items() if key.startswith(OF_THE_CONTAINER)])

    @cached_property
    def _changes(self) -> dict[int, list[dict[str, Any]]]:
        """Of the cells last asked for: each is asked for by every one of its copies."""
        return {}

    @cached_property
    def _make(self) -> CaseMaker:
        return CaseMaker(self.base.without_fields())

    def _value_of(self, key: str, values: Mapping[str, Any]) -> float:
        """Value of a key that an expression refers to: set here, given in the base, or a default."""
        if key in values:
            return float(values[key])
        found = value_in(self.base, key, values)
        if found is None:
            raise CaseError(f"[derived] refers to {key}, which has no value in the base case")
        return found


def value_in(base: Case, key: str, values: Mapping[str, Any]) -> float | None:
    """The number that a key has in a case where others are set; None if it has none.

    A default that follows another key of its table (`mu_kinetic` that of `mu_static`) follows it here too.
    """
    table, dot, name = key.rpartition(".")
    if not dot:
        return _as_number(base.resolved().get(name))
    model, content = TABLES[table], getattr(base, table)
    if name in content.model_fields_set:
        return _as_number(getattr(content, name))
    own = content.model_dump() | {
        k.rpartition(".")[2]: v for k, v in values.items() if k.startswith(f"{table}.")
    }
    return _as_number(known_keys(model)[name].get_default(call_default_factory=True, validated_data=own))


def in_order(derived: Mapping[str, Expression]) -> Sequence[str]:
    """The derived keys so that each stands behind those it refers to.

    Raises:
        CaseError: some refer to one another in a circle.
    """
    done: list[str] = []
    while len(done) < len(derived):
        ready = [
            key
            for key, expression in derived.items()
            if key not in done and not (expression.keys & derived.keys() - set(done))
        ]
        if not ready:
            circle = [key for key in derived if key not in done]
            if len(circle) == 1 or any(key in derived[key].keys for key in circle):
                own = next(key for key in circle if key in derived[key].keys)
                raise CaseError(
                    f"[derived] {own} refers to itself; let it follow an axis, or set it under [set]"
                )
            raise CaseError(f"[derived] {' and '.join(circle)} refer to one another; let one follow an axis")
        done += ready
    return done


def _as_number(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None


_WHOLE_KEYS = frozenset(
    f"{table}.{name}"
    for table, model in TABLES.items()
    for name, field in known_keys(model).items()
    if field.annotation is int
)
