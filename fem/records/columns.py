"""Columns of numbers: values with a sampling interval; time and value; or time, horizontal and vertical value.

Columns are separated by semicolons, tabs, commas or blanks; decimals by points, or by commas where these do not
separate. `#` starts a comment. Lines before the first number are a header, whose units must agree with the given one.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice

import numpy as np

from fem.records.fixed_width import require_interval
from fem.records.record import Component, Direction, Record
from fem.records.source import BLOCK, LARGEST_NUMBER, MotionText, as_numbers, read_rows
from fem.records.units import UNITS, settled_unit, unit_spelled
from fem.runtime.arrays import FloatArray

NAME = "columns"
GIVEN = "motion.csv"  #: file name of a motion that was given by arrays
MOST_COLUMNS = 3
MOST_HEADER = 1000  #: lines
NOT_NUMBERS = ("nan", "inf", "+inf", "-inf")
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(\s+[-+]?\d+,\d+)+\s*", re.ASCII)
#: bounded: a line of brackets would be scanned for each of them
BRACKETED = re.compile(r"[\[(]([^\])]{0,40})[\])]")
DIRECTIONS: dict[int, tuple[Direction | None, ...]] = {1: (None,), 2: (None,), 3: ("horizontal", "vertical")}


def read_columns(source: MotionText, *, unit: str | None, sample_interval: float | None) -> Record:
    """Read a file of one, two or three columns.

    Raises:
        RecordError: with the line: no numbers, another number of columns, contradicting units, no unit.
    """
    top = list(islice(_contents(source.lines), MOST_HEADER))
    begin = next((k for k, (_, line) in enumerate(top) if _is_data(line)), None)
    if begin is None:
        raise source.refused("no numbers were found; a motion file is needed")
    header, (first, line) = top[:begin], top[begin]
    separator, decimal_comma = _separators(line)
    table = _table(source, first, separator, decimal_comma)
    count = table.shape[1]
    if count == 1 and sample_interval is None:
        raise source.refused("one column without times: give the interval as sample_interval_s")
    if count > 1 and sample_interval is not None:
        raise source.refused(
            f"sample_interval_s is for a file of one column, and {count} were found"
            + ("; write decimals with a point" if separator == "," else "")
        )
    has_time = count > 1
    stated = _stated_units(source, header, count)
    if has_time and stated[0] not in (None, "s"):
        raise source.refused(f"the header gives times in {stated[0]!r}; they must be in s", header[-1][0])
    times: FloatArray = (
        table[:, 0] if has_time else np.arange(len(table), dtype=np.float64) * (sample_interval or 1.0)
    )
    _require_increasing(source, times, first)
    if len(times) > 1:
        require_interval(float(np.median(np.diff(times))), "the samples have")
    components = []
    for column, direction in enumerate(DIRECTIONS[count], start=int(has_time)):
        settled, by_file = settled_unit(stated[column], unit, source.name)
        components.append(
            Component(
                times=times,
                readings=table[:, column],
                factor=UNITS[settled].factor,
                quantity=UNITS[settled].quantity,
                unit=settled,
                unit_stated=by_file,
                name="" if direction is None else direction,
                direction=direction,
            )
        )
    return Record(components=tuple(components), name=source.name, format=NAME)


def _contents(lines: Sequence[str], first: int = 1) -> Iterator[tuple[int, str]]:
    """The lines from number `first` on, with their numbers, without comments and empty lines."""
    for number, line in enumerate(lines, start=first):
        content = (line.partition("#")[0] if "#" in line else line).strip()
        if content:
            yield number, content


def _is_data(line: str) -> bool:
    """Whether a line is meant as numbers: its first field is one, or none of them is a word."""
    fields = re.split(r"[;,\s]+", line)
    return as_numbers(fields[:1]) is not None or all(
        field.lower() in NOT_NUMBERS or as_numbers([field]) is not None for field in fields
    )


def _separators(line: str) -> tuple[str | None, bool]:
    """What separates columns (None: blanks), and whether a comma is the decimal mark, from the first line of data."""
    for mark in (";", "\t"):
        if mark in line:
            return mark, "," in line
    if DECIMAL_COMMA.fullmatch(line):
        return None, True
    return ("," if "," in line else None), False


def _table(source: MotionText, first: int, separator: str | None, decimal_comma: bool) -> FloatArray:
    """The numbers from the line `first` on, shape (n, columns)."""
    count = len(source.line(first).partition("#")[0].strip().split(separator))
    if count > MOST_COLUMNS:
        raise source.refused(
            f"{count} columns; a motion has one (with sample_interval_s), two (time, value) or three (time, "
            "horizontal, vertical)",
            first,
        )

    def rows(lines: Sequence[str], start: int) -> Iterator[tuple[int, list[str]]]:
        for number, line in _contents(lines, start):
            if decimal_comma and "." in line:
                raise source.refused("decimal commas and decimal points in one file; use one of them", number)
            row = (line.replace(",", ".") if decimal_comma else line).split(separator)
            if len(row) != count:
                raise source.refused(
                    f"{count} columns are needed as in line {first}, found {len(row)}", number
                )
            yield number, row

    blocks = []
    for start in range(first, len(source.lines) + 1, BLOCK):
        lines = source.lines[start - 1 : start - 1 + BLOCK]
        table = _plain_table(lines, separator, decimal_comma, count)
        blocks.append(read_rows(source, rows(lines, start)) if table is None else table)
    return np.concatenate(blocks, axis=None).reshape(-1, count)


def _plain_table(
    lines: Sequence[str], separator: str | None, decimal_comma: bool, count: int
) -> FloatArray | None:
    """Lines of numbers alone, read by numpy, many times faster; None where they hold anything else."""
    if not lines[0].strip() or (decimal_comma and any("." in line for line in lines)):
        return None
    points = [line.replace(",", ".") for line in lines] if decimal_comma else lines
    try:
        table = np.loadtxt(points, delimiter=separator, comments=None, ndmin=2)
    except ValueError:
        return None
    plain = table.shape == (len(lines), count) and bool((np.abs(table) <= LARGEST_NUMBER).all())
    return table if plain else None


def _require_increasing(source: MotionText, times: FloatArray, first: int) -> None:
    back = np.flatnonzero(np.diff(times) <= 0.0)
    if back.size:
        row = int(back[0])
        how = "occurs twice" if times[row] == times[row + 1] else "is earlier than that of the line before"
        number, _ = next(islice(_contents(source.lines[first - 1 :], first), row + 1, None))
        raise source.refused(f"times must increase, but time {times[row + 1]:g} s {how}", number)


def _stated_units(source: MotionText, header: list[tuple[int, str]], count: int) -> list[str | None]:
    """Unit of each column as the header states it; None where it does not."""
    units: list[str | None] = [None] * count
    for number, line in header:
        for column, unit in enumerate(_units_in(line, count)):
            if column >= count:
                raise source.refused(f"the header names more units than the {count} columns have", number)
            if unit is not None and units[column] not in (None, unit):
                raise source.refused(f"the header gives two units for column {column + 1}", number)
            units[column] = unit or units[column]
    return units


def _units_in(line: str, count: int) -> list[str | None]:
    """Units in a line of the header, by column."""
    fields = re.split(r"[;,\t]" if re.search(r"[;,\t]", line) else r"\s+", line)
    if len(fields) == count:
        return [_unit_of(field) for field in fields]
    # "time (s) acc (g)" splits at its blanks; only what stands in brackets matters.
    spelled = (unit_spelled(text) for text in BRACKETED.findall(line))
    units = [unit for unit in spelled if unit is not None]
    if len(units) == 1 and units != ["s"]:  # one unit, of all values
        return [None] * (count > 1) + units * max(1, count - 1)
    return list(units)


def _unit_of(field: str) -> str | None:
    """The unit in the name of a column: in brackets, behind an underscore, or the whole name."""
    if bracketed := BRACKETED.search(field):
        return unit_spelled(bracketed.group(1))
    parts = field.split("_")[-2:]  # no unit has more, such as m_s2
    spelled = (unit_spelled("_".join(parts[k:])) for k in range(len(parts)))
    return next((unit for unit in spelled if unit is not None), None)


def given_record(times: FloatArray, accelerations: Mapping[Direction, FloatArray]) -> Record:
    """A record of accelerations in m/s2, by direction, at the same times.

    Raises:
        RecordError: numbers that are no motion, or not as many as there are times.
    """
    return Record(
        components=tuple(
            Component(times=times, readings=values, name=direction, direction=direction)
            for direction, values in accelerations.items()
        ),
        name=GIVEN,
        format=NAME,
    )


def written(record: Record) -> str:
    """Times and SI values of all components as a file of columns, which reads back to the same bits."""
    columns = [record.components[0].times, *(component.values for component in record.components)]
    names = (
        ["acceleration_m_s2"]
        if len(columns) == 2
        else [f"{component.name}_m_s2" for component in record.components]
    )
    rows = map(",".join, zip(*(map(repr, column.tolist()) for column in columns), strict=True))
    return "\n".join([",".join(["time_s", *names]), *rows, ""])
