"""The text of a motion file, the numbers that its header states, and those below it.

Text comes in any of the usual encodings; binary, empty and huge files are refused. Messages name the line and never
quote it: a file that is no motion may hold confidential content.

One parser for every format: a number is a whole word, with its unit behind it; it must be one from end to end, so that
no part of one is taken for it. A Fortran exponent D is one; a fraction is none. In blocks of a fixed width, as Fortran
writes them, negative numbers may touch without a blank.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fem.records.record import PLURALS, Component, Direction, Quantity, Record, RecordError
from fem.records.units import OTHERWISE, STATED, TIMES, UNITS, direction_of, unit_spelled
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import read_regular

LARGEST_FILE = 32 * 2**20  #: [bytes]
LONGEST_LINE = 1000  #: [bytes]
MOST_SAMPLES = 1_000_000  #: of a component, and lines of a file: more than an hour at 200 samples in a second
BLOCK = 10_000  #: rows that are read together
LARGEST_NUMBER = 1e12  #: of seconds or of any unit: above it the integrals of the motion are meaningless
CONTROL = re.compile(r"[\x00-\x08\x0e-\x19\x1b-\x1f\x7f]")
NUMERIC = re.compile(r"[-+.0-9eE \t]*", re.ASCII)
TWO_BYTES = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
INTERVALS = (1e-6, 10.0)  #: shortest and longest between samples [s]
NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[EeDd][-+]?[0-9]+)?"
WORD = re.compile(rf"({NUMBER})\s*(?:[\[(]?\s*([A-Za-zµμ%][^\s\[\]()]*|1/s)\s*[\])]?)?")
#: difference of a stated peak from that of the values from which they contradict each other, over the larger: far
#: above what a correction changes, far below a wrong unit
CONTRADICTION = 0.1
#: such as (8f10.6), (5E15.7), (10I8), (1P8E10.3)
LAYOUT = re.compile(r"\(\s*(?:1P\s*,?\s*)?(\d+)\s*[FEGDI]\s*(\d+)(?:\.\d+)?(?:E\d+)?\s*\)", re.IGNORECASE)


@dataclass(frozen=True)
class MotionText:
    """Lines of a file, and the name by which messages call it.

    What does not fit is a RecordError, which gives the line.
    """

    name: str
    lines: list[str]

    def line(self, number: int) -> str:
        """A line, from 1; empty behind the end."""
        return self.lines[number - 1] if number <= len(self.lines) else ""

    def refused(self, why: str, number: int | None = None) -> RecordError:
        """The error that names the file and the line."""
        return RecordError(f"{self.name}{f', line {number}' if number else ''}: {why}")

    def measured(
        self, text: str, what: str, line: int | None = None, *, units: Mapping[str, float] = TIMES
    ) -> float:
        """A number of a header above zero, in the unit whose factor is 1, as it is where none stands behind the number.

        Refused, about `what`: it is no number from end to end, not above zero, or in none of these units.
        """
        match = WORD.fullmatch(text.strip())
        numbers = as_numbers([match[1]]) if match else None
        if match is None or numbers is None or not numbers[0] > 0.0:
            raise self.refused(f"the header gives no {what}", line)
        unit = "" if match[2] is None else unit_spelled(match[2]) or "?"
        if unit and unit not in units:
            named = "a unit that is not known" if unit == "?" else repr(unit)
            raise self.refused(f"the header gives the {what} in {named}; known: {', '.join(units)}", line)
        return float(numbers[0]) * (units[unit] if unit else 1.0)

    def whole_number(self, text: str, what: str, line: int | None = None) -> int:
        """A count of a header; refused: it is no whole number above zero, or more than a file may have."""
        stripped = text.strip().removesuffix(".")
        if not stripped.isascii() or not stripped.isdigit() or len(stripped) > 9 or int(stripped) < 1:
            raise self.refused(f"the header gives no {what}", line)
        if int(stripped) > MOST_SAMPLES:
            raise self.refused(f"{stripped} as {what}; at most {MOST_SAMPLES} are read", line)
        return int(stripped)

    def unit_in_header(self, spelled: str, quantity: Quantity) -> str:
        """The unit that a header spells for a quantity; refused: it is not known, or measures something else."""
        unit = unit_spelled(spelled)
        if unit is None:
            raise self.refused(f"the header gives {PLURALS[quantity]} in a unit that is not known")
        if unit in UNITS and UNITS[unit].quantity != quantity:
            raise self.refused(
                f"the header gives {PLURALS[quantity]} in {unit!r}, which measures {PLURALS[UNITS[unit].quantity]}"
            )
        return unit

    def settled_unit(self, stated: str | None, given: str | None) -> tuple[str, bool]:
        """The unit of some values, and whether the file states it; refused: none, two, or one not read."""
        if stated is None and given is None:
            raise self.refused(f"the file does not state the unit of its values; {OTHERWISE}")
        if stated is not None and stated not in UNITS:
            raise self.refused(
                f"the header gives {stated!r}, which is not read; convert the values to one of {', '.join(STATED)}"
            )
        if stated is not None and given is not None and UNITS[stated] != UNITS[given]:
            raise self.refused(
                f"the file states {stated!r}, but unit = {given!r} is given; correct one of them"
            )
        return stated or given or "", stated is not None

    def require_peak(self, values: Sequence[FloatArray], text: str, line: int | None = None) -> None:
        """Refuse components of which none has the peak that the file states in their unit; no number states nothing."""
        match = WORD.fullmatch(text.strip())
        numbers = as_numbers([match[1]]) if match else None
        if numbers is None or not numbers[0]:
            return
        stated = abs(float(numbers[0]))
        found = min((float(np.abs(one).max()) for one in values), key=lambda peak: abs(peak - stated))
        if abs(stated - found) > CONTRADICTION * max(stated, found):
            raise self.refused(
                f"the header states a peak of {stated:g}, and the values reach {found:g} in the same unit; one of them "
                "is wrong, or the unit, or the scale",
                line,
            )

    def require_length(self, length: float, count: int, step: float, line: int | None = None) -> None:
        """Refuse a length [s] that is not that of the samples."""
        if not abs(length - count * step) <= 2.0 * step + 1e-3 * length:
            raise self.refused(
                f"the header gives a length of {length:g} s, and {count} samples {step:g} s apart take "
                f"{count * step:g} s",
                line,
            )

    def require_count(self, count: int, stated: int, line: int | None = None) -> None:
        """Refuse another number of samples than the file states."""
        if count != stated:
            raise self.refused(f"the header says {stated} values, found {count}", line)

    def require_end(self, line: int, count: int) -> None:
        """Refuse a file with content after its numbers."""
        for number in range(line, len(self.lines) + 1):
            if self.line(number).strip():
                raise self.refused(f"the header says {count} values, and more content follows them", number)

    def read_rows(self, rows: Iterable[tuple[int, list[str]]], largest: float = LARGEST_NUMBER) -> FloatArray:
        """The numbers of rows of fields, each with its line, in one array of shape (n,).

        By blocks: the fields of a long file do not fit into little memory; a bad one is looked for in its block only.
        """
        remaining, blocks = iter(rows), [np.empty(0)]
        while block := list(islice(remaining, BLOCK)):
            numbers = as_numbers([field for _, row in block for field in row], largest)
            if numbers is None:
                wrong = next(number for number, row in block if as_numbers(row, largest) is None)
                raise self.refused("not a number, or too large for one (no unit, no text)", wrong)
            blocks.append(numbers)
        return np.concatenate(blocks)

    def read_separated(self, first: int, count: int) -> FloatArray:
        """Numbers between blanks, any number of them in a line, up to the end of the file; else as `read_block`."""
        lines = self.lines[first - 1 :]
        self.require_count(sum(len(line.split()) for line in lines), count)
        return self.read_rows(((number, line.split()) for number, line in enumerate(lines, start=first)))

    def read_block(
        self, first: int, count: int, *, per_line: int, width: int, largest: float = LARGEST_NUMBER
    ) -> tuple[FloatArray, int]:
        """Numbers of a fixed width in full lines, but for the last, shape (count,), and the line behind them.

        Headers write what they do not know as 1.7e38, beyond `largest`. Refused: fewer or more numbers than the header
        says, or a field that is no number.
        """
        behind = first + -(-count // per_line)
        lines = [line.rstrip() for line in self.lines[first - 1 : behind - 1]]
        rows = [[line[at : at + width] for at in range(0, len(line), width)] for line in lines]
        for number, row in enumerate(rows, start=first):
            expected = per_line if number < behind - 1 else count - per_line * (len(rows) - 1)
            if len(row) != expected:
                so_far = per_line * (number - first) + len(row)
                raise self.refused(
                    f"the header says {count} values, {per_line} in a line of {width} columns each; found {len(row)} "
                    f"in this line, {so_far} up to it",
                    number,
                )
        if len(rows) < behind - first:
            self.require_count(sum(map(len, rows)), count)
        return self.read_rows(enumerate(rows, start=first), largest), behind

    def read_values(self, first: int, count: int, *, per_line: int, width: int) -> FloatArray:
        """Numbers up to the end of the file, in full lines of a fixed width or between blanks, by the first line."""
        line = self.line(first).rstrip()
        fields = [line[at : at + width] for at in range(0, len(line), width)]
        if len(fields) != min(per_line, count) or len(line) % width or as_numbers(fields) is None:
            return self.read_separated(first, count)
        numbers, behind = self.read_block(first, count, per_line=per_line, width=width)
        self.require_end(behind, count)
        return numbers


class Format(NamedTuple):
    """A format with a header of its own."""

    name: str
    recognises: Callable[[MotionText], object]  #: whether its header is there
    #: all components, for the unit that is given; a RecordError gives the line that does not fit
    read: Callable[[MotionText, str | None], Record]


def read_source(path: Path) -> MotionText:
    """Read the text of a file; RecordError: no such file, empty, too large, or no text in lines."""
    try:
        content = read_regular(path, LARGEST_FILE)
    except ValueError as error:
        raise RecordError(f"motion file {path} {error}") from None
    if not content or content.isspace():
        raise RecordError(f"{path.name}: the file is empty")
    at, too_long = 0, max(content.count(b"\n"), content.count(b"\r")) > MOST_SAMPLES
    while not too_long and at + LONGEST_LINE < len(content):
        at = 1 + max(content.rfind(end, at, at + LONGEST_LINE + 1) for end in (b"\n", b"\r"))
        too_long = at == 0
    if too_long:
        raise RecordError(
            f"{path.name}: a motion file may have at most {MOST_SAMPLES} lines of {LONGEST_LINE} characters each"
        )
    text = decoded(content)
    del content  # a file may be large
    if text is None or CONTROL.search(text):
        raise RecordError(f"{path.name}: not a text file; a motion file holds numbers as text")
    return MotionText(path.name, text.rstrip("\x1a \n").split("\n"))


def decoded(content: bytes) -> str | None:
    """UTF-16 with a byte order mark, UTF-8, else Latin-1, which any bytes can be.

    With the ends of lines of Python, and the minus that programs write for a typographic one.
    """
    encodings = [TWO_BYTES[content[:2]]] if content[:2] in TWO_BYTES else ["utf-8-sig", "latin-1"]
    for encoding in encodings:
        try:
            text = content.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
            return text.replace("\N{MINUS SIGN}", "-")
        except UnicodeDecodeError:
            continue
    return None


def as_numbers(fields: list[str], largest: float = LARGEST_NUMBER) -> FloatArray | None:
    """Fields as numbers, shape (n,); None where one is no number or larger than it may be.

    Stricter than float(), which takes "1_000", "nan" and digits of other scripts; a Fortran exponent D is taken.
    """
    text = " ".join(fields)
    if not NUMERIC.fullmatch(text):
        text = text.replace("D", "E").replace("d", "e")
        if not NUMERIC.fullmatch(text):
            return None
        fields = [field.replace("D", "E").replace("d", "e") for field in fields]
    try:
        numbers = np.fromiter(map(float, fields), np.float64, len(fields))
    except ValueError:
        return None
    return numbers if (np.abs(numbers) <= largest).all() else None


def fortran_format(text: str) -> tuple[int, int] | None:
    """Numbers a line and their width from a Fortran format in a line of text; None where there is none."""
    match = LAYOUT.search(text)
    if match is None or not 0 < int(match[1]) <= 100 or not 0 < int(match[2]) <= 100:
        return None
    return int(match[1]), int(match[2])


def require_interval(step: float, subject: str) -> None:
    """Refuse an interval [s] that no sensor has; the message begins with `subject`, such as "the header gives"."""
    if not INTERVALS[0] <= step <= INTERVALS[1]:
        raise RecordError(
            f"{subject} an interval of {step:g} s; it must be between {INTERVALS[0]:g} and {INTERVALS[1]:g} s"
        )


def regular_component(
    readings: FloatArray,
    step: float,
    unit: tuple[str, bool],
    *,
    name: str,
    direction: tuple[Direction | None, float] | None = None,
) -> Component:
    """A component of samples as the file gives them, `step` apart from t = 0 [s].

    The unit is as by `settled_unit`, the direction as by `direction_of`; None: by its name.
    """
    require_interval(step, "the header gives")
    along, sense = direction or direction_of(name)
    return Component(
        times=np.arange(readings.size, dtype=np.float64) * step,
        readings=readings,
        factor=sense * UNITS[unit[0]].factor,
        quantity=UNITS[unit[0]].quantity,
        unit=unit[0],
        unit_stated=unit[1],
        name=name,
        direction=along,
    )
