"""A dataclass that is written as a JSON object and read back, with its fields as keys."""

from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache
from types import UnionType
from typing import Any, ClassVar, Self, TypeVar, Union, get_args, get_origin, get_type_hints


class JsonBlock:
    """A dataclass that is written as a JSON object, with its fields as keys; `block[key]` is `block.key`."""

    #: keys that are left out where they are None, in place of null
    written_where_given: ClassVar[frozenset[str]] = frozenset()

    @classmethod
    def from_json(cls, block: Mapping[str, Any]) -> Self:
        """Read a block; missing keys and null take the default, unknown keys are ignored.

        Raises:
            ValueError: the block is no object, or a required key is missing.
        """
        try:
            readers = _readers(cls)  # type: ignore[arg-type]
            return cls(
                **{name: readers[name](block[name]) for name in readers if block.get(name) is not None}
            )
        except (AttributeError, TypeError) as error:
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


@cache
def _readers(kind: type[JsonBlock]) -> dict[str, Callable[[Any], Any]]:
    """For each field, what makes its value from JSON types."""
    hints = get_type_hints(kind)
    return {field.name: _reader(hints[field.name]) for field in fields(kind)}  # type: ignore[arg-type]


def _reader(hint: Any) -> Callable[[Any], Any]:
    if get_origin(hint) in (UnionType, Union):  # X | None
        hint = get_args(hint)[0]
    if isinstance(hint, TypeVar):  # a number, or the ends of a range
        return lambda value: tuple(value) if isinstance(value, list) else value
    if isinstance(hint, type) and issubclass(hint, JsonBlock):
        return hint.from_json
    if get_origin(hint) is tuple:
        item = _reader(get_args(hint)[0])
        return lambda values: tuple(item(value) for value in values)
    return lambda value: value
