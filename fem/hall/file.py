"""Read the list of a hall: one row a container, under a header of keys of a case.

Columns are separated by semicolons, tabs or commas, decimals by points or, where all are, by commas. What is wrong with
the list as a whole is an error; what is wrong with a row is its reason.
"""

import csv
import difflib
import io
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import islice
from pathlib import Path
from typing import Any, get_args

from fem.batch.axes import NAMED, NO_AXIS, AxisError, field_of
from fem.batch.table import plain_text
from fem.case.tables import TABLES
from fem.case.validation import CaseError, known_keys, quantity_of
from fem.hall.result import RESULT_COLUMNS
from fem.records.source import as_numbers, decoded
from fem.results.figures import TURNED
from fem.runtime.user_files import read_regular

LARGEST_FILE = 512 * 2**20  #: [bytes]
#: tables whose keys a column may name without the table
PLAIN_TABLES = ("container", "contact", "support", "floor")
NAME, COUNT, TAG = "name", "count", "tag"
PLACE, GEOGRAPHIC = ("x_m", "y_m"), ("lon", "lat")
OWN = (NAME, COUNT, TAG, *PLACE, *GEOGRAPHIC)
#: a unit at the end of a name, as people write it
UNIT = re.compile(r"[ _]*[\[(]?\b(mm|cm|m|kg|t|g|kn|n|mpa|gpa|pa|rad|deg|s|hz)\b[\])]?$", re.IGNORECASE)
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(e[-+]?\d+)?", re.ASCII | re.IGNORECASE)
LIKE = 0.8  #: likeness from which an unknown name is taken for a slip
LARGEST_COUNT = 10**9
A_HEADER = "the first line must name the columns, such as name;width_m;height_m;mass_kg;mu_static"


@dataclass(frozen=True, kw_only=True)
class HallRow:
    """A row of the list."""

    line: int  #: of the file, where it ends
    given: tuple[str, ...]  #: its fields, as many as there are columns
    name: str
    count: int = 1
    tag: str = ""
    place: tuple[float, float] | None = None  #: x, y [m]
    geographic: tuple[float, float] | None = None  #: longitude, latitude [degrees]
    values: Mapping[str, Any]  #: of the dotted keys that it sets
    reason: str = ""  #: why it cannot be used


@dataclass(frozen=True, kw_only=True)
class HallFile:
    """A list as it was read."""

    path: Path
    text: str
    names: Sequence[str]  #: in the header; empty for a column without
    columns: tuple[str, ...]  #: those that are read
    keys: Mapping[str, str]  #: dotted keys by column
    kept: tuple[str, ...]  #: columns that are neither keys nor known by themselves
    places: tuple[int, ...]  #: of the columns in the file

    @property
    def name(self) -> str:
        """File stem."""
        return self.path.stem

    @property
    def count(self) -> int:
        """Lines below the header, before any is read; a line break within a field counts."""
        return sum(map(bool, map(str.strip, self.text.split("\n")))) - 1

    @cached_property
    def lines(self) -> list[tuple[int, list[str]]]:
        """Below the header: number and fields.

        Raises:
            CaseError: there are none, or values below no name.
        """
        _, *lines = _records(self.path, self.text)
        if not lines:
            raise CaseError(f"{self.path}: the list has a header and no rows; give one row a container")
        nameless = [k for k, name in enumerate(self.names) if not name]
        for line, fields in lines if nameless else ():
            if filled := [k for k in nameless if k < len(fields) and fields[k]]:
                raise CaseError(
                    f"{self.path}, line {line}: column {filled[0] + 1} has values and no name; name it in line 1"
                )
        return lines

    @cached_property
    def rows(self) -> tuple[HallRow, ...]:
        """A row for each line.

        Raises:
            CaseError: decimal commas and points.
        """
        comma = self._has_decimal_commas()
        return tuple(self._row(number, *line, comma=comma) for number, line in enumerate(self.lines, start=1))

    def _row(self, number: int, line: int, fields: list[str], *, comma: bool) -> HallRow:
        chosen = tuple(fields[k] if k < len(fields) else "" for k in self.places)
        row = _row(number, line, chosen, self.columns, self.keys, comma=comma)
        named = [k for k, name in enumerate(self.names) if name]
        if len(fields) > named[-1] and not any(fields[len(self.names) :]):
            return row
        reason = f"{len(fields)} fields, and the header names {len(named)} columns"
        return replace(row, values={}, reason=reason)

    def _has_decimal_commas(self) -> bool:
        numeric = [
            k
            for k, name in zip(self.places, self.columns, strict=True)
            if name in self.keys or _own(name) not in ("", NAME, TAG)
        ]
        comma = point = 0
        for line, fields in self.lines:
            for field in (fields[k] for k in numeric if k < len(fields)):
                if "," in field and DECIMAL_COMMA.fullmatch(field):
                    comma = comma or line
                elif "." in field and not point and as_numbers([field]) is not None:
                    point = line
        if comma and point:
            raise CaseError(
                f"{self.path}: decimal commas (line {comma}) and decimal points (line {point}) in one list; use one "
                "of them, and no sign between thousands"
            )
        return bool(comma)


def read_hall(path: Path) -> HallFile:
    """Read a list; its rows are read on first use.

    Raises:
        CaseError: no such file, no text, no header, a column that names no key or a key twice, no rows.
    """
    text = _text_of(path)
    names = _names(path, text)
    is_result = {"status", "outcome", TURNED} <= {*names}  # an earlier one, given as a list again
    positions = tuple(
        k for k, name in enumerate(names) if name and not (is_result and name in RESULT_COLUMNS)
    )
    columns = tuple(names[k] for k in positions)
    keys, others = _keys_of(path, columns)
    return HallFile(
        path=path, text=text, names=names, columns=columns, keys=keys, kept=others, places=positions
    )


def _text_of(path: Path) -> str:
    try:
        text = decoded(read_regular(path, LARGEST_FILE))
    except ValueError as error:
        raise CaseError(f"{path} {error}; a list of containers is needed") from None
    if text is None or "\0" in text:
        raise CaseError(f"{path}: not a text file; save the list as CSV")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _records(path: Path, text: str) -> Iterator[tuple[int, list[str]]]:
    """The lines with something in them: number and fields."""
    sep_line = re.match(r"sep=(.)\n", text, re.IGNORECASE)  # as Excel writes it
    first = next(
        (line for line in text[sep_line.end() if sep_line else 0 :].split("\n", 99) if line.strip()), ""
    )
    separator = sep_line[1] if sep_line else next((mark for mark in ";\t" if mark in first), ",")
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    try:
        for line in islice(reader, int(bool(sep_line)), None):
            fields = [field.strip() for field in line]
            if any(fields):
                yield reader.line_num, fields
    except csv.Error as error:
        raise CaseError(f"{path}: no table in CSV ({error})") from None


def _names(path: Path, text: str) -> list[str]:
    """The names of the columns, empty for one without."""
    _, header = next(_records(path, text), (0, []))
    if not header:
        raise CaseError(f"{path}: the list is empty; {A_HEADER}")
    names = [plain_text(name) for name in header]
    if not any(_is_known(name) for name in names):
        raise CaseError(f"{path}: line 1 names no key of a case, so there is no header; {A_HEADER}")
    return names


def _keys_of(path: Path, columns: Sequence[str]) -> tuple[dict[str, str], tuple[str, ...]]:
    """The dotted keys by column, and the columns to keep; refuses what looks like a key and is none."""
    problems, keys, others = [], dict[str, str](), []
    for column, count in Counter(columns).items():
        if count > 1:
            problems.append(f"column {column!r} occurs {count} times; keep one")
        elif column in RESULT_COLUMNS:
            problems.append(f"column {column!r} has the name of a result; rename it")
        elif _own(column):
            continue
        elif key := _key(column, problems):
            keys[column] = key
        elif key is None:
            others.append(column)
    for meaning, count in Counter([*keys.values(), *filter(None, map(_own, columns))]).items():
        if count > 1:
            same = [column for column in columns if keys.get(column, _own(column)) == meaning]
            if len({*same}) > 1:
                problems.append(f"columns {' and '.join(map(repr, same))} both set {meaning!r}; keep one")
    for pair in (PLACE, GEOGRAPHIC):
        there = {*map(_own, columns)} & {*pair}
        if len(there) == 1:
            problems.append(f"{' and '.join(pair)} belong together, and only {there.pop()} is there")
    if problems:
        raise CaseError("\n".join(f"{path}: {problem}" for problem in problems))
    return keys, tuple(others)


@cache
def _plain_keys() -> dict[str, list[str]]:
    """Dotted keys by the name, in small letters, by which a column may call them."""
    names: dict[str, list[str]] = {"gravity_m_s2": ["gravity_m_s2"]}
    for table in PLAIN_TABLES:
        for key in known_keys(TABLES[table]):
            if key != "box":  # a table
                names.setdefault(key.lower(), []).append(f"{table}.{key}")
    return names


def _own(column: str) -> str:
    """The name of a column that is known by itself, such as `count`; else empty."""
    return column.lower() if column.lower() in OWN else ""


def _is_known(column: str) -> bool:
    return bool(_own(column)) or column.lower() in _plain_keys() or column.partition(".")[0] in NAMED


def _key(column: str, problems: list[str]) -> str | None:
    """The key that a column names; None for a column to keep, empty where it is refused, with a problem."""
    table, dot, _ = column.partition(".")
    near_table = difflib.get_close_matches(table.lower(), NAMED, n=1, cutoff=LIKE) if dot else []
    if near_table:
        try:
            field_of(column)
        except AxisError as error:
            problems.append(f"column {column!r} {error}")
            return ""
        return None if column in NO_AXIS or table == "document" else column
    keys = _plain_keys().get(column.lower(), [])
    if len(keys) == 1:
        return keys[0]
    if keys:
        problems.append(f"column {column!r} may be {' or '.join(keys)}; write one of them")
        return ""
    if meant := _meant(column):
        problems.append(
            f"column {column!r} is no key of a case; did you mean {meant!r}? To keep it as a note, rename it, "
            f"for instance to 'note {column}'"
        )
        return ""
    return None


def _meant(column: str) -> str:
    """The known name that an unknown one was meant for: without its unit the same, or very like it; else empty."""

    def stem(name: str) -> str:
        return UNIT.sub("", name.lower().replace(" ", "_").replace("-", "_")).strip("_ ")

    stems = {
        stem(name): name
        for name in [*OWN, *(key.rpartition(".")[2] for keys in _plain_keys().values() for key in keys)]
    }
    stems |= {"mu": "mu_static", "friction_coefficient": "mu_static", "longitude": "lon", "latitude": "lat"}
    near = difflib.get_close_matches(stem(column), stems, n=1, cutoff=LIKE) if len(stem(column)) > 1 else []
    return stems[near[0]] if near else ""


def _row(
    number: int,
    line: int,
    chosen: tuple[str, ...],
    columns: Sequence[str],
    keys: Mapping[str, str],
    *,
    comma: bool,
) -> HallRow:
    fields = dict(zip(columns, chosen, strict=True))
    own = {_own(column): text for column, text in fields.items() if _own(column)}
    name = plain_text(own.get(NAME, "")) or str(number)
    problems: list[str] = []

    def numbers(pair: tuple[str, str], limits: tuple[float, float]) -> tuple[float, float] | None:
        texts = [own.get(column, "") for column in pair]
        if not any(texts):
            return None
        values = [_number(text, comma=comma) for text in texts]
        for column, text, value, limit in zip(pair, texts, values, limits, strict=True):
            if value is None or abs(value) > limit:
                problems.append(f"{column} must be a number of at most {limit:g}, got {text!r}")
        return None if None in values else (values[0] or 0.0, values[1] or 0.0)

    position, geographic = numbers(PLACE, (1e6, 1e6)), numbers(GEOGRAPHIC, (180.0, 90.0))
    count = _number(own.get(COUNT) or "1", comma=comma)
    if count is None or not count.is_integer() or not 1 <= count <= LARGEST_COUNT:
        problems.append(f"count must be a whole number of at least 1, got {own.get(COUNT)!r}")
        count = 1.0
    values = {key: _value(key, fields[column], comma=comma) for column, key in keys.items() if fields[column]}
    return HallRow(
        line=line,
        given=chosen,
        name=name,
        count=int(count),
        tag=plain_text(own.get(TAG, "")),
        place=position,
        geographic=geographic,
        values=values,
        reason="; ".join(problems),
    )


def _number(text: str, *, comma: bool) -> float | None:
    if comma and DECIMAL_COMMA.fullmatch(text):
        text = text.replace(",", ".")
    numbers = as_numbers([text]) if text else None
    return None if numbers is None else float(numbers[0])


def _value(key: str, text: str, *, comma: bool) -> Any:
    """A field as a case file would give it: a number, true or false, a list, else text."""
    field = field_of(key)
    if text[0] == "[":
        with suppress(ValueError):
            return tomllib.loads(f"value = {text}")["value"]
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    if quantity_of(field.annotation, field.metadata) is None and field.annotation is not int:
        return plain_text(text)
    number = _number(text, comma=comma)
    if number is None:
        return text
    whole = field.annotation is int or int in get_args(field.annotation)
    return int(number) if whole and number.is_integer() else number
