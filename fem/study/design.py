"""Keys that follow others by an expression, and the numbers that keys have where others vary."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, ValidationError

from fem.case.case import Case
from fem.case.overrides import keys_in_effect, with_overrides
from fem.case.tables.all_tables import TABLES
from fem.case.tables.input_ranges import Value
from fem.case.tables.links import ROWS
from fem.case.tables.quantities import Quantity
from fem.case.tables.table import CaseTable
from fem.case.tables.unknown_inputs import INPUTS, ranges_of
from fem.case.uncertainty import as_changed, drawn_values
from fem.case.validation import CaseError, known_keys
from fem.runtime.expressions import Expression, ExpressionError, parse_expression
from fem.study.axes import MOTION_FILE, Axis, AxisError, point_of, shape_of, with_following
from fem.study.containers import PenaltyCache
from fem.study.draws import RandomChoice, RandomQuantity, Sampling, draw_shares, held_inputs
from fem.study.perturbation import Perturbation

FREE = "free."  #: begins the name of a variable that is no key of a case; derived keys refer to it


@dataclass(frozen=True, kw_only=True)
class Derived:
    """A key that follows others."""

    key: str  #: dotted
    expression: Expression


def read_derived(
    content: Mapping[str, Any],
    varied: Collection[str],
    check_key: Callable[[str], object],
    check_reference: Callable[[str], object],
) -> tuple[Derived, ...]:
    """The table [derived] of a study, in an order in which each key follows those it refers to.

    Args:
        content: of the table.
        varied: keys that vary already.
        check_key, check_reference: raise an `AxisError` for a key that cannot follow, or be referred to.

    Raises:
        CaseError: with the key and the reason.
    """
    expressions: dict[str, Expression] = {}
    for key, text in content.items():
        try:
            if key in varied:
                raise AxisError("varies already; it cannot follow another key as well")
            check_key(key)
            if not isinstance(text, str):
                raise AxisError(
                    f"must be an expression in quotes, got {text!r}; a fixed value goes under [set]"
                )
            expressions[key] = parse_expression(text)
        except (AxisError, ExpressionError) as error:
            raise CaseError(f"[derived] {key!r} {error}") from None
    for key, expression in expressions.items():
        for name in sorted(expression.keys - expressions.keys()):
            try:
                check_reference(name)
            except AxisError as error:
                raise CaseError(f"[derived] {key!r} refers to {name!r}, which {error}") from None
    return tuple(Derived(key=key, expression=expressions[key]) for key in _in_order(expressions))


def with_derived(values: Mapping[str, Any], derived: Iterable[Derived], base: Case) -> dict[str, Any]:
    """Values by key, those of the derived keys added.

    Raises:
        CaseError: an expression has no value.
    """
    complete = dict(values)
    for quantity in derived:
        known = {key: number_of(key, complete, base) for key in quantity.expression.keys}
        try:
            value = quantity.expression.value(known)
        except ExpressionError as error:
            raise CaseError(f"[derived] {quantity.key} {error}") from None
        complete[quantity.key] = int(value) if quantity.key in _WHOLE_KEYS and value == int(value) else value
    return complete


def number_of(key: str, values: Mapping[str, Any], base: Case) -> float:
    """The number of a key: set in `values`, given in the base case, or a default.

    Raises:
        CaseError: it has none.
    """
    number = float(values[key]) if key in values else value_in(base, key, values)
    if number is None:
        raise CaseError(f"{key!r} has no number; set it under [set], or let it vary")
    return number


def value_in(base: Case, key: str, values: Mapping[str, Any]) -> float | None:
    """The number that a key has in a case where others are set; None if it has none.

    A default that follows another key of its table (`mu_kinetic` that of `mu_static`) follows it here too.
    """
    (key,) = keys_in_effect({key: None}, base.kinds)
    table, dot, name = key.rpartition(".")
    if not dot:
        return _as_number(base.resolved().get(name))
    if table not in TABLES:
        return None
    content = getattr(base, table) or TABLES[table]()
    if name in content.model_fields_set:
        return _as_number(getattr(content, name))
    own = content.model_dump() | {
        k.rpartition(".")[2]: v for k, v in values.items() if k.startswith(f"{table}.")
    }
    return _as_number(
        known_keys(TABLES[table])[name].get_default(call_default_factory=True, validated_data=own)
    )


def _in_order(derived: Mapping[str, Expression]) -> list[str]:
    """The derived keys so that each stands behind those it refers to.

    Raises:
        CaseError: some refer to one another in a circle.
    """
    done: list[str] = []
    while len(done) < len(derived):
        left = {key: expression for key, expression in derived.items() if key not in done}
        ready = [key for key, expression in left.items() if not expression.keys & left.keys()]
        if not ready:
            own = [key for key, expression in left.items() if key in expression.keys]
            circle = f"{own[0]} refers to itself" if own else f"{' and '.join(left)} refer to one another"
            raise CaseError(f"[derived] {circle}; let one follow an axis, or set it under [set]")
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


class CaseMaker:
    """Makes `base.with_values(values)`, at a tenth of the cost.

    Only the tables that change and the rules of the whole case are checked again; a case that breaks one is made the
    long way, which names the error.
    """

    def __init__(self, base: Case) -> None:
        self.base = base
        self._kinds = base.kinds
        #: by the keys that are set: what does not change, and the content of the tables that do
        self._templates: dict[tuple[str, ...], tuple[dict[str, Any], dict[str, dict[str, Any]]]] = {}

    def __call__(self, values: Mapping[str, Any]) -> Case:
        """The base with dotted keys set; alternatives are replaced.

        Raises:
            CaseError: as for a case file.
        """
        given = values
        values = keys_in_effect(values, self._kinds)
        keys = tuple(values)
        if any(key.rpartition(".")[0] in ROWS for key in keys):  # all rows of a table change
            return self.base.with_values(given)
        if keys not in self._templates:
            self._templates[keys] = self._template(values)
        fixed, touched = self._templates[keys]
        heading: dict[str, Any] = {}
        content = {name: dict(given) for name, given in touched.items()}
        for dotted, value in values.items():
            table, _, key = dotted.rpartition(".")
            (content[table] if table else heading)[key] = value
        try:
            tables = {name: TABLES[name].model_validate(given) for name, given in content.items()}
            return Case.model_validate(fixed | heading | tables).from_origin(self.base.origin_with(given))
        except ValidationError:
            return self.base.with_values(given)

    def _template(self, values: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        data = with_overrides(self.base.given(), values)
        names = {key.rpartition(".")[0] for key in values} - {""}
        fixed = {key: value for key, value in data.items() if key not in TABLES and key not in ROWS}
        fixed |= {name: rows for name in ROWS if (rows := getattr(self.base, name))}
        fixed |= {name: getattr(self.base, name) for name in TABLES if name not in names}
        return fixed, {name: data[name] for name in names}


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
        return with_derived(with_following(self.axes, point), self.derived, self.base)

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


STREAM = 1  #: of random numbers


class UnknownInputs:
    """The unknown inputs of an ensemble, and their values in each draw."""

    def __init__(self, ensemble: Ensemble) -> None:
        self._ensemble = ensemble
        self._penalties = PenaltyCache()
        cases = list(_cases(ensemble))
        varied = {axis.key for axis in ensemble.axes} | {quantity.key for quantity in ensemble.random}
        fixed = varied | {derived.key for derived in ensemble.derived}
        ranges = (interval for case in cases for interval in ranges_of(case, self._penalties.of(case)))
        drawn = {interval.key for interval in ranges if interval.drawn is not None} - fixed
        #: keys of the inputs that are drawn
        self.keys = tuple(key for key in INPUTS if key in drawn) if ensemble.unknown_inputs == "drawn" else ()
        #: what is held fixed of the others, in words
        self.held = held_inputs(cases, varied | set(self.keys))

    def draws_at(self, cell: int) -> list[Draw]:
        """The draws of a point, with the values of the unknown inputs."""
        ensemble = self._ensemble
        draws = ensemble.draws_at(cell)
        if not self.keys:
            return draws
        shares = draw_shares(
            ensemble.sampling,
            seed=ensemble.seed,
            cell=cell,
            dimensions=len(self.keys),
            draws=ensemble.draws,
            replicates=ensemble.replicates,
            stream=STREAM,
        )
        return [
            draw._replace(unknown=self._values(draw, row))
            for draw, row in zip(draws, shares.tolist(), strict=True)
        ]

    def _values(self, draw: Draw, shares: list[float]) -> dict[str, Value]:
        """Values at these shares of the ranges that a draw has; empty for a draw that cannot be made."""
        try:
            case = self._ensemble.case(draw)
            share = dict(zip(self.keys, shares, strict=True))
            ranges = ranges_of(case, self._penalties.of(case))
        except (CaseError, ValueError):
            return {}
        drawn = [interval for interval in ranges if interval.key in share]
        return drawn_values(drawn, [share[interval.key] for interval in drawn])


def _cases(ensemble: Ensemble) -> Iterator[Case]:
    """The cases in the middle and at the ends of all distributions, at the ends of the axes, those that can be made."""
    corners = product(*((axis.values[0], axis.values[-1]) for axis in ensemble.axes))
    shares = np.array([0.5, 0.0, 1.0])
    drawn = list(zip(*(quantity.values(shares) for quantity in ensemble.random), strict=True))
    for corner, values in product(corners, drawn):
        with suppress(CaseError):
            point = {axis.key: value for axis, value in zip(ensemble.axes, corner, strict=True)}
            yield ensemble.case_of(point, values)
