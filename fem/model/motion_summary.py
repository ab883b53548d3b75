"""The floor's motions of a run in numbers: length, samples, peaks, and how much of it the run covers.

Peaks are those of the whole motion used, after its scale and baseline; a run that ends before the motion does not reach
them all. No kernel is loaded here, so that `check` stays quick where the keys alone determine the motion.
"""

import math
from dataclasses import replace
from typing import assert_never

from fem.case.case import Case
from fem.case.tables.duration import longest_time
from fem.case.tables.motion_tables import FloorMotionTable
from fem.results.run_result import MotionResult

#: velocity and displacement at the end of a pulse, over peak x length and peak x length^2
PULSE_ENDS = {
    "rectangular": (1.0, 0.5),
    "half-sine": (2.0 / math.pi, 1.0 / math.pi),
    "sine": (1.0 / math.pi, 0.5 / math.pi),
}


def summary_from_keys(case: Case) -> MotionResult | None:
    """The numbers of both motions where the keys alone determine them; else None."""
    result = None if case.floor.turn else numbers_from_keys(case.motion, longest_time(case))
    if result is None or not case.has_vertical:
        return result
    vertical = numbers_from_keys(case.vertical, longest_time(case))
    return None if vertical is None else replace(result, vertical=vertical)


def numbers_from_keys(motion: FloorMotionTable, duration: float) -> MotionResult | None:
    """The numbers of one motion, for a run of at most this duration [s].

    None where the motion must be evaluated: a table, ramps, a run that ends before the peaks, or before the motion.
    """
    peak = motion.nominal_peak or 0.0
    match motion.kind:
        case "none":
            return MotionResult(kind="none", peak_acceleration_m_s2=0.0, peak_in_run_m_s2=0.0)
        case "harmonic":
            if motion.ramp_cycles > 0.0 or motion.cycles is not None or duration < motion.period:
                return None
            amplitude, rate = motion.amplitude, motion.angular_frequency
            return _covered("harmonic", duration, (peak, amplitude * rate, amplitude))
        case "pulse":
            length = motion.pulse_s
            if motion.shape is None or length is None or duration < motion.delay_s + length:
                return None
            velocity, displacement = PULSE_ENDS[motion.shape]
            peaks = (peak, velocity * peak * length, displacement * peak * length**2)
            return _covered("pulse", motion.delay_s + length, peaks)
        case "table":
            return None
    assert_never(motion.kind)


def _covered(kind: str, length: float, peaks: tuple[float, float, float]) -> MotionResult:
    """A motion that the run covers; `peaks` of acceleration, velocity and displacement."""
    return MotionResult(
        kind=kind,
        duration_s=length,
        peak_acceleration_m_s2=peaks[0],
        peak_velocity_m_s=peaks[1],
        peak_displacement_m=peaks[2],
        covered=1.0,
        peak_in_run_m_s2=peaks[0],
    )
