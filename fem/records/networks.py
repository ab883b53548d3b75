"""Text files of databases and national networks: a header of keys over the numbers of one recording, without times.

ESM (Engineering Strong-Motion database): 64 lines "KEY: value", then one number in a line. CSMNC (China): sixteen
lines, "COMP. EW"; "UNCORRECTED ACCELERATION UNIT: CM/SEC/SEC"; "NO. OF POINTS: 12000 EQUALLY SPACED INTERVALS OF:
0.005 SEC"; "PEAK VALUE: -1005.350 AT 26.35 SEC DURATION: 60 SEC", then the numbers of one component.

In columns: AFAD (Turkey, to 2018; later files are those of ESM): "NUMBER OF DATA : 13494", "SAMPLING INTERVAL (sec) :
0.01", "RAW PGA VALUES (gal) : (N-S) 21.8 (E-W) 26.0 (U-D) 9.8". JMA (Japan), CSV: "SAMPLING RATE= 100Hz", "UNIT  =
gal(cm/s/s)", "NS,EW,UD". ASA 2.0 (Mexico: UNAM, UAM), lists between slashes: "ORIENTACION C1-C6 (rumbo;orientacion) :
/N90E/V/N00E/".
"""

import re
from dataclasses import dataclass
from typing import NamedTuple

from fem.records.columns import read_table
from fem.records.record import PLURALS, Quantity, Record
from fem.records.source import Format, MotionText, as_numbers, regular_component
from fem.records.table import fields_in
from fem.records.units import RATES, TIMES, unit_spelled

ESM_KEY = re.compile(r"([A-Z][A-Z0-9_/^]*)\s*:\s*(.*)")  #: such as PGA_CM/S^2
ESM_LINES = 200  #: of a header at most; it has 64
CSMNC_LINES = 16
CSMNC_COUNT = re.compile(
    r"\s*NO\. OF POINTS:\s*(\S+)\s+EQUALLY SPACED INTERVALS OF:\s*(\S+\s*[A-Z]*)\s*", re.IGNORECASE
)
CSMNC_UNIT = re.compile(r"(ACC+ELERATION|VELOCITY|DISPLACEMENT)\s+UNIT:\s*(\S+)", re.IGNORECASE)
CSMNC_PEAK = re.compile(r"\s*PEAK VALUE:\s*(\S+)(?:.*\bDURATION:\s*(\S+\s*[A-Z]*))?", re.IGNORECASE)
CSMNC_COMPONENT = re.compile(r"\s*COMP\.?\s+(.*)", re.IGNORECASE)
HEADING = 130  #: lines in which the columns must begin
KEY = re.compile(r"\s*([^:=]{2,60}?)\s*[:=]\s*(.*?)[\s,;]*")


def _read_esm(source: MotionText, unit: str | None) -> Record:
    header: dict[str, str] = {}
    first = 1
    while first <= ESM_LINES and (match := ESM_KEY.match(source.line(first))):
        header[match[1]] = match[2].strip()
        first += 1
    for key in ("SAMPLING_INTERVAL_S", "NDATA", "DATA_TYPE"):
        if not header.get(key):
            raise source.refused(f"the header has no {key}")
    count = source.whole_number(header["NDATA"], "number of samples (NDATA)")
    step = source.measured(header["SAMPLING_INTERVAL_S"], "interval (SAMPLING_INTERVAL_S)")
    spelled = header.get("UNITS", "")
    quantity = next((known for known in PLURALS if known == header["DATA_TYPE"].lower()), None)
    if quantity is None:
        raise source.refused("its DATA_TYPE is neither acceleration nor displacement")
    stated = source.unit_in_header(spelled, quantity) if spelled else None
    settled = source.settled_unit(stated, unit)
    readings = source.read_separated(first, count)
    for key, peak in header.items():
        if key.startswith("PGA_") and unit_spelled(key[4:]) == settled[0]:
            source.require_peak([readings], peak)
    return Record(
        components=(regular_component(readings, step, settled, name=header.get("STREAM", "")),),
        station=header.get("STATION_CODE", ""),
        event=header.get("EVENT_NAME", "") or header.get("EVENT_ID", ""),
        date=header.get("EVENT_DATE_YYYYMMDD", ""),
    )


def _read_csmnc(source: MotionText, unit: str | None) -> Record:
    header = source.lines[:CSMNC_LINES]
    line, counted = next((k, m) for k, m in enumerate(map(CSMNC_COUNT.fullmatch, header), start=1) if m)
    count = source.whole_number(counted[1], "number of samples", line)
    step = source.measured(counted[2], "interval of the samples", line)
    spelled = next((m for m in map(CSMNC_UNIT.search, header) if m), None)
    quantity: Quantity = next(
        (q for q in PLURALS if spelled and spelled[1].casefold().startswith(q[:3])), "acceleration"
    )
    stated = source.unit_in_header(spelled[2], quantity) if spelled else None
    settled = source.settled_unit(stated, unit)
    last = 1 + max(k for k, text in enumerate(header) if re.search("[a-z]{3}", text, re.IGNORECASE))
    readings = source.read_separated(last + 1, count)
    if peak := next((m for m in map(CSMNC_PEAK.match, header) if m), None):
        source.require_peak([readings], peak[1])
        if peak[2]:
            source.require_length(source.measured(peak[2], "duration"), count, step)
    name = next((m[1].strip() for m in map(CSMNC_COMPONENT.match, header) if m), "")
    component = regular_component(readings, step, settled, name=name)
    station = source.line(6).partition(":")[2].strip().partition(" ")[0]
    return Record(components=(component,), station=station, event=source.line(3).strip())


class _Stated(NamedTuple):
    key: str = ""
    text: str = ""
    line: int = 0

    @property
    def parts(self) -> list[str]:
        """Between slashes or bracketed names."""
        return [part.strip() for part in re.split(r"/|\([^()]*\)", self.text) if part.strip()]


@dataclass(frozen=True, kw_only=True)
class Network:
    """A format of columns by the beginnings of its keys, in lower case; empty: it has none."""

    name: str
    mark: str  #: in one of the first lines
    step: str  #: interval or rate of the samples
    unit: str  #: its value, or brackets in it
    count: str = ""
    names: str = ""  #: of the channels; else in the line above the numbers
    peaks: str = ""  #: in gal
    station: str = ""

    def recognises(self, source: MotionText) -> bool:
        """Whether one of the first lines has its mark."""
        return any(self.mark in line.casefold() for line in source.lines[:12])

    def read(self, source: MotionText, unit: str | None) -> Record:
        """Read all channels; a RecordError gives the key or the line that does not fit."""
        matches = [(number, KEY.fullmatch(line)) for number, line in enumerate(source.lines[:HEADING], 1)]
        keys = [_Stated(" ".join(m[1].casefold().split()), m[2], number) for number, m in matches if m]

        def stated(begin: str) -> _Stated:
            found = next((one for one in keys if begin and one.key.startswith(begin)), _Stated())
            if begin and not found.text:
                raise source.refused(
                    f"the header has no {begin.upper()}, as {self.name} has; write one component into a column, and "
                    "give unit and sample_interval_s"
                )
            return found

        def separator(number: int) -> str | None:
            return "," if "," in source.line(number) else None

        def fields(number: int) -> list[str]:
            return fields_in(source.line(number), separator(number))

        spelled, interval = stated(self.unit), stated(self.step)
        bracketed = re.search(r"\(([^()]*)\)", spelled.key)
        unit_text = bracketed[1] if bracketed else spelled.text
        settled = source.settled_unit(source.unit_in_header(unit_text, "acceleration"), unit)
        first = next(
            (k for k in range(2, HEADING) if len(row := fields(k)) > 1 and as_numbers(row) is not None),
            HEADING,
        )
        names = stated(self.names).parts if self.names else fields(first - 1)
        rate = "rate" in interval.key or "freq" in interval.key
        steps = {
            source.measured(text, "interval of the samples", interval.line, units=RATES if rate else TIMES)
            for text in interval.parts[: len(names)]
        }
        if len(steps) != 1:
            raise source.refused("its channels have different intervals, or none", interval.line)
        table, counts = read_table(source, first, len(names), separator(first)), stated(self.count)
        for text in counts.parts[: len(names)]:
            count = source.whole_number(text, "number of samples", counts.line)
            source.require_count(len(table), count, counts.line)
        peaks = stated(self.peaks)
        if settled[0] in ("gal", "cm/s2"):
            for column, peak in zip(table.T, peaks.parts, strict=False):
                source.require_peak([column], peak, peaks.line)
        (step,) = (1.0 / found if rate else found for found in steps)
        components = [
            regular_component(column, step, settled, name=name.partition(";")[0].strip())
            for column, name in zip(table.T, names, strict=True)
        ]
        station = next((one.text for one in keys if one.key == self.station), "").partition(",")[0]
        return Record(components=tuple(components), station=station)


ESM = Format(
    "ESM ASCII",
    lambda source: source.line(1).startswith("EVENT_NAME:") and source.line(2).startswith("EVENT_ID:"),
    _read_esm,
)
CSMNC = Format(
    "CSMNC", lambda source: any(map(CSMNC_COUNT.fullmatch, source.lines[:CSMNC_LINES])), _read_csmnc
)
NETWORKS = (
    Network(
        name="AFAD", mark="strong ground motion records of turk", step="sampling interval", unit="raw pga values",
        count="number of data", peaks="raw pga values", station="station id",
    ),
    Network(name="JMA CSV", mark="site code", step="sampling", unit="unit", station="site code"),
    Network(
        name="ASA", mark="archivo estandar de aceleracion", step="intervalo de muestreo", unit="unidades de los datos",
        count="num. total de muestras", names="orientacion c1-c6", peaks="acel. max.(gal)",
        station="clave de la estacion",
    ),
)  # fmt: skip
