"""The motions of the floor of a case, along x and vertical: how long a run follows them, their numbers, doubts."""

import math
from dataclasses import replace
from typing import Any, assert_never

import numpy as np

from contact.motion.base_motion import (
    BaseMotion,
    HarmonicMotion,
    NoMotion,
    PulseMotion,
    SingleMotion,
    TableMotion,
    along_and_normal,
)
from fem.case.case import Case, CaseError
from fem.case.case_rules import CASE_RULES
from fem.case.recorded import MotionKey, recorded_motion
from fem.case.tables import quantities as q
from fem.case.tables.duration import MOST_FREE_MOTION, ends_at_rest, longest_time
from fem.case.tables.motion_tables import FloorMotionTable
from fem.case.tables.problem import broken
from fem.case.validation import problem_lines
from fem.model.motion_summary import numbers_from_keys
from fem.results.run_result import MotionResult

DRIFT = 0.1  #: over the largest velocity: velocity at the end of a table from which a drift is reported
COARSE = 2.0 * math.sin(math.pi / 10.0)  #: change between samples over the amplitude, ten samples a period
CYCLE_SAMPLES, MOST_CYCLES = 256, 4000  #: samples of a cycle for its peaks, of so many cycles at most

#: rules of a case that limit what a long run makes
BOUNDED = [
    rule for rule in CASE_RULES if rule.place in ("solver.step_s", "output.history_s", "output.fields_s")
]


def build_motions(
    case: Case, before: tuple[Case, BaseMotion, BaseMotion] | None = None
) -> tuple[BaseMotion, BaseMotion]:
    """How the floor of the case moves along x, which is along a slope, and up and down, which is normal to one.

    `before`: another case with its motions, which are taken where they are recorded and the same.
    """
    turn = case.floor.turn
    if before is not None and case.motion.kind == "table":
        other, motion, vertical = before
        same = case.motion == other.motion and case.folder == other.folder and case.recorded is other.recorded
        if same and turn == other.floor.turn and (case.vertical == other.vertical or not turn):
            return motion, vertical if case.vertical == other.vertical else build_motion(case, "vertical")
    motions = build_motion(case), build_motion(case, "vertical")
    return along_and_normal(*motions, turn) if turn else motions


def motions_end(*motions: BaseMotion) -> float:
    """When the last of them ends; infinite where none has an end [s]."""
    return max((motion.span[1] for motion in motions if not isinstance(motion, NoMotion)), default=math.inf)


def longest_run(case: Case, *motions: BaseMotion) -> float:
    """Simulated time of a run on its motions, at most [s]; CaseError: a record too long for its samples or steps."""
    if "table" not in (case.motion.kind, case.vertical.kind) or not ends_at_rest(case):
        return longest_time(case)
    longest = motions_end(*motions) + MOST_FREE_MOTION
    solver = case.solver.model_copy(update={"duration_s": longest})
    if problems := broken(BOUNDED, case.model_copy(update={"solver": solver})):
        raise CaseError("\n".join(problem_lines(problems)))
    return longest


def motion_result(case: Case, motion: BaseMotion, vertical: BaseMotion) -> MotionResult:
    """The numbers of both motions, along the floor and normal to it, and doubts about them."""
    duration = longest_run(case, motion, vertical)

    def numbers(keys: FloorMotionTable, motion: BaseMotion, table: MotionKey) -> MotionResult:
        turned = case.floor.turn != 0.0 and not isinstance(motion, NoMotion)
        result = None if turned else numbers_from_keys(keys, longest_time(case))
        of_record = recorded_motion(case, table).notes if keys.kind == "table" else ()
        return replace(
            result or _evaluated(motion, duration),
            kind=keys.kind if keys.kind != "none" or not turned else case.motion.kind,
            notes=(*of_record, *motion_notes(motion, table)),
            endless=(isinstance(motion, HarmonicMotion) and math.isinf(motion.end_time)) or None,
        )

    upward = numbers(case.vertical, vertical, "vertical") if case.has_normal else None
    return replace(numbers(case.motion, motion, "motion"), vertical=upward)


def _evaluated(motion: BaseMotion, duration: float) -> MotionResult:
    """Numbers of a motion that is evaluated, for a run of this duration [s]."""
    begin, end = motion.span
    if isinstance(motion, HarmonicMotion):
        end = motion.end_time if math.isfinite(motion.end_time) else duration
    # instants that are dense enough for the peaks of displacement and velocity, within 0.01 %
    if isinstance(motion, TableMotion):  # samples, and where acceleration and then velocity pass through zero
        times = motion.times
        for row in (2, 1):
            before, after = (values := motion.evaluate(times)[row])[:-1], values[1:]
            through = before * after < 0.0
            share = before[through] / (before[through] - after[through])
            times = np.unique(np.append(times, times[:-1][through] + share * np.diff(times)[through]))
    else:
        cycles = min(math.ceil((end - begin) / motion.time_scale), MOST_CYCLES)
        times = np.linspace(begin, end, CYCLE_SAMPLES * max(cycles, 1) + 1)
    peaks = np.abs(motion.evaluate(times)).max(axis=1)
    if isinstance(motion, PulseMotion):
        begin = 0.0  # its delay is a part of it
    covered = max(0.0, min(end, duration) - max(begin, 0.0)) / (end - begin)
    whole = motion.peak_acceleration
    table = motion if isinstance(motion, TableMotion) else None
    residual = None if table is None else table.evaluate(table.times[-1:])[:, 0]
    return MotionResult(
        duration_s=end - begin,
        begin_s=begin if begin < 0.0 else None,
        step_s=None if table is None else float(np.median(np.diff(table.times))),
        samples=None if table is None else table.times.size,
        peak_acceleration_m_s2=whole,
        peak_velocity_m_s=float(peaks[1]),
        peak_displacement_m=float(peaks[0]),
        residual_velocity_m_s=None if residual is None else float(residual[1]),
        residual_displacement_m=None if residual is None else float(residual[0]),
        covered=covered,
        peak_in_run_m_s2=motion.peak_within(duration),
    )


def peaks_in_run(
    case: Case, motion: BaseMotion, vertical: BaseMotion, duration: float | None = None
) -> tuple[float, float | None]:
    """Largest |acceleration| of the floor in the run, along x and vertical [m/s2]; None: no vertical motion.

    `duration` is its `longest_run`, where that is known.
    """
    duration = longest_run(case, motion, vertical) if duration is None else duration
    upward = vertical.peak_within(duration) if case.has_normal else None
    return motion.peak_within(duration), upward


def motion_notes(motion: BaseMotion, table: MotionKey = "motion") -> list[str]:
    """Doubts about a recorded motion, of this table: a drift, samples too far apart."""
    if not isinstance(motion, TableMotion):
        return []
    notes = []
    velocity, values = motion.evaluate(motion.times)[1], motion.accelerations
    last, largest = float(velocity[-1]), float(np.abs(velocity).max())
    if motion.quantity == "acceleration" and abs(last) > DRIFT * largest > 0.0:
        notes.append(
            f"{table}.file: its mean acceleration, {last / np.ptp(motion.times):.3g} m/s2, leaves the floor with "
            f'{last:.3g} m/s at the end of the table: it drifts; baseline = "mean" ends it at rest, "linear" at '
            "rest where it began"
        )
    size, change = float(np.sqrt(np.mean(values**2))), float(np.sqrt(np.mean(np.diff(values) ** 2)))
    if change > COARSE * size:
        notes.append(
            f"{table}.file: the acceleration changes by {change / size:.2g} of its own size from one sample to the "
            f"next ({COARSE:.2g} is ten samples a period): the samples, {np.median(np.diff(motion.times)):.3g} s "
            "apart, are too coarse for this motion; use a record with a shorter sampling interval"
        )
    return notes


def _plausible(motion: TableMotion, table: MotionKey) -> TableMotion:
    """The motion, if it lasts into the run and no acceleration is too large; else a CaseError."""
    if motion.times[-1] <= 0.0:
        raise CaseError(
            f"[{table}] file: its times end at {motion.times[-1]:g} s, and the run begins at t = 0; shift them"
        )
    limits, peak = q.PEAK_ACCELERATION, motion.peak_acceleration
    if limits.allows(peak):
        return motion
    guess = limits.guess(peak) or "is its unit right, and are displacements sampled closely enough?"
    raise CaseError(
        f"[{table}] file: its accelerations reach {peak:.4g} m/s2, at most {limits.most:g} m/s2 are accepted; {guess}"
    )


def build_motion(case: Case, table: MotionKey = "motion") -> SingleMotion:
    """The motion [motion] of the case, or [vertical], positive upward.

    CaseError: a missing or unfit file, or an impossible motion.
    """
    motion = case.vertical if table == "vertical" else case.motion

    def given(key: str) -> Any:
        """A key that the rules of the case file require for this kind of motion."""
        value = getattr(motion, key)
        if value is None:
            raise CaseError(f"[{table}] {key} is missing")
        return value

    try:
        match motion.kind:
            case "none":
                return NoMotion()
            case "harmonic":
                return HarmonicMotion(
                    amplitude=motion.amplitude,
                    angular_frequency=motion.angular_frequency,
                    duration=longest_time(case),
                    phase=motion.phase_rad + (math.pi if motion.factor < 0.0 else 0.0),
                    ramp_cycles=motion.ramp_cycles,
                    cycles=motion.cycles,
                )
            case "pulse":
                return PulseMotion(
                    shape=given("shape"),
                    acceleration=motion.factor * given("peak_acceleration_m_s2"),
                    pulse=given("pulse_s"),
                    delay=motion.delay_s,
                )
            case "table":
                made = recorded_motion(case, table).motion
                recorded = TableMotion(times=made.times, values=made.values, quantity=motion.quantity)
                return _plausible(recorded, table)
        assert_never(motion.kind)
    except CaseError:
        raise
    except ValueError as error:
        raise CaseError(f"[{table}] {error}") from error
