"""Seismic action at a site: elastic spectra, ground displacement, factors; or the spectrum of a floor that is given.

EN 1998-1:2004, 3.2.2.2 to 3.2.2.5 and Annex A, recommended values of tables 3.2 to 3.4; the zones and subsoils of
DIN EN 1998-1/NA:2011; or parameters of another annex. All spectra are for 5 % of critical damping, where eta of (3.6)
is 1. Accelerations are magnitudes in m/s2, periods in s.

The given spectrum of a floor belongs to the floor on which a body stands, so no building filters it again and no factor
is applied to it. Between its points logarithms are straight over logarithms; before the first the floor moves as one
body, beyond the last the displacement stays.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fem.records.source import decoded
from fem.records.table import UserTable
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import read_regular

DAMPING_RATIO = 0.05  #: damping of the spectra to which motions are matched (3.2.3.1.2)
PLATEAU, VERTICAL_PLATEAU = 2.5, 3.0  #: amplification of the plateau, horizontal (3.3) and vertical (3.9)
#: range of the formulas (3.2) to (3.5); Annex A continues from there
LAST_PERIOD_S, LAST_PERIOD_ANNEX_A_S = 4.0, 10.0
FACTORS = (0.5, 2.0)  #: gamma_I and gamma_a that are accepted
#: columns of the given spectrum of a floor
PERIOD, HORIZONTAL, VERTICAL = "period_s", "acceleration_m_s2", "vertical_acceleration_m_s2"
#: its first period, at which it is taken for the peak of the floor, and its last, at least [s]
LATEST_FIRST_S, LEAST_LAST_S = 0.05, 1.0
LARGEST_FILE = 1_000_000  #: [bytes]; a spectrum has some tens of points


@dataclass(frozen=True, kw_only=True)
class SpectrumShape:
    """Parameters of the elastic spectra of a ground.

    Raises:
        ValueError: a number out of range, or corner periods that do not rise.
    """

    soil_factor: float  #: S [-]
    corner_periods: tuple[float, float, float]  #: T_B, T_C, T_D [s]
    vertical_ratio: float  #: a_vg / a_g [-]
    vertical_corner_periods: tuple[float, float, float]  #: [s]
    annex_a_corner: float | None = None  #: T_E [s]; None: constant displacement beyond T_D
    flat_to: float = 0.0  #: T_A, up to which the spectra stay at the peak [s]
    plateau: float = PLATEAU  #: over the peak, horizontal [-]
    vertical_plateau: float = VERTICAL_PLATEAU  #: over the peak, vertical [-]
    source: str = "given"  #: where the numbers stand

    def __post_init__(self) -> None:
        for name, value in (("soil factor", self.soil_factor), ("vertical ratio", self.vertical_ratio)):
            if not 0.0 < value < 10.0:
                raise ValueError(f"the {name} must be positive and below 10, got {value:g}")
        for periods in (self.corner_periods, self.vertical_corner_periods):
            if not self.flat_to < periods[0] < periods[1] < periods[2] <= LAST_PERIOD_S:
                values = ", ".join(f"{period:g}" for period in periods)
                raise ValueError(
                    f"corner periods T_B, T_C, T_D must rise from above {self.flat_to:g} s to at most 4 s, got {values}"
                )


_ANNEX_A = {"A": 4.5, "B": 5.0, "C": 6.0, "D": 6.0, "E": 6.0}  #: T_E of Annex A, by ground [s]
#: tables 3.2 and 3.3: S, T_B, T_C, T_D by type and ground
_EUROCODE = {
    1: {
        "A": (1.0, 0.15, 0.4, 2.0),
        "B": (1.2, 0.15, 0.5, 2.0),
        "C": (1.15, 0.20, 0.6, 2.0),
        "D": (1.35, 0.20, 0.8, 2.0),
        "E": (1.4, 0.15, 0.5, 2.0),
    },
    2: {
        "A": (1.0, 0.05, 0.25, 1.2),
        "B": (1.35, 0.05, 0.25, 1.2),
        "C": (1.5, 0.10, 0.25, 1.2),
        "D": (1.8, 0.10, 0.30, 1.2),
        "E": (1.6, 0.05, 0.25, 1.2),
    },
}
_EUROCODE_VERTICAL_RATIO = {1: 0.90, 2: 0.45}  #: table 3.4
_EUROCODE_VERTICAL_PERIODS = (0.05, 0.15, 1.0)

GERMAN_ZONES = {1: 0.4, 2: 0.6, 3: 0.8}  #: a_gR of the zones of DIN EN 1998-1/NA:2011 [m/s2]
#: subsoil: S, horizontal T_B, T_C, T_D; vertical T_B
_GERMAN = {
    "A-R": ((1.00, 0.05, 0.20, 2.0), 0.05),
    "B-R": ((1.25, 0.05, 0.25, 2.0), 0.05),
    "C-R": ((1.50, 0.05, 0.30, 2.0), 0.05),
    "B-T": ((1.00, 0.10, 0.30, 2.0), 0.10),
    "C-T": ((1.25, 0.10, 0.40, 2.0), 0.10),
    "C-S": ((0.75, 0.10, 0.50, 2.0), 0.10),
}


def eurocode_shape(kind: int, ground: str) -> SpectrumShape:
    """Spectra of EN 1998-1:2004, tables 3.2 to 3.4.

    Args:
        kind: type 1 or 2 (3.2.2.2(2)P); ground: type A to E (3.1.2).

    Raises:
        ValueError: another type, or a ground that needs a special study or does not exist.
    """
    if kind not in _EUROCODE:
        raise ValueError(f"spectrum type {kind}: EN 1998-1 has types 1 and 2")
    if ground in ("S1", "S2"):
        raise ValueError(
            f"ground type {ground} needs a special study (EN 1998-1, 3.1.2(4)P); give its spectrum with "
            'spectrum = "custom"'
        )
    if ground not in _EUROCODE[kind]:
        raise ValueError(f"ground type {ground!r}: EN 1998-1 has A, B, C, D, E")
    soil, *periods = _EUROCODE[kind][ground]
    return SpectrumShape(
        soil_factor=soil,
        corner_periods=(periods[0], periods[1], periods[2]),
        vertical_ratio=_EUROCODE_VERTICAL_RATIO[kind],
        vertical_corner_periods=_EUROCODE_VERTICAL_PERIODS,
        annex_a_corner=_ANNEX_A[ground],
        source=f"EN 1998-1:2004, table 3.{kind + 1}, type {kind}, ground {ground}; vertical: table 3.4",
    )


def german_shape(subsoil: str, vertical_ratio: float) -> SpectrumShape:
    """Spectra of DIN EN 1998-1/NA:2011.

    Args:
        subsoil: ground and geology, such as "C-R"; vertical_ratio: a_vg/a_g, as the annex in force gives it.

    Raises:
        ValueError: an unknown subsoil.
    """
    if subsoil not in _GERMAN:
        raise ValueError(f"subsoil {subsoil!r}: DIN EN 1998-1/NA:2011 has {', '.join(_GERMAN)}")
    (soil, *periods), vertical_first = _GERMAN[subsoil]
    return SpectrumShape(
        soil_factor=soil,
        corner_periods=(periods[0], periods[1], periods[2]),
        vertical_ratio=vertical_ratio,
        vertical_corner_periods=(vertical_first, 0.20, 2.0),
        source=f"DIN EN 1998-1/NA:2011, subsoil {subsoil} (superseded by NA:2021-07 and NA:2023-11)",
    )


def second_generation_shape(
    *,
    plateau: float,
    one_second: float,
    periods: tuple[float, float, float],
    vertical_ratio: float,
    ratio: float,
) -> SpectrumShape:
    """Spectra of the form of the second generation of Eurocode 8, from parameters of the ground's surface.

    Up to T_A the peak S_alpha/F_A, from T_B the plateau S_alpha, from T_C = S_beta/S_alpha on S_beta/T, from T_D on
    T_D S_beta/T^2. The vertical has the same form. Site factors are not in it: the program has no text of that code.

    Args:
        plateau: S_alpha [m/s2]; one_second: S_beta [m/s2], both at the surface.
        periods: T_A, T_B, T_D [s].
        vertical_ratio: f_vh, vertical over horizontal.
        ratio: F_A, plateau over peak.

    Raises:
        ValueError: numbers that give no such spectrum.
    """
    if not (0.0 < plateau < math.inf and 0.0 < one_second < math.inf):
        raise ValueError(f"S_alpha and S_beta must be positive, got {plateau:g} and {one_second:g} m/s2")
    if not 1.0 < ratio < 10.0:
        raise ValueError(f"F_A must lie between 1 and 10, got {ratio:g}")
    first, second, fourth = periods
    corners = second, one_second / plateau, fourth
    return SpectrumShape(
        soil_factor=1.0,
        corner_periods=corners,
        vertical_ratio=vertical_ratio,
        vertical_corner_periods=corners,
        flat_to=first,
        plateau=ratio,
        vertical_plateau=ratio,
        source=f"given, in the form of the second generation of Eurocode 8: S_alpha = {plateau:g} m/s2, S_beta = "
        f"{one_second:g} m/s2, T_A = {first:g} s, F_A = {ratio:g}",
    )


@dataclass(frozen=True, kw_only=True)
class SiteAction:
    """The seismic action on an element that stands at a site.

    Raises:
        ValueError: an acceleration that is not positive, or a factor outside 0.5 to 2.
    """

    shape: SpectrumShape
    reference_acceleration: float  #: a_gR, on rock [m/s2]
    importance_factor: float = 1.0  #: gamma_I of the building (4.2.5) [-]
    element_importance_factor: float = 1.0  #: gamma_a of the element (4.3.5.3); 1.5 for toxic content [-]
    topographic_factor: float = 1.0  #: S_T (EN 1998-5:2004, Annex A), on both components [-]

    def __post_init__(self) -> None:
        if not 0.0 < self.reference_acceleration < 30.0:
            raise ValueError(
                f"the reference acceleration must be positive and below 30 m/s2, got "
                f"{self.reference_acceleration:g} m/s2"
            )
        for name, value in (
            ("importance factor", self.importance_factor),
            ("importance factor of the element", self.element_importance_factor),
        ):
            if not FACTORS[0] <= value <= FACTORS[1]:
                raise ValueError(
                    f"the {name} must lie between {FACTORS[0]:g} and {FACTORS[1]:g}, got {value:g}"
                )

    @property
    def ground_acceleration(self) -> float:
        """a_g gamma_a S_T = gamma_I gamma_a S_T a_gR (3.2.1(3); 4.24 for gamma_a) [m/s2]."""
        factors = self.importance_factor * self.element_importance_factor
        return factors * self.reference_acceleration * self.topographic_factor

    @property
    def surface_acceleration(self) -> float:
        """a_g S, the horizontal spectrum at T = 0 [m/s2]."""
        return self.ground_acceleration * self.shape.soil_factor

    @property
    def vertical_acceleration(self) -> float:
        """a_vg [m/s2]; the soil factor does not apply to it (3.2.2.3)."""
        return self.ground_acceleration * self.shape.vertical_ratio

    @property
    def ground_displacement(self) -> float:
        """d_g = 0.025 a_g S T_C T_D (3.12) [m]."""
        _, third, fourth = self.shape.corner_periods
        return 0.025 * self.surface_acceleration * third * fourth

    def horizontal(self, periods: FloatArray) -> FloatArray:
        """Horizontal elastic spectrum S_e (3.2) to (3.5), beyond 4 s Annex A, at the periods (n,) [s]; (n,) [m/s2].

        Where no T_E is known, the displacement stays constant beyond 4 s, which is not below Annex A.
        """
        corners, plateau = self.shape.corner_periods, self.shape.plateau
        spectrum = self._elastic(periods, self.surface_acceleration, plateau, corners)
        if self.shape.annex_a_corner is None:
            return spectrum
        begin = self.shape.annex_a_corner
        share = np.clip((periods - begin) / (LAST_PERIOD_ANNEX_A_S - begin), 0.0, 1.0)  # (A.1), (A.2)
        displacement = self.ground_displacement * (PLATEAU + share * (1.0 - PLATEAU))
        beyond = periods >= begin
        spectrum[beyond] = displacement[beyond] * (2.0 * math.pi / periods[beyond]) ** 2
        return spectrum

    def vertical(self, periods: FloatArray) -> FloatArray:
        """Vertical elastic spectrum S_ve (3.8) to (3.11) at the periods (n,) [s], shape (n,) [m/s2]."""
        corners, plateau = self.shape.vertical_corner_periods, self.shape.vertical_plateau
        return self._elastic(periods, self.vertical_acceleration, plateau, corners)

    def _elastic(
        self, periods: FloatArray, peak: float, plateau: float, corners: tuple[float, float, float]
    ) -> FloatArray:
        """(3.2) to (3.5), or (3.8) to (3.11), at the periods (n,); `peak` at T = 0 [m/s2], and on to T_A."""
        first, second, third = corners
        flat, flat_to = plateau * peak, self.shape.flat_to
        way = np.maximum(periods - flat_to, 0.0) / (first - flat_to)
        rising = peak * (1.0 + way * (plateau - 1.0))
        with np.errstate(divide="ignore"):
            falling = flat * np.where(periods <= third, second / periods, second * third / periods**2)
        return np.where(periods < first, rising, np.where(periods <= second, flat, falling))


@dataclass(frozen=True, kw_only=True)
class FloorSpectrum:
    """Elastic spectra of a floor: pseudo-accelerations at 5 % damping.

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

    def horizontal(self, periods: FloatArray) -> FloatArray:
        """Horizontal spectrum at periods (n,) [s], shape (n,) [m/s2]."""
        return self._at(periods, self.accelerations)

    def vertical(self, periods: FloatArray) -> FloatArray:
        """Vertical spectrum at periods (n,) [s], shape (n,) [m/s2]; that of the ground where none is given."""
        if not self.vertical_accelerations:
            return self.ground.vertical(periods)
        return self._at(periods, self.vertical_accelerations)

    def _at(self, periods: FloatArray, values: Sequence[float]) -> FloatArray:
        first, last = self.periods[0], self.periods[-1]
        inside = np.log(np.clip(periods, first, last))
        spectrum = np.exp(np.interp(inside, np.log(self.periods), np.log(values)))
        slower = np.minimum(last / np.maximum(periods, first), 1.0) ** 2
        return np.asarray(spectrum * slower)


#: what motions are made to fit: elastic spectra, and the peak that belongs to them
MotionTarget = SiteAction | FloorSpectrum


def read_spectrum(path: Path) -> dict[str, tuple[float, ...]]:
    """The columns of a CSV file by name, as any spreadsheet writes them: a line that names them, and lines of numbers.

    period_s, acceleration_m_s2 and, if it has one, vertical_acceleration_m_s2, for 5 % damping.

    Raises:
        ValueError: it cannot be read, has other columns, or a line without a number for each.
    """
    table, choices = (
        UserTable(path.name, spectrum_text(path)),
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


def spectrum_text(path: Path) -> str:
    """The text of a file of such points.

    Raises:
        ValueError: it cannot be read.
    """
    try:
        return decoded(read_regular(path, LARGEST_FILE)) or ""
    except ValueError as error:
        raise ValueError(f"{path.name} {error}") from None
