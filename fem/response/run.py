"""A response curve from a request to its folder: points, their tables, what lasts, figures.

After every task the folder holds all points and the motion that is carried on, so an interrupted or killed response
curve continues where it was, to the same bytes.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, Unpack

import numpy as np

from contact.stepping.integrator import OVERTURNED, REACHED
from contact.stepping.modes import ROCKING
from contact.stepping.state import Control
from fem.case.case import Case, to_toml
from fem.model.container import Container, discretise
from fem.model.model import Model, build_model
from fem.response.figures import response_figures
from fem.response.lasting import (
    PORTRAYED,
    PointRecord,
    PointRow,
    ResponseResult,
    differ,
    lasting_at,
    packed,
    record_of,
    result_of,
    tables_of,
    unpacked,
)
from fem.response.orbit import (
    STATUSES,
    Decay,
    Orbit,
    Progress,
    begin_drive,
    carry_drive,
    classify,
    driven_model,
    follow_periods,
    orbit_of,
    step_to,
    stop_drive,
)
from fem.response.request import SAMPLES_PER_PERIOD, TURN, ResponseRequest
from fem.results.archive import CheckpointError
from fem.results.disk import table_bytes
from fem.results.folder import ResultFolder
from fem.results.kinds import RESPONSE
from fem.results.outcome import MODES, Outcome, least_slide
from fem.run.expected import of_a_second, say_expected
from fem.run.output import changing, require_same
from fem.run.verdict import audit, destroyed_corner
from fem.study.driver import Study, StudyOptions, run_study
from fem.study.runner import Runner

WINDOWS = 4  #: a motion that is not settled is observed again, at most so many windows in all
SEED = 1  #: of the random states
REACH = (0.6, 0.7)  #: of random states: rotation over the slenderness angle al, angular velocity over al p
PHASES = 3  #: sections of a motion from which it is followed to a neighbour, at most
STILL = 2.0  #: at rest: for so long, in 1/p, it neither turned beyond the limit of a verdict nor slid
STILL_SLIP = 1e-6  #: over the width, between two checks
LOOK = 0.02  #: between two checks, in 1/p
PATIENCE = 400.0  #: followed at most, in 1/p


class Task(NamedTuple):
    """A frequency and what leads to it."""

    way: str  #: up | down: carried on; random: from random states; risen | sunk: from the motions of a neighbour
    number: int  #: of the frequency, from 0 for the lowest
    model: str

    @property
    def carries(self) -> bool:
        """Whether its motion is carried on to the next frequency."""
        return self.way in ("up", "down")


def plan_of(request: ResponseRequest) -> list[Task]:
    """All tasks, in the order in which they are computed."""
    own = request.case.solver.model
    ways = [(way, own) for way in ("up", "down", *(("random", "risen", "sunk") if request.starts else ()))]
    return [
        Task(way, number, model)
        for way, model in [*ways, *[(way, "reduced") for way in ("up", "down") if request.shell]]
        for number in range(request.count)[:: -1 if way in ("down", "sunk") else 1]
    ]


def computed(
    request: ResponseRequest,
    container: Container,
    task: Task,
    records: Sequence[PointRecord],
    before: Model | None,
    control: Control,
    progress: Progress = None,
) -> tuple[list[PointRecord], Model | None]:
    """The points of a task, and the motion to carry on; None where there is none.

    Args:
        records: what was computed before.
        before: the motion to carry on; None: begin as the case does.
        progress: called within a point with the time since its beginning [s], the rotation [rad] and the mode.
    """
    case = request.case_at(task.number, task.model)
    if task.carries:
        begins = (task.way, task.number) == ("up", 0)
        point = follow_point(request, case, container, task, None if begins else before, progress)
        return [point[0]], point[1]
    found: list[PointRecord] = []
    states: Iterable[Sequence[float]] = _neighbours(records, found, task)
    if task.way == "random":  # as the floor turns at +A, the same whenever they are asked for
        drawn = np.random.default_rng([SEED, task.number]).uniform(-1.0, 1.0, (request.starts, 2))
        angle = control.slenderness_angle
        states = (drawn * np.multiply(REACH, [angle, angle * control.frequency_parameter])).tolist()
    at_section = {"initial.velocity_m_s": 0.0, "motion.phase_rad": 0.5 * math.pi, "motion.ramp_cycles": 0.0}
    for rotation, rate in states:
        start = {"initial.rotation_rad": rotation, "initial.angular_velocity_rad_s": rate}
        begun = case.with_values(start | at_section)
        found.append(follow_point(request, begun, container, task, None, progress)[0])
    return found, None


def _neighbours(
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
    before: Model | None = None,
    progress: Progress = None,
) -> tuple[PointRecord, Model | None]:
    """One frequency, from the motion before or as its case begins; returns the point and the motion to carry on."""
    at_section, status = before, "completed"
    if at_section is None:
        at_section, until = begin_drive(case, container)
        status = STATUSES[step_to(at_section, until)[0]] if until > 0.0 else status
    if status == "completed":
        on_floor = carry_drive(case, container, at_section)
        driven, orbit = follow_periods(on_floor, request.settle, progress=progress)
    else:  # it fell before the first section
        reason = "failed before the first section" if status == "failed" else None
        driven, orbit = at_section, orbit_of(status, reason)
    judged, periods = None, len(orbit.sections)
    for _ in range(WINDOWS):
        if orbit.status != "completed" or destroyed_corner(driven):
            break
        driven, orbit = follow_periods(driven, request.observe, portrayed=PORTRAYED, progress=progress)
        periods += len(orbit.sections)
        judged = None
        if len(orbit.sections) == request.observe:
            control, amplitude = driven.run.problem.control, case.motion.amplitude
            angle, speed = control.slenderness_angle, amplitude * case.motion.angular_frequency
            scaled = orbit.sections / [angle, angle * control.frequency_parameter, speed, amplitude]
            judged = classify(scaled, resting=_motion_of(driven, orbit) == Outcome.REST)
            if judged.long_time != "not settled":
                break
    crushed = destroyed_corner(driven)
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


def _motion_of(driven: Model, orbit: Orbit) -> str:
    """One word for a window of periods, with the limits of a verdict."""
    if destroyed_corner(driven):
        return Outcome.INVALID
    if orbit.status == "overturned":
        return Outcome.OVERTURNED
    control = driven.run.problem.control
    rocks = orbit.extremes[:, 3].max(initial=0.0) > ROCKING * control.slenderness_angle
    return Outcome.of(slides=orbit.extremes[:, 4].max(initial=0.0) > least_slide(control.width), rocks=rocks)


def _follow_decay(case: Case, container: Container, driven: Model) -> Decay:
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
        code, _ = step_to(stopped, float(clock.time) + look)
        if code == OVERTURNED:
            return "overturns", float(track.overturned_at)
        if code != REACHED:
            return "failed", None
        if track.max_rotation > limit or joint.slip_travel - travelled > STILL_SLIP * control.width:
            moved_at = float(clock.time)
        if clock.time - moved_at > STILL / control.frequency_parameter:
            return "failed" if audit(stopped) else "dies out", moved_at
    return "goes on", None


STATE = "state.npz"
#: numbers of a period and of a sample in their tables and twice in the state, of a point in its files
OF_A_PERIOD, OF_A_SAMPLE, OF_A_POINT = 19, 4, 100


def run_response(
    request: ResponseRequest, *, folder: Path, **options: Unpack[StudyOptions]
) -> ResponseResult:
    """Compute a response curve into a folder; raises as `run_study`, and CaseError and MeshError for bad input."""
    begun = ResponseResult(
        asked=request.hash, case=request.case.name, title=request.case.title, request=request.to_dict()
    )
    portrait = min(request.observe, PORTRAYED) * SAMPLES_PER_PERIOD * OF_A_SAMPLE
    points, plan = request.count * (2 + 2 * request.shell + request.starts), plan_of(request)

    def compute(results: ResultFolder, runner: Runner) -> ResponseResult:
        """Add the points that are missing, and write their tables and figures."""
        done, records = _follow(request, plan, results, runner)
        for name, text in tables_of(request, records).items():
            results.write(name, text)
        for name, svg in response_figures(request, records).items():
            results.write(f"figures/{name}.svg", svg)
        missing = f"{done} of {len(plan)} steps are computed" if done < len(plan) else None
        return result_of(begun, records, missing)

    study = Study(
        kind=RESPONSE,
        request=request.hash,
        result=ResponseResult,
        begun=begun,
        compute=compute,
        texts={"case.toml": to_toml(request.case)},
        size=table_bytes(points, request.observe * OF_A_PERIOD + portrait + OF_A_POINT),
    )
    return run_study(study, folder, **options)


def _require_planned(request: ResponseRequest, done: Sequence[Task], rows: Sequence[PointRow]) -> None:
    """Hold points against the tasks that they are said to be of; ValueError where they are of others."""
    drives = {task: request.case_at(task.number, task.model).motion for task in done}
    made = [
        Task(row.began if row.direction == "start" else row.direction, row.number, row.model) for row in rows
    ]
    if not done or [task for task in made if task.carries] != [task for task in done if task.carries]:
        raise ValueError("its points are others")
    for task, row in zip(made, rows, strict=True):
        drive = drives[task]
        if (row.frequency_Hz, row.amplitude_m) != (drive.angular_frequency / TURN, drive.amplitude):
            raise ValueError(f"its point {task.way} {task.number} has another drive")


def _follow(
    request: ResponseRequest, plan: Sequence[Task], results: ResultFolder, runner: Runner
) -> tuple[int, list[PointRecord]]:
    """How many tasks are done, and the points of all these, those already there included."""
    saved, records, done, reporter = results.read_arrays(STATE), [], 0, runner.reporter
    before = None
    containers = {model: discretise(request.case_at(0, model)) for model in {task.model for task in plan}}
    control = build_model(request.case, containers[request.case.solver.model]).run.problem.control
    if saved is not None:
        try:
            records, done = unpacked(saved), int(saved["done"])
            _require_planned(request, plan[:done], [record.row for record in records])
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            raise CheckpointError(results.path / STATE, f"is of no such response curve ({error})") from None
        last = plan[done - 1]
        if last.carries and records[-1].stands:
            before = driven_model(request.case_at(last.number, last.model), containers[last.model])
            parts = changing(before)
            require_same(results.path / STATE, saved, parts)
            for name, part in parts.items():
                part[...] = saved[name]
    periods = request.settle + request.observe
    runs = [request.starts if task.way == "random" else 1 for task in plan]
    spans = [
        n * periods / float(request.frequencies[task.number]) for n, task in zip(runs, plan, strict=True)
    ]
    seconds = sum(
        span * of_a_second(request.case_at(task.number, task.model))
        for span, task in zip(spans[done:], plan[done:], strict=True)
    )
    say_expected(reporter, f"{len(plan)} frequencies and starts", seconds)
    reporter.start(sum(spans))
    for task in plan[done:]:
        if runner.stop():
            break

        def progress(time: float, rotation: float, mode: int, behind: float = sum(spans[:done])) -> None:
            reporter.update(behind + time, abs(rotation) / control.slenderness_angle, MODES[mode])

        found, before = computed(request, containers[task.model], task, records, before, control, progress)
        records, done = records + found, done + 1
        carried = {} if before is None else changing(before)
        results.write_arrays(STATE, packed(records) | {"done": np.array(done)} | carried)
    reporter.finish()
    return done, records
