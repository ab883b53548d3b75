"""Motions as files for other programs: CSV in m/s2, and PEER AT2 in g. Both read back to the same bits.

Numbers are written with as many digits as a float64 needs, so an AT2 file has columns wider than the usual 15; programs
that read it number by number accept that. A value in m/s2 is not in general a float64 in g times 9.80665, so motions
are made of values that are: `in_whole_g` changes them by a rounding.
"""

from pathlib import Path

import numpy as np

from fem.records.columns import given_record, written
from fem.records.units import STANDARD_GRAVITY
from fem.runtime.arrays import FloatArray
from fem.runtime.own_files import write_atomically

AT2_PER_LINE = 5


def in_whole_g(acceleration: FloatArray) -> FloatArray:
    """The nearest accelerations (n,) that are a float64 in g times 9.80665 [m/s2]."""
    return acceleration / STANDARD_GRAVITY * STANDARD_GRAVITY


def write_csv(path: Path, step: float, acceleration: FloatArray) -> None:
    """Write times and accelerations (n,) [m/s2]."""
    times = np.asarray(np.arange(acceleration.size) * step, dtype=np.float64)
    record = given_record(times, {"horizontal": acceleration})
    write_atomically(path, written(record), to_disk=False)


def write_at2(path: Path, step: float, acceleration: FloatArray, described: str) -> None:
    """Write an acceleration (n,) [m/s2] as a PEER file.

    Args:
        described: event, date, station and component of the second line; commas divide them.

    Raises:
        ValueError: a value that is no float64 in g times 9.80665; use `in_whole_g` first.
    """
    values = acceleration / STANDARD_GRAVITY
    for neighbour in (-np.inf, np.inf):
        off = values * STANDARD_GRAVITY != acceleration
        values[off] = np.nextafter(acceleration[off] / STANDARD_GRAVITY, neighbour)
    if (values * STANDARD_GRAVITY != acceleration).any():
        raise ValueError("an acceleration is no float64 in g times 9.80665; use in_whole_g first")
    rows = [
        " ".join(f"{value:24.16E}" for value in values[at : at + AT2_PER_LINE].tolist())
        for at in range(0, values.size, AT2_PER_LINE)
    ]
    heading = (
        "PROGRAM UNANCHORED",
        described,
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {values.size}, DT= {step!r} SEC",
    )
    write_atomically(path, "\n".join((*heading, *rows, "")), to_disk=False)
