"""The spectrum of a floor as a target of motions: given at some periods, and taken as it is.

It belongs to the floor on which a body stands, so no building filters it again and no factor is applied to it. Between
the points logarithms are straight over logarithms; before the first the floor moves as one body, beyond the last the
displacement stays. Pseudo-accelerations at 5 % damping [m/s2], periods [s].
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fem.records.source import decoded
from fem.records.table import UserTable
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import read_regular
from fem.seismic.action import DAMPING_RATIO, SiteAction, damping_correction

PERIOD, HORIZONTAL, VERTICAL = "period_s", "acceleration_m_s2", "vertical_acceleration_m_s2"
#: the first period, at which the spectrum is taken for the peak of the floor, and the last, at least [s]
LATEST_FIRST_S, LEAST_LAST_S = 0.05, 1.0
LARGEST_FILE = 1_000_000  #: [bytes]; a spectrum has some tens of points


@dataclass(frozen=True, kw_only=True)
class FloorSpectrum:
    """Elastic spectra of a floor.

    Raises:
        ValueError: periods that do not rise from 0.05 s or less to 1 s or more, or values that are not positive.
    """

    periods: tuple[float, ...]  #: (n,) [s]
    accelerations: tuple[float, ...]  #: (n,) [m/s2]
    vertical_accelerations: tuple[float, ...] = ()  #: (n,) [m/s2]; empty: the vertical of the ground
    ground: SiteAction  #: below the building

    def __post_init__(self) -> None:
        for name, values in (
            (HORIZONTAL, self.accelerations),
            (VERTICAL, self.vertical_accelerations or self.accelerations),
        ):
            if len(values) != len(self.periods):
                raise ValueError(f"{PERIOD} has {len(self.periods)} values and {name} {len(values)}")
            if not (np.isfinite(values).all() and min(values, default=0.0) > 0.0):
                raise ValueError(f"{name} must be positive and finite")
        rising = np.isfinite(self.periods).all() and (np.diff((0.0, *self.periods)) > 0.0).all()
        if not rising or self.periods[0] > LATEST_FIRST_S or self.periods[-1] < LEAST_LAST_S:
            raise ValueError(
                f"{PERIOD} must rise from {LATEST_FIRST_S:g} s or less, where the spectrum is the peak of the floor, "
                f"to {LEAST_LAST_S:g} s or more"
            )

    @property
    def surface_acceleration(self) -> float:
        """Peak of the floor [m/s2]."""
        return self.accelerations[0]

    def horizontal(self, periods: FloatArray, damping_ratio: float = DAMPING_RATIO) -> FloatArray:
        """Horizontal spectrum at periods (n,) [s], shape (n,) [m/s2]; at another damping corrected by (3.6)."""
        return self._at(periods, self.accelerations, damping_ratio)

    def vertical(self, periods: FloatArray, damping_ratio: float = DAMPING_RATIO) -> FloatArray:
        """Vertical spectrum at periods (n,) [s], shape (n,) [m/s2]; that of the ground where none is given."""
        if not self.vertical_accelerations:
            return self.ground.vertical(periods, damping_ratio)
        return self._at(periods, self.vertical_accelerations, damping_ratio)

    def _at(self, periods: FloatArray, values: Sequence[float], damping_ratio: float) -> FloatArray:
        first, last = self.periods[0], self.periods[-1]
        inside = np.log(np.clip(periods, first, last))
        spectrum = np.exp(np.interp(inside, np.log(self.periods), np.log(values)))
        slower = np.minimum(last / np.maximum(periods, first), 1.0) ** 2
        share = damping_correction(damping_ratio) / damping_correction(DAMPING_RATIO)
        return np.asarray(share * spectrum * slower)


def read_spectrum(path: Path) -> dict[str, tuple[float, ...]]:
    """The columns of a CSV file by name, as any spreadsheet writes them: a line that names them, and lines of numbers.

    period_s, acceleration_m_s2 and, if it has one, vertical_acceleration_m_s2.

    Raises:
        ValueError: it cannot be read, has other columns, or a line without a number for each.
    """
    table, choices = (
        UserTable(path.name, text_of(path)),
        ([PERIOD, HORIZONTAL], [PERIOD, HORIZONTAL, VERTICAL]),
    )
    names = table.header
    if names not in choices:
        actual = f"got {','.join(names)[:80]!r}" if names else "and the file is empty"
        raise ValueError(
            f"{path.name}: the first line must be {' or '.join(map(','.join, choices))}, {actual}"
        )
    table.require_one_decimal_mark(range(len(names)))
    rows = [line.numbers() for line in table.lines if len(line.fields) == len(names)]
    if not rows or [len(row) for row in rows] != [len(names)] * len(table.lines):
        raise ValueError(f"{path.name}: every further line must hold {len(names)} numbers")
    return dict(zip(names, zip(*rows, strict=True), strict=True))


def text_of(path: Path) -> str:
    """The text of such a file.

    Raises:
        ValueError: it cannot be read.
    """
    try:
        return decoded(read_regular(path, LARGEST_FILE)) or ""
    except ValueError as error:
        raise ValueError(f"{path.name} {error}") from None
