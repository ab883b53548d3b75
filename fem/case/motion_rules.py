"""What ties the keys of a base motion together: rules of `fem.case.rules` for the table [motion].

x = A sin(Omega t + phase); of amplitude, peak acceleration A Omega^2 and frequency any two tell the third.
"""

import math
from collections.abc import Sequence
from typing import Any

from fem.case import quantities as q
from fem.case.problem import Problem, leaves_the_folder

#: peak acceleration of a harmonic floor given by amplitude and frequency [m/s2]: a hundred times gravity, which a
#: vibration test at 100 Hz may reach; ten times that is a slip, and steps of nanoseconds
MOST_PEAK = 1e3


#: cycles over which a taper may bring the floor to its velocity
LEAST_RAMP = 0.01


def harmonic_angular_frequency(motion: Any) -> float | None:
    """Omega [rad/s] from the keys given; None where they do not tell."""
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
    """A [m] of x = A sin(Omega t + phase) from the keys given; None where they do not tell."""
    if motion.kind != "harmonic":
        return None
    if motion.amplitude_m is not None:
        return float(motion.amplitude_m)
    frequency = harmonic_angular_frequency(motion)
    if frequency is None or motion.peak_acceleration_m_s2 is None:
        return None
    return float(motion.peak_acceleration_m_s2) / frequency**2


def harmonic_is_given_by_two_of_three(motion: Any) -> Problem | None:
    """Amplitude, peak acceleration and frequency determine one another."""
    if motion.kind != "harmonic":
        return None
    frequencies = [
        key for key in ("angular_frequency_rad_s", "frequency_Hz") if getattr(motion, key) is not None
    ]
    others = [key for key in ("amplitude_m", "peak_acceleration_m_s2") if getattr(motion, key) is not None]
    given = others + frequencies
    if len(frequencies) <= 1 and len(given) == 2:
        return None
    return Problem(
        key="amplitude_m",
        reason=", peak_acceleration_m_s2, frequency (angular_frequency_rad_s or frequency_Hz): exactly "
        f"two of the three must be given, got {', '.join(given) or 'none'}; "
        + ("leave one out" if len(given) > 1 else "add what is missing"),
    )


def harmonic_frequency_is_computable(motion: Any) -> Problem | None:
    """A frequency that follows from amplitude and peak acceleration lies in the range of a given one."""
    stated = motion.angular_frequency_rad_s is not None or motion.frequency_Hz is not None
    amplitude, peak = motion.amplitude_m, motion.peak_acceleration_m_s2
    if motion.kind != "harmonic" or stated or amplitude is None or peak is None:
        return None
    frequency = harmonic_angular_frequency(motion)
    if frequency is not None and q.ANGULAR_FREQUENCY.allows(frequency):
        return None
    follows = "does not follow from" if frequency is None else f"would be {frequency:g} rad/s for"
    return Problem(
        key="angular_frequency_rad_s",
        reason=f"{follows} amplitude_m = {amplitude:g} m and peak_acceleration_m_s2 = {peak:g} m/s2; "
        f"it must be {q.ANGULAR_FREQUENCY.range_in_words} rad/s",
    )


def harmonic_peak_is_not_negative(motion: Any) -> Problem | None:
    """The peak of a harmonic motion has no sign."""
    peak = motion.peak_acceleration_m_s2
    if motion.kind != "harmonic" or peak is None or peak >= 0.0:
        return None
    return Problem(
        key="peak_acceleration_m_s2",
        reason=f"must be at least 0 for a harmonic motion, got {peak:g} m/s2; "
        "phase_rad = 3.14159 turns its sign",
    )


def harmonic_amplitude_is_computable(motion: Any) -> Problem | None:
    """An amplitude that follows from peak acceleration and frequency lies in the range of a given one."""
    if motion.kind != "harmonic" or motion.amplitude_m is not None:
        return None
    amplitude = harmonic_amplitude(motion)
    if amplitude is None or amplitude < 0.0 or q.AMPLITUDE.allows(amplitude):
        return None
    return Problem(
        key="peak_acceleration_m_s2",
        reason=f"= {motion.peak_acceleration_m_s2:g} m/s2 at {harmonic_angular_frequency(motion):g} rad/s "
        f"is an amplitude of {amplitude:g} m; it must be {q.AMPLITUDE.range_in_words} m",
    )


def harmonic_peak_is_computable(motion: Any) -> Problem | None:
    """A peak acceleration that follows from amplitude and frequency is one that a floor may have."""
    if motion.kind != "harmonic" or motion.peak_acceleration_m_s2 is not None:
        return None
    frequency = harmonic_angular_frequency(motion)
    if frequency is None or motion.amplitude_m is None:
        return None
    peak = motion.amplitude_m * frequency**2
    if peak <= MOST_PEAK:
        return None
    return Problem(
        key="amplitude_m",
        reason=f"= {motion.amplitude_m:g} m at {frequency:g} rad/s is a peak acceleration of {peak:.4g} m/s2; it must "
        f"be at most {MOST_PEAK:g} m/s2; are the amplitude in m and the frequency as its key says?",
    )


def ramps_fit_into_the_cycles(motion: Any) -> Problem | None:
    """The two tapers do not overlap."""
    if motion.kind != "harmonic" or motion.cycles is None or 2.0 * motion.ramp_cycles <= motion.cycles:
        return None
    return Problem(
        key="ramp_cycles",
        reason=f"must be at most half of cycles = {motion.cycles:g}, got {motion.ramp_cycles:g}; "
        "it tapers the beginning and the end",
    )


def tapers_take_time(motion: Any) -> Problem | None:
    """A taper of almost no time would be a blow, of any acceleration."""
    if motion.kind != "harmonic" or motion.ramp_cycles == 0.0 or motion.ramp_cycles >= LEAST_RAMP:
        return None
    return Problem(
        key="ramp_cycles",
        reason=f"must be 0 or at least {LEAST_RAMP:g}, got {motion.ramp_cycles:g}: so short a taper is a blow; "
        "without one the floor moves from the beginning on (see start)",
    )


def _missing(motion: Any, kind: str, keys: Sequence[str]) -> Problem | None:
    missing = [key for key in keys if getattr(motion, key) is None]
    if motion.kind != kind or not missing:
        return None
    be = "is" if len(missing) == 1 else "are"
    return Problem(key=" and ".join(missing), reason=f'{be} missing: kind = "{kind}" needs {", ".join(keys)}')


def pulse_is_complete(motion: Any) -> Problem | None:
    """A pulse has a shape, a peak and a length."""
    return _missing(motion, "pulse", ("shape", "peak_acceleration_m_s2", "pulse_s"))


def table_is_complete(motion: Any) -> Problem | None:
    """A table has a file, and says what its values are."""
    return _missing(motion, "table", ("file", "quantity", "unit"))


def table_unit_fits_its_quantity(motion: Any) -> Problem | None:
    """Accelerations are in m/s2 or g, displacements in m."""
    units = {"acceleration": ("m/s2", "g"), "displacement": ("m",)}.get(motion.quantity, ())
    if motion.kind != "table" or motion.quantity is None or motion.unit is None or motion.unit in units:
        return None
    return Problem(
        key="unit",
        reason=f'must be {" or ".join(units)} for quantity = "{motion.quantity}", got "{motion.unit}"; '
        "for values in another unit give the factor as scale",
    )


def displacements_have_no_baseline(motion: Any) -> Problem | None:
    """A baseline is taken from accelerations."""
    if motion.kind != "table" or motion.quantity != "displacement" or motion.baseline == "none":
        return None
    return Problem(
        key="baseline",
        reason=f'must be "none" for quantity = "displacement", got "{motion.baseline}"; '
        "it corrects accelerations",
    )


def table_is_not_scaled_away(motion: Any) -> Problem | None:
    """A factor of zero leaves no motion."""
    if motion.kind != "table" or motion.scale != 0.0:
        return None
    return Problem(key="scale", reason='must not be 0; for a floor at rest take kind = "none"')


def motion_file_stays_beside_the_case(motion: Any) -> Problem | None:
    """A record is read from the folder of the case file or below it."""
    return leaves_the_folder("file", motion.file)
