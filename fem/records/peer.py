"""Files of the PEER databases: .AT2 accelerations, .VT2 velocities, .DT2 displacements, with both headers.

Four lines: database; event, date, station, component; "ACCELERATION TIME SERIES IN UNITS OF G"; and "NPTS= 4000, DT=
.0050 SEC" or " 4000 0.0050 NPTS, DT". Then 5 numbers of 15 columns in a line, or numbers between blanks.
"""

import re

from fem.records.directions import direction_of
from fem.records.fixed_width import (
    positive_number,
    read_block,
    read_separated,
    regular_component,
    require_end,
    whole_number,
)
from fem.records.record import PLURALS, Quantity, Record
from fem.records.source import MotionText, as_numbers
from fem.records.units import settled_unit, unit_in_header
from fem.runtime.arrays import FloatArray

NAME = "PEER"
PER_LINE, WIDTH = 5, 15
HEADING = 8  #: lines in which the header must end
LABELLED = re.compile(r"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*([-+.\dEe]+)", re.IGNORECASE | re.ASCII)
BEFORE = re.compile(r"\s*(\d+)\s+([-+.\dEe]+)\s+NPTS\s*,?\s*DT\b", re.IGNORECASE | re.ASCII)
QUANTITY = re.compile(
    r"(ACCELERATION|VELOCITY|DISPLACEMENT)\s+TIME\s+(?:SERIES|HISTORY)(?:\s+IN\s+UNITS\s+OF\s+([^\s.,;]+))?",
    re.IGNORECASE,
)

QUANTITIES: dict[str, Quantity] = {name: name for name in PLURALS}


def recognises(source: MotionText) -> bool:
    """Whether one of the first lines gives number and interval of the samples as PEER does."""
    return _sampling_line(source) is not None


def read(source: MotionText, unit: str | None) -> Record:
    """Read the one component of a file.

    Raises:
        RecordError: counts, units or numbers that do not fit; with the line.
    """
    last = _sampling_line(source) or 1
    match = LABELLED.search(source.line(last)) or BEFORE.match(source.line(last))
    count = whole_number(source, match[1] if match else "", "number of samples", last)
    step = positive_number(source, match[2] if match else "", "interval of the samples", last)
    stated = None
    quantity = next((q for q in map(QUANTITY.search, source.lines[:last]) if q), None)
    if quantity is not None and quantity[2]:
        stated = unit_in_header(source, quantity[2], QUANTITIES[quantity[1].lower()])
    settled = settled_unit(stated, unit, source.name)
    described = source.line(2) if last == 4 else ""
    name = described.rpartition(",")[2].strip() if "," in described else ""
    direction, sense = direction_of(name)
    readings = _numbers(source, last + 1, count)
    component = regular_component(readings, step, settled, name=name, direction=direction, sense=sense)
    event, _, station = described.rpartition(",")[0].partition(",")
    return Record(
        components=(component,),
        name=source.name,
        format=NAME,
        event=event.strip(),
        station=station.rpartition(",")[2].strip(),
    )


def _sampling_line(source: MotionText) -> int | None:
    for number, line in enumerate(source.lines[:HEADING], start=1):
        if LABELLED.search(line) or BEFORE.match(line):
            return number
    return None


def _numbers(source: MotionText, first: int, count: int) -> FloatArray:
    line = source.line(first).rstrip()
    fields = [line[at : at + WIDTH] for at in range(0, len(line), WIDTH)]
    full = len(fields) == min(PER_LINE, count) and len(line) % WIDTH == 0 and as_numbers(fields) is not None
    if not full:
        return read_separated(source, first, count)[0]
    numbers, behind = read_block(source, first, count, per_line=PER_LINE, width=WIDTH)
    require_end(source, behind, count)
    return numbers
