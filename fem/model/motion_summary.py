"""The floor's motion of a run in numbers: length, samples, peaks, and how much of it the run covers.

Peaks are those of the whole motion used, after its scale and baseline; a run that ends before the motion does not reach
them all. No kernel is loaded here, so that `check` stays quick where the keys alone determine the motion.
"""

import math

from fem.case.case import Case
from fem.case.rules import longest_time
from fem.results.run_result import MotionResult

#: velocity and displacement at the end of a pulse, over peak x length and peak x length^2
PULSE_ENDS = {
    "rectangular": (1.0, 0.5),
    "half-sine": (2.0 / math.pi, 1.0 / math.pi),
    "sine": (1.0 / math.pi, 0.5 / math.pi),
}


def summary_from_keys(case: Case) -> MotionResult | None:
    """The motion's numbers where the keys alone determine them.

    None where the motion must be evaluated: a table, ramps, a run that ends before the peaks, or before the motion.
    """
    motion, duration = case.motion, longest_time(case)
    if motion.kind == "none":
        return MotionResult(kind="none", peak_acceleration_m_s2=0.0, peak_in_run_m_s2=0.0)
    if motion.kind == "harmonic":
        if motion.ramp_cycles > 0.0 or motion.cycles is not None or duration < motion.period:
            return None
        amplitude, rate = case.amplitude, case.angular_frequency
        peak = case.nominal_peak_acceleration
        return _covered("harmonic", duration, (peak or 0.0, amplitude * rate, amplitude))
    if motion.kind == "pulse" and motion.shape is not None and motion.pulse_s is not None:
        end, peak = motion.delay_s + motion.pulse_s, case.nominal_peak_acceleration or 0.0
        velocity, displacement = PULSE_ENDS[motion.shape]
        if duration < end:
            return None
        return _covered(
            "pulse", end, (peak, velocity * peak * motion.pulse_s, displacement * peak * motion.pulse_s**2)
        )
    return None


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
