"""COSMOS files, volumes 1 and 2, one or more channels one behind the other.

A channel has lines of text, whole numbers, reals, comments and data; each block after the text is opened by a line with
the number of its values and its Fortran format, or of its lines. Units and directions are codes. Source: COSMOS Strong
Motion Data Format (2001), tables 1 to 8.
"""

import re

from fem.records.record import Component, Direction, Record
from fem.records.source import Format, MotionText, fortran_format, regular_component
from fem.records.units import UNITS, direction_of, stream_direction, unit_spelled
from fem.runtime.arrays import FloatArray

TITLE = re.compile(r"\(format v\s*[\d.]+\s+with\s+(\d+)\s+text lines\)", re.IGNORECASE | re.ASCII)
BLOCK = re.compile(r"\s*(\d+)\s+(.*)", re.ASCII)
CHANNEL = re.compile(r"Chan\s+(\d+):\s*(\S+(?: \S+)*)", re.IGNORECASE | re.ASCII)
SPELLED = re.compile(r"units\s*=\s*([^\s,(]+)", re.IGNORECASE)
END = re.compile(r"end[- ]of[- ]data", re.IGNORECASE)
UNIT_CODES = {
    2: "g", 4: "cm/s2", 5: "cm/s", 6: "cm", 7: "in/s2", 8: "in/s", 9: "in", 10: "gal", 11: "mg", 50: "counts",
    51: "volts",
}  # fmt: skip
DIRECTION_CODES: dict[int, tuple[Direction, float]] = {
    400: ("vertical", 1.0), 401: ("vertical", -1.0), 402: ("vertical", 1.0), 500: ("horizontal", 1.0),
    501: ("horizontal", 1.0), 600: ("horizontal", 1.0), 601: ("horizontal", 1.0), 700: ("horizontal", 1.0),
    701: ("horizontal", 1.0),
}  # fmt: skip
UNKNOWN = -999.0
#: places in the reals: interval in ms, length in s
INTERVAL, LENGTH = 61, 62
STREAM = re.compile(r"(?:<SCNL>|RcrdId:)\s*\S*?\.([A-Z][NLGH][A-Z0-9])\b")  #: such as <SCNL>BMR.BNZ.AK.--
#: places in the whole numbers: unit, azimuth
UNIT, AZIMUTH = 2, 53


def _read(source: MotionText, unit: str | None) -> Record:
    components, line = [], 1
    while line <= len(source.lines):
        component, line = _channel(source, line, unit)
        components.append(component)
        while line <= len(source.lines) and not TITLE.search(source.line(line)):
            if source.line(line).strip() and not END.search(source.line(line)):
                raise source.refused("a channel or the end of the file is needed here", line)
            line += 1
    station = source.line(5).partition(":")[2].strip()
    return Record(components=tuple(components), event=source.line(2).strip(), station=station)


def _channel(source: MotionText, line: int, unit: str | None) -> tuple[Component, int]:
    """One channel that begins at a line, and the line behind it."""
    title = TITLE.search(source.line(line))
    text = int(title[1]) if title and len(title[1]) < 3 else 13
    name = next((m[2] for m in map(CHANNEL.search, source.lines[line - 1 : line - 1 + text]) if m), "")
    line += text
    whole, line = _numbers(source, line, "whole numbers")
    real, line = _numbers(source, line, "reals")
    comments = BLOCK.match(source.line(line))
    if comments is None or "comment" not in comments[2].lower():
        raise source.refused("the number of lines of comments is needed here", line)
    first, line = line, line + 1 + (int(comments[1]) if len(comments[1]) < 6 else 0)
    opening = BLOCK.match(source.line(line))
    layout = fortran_format(source.line(line))
    if opening is None or layout is None:
        raise source.refused("the number of the values and their format are needed here", line)
    count = source.whole_number(opening[1], "number of samples", line)
    by_code, spelled = UNIT_CODES.get(int(whole[UNIT])), SPELLED.search(opening[2])
    by_name = unit_spelled(spelled[1]) if spelled else None
    if by_code in ("counts", "volts") or (spelled and spelled[1].lower().startswith("count")):
        raise source.refused("raw counts are no motion; take the file of volume 1 or 2", line)
    known = [UNITS.get(name) for name in (by_code, by_name) if name is not None]
    if len(known) == 2 and known[0] != known[1]:
        raise source.refused(f"the unit is {by_code!r} by its code and {by_name!r} by this line", line)
    settled = source.settled_unit(by_code or by_name, unit)
    step = 1e-3 * float(real[INTERVAL])
    if not step > 0.0:
        raise source.refused("the header gives no interval of the samples (real 62)", line)
    if float(real[LENGTH]) != UNKNOWN:
        source.require_length(float(real[LENGTH]), count, step, line)
    stream = next((m[1] for m in map(STREAM.search, source.lines[first : line - 1]) if m), "")
    readings, line = source.read_block(line + 1, count, per_line=layout[0], width=layout[1])
    direction = _direction(int(whole[AZIMUTH]), name, stream)
    return regular_component(readings, step, settled, name=name, direction=direction), line


def _numbers(source: MotionText, line: int, what: str) -> tuple[FloatArray, int]:
    """A block of the header with its opening line."""
    opening, layout = BLOCK.match(source.line(line)), fortran_format(source.line(line))
    if opening is None or layout is None:
        raise source.refused(f"the number of the header's {what} and their format are needed here", line)
    count = source.whole_number(opening[1], f"number of {what}", line)
    numbers, behind = source.read_block(line + 1, count, per_line=layout[0], width=layout[1])
    if count < LENGTH + 1:
        raise source.refused(f"100 {what} are needed, and {count} are given", line)
    return numbers, behind


def _direction(code: int, name: str, stream: str) -> tuple[Direction | None, float]:
    """Direction by its code, else by the stream that the comments name; None where these contradict each other."""
    named = stream_direction(stream)
    if code in DIRECTION_CODES or 0 < code <= 360:
        direction = DIRECTION_CODES.get(code, ("horizontal", 1.0))
        return direction if named in (direction[0], None) else (None, 1.0)
    return (named, 1.0) if named else direction_of(name)


COSMOS = Format("COSMOS", lambda source: TITLE.search(source.line(1)), _read)
