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
PLACE, GEOGRAPHIC = {"x_m": 1e6, "y_m": 1e6}, {"lon": 180.0, "lat": 90.0}  #: and the largest number of each
OWN = (NAME, COUNT, TAG, *PLACE, *GEOGRAPHIC)
#: a unit at the end of a name, as people write it
UNIT = re.compile(r"[ _]*[\[(]?\b(mm|cm|m|kg|t|g|kn|n|mpa|gpa|pa|rad|deg|s|hz)\b[\])]?$", re.IGNORECASE)
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(e[-+]?\d+)?", re.ASCII | re.IGNORECASE)
LIKE = 0.8  #: likeness from which an unknown name is taken for a slip
LARGEST_COUNT = 10**9
#: of a row, what the result says of it
LISTED = ("line", "name", "count", "tag", "place_m", "lon_lat", "given")
A_HEADER = "the first line must name the columns, such as name;width_m;height_m;mass_kg;mu_static"


@dataclass(frozen=True, kw_only=True)
class HallRow:
    """A row of the list."""

    line: int  #: of the file, where it ends
    name: str
    count: int = 1
    tag: str = ""
    place_m: tuple[float, ...] | None = None  #: x, y
    lon_lat: tuple[float, ...] | None = None  #: [degrees]
    given: Mapping[str, str]  #: its fields by column
    values: Mapping[str, Any]  #: of the dotted keys that it sets
    reason: str = ""  #: why it cannot be used
    container: int | None = None  #: its number among those that differ, once the row is checked


@dataclass(frozen=True, kw_only=True)
class HallFile:
    """A list as it was read."""

    path: Path
    text: str
    header: Sequence[str]  #: names of all columns; empty for a column without
    places: Mapping[str, int]  #: in the header, of the columns that are read, by name
    meanings: Mapping[str, str]  #: of these, as of `_meaning`

    @property
    def name(self) -> str:
        """File stem."""
        return self.path.stem

    @property
    def columns(self) -> tuple[str, ...]:
        """Those that are read."""
        return tuple(self.meanings)

    @property
    def keys(self) -> list[str]:
        """The dotted keys that columns name."""
        return [meaning for meaning in self.meanings.values() if meaning and meaning not in OWN]

    @property
    def kept(self) -> tuple[str, ...]:
        """Columns that are neither keys nor known by themselves."""
        return tuple(column for column, meaning in self.meanings.items() if not meaning)

    @property
    def count(self) -> int:
        """Lines below the header, before any is read; a line break within a field counts."""
        return sum(map(bool, map(str.strip, self.text.split("\n")))) - 1

    @cached_property
    def rows(self) -> tuple[HallRow, ...]:
        """A row for each line.

        Raises:
            CaseError: there are none, values below no name, decimal commas and points.
        """
        _, *lines = _lines(self.path, self.text)
        if not lines:
            raise CaseError(f"{self.path}: the list has a header and no rows; give one row a container")
        nameless = [k for k, name in enumerate(self.header) if not name]
        for line, fields in lines if nameless else ():
            if filled := [k for k in nameless if k < len(fields) and fields[k]]:
                raise CaseError(
                    f"{self.path}, line {line}: column {filled[0] + 1} has values and no name; name it in line 1"
                )
        self._require_one_decimal_mark(lines)
        return tuple(self._row(number, *line) for number, line in enumerate(lines, start=1))

    def _require_one_decimal_mark(self, lines: Sequence[tuple[int, list[str]]]) -> None:
        numeric = [self.places[name] for name, what in self.meanings.items() if what not in ("", NAME, TAG)]
        comma = point = 0
        for line, fields in lines:
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

    def _row(self, number: int, line: int, fields: list[str]) -> HallRow:
        given = {name: fields[k] if k < len(fields) else "" for name, k in self.places.items()}
        texts = dict(zip(self.meanings.values(), given.values(), strict=True))
        problems: list[str] = []

        def place(largest: Mapping[str, float]) -> tuple[float, ...] | None:
            if not any(texts.get(name) for name in largest):
                return None
            values = []
            for name, limit in largest.items():
                value = _number(texts[name])
                if value is None or abs(value) > limit:
                    problems.append(f"{name} must be a number of at most {limit:g}, got {texts[name]!r}")
                else:
                    values.append(value)
            return tuple(values) if len(values) == len(largest) else None

        where, geographic = place(PLACE), place(GEOGRAPHIC)
        count = _number(texts.get(COUNT) or "1")
        if count is None or not count.is_integer() or not 1 <= count <= LARGEST_COUNT:
            problems.append(f"count must be a whole number of at least 1, got {texts[COUNT]!r}")
            count = 1.0
        row = HallRow(
            line=line,
            given=given,
            name=plain_text(texts.get(NAME, "")) or str(number),
            count=int(count),
            tag=plain_text(texts.get(TAG, "")),
            place_m=where,
            lon_lat=geographic,
            values={key: _value(key, texts[key]) for key in self.keys if texts[key]},
            reason="; ".join(problems),
        )
        named = [k for k, name in enumerate(self.header) if name]
        if len(fields) > named[-1] and not any(fields[len(self.header) :]):
            return row
        reason = f"{len(fields)} fields, and the header names {len(named)} columns"
        return replace(row, values={}, reason=reason)


def read_hall(path: Path) -> HallFile:
    """Read a list; its rows are read on first use.

    Raises:
        CaseError: no such file, no text, no header, a column that names no key or a key twice, no rows.
    """
    try:
        text = decoded(read_regular(path, LARGEST_FILE))
    except ValueError as error:
        raise CaseError(f"{path} {error}; a list of containers is needed") from None
    if text is None or "\0" in text:
        raise CaseError(f"{path}: not a text file; save the list as CSV")
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    _, header = next(_lines(path, text), (0, []))
    if not header:
        raise CaseError(f"{path}: the list is empty; {A_HEADER}")
    names = [plain_text(name) for name in header]
    if not any(name.lower() in _plain_names() or name.partition(".")[0] in NAMED for name in names):
        raise CaseError(f"{path}: line 1 names no key of a case, so there is no header; {A_HEADER}")
    is_result = {"status", "outcome", TURNED} <= {*names}  # an earlier one, given as a list again
    read = [(name, k) for k, name in enumerate(names) if name and not (is_result and name in RESULT_COLUMNS)]
    meanings = _meanings_of(path, [name for name, _ in read])
    return HallFile(path=path, text=text, header=names, places=dict(read), meanings=meanings)


def _lines(path: Path, text: str) -> Iterator[tuple[int, list[str]]]:
    """The lines with something in them: number and fields."""
    stated = re.match(r"sep=(.)\n", text, re.IGNORECASE)  # as Excel writes it
    table = text[stated.end() :] if stated else text
    first = next(filter(str.strip, table.split("\n", 99)), "")
    separator = stated[1] if stated else next((mark for mark in ";\t" if mark in first), ",")
    reader = csv.reader(io.StringIO(table, newline=""), delimiter=separator)
    try:
        for line in reader:
            fields = [field.strip() for field in line]
            if any(fields):
                yield reader.line_num + bool(stated), fields
    except csv.Error as error:
        raise CaseError(f"{path}: no table in CSV ({error})") from None


def _meanings_of(path: Path, columns: Sequence[str]) -> dict[str, str]:
    """What each column means; refuses a meaning that occurs twice, and half a place.

    Raises:
        CaseError: every problem of the header.
    """
    problems, meanings = [], dict[str, str]()
    for column, count in Counter(columns).items():
        if count > 1:
            problems.append(f"column {column!r} occurs {count} times; keep one")
        elif column in RESULT_COLUMNS:
            problems.append(f"column {column!r} has the name of a result; rename it")
        else:
            try:
                meanings[column] = _meaning(column)
            except AxisError as error:
                problems.append(f"column {column!r} {error}")
    for meaning, count in Counter(filter(None, meanings.values())).items():
        if count > 1:
            same = [repr(column) for column in columns if meanings.get(column) == meaning]
            problems.append(f"columns {' and '.join(same)} both set {meaning!r}; keep one")
    for pair in (PLACE, GEOGRAPHIC):
        there = {column.lower() for column in columns} & {*pair}
        if len(there) == 1:
            problems.append(f"{' and '.join(pair)} belong together, and only {there.pop()} is there")
    if problems:
        raise CaseError("\n".join(f"{path}: {problem}" for problem in problems))
    return meanings


def _meaning(column: str) -> str:
    """What a column means: a dotted key, or a name of `OWN`; empty for one that is kept as it is.

    Raises:
        AxisError: it looks like a key and is none, or may be several.
    """
    table, dot, _ = column.partition(".")
    if dot and difflib.get_close_matches(table.lower(), NAMED, n=1, cutoff=LIKE):
        field_of(column)
        return "" if column in NO_AXIS or table == "document" else column
    meant = _plain_names().get(column.lower(), [])
    if len(meant) > 1:
        raise AxisError(f"may be {' or '.join(meant)}; write one of them")
    if not meant and (near := _nearest_name(column)):
        raise AxisError(
            f"is no key of a case; did you mean {near!r}? To keep it as a note, rename it, for instance to "
            f"'note {column}'"
        )
    return meant[0] if meant else ""


@cache
def _plain_names() -> dict[str, list[str]]:
    """What a name without a table, in small letters, may mean: dotted keys, or itself."""
    names = {name: [name] for name in (*OWN, "gravity_m_s2")}
    for table in PLAIN_TABLES:
        for key in known_keys(TABLES[table]):
            if key != "box":  # a table
                names.setdefault(key.lower(), []).append(f"{table}.{key}")
    return names


def _nearest_name(column: str) -> str:
    """The known name that an unknown one was meant for: without its unit the same, or very like it; else empty."""

    def stem(name: str) -> str:
        return UNIT.sub("", name.lower().replace(" ", "_").replace("-", "_")).strip("_ ")

    names = [key.rpartition(".")[2] for meant in _plain_names().values() for key in meant]
    stems = {stem(name): name for name in names}
    stems |= {"mu": "mu_static", "friction_coefficient": "mu_static", "longitude": "lon", "latitude": "lat"}
    near = difflib.get_close_matches(stem(column), stems, n=1, cutoff=LIKE) if len(stem(column)) > 1 else []
    return stems[near[0]] if near else ""


def _number(text: str) -> float | None:
    if DECIMAL_COMMA.fullmatch(text):
        text = text.replace(",", ".")
    numbers = as_numbers([text]) if text else None
    return None if numbers is None else float(numbers[0])


def _value(key: str, text: str) -> Any:
    """A field as a case file would give it: a number, true or false, a list, else text."""
    field = field_of(key)
    if text[0] == "[":
        with suppress(ValueError):
            return tomllib.loads(f"value = {text}")["value"]
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    if quantity_of(field.annotation, field.metadata) is None and field.annotation is not int:
        return plain_text(text)
    number = _number(text)
    if number is None:
        return text
    whole = field.annotation is int or int in get_args(field.annotation)
    return int(number) if whole and number.is_integer() else number
