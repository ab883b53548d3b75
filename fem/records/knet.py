"""Files of K-NET and KiK-net (NIED, Japan): 17 lines of header, then 8 whole numbers in a line.

The scale factor of the header makes them gal; they stand about an offset, so that their mean is subtracted.
"""

import re

from fem.records.fixed_width import read_values
from fem.records.header import NUMBER, measured, regular_component, require_peak
from fem.records.record import Record
from fem.records.source import MotionText
from fem.records.units import RATES, settled_unit
from fem.records.words import direction_of

NAME = "K-NET"
LINES, LABEL = 17, 18  #: of the header, and columns of its labels
PER_LINE, WIDTH = 8, 9
SCALE = re.compile(rf"({NUMBER})\s*\(gal\)\s*/\s*({NUMBER})", re.IGNORECASE)
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
    step = 1.0 / measured(source, _value(source, 11), "sampling frequency", 11, units=RATES)
    duration = measured(source, _value(source, 12), "duration", 12)
    scale = SCALE.fullmatch(_value(source, 14))
    if scale is None:
        raise source.refused("the header gives no scale factor in gal", 14)
    factor = measured(source, scale[1], "scale factor", 14) / measured(source, scale[2], "scale factor", 14)
    settled = settled_unit("gal", unit, source.name)
    count = round(duration / step)
    if not 1 <= count <= 10**8:
        raise source.refused("the header gives no number of samples", 12)
    counts = read_values(source, LINES + 1, count, per_line=PER_LINE, width=WIDTH)
    sensor = _value(source, 13)
    readings = (counts - counts.mean()) * factor
    require_peak(source, [readings], _value(source, 15), 15)
    component = regular_component(
        readings, step, settled, name=sensor, direction=direction_of(SENSORS.get(sensor, sensor))
    )
    return Record(
        components=(component,),
        name=source.name,
        format=NAME,
        station=_value(source, 6),
        date=_value(source, 1),
    )


def _value(source: MotionText, number: int) -> str:
    return source.line(number)[LABEL:].strip()
