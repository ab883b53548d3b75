"""Files of K-NET and KiK-net (NIED, Japan).

ASCII: 17 lines of header, then 8 whole numbers in a line, which the scale factor of the header makes gal. CSV: labels
behind `#` over their values, "#Time,RelativeTime(s),N-S(gal),E-W(gal),U-D(gal)", then rows of as many columns. Both
stand about an offset, so that their mean is subtracted.
"""

import re
from itertools import pairwise, takewhile

import numpy as np

from fem.records.record import Record
from fem.records.source import NUMBER, Format, MotionText, regular_component
from fem.records.table import fields_in
from fem.records.units import RATES, direction_of

CSV, TIMES, GAL = "#K-NET CSV", ["Time", "RelativeTime(s)"], "(gal)"
LINES, LABEL = 17, 18  #: of the header, and columns of its labels
PER_LINE, WIDTH = 8, 9
SCALE = re.compile(rf"({NUMBER})\s*\(gal\)\s*/\s*({NUMBER})", re.IGNORECASE)
#: KiK-net numbers its sensors: 1 to 3 in the borehole, 4 to 6 at the surface
SENSORS = {"1": "N-S", "2": "E-W", "3": "U-D", "4": "N-S", "5": "E-W", "6": "U-D"}


def _recognises(source: MotionText) -> bool:
    ascii_labels = source.line(1).startswith("Origin Time") and source.line(6).startswith("Station Code")
    return ascii_labels or source.line(1).startswith(CSV)


def _read(source: MotionText, unit: str | None) -> Record:
    settled = source.settled_unit("gal", unit)
    if source.line(1).startswith(CSV):
        return _read_csv(source, settled)

    def value(number: int) -> str:
        return source.line(number)[LABEL:].strip()

    step = 1.0 / source.measured(value(11), "sampling frequency", 11, units=RATES)
    duration = source.measured(value(12), "duration", 12)
    scale = SCALE.fullmatch(value(14))
    if scale is None:
        raise source.refused("the header gives no scale factor in gal", 14)
    factor = source.measured(scale[1], "scale factor", 14) / source.measured(scale[2], "scale factor", 14)
    count = round(duration / step)
    if not 1 <= count <= 10**8:
        raise source.refused("the header gives no number of samples", 12)
    counts = source.read_values(LINES + 1, count, per_line=PER_LINE, width=WIDTH)
    readings, name = (counts - counts.mean()) * factor, value(13)
    direction = direction_of(SENSORS.get(name, name))
    component = regular_component(readings, step, settled, name=name, direction=direction)
    source.require_peak([component.readings], value(15), 15)
    return Record(components=(component,), station=value(6), date=value(1))


def _read_csv(source: MotionText, settled: tuple[str, bool]) -> Record:
    header = [line[1:].strip() for line in takewhile(lambda line: line.startswith("#"), source.lines)]
    below = dict(pairwise(header))
    columns = fields_in(header[-1], ",")
    sensors = [name.removesuffix(GAL) for name in columns[2:] if name.endswith(GAL)]
    if columns[:2] != TIMES or not sensors or len(sensors) < len(columns) - 2:
        raise source.refused(
            "the header does not end with #Time,RelativeTime(s) and components in gal, as CSV of K-NET does; write one "
            "component into a column, and give unit and sample_interval_s",
            len(header),
        )
    step = 1.0 / source.measured(below.get("SamplingFrequency(Hz)", ""), "sampling frequency", units=RATES)
    duration = source.measured(below.get("DurationTime(s)", ""), "duration")
    lines = enumerate(source.lines[len(header) :], start=len(header) + 1)
    rows = [(number, fields_in(line, ",")) for number, line in lines if line.strip()]
    for number, row in rows:
        if len(row) != len(columns):
            raise source.refused(
                f"{len(columns)} columns are needed as in the header, found {len(row)}", number
            )
    table = source.read_rows(((number, row[1:]) for number, row in rows)).reshape(-1, len(sensors) + 1)
    source.require_length(duration, len(table), step)
    if np.abs(table[:, 0] - step * np.arange(len(table))).max() > 1.01 * step:  # printed to a few digits
        raise source.refused("its times contradict the sampling frequency of the header")
    components = [
        regular_component(
            column - column.mean(),
            step,
            settled,
            name=sensor,
            direction=direction_of(SENSORS.get(sensor, sensor)),
        )
        for column, sensor in zip(table.T[1:], sensors, strict=True)
    ]
    stations = (below[label].partition(",")[0] for label in header[:-1] if label.startswith("Code,"))
    return Record(components=tuple(components), station=next(stations, ""))


KNET = Format("K-NET", _recognises, _read)
