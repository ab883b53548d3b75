"""Keys that follow others, by arithmetic: numbers, dotted keys, + - * / ^, parentheses, a few functions, nothing else.

A key is `table.key`, or a key before the first table, such as `gravity_m_s2`; `pi` is the number; `**` is `^`. Python's
own parser reads the text; only a white list of its nodes becomes a tree of tuples, and nothing is executed as code.
"""

import ast
import math
import operator
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from keyword import iskeyword
from typing import Any
from warnings import catch_warnings, simplefilter

from fem.case.case import Case
from fem.case.overrides import keys_in_effect
from fem.case.tables.all_tables import TABLES
from fem.case.validation import CaseError, known_keys, told_as
from fem.study.axes import AxisError

Tree = tuple[Any, ...]

FUNCTIONS: dict[str, tuple[Callable[..., float], int]] = {
    name: (getattr(math, name), 1) for name in ("atan", "cos", "exp", "log", "sin", "sqrt", "tan")
}
FUNCTIONS = dict(sorted((FUNCTIONS | {"abs": (abs, 1), "max": (max, 2), "min": (min, 2)}).items()))
ARITHMETIC: dict[str, Callable[[float, float], float]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "^": math.pow,
}
OPERATORS: dict[type[ast.AST], str] = dict(
    zip((ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.UAdd, ast.USub), "+-*/^+-", strict=True)
)
KEY = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)?", re.ASCII)
WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)
#: what Python may read, and an expression may not hold: signs, a comma at an end, 0x10, 1_000, 2j
FOREIGN = re.compile(r"[^\w\s.+\-*/^(),]|,(?=\s*\))|\b\d[\d.]*[_a-df-zA-DF-Z]\w*", re.ASCII)
OWN = "\u00f8"  #: before a key that is one of Python's words, such as free.lambda; no text holds it
LONGEST = 400  #: characters


class ExpressionError(ValueError):
    """A text that is no expression, or one that has no value; the message is a reason without a place."""


@dataclass(frozen=True)
class Expression:
    """A parsed expression."""

    text: str
    tree: Tree

    @property
    def keys(self) -> frozenset[str]:
        """The keys it refers to."""
        return frozenset(_keys(self.tree))

    def value(self, values: Mapping[str, float]) -> float:
        """Its value where the keys have these values; ExpressionError if that is not finite."""
        try:
            value = _value(self.tree, values)
        except ZeroDivisionError:
            reason = "it divides by zero"
        except OverflowError:
            reason = "it is too large for a number"
        except (ArithmeticError, ValueError, TypeError) as error:
            reason = str(error)
        else:
            if math.isfinite(value):
                return float(value)
            reason = f"it is {value}, not a finite number"
        raise ExpressionError(
            f"= {self.text!r} has no value: {reason}; change it, or the values of the keys that it refers to"
        )


def parse_expression(text: str) -> Expression:
    """Parse a text; ExpressionError with the reason why it is no expression."""
    if len(text) > LONGEST:
        raise ExpressionError(f"is {len(text)} characters long; at most {LONGEST} are read")
    reason = ""
    if foreign := FOREIGN.search(text):
        reason = f"unexpected {foreign[0]!r}"
    else:
        python = " ".join(text.replace("^", "**").split())
        python = WORD.sub(lambda word: f"{OWN * iskeyword(word[0])}{word[0]}", python)
        try:
            with catch_warnings():
                simplefilter("error")  # what Python doubts, such as 1if, is an error that is told in words
                return Expression(text, _tree(ast.parse(python, mode="eval").body))
        except SyntaxError as error:
            reason = error.msg if error.lineno is None else re.split("[.;]", error.msg)[0]
        except (RecursionError, MemoryError):
            raise ExpressionError("is nested too deeply") from None
        except OverflowError:
            reason = "a number is too large"
    raise ExpressionError(
        f"= {text!r}: {reason}; it may hold numbers, keys such as contact.mu_static, + - * / ^ ( ) and functions"
    )


def _tree(node: ast.expr) -> Tree:
    """What is read of a node; raises a SyntaxError for one that no expression holds."""
    source = ast.unparse(node).replace(OWN, "").replace(" ** ", "^")
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return ("number", float(number))
        case ast.Name() | ast.Attribute() if KEY.fullmatch(source):
            return ("number", math.pi) if source == "pi" else ("key", source)
        case ast.UnaryOp(op=op, operand=part) if type(op) in OPERATORS:
            return ("sign", OPERATORS[type(op)], _tree(part))
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            return (OPERATORS[type(op)], _tree(left), _tree(right))
        case ast.Call(func=function, args=arguments, keywords=[]):
            name = ast.unparse(function)
            if name not in FUNCTIONS:
                raise SyntaxError(f"no function {name!r} (known: {', '.join(FUNCTIONS)})")
            if len(arguments) != FUNCTIONS[name][1]:
                raise SyntaxError(f"{name} takes {FUNCTIONS[name][1]} arguments, got {len(arguments)}")
            return ("call", name, *map(_tree, arguments))
    raise SyntaxError(f"{source!r} is no number, key, sum, product or power")


def _keys(tree: Tree) -> Iterator[str]:
    if tree[0] == "key":
        yield tree[1]
    for part in tree[1:]:
        if isinstance(part, tuple):
            yield from _keys(part)


def _value(tree: Tree, values: Mapping[str, float]) -> float:
    match tree:
        case ("number", number):
            return float(number)
        case ("key", key):
            return values[key]
        case ("sign", sign, part):
            return -_value(part, values) if sign == "-" else _value(part, values)
        case ("call", name, *parts):
            return FUNCTIONS[name][0](*(_value(part, values) for part in parts))
    sign, left, right = tree
    return ARITHMETIC[sign](_value(left, values), _value(right, values))


FREE = "free."  #: begins the name of a variable that is no key of a case; derived keys refer to it


def read_derived(
    content: Mapping[str, Any],
    varied: Collection[str],
    check_key: Callable[[str], object],
    check_reference: Callable[[str], object],
) -> dict[str, Expression]:
    """The table [derived] of a study, by dotted keys: each stands behind those that its expression refers to.

    `varied` vary already; `check_key` and `check_reference` raise an `AxisError` for a key that cannot follow, or be
    referred to. CaseError with the key and the reason.
    """
    expressions: dict[str, Expression] = {}
    for key, text in content.items():
        with told_as(f"[derived] {key!r} "):
            if key in varied:
                raise AxisError("varies already; it cannot follow another key as well")
            check_key(key)
            if not isinstance(text, str):
                raise AxisError(
                    f"must be an expression in quotes, got {text!r}; a fixed value goes under [set]"
                )
            expressions[key] = parse_expression(text)
    for key, expression in expressions.items():
        for name in sorted(expression.keys - expressions.keys()):
            with told_as(f"[derived] {key!r} refers to {name!r}, which "):
                check_reference(name)
    ordered: dict[str, Expression] = {}
    while left := {key: one for key, one in expressions.items() if key not in ordered}:
        ready = {key: one for key, one in left.items() if not one.keys & left.keys()}
        if not ready:
            own = [key for key, one in left.items() if key in one.keys]
            circle = f"{own[0]} refers to itself" if own else f"{' and '.join(left)} refer to one another"
            raise CaseError(f"[derived] {circle}; let one follow an axis, or set it under [set]")
        ordered |= ready
    return ordered


def with_derived(values: Mapping[str, Any], derived: Mapping[str, Expression], base: Case) -> dict[str, Any]:
    """Values by key, those of the derived keys added; CaseError for an expression without a value."""
    complete = dict(values)
    for derived_key, expression in derived.items():
        known = {key: number_of(key, complete, base) for key in expression.keys}
        with told_as(f"[derived] {derived_key} "):
            value = expression.value(known)
        complete[derived_key] = int(value) if derived_key in _WHOLE_KEYS and value == int(value) else value
    return complete


def number_of(key: str, values: Mapping[str, Any], base: Case) -> float:
    """The number of a key: set in `values`, given in the base case, or a default; CaseError if it has none."""
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


def _as_number(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None


_WHOLE_KEYS = frozenset(
    f"{table}.{name}"
    for table, model in TABLES.items()
    for name, field in known_keys(model).items()
    if field.annotation is int
)
