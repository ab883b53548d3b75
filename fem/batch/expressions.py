"""Arithmetic of derived keys: numbers, dotted keys, + - * / ^, parentheses and a few functions, and nothing else.

    expression = term {("+" | "-") term}          term   = factor {("*" | "/") factor}
    factor     = ("+" | "-") factor | power        power  = atom ["^" factor]
    atom       = number | key | function "(" expression {"," expression} ")" | "(" expression ")"

A key is `table.key`, or a key before the first table, such as `gravity_m_s2`; `pi` is the number. The text is parsed
into a tree of tuples; nothing of it is ever executed as code.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

Tree = tuple[Any, ...]

TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)?)|(?P<sign>\*\*|[-+*/^(),]))"
)
FUNCTIONS: dict[str, tuple[Callable[..., float], int]] = {
    "abs": (abs, 1),
    "atan": (math.atan, 1),
    "cos": (math.cos, 1),
    "exp": (math.exp, 1),
    "log": (math.log, 1),
    "max": (max, 2),
    "min": (min, 2),
    "sin": (math.sin, 1),
    "sqrt": (math.sqrt, 1),
    "tan": (math.tan, 1),
}
LONGEST = 400  #: characters
DEEPEST = 50  #: parentheses, signs and powers within one another


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
        """Its value where the keys have these values.

        Raises:
            ExpressionError: a division by zero, a root of a negative number, a value that is not finite.
        """
        try:
            found = _value(self.tree, values)
        except ZeroDivisionError:
            reason = "it divides by zero"
        except OverflowError:
            reason = "it grows beyond all numbers"
        except (ArithmeticError, ValueError, TypeError) as error:
            reason = str(error)
        else:
            if not isinstance(found, complex) and math.isfinite(found):
                return float(found)
            reason = f"it is {found}, not a finite number"
        raise ExpressionError(
            f"= {self.text!r} has no value: {reason}; change it, or the values of the keys that it refers to"
        )


def parse_expression(text: str) -> Expression:
    """Parse a text.

    Raises:
        ExpressionError: if it is no expression; says where and what was expected.
    """
    if len(text) > LONGEST:
        raise ExpressionError(f"is {len(text)} characters long; at most {LONGEST} are read")
    parser = _Parser(text)
    tree = parser.expression()
    if parser.kind != "end":
        raise parser.expected("an operator or the end")
    return Expression(text, tree)


class _Parser:
    """Recursive descent over the tokens of one text."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._end = self._start = self._depth = 0
        self.kind = self._token = ""
        self._next()

    def expression(self) -> Tree:
        tree = self._term()
        while self._token in ("+", "-"):
            sign = self._take()
            tree = (sign, tree, self._term())
        return tree

    def expected(self, what: str) -> ExpressionError:
        found = "the end" if self.kind == "end" else repr(self._token)
        return ExpressionError(
            f"= {self._text!r}: {what} expected at character {self._start + 1}, found {found}"
        )

    def _term(self) -> Tree:
        tree = self._factor()
        while self._token in ("*", "/"):
            sign = self._take()
            tree = (sign, tree, self._factor())
        return tree

    def _factor(self) -> Tree:
        self._depth += 1
        if self._depth > DEEPEST:
            raise ExpressionError(f"is nested deeper than {DEEPEST} levels")
        if self._token in ("+", "-"):
            tree: Tree = ("sign", self._take(), self._factor())
        else:
            tree = self._atom()
            if self._token in ("^", "**"):
                self._take()
                tree = ("^", tree, self._factor())
        self._depth -= 1
        return tree

    def _atom(self) -> Tree:
        if self.kind == "number":
            return ("number", float(self._take()))
        if self.kind == "name":
            name = self._take()
            if self._token == "(":
                return self._call(name)
            return ("number", math.pi) if name == "pi" else ("key", name)
        if self._token == "(":
            self._take()
            tree = self.expression()
            self._close()
            return tree
        raise self.expected("a number, a key or '('")

    def _call(self, name: str) -> Tree:
        if name not in FUNCTIONS:
            raise ExpressionError(f"= {self._text!r}: no function {name!r} (known: {', '.join(FUNCTIONS)})")
        self._take()
        arguments = [self.expression()]
        while self._token == ",":
            self._take()
            arguments.append(self.expression())
        self._close()
        wanted = FUNCTIONS[name][1]
        if len(arguments) != wanted:
            raise ExpressionError(
                f"= {self._text!r}: {name} takes {wanted} argument{'s' * (wanted > 1)}, got {len(arguments)}"
            )
        return ("call", name, *arguments)

    def _close(self) -> None:
        if self._token != ")":
            raise self.expected("')'")
        self._take()

    def _take(self) -> str:
        token = self._token
        self._next()
        return token

    def _next(self) -> None:
        match = TOKEN.match(self._text, self._end)
        if match is None:
            self._start = len(self._text) - len(self._text[self._end :].lstrip())
            self.kind, self._token = "end", ""
            if self._start < len(self._text):
                self.kind, self._token = "unknown", self._text[self._start]
                raise self.expected("a number, a key or an operator")
            return
        self.kind, self._token = str(match.lastgroup), match[str(match.lastgroup)]
        self._start, self._end = match.start(str(match.lastgroup)), match.end()


def _keys(tree: Tree) -> list[str]:
    if tree[0] == "key":
        return [tree[1]]
    return [key for part in tree[1:] if isinstance(part, tuple) for key in _keys(part)]


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
    sign, left, right = tree[0], _value(tree[1], values), _value(tree[2], values)
    match sign:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case "/":
            return left / right
    return math.pow(left, right)
