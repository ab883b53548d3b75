"""A sweep: the product of its axes over one base case, cell by cell.

Cells are numbered from 0 in the order of the axes, the last one fastest.
"""

import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Annotated, Any, NamedTuple

from pydantic import Field

from fem.batch.axes import Axis, point_of, shape_of, with_following
from fem.batch.case_maker import CaseMaker
from fem.batch.derived import FREE, Derived, with_derived
from fem.case.case import Case
from fem.case.tables.quantities import Quantity
from fem.case.tables.table import CaseTable
from fem.case.validation import CaseError
from fem.sweep.perturbation import Perturbation

#: tables and keys on which the container depends, or how it is computed: see `container_cache.container_key`
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


class MapChoice(CaseTable):
    """Which axes span the maps."""

    x: str | None = Field(default=None, description="key of an axis; default: one with the most values")
    y: str | None = Field(default=None, description="key of another axis")
    fixed: dict[str, Any] = Field(
        default={}, description="values at which further axes are held; the others have a panel each"
    )


RESOLUTION = Quantity(above=0.0, most=1.0, advice="0.01 is one per cent")


class Threshold(CaseTable):
    """Along which axis changes of outcome are located, and how precisely."""

    axis: str = Field(description="the key of one of the axes", examples=["motion.peak_acceleration_m_s2"])
    resolution: Annotated[float, RESOLUTION] = Field(
        default=0.01, description="largest width of a bracket, relative to the value"
    )
    inner: Annotated[int, Quantity(least=1, most=100)] = Field(
        default=3, description="values tried within a bracket at a time"
    )


class CopyItem(NamedTuple):
    """A copy of a cell."""

    cell: int
    number: int  #: of the copy
    values: Mapping[str, Any]  #: that make its case of that of the cell
    change: Mapping[str, Any]  #: what it changes, for the log


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
    limit_slip_m: float | None = None  #: beyond which a cell does not stand in the answer
    margin: bool = False  #: find the factor on the motion at which each cell overturns first

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of each axis."""
        return shape_of(self.axes)

    @property
    def count(self) -> int:
        """Cells."""
        return math.prod(self.shape)

    def point(self, cell: int) -> dict[str, Any]:
        """Values of the axes in a cell, by key."""
        return point_of(self.axes, cell)

    def values(self, point: Mapping[str, Any]) -> dict[str, Any]:
        """All keys that a point on the axes sets, derived ones included.

        Raises:
            CaseError: an expression has no value there.
        """
        values = with_derived(with_following(self.axes, point), self.derived, self.base)
        return {key: value for key, value in values.items() if not key.startswith(FREE)}

    def model_of(self, cell: int) -> str:
        """The model of a cell."""
        return str(self.point(cell).get("solver.model", self.base.solver.model))

    def case_at(self, point: Mapping[str, Any], more: Mapping[str, Any] | None = None) -> Case:
        """The case at a point on the axes, with further keys set.

        Raises:
            CaseError: it cannot be used.
        """
        return self._make(self.values(point) | dict(more or {}))

    def case(self, cell: int) -> Case:
        """The case of a cell."""
        return self.case_at(self.point(cell))

    def ends(self) -> list[Case]:
        """The cases at the ends of each axis, those that can be made."""
        cases = []
        for corner in product(*((axis.values[0], axis.values[-1]) for axis in self.axes)):
            with suppress(CaseError):
                cases.append(self.case_at(dict(zip((axis.key for axis in self.axes), corner, strict=True))))
        return cases

    def copy_case(self, item: CopyItem) -> Case:
        """The case of a copy of a cell."""
        return self.case_at(self.point(item.cell), item.values)

    def tried_case(self, item: tuple[int, float]) -> Case:
        """The case between cells that a threshold tries: a cell of the line, and the value on the axis."""
        cell, value = item
        return self.case_at(self.point(cell) | {self.threshold_axis.key: value})

    @property
    def threshold_axis(self) -> Axis:
        """The axis along which changes of outcome are located; only where that is asked for."""
        assert self.threshold is not None
        return next(axis for axis in self.axes if axis.key == self.threshold.axis)

    def by_container(self, cells: Iterable[int]) -> list[int]:
        """The cells in an order in which those of one container are neighbours."""
        return sorted(cells, key=lambda cell: (self.container_of(cell), cell))

    def container_of(self, cell: int) -> str:
        """Equal for cells that have the same container."""
        if not self._varies_container:
            return ""
        values = self.point(cell)
        with suppress(CaseError):  # a derived key without a value: the row will have the reason
            values = self.values(values)
        return repr([value for key, value in values.items() if key.startswith(OF_THE_CONTAINER)])

    @cached_property
    def _varies_container(self) -> bool:
        moving = {axis.key for axis in self.axes} | {quantity.key for quantity in self.derived}
        return any(key.startswith(OF_THE_CONTAINER) for key in moving)

    @cached_property
    def _make(self) -> CaseMaker:
        return CaseMaker(self.base.without_fields())
