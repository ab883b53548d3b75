"""The base motion of a case, and doubts about a recorded one."""

import math
from typing import TypeVar

import numpy as np

from contact.motion.base_motion import BaseMotion, HarmonicMotion, NoMotion, PulseMotion, TableMotion
from contact.motion.table_file import read_motion_table
from fem.case import quantities as q
from fem.case.case import Case, CaseError

DRIFT = 0.1  #: over the largest velocity: velocity at the end of a table from which a drift is reported
COARSE = 2.0 * math.sin(math.pi / 10.0)  #: change between samples over the amplitude, ten samples a period
PEAK_SAMPLES = 20_001  #: over a run, in addition to the instants at which a pulse or a table changes

ValueT = TypeVar("ValueT")


def build_motion(case: Case) -> BaseMotion:
    """How the floor of the case moves.

    Raises:
        CaseError: the file of a table is missing or is no table of motion; an impossible motion.
    """
    try:
        return _build(case)
    except CaseError:
        raise
    except ValueError as error:
        raise CaseError(f"[motion] {error}") from error


def peak_acceleration_within(motion: BaseMotion, duration: float) -> float:
    """Largest |acceleration| of the floor up to `duration`, the end of the run [m/s2]."""
    if isinstance(motion, NoMotion | HarmonicMotion):
        return motion.peak_acceleration  # within the duration of its case
    if isinstance(motion, PulseMotion):  # between these instants its size is monotonic
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


def motion_notes(motion: BaseMotion) -> list[str]:
    """Doubts about a recorded motion: a drift, samples too far apart."""
    if not isinstance(motion, TableMotion):
        return []
    notes = []
    velocity, values = motion.evaluate(motion.times)[1], motion.accelerations
    last, largest = float(velocity[-1]), float(np.abs(velocity).max())
    if motion.quantity == "acceleration" and abs(last) > DRIFT * largest > 0.0:
        notes.append(
            f"motion.file: its mean acceleration, {last / np.ptp(motion.times):.3g} m/s2, leaves the floor with "
            f'{last:.3g} m/s at the end of the table: it drifts; baseline = "mean" ends it at rest, "linear" at '
            "rest where it began"
        )
    size, change = float(np.sqrt(np.mean(values**2))), float(np.sqrt(np.mean(np.diff(values) ** 2)))
    if change > COARSE * size:
        notes.append(
            f"motion.file: the acceleration changes by {change / size:.2g} of its own size from one sample to the next "
            f"({COARSE:.2g} is ten samples a period): the samples, {np.median(np.diff(motion.times)):.3g} s apart, are "
            "too coarse for this motion; use a record with a shorter sampling interval"
        )
    return notes


def _plausible(motion: TableMotion) -> TableMotion:
    peak = motion.peak_acceleration
    if q.PEAK_ACCELERATION.allows(peak):
        return motion
    guess = (
        q.PEAK_ACCELERATION.guess(peak) or "is its unit right, and are displacements sampled closely enough?"
    )
    raise CaseError(
        f"[motion] file: its accelerations reach {peak:.4g} m/s2, at most {q.PEAK_ACCELERATION.most:g} m/s2 are "
        f"accepted; {guess}"
    )


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
            return _plausible(
                read_motion_table(
                    case.data_files["motion.file"],
                    quantity=_given(motion.quantity, "quantity"),
                    unit=_given(motion.unit, "unit"),
                    scale=motion.scale,
                    baseline=motion.baseline,
                )
            )


def _given(value: ValueT | None, key: str) -> ValueT:
    """A key that the rules of the case file require for this kind of motion."""
    if value is None:
        raise CaseError(f"[motion] {key} is missing")
    return value
