"""Blocks of numbers of a fixed width, as Fortran writes them: negative numbers may touch without a blank."""

import re

from fem.records.source import LARGEST_NUMBER, MotionText, as_numbers, read_rows
from fem.runtime.arrays import FloatArray

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
    """Numbers of a fixed width in full lines, but for the last, shape (count,), and the line behind them.

    Headers write what they do not know as 1.7e38, beyond `largest`.

    Raises:
        RecordError: fewer or more numbers than the header says, or a field that is no number.
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
    """Numbers between blanks, any number of them in a line, up to the end of the file; else as `read_block`."""
    lines = source.lines[first - 1 :]
    total = sum(len(line.split()) for line in lines)
    if total != count:
        raise source.refused(f"the header says {count} values, found {total}")
    rows = ((number, line.split()) for number, line in enumerate(lines, start=first))
    return read_rows(source, rows), len(source.lines) + 1


def read_values(source: MotionText, first: int, count: int, *, per_line: int, width: int) -> FloatArray:
    """Numbers up to the end of the file, in full lines of a fixed width or between blanks, by the first line."""
    line = source.line(first).rstrip()
    fields = [line[at : at + width] for at in range(0, len(line), width)]
    if len(fields) != min(per_line, count) or len(line) % width or as_numbers(fields) is None:
        return read_separated(source, first, count)[0]
    numbers, behind = read_block(source, first, count, per_line=per_line, width=width)
    require_end(source, behind, count)
    return numbers


def require_end(source: MotionText, line: int, count: int) -> None:
    """Refuse a file with content after its numbers."""
    for number in range(line, len(source.lines) + 1):
        if source.line(number).strip():
            raise source.refused(f"the header says {count} values, and more content follows them", number)
