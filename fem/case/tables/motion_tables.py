"""The tables [motion] and [vertical]: how the floor moves along x and along z, by the same keys, and their rules.

x = A sin(Omega t + phase); any two of amplitude, peak acceleration A Omega^2 and frequency determine the third. Keys
that both tables have stand in the shared bases; the order of the bases is the order of the keys in a resolved case, on
which its hash depends.
"""

import math
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, Literal, assert_never

from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule, file_beside, refused
from fem.case.tables.table import CaseTable, case_key, optional_key

#: peak acceleration of a harmonic floor given by amplitude and frequency [m/s2]: a hundred times gravity, which a
#: vibration test at 100 Hz may reach; ten times that is a slip, and steps of nanoseconds
MOST_PEAK = 1e3
LEAST_RAMP = 0.01  #: cycles over which a taper may bring the floor to its velocity


def _not_two_of_three(motion: Any) -> str:
    sizes, frequencies = (
        [key for key in keys if getattr(motion, key) is not None]
        for keys in (("amplitude_m", "peak_acceleration_m_s2"), ("angular_frequency_rad_s", "frequency_Hz"))
    )
    given = sizes + frequencies
    if motion.kind != "harmonic" or (len(frequencies) <= 1 and len(given) == 2):
        return ""
    return (
        ", peak_acceleration_m_s2, frequency (angular_frequency_rad_s or frequency_Hz): exactly "
        f"two of the three must be given, got {', '.join(given) or 'none'}; "
        + ("leave one out" if len(given) > 1 else "add what is missing")
    )


def _frequency_refused(motion: Any) -> str:
    given = motion.angular_frequency_rad_s is not None or motion.frequency_Hz is not None
    if motion.kind != "harmonic" or given:
        return ""
    if motion.amplitude_m is None or motion.peak_acceleration_m_s2 is None:
        return ""
    frequency = motion.omega
    if frequency is not None and q.ANGULAR_FREQUENCY.allows(frequency):
        return ""
    follows = "does not follow from" if frequency is None else f"would be {frequency:g} rad/s for"
    return (
        f"{follows} amplitude_m = {motion.amplitude_m:g} m and peak_acceleration_m_s2 = "
        f"{motion.peak_acceleration_m_s2:g} m/s2; it must be {q.ANGULAR_FREQUENCY.range_in_words} rad/s"
    )


def _too_strong(motion: Any) -> str:
    """Of a harmonic motion given by amplitude and frequency."""
    if motion.omega is None or motion.amplitude_m is None or motion.peak_acceleration_m_s2 is not None:
        return ""
    peak = float(motion.amplitude_m * motion.omega**2)
    if peak <= MOST_PEAK:
        return ""
    return (
        f"= {motion.amplitude_m:g} m at {motion.omega:g} rad/s is a peak acceleration of {peak:.4g} m/s2; it must be "
        f"at most {MOST_PEAK:g} m/s2; is the amplitude in m, and is the frequency in the unit of its key?"
    )


def _amplitude_refused(motion: Any) -> str:
    amplitude = motion.unscaled_amplitude
    if (
        motion.amplitude_m is not None
        or amplitude is None
        or amplitude < 0.0
        or q.AMPLITUDE.allows(amplitude)
    ):
        return ""
    return (
        f"= {motion.peak_acceleration_m_s2:g} m/s2 at {motion.omega:g} rad/s is an amplitude of {amplitude:g} m; it "
        f"must be {q.AMPLITUDE.range_in_words} m"
    )


def _incomplete(motion: Any, kind: str, keys: tuple[str, ...]) -> str:
    """What a motion of a kind needs and does not have; empty where it has all."""
    missing = [key for key in keys if getattr(motion, key) is None] if motion.kind == kind else []
    are = "is" if len(missing) == 1 else "are"
    needs = f'{" and ".join(missing)} {are} missing: kind = "{kind}" needs {", ".join(keys)}'
    return needs if missing else ""


#: quantity of a table -> its units
UNITS = {"acceleration": ("g", "m/s2", "cm/s2", "gal", "mm/s2"), "displacement": ("m",)}

SHARED_RULES = (
    refused("motion.amplitude_m", _not_two_of_three),
    refused("motion.angular_frequency_rad_s", _frequency_refused),
    Rule(
        "motion.peak_acceleration_m_s2",
        lambda motion: motion.kind != "harmonic" or (motion.peak_acceleration_m_s2 or 0.0) >= 0.0,
        "must be at least 0 for a harmonic motion, got {peak_acceleration_m_s2:g} m/s2; "
        "phase_rad = 3.14159 reverses its sign",
    ),
    refused("motion.peak_acceleration_m_s2", _amplitude_refused),
    refused("motion.amplitude_m", _too_strong),
    Rule(
        "motion.ramp_cycles",
        lambda motion: (
            motion.kind != "harmonic" or motion.cycles is None or 2.0 * motion.ramp_cycles <= motion.cycles
        ),
        "must be at most half of cycles = {cycles:g}, got {ramp_cycles:g}; it tapers the beginning and the end",
    ),
    Rule(
        "motion.ramp_cycles",
        lambda motion: (
            motion.kind != "harmonic" or motion.ramp_cycles == 0.0 or motion.ramp_cycles >= LEAST_RAMP
        ),
        f"must be 0 or at least {LEAST_RAMP:g}, got {{ramp_cycles:g}}: so short a taper is an impact; "
        "without one the floor moves from the beginning on (see start)",
    ),
    refused(
        "motion.", partial(_incomplete, kind="pulse", keys=("shape", "peak_acceleration_m_s2", "pulse_s"))
    ),
    Rule(
        "motion.unit",
        lambda motion: motion.kind != "table" or motion.unit in (None, *UNITS[motion.quantity]),
        lambda motion: (
            f'must be {" or ".join(UNITS[motion.quantity])} for quantity = "{motion.quantity}", '
            f'got "{motion.unit}"; for values in another unit give the factor as scale'
        ),
    ),
    Rule(
        "motion.baseline",
        lambda motion: (
            motion.kind != "table" or motion.quantity != "displacement" or motion.baseline == "none"
        ),
        'must be "none" for quantity = "displacement", got "{baseline}"; it corrects accelerations',
    ),
    Rule(
        "motion.scale",
        lambda motion: motion.kind != "table" or motion.scale != 0.0,
        'must not be 0; for a floor at rest take kind = "none"',
    ),
    file_beside("motion.file", below=False),
    Rule(
        "motion.scale_to_m_s2",
        lambda motion: motion.kind != "table" or motion.scale_to_m_s2 is None or motion.scale == 1.0,
        "and scale are alternatives; leave one out",
    ),
    Rule(
        "motion.scale_to_m_s2",
        lambda motion: motion.scale_to_m_s2 != 0.0,
        'must not be 0; for a floor at rest take kind = "none"',
    ),
    Rule(
        "motion.end_s",
        lambda motion: motion.start_s is None or motion.end_s is None or motion.start_s < motion.end_s,
        "must be later than start_s = {start_s:g} s, got {end_s:g} s",
    ),
)

MOTION_RULES = (*SHARED_RULES, refused("motion.", partial(_incomplete, kind="table", keys=("file",))))

#: the same rules for the keys of the same names, and what concerns a scale of every kind
VERTICAL_RULES = (
    *(replace(rule, place=rule.place.replace("motion.", "vertical.", 1)) for rule in SHARED_RULES),
    Rule(
        "vertical.scale",
        lambda vertical: vertical.kind not in ("harmonic", "pulse") or vertical.scale != 0.0,
        'must not be 0; for a floor that does not move up and down take kind = "none"',
    ),
    Rule(
        "vertical.scale",
        lambda vertical: vertical.kind not in ("harmonic", "pulse") or vertical.nominal_peak <= MOST_PEAK,
        lambda vertical: (
            f"= {vertical.scale:g} makes a peak acceleration of {vertical.nominal_peak:.4g} m/s2; it must be at most "
            f"{MOST_PEAK:g} m/s2"
        ),
    ),
)


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

    @property
    def omega(self) -> float | None:
        """Omega of a harmonic motion from the keys given [rad/s]; None where they do not determine it."""
        if self.kind != "harmonic":
            return None
        if self.angular_frequency_rad_s is not None:
            return float(self.angular_frequency_rad_s)
        if self.frequency_Hz is not None:
            return 2.0 * math.pi * float(self.frequency_Hz)
        if not self.amplitude_m or self.peak_acceleration_m_s2 is None:
            return None
        ratio = self.peak_acceleration_m_s2 / self.amplitude_m
        return math.sqrt(ratio) if ratio > 0.0 else None

    @property
    def unscaled_amplitude(self) -> float | None:
        """A of x = A sin(Omega t + phase), without its factor [m]; None where the keys do not determine it."""
        if self.kind != "harmonic":
            return None
        if self.amplitude_m is not None:
            return self.amplitude_m
        if self.omega is None or self.peak_acceleration_m_s2 is None:
            return None
        return self.peak_acceleration_m_s2 / self.omega**2


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
        return self.omega or 0.0

    @property
    def amplitude(self) -> float:
        """A of a harmonic motion x = A sin(Omega t + phase) [m], with its factor; 0 for every other kind."""
        return abs(self.factor) * (self.unscaled_amplitude or 0.0)

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
