"""Text files of AFAD (Turkey) up to 2018: seventeen lines of header, then N-S, E-W and U-D in gal, without times.

The file gives its unit with the largest values, "RAW PGA VALUES (gal) : (N-S) 21.8 (E-W) 26.0 (U-D) 9.8". Newer files of
AFAD are those of ESM.
"""

import re

from fem.records.columns import rows_of
from fem.records.header import keyed, measured, regular_components, require_count, require_peak, whole_number
from fem.records.record import Record
from fem.records.source import MotionText
from fem.records.units import settled_unit, unit_in_header

NAME = "AFAD"
TITLE = "strong ground motion records of turk"
HEADING = 18
PEAKS = re.compile(r"raw pga values \(([^()]*)\)")
PEAK = re.compile(r"\(([^()]+)\)\s*(\S+)")


def recognises(source: MotionText) -> bool:
    """Whether the first line is the title of these files."""
    return source.line(1).strip().casefold().startswith(TITLE)


def read(source: MotionText, unit: str | None) -> Record:
    """Read the three components of a file.

    Raises:
        RecordError: a line of the header, counts, units or numbers that do not fit; with the line.
    """
    keys = keyed(source, HEADING)
    peaks = next((key for key in keys if PEAKS.fullmatch(key)), "")
    if not peaks or "number of data" not in keys or "sampling interval (sec)" not in keys:
        raise source.refused("the header gives no NUMBER OF DATA, SAMPLING INTERVAL or RAW PGA VALUES")
    count, interval = keys["number of data"], keys["sampling interval (sec)"]
    number = whole_number(source, count.text, "number of samples", count.line)
    step = measured(source, interval.text, "interval of the samples", interval.line)
    spelled = PEAKS.fullmatch(peaks)
    stated = unit_in_header(source, spelled[1] if spelled else "", "acceleration")
    settled = settled_unit(stated, unit, source.name)
    largest = PEAK.findall(keys[peaks].text)
    first = 1 + next(
        (k for k in range(1, HEADING + 3) if source.line(k).split() == [n for n, _ in largest]), HEADING
    )
    table = rows_of(source, first, len(largest))
    require_count(source, len(table), number, count.line)
    for column, (_, peak) in zip(table.T, largest, strict=True):
        require_peak(source, column, peak, keys[peaks].line)
    return Record(
        components=regular_components(table, step, settled, [name for name, _ in largest]),
        name=source.name,
        format=NAME,
        station=keys["station id"].text if "station id" in keys else "",
        date=keys["earthquake date"].text if "earthquake date" in keys else "",
    )
