"""The tables [motion] and [vertical]: how the floor moves along x and along z, by the same keys.

Keys that both tables have stand in the shared bases; the order of the bases is the order of the keys in a resolved
case, on which its hash depends.
"""

import math
from typing import Annotated, Literal, assert_never

from fem.case.tables import quantities as q
from fem.case.tables.motion_rules import (
    MOTION_RULES,
    VERTICAL_RULES,
    harmonic_amplitude,
    harmonic_angular_frequency,
)
from fem.case.tables.table import CaseTable, case_key, optional_key


class HarmonicKeys(CaseTable):
    """The kind of a motion, and the keys of a harmonic one."""

    kind: Literal["none", "harmonic", "pulse", "table"] = case_key(
        '"none" | "harmonic" | "pulse" | "table"', example="harmonic"
    )
    amplitude_m: Annotated[float, q.AMPLITUDE] | None = optional_key(
        "harmonic: exactly two of amplitude, peak acceleration and frequency", 0.05, only=("kind", "harmonic")
    )
    peak_acceleration_m_s2: Annotated[float, q.PEAK_ACCELERATION] | None = optional_key(
        "harmonic: A Omega^2; pulse: its peak, > 0 toward +x or upward",
        4.0,
        only=("kind", "harmonic", "pulse"),
    )
    angular_frequency_rad_s: Annotated[float, q.ANGULAR_FREQUENCY] | None = optional_key(
        "harmonic: Omega", 6.928, only=("kind", "harmonic")
    )
    frequency_Hz: Annotated[float, q.FREQUENCY] | None = optional_key(
        "harmonic: Omega/2 pi, in place of angular_frequency_rad_s", 1.1026, only=("kind", "harmonic")
    )
    phase_rad: Annotated[float, q.PHASE] = case_key(
        "harmonic: x = A sin(Omega t + phase)", 0.0, only=("kind", "harmonic")
    )
    ramp_cycles: Annotated[float, q.RAMP_CYCLES] = case_key(
        "harmonic: cycles over which the beginning and the end are tapered", 0.0, only=("kind", "harmonic")
    )
    cycles: Annotated[float, q.CYCLES] | None = optional_key(
        "harmonic: the floor stops when it next comes to rest after this number of cycles; default: never",
        10.0,
        only=("kind", "harmonic"),
    )


class StartKey(HarmonicKeys):
    """How the container starts, after the keys of a harmonic motion; it holds for the vertical motion, too."""

    start: Literal["moving", "rest"] = case_key(
        '"moving": the container moves with the floor at t = 0 | "rest": it does not',
        "moving",
        only=("kind", "harmonic", "pulse", "table"),
    )


class PulseAndTableKeys(CaseTable):
    """The keys of a pulse and of a table."""

    shape: Literal["rectangular", "half-sine", "sine"] | None = optional_key(
        'pulse: "rectangular" | "half-sine" | "sine"', "half-sine", only=("kind", "pulse")
    )
    pulse_s: Annotated[float, q.PULSE_DURATION] | None = optional_key(
        "pulse: its length", 0.5, only=("kind", "pulse")
    )
    delay_s: Annotated[float, q.DELAY] = case_key("pulse: when it begins", 0.0, only=("kind", "pulse"))
    file: str | None = optional_key(
        "table: a record of any known format, beside the case file; FILE#CHANNEL chooses one of several",
        "floor.csv",
        only=("kind", "table"),
    )
    quantity: Literal["acceleration", "displacement"] = case_key(
        'table: "acceleration" | "displacement"', "acceleration", only=("kind", "table")
    )
    unit: Literal["g", "m/s2", "cm/s2", "gal", "mm/s2", "m"] | None = optional_key(
        'table: unit of its values, where the file does not state it; "g" is 9.80665 m/s2',
        "g",
        only=("kind", "table"),
    )
    sample_interval_s: Annotated[float, q.SAMPLE_INTERVAL] | None = optional_key(
        "table: of a file of one column, without times", 0.005, only=("kind", "table")
    )
    gaps: Literal["bridge"] | None = optional_key(
        'table: "bridge" takes a file in which samples are missing, or far apart in places',
        "bridge",
        only=("kind", "table"),
    )
    start_s: Annotated[float, q.RECORD_TIME] | None = optional_key(
        "table: start of the part taken, which becomes t = 0", 5.0, only=("kind", "table")
    )
    end_s: Annotated[float, q.RECORD_TIME] | None = optional_key(
        "table: end of the part taken, in the times of the file", 30.0, only=("kind", "table")
    )
    scale: Annotated[float, q.SCALE] = case_key("table: factor on its values", 1.0, only=("kind", "table"))
    scale_to_m_s2: Annotated[float, q.PEAK_ACCELERATION] | None = optional_key(
        "table: peak acceleration that it is scaled to, in place of scale; < 0: the other sign",
        2.4,
        only=("kind", "table"),
    )
    baseline: Literal["none", "mean", "linear", "zero-end"] = case_key(
        'table: removed from the acceleration, "none" | "mean" | "linear" | "zero-end" (ends at rest where it began)',
        "none",
        only=("kind", "table"),
    )
    allow_baseline: Literal[True] | None = optional_key(
        "table: true takes a baseline that changes a peak by more than 20 %", True, only=("kind", "table")
    )


class FloorMotionTable(PulseAndTableKeys, HarmonicKeys):
    """A motion of the floor in one direction."""

    @property
    def factor(self) -> float:
        """Factor on the motion, with its sign [-]; 1 where the key `scale` is not used."""
        return 1.0 if self.is_idle("scale") else self.scale

    @property
    def nominal_peak(self) -> float | None:
        """A Omega^2 of a harmonic motion, the peak of a pulse, 0 of no motion [m/s2]; a magnitude.

        Ramps are ignored, and so is the end of a run before the peak. Of a table: the peak to which it is
        scaled, else None: no file is read here.
        """
        match self.kind:
            case "none":
                return 0.0
            case "harmonic":
                return self.amplitude * self.angular_frequency**2
            case "pulse":
                return abs(self.factor * (self.peak_acceleration_m_s2 or 0.0))
            case "table":
                return None if self.scale_to_m_s2 is None else abs(self.scale_to_m_s2)
        assert_never(self.kind)

    @property
    def angular_frequency(self) -> float:
        """Omega of a harmonic motion [rad/s]; 0 for every other kind."""
        return harmonic_angular_frequency(self) or 0.0

    @property
    def amplitude(self) -> float:
        """A of a harmonic motion x = A sin(Omega t + phase) [m], with its factor; 0 for every other kind."""
        return abs(self.factor) * (harmonic_amplitude(self) or 0.0)

    @property
    def period(self) -> float:
        """Time of one cycle of a harmonic motion [s]; infinite for every other kind."""
        return 2.0 * math.pi / self.angular_frequency if self.angular_frequency else math.inf


class MotionTable(FloorMotionTable, StartKey):
    """How the floor moves; accelerations and displacements are positive toward +x."""

    rules = MOTION_RULES


class VerticalTable(FloorMotionTable):
    """How the floor moves up and down, with the keys of [motion]; positive upward."""

    kind: Literal["none", "harmonic", "pulse", "table"] = case_key(
        '"none" | "harmonic" | "pulse" | "table"', "none"
    )
    scale: Annotated[float, q.SCALE] = case_key(
        "factor on the motion of any kind; -1: the other sign; of a record whose [motion] is scaled to a peak: "
        "times the factor of that one",
        1.0,
        only=("kind", "harmonic", "pulse", "table"),
    )

    rules = VERTICAL_RULES
