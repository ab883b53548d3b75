"""Files of the PEER databases, and others of one component under a line with number and interval of the samples.

PEER has four lines: database; event, date, station, component; "ACCELERATION TIME SERIES IN UNITS OF G"; and "NPTS=
4000, DT= .0050 SEC" in either order, with signs or without, or " 4000 0.0050 NPTS, DT", or the two numbers alone. Then
5 numbers of 15 columns in a line, or numbers between blanks, as many as the header says.
"""

import re

from fem.records.record import PLURALS, Quantity, Record
from fem.records.source import Format, MotionText, regular_component
from fem.records.units import BRACKETS, units_in_words

PER_LINE, WIDTH = 5, 15
HEADING = 8  #: lines in which the header must end
COUNT = re.compile(r"\bNPTS\b\s*[=:]?\s*([^\s,;=:]+)", re.IGNORECASE)
STEP = re.compile(r"\bDT\b\s*[=:]?\s*([^\s,;=:]+(?:\s*(?!NPTS)[a-z]+)?)", re.IGNORECASE)
BEFORE = re.compile(r"\s*(\S+)\s+(\S+)\s+NPTS\s*,?\s*DT\b(.*)", re.IGNORECASE)
QUANTITY = re.compile(
    r"(ACCELERATION|VELOCITY|DISPLACEMENT)(?:\s+TIME\s+(?:SERIES|HISTORY))?\s*,?\s*(?:IN\s+)?UNITS?\s*(?:OF|:|=)?\s*"
    r"\(?([^\s,;()]+)",
    re.IGNORECASE,
)
ALONE = re.compile(r"\s*(\d{1,7})[\s,;]+([\d.]\S*(?:\s+s(?:ec\w*)?)?)\s*", re.IGNORECASE | re.ASCII)
QUANTITIES: dict[str, Quantity] = {name: name for name in PLURALS}


def _recognises(source: MotionText) -> bool:
    """Whether one of the first lines gives number and interval of the samples, and not of rows of columns."""
    last, number, _ = _sampling(source)
    if last == 0:
        return False
    rows = [line for line in source.lines[last:] if line.strip()]
    in_columns = number.isdigit() and len(rows) == int(number) > 1
    return not in_columns or len(rows[0].split()) == 1


def _read(source: MotionText, unit: str | None) -> Record:
    last, counted, interval = _sampling(source)
    count = source.whole_number(counted, "number of samples", last)
    step = source.measured(interval, "interval of the samples", last)
    stated = None
    for line in source.lines[:last]:
        if match := QUANTITY.search(line):
            stated = source.unit_in_header(match[2], QUANTITIES[match[1].lower()])
            break
        if units := units_in_words(line):
            stated = units[0]
            break
    settled = source.settled_unit(stated, unit)
    described = source.line(2) if last == 4 else ""
    # what follows the station is its network or number, in brackets: "090 (CDMG STATION 99999)", "E, (CWB)"
    fields = [field for part in described.split(",") if (field := BRACKETS.sub("", part).strip())]
    name = fields[-1] if len(fields) > 1 else ""
    readings = source.read_values(last + 1, count, per_line=PER_LINE, width=WIDTH)
    component = regular_component(readings, step, settled, name=name)
    event, station = fields[0] if len(fields) > 1 else "", fields[-2] if len(fields) > 2 else ""
    return Record(components=(component,), event=event, station=station)


def _sampling(source: MotionText) -> tuple[int, str, str]:
    """The line of number and interval of the samples, and what it gives; 0 where there is none."""
    for number, line in enumerate(source.lines[:HEADING], start=1):
        if match := BEFORE.match(line):
            return number, match[1], match[2]
        count, step = COUNT.search(line), STEP.search(line)
        if count and step:
            return number, count[1], step[1]
        if alone := ALONE.fullmatch(line):
            if QUANTITY.search(source.line(number - 1)):
                return number, alone[1], alone[2]
            # as many numbers as it says follow, which are not in pairs, as the rows of a table are
            widths = [len(row.split()) for row in source.lines[number:]]
            if sum(widths) == int(alone[1]) > 1 and max(widths) != 2:
                return number, alone[1], alone[2]
    return 0, "", ""


PEER = Format("PEER", _recognises, _read)
