"""SMC files of the US Geological Survey: 11 lines of text, 48 whole numbers, 50 reals, comments, 8 numbers in a line.

Accelerations are cm/s2, velocities cm/s, displacements cm; the format has no other unit. Source: the description of the
format by the National Strong-Motion Program (Converse, USGS).
"""

import math
import re

from fem.records.record import Direction, Record
from fem.records.source import Format, MotionText, regular_component
from fem.records.units import OTHERWISE, direction_of

TEXT_LINES, WHOLE_LINES, REAL_LINES = 11, 6, 10
TITLE = re.compile(
    r"\s*\d\s+(UNKNOWN|(?:UN)?CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE SPECTRA|FOURIER.*)\s*"
)
UNIT = {
    "UNCORRECTED ACCELEROGRAM": "cm/s2", "CORRECTED ACCELEROGRAM": "cm/s2", "VELOCITY": "cm/s", "DISPLACEMENT": "cm",
}  # fmt: skip
UNKNOWN = "UNKNOWN"  #: type 0: values of any kind
PER_LINE, WIDTH = 8, 10
FASTEST = 1e5  #: samples in a second, above which the rate is none


def _read(source: MotionText, unit: str | None) -> Record:
    title = TITLE.fullmatch(source.line(1))
    kind = title[1] if title else ""
    if kind not in UNIT and kind != UNKNOWN:
        raise source.refused("spectra do not move a floor; take the file of the accelerogram", 1)
    if kind == UNKNOWN and unit is None:
        raise source.refused(f"an SMC file of type 0 does not say what its values are; {OTHERWISE}", 1)
    settled = source.settled_unit(UNIT.get(kind), unit)
    line = TEXT_LINES + 1
    whole, line = source.read_block(line, 8 * WHOLE_LINES, per_line=8, width=10)
    real, line = source.read_block(line, 5 * REAL_LINES, per_line=5, width=15, largest=math.inf)
    comments, count, rate = int(whole[15]), int(whole[16]), float(real[1])
    if not 1 <= count <= 10**8:
        raise source.refused("the header gives no number of samples", TEXT_LINES + 3)
    if not 0.0 < rate <= FASTEST or real[1] == real[0]:
        raise source.refused("the header gives no sampling rate", TEXT_LINES + WHOLE_LINES + 1)
    if whole[15] == whole[0]:
        comments = 0
    for number in range(line, line + max(comments, 0)):
        if not source.line(number).startswith("|"):
            raise source.refused(f'{comments} lines of comments, each with "|" before it, are needed', number)
    line += max(comments, 0)
    readings, behind = source.read_block(line, count, per_line=PER_LINE, width=WIDTH)
    source.require_end(behind, count)
    name = source.line(6).partition("component=")[2].strip() or source.line(6).partition("comp=")[2].strip()
    direction = _direction(name, whole[12], whole[13], whole[0])
    component = regular_component(readings, 1.0 / rate, settled, name=name, direction=direction)
    flagged = whole[17] == 1.0 and whole[0] != 1.0
    notes = ("its header flags a problem of the record, see the comments in the file",) if flagged else ()
    station = source.line(6).partition("component=")[0].partition("=")[2].strip()
    return Record(components=(component,), station=station, notes=notes)


def _direction(name: str, tilt: float, azimuth: float, null: float) -> tuple[Direction | None, float]:
    """By the component's name, else by the angles of the sensor from the upward vertical and from north [degrees]."""
    by_name, sense = direction_of(name)
    if by_name is not None:
        return by_name, sense
    if tilt == null:
        return (None if azimuth == null else "horizontal"), 1.0
    if tilt in (0.0, 180.0):
        return "vertical", (1.0 if tilt == 0.0 else -1.0)
    return ("horizontal" if tilt == 90.0 else None), 1.0


SMC = Format("SMC", lambda source: TITLE.fullmatch(source.line(1)), _read)
