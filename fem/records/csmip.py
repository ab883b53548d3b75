"""Files of CSMIP and CISN (California), volumes 1 and 2, one or more channels one behind the other.

A line states number, interval, unit and format of the values: "13000 points of accel data equally spaced at 0.005 sec,
in cm/sec2. (8f10.6)" of volume 2, which has velocities and displacements behind them, or "31932 Accelerogram points at
100 pts/sec in units of g. Format: (8f9.6)" of volume 1. Only the accelerations are taken.
"""

import re
from dataclasses import dataclass

from fem.records.fixed_width import fortran_format, read_block
from fem.records.header import measured, regular_component, require_peak, whole_number
from fem.records.record import Component, Quantity, Record
from fem.records.source import MotionText
from fem.records.units import RATES, settled_unit, unit_in_header, unit_spelled

NAME = "CSMIP"
TITLE = re.compile(r"\s*(un)?corrected accelerogram|\s*response and fourier", re.IGNORECASE)
SPACED = re.compile(
    r"\s*(\d+)\s+points of (?:\S+ )*?(accel|veloc|displ)\w* data,? equally spaced at\s*(\S+\s*[a-z]+)\.?,?\s*"
    r"\(?(?:in|units[ :=])\s*(?:units of\s*)?([^\s,()]+)",
    re.IGNORECASE | re.ASCII,
)
RATED = re.compile(
    r"\s*(\d+)\s+accel\w* points at\s*(\S+\s*(?:pts|points|samples)/sec\w*)\.?,?\s*in units of\s+([^\s,()]+)",
    re.IGNORECASE | re.ASCII,
)
CHANNEL = re.compile(r"\bChan\s+(\d+):\s*(\S+(?: \S+)*)", re.IGNORECASE | re.ASCII)
PEAK = re.compile(r"\bpeak\s+accel\w*\s*=\s*(\S+)\s*(\S+)", re.IGNORECASE)
LAYOUTS = {"spaced": (8, 10), "rated": (8, 9)}  #: where the line gives no format
QUANTITIES: dict[str, Quantity] = {"accel": "acceleration", "veloc": "velocity", "displ": "displacement"}


def recognises(source: MotionText) -> bool:
    """Whether the first line is a title of the format."""
    return TITLE.match(source.line(1)) is not None


def read(source: MotionText, unit: str | None) -> Record:
    """Read the accelerations of all channels of a file.

    Raises:
        RecordError: a file of spectra, no line that opens data, counts, units or numbers that do not fit.
    """
    if "fourier" in source.line(1).lower():
        raise source.refused("spectra do not move a floor; take the file of volume 1 or 2", 1)
    components: list[Component] = []
    name, line, peak = "", 1, None
    while line <= len(source.lines):
        text = source.line(line)
        opening = _opening(source, line)
        if opening is None:
            match = CHANNEL.search(text)
            name = match[2].split("  ")[0].strip() if match else name
            peak = PEAK.search(text) or peak
            line += 1
            continue
        layout = fortran_format(text) or opening.layout
        first = line + 1
        readings, line = read_block(source, first, opening.count, per_line=layout[0], width=layout[1])
        if opening.quantity == "acceleration":
            stated = unit_in_header(source, opening.unit.rstrip("."), opening.quantity)
            settled = settled_unit(stated, unit, source.name)
            if peak is not None and unit_spelled(peak[2]) == settled[0]:
                require_peak(source, [readings], peak[1], line)
            components.append(regular_component(readings, opening.step, settled, name=name))
    if not components:
        raise source.refused("no line gives number, interval and unit of accelerations")
    return Record(
        components=tuple(components),
        name=source.name,
        format=NAME,
        event=source.line(3).strip(),
        station=_station(source),
    )


@dataclass(frozen=True, kw_only=True)
class _Opening:
    """The line that opens a block of values."""

    count: int
    step: float  #: [s]
    quantity: Quantity
    unit: str
    layout: tuple[int, int]


def _opening(source: MotionText, line: int) -> _Opening | None:
    if match := SPACED.match(source.line(line)):
        return _Opening(
            count=whole_number(source, match[1], "number of samples", line),
            step=measured(source, match[3], "interval of the samples", line),
            quantity=QUANTITIES[match[2].lower()],
            unit=match[4],
            layout=LAYOUTS["spaced"],
        )
    if match := RATED.match(source.line(line)):
        return _Opening(
            count=whole_number(source, match[1], "number of samples", line),
            step=1.0 / measured(source, match[2], "sampling rate", line, units=RATES),
            quantity="acceleration",
            unit=match[3],
            layout=LAYOUTS["rated"],
        )
    return None


def _station(source: MotionText) -> str:
    names = (line.partition("Station No.")[2] for line in source.lines[:13] if "station no." in line.lower())
    return next(names, "").strip().partition(" ")[0]
