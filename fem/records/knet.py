"""Files of K-NET and KiK-net (NIED, Japan): 17 lines of header, then 8 whole numbers in a line.

The scale factor of the header makes them gal; they stand about an offset, so that their mean is subtracted.
"""

import re

from fem.records.directions import direction_of
from fem.records.fixed_width import (
    positive_number,
    read_block,
    read_separated,
    regular_component,
    require_end,
)
from fem.records.record import Record
from fem.records.source import MotionText, as_numbers
from fem.records.units import settled_unit
from fem.runtime.arrays import FloatArray

NAME = "K-NET"
LINES, LABEL = 17, 18  #: of the header, and columns of its labels
PER_LINE, WIDTH = 8, 9
SCALE = re.compile(r"([\d.]+)\s*\(gal\)\s*/\s*([\d.]+)", re.IGNORECASE | re.ASCII)
#: KiK-net numbers its sensors: 1 to 3 in the borehole, 4 to 6 at the surface
SENSORS = {"1": "N-S", "2": "E-W", "3": "U-D", "4": "N-S", "5": "E-W", "6": "U-D"}


def recognises(source: MotionText) -> bool:
    """Whether the header has the labels of NIED."""
    return source.line(1).startswith("Origin Time") and source.line(6).startswith("Station Code")


def read(source: MotionText, unit: str | None) -> Record:
    """Read the one component of a file.

    Raises:
        RecordError: a line of the header, counts, units or numbers that do not fit; with the line.
    """
    rate = positive_number(source, _value(source, 11).lower().removesuffix("hz"), "sampling frequency", 11)
    duration = positive_number(source, _value(source, 12), "duration", 12)
    scale = SCALE.search(source.line(14))
    if scale is None:
        raise source.refused("the header gives no scale factor in gal", 14)
    factor = positive_number(source, scale[1], "scale factor", 14) / positive_number(
        source, scale[2], "scale factor", 14
    )
    settled = settled_unit("gal", unit, source.name)
    count = round(duration * rate)
    if not 1 <= count <= 10**8:
        raise source.refused("the header gives no number of samples", 12)
    counts = _counts(source, count)
    sensor = _value(source, 13)
    direction, _ = direction_of(SENSORS.get(sensor, sensor))
    readings = (counts - counts.mean()) * factor
    component = regular_component(readings, 1.0 / rate, settled, name=sensor, direction=direction)
    return Record(
        components=(component,),
        name=source.name,
        format=NAME,
        station=_value(source, 6),
        date=_value(source, 1),
    )


def _value(source: MotionText, number: int) -> str:
    return source.line(number)[LABEL:].strip()


def _counts(source: MotionText, count: int) -> FloatArray:
    first = LINES + 1
    line = source.line(first).rstrip()
    fields = [line[at : at + WIDTH] for at in range(0, len(line), WIDTH)]
    if len(line) % WIDTH or as_numbers(fields) is None:
        return read_separated(source, first, count)[0]
    numbers, behind = read_block(source, first, count, per_line=PER_LINE, width=WIDTH)
    require_end(source, behind, count)
    return numbers
