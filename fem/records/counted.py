"""Files of one component under a line with the number of its samples and their interval, "1001 0.01".

Up to `HEADING` lines of title stand before it. The numbers behind it, as many as it says, tell it from a row of a table.
"""

import re

from fem.records.fixed_width import read_separated
from fem.records.header import measured, regular_component, whole_number
from fem.records.record import Record
from fem.records.source import MotionText
from fem.records.units import settled_unit, units_in_words

NAME = "count and interval"
HEADING = 8
LINE = re.compile(r"\s*(\d+)[\s,;]+([\d.]\S*)\s*(?:s|sec\w*)?\s*", re.IGNORECASE | re.ASCII)


def recognises(source: MotionText) -> bool:
    """Whether such a line stands over as many numbers, which are not in pairs."""
    return _counting_line(source) is not None


def read(source: MotionText, unit: str | None) -> Record:
    """Read the one component of a file.

    Raises:
        RecordError: numbers or a unit that do not fit; with the line.
    """
    line = _counting_line(source) or 1
    match = LINE.fullmatch(source.line(line))
    count = whole_number(source, match[1] if match else "", "number of samples", line)
    step = measured(source, match[2] if match else "", "interval of the samples", line)
    title = source.lines[: line - 1]
    stated = next((units[0] for units in map(units_in_words, title) if units), None)
    settled = settled_unit(stated, unit, source.name)
    component = regular_component(read_separated(source, line + 1, count)[0], step, settled, name="")
    return Record(components=(component,), name=source.name, format=NAME)


def _counting_line(source: MotionText) -> int | None:
    for number, line in enumerate(source.lines[:HEADING], start=1):
        match = LINE.fullmatch(line)
        if match is None or len(match[1]) > 7:
            continue
        widths = [len(row.split()) for row in source.lines[number:]]
        if sum(widths) == int(match[1]) > 1 and max(widths) != 2:
            return number
    return None
