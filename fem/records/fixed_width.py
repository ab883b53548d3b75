"""Blocks of numbers of a fixed width, as Fortran writes them: negative numbers may touch without a blank."""

import re

import numpy as np

from fem.records.record import Component, Direction, RecordError
from fem.records.source import LARGEST_NUMBER, MOST_SAMPLES, MotionText, as_numbers, read_rows
from fem.records.units import UNITS
from fem.runtime.arrays import FloatArray

INTERVALS = (1e-6, 10.0)  #: shortest and longest between samples [s]
#: such as (8f10.6), (5E15.7), (10I8), (1P8E10.3)
FORMAT = re.compile(r"\(\s*(?:1P\s*,?\s*)?(\d+)\s*[FEGDI]\s*(\d+)(?:\.\d+)?(?:E\d+)?\s*\)", re.IGNORECASE)


def fortran_format(text: str) -> tuple[int, int] | None:
    """Numbers a line and their width from a Fortran format in a line of text; None where there is none."""
    match = FORMAT.search(text)
    if match is None or not 0 < int(match[1]) <= 100 or not 0 < int(match[2]) <= 100:
        return None
    return int(match[1]), int(match[2])


def read_block(
    source: MotionText, first: int, count: int, *, per_line: int, width: int, largest: float = LARGEST_NUMBER
) -> tuple[FloatArray, int]:
    """Numbers in full lines, but for the last.

    Args:
        source: the file.
        first: line of the first number, from 1.
        count: numbers by the header.
        per_line: numbers in a full line.
        width: columns of each.
        largest: magnitude that a number may have; headers write what they do not know as 1.7e38.

    Returns:
        The numbers, shape (count,), and the line behind them.

    Raises:
        RecordError: fewer or more numbers than in the header, or a field that is no number.
    """
    behind = first + -(-count // per_line)
    lines = [line.rstrip() for line in source.lines[first - 1 : behind - 1]]
    rows = [[line[at : at + width] for at in range(0, len(line), width)] for line in lines]
    for number, row in enumerate(rows, start=first):
        expected = per_line if number < behind - 1 else count - per_line * (len(rows) - 1)
        if len(row) != expected:
            so_far = per_line * (number - first) + len(row)
            raise source.refused(
                f"the header says {count} values, {per_line} in a line of {width} columns each; found {len(row)} in "
                f"this line, {so_far} up to it",
                number,
            )
    if len(rows) < behind - first:
        raise source.refused(f"the header says {count} values, found {sum(map(len, rows))}")
    return read_rows(source, enumerate(rows, start=first), largest), behind


def read_separated(source: MotionText, first: int, count: int) -> tuple[FloatArray, int]:
    """Numbers separated by blanks, any number of them in a line, up to the end of the file.

    Returns and raises as `read_block`.
    """
    lines = source.lines[first - 1 :]
    total = sum(len(line.split()) for line in lines)
    if total != count:
        raise source.refused(f"the header says {count} values, found {total}")
    rows = ((number, line.split()) for number, line in enumerate(lines, start=first))
    return read_rows(source, rows), len(source.lines) + 1


def require_end(source: MotionText, line: int, count: int) -> None:
    """Refuse a file with content after its numbers."""
    for number in range(line, len(source.lines) + 1):
        if source.line(number).strip():
            raise source.refused(f"the header says {count} values, and more content follows them", number)


def whole_number(source: MotionText, text: str, what: str, number: int | None = None) -> int:
    """A count of a header.

    Raises:
        RecordError: it is no whole number above zero, or more than a file may have.
    """
    stripped = text.strip()
    if not stripped.isascii() or not stripped.isdigit() or len(stripped) > 9 or int(stripped) < 1:
        raise source.refused(f"the header gives no {what}", number)
    if int(stripped) > MOST_SAMPLES:
        raise source.refused(f"{stripped} as {what}; at most {MOST_SAMPLES} are read", number)
    return int(stripped)


def positive_number(source: MotionText, text: str, what: str, number: int | None = None) -> float:
    """A number of a header above zero.

    Raises:
        RecordError: it is none.
    """
    numbers = as_numbers([text])
    if numbers is None or not numbers[0] > 0.0:
        raise source.refused(f"the header gives no {what}", number)
    return float(numbers[0])


def regular_component(
    readings: FloatArray,
    step: float,
    unit: tuple[str, bool],
    *,
    name: str,
    direction: Direction | None,
    sense: float = 1.0,
) -> Component:
    """A component of evenly spaced samples from t = 0.

    Args:
        readings: as the file gives them, (n,).
        step: between the samples [s].
        unit: as by `settled_unit`.
        name, direction: of the component.
        sense: -1 where the readings are positive downward.

    Raises:
        RecordError: no sensor has such an interval.
    """
    require_interval(step, "the header gives")
    return Component(
        times=np.arange(readings.size, dtype=np.float64) * step,
        readings=readings,
        factor=sense * UNITS[unit[0]].factor,
        quantity=UNITS[unit[0]].quantity,
        unit=unit[0],
        unit_stated=unit[1],
        name=name,
        direction=direction,
    )


def require_interval(step: float, subject: str) -> None:
    """Refuse an interval [s] that no sensor has.

    Raises:
        RecordError: beginning with `subject`, such as "the header gives".
    """
    if not INTERVALS[0] <= step <= INTERVALS[1]:
        raise RecordError(
            f"{subject} an interval of {step:g} s; it must be between {INTERVALS[0]:g} and {INTERVALS[1]:g} s"
        )
