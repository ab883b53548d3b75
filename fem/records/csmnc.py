"""Files of the China Strong Motion Networks Center: sixteen lines of header, then the numbers of one component.

"COMP. EW"; "UNCORRECTED ACCELERATION UNIT: CM/SEC/SEC"; "NO. OF POINTS: 12000 EQUALLY SPACED INTERVALS OF: 0.005 SEC";
"PEAK VALUE: -1005.350 AT 26.35 SEC DURATION: 60 SEC".
"""

import re

from fem.records.fixed_width import read_separated
from fem.records.header import measured, regular_component, require_length, require_peak, whole_number
from fem.records.record import PLURALS, Quantity, Record
from fem.records.source import MotionText
from fem.records.units import settled_unit, unit_in_header

NAME = "CSMNC"
HEADING = 16
COUNT = re.compile(
    r"\s*NO\. OF POINTS:\s*(\S+)\s+EQUALLY SPACED INTERVALS OF:\s*(\S+\s*[A-Z]*)\s*", re.IGNORECASE
)
UNIT = re.compile(r"(ACC+ELERATION|VELOCITY|DISPLACEMENT)\s+UNIT:\s*(\S+)", re.IGNORECASE)
PEAK = re.compile(r"\s*PEAK VALUE:\s*(\S+)(?:.*\bDURATION:\s*(\S+\s*[A-Z]*))?", re.IGNORECASE)
COMPONENT = re.compile(r"\s*COMP\.?\s+(.*)", re.IGNORECASE)


def recognises(source: MotionText) -> bool:
    """Whether a line of the header gives number and interval of the points as these files do."""
    return any(map(COUNT.fullmatch, source.lines[:HEADING]))


def read(source: MotionText, unit: str | None) -> Record:
    """Read the one component; a RecordError gives the line that does not fit."""
    header = source.lines[:HEADING]
    line, counted = next((k, m) for k, m in enumerate(map(COUNT.fullmatch, header), start=1) if m)
    count = whole_number(source, counted[1], "number of samples", line)
    step = measured(source, counted[2], "interval of the samples", line)
    spelled = next((m for m in map(UNIT.search, header) if m), None)
    quantity: Quantity = next(
        (q for q in PLURALS if spelled and spelled[1].casefold().startswith(q[:3])), "acceleration"
    )
    stated = unit_in_header(source, spelled[2], quantity) if spelled else None
    settled = settled_unit(stated, unit, source.name)
    last = 1 + max(k for k, text in enumerate(header) if re.search("[a-z]{3}", text, re.IGNORECASE))
    readings = read_separated(source, last + 1, count)[0]
    if peak := next((m for m in map(PEAK.match, header) if m), None):
        require_peak(source, [readings], peak[1])
        if peak[2]:
            require_length(source, measured(source, peak[2], "duration"), count, step)
    name = next((m[1].strip() for m in map(COMPONENT.match, header) if m), "")
    component = regular_component(readings, step, settled, name=name)
    station = source.line(6).partition(":")[2].strip().partition(" ")[0]
    return Record(components=(component,), station=station, event=source.line(3).strip())
