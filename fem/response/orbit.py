"""The motion, period by period: a section at the end of each, and the extremes within it.

The stepping ends a step at each section, the floor's turning point at +A.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact.motion.kernel import HARMONIC, UNIFORM, FloorMotion, as_floor_motion, floor_motion
from contact.stepping.body import ANGULAR_VELOCITY, CENTRE_X, CENTRE_Z, ROTATION, VELOCITY_X
from contact.stepping.control import step_level, step_of_level
from contact.stepping.integrator import FAILED, OVERTURNED, REACHED
from contact.stepping.modal_body import ModalBody
from contact.stepping.outcome import advance_compiled
from contact.stepping.state import (
    ROW_ANGULAR_VELOCITY,
    ROW_ROTATION,
    ROW_SLIP,
    Buffers,
    RunState,
    make_samples,
)
from fem.case.case import Case
from fem.model.container import Container
from fem.model.model import Model, build_model
from fem.response.request import SAMPLES_PER_PERIOD
from fem.run.verdict import audit, softer_contact
from fem.runtime.arrays import FloatArray

#: state of the step control that is carried from one motion to the next
CARRIED = ("allowance_used", "recent_dissipation", "growth_hold", "lag_step")


def begin_drive(case: Case, container: Container) -> tuple[Model, float]:
    """The container as the case begins, and the time until the section [s].

    The case's own start: phase, ramp at the beginning, floor at rest or moving, initial state. It lasts to the first
    turning point of the floor at +A after the ramp.
    """
    model = build_model(case, container)
    omega, phase = case.motion.angular_frequency, case.motion.phase_rad
    period = 2.0 * math.pi / omega
    turn = ((0.5 * math.pi - phase) % (2.0 * math.pi)) / omega
    until = turn + math.ceil(case.motion.ramp_cycles) * period
    ramp = case.motion.ramp_cycles * period
    floor = as_floor_motion(HARMONIC, (case.motion.amplitude, omega, phase, ramp, math.inf))
    return _on_floor(model, floor, (ramp, until)), until


def driven_model(case: Case, container: Container) -> Model:
    """The container on x = A cos(Omega t), without the motion that it has."""
    drive = case.motion.amplitude, case.motion.angular_frequency, 0.5 * math.pi, 0.0, math.inf
    return _on_floor(build_model(case, container), as_floor_motion(HARMONIC, drive))


def carry_drive(case: Case, container: Container, before: Model) -> Model:
    """The container, moving as `before` left it at a turning point of its floor, on x = A cos(Omega t).

    The motion is carried, the damage is not: the floor is whole again.
    """
    driven = driven_model(case, container)
    _carry_state(before.run, driven.run)
    state, control = driven.run.old, driven.run.problem.control
    # Raised by its deepest indentation it bears there as before; a corner less deep is off the floor.
    raised = float(state.crushed[: control.base_points].max())
    if raised > 0.0:
        state.point[:, 1] += raised - state.crushed
        state.crushed[:] = 0.0
        state.position[1] += raised
        state.pose[CENTRE_Z] += raised
        state.corner[:, 1] += raised
        state.monitor[:, 1] += raised
        state.energy[2] += control.mass * control.gravity * raised
        state.force[state.point[:, 1] > 0.0] = 0.0
    return driven


def stop_drive(case: Case, container: Container, before: Model) -> Model:
    """The container, moving as `before` left it at a turning point of its floor; the floor stays there."""
    floor = as_floor_motion(UNIFORM, (0.0, case.motion.amplitude, 0.0))
    driven = _on_floor(build_model(case, container), floor)
    _carry_state(before.run, driven.run)
    return driven


def _carry_state(before: RunState, after: RunState) -> None:
    """Start `after` from the state of `before`, moved along x to where its floor is at t = 0."""
    for target, source in zip(after.old, before.old, strict=True):
        target[:] = source
    floor, _, _ = floor_motion(after.problem.motion, 0.0)
    shift = floor - before.floor[0, 0]
    after.old.position[0] += shift
    after.old.pose[CENTRE_X] += shift
    for name in CARRIED:
        after.clock[name] = before.clock[name]
    step = step_of_level(before.problem.control.largest_step, int(before.clock.level[0]))
    after.clock.level = step_level(
        after.problem.control.largest_step, min(step, after.problem.control.largest_step)
    )
    after.track[:] = before.track
    after.joints[:] = before.joints


def _on_floor(model: Model, floor: FloorMotion, breaks: Sequence[float] = ()) -> Model:
    """The model on another floor, at t = 0."""
    run, points = model.run, model.run.old.point.shape[0]
    run.floor[:] = floor_motion(floor, 0.0)
    run = run.with_problem(motion=floor, breaks=np.array([*(at for at in breaks if at > 0.0), np.inf]))
    step = period_of(model) / SAMPLES_PER_PERIOD
    history = make_samples(step, 4 * SAMPLES_PER_PERIOD, points, columns=True)
    run = run._replace(buffers=Buffers(history=history, frames=make_samples(math.inf, 4, points)))
    return replace(model, run=run)


def period_of(model: Model) -> float:
    """Of the drive [s]."""
    return 2.0 * math.pi / model.case.motion.angular_frequency


#: called with the time [s], the rotation [rad] and the mode; None: nobody asks
Progress = Callable[[float, float, int], None] | None

AUDITED = 10  #: periods after which the energy balance is checked as that of a run
STATUSES = {REACHED: "completed", OVERTURNED: "overturned", FAILED: "failed"}
#: columns of `Orbit.sections`
SECTION_COLUMNS = ("rotation_rad", "angular_velocity_rad_s", "centre_velocity_m_s", "slip_gained_m")
#: columns of `Orbit.extremes`, within a period
EXTREME_COLUMNS = (
    "max_rotation_rad",
    "least_rotation_rad",
    "most_rotation_rad",
    "rocking_rad",
    "slip_stroke_m",
    "impacts",
    "slip_excursion_m",  # from where it was at the start of the first period
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Orbit:
    """Consecutive periods of one motion."""

    status: str  #: completed | overturned | failed
    sections: FloatArray  #: (n, 4), see `SECTION_COLUMNS`
    extremes: FloatArray  #: (n, 7), see `EXTREME_COLUMNS`
    portrait: FloatArray  #: (n_samples, 2) rotation [rad] and angular velocity [rad/s] over the last periods
    reason: str | None = None  #: why it failed


def follow_periods(
    driven: Model, count: int, *, portrayed: int = 0, progress: Progress = None
) -> tuple[Model, Orbit]:
    """Step through `count` periods from a section.

    Args:
        driven: at a section, which is its t = 0.
        count: periods.
        portrayed: of how many last periods the phase portrait is kept.
        progress: called after each period.

    Returns:
        The model at the end, and its motion; fewer periods where it overturned or failed.
    """
    # At t = 0 again: it is at a section, so a whole number of periods is subtracted from its time, and the phase of the
    # drive is as exact in the last period as in the first. Steps end on each of the sections.
    times = driven.run.clock
    times.time, times.samples, times.samples_drained, times.next_break = 0.0, 0, 0, 0
    period = period_of(driven)
    breaks = np.append(period * np.arange(1, count + 1), np.inf)
    driven = replace(driven, run=driven.run.with_problem(breaks=breaks))
    run, track, clock = driven.run, driven.run.track[0], driven.run.clock[0]
    sections, extremes, portraits = [], [], []
    code, slipped, reason = REACHED, float(driven.run.joints[0].slip), None
    before = slipped
    _open_ledger(driven)
    for k, end in enumerate(breaks[:-1]):
        impacts = int(track.impacts)
        track.max_rotation, track.max_rocking = 0.0, 0.0
        code, samples = step_to(driven, end)
        if code != REACHED:
            break
        _, floor_velocity, _ = floor_motion(run.problem.motion, end)
        pose, slip = run.old.pose, float(driven.run.joints[0].slip)
        rotation = np.append(samples[:, ROW_ROTATION], pose[ROTATION])
        sliding = np.append(samples[:, ROW_SLIP], slip)
        speed = pose[VELOCITY_X] - floor_velocity
        sections.append([pose[ROTATION], pose[ANGULAR_VELOCITY], speed, slip - slipped])
        turned = float(track.max_rotation), rotation.min(), rotation.max(), float(track.max_rocking)
        slid = np.ptp(sliding), int(track.impacts) - impacts, float(np.abs(sliding - before).max())
        extremes.append([*turned, *slid])
        slipped = slip
        if k >= count - portrayed:
            portraits.append(samples[:, [ROW_ROTATION, ROW_ANGULAR_VELOCITY]])
        if progress is not None:
            progress(float(clock.time), float(pose[ROTATION]), int(track.mode))
        if k % AUDITED == AUDITED - 1:
            reason = audit(driven)
            if reason is not None:
                break
            _open_ledger(driven)
    status = STATUSES[code]
    if code == FAILED:
        reason = (
            f"after {clock.time / period:.6g} periods: the contact forces do not converge at the smallest "
            f"step ({run.problem.control.smallest_step:.1g} s); try {softer_contact(driven.case)}, "
            "contact.weakening_m > 0, or a smaller solver.step_s"
        )
    else:
        reason = reason or audit(driven)
        status = "failed" if reason else status
    return driven, orbit_of(status, reason, sections, extremes, portraits)


def orbit_of(status: str, reason: str | None, *periods: list[Any]) -> Orbit:
    """An orbit from the sections, extremes and portraits of its periods; without these, of a motion that had none."""
    sections, extremes, portraits = periods or ([], [], [])
    return Orbit(
        status=status,
        sections=np.array(sections).reshape(-1, len(SECTION_COLUMNS)),
        extremes=np.array(extremes).reshape(-1, len(EXTREME_COLUMNS)),
        portrait=np.concatenate([np.zeros((0, 2)), *portraits]),
        reason=reason,
    )


def _open_ledger(driven: Model) -> None:
    """Reset the energy balance."""
    driven.run.ledger[:] = 0.0
    for name in ("least_imbalance", "most_imbalance", "dissipated"):
        driven.run.clock[name] = 0.0


def step_to(driven: Model, end: float) -> tuple[int, FloatArray]:
    """Step to an instant [s] that is a break of the run, or to a fall; the code, and the samples on the way."""
    body, run, clock = driven.body, driven.run, driven.run.clock[0]
    if not isinstance(body, ModalBody):
        raise TypeError("a response curve is followed with the compiled models")  # the request excludes it
    drained = []
    while True:
        code = advance_compiled(body, run, end)
        count = int(clock.samples - clock.samples_drained)
        drained.append(run.buffers.history.columns[:count].copy())
        clock.samples_drained = clock.samples
        if code != REACHED or clock.time >= end or math.isinf(end):
            return code, np.concatenate(drained)


LARGEST_PERIOD = 16  #: tried, in periods of the drive; and at most a third of the window
REPEATS = 3  #: of a period within the window, at least
#: of a section against the one n periods before; an elastic container that slides and rings scatters by 3e-3
TOLERANCE = 5e-3
#: distances over the second half of the window less than this share of those over the first: still settling
SETTLING = 0.5
#: growth of the largest amplitude from the first half to the second beyond which amplitudes diverge
GROWTH = 0.1
NEGLIGIBLE = 0.01  #: of the slenderness angle: smaller amplitudes do not grow

Decay = tuple[str, float | None]  #: fate of a motion without its drive, and time [s]


@dataclass(frozen=True, kw_only=True)
class LongTime:
    """Long-time motion, with the figures that decide, by the columns of a point."""

    long_time: str  #: rest | periodic | not periodic | not settled
    period_n: int | None  #: of a periodic motion, in periods of the drive
    scatter: float  #: largest distance of sections n apart; of the best n where none was good enough
    pairs_compared: int  #: sections, behind it
    settling: float | None  #: distances over the second half by those over the first; None where periodic


def classify(sections: FloatArray, *, resting: bool) -> LongTime:
    """Judge a window of sections.

    Args:
        sections: (n, k), n at least 4, scaled to order one.
        resting: nothing moved beyond the limits of a verdict.
    """

    def distances(n: int) -> FloatArray:
        """Largest coordinate of the difference of each section to the one n before, shape (count - n,)."""
        return np.asarray(np.abs(sections[n:] - sections[:-n]).max(axis=1))

    def approach(n: int) -> float:
        """Mean distance of sections n apart in the second half of the window over that in the first."""
        apart = distances(n)
        half = apart.size // 2
        return float(apart[-half:].mean() / max(apart[:half].mean(), 1e-300))

    count = len(sections)
    looked_for = min(LARGEST_PERIOD, count // REPEATS)
    scatters = np.array([distances(n).max() for n in range(1, looked_for + 1)])
    repeating = np.flatnonzero(scatters <= TOLERANCE)
    n = int(repeating[0]) + 1 if repeating.size else int(np.argmin(scatters)) + 1
    period = ratio = None
    if resting:
        kind = "rest"
    else:
        # a spiral toward a motion of period m comes back to itself first after a multiple of m
        tried = [m for m in range(1, n) if n % m == 0] if repeating.size else range(1, looked_for + 1)
        ratio = min((approach(m) for m in tried), default=None)
        if ratio is not None and ratio < SETTLING:
            kind = "not settled"
        elif repeating.size:
            kind, period, ratio = "periodic", n, None
        else:
            kind = "not periodic"
    scatter, compared = float(scatters[n - 1]), count - n
    return LongTime(long_time=kind, period_n=period, scatter=scatter, pairs_compared=compared, settling=ratio)


def amplitude_growth(amplitudes: FloatArray) -> float:
    """Largest amplitude in the second half of the window over that in the first, less one [-].

    Beyond `GROWTH` it diverges.

    Args:
        amplitudes: (n,) largest |rotation| of each period, over the slenderness angle.
    """
    half = amplitudes.size // 2
    first, second = float(amplitudes[:half].max()), float(amplitudes[-half:].max())
    return (second - first) / max(first, NEGLIGIBLE)
