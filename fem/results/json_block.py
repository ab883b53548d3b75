"""A dataclass that is written as a JSON object and read back, with its fields as keys."""

from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache
from types import NoneType, UnionType
from typing import Any, ClassVar, Self, TypeVar, Union, get_args, get_origin, get_type_hints

from fem.runtime.terminal import one_line

#: types of JSON, and what messages call them
NAMED = {float: "number", int: "whole number", str: "text", bool: "truth value"}


class JsonBlock:
    """A dataclass that is written as a JSON object, with its fields as keys; `block[key]` is `block.key`."""

    #: keys that are left out where they are None, in place of null
    written_where_given: ClassVar[frozenset[str]] = frozenset()
    #: of fields that hold rows, the types of their columns
    columns_of: ClassVar[Mapping[str, Mapping[str, type]]] = {}

    @classmethod
    def from_json(cls, block: Mapping[str, Any]) -> Self:
        """Read a block; missing keys and null take the default, unknown keys are ignored.

        Raises:
            ValueError: the block is no table, a required key is missing, or one has a value of another type.
        """
        if not isinstance(block, Mapping):
            raise _WrongTypeError("", "table")
        try:
            readers = _readers(cls)  # type: ignore[arg-type]
            given = [name for name in readers if block.get(name) is not None]
            return cls(**{name: _within(name, readers[name], block[name]) for name in given})
        except TypeError as error:
            raise ValueError(f"cannot be read as {cls.__name__} ({error})") from None

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


class _WrongTypeError(ValueError):
    """A value of another type than its key has."""

    def __init__(self, key: str, what: str) -> None:
        super().__init__(f"{key} is no {what}")
        self.key, self.what = key, what


@cache
def _readers(kind: type[JsonBlock]) -> dict[str, Callable[[Any], Any]]:
    """For each field, what makes its value from JSON types."""
    hints = get_type_hints(kind)
    readers = {field.name: _reader(hints[field.name], _given(kind)) for field in fields(kind)}  # type: ignore[arg-type]
    return readers | {name: _listed(_row(columns)) for name, columns in kind.columns_of.items()}


def _given(kind: type) -> dict[Any, Any]:
    """What the variables of generic bases stand for in a class."""
    given: dict[Any, Any] = {}
    for base in kind.__mro__:
        for generic in getattr(base, "__orig_bases__", ()):
            of = getattr(get_origin(generic), "__parameters__", ())
            given |= dict(zip(of, get_args(generic), strict=False)) if of else {}
    return given


def _row(columns: Mapping[str, type]) -> Callable[[Any], Any]:
    """A row with typed columns, and others as they are."""
    readers = {name: _scalar((kind,)) for name, kind in columns.items()}

    def read(value: Any) -> Any:
        if not isinstance(value, dict):
            raise _WrongTypeError("", "table")
        given = ((name, reader) for name, reader in readers.items() if name in value)
        return value | {name: _within(f".{name}", reader, value[name]) for name, reader in given}

    return read


def _reader(hint: Any, given: Mapping[Any, Any]) -> Callable[[Any], Any]:
    """What makes a value from JSON types, where null is one of any type; given: what type variables stand for."""
    hint = given.get(hint, hint) if isinstance(hint, TypeVar) else hint
    parts = [part for part in get_args(hint) if part is not NoneType]
    if get_origin(hint) in (UnionType, Union):
        return _reader(parts[0], given) if len(parts) == 1 else _scalar(tuple(parts))
    kind = get_origin(hint) or hint
    if isinstance(kind, type) and issubclass(kind, JsonBlock):
        return kind.from_json
    if kind is tuple:
        return _listed(_reader(parts[0], given), None if Ellipsis in parts else len(parts))
    if kind is dict:
        return _table(_reader(parts[1], given))
    return _scalar((kind,)) if kind in NAMED else lambda value: value


def _scalar(kinds: tuple[type, ...]) -> Callable[[Any], Any]:
    """A value of one of some types; a whole number is a number, and true is none."""
    if not set(kinds) <= set(NAMED):
        return lambda value: value
    taken = (*kinds, int) if float in kinds else kinds

    def read(value: Any) -> Any:
        right = isinstance(value, taken) and (not isinstance(value, bool) or bool in kinds)
        if value is not None and not right:
            raise _WrongTypeError("", " and no ".join(NAMED[kind] for kind in kinds))
        return one_line(value) if isinstance(value, str) else value

    return read


def _listed(read: Callable[[Any], Any], count: int | None = None) -> Callable[[Any], Any]:
    """A list; of `count` items, none of which is null, where that is given."""

    def items(values: Any) -> Any:
        if not isinstance(values, list):
            raise _WrongTypeError("", "list")
        if count is not None and (len(values) != count or None in values):
            raise _WrongTypeError("", f"list of {count} values")
        return tuple(_within(f"[{k}]", read, value) for k, value in enumerate(values))

    return items


def _table(read: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def items(values: Any) -> Any:
        if not isinstance(values, dict):
            raise _WrongTypeError("", "table")
        return {(name := one_line(key)): _within(f".{name}", read, value) for key, value in values.items()}

    return items


def _within(key: str, read: Callable[[Any], Any], value: Any) -> Any:
    """A value of a list or table, whose key is in the message."""
    try:
        return read(value)
    except _WrongTypeError as error:
        inner = f".{error.key}" if error.key and error.key[0] not in ".[" else error.key
        raise _WrongTypeError(key + inner, error.what) from None
