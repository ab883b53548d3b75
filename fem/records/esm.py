"""ASCII files of the Engineering Strong-Motion database: lines "KEY: value", then one number in a line."""

import re

from fem.records.fixed_width import read_separated
from fem.records.header import measured, regular_component, require_peak, whole_number
from fem.records.record import PLURALS, Record
from fem.records.source import MotionText
from fem.records.units import settled_unit, unit_in_header, unit_spelled

NAME = "ESM ASCII"
KEY = re.compile(r"([A-Z][A-Z0-9_/^]*)\s*:\s*(.*)")  #: such as PGA_CM/S^2
MOST_LINES = 200  #: of a header; it has 64


def recognises(source: MotionText) -> bool:
    """Whether the first two lines name the event."""
    return source.line(1).startswith("EVENT_NAME:") and source.line(2).startswith("EVENT_ID:")


def read(source: MotionText, unit: str | None) -> Record:
    """Read the one component; a RecordError gives the key or the line that does not fit."""
    header: dict[str, str] = {}
    first = 1
    while first <= MOST_LINES and (match := KEY.match(source.line(first))):
        header[match[1]] = match[2].strip()
        first += 1
    for key in ("SAMPLING_INTERVAL_S", "NDATA", "DATA_TYPE"):
        if not header.get(key):
            raise source.refused(f"the header has no {key}")
    count = whole_number(source, header["NDATA"], "number of samples (NDATA)")
    step = measured(source, header["SAMPLING_INTERVAL_S"], "interval (SAMPLING_INTERVAL_S)")
    spelled = header.get("UNITS", "")
    quantity = next((known for known in PLURALS if known == header["DATA_TYPE"].lower()), None)
    if quantity is None:
        raise source.refused("its DATA_TYPE is neither acceleration nor displacement")
    stated = unit_in_header(source, spelled, quantity) if spelled else None
    settled = settled_unit(stated, unit, source.name)
    readings = read_separated(source, first, count)[0]
    for key, peak in header.items():
        if key.startswith("PGA_") and unit_spelled(key[4:]) == settled[0]:
            require_peak(source, [readings], peak)
    component = regular_component(readings, step, settled, name=header.get("STREAM", ""))
    return Record(
        components=(component,),
        station=header.get("STATION_CODE", ""),
        event=header.get("EVENT_NAME", "") or header.get("EVENT_ID", ""),
        date=header.get("EVENT_DATE_YYYYMMDD", ""),
    )
