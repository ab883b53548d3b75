"""Results as strict JSON: a dataclass is written as an object and read back, with its fields as keys."""

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from enum import StrEnum
from functools import cache
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, ClassVar, Literal, Self, TypeVar, Union, get_args, get_origin, get_type_hints

from fem.runtime.terminal import one_line

#: types of JSON, and what messages call them
NAMED = {float: "number", int: "whole number", str: "text", bool: "truth value"}
IS_MISSING = "is missing"


def to_json(content: Mapping[str, Any]) -> str:
    """Strict JSON: numpy scalars and arrays as numbers and lists, nan and infinity as null."""
    return json.dumps(_as_json(content), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def _as_json(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _as_json(item) for key, item in value.items()}
    if hasattr(value, "tolist"):  # of numpy, which takes long to load
        return _as_json(value.tolist())
    if isinstance(value, str | Path):
        return str(value)
    if isinstance(value, Sequence | set | frozenset):
        return [_as_json(item) for item in (sorted(value) if isinstance(value, set | frozenset) else value)]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


class JsonBlock:
    """A dataclass that is written as a JSON object, with its fields as keys; `block[key]` is `block.key`."""

    #: keys that are left out where they are None, in place of null
    written_where_given: ClassVar[frozenset[str]] = frozenset()
    #: of fields that hold rows, or one, the types of their columns
    columns_of: ClassVar[Mapping[str, Mapping[str, Any]]] = {}
    #: of these columns, those that no row lacks; the others are None where one has no such key
    needed: ClassVar[frozenset[str]] = frozenset()

    @classmethod
    def from_json(cls, block: Mapping[str, Any]) -> Self:
        """Read a block; missing keys and null take the default, unknown keys are ignored.

        Raises:
            ValueError: the block is no table, a required key is missing, or one has a value of another type; with the
                key.
        """
        _require(isinstance(block, Mapping), "is no table")
        kind: Any = cls  # a dataclass, which the type checker does not know of this base
        readers = _readers(kind)
        named = [name for name in readers if block.get(name) is not None]
        given = {name: _within(name, readers[name], block[name]) for name in named}
        for field in fields(kind):
            optional = field.default is not field.default_factory  # both are missing of another
            _require(optional or field.name in given, IS_MISSING, field.name)
        return cls(**given)

    def __getitem__(self, key: str) -> Any:
        """A value by its key in the file; KeyError names the keys there are."""
        if key not in (known := _readers(type(self))):  # type: ignore[arg-type]  # a class can be hashed
            raise KeyError(f"no key {key!r}; known: {', '.join(known)}")
        return getattr(self, key)

    def get(self, key: str, default: Any = None) -> Any:
        """A value by its key in the file, or the default where there is no such key."""
        return getattr(self, key, default)

    def to_json(self) -> dict[str, Any]:
        """The block as JSON types, its keys in the order of the fields."""
        block = {field.name: _plain(getattr(self, field.name)) for field in fields(self)}  # type: ignore[arg-type]
        idle = self.written_where_given
        return {key: value for key, value in block.items() if value is not None or key not in idle}


def _plain(value: Any) -> Any:
    if isinstance(value, JsonBlock):
        return value.to_json()
    return [_plain(item) for item in value] if isinstance(value, tuple) else value


def _require(right: bool, what: str, key: str = "") -> None:
    if not right:
        raise _WrongValueError(key, what)


class _WrongValueError(ValueError):
    """A value that its key cannot have."""

    def __init__(self, key: str, what: str) -> None:
        super().__init__(f"{key} {what}")
        self.key, self.what = key, what


@cache
def _readers(kind: type[JsonBlock]) -> dict[str, Callable[[Any], Any]]:
    """For each field, what makes its value from JSON types."""
    hints = get_type_hints(kind)
    readers = {field.name: _reader(hints[field.name], _given(kind)) for field in fields(kind)}  # type: ignore[arg-type]
    for name, columns in kind.columns_of.items():
        row = _row(columns, kind.needed)
        readers[name] = row if get_origin(hints[name]) is dict else _listed(row)
    return readers


def _given(kind: type) -> dict[Any, Any]:
    """What the variables of generic bases stand for in a class."""
    given: dict[Any, Any] = {}
    for base in kind.__mro__:
        for generic in getattr(base, "__orig_bases__", ()):
            of = getattr(get_origin(generic), "__parameters__", ())
            given |= dict(zip(of, get_args(generic), strict=False)) if of else {}
    return given


def _row(columns: Mapping[str, Any], needed: frozenset[str]) -> Callable[[Any], Any]:
    """A row with typed columns, and others as they are."""
    numbers = tuple[float, ...]  # of a column with several
    hints = {name: numbers if kind is tuple else kind for name, kind in columns.items()}
    readers = {name: _reader(hint if name in needed else hint | None, {}) for name, hint in hints.items()}

    def read(value: Any) -> Any:
        _require(isinstance(value, dict), "is no table")
        return value | {
            name: _within(f".{name}", reader, value.get(name)) for name, reader in readers.items()
        }

    return read


def _reader(hint: Any, given: Mapping[Any, Any]) -> Callable[[Any], Any]:
    """What makes a value of a list, table or row from JSON types; given: what type variables stand for."""
    hint = given.get(hint, hint) if isinstance(hint, TypeVar) else hint
    read, may_lack = _of_type(hint, given), hint is Any or NoneType in get_args(hint)

    def present(value: Any) -> Any:
        _require(value is not None or may_lack, IS_MISSING)
        return None if value is None else read(value)

    return present


def _of_type(hint: Any, given: Mapping[Any, Any]) -> Callable[[Any], Any]:
    parts = [part for part in get_args(hint) if part is not NoneType]
    if get_origin(hint) in (UnionType, Union):
        return _reader(parts[0], given) if len(parts) == 1 else _scalar(tuple(parts))
    kind = get_origin(hint) or hint
    if kind is Literal:
        return _choice(parts)
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return _choice(kind)
    if isinstance(kind, type) and issubclass(kind, JsonBlock):
        return kind.from_json
    if kind is tuple:
        return _listed(_reader(parts[0], given), None if Ellipsis in parts else len(parts))
    if kind in (dict, Mapping):
        return _table(_reader(parts[0], given), _reader(parts[1], given))
    return _scalar((kind,)) if kind in NAMED else lambda value: value  # Any


def _choice(choices: Iterable[str]) -> Callable[[Any], Any]:
    """One of some words."""
    known = {str(choice): choice for choice in choices}

    def read(value: Any) -> Any:
        _require(isinstance(value, str) and value in known, f"is none of {', '.join(known)}")
        return known[value]

    return read


def _scalar(kinds: tuple[type, ...]) -> Callable[[Any], Any]:
    """A value of one of some types; a whole number is a number, and true is none."""
    taken = (*kinds, int) if float in kinds else kinds
    other = "is no " + " and no ".join(NAMED[kind] for kind in kinds)

    def read(value: Any) -> Any:
        _require(isinstance(value, taken) and (bool in kinds or not isinstance(value, bool)), other)
        return one_line(value) if isinstance(value, str) else value

    return read


def _listed(read: Callable[[Any], Any], count: int | None = None) -> Callable[[Any], Any]:
    """A list; of `count` items where that is given."""

    def items(values: Any) -> Any:
        _require(isinstance(values, list), "is no list")
        _require(count in (None, len(values)), f"is no list of {count} values")
        return tuple(_within(f"[{k}]", read, value) for k, value in enumerate(values))

    return items


def _table(read_key: Callable[[Any], Any], read: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def items(values: Any) -> Any:
        _require(isinstance(values, dict), "is no table")
        names = {key: _within(f".{one_line(key)}", read_key, key) for key in values}
        return {names[key]: _within(f".{names[key]}", read, value) for key, value in values.items()}

    return items


def _within(key: str, read: Callable[[Any], Any], value: Any) -> Any:
    """A value of a list or table, whose key is in the message."""
    try:
        return read(value)
    except _WrongValueError as error:
        inner = f".{error.key}" if error.key and error.key[0] not in ".[" else error.key
        raise _WrongValueError(key + inner, error.what) from None
