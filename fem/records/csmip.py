"""Files of CSMIP and CISN (California), volumes 1 and 2, one or more channels one behind the other.

A line states number, interval, unit and format of the values: "13000 points of accel data equally spaced at 0.005 sec,
in cm/sec2. (8f10.6)" of volume 2, which has velocities and displacements behind them, or "31932 Accelerogram points at
100 pts/sec in units of g. Format: (8f9.6)" of volume 1. Only the accelerations are taken.
"""

import re

from fem.records.record import Component, Record
from fem.records.source import Format, MotionText, fortran_format, regular_component
from fem.records.units import RATES, TIMES, unit_spelled

TITLE = re.compile(r"\s*(un)?corrected accelerogram|\s*response and fourier", re.IGNORECASE)
OPENING = re.compile(
    r"\s*(?P<count>\d+)\s+(?:points of (?:\S+ )*?)?(?P<quantity>accel|veloc|displ)\w*"
    r"(?: data,? equally spaced| points) at\s*(?P<step>\S+\s*[a-z]+(?P<rate>/sec\w*)?)\.?,?\s*"
    r"\(?(?:in|units[ :=])\s*(?:units of\s*)?(?P<unit>[^\s,()]+)",
    re.IGNORECASE | re.ASCII,
)
CHANNEL = re.compile(r"\bChan\s+(\d+):\s*(\S+(?: \S+)*)", re.IGNORECASE | re.ASCII)
PEAK = re.compile(r"\bpeak\s+accel\w*\s*=\s*(\S+)\s*(\S+)", re.IGNORECASE)
LAYOUTS = ((8, 10), (8, 9))  #: of volumes 2 and 1, where the line gives no format


def _read(source: MotionText, unit: str | None) -> Record:
    if "fourier" in source.line(1).lower():
        raise source.refused("spectra do not move a floor; take the file of volume 1 or 2", 1)
    components: list[Component] = []
    name, line, peak = "", 1, None
    while line <= len(source.lines):
        text = source.line(line)
        opening = OPENING.match(text)
        if opening is None:
            match = CHANNEL.search(text)
            name = match[2].split("  ")[0].strip() if match else name
            peak = PEAK.search(text) or peak
            line += 1
            continue
        first, rated, taken = line, opening["rate"], opening["quantity"].lower() == "accel"
        count = source.whole_number(opening["count"], "number of samples", first)
        units = RATES if rated else TIMES
        stated = source.measured(opening["step"], "interval of the samples", first, units=units)
        layout = fortran_format(text) or LAYOUTS[bool(rated)]
        readings, line = source.read_block(first + 1, count, per_line=layout[0], width=layout[1])
        if taken:
            spelled = source.unit_in_header(opening["unit"].rstrip("."), "acceleration")
            settled = source.settled_unit(spelled, unit)
            if peak is not None and unit_spelled(peak[2]) == settled[0]:
                source.require_peak([readings], peak[1], first)
            step = 1.0 / stated if rated else stated
            components.append(regular_component(readings, step, settled, name=name))
    if not components:
        raise source.refused("no line gives number, interval and unit of accelerations")
    names = (line.partition("Station No.")[2] for line in source.lines[:13] if "station no." in line.lower())
    station = next(names, "").strip().partition(" ")[0]
    return Record(components=tuple(components), event=source.line(3).strip(), station=station)


CSMIP = Format("CSMIP", lambda source: TITLE.match(source.line(1)), _read)
