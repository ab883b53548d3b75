"""Text files of national networks: a header of keys over the columns of one recording, which have no times.

AFAD (Turkey, to 2018; later files are those of ESM): "NUMBER OF DATA : 13494", "SAMPLING INTERVAL (sec) : 0.01", "RAW
PGA VALUES (gal) : (N-S) 21.8 (E-W) 26.0 (U-D) 9.8". JMA (Japan), CSV: "SAMPLING RATE= 100Hz", "UNIT  = gal(cm/s/s)",
"NS,EW,UD". ASA 2.0 (Mexico: UNAM, UAM), lists between slashes: "ORIENTACION C1-C6 (rumbo;orientacion) : /N90E/V/N00E/".
"""

import re
from dataclasses import dataclass
from typing import NamedTuple

from fem.records.columns import rows_of
from fem.records.header import measured, regular_component, require_count, require_peak, whole_number
from fem.records.record import Record
from fem.records.source import MotionText, as_numbers
from fem.records.table import fields_in
from fem.records.units import RATES, TIMES, settled_unit, unit_in_header

HEADING = 130  #: lines in which the numbers must begin
KEY = re.compile(r"\s*([^:=]{2,60}?)\s*[:=]\s*(.*?)[\s,;]*")


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
    """A format by the beginnings of its keys, in lower case; empty: it has none."""

    NAME: str
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
                    f"the header has no {begin.upper()}, as {self.NAME} has; write one component into a column, and "
                    "give unit and sample_interval_s"
                )
            return found

        spelled, interval = stated(self.unit), stated(self.step)
        bracketed = re.search(r"\(([^()]*)\)", spelled.key)
        unit_text = bracketed[1] if bracketed else spelled.text
        settled = settled_unit(unit_in_header(source, unit_text, "acceleration"), unit, source.name)
        first = next((k for k in range(2, HEADING) if _numbers_in(source.line(k)) > 1), HEADING)
        above = source.line(first - 1)
        names = stated(self.names).parts if self.names else fields_in(above, "," if "," in above else None)
        rate = "rate" in interval.key or "freq" in interval.key
        steps = {
            measured(source, text, "interval of the samples", interval.line, units=RATES if rate else TIMES)
            for text in interval.parts[: len(names)]
        }
        if len(steps) != 1:
            raise source.refused("its channels have different intervals, or none", interval.line)
        table, counts = rows_of(source, first, len(names)), stated(self.count)
        for text in counts.parts[: len(names)]:
            count = whole_number(source, text, "number of samples", counts.line)
            require_count(source, len(table), count, counts.line)
        peaks = stated(self.peaks)
        if settled[0] in ("gal", "cm/s2"):
            for column, peak in zip(table.T, peaks.parts, strict=False):
                require_peak(source, [column], peak, peaks.line)
        (step,) = (1.0 / found if rate else found for found in steps)
        components = [
            regular_component(column, step, settled, name=name.partition(";")[0].strip())
            for column, name in zip(table.T, names, strict=True)
        ]
        station = next((one.text for one in keys if one.key == self.station), "").partition(",")[0]
        return Record(components=tuple(components), station=station)


def _numbers_in(line: str) -> int:
    """How many numbers a line holds; none where it holds anything else."""
    fields = fields_in(line, "," if "," in line else None)
    return len(fields) if as_numbers(fields) is not None else 0


NETWORKS = (
    Network(
        NAME="AFAD",
        mark="strong ground motion records of turk",
        step="sampling interval",
        unit="raw pga values",
        count="number of data",
        peaks="raw pga values",
        station="station id",
    ),
    Network(NAME="JMA CSV", mark="site code", step="sampling", unit="unit", station="site code"),
    Network(
        NAME="ASA",
        mark="archivo estandar de aceleracion",
        step="intervalo de muestreo",
        unit="unidades de los datos",
        count="num. total de muestras",
        names="orientacion c1-c6",
        peaks="acel. max.(gal)",
        station="clave de la estacion",
    ),
)
