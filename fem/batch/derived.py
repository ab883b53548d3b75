"""Keys that follow others by an expression, and the numbers that keys have where others vary."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from fem.batch.axes import AxisError
from fem.batch.expressions import Expression, ExpressionError, parse_expression
from fem.case.case import Case
from fem.case.overrides import keys_in_effect
from fem.case.tables.all_tables import TABLES
from fem.case.validation import CaseError, known_keys

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
