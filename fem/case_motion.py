"""The base motion of a case, as the stepping takes it."""

from typing import TypeVar

import numpy as np

from contact.motion import BaseMotion, HarmonicMotion, NoMotion, PulseMotion, TableMotion
from contact.motion_file import read_motion_table
from fem.case import Case, CaseError

PEAK_SAMPLES = 20_001  #: over a run, beside the instants at which a pulse or a table changes

ValueT = TypeVar("ValueT")


def build_motion(case: Case) -> BaseMotion:
    """How the floor of the case moves.

    Raises:
        CaseError: if the file of a table is missing or is no table of motion, or if a motion is asked for
            that cannot be, with the reason.
    """
    try:
        return _build(case)
    except CaseError:
        raise
    except ValueError as error:
        raise CaseError(f"[motion] {error}") from error


def peak_acceleration_within(motion: BaseMotion, duration: float) -> float:
    """Largest |acceleration| that the floor reaches up to `duration` [m/s2].

    What it would do afterwards is no business of a static rule that is compared with the run.
    """
    if isinstance(motion, NoMotion | HarmonicMotion):
        return motion.peak_acceleration  # knows the duration of its case
    if isinstance(motion, PulseMotion):  # between these its size rises or falls
        quarters = motion.delay + motion.pulse * np.array([0.0, 0.25, 0.5, 0.75])
        instants = np.append(quarters, duration)
        return float(np.abs(motion.evaluate(instants[instants <= duration])[2]).max())
    instants = np.concatenate(
        [
            np.linspace(0.0, duration, PEAK_SAMPLES),
            np.asarray(motion.break_times, dtype=float),
            motion.times if isinstance(motion, TableMotion) else np.zeros(0),
        ]
    )
    inside = np.unique(instants[(instants >= 0.0) & (instants <= duration)])
    return float(np.abs(motion.evaluate(inside)[2]).max())


def _build(case: Case) -> BaseMotion:
    motion = case.motion
    match motion.kind:
        case "none":
            return NoMotion()
        case "harmonic":
            return HarmonicMotion(
                amplitude=motion.amplitude,
                angular_frequency=motion.angular_frequency,
                duration=case.solver.duration_s,
                phase=motion.phase_rad,
                ramp_cycles=motion.ramp_cycles,
                cycles=motion.cycles,
            )
        case "pulse":
            return PulseMotion(
                shape=_given(motion.shape, "shape"),
                acceleration=_given(motion.peak_acceleration_m_s2, "peak_acceleration_m_s2"),
                pulse=_given(motion.pulse_s, "pulse_s"),
                delay=motion.delay_s,
            )
        case "table":
            return read_motion_table(
                case.data_files["motion.file"],
                quantity=_given(motion.quantity, "quantity"),
                unit=_given(motion.unit, "unit"),
                scale=motion.scale,
                baseline=motion.baseline,
            )


def _given(value: ValueT | None, key: str) -> ValueT:
    """What the rules of the table have seen to: the chosen kind of motion is complete."""
    if value is None:
        raise CaseError(f"[motion] {key} is missing")
    return value
