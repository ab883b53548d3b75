"""Read a motion file of any known format, which is recognised by its content, never by its name."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from fem.records.columns import NAME as COLUMNS
from fem.records.columns import read_columns
from fem.records.cosmos import COSMOS
from fem.records.csmip import CSMIP
from fem.records.knet import KNET
from fem.records.networks import CSMNC, ESM, NETWORKS
from fem.records.peer import PEER
from fem.records.record import Record, RecordError
from fem.records.smc import SMC
from fem.records.source import read_source
from fem.records.units import STATED

#: formats with a header of their own; every other text is columns
FORMATS = (ESM, KNET, SMC, COSMOS, CSMIP, CSMNC, *NETWORKS, PEER)


def read_record(path: Path, *, unit: str | None = None, sample_interval: float | None = None) -> Record:
    """All components of a motion file; `unit` and `sample_interval` [s] where the file does not state them.

    Raises:
        RecordError: no such file, no motion, or one that contradicts itself or its unit; with the line.
    """
    if unit is not None and unit not in STATED:
        raise RecordError(f"unknown unit {unit!r}; known: {', '.join(STATED)}")
    try:
        state = path.stat()
    except OSError:
        state = None
    return _read(path, state and (state.st_mtime_ns, state.st_size), unit, sample_interval)


@lru_cache(maxsize=64)  # the runs of a sweep and of a band follow the same motions: a set of 32 pairs
def _read(
    path: Path, state: tuple[int, int] | None, unit: str | None, sample_interval: float | None
) -> Record:
    source = read_source(path)
    reader = next((form for form in FORMATS if form.recognises(source)), None)
    try:
        if reader is None:
            record = read_columns(source, unit=unit, sample_interval=sample_interval)
            return replace(record, name=source.name, format=COLUMNS)
        if sample_interval is not None:
            raise source.refused(
                f"sample_interval_s is for a file of one column, and this is a {reader.name} file"
            )
        return replace(reader.read(source, unit), name=source.name, format=reader.name)
    except RecordError as error:
        named = str(error).startswith(source.name)
        raise error if named else RecordError(f"{source.name}: {error}") from None
