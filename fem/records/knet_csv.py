"""CSV files of NIED (Japan): the labels of K-NET with commas behind them, then columns that are named.

"Sampling Freq(Hz),100Hz", "Max. Acc. (gal),12.7"; a line of names such as "Time(s),NS(gal),EW(gal),UD(gal)". What such a
file does not state is asked for, as of every file of columns.
"""

from dataclasses import replace

from fem.records.columns import read_columns
from fem.records.record import Record
from fem.records.source import MotionText

NAME = "K-NET CSV"
HEADING = 25


def recognises(source: MotionText) -> bool:
    """Whether the header has the labels of NIED, with commas behind them."""
    begin = source.line(1).lstrip('#" ')
    return (
        begin.startswith("Origin Time")
        and "," in begin
        and any("Sampling Freq" in x for x in source.lines[:HEADING])
    )


def read(source: MotionText, unit: str | None, sample_interval: float | None = None) -> Record:
    """Read the components of a file.

    Raises:
        RecordError: as `read_columns`.
    """
    record = read_columns(source, unit=unit, sample_interval=sample_interval)
    labels = dict(line.lstrip("#").strip().partition(",")[::2] for line in source.lines[:HEADING])
    return replace(record, format=NAME, station=labels.get("Station Code", "").strip(","))
