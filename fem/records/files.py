"""Read a motion file of any known format; the format is recognised by what the file holds, never by its name."""

from pathlib import Path

from fem.records.columns import read_columns
from fem.records.record import Record, RecordError
from fem.records.source import read_source
from fem.records.units import STATED


def read_record(path: Path, *, unit: str | None = None, sample_interval: float | None = None) -> Record:
    """All components of a motion file, in SI units.

    Args:
        path: of the file.
        unit: of its values, one of `STATED`; not needed where the file states it.
        sample_interval: of a file of one column, which has no times [s].

    Raises:
        RecordError: no such file, no motion, or one that contradicts itself or its unit; with the line.
    """
    if unit is not None and unit not in STATED:
        raise RecordError(f"unknown unit {unit!r}; known: {', '.join(STATED)}")
    source = read_source(path)
    try:
        return read_columns(source, unit=unit, sample_interval=sample_interval)
    except RecordError as error:
        named = str(error).startswith(source.name)
        raise error if named else RecordError(f"{source.name}: {error}") from None
