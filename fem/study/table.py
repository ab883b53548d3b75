"""Tables of rows: columns with the types of their fields, and rows as lines of text.

Numbers are written in the shortest form that reads back to the same bits. What a spreadsheet would compute in a text,
such as a file name that begins with "=", has an apostrophe before it, also behind a semicolon, which separates columns
where commas do not.
"""

import csv
import io
import math
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fem.results.outcome import COUNTED, UPRIGHT_OR_FALLEN, Outcome
from fem.runtime.user_files import read_text

#: by the names in the header, what the fields hold: text, one number, true or false; a tuple: several numbers
Columns = dict[str, type]


def _finite(field: str) -> float:
    number = float(field)
    if not math.isfinite(number):  # no row of ours has one
        raise ValueError(f"{field} is no finite number")
    return number


READERS: dict[type, Callable[[str], Any]] = {
    str: str,
    int: int,
    float: _finite,
    bool: lambda field: field == "true",
    tuple: lambda field: tuple(map(_finite, field.split())),
}


#: what the columns of these names can hold in a log, besides nothing
WORDS = {"status": {None, *UPRIGHT_OR_FALLEN, "failed"}, "outcome": {None, *Outcome, *COUNTED}}
#: what other programs may take for a field of its own, and apostrophes that stand before a formula in it
PART = re.compile(r"(?P<blanks> *)(?P<marks>'*)(?P<text>[^;|]+)")


def line_of(values: Iterable[Any], *, separator: str = ",", comma: bool = False, digits: int = 0) -> str:
    """Values as a line of a table, without its end; numbers with a decimal comma, and with so many digits, if asked."""
    text = io.StringIO()
    # fields with what may end a line are quoted, and so are those with a semicolon
    csv.writer(text, delimiter=separator, lineterminator=";").writerow(
        [_text(value, comma, digits) for value in values]
    )
    return text.getvalue()[:-1]


def fields_of(line: str) -> list[str]:
    """The fields of one line."""
    return [plain_text(field) for field in next(csv.reader([line]))]


def plain_text(field: str) -> str:
    """A field without the apostrophes before what a spreadsheet would compute."""
    return PART.sub(
        lambda part: part[0].replace("'", "", int(bool(part["marks"]) and _is_computed(part["text"]))), field
    )


def row_of(columns: Columns, line: str) -> dict[str, Any]:
    """The values of a line by column; None where a field is empty."""
    fields = zip(columns.items(), fields_of(line), strict=True)
    return {name: READERS[kind](field) if field else None for (name, kind), field in fields}


def is_row(columns: Columns, line: str) -> bool:
    """Whether a line has a value for each column that it can hold."""
    try:
        row = row_of(columns, line)
    except (ValueError, StopIteration, csv.Error):
        return False
    known = all(row.get(name) in words for name, words in WORDS.items())
    return known and "\ufffd" not in line  # of bytes that are no text


def table_text(columns: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """A table as text."""
    return table_of_lines(columns, map(line_of, rows))


def table_of_rows(columns: Columns, rows: Iterable[Mapping[str, Any]]) -> str:
    """A table as text, from rows by column; nothing where a row has no such value."""
    return table_text(columns, ([row.get(name) for name in columns] for row in rows))


def table_of_lines(columns: Iterable[str], lines: Iterable[str]) -> str:
    """A table as text, from lines."""
    return "".join(f"{line}\n" for line in (line_of(columns), *lines))


def read_rows(path: Path, columns: Columns) -> list[dict[str, Any]]:
    """The rows of a whole table by column, None where it has no such column or value; none if the file is missing."""
    header, *lines = read_text(path).splitlines() if path.is_file() else [""]
    names = fields_of(header)
    rows = (dict(zip(names, fields_of(line), strict=True)) for line in lines)
    return [
        {name: READERS[kind](row[name]) if row.get(name) else None for name, kind in columns.items()}
        for row in rows
    ]


def read_lines(path: Path, columns: Iterable[str]) -> list[str]:
    """The whole lines of a table below its header; none if the file is missing, or has other columns."""
    try:
        text = read_text(path, errors="replace")
    except FileNotFoundError:
        return []
    lines = text[: text.rfind("\n") + 1].split("\n")[:-1]
    return lines[1:] if lines[:1] == [line_of(columns)] else []


def _text(value: Any, comma: bool = False, digits: int = 0) -> str:
    """One field: nothing for None, text on one line, spaces between several numbers."""
    if value is None:
        return ""
    if isinstance(value, tuple):
        return " ".join(_text(one, comma, digits) for one in value)
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, float | np.floating):
        number = f"{value:.{digits}g}" if digits else repr(float(value))
        return number.replace(".", ",") if comma else number
    return PART.sub(
        lambda part: part["blanks"] + "'" * _is_computed(part["text"]) + part["marks"] + part["text"],
        " ".join(str(value).split()),
    )


def _is_computed(text: str) -> bool:
    """Whether a spreadsheet would take a text for a formula."""
    if text[:1] not in ("=", "+", "-", "@"):
        return False
    try:
        return not [float(word.replace(",", ".")) for word in text.split()]
    except ValueError:
        return True
