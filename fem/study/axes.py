"""The axes of a study: each is one key of a case and its values."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any, Literal, TypeVar, get_args

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, Strict, ValidationError
from pydantic.fields import FieldInfo

from fem.case.tables.all_tables import TABLES
from fem.case.tables.links import ROWS
from fem.case.tables.quantities import Quantity, with_unit
from fem.case.validation import TOP, choices_of, did_you_mean, known_keys, quantity_of, requirement_of
from fem.records.units import STANDARD_GRAVITY
from fem.results.json_block import JsonBlock
from fem.runtime.units import plain_number

#: keys that do not change a result, and why
NO_AXIS = {
    "schema": "it says how a file is read",
    "title": "it changes no result",
    "document": "it changes no result",
    "uncertainty": "it changes the band of a run, not what happens",
    "output.fields_s": "no fields are kept",
}
MOST_VALUES = 1_000_000
#: the key whose values are motions: files, or pairs of a horizontal and a vertical file
MOTION_FILE = "motion.file"
VERTICAL_FILE = "vertical.file"
#: keys whose values of one magnitude are the signs of a motion
SIGNS = ("motion.scale", "vertical.scale")
A_PAIR = 'a pair is ["horizontal file", "vertical file"]'

ModelT = TypeVar("ModelT", bound=BaseModel)


class Range(BaseModel):
    """`{ from = .., to = .., count = .., scale = "log" }` of a sweep file."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)

    lowest: float = Field(alias="from", description="first value")
    highest: float = Field(alias="to", description="last value")
    count: Annotated[int, Strict()] = Field(description="how many values, both ends included")
    scale: Literal["linear", "log"] = Field(default="linear", description='spacing, "linear" | "log"')


@dataclass(frozen=True, kw_only=True)
class Axis(JsonBlock):
    """A key and its values, in the order of the file."""

    key: str  #: dotted
    values: tuple[float | str | bool, ...]
    scale: str = "list"  #: linear | log | list
    unit: str = ""  #: of the key
    #: further keys that each value sets, and what to; None: not set
    following: dict[str, tuple[str | None, ...]] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """As JSON types; without a scale and following keys where there are none."""
        return {key: value for key, value in super().to_json().items() if value or key == "unit"}

    @cached_property
    def numbers(self) -> list[float]:
        """Those of its values that are no words."""
        return [value for value in self.values if not isinstance(value, bool | str)]

    @cached_property
    def is_numeric(self) -> bool:
        """Whether its values are rising numbers, so that points have neighbours along it."""
        return len(self.numbers) == len(self.values) > 1 and bool(np.all(np.diff(self.numbers) > 0.0))


def shape_of(axes: Sequence[Axis]) -> tuple[int, ...]:
    """Number of values of each axis; points on the axes are numbered with the last one the fastest."""
    return tuple(len(axis.values) for axis in axes)


def point_of(axes: Sequence[Axis], number: int) -> dict[str, Any]:
    """Values of the axes at a point, by key."""
    places = np.unravel_index(number, shape_of(axes))
    return {axis.key: axis.values[k] for axis, k in zip(axes, places, strict=True)}


def lines_along(axes: Sequence[Axis], axis: Axis) -> list[list[int]]:
    """The numbers of points that differ in their value of one axis alone, line by line."""
    shape = shape_of(axes)
    numbers = np.moveaxis(np.arange(math.prod(shape)).reshape(shape), list(axes).index(axis), -1)
    lines: list[list[int]] = numbers.reshape(-1, len(axis.values)).tolist()
    return lines


def with_following(axes: Iterable[Axis], point: Mapping[str, Any]) -> dict[str, Any]:
    """Values at a point, those of the keys that follow the axes added."""
    values = dict(point)
    for axis in axes:
        if axis.following:
            k = axis.values.index(point[axis.key])
            values |= {key: column[k] for key, column in axis.following.items() if column[k] is not None}
    return values


def set_axis(axes: Iterable[Axis]) -> Axis | None:
    """The axis that holds a set of motions; None without one."""
    return next((axis for axis in axes if axis.key == MOTION_FILE), None)


def first_motion(axis: Axis | None) -> dict[str, Any]:
    """The keys that set the first motion of a set, the first pair if there is one; none without a set."""
    if axis is None:
        return {}
    verticals = axis.following.get(VERTICAL_FILE, ())
    first = next((k for k, name in enumerate(verticals) if name), 0)
    return with_following([axis], {axis.key: axis.values[first]})


class AxisError(ValueError):
    """A key or an axis that cannot be used; the message is the reason, without the key."""


def check_varied(key: str) -> FieldInfo:
    """The field of a case that a dotted key names; AxisError for an unknown one, or one that may not vary."""
    field = field_of(key)
    for fixed in (key, key.partition(".")[0]):
        if fixed in NO_AXIS:
            raise AxisError(f"cannot vary: {NO_AXIS[fixed]}")
    return field


#: what the first part of a dotted key names; a key of [[stop]], [[tie]] or [[neighbour]] is that of all of them
NAMED = TABLES | ROWS


def field_of(key: str) -> FieldInfo:
    """The field of a case that a dotted key names; AxisError with the nearest one if no case has it."""
    table, dot, name = key.rpartition(".")
    if not dot:
        if name in TOP:
            return TOP[name]
        owners = [known for known, model in NAMED.items() if name in known_keys(model)]
        if owners:
            wanted = " or ".join(f"{owner}.{name}" for owner in owners)
            raise AxisError(f"is no key before the first table; write {wanted!r}")
        keys = [f"{known}.{field}" for known, model in NAMED.items() for field in known_keys(model)]
        raise AxisError(f"is no key of a case file{did_you_mean(name, [*TOP, *keys])}")
    if table not in NAMED:
        raise AxisError(
            f"names no table of a case file{did_you_mean(table, NAMED)} (known: {', '.join(NAMED)})"
        )
    fields = known_keys(NAMED[table])
    if name not in fields:
        raise AxisError(f"is no key of a case file{did_you_mean(name, fields)} (known: {', '.join(fields)})")
    return fields[name]


def read_axis(key: str, given: Any) -> Axis:
    """Read an axis: a list of values, or a range; AxisError with what is wrong."""
    field = check_varied(key)
    quantity = quantity_of(field.annotation, field.metadata)
    unit = quantity.unit if quantity else ""
    if key == MOTION_FILE:
        names, following = _read_motion_files(given)
        return Axis(key=key, values=names, following=following)
    values: tuple[Any, ...]
    scale = "list"
    if isinstance(given, list):
        if not given:
            raise AxisError("has no values: the list is empty; give one or more")
        if any(isinstance(value, list | dict) for value in given):
            raise AxisError("must be a list of single values, got lists or tables in it")
        if len(set(map(repr, given))) < len(given):
            twice = next(value for value in given if given.count(value) > 1)
            raise AxisError(f"has the value {twice!r} twice; leave one out")
        values = tuple(float(v) if isinstance(v, int) and not isinstance(v, bool) else v for v in given)
    elif isinstance(given, Mapping):
        values, scale = _spaced(given, quantity, unit)
    else:
        raise AxisError(
            f"must be a list or a range, got {with_unit(given, unit)}; "
            "for instance [0.2, 0.3] or { from = 1.0, to = 4.0, count = 13 }"
        )
    kinds = (field.annotation, *get_args(field.annotation))
    if any(kind is int or get_args(kind)[:1] == (int,) for kind in kinds):
        if broken := [value for value in values if isinstance(value, float) and not value.is_integer()]:
            way_out = "choose from, to and count so that the values are whole, or list them"
            raise AxisError(f"takes whole numbers, got {broken[0]!r}; {way_out}")
        values = tuple(int(value) if isinstance(value, float) else value for value in values)
    choices = choices_of(field.annotation) if quantity is None else ()
    for value in values:  # that the key can never have; rules between keys are checked with the case
        if choices and value not in choices:
            listed = " or ".join(f'"{choice}"' for choice in choices)
            raise AxisError(f"must be {listed}, got {value!r}{did_you_mean(value, choices)}")
        if quantity is None or value == "auto":
            continue
        if isinstance(value, bool | str):
            raise AxisError(f"must be a number{' in ' + unit if unit else ''}, got {value!r}")
        try:
            quantity.check(value)
        except ValueError as error:
            raise AxisError(str(error)) from None
    return Axis(key=key, values=values, scale=scale, unit=unit)


def _read_motion_files(given: Any) -> tuple[tuple[str, ...], dict[str, tuple[str | None, ...]]]:
    """Names, and pairs of a horizontal and a vertical file; the keys that go with each, none without a pair."""
    if not isinstance(given, list) or not given:
        raise AxisError(
            f'must be a list of files or pairs, such as ["a.at2", ["b_h.at2", "b_v.at2"]], got {given!r}'
        )
    pairs: list[tuple[str, str | None]] = []
    for entry in given:
        names = [entry] if isinstance(entry, str) and entry.strip() else entry
        if (
            not isinstance(names, list)
            or not 1 <= len(names) <= 2
            or not all(isinstance(name, str) for name in names)
        ):
            raise AxisError(f"must hold file names and pairs of file names, got {entry!r}; {A_PAIR}")
        horizontal, vertical = (*names, "")[:2]
        if not horizontal.strip():
            raise AxisError(f"has a vertical motion without a horizontal one, {entry!r}; {A_PAIR}")
        if isinstance(entry, list) and not vertical.strip():
            raise AxisError(f"has a pair without its vertical motion, {entry!r}; {A_PAIR}")
        pairs.append((horizontal, vertical or None))
    named = [name for horizontal, vertical in pairs for name in {horizontal, vertical} if name is not None]
    if twice := [name for name, count in Counter(named).items() if count > 1]:
        raise AxisError(
            f"names {twice[0]!r} twice; the motions of a set are of different files: leave one out"
        )
    following: dict[str, tuple[str | None, ...]] = {}
    if any(vertical for _, vertical in pairs):
        following["vertical.kind"] = tuple("table" if vertical else "none" for _, vertical in pairs)
        following[VERTICAL_FILE] = tuple(vertical for _, vertical in pairs)
    return tuple(horizontal for horizontal, _ in pairs), following


def read_inline(model: type[ModelT], given: Mapping[str, Any], example: str) -> ModelT:
    """An inline table of a study's file; AxisError with all that is wrong, and the example."""
    try:
        return model.model_validate(given)
    except ValidationError as error:
        known = ", ".join(field.alias or name for name, field in model.model_fields.items())
        reasons = []
        for detail in error.errors(include_url=False):
            name = str(detail["loc"][0])
            match detail["type"]:
                case "missing":
                    reasons.append(f"has no {name!r}")
                case "extra_forbidden":
                    reasons.append(f"has the unknown key {name!r} (known: {known})")
                case _:
                    reasons.append(f"{name} {requirement_of(detail)}, got {detail['input']!r}")
        raise AxisError(f"{'; '.join(reasons)}; {example}") from None


def _spaced(given: Mapping[str, Any], quantity: Quantity | None, unit: str) -> tuple[tuple[float, ...], str]:
    wanted = read_inline(Range, given, "a range is { from = 1.0, to = 4.0, count = 13 }")
    if quantity is None:
        raise AxisError("is not a number, so it has no range; list its values")
    low, high, count = wanted.lowest, wanted.highest, wanted.count
    if count < 2:
        raise AxisError(
            f"has an empty range: count must be at least 2, got {count}; for one value write [{low!r}]"
        )
    if count > MOST_VALUES:
        raise AxisError(f"has count = {count}; a range has at most {MOST_VALUES} values")
    if not low < high:
        raise AxisError(
            f"has an empty range: from = {with_unit(low, unit)} must be less than to = {with_unit(high, unit)}"
        )
    if wanted.scale == "linear":
        spaced = np.linspace(low, high, count)
    elif low <= 0.0:
        raise AxisError(
            f"cannot go through zero on a log scale: from = {with_unit(low, unit)}; "
            'begin above zero, or take scale = "linear"'
        )
    else:
        spaced = np.geomspace(low, high, count)
    # Fifteen digits: 0.30000000000000004 is 0.3, on every machine.
    return tuple(float(f"{value:.15g}") for value in spaced), wanted.scale


#: units in which people say the values of a key: from which value on, the unit, the factor
PEOPLE = {
    "m": ((0.1, "m", 1.0), (0.0, "mm", 1e3)),
    "N": ((1e3, "kN", 1e-3),),
    "Pa": ((1e9, "GPa", 1e-9), (1e6, "MPa", 1e-6)),
}


def axis_name(axis: Axis) -> str:
    """The name of a key: `motion.peak_acceleration_m_s2` is "peak acceleration"."""
    table, _, name = axis.key.rpartition(".")
    if axis.key == MOTION_FILE:
        return "motion"
    if name == "scale_to_m_s2":  # of a record
        name = "peak_acceleration_m_s2"
    name = name.removesuffix("_" + axis.unit.replace("/", "_").replace(" ", "_")).replace("_", " ")
    before = {"vertical": "vertical ", "joints": "joint "}.get(table, "")
    return f"{before}{name}"


def axis_label(axis: Axis) -> str:
    """The name of a key with its unit: "peak acceleration [m/s²]"."""
    unit = axis.unit.replace("s2", "s²").replace("m3", "m³") or "-"
    words = all(isinstance(value, bool | str) for value in axis.values)
    return axis_name(axis) + ("" if words else f" [{unit}]")


def in_words(axis: Axis, values: Sequence[Any], figures: int = 3, *, bare: bool = False) -> str:
    """Values on an axis in their usual unit, unless `bare`: "0.5 to 0.55 g", "steel, wood"."""
    if any(isinstance(value, bool | str) for value in values):
        return ", ".join(str(value) for value in values)
    unit, factor = unit_of_people(axis)
    words = " to ".join(plain_number(factor * value, figures) for value in values)
    return words if bare else f"{words} {unit}".strip()


def place_in_words(axes: Iterable[Axis], point: Mapping[str, Any]) -> str:
    """Where on some axes a point is: "mu static 0.3, width 1.1 m"."""
    return ", ".join(f"{axis_name(axis)} {in_words(axis, [point[axis.key]], 4)}" for axis in axes)


def unit_of_people(axis: Axis) -> tuple[str, float]:
    """The unit that `in_words` takes, and the factor from that of the key; it depends on the largest value."""
    largest = max(map(abs, axis.numbers), default=0.0)
    if axis.unit == "m/s2" and axis.key.startswith(("motion.", "vertical.")):
        return "g", 1.0 / STANDARD_GRAVITY
    for least, unit, factor in PEOPLE.get(axis.unit, ()):
        if largest >= least:
            return unit, factor
    return axis.unit, 1.0
