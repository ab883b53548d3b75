"""CSV files of the Japan Meteorological Agency: seven lines of header, then N-S, E-W and U-D in gal, without times.

"SITE CODE= ..", "LAT.=", "LON.=", "SAMPLING RATE= 100Hz", "UNIT  = gal(cm/s/s)", "INITIAL TIME = ..", "NS,EW,UD"; empty
fields may follow in each line. Source: data.jma.go.jp/eqev/data/kyoshin/jishin/format.html.
"""

from fem.records.columns import rows_of
from fem.records.header import keyed, rate_to_step, regular_components
from fem.records.record import Record
from fem.records.source import MotionText
from fem.records.units import settled_unit, unit_in_header

NAME = "JMA CSV"
HEADING = 7


def recognises(source: MotionText) -> bool:
    """Whether the first line names the site, and another the time of the first sample."""
    keys = keyed(source, HEADING)
    return "site code" in keys and "initial time" in keys


def read(source: MotionText, unit: str | None) -> Record:
    """Read the three components of a file.

    Raises:
        RecordError: a line of the header, units or numbers that do not fit; with the line.
    """
    keys = keyed(source, HEADING)
    rate = next((keys[key] for key in ("sampling rate", "sampling freq") if key in keys), None)
    if rate is None or "unit" not in keys:
        raise source.refused(
            "a file of JMA gives SAMPLING RATE and UNIT in its header, and this one does not"
        )
    step = rate_to_step(source, rate.text, rate.line)
    settled = settled_unit(unit_in_header(source, keys["unit"].text, "acceleration"), unit, source.name)
    names = [name.strip() for name in source.line(HEADING).rstrip(", \t").split(",")]
    table = rows_of(source, HEADING + 1, len(names))
    return Record(
        components=regular_components(table, step, settled, names),
        name=source.name,
        format=NAME,
        station=keys["site code"].text.partition(",")[0].partition(" ")[0],
        date=keys["initial time"].text,
    )
