"""Files of ASA 2.0, the standard of Mexican networks (UNAM, UAM): keys in Spanish, then one column a channel.

Lists stand between slashes: "ORIENTACION C1-C6 (rumbo;orientacion) : /N90E/V/N00E/", "INTERVALO DE MUESTREO, C1-C6 (s) :
/.0100/.0100/.0100/"; "UNIDADES DE LOS DATOS : Gal (cm/s/s)". Columns have no times.
"""

from fem.records.columns import rows_of
from fem.records.header import (
    Stated,
    keyed,
    measured,
    regular_components,
    require_count,
    require_peak,
    whole_number,
)
from fem.records.record import Record
from fem.records.source import MotionText, as_numbers
from fem.records.units import settled_unit, unit_in_header

NAME = "ASA"
TITLE = "archivo estandar de aceleracion"
HEADING = 130  #: lines in which the numbers must begin; 109 are usual


def recognises(source: MotionText) -> bool:
    """Whether one of the first lines names the standard."""
    return any(TITLE in line.casefold() for line in source.lines[:12])


def read(source: MotionText, unit: str | None) -> Record:
    """Read the channels of a file.

    Raises:
        RecordError: a key that is missing, counts, units or numbers that do not fit; with the line.
    """
    keys = keyed(source, HEADING)

    def stated(begin: str) -> Stated:
        found = next((value for key, value in keys.items() if key.startswith(begin)), None)
        if found is None or not found.text:
            raise source.refused(f"the header of an ASA file has no {begin.upper()}")
        return found

    orientations, intervals, counts = map(
        stated, ("orientacion c1-c6", "intervalo de muestreo", "num. total de muestras")
    )
    names = [name.partition(";")[0].strip() for name in _listed(orientations)]
    steps = {
        measured(source, text, "interval of the samples", intervals.line)
        for text in _listed(intervals)[: len(names)]
    }
    if len(steps) != 1:
        raise source.refused(
            "its channels have different intervals, or none; take one channel of it", intervals.line
        )
    settled = settled_unit(
        unit_in_header(source, stated("unidades de los datos").text, "acceleration"), unit, source.name
    )
    first = next(
        (k for k in range(orientations.line, HEADING) if _is_row(source.line(k), len(names))), HEADING
    )
    table = rows_of(source, first, len(names))
    for text in _listed(counts)[: len(names)]:
        require_count(
            source, len(table), whole_number(source, text, "number of samples", counts.line), counts.line
        )
    peaks = next((value for key, value in keys.items() if key.startswith("acel. max.(gal)")), Stated("", 0))
    for column, peak in zip(table.T, _listed(peaks) if settled[0] in ("gal", "cm/s2") else (), strict=False):
        require_peak(source, column, peak, peaks.line)
    return Record(
        components=regular_components(table, steps.pop(), settled, names),
        name=source.name,
        format=NAME,
        station=keys["clave de la estacion"].text if "clave de la estacion" in keys else "",
        event=keys["fecha del sismo [gmt]"].text if "fecha del sismo [gmt]" in keys else "",
    )


def _listed(value: Stated) -> list[str]:
    return [part.strip() for part in value.text.strip().strip("/").split("/") if part.strip()]


def _is_row(line: str, count: int) -> bool:
    fields = line.split()
    return len(fields) == count and as_numbers(fields) is not None
