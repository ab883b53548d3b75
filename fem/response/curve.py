"""Response curves: one frequency after the other, up and down, and each from random states of the container.

Up and down the motion is carried on from one frequency to the next, onto a floor that is whole. After a fall or a
destroyed corner the next frequency begins as the case does. Each ends with the drive stopped, on a copy of the motion.
A motion that random states lead to, and the curve does not, is followed to the neighbouring frequencies.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from contact.stepping.integrator import OVERTURNED, REACHED
from contact.stepping.modes import ROCKING
from contact.stepping.outcome import advance_compiled
from contact.stepping.state import Control
from fem.case.case import Case
from fem.model.container import Container
from fem.response.lasting import differ, lasting_at
from fem.response.model import DrivenModel, begin_drive, carry_drive, stop_drive
from fem.response.orbit import Orbit, Progress, follow_periods, no_progress, orbit_of, step_until
from fem.response.records import PORTRAYED, PointRecord, record_of
from fem.response.request import ResponseRequest
from fem.response.stability import Decay, LongTime, classify
from fem.results.outcome import Outcome, least_slide
from fem.run.verdict import audit, destroyed_corner

WINDOWS = 4  #: a motion that is not settled is observed again, at most so many windows in all
SEED = 1  #: of the random states
REACH = (0.6, 0.7)  #: of random states: rotation over the slenderness angle al, angular velocity over al p
PHASES = 3  #: sections of a motion from which it is followed to a neighbour, at most
#: at rest: for so long, in 1/p, it neither turned beyond the limit of a verdict nor slid
STILL = 2.0
STILL_SLIP = 1e-6  #: over the width, between two checks
LOOK = 0.02  #: between two checks, in 1/p
PATIENCE = 400.0  #: followed at most, in 1/p


@dataclass(frozen=True, kw_only=True)
class Task:
    """A frequency and what leads to it."""

    way: str  #: up | down: carried on; random: from random states; risen | sunk: from the motions of a neighbour
    number: int  #: of the frequency, from 0 for the lowest
    model: str
    begins: bool = False  #: a sweep, as the case does

    @property
    def carries(self) -> bool:
        """Whether its motion is carried on to the next frequency."""
        return self.way in ("up", "down")


def plan_of(request: ResponseRequest) -> list[Task]:
    """All tasks, in the order in which they are computed."""
    own = request.case.solver.model
    ways = [(way, own) for way in ("up", "down", *(("random", "risen", "sunk") if request.starts else ()))]
    return [
        Task(way=way, number=number, model=model, begins=(way, number) == ("up", 0))
        for way, model in [*ways, *[(way, "reduced") for way in ("up", "down") if request.shell]]
        for number in range(request.count)[:: -1 if way in ("down", "sunk") else 1]
    ]


def computed(
    request: ResponseRequest,
    container: Container,
    task: Task,
    records: Sequence[PointRecord],
    before: DrivenModel | None,
    control: Control,
    progress: Progress = no_progress,
) -> tuple[list[PointRecord], DrivenModel | None]:
    """The points of a task, and the motion to carry on; None where there is none.

    Args:
        request: frequencies and drive.
        container: of its case.
        task: what to compute.
        records: what was computed before.
        before: the motion to carry on; None: begin as the case does.
        control: of its model.
        progress: called within a point with the time since its beginning [s], the rotation [rad] and the mode.
    """
    case = request.case_at(task.number, task.model)
    if task.carries:
        point = follow_point(request, case, container, task, None if task.begins else before, progress)
        return [point[0]], point[1]
    found: list[PointRecord] = []
    states = (
        _random_states(request, task, control) if task.way == "random" else neighbours(records, found, task)
    )
    at_section = {"initial.velocity_m_s": 0.0, "motion.phase_rad": 0.5 * math.pi, "motion.ramp_cycles": 0.0}
    for rotation, rate in states:
        start = {"initial.rotation_rad": rotation, "initial.angular_velocity_rad_s": rate}
        begun = case.with_values(start | at_section)
        found.append(follow_point(request, begun, container, task, None, progress)[0])
    return found, None


def _random_states(request: ResponseRequest, task: Task, control: Control) -> list[tuple[float, float]]:
    """Rotations [rad] and angular velocities [rad/s] as the floor turns at +A, the same whenever they are asked for."""
    drawn = np.random.default_rng([SEED, task.number]).uniform(-1.0, 1.0, (request.starts, 2))
    angle = control.slenderness_angle
    largest = np.multiply(REACH, [angle, angle * control.frequency_parameter])
    return [(float(rotation), float(rate)) for rotation, rate in drawn * largest]


def neighbours(
    records: Sequence[PointRecord], found: Sequence[PointRecord], task: Task
) -> Iterator[tuple[float, float]]:
    """States of the motions off the curve that last at the frequency before and were not found at this one.

    `found` grows meanwhile by what these states led to.
    """
    for group in lasting_at(records, task.number + (-1 if task.way == "risen" else 1)):
        if any(record.row.direction != "start" for record in group):
            continue
        for turned, rate in group[0].sections[-min(group[0].row.period_n or 1, PHASES) :, :2]:
            here = lasting_at([*records, *found], task.number)
            if all(differ(group[0], known[0]) for known in here):
                yield float(turned), float(rate)


def follow_point(
    request: ResponseRequest,
    case: Case,
    container: Container,
    task: Task,
    before: DrivenModel | None = None,
    progress: Progress = no_progress,
) -> tuple[PointRecord, DrivenModel | None]:
    """One frequency, from the motion before or as its case begins; returns the point and the motion to carry on."""
    driven, orbit = _settled(request, case, container, before, progress)
    judged, periods = None, len(orbit.sections)
    for _ in range(WINDOWS):
        if orbit.status != "completed" or destroyed_corner(driven.model):
            break
        driven, orbit = follow_periods(driven, request.observe, portrayed=PORTRAYED, progress=progress)
        periods += len(orbit.sections)
        judged = _judge(request, case, driven, orbit) if len(orbit.sections) == request.observe else None
        if judged is not None and judged.kind != "not settled":
            break
    crushed = destroyed_corner(driven.model)
    stands = orbit.status == "completed" and not crushed
    fall = f"it overturned in period {periods + 1} of the drive" if orbit.status == "overturned" else None
    record = record_of(
        case,
        orbit,
        driven.run.problem.control,
        judged if stands else None,
        _follow_decay(case, container, driven) if stands and task.carries else None,
        direction=task.way if task.carries else "start",
        number=task.number,
        began=task.way if not task.carries else "case" if before is None else "carried",
        motion=None if orbit.status == "failed" else _motion_of(driven, orbit),
        periods=periods,
        reason=crushed or orbit.reason or fall,
    )
    return record, driven if stands else None


def _settled(
    request: ResponseRequest, case: Case, container: Container, before: DrivenModel | None, progress: Progress
) -> tuple[DrivenModel, Orbit]:
    """The model after the periods left out, and their orbit; an empty one where it fell before the first section."""
    if before is None:
        before, until = begin_drive(case, container)
        status = step_until(before, until) if until > 0.0 else "completed"
        if status != "completed":
            reason = "failed before the first section" if status == "failed" else None
            return before, orbit_of(status, reason)
    return follow_periods(carry_drive(case, container, before), request.settle, progress=progress)


def _judge(request: ResponseRequest, case: Case, driven: DrivenModel, orbit: Orbit) -> LongTime:
    """The long-time motion of a window of periods."""
    control = driven.run.problem.control
    angle, amplitude, omega = control.slenderness_angle, case.motion.amplitude, case.motion.angular_frequency
    scales = [angle, angle * control.frequency_parameter, amplitude * omega, amplitude]
    return classify(orbit.sections / scales, resting=_motion_of(driven, orbit) == Outcome.REST)


def _motion_of(driven: DrivenModel, orbit: Orbit) -> str:
    """One word for a window of periods, with the limits of a verdict."""
    if destroyed_corner(driven.model):
        return Outcome.INVALID
    if orbit.status == "overturned":
        return Outcome.OVERTURNED
    control = driven.run.problem.control
    rocks = orbit.extremes[:, 3].max(initial=0.0) > ROCKING * control.slenderness_angle
    return Outcome.of(slides=orbit.extremes[:, 4].max(initial=0.0) > least_slide(control.width), rocks=rocks)


def _follow_decay(case: Case, container: Container, driven: DrivenModel) -> Decay:
    """What becomes of it with the floor stopped at a turning point, which is no impulse, and the time until then [s].

    dies out | overturns | goes on | failed. Whether a motion dies out is condition (b) of stability in Knoedel and
    Hrabowski, section 2.
    """
    stopped = stop_drive(case, container, driven)
    run, control = stopped.run, stopped.run.problem.control
    clock, track, joint = run.clock[0], run.track[0], run.joints[0]
    look = LOOK / control.frequency_parameter
    moved_at, limit = 0.0, ROCKING * control.slenderness_angle
    while clock.time < PATIENCE / control.frequency_parameter:
        track.max_rotation, travelled = 0.0, float(joint.slip_travel)
        code = advance_compiled(stopped.body, run, float(clock.time) + look)
        clock.samples_drained = clock.samples
        if code == OVERTURNED:
            return "overturns", float(track.overturned_at)
        if code != REACHED:
            return "failed", None
        if track.max_rotation > limit or joint.slip_travel - travelled > STILL_SLIP * control.width:
            moved_at = float(clock.time)
        if clock.time - moved_at > STILL / control.frequency_parameter:
            return "failed" if audit(stopped.model) else "dies out", moved_at
    return "goes on", None
