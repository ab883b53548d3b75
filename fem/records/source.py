"""The text of a motion file, from bytes in any of the usual encodings; binary, empty and huge files are refused.

Messages name the line and never quote it: a file that is no motion may hold confidential content.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from fem.records.record import RecordError
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


@dataclass(frozen=True)
class MotionText:
    """Lines of a file, and the name by which messages call it."""

    name: str
    lines: list[str]

    def line(self, number: int) -> str:
        """A line, from 1; empty behind the end."""
        return self.lines[number - 1] if number <= len(self.lines) else ""

    def refused(self, why: str, number: int | None = None) -> RecordError:
        """The error that names the file and the line."""
        return RecordError(f"{self.name}{f', line {number}' if number else ''}: {why}")


def read_source(path: Path) -> MotionText:
    """Read the text of a file; RecordError: no such file, empty, too large, or no text in lines."""
    try:
        content = read_regular(path, LARGEST_FILE)
    except ValueError as error:
        raise RecordError(f"motion file {path} {error}") from None
    if not content or content.isspace():
        raise RecordError(f"{path.name}: the file is empty")
    if max(content.count(b"\n"), content.count(b"\r")) > MOST_SAMPLES or _has_long_line(content):
        raise RecordError(
            f"{path.name}: a motion file may have at most {MOST_SAMPLES} lines of {LONGEST_LINE} characters each"
        )
    text = decoded(content)
    del content  # a file may be large
    if text is None or CONTROL.search(text):
        raise RecordError(f"{path.name}: not a text file; a motion file holds numbers as text")
    return MotionText(path.name, text.rstrip("\x1a \n").split("\n"))


def _has_long_line(content: bytes) -> bool:
    at = 0
    while at + LONGEST_LINE < len(content):
        at = 1 + max(content.rfind(end, at, at + LONGEST_LINE + 1) for end in (b"\n", b"\r"))
        if at == 0:
            return True
    return False


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


def read_rows(
    source: MotionText, rows: Iterable[tuple[int, list[str]]], largest: float = LARGEST_NUMBER
) -> FloatArray:
    """The numbers of rows of fields, each with its line, in one array of shape (n,).

    By blocks: the fields of a long file do not fit into little memory, and a bad one is looked for in its block only.
    """
    remaining, blocks = iter(rows), [np.empty(0)]
    while block := list(islice(remaining, BLOCK)):
        numbers = as_numbers([field for _, row in block for field in row], largest)
        if numbers is None:
            wrong = next(number for number, row in block if as_numbers(row, largest) is None)
            raise source.refused("not a number, or too large for one (no unit, no text)", wrong)
        blocks.append(numbers)
    return np.concatenate(blocks)
