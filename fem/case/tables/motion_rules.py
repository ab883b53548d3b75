"""What ties the keys of a base motion together: the rules of the tables [motion] and [vertical].

x = A sin(Omega t + phase); any two of amplitude, peak acceleration A Omega^2 and frequency determine the third.
"""

import math
from dataclasses import replace
from functools import partial
from typing import Any

from fem.case.tables import quantities as q
from fem.case.tables.problem import Rule, file_beside, refused

#: peak acceleration of a harmonic floor given by amplitude and frequency [m/s2]: a hundred times gravity, which a
#: vibration test at 100 Hz may reach; ten times that is a slip, and steps of nanoseconds
MOST_PEAK = 1e3
LEAST_RAMP = 0.01  #: cycles over which a taper may bring the floor to its velocity


def harmonic_angular_frequency(motion: Any) -> float | None:
    """Omega [rad/s] from the keys given; None where they do not determine it."""
    if motion.kind != "harmonic":
        return None
    if motion.angular_frequency_rad_s is not None:
        return float(motion.angular_frequency_rad_s)
    if motion.frequency_Hz is not None:
        return 2.0 * math.pi * float(motion.frequency_Hz)
    if not motion.amplitude_m or motion.peak_acceleration_m_s2 is None:
        return None
    ratio = motion.peak_acceleration_m_s2 / motion.amplitude_m
    return math.sqrt(ratio) if ratio > 0.0 else None


def harmonic_amplitude(motion: Any) -> float | None:
    """A [m] of x = A sin(Omega t + phase) from the keys given; None where they do not determine it."""
    if motion.kind != "harmonic":
        return None
    if motion.amplitude_m is not None:
        return float(motion.amplitude_m)
    frequency = harmonic_angular_frequency(motion)
    if frequency is None or motion.peak_acceleration_m_s2 is None:
        return None
    return float(motion.peak_acceleration_m_s2) / frequency**2


def _peak(motion: Any) -> float:
    """A Omega^2 of a harmonic motion given by amplitude and frequency [m/s2]; 0 of every other motion."""
    frequency = harmonic_angular_frequency(motion)
    if frequency is None or motion.amplitude_m is None or motion.peak_acceleration_m_s2 is not None:
        return 0.0
    return float(motion.amplitude_m * frequency**2)


def _given(motion: Any) -> tuple[list[str], list[str]]:
    """Which of amplitude and peak are given, and which of the two frequencies."""
    sizes, frequencies = (
        ("amplitude_m", "peak_acceleration_m_s2"),
        ("angular_frequency_rad_s", "frequency_Hz"),
    )
    return (
        [key for key in sizes if getattr(motion, key) is not None],
        [key for key in frequencies if getattr(motion, key) is not None],
    )


def _not_two_of_three(motion: Any) -> str:
    sizes, frequencies = _given(motion)
    given = sizes + frequencies
    if motion.kind != "harmonic" or (len(frequencies) <= 1 and len(given) == 2):
        return ""
    return (
        ", peak_acceleration_m_s2, frequency (angular_frequency_rad_s or frequency_Hz): exactly "
        f"two of the three must be given, got {', '.join(given) or 'none'}; "
        + ("leave one out" if len(given) > 1 else "add what is missing")
    )


def _frequency_refused(motion: Any) -> str:
    sizes, frequencies = _given(motion)
    frequency = harmonic_angular_frequency(motion)
    follow = motion.kind == "harmonic" and not frequencies and len(sizes) == 2
    if not follow or (frequency is not None and q.ANGULAR_FREQUENCY.allows(frequency)):
        return ""
    follows = "does not follow from" if frequency is None else f"would be {frequency:g} rad/s for"
    return (
        f"{follows} amplitude_m = {motion.amplitude_m:g} m and peak_acceleration_m_s2 = "
        f"{motion.peak_acceleration_m_s2:g} m/s2; it must be {q.ANGULAR_FREQUENCY.range_in_words} rad/s"
    )


def _amplitude_follows(motion: Any) -> bool:
    amplitude = harmonic_amplitude(motion)
    given = motion.amplitude_m is not None
    return given or amplitude is None or amplitude < 0.0 or q.AMPLITUDE.allows(amplitude)


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
    Rule(
        "motion.peak_acceleration_m_s2",
        _amplitude_follows,
        lambda motion: (
            f"= {motion.peak_acceleration_m_s2:g} m/s2 at {harmonic_angular_frequency(motion):g} rad/s "
            f"is an amplitude of {harmonic_amplitude(motion):g} m; it must be {q.AMPLITUDE.range_in_words} m"
        ),
    ),
    Rule(
        "motion.amplitude_m",
        lambda motion: _peak(motion) <= MOST_PEAK,
        lambda motion: (
            f"= {motion.amplitude_m:g} m at {harmonic_angular_frequency(motion):g} rad/s is a peak acceleration of "
            f"{_peak(motion):.4g} m/s2; it must be at most {MOST_PEAK:g} m/s2; "
            "is the amplitude in m, and is the frequency in the unit of its key?"
        ),
    ),
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
