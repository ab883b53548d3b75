"""Read the tables of a case file, or find every reason why they cannot be used.

One pass collects all that is wrong: unknown keys, values of the wrong type or out of range, and broken rules among the
keys that could be read. Each reason is one line: table, key, what is required, the value with its unit, and what to do.
"""

import datetime
import difflib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, PydanticUndefined

from fem.case.case_rules import CASE_RULES
from fem.case.tables.all_tables import OPTIONAL, TABLES, CaseContent, CaseHeading
from fem.case.tables.container_tables import BoxTable
from fem.case.tables.input_ranges import short
from fem.case.tables.links import MOST_ROWS, ROWS
from fem.case.tables.problem import Problem, broken
from fem.case.tables.quantities import Quantity, with_unit
from fem.case.tables.table import CaseTable
from fem.runtime.left import left_words
from fem.runtime.terminal import one_line

ModelT = TypeVar("ModelT", bound=BaseModel)


class CaseError(ValueError):
    """A case that cannot be used; the message has one line for each reason."""


@contextmanager
def told_as(before: str, after: str = "", *, of: type[ValueError] = ValueError) -> Iterator[None]:
    """Raise such an error of the block as a CaseError, each of its lines between these words."""
    try:
        yield
    except of as error:
        raise CaseError("\n".join(f"{before}{line}{after}" for line in str(error).splitlines())) from None


def known_keys(table: type[CaseTable]) -> dict[str, FieldInfo]:
    """Keys of a table as they are written in a file, with their fields."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


TOP = known_keys(CaseHeading)
MOST_BOXES = range(1, 51)
#: what pydantic requires of a value, by its name of the fault
REQUIRED = {
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be text in quotes",
    "list_type": "must be a list in brackets",
    "tuple_type": "must be a list in brackets",
    "greater_than": "must be greater than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "string_too_long": "must have at most {max_length} characters",
    "too_short": "must have {min_length} items",
    "too_long": "must have {max_length} items",
    "literal_error": "must be {expected}",
}


def quantity_of(annotation: Any, metadata: Iterable[Any] = ()) -> Quantity | None:
    """The quantity that a field holds, if it holds one; optional and "auto" fields included."""
    for item in metadata:
        if isinstance(item, Quantity):
            return item
    for part in get_args(annotation):
        quantity = part if isinstance(part, Quantity) else quantity_of(part)
        if quantity is not None:
            return quantity
    return None


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """The nearest known name as the end of a message; nothing where none is near."""
    if not isinstance(name, str):
        return ""
    names = list(known)
    lower = {candidate.lower(): candidate for candidate in names}
    near = difflib.get_close_matches(name.lower(), lower, n=1, cutoff=0.6)
    near = near or [candidate for candidate in lower if len(name) > 1 and candidate.startswith(name.lower())]
    return f"; did you mean {lower[near[0]]!r}?" if near else ""


def read_case_tables(data: Mapping[str, Any]) -> tuple[dict[str, Any], list[Problem]]:
    """Read all tables of a case.

    Returns:
        What could be read, by name: the heading's keys and one `CaseTable` for each table; and every
        problem found. The first is complete only when the second is empty.
    """
    heading: dict[str, Any] = {}
    problems: list[Problem] = []
    contact, ranges = data.get("contact"), data.get("uncertainty", {})
    if isinstance(contact, dict) and isinstance(ranges, dict) and "mu_static" not in ranges:
        ends = contact.get("mu_static")
        if isinstance(ends, list) and len(ends) == 2 and all(isinstance(end, int | float) for end in ends):
            # contact.mu_static = [low, high] is its middle, and its range in [uncertainty]
            low, high = map(float, ends)
            contact = {**contact, "mu_static": short(0.5 * (low + high))}
            data = {**data, "contact": contact, "uncertainty": {**ranges, "mu_static": [low, high]}}
    for key, value in data.items():
        if key in TABLES and not isinstance(value, dict):
            reason = f"must be one table, got {_shown(value)}; write [{key}] above its keys"
            problems.append(Problem(table=key, key="", reason=reason))
        elif isinstance(value, dict) and key not in (*TABLES, *ROWS, *TOP):
            unknown = f"unknown table{did_you_mean(key, TABLES)} (known: {', '.join(TABLES)})"
            problems.append(Problem(table=one_line(key), key="", reason=left_words(f"[{key}]") or unknown))
        elif key not in TABLES and key not in ROWS:
            heading[key] = value
    read, partial, faults = read_table("", CaseHeading, heading)
    problems += faults
    for name, model in TABLES.items():
        content = data.get(name, {})
        if not isinstance(content, dict) or (name in OPTIONAL and name not in data):
            continue
        given, part, faults = read_table(name, model, content)
        problems += faults
        partial[name] = _in_part(model, part)
        if not faults:
            read[name] = model.model_validate(given)
    for name, model in ROWS.items():
        rows = ()
        if name in data:
            rows, faults = _read_rows(name, model, data[name], range(MOST_ROWS + 1))
            problems += faults
            if not faults:
                read[name] = rows
        partial[name] = rows or ()
    return read, problems + broken(CASE_RULES, _in_part(CaseContent, partial))


def _in_part(model: type[ModelT], values: Mapping[str, Any]) -> ModelT:
    """A table or a case as far as it could be read: what asks for one of its other keys raises AttributeError."""
    part = model.__new__(model)
    object.__setattr__(part, "__dict__", dict(values))
    object.__setattr__(part, "__pydantic_fields_set__", set(values))
    return part


def problem_lines(problems: Iterable[Problem], heading: str = "") -> list[str]:
    """One line a problem, in the order of the tables; `heading` says whose they are."""
    order = {name: place for place, name in enumerate(TABLES, 1)}
    lines = []
    for problem in sorted(problems, key=lambda problem: order.get(problem.table, 0)):
        table = f"[{problem.table}] " if problem.table else ""
        space = " " if problem.key and not problem.reason.startswith(",") else ""
        lines.append(f"{heading}{table}{problem.key}{space}{problem.reason}")
    return lines


def read_table(
    name: str, model: type[CaseTable], content: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, Any], list[Problem]]:
    """Values as given, values by field with defaults as far as readable, and problems."""
    known = known_keys(model)
    problems = []
    for key in content:
        if key in known:
            continue
        if words := left_words(f"{name}.{key}"):
            problems.append(Problem(table=name, key="", reason=f"{key!r} {words}"))
            continue
        elsewhere = [
            f"[{other}]" for other, table in TABLES.items() if other != name and key in known_keys(table)
        ]
        if elsewhere:
            way_out = f"; it belongs into {' or '.join(elsewhere)}"
        elif name and key in TOP:
            way_out = "; it belongs before the first table"
        else:
            way_out = did_you_mean(key, known)
        unknown = f"unknown key {key[:80]!r}{way_out} (known: {', '.join(known)})"
        problems.append(Problem(table=name, key="", reason=unknown))
    given = model.as_meant({key: value for key, value in content.items() if key in known})
    if model is TABLES["container"] and "box" in given:
        given["box"], of_boxes = _read_rows(
            "container.box", BoxTable, given["box"], MOST_BOXES, "from the floor up"
        )
        problems += of_boxes
    faults: dict[str, list[ErrorDetails]] = {}
    try:
        model.model_validate(given)
    except ValidationError as error:
        for detail in error.errors(include_url=False):
            if detail["loc"] and detail["type"] != "default_factory_not_called":
                faults.setdefault(str(detail["loc"][0]), []).append(detail)
    problems += [
        Problem(table=name, key=key, reason=_reason(known[key], details)) for key, details in faults.items()
    ]
    values: dict[str, Any] = {}
    for name_here, field in model.model_fields.items():
        if (key := field.alias or name_here) in faults:
            continue
        with suppress(KeyError):  # the default follows a key that is bad or missing
            value = (
                given[key]
                if key in given
                else field.get_default(call_default_factory=True, validated_data=values)
            )
            if value is not PydanticUndefined:
                values[name_here] = value
    return given, values, problems + broken(model.rules, _in_part(model, values))


def _read_rows(
    name: str, model: type[CaseTable], content: Any, count: range, order: str = ""
) -> tuple[Any, list[Problem]]:
    """Tables [[name]] as far as they can be read, in place of the content; and problems, each with its number."""
    table, _, key = name.rpartition(".")
    tables = isinstance(content, list | tuple) and all(isinstance(row, Mapping) for row in content)
    if not tables or len(content) not in count:
        ordered = f", one a {key} {order}" if order else ""
        reason = f"must be {count[0]} to {count[-1]} tables [[{name}]]{ordered}, got {_shown(content)}"
        return None, [Problem(table=table, key=key, reason=reason)]
    rows, problems = [], []
    for number, row in enumerate(content, 1):
        given, part, faults = read_table(name, model, row)
        rows.append(_in_part(model, part) if faults else model.model_validate(given))
        problems += [
            Problem(table=table, key=f"{key} {number}: {problem.key}".rstrip(), reason=problem.reason)
            for problem in faults
        ]
    return tuple(rows), problems


def _reason(field: FieldInfo, details: list[ErrorDetails]) -> str:
    """One reason for all that pydantic says of one key."""
    faults = {detail["type"]: detail for detail in details}
    detail = faults.get("value_error", details[0])
    value = detail["input"]
    quantity = quantity_of(field.annotation, field.metadata)
    unit = quantity.unit if quantity else ""
    if "value_error" in faults:
        return str(detail.get("ctx", {}).get("error", detail["msg"]))
    if "missing" in faults:
        example = f", for instance {field.examples[0]!r}" if field.examples else ""
        return f"is missing: {field.description}{example} {unit}".strip().replace("'", '"')
    if "literal_error" in faults and len(faults) > 1:
        choice = choices_of(field.annotation)[0]
        kind = "a number" if choice == "auto" else "true, false" if "bool_type" in faults else "[low, high]"
        return f'must be {kind} or "{choice}", got {_shown(faults["literal_error"]["input"])}'
    if "literal_error" in faults:
        choices = choices_of(field.annotation)
        near = "" if "m/s2" in choices else did_you_mean(value, choices)  # of a unit it is another one
        listed = " or ".join(f'"{choice}"' for choice in choices)
        return f"must be {listed}, got {_shown(value)}{near}"
    hint = ""
    if isinstance(value, str) and quantity and faults.keys() & REQUIRED:
        try:
            hint = f"; write {float(value)!r}"
        except ValueError:
            hint = f"; give the bare number{' in ' + unit if unit else ''}"
    return f"{requirement_of(detail)}, got {repr(value) if isinstance(value, float) else _shown(value)}{hint}"


def choices_of(annotation: Any) -> list[str]:
    """The words that a field may hold; optional fields included."""
    parts = get_args(annotation)
    return [part for part in parts if isinstance(part, str)] or [
        c for part in parts for c in choices_of(part)
    ]


def requirement_of(detail: ErrorDetails) -> str:
    """What pydantic requires of a value, in plain words."""
    words = REQUIRED.get(detail["type"])
    return words.format_map(detail.get("ctx", {})) if words else f"cannot be used ({detail['msg'].lower()})"


def _shown(value: object) -> str:
    """A value of a TOML file in words."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict | list | tuple):
        return "a table" if isinstance(value, dict) else "a list"
    kind = "the text " * isinstance(value, str)
    if isinstance(value, datetime.date | datetime.time):
        return f"the date or time {value}"
    return kind + with_unit(value, "")
