"""A table that a user has written, in a spreadsheet or by hand: a header of names, and lines of fields.

Columns are separated by semicolons, tabs or commas, or as a first line "sep=|" says; decimals by points or, where all
are, by commas.
"""

import csv
import io
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from fem.records.source import as_numbers

DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(e[-+]?\d+)?", re.ASCII | re.IGNORECASE)
STATED = re.compile(r'"?sep=(.)"?[;,\s]*', re.IGNORECASE)  #: by Excel, what separates columns


class TableLine(NamedTuple):
    """A line with something in it."""

    number: int  #: in the file, where it ends
    fields: list[str]  #: without the blanks around them

    def field(self, place: int) -> str:
        """That of a column; empty behind the end."""
        return self.fields[place] if place < len(self.fields) else ""

    def numbers(self) -> list[float]:
        """Its fields; fewer where some are no numbers."""
        return [number for field in self.fields if (number := number_in(field)) is not None]


def number_in(text: str) -> float | None:
    """The number in a field, with a decimal point or comma; None where it is none."""
    numbers = as_numbers([text.replace(",", ".") if DECIMAL_COMMA.fullmatch(text) else text])
    return None if numbers is None else float(numbers[0])


def stated_separator(line: str) -> str | None:
    """What separates columns as the first line of a file says, as Excel does."""
    match = STATED.fullmatch(line)
    return match[1] if match else None


def fields_in(line: str, separator: str | None) -> list[str]:
    """The fields of a line (None: between blanks), unquoted, without empty ones at its end."""
    if separator is None:
        return line.split()
    quoted = '"' in line
    fields = [
        *map(
            str.strip, next(csv.reader([line], delimiter=separator), []) if quoted else line.split(separator)
        )
    ]
    while fields and not fields[-1]:
        fields.pop()
    return fields


@dataclass(frozen=True)
class UserTable:
    """A table whose lines are split on first use."""

    name: str
    text: str
    refused: type[ValueError] = ValueError  #: what is raised where it cannot be used

    @cached_property
    def header(self) -> list[str]:
        """Names of the columns; empty for a column without; no columns where there is nothing in the table."""
        return next((line.fields for line in self._lines()), [])

    @cached_property
    def lines(self) -> list[TableLine]:
        """Those below the header."""
        return [*self._lines()][1:]

    @property
    def count(self) -> int:
        """Lines below the header, before they are split; a line break within a field counts."""
        return sum(map(bool, map(str.strip, self.text.split("\n")))) - 1

    def require_names(self) -> None:
        """Refuse values below no name."""
        nameless = [k for k, name in enumerate(self.header) if not name]
        for line in self.lines if nameless else ():
            if filled := [k for k in nameless if line.field(k)]:
                raise self.refused(
                    f"{self.name}, line {line.number}: column {filled[0] + 1} has values and no name; name it in line 1"
                )

    @cached_property
    def separator(self) -> str:
        """What separates the columns."""
        line, _, below = self.text.partition("\n")
        stated = stated_separator(line)
        first = next(filter(str.strip, (below if stated else self.text).split("\n", 99)), "")
        return stated or next((mark for mark in ";\t" if mark in first), ",")

    def require_one_decimal_mark(self, columns: Iterable[int]) -> str:
        """The decimal mark in these columns, which hold numbers; commas and points are refused."""
        numeric, comma, point = [*columns], 0, 0
        for line in self.lines:
            for field in map(line.field, numeric):
                if "," in field and DECIMAL_COMMA.fullmatch(field):
                    comma = comma or line.number
                elif "." in field and not point and as_numbers([field]) is not None:
                    point = line.number
        if comma and point:
            raise self.refused(
                f"{self.name}: decimal commas (line {comma}) and decimal points (line {point}) in one list; use one of "
                "them, and no sign between thousands"
            )
        return "," if comma else "."

    def _lines(self) -> Iterator[TableLine]:
        line, _, below = self.text.partition("\n")
        stated = stated_separator(line)
        table = below if stated else self.text
        reader = csv.reader(io.StringIO(table, newline=""), delimiter=self.separator)
        try:
            for fields in ([field.strip() for field in line] for line in reader):
                if any(fields):
                    yield TableLine(reader.line_num + bool(stated), fields)
        except csv.Error as error:
            raise self.refused(f"{self.name}: no table in CSV ({error})") from None
