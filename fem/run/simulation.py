"""Stepping a model to its end: in slices, so that samples are taken, progress is told and a stop is heard.

A slice is so much simulated time, or so many steps tried: what is done between slices (samples, the decision to go on)
falls on the same instants however fast the machine is. A slice of a large mesh may take minutes; so it is interrupted
by pauses, in which nothing is decided and the clock on the wall is looked at: a stop is heard, the state is kept.

A container that the end of a run finds beyond its slenderness angle has neither fallen nor come back: it is
followed in the frame of its floor, undriven and so at rest there, until it has done one or the other.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from contact.motion.kernel import UNIFORM, as_floor_motion, floor_motion
from contact.stepping.body import ROTATION
from contact.stepping.control import most_attempts
from contact.stepping.integrator import AFTERMATH_SLICE, FAILED, OVERTURNED, REACHED
from contact.stepping.state import Run
from fem.assessment.verdict import MODE_NAMES, audit, rotation_ratio
from fem.model.crushing import least_volume_ratio
from fem.model.model import Model
from fem.run.recorder import Recorder
from fem.runtime.progress import Reporter, SilentReporter
from fem.solid.nodal_body import FullBody, advance_body, leave_body_alone

#: how far the stepping goes before it looks up, in simulated seconds
SLICE_REDUCED, SLICE_FULL = 0.25, 0.01
#: .. and in steps tried
LOOK_REDUCED, LOOK_FULL = 100_000, 2000
#: wall time between pauses [s]; steps tried until the first one; how many times more until the next, at most
PAUSE_S, FIRST_PAUSE, LONGER = 5.0, 16, 8
#: imbalance of the contact forces, over the weight, that is not what keeps a step from being solved
BALANCED = 1e-6
#: a container left beyond its slenderness angle at the end falls or comes back within so many times 1/p
AFTERMATH = 50.0


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a simulation has come, besides what its model and recorder hold."""

    stepping_cpu_s: float = 0.0
    #: since when the floor is left at rest [s], and where it stands [m]; None while it is driven
    undriven: tuple[float, float] | None = None
    #: of a slice that is under way: the time it goes to [s], and the steps tried at which it ends before
    slice: tuple[float, int] | None = None


class Pace:
    """How many steps are tried until the next pause, by the wall time that the last ones took."""

    def __init__(self) -> None:
        self.attempts = FIRST_PAUSE

    def note(self, attempts: int, wall_s: float) -> None:
        """Take in what so many steps tried took."""
        if attempts > 0:
            affordable = int(PAUSE_S * attempts / max(wall_s, 1e-9))
            self.attempts = max(1, min(affordable, LONGER * self.attempts, LOOK_REDUCED))


class Keeper(Protocol):
    """Somebody who may want to keep the state of a simulation."""

    def keep(self, progress: Progress, *, at_once: bool = False) -> None:
        """Called in pauses and between slices; `at_once`: the simulation ends here, unfinished."""


class NoKeeper:
    """Keeps nothing."""

    def keep(self, progress: Progress, *, at_once: bool = False) -> None:
        """Nothing."""


@dataclass(frozen=True, kw_only=True)
class Ending:
    """How the stepping ended."""

    status: str  #: completed | overturned | failed | interrupted
    stepping_cpu_s: float
    error: str | None = None


def simulate(
    model: Model,
    recorder: Recorder,
    *,
    reporter: Reporter | None = None,
    stop: Callable[[], bool] = lambda: False,
    keeper: Keeper | None = None,
    progress: Progress | None = None,
) -> Ending:
    """Step a model to its end; the recorder takes the samples.

    A container that the end finds beyond its slenderness angle is followed in the frame of its floor, which
    stands still there, until it falls or has come back.

    Args:
        model: from its present state on; recorder: of its samples.
        reporter: told how far it is.
        stop: asked between slices; true ends the simulation there.
        keeper: may keep the state there, to go on from.
        progress: of the simulation to go on with; its first slice is the one that came next then.
    """
    reporter, keeper, progress = reporter or SilentReporter(), keeper or NoKeeper(), progress or Progress()
    full = isinstance(model.body, FullBody)
    advance_body(model.body, model.run, 0.0)
    duration, control, run = model.case.solver.duration_s, model.run.control, model.run
    clock, track = run.clock[0], run.track[0]
    if progress.undriven is not None:
        run = _on_resting_floor(run, progress.undriven)
    reporter.start(duration, float(clock.time))
    pace = Pace()
    while progress.slice is not None or _goes_on(model):
        stopped = stop()
        keeper.keep(progress, at_once=stopped)
        if stopped:
            reporter.finish()
            return Ending(status="interrupted", stepping_cpu_s=progress.stepping_cpu_s)
        if progress.slice is None:
            until, ahead = duration, SLICE_FULL if full else SLICE_REDUCED
            if clock.time >= duration:
                until, ahead = _end_of_aftermath(model), AFTERMATH_SLICE
                if progress.undriven is None:
                    undriven = _leave_alone(model, run, recorder)
                    progress, run = replace(progress, undriven=undriven), _on_resting_floor(run, undriven)
            most = _attempts(run) + (LOOK_FULL if full else LOOK_REDUCED)
            progress = replace(progress, slice=(min(float(clock.time) + ahead, until), most))
        code, progress = _advance(model, run, progress, pace)
        if progress.slice is None:
            recorder.drain(run)
        ratio = rotation_ratio(float(run.old.pose[ROTATION]), control.slenderness_angle)
        reporter.update(float(clock.time), ratio, MODE_NAMES[int(track.mode)])
        if progress.slice is not None:
            continue
        stuck = _attempts(run) >= most_attempts(control, float(clock.time))
        failure = crushing_failure(model)
        if failure is None and (code == FAILED or (stuck and code != OVERTURNED)):
            residual = float(np.abs(run.work.law - run.work.force).max())
            failure = stepping_failure(model, residual)
        if failure is not None:
            reporter.finish()
            return Ending(status="failed", stepping_cpu_s=progress.stepping_cpu_s, error=failure)
        if code == OVERTURNED:
            break
    reporter.finish()
    error = audit(model)
    if error is not None:
        return Ending(status="failed", stepping_cpu_s=progress.stepping_cpu_s, error=error)
    status = "overturned" if np.isfinite(track.overturned_at) else "completed"
    return Ending(status=status, stepping_cpu_s=progress.stepping_cpu_s)


def _advance(model: Model, run: Run, progress: Progress, pace: Pace) -> tuple[int, Progress]:
    """Step to the end of the slice or to the next pause; returns the code of `advance`, and how far it has come."""
    assert progress.slice is not None  # for the type checker
    until, most = progress.slice
    clock, before = run.clock[0], _attempts(run)
    pause = min(most, before + pace.attempts)
    clock.attempt_limit = pause
    began, wall = time.thread_time(), time.perf_counter()  # others may step in other threads
    code = advance_body(model.body, run, until)
    pace.note(_attempts(run) - before, time.perf_counter() - wall)
    # Where the arrays of samples are full as well, the next call makes no step, and the slice ends then.
    pausing = code == REACHED and clock.time < until and _attempts(run) == pause < most
    return code, replace(
        progress,
        stepping_cpu_s=progress.stepping_cpu_s + time.thread_time() - began,
        slice=progress.slice if pausing else None,
    )


def _attempts(run: Run) -> int:
    """Steps tried so far, accepted and rejected."""
    return int(run.clock[0].steps + run.clock[0].rejected)


def _goes_on(model: Model) -> bool:
    """Whether there is time left, or the end of it finds the container neither fallen nor come back."""
    clock, run = model.run.clock[0], model.run
    if clock.time < model.case.solver.duration_s:
        return True
    beyond = abs(float(run.old.pose[ROTATION])) > run.control.slenderness_angle
    undecided = beyond and not np.isfinite(run.track[0].overturned_at)
    return undecided and clock.time < _end_of_aftermath(model)


def _end_of_aftermath(model: Model) -> float:
    """When a container left alone is given up [s]."""
    return model.case.solver.duration_s + AFTERMATH / model.run.control.frequency_parameter


def _leave_alone(model: Model, run: Run, recorder: Recorder) -> tuple[float, float]:
    """Go over to the frame of the floor, which is driven no more; returns since when [s] and where it stands [m]."""
    since = float(run.clock[0].time)
    displacement, velocity, _ = floor_motion(run.motion, since)
    leave_body_alone(model.body, run, velocity)
    recorder.go_over_to_frame(velocity)
    return since, float(displacement)


def _on_resting_floor(run: Run, undriven: tuple[float, float]) -> Run:
    """The run on a floor that stands still since then and there."""
    still = as_floor_motion(UNIFORM, (*undriven, 0.0))
    return run._replace(motion=still, breaks=np.full(1, np.inf))


def crushing_failure(model: Model) -> str | None:
    """Where a cell of a full model lies inside out, or None: what comes after that is no motion of a container."""
    if not isinstance(model.body, FullBody):
        return None
    elements, clock = model.container.elements, model.run.clock[0]
    displacement = model.run.old.position.reshape(-1, 2) - elements.nodes
    ratio = least_volume_ratio(elements.displacement_gradient(displacement))
    if ratio > 0.0:  # false for nan
        return None
    return (
        f"step {int(clock.steps)}, t = {float(clock.time):.6g} s: the container is crushed, a cell of its mesh lies "
        f"inside out ({ratio:.2g} of its volume is left); take a larger container.youngs_modulus_Pa, thicker walls, "
        'a softer contact.normal_penalty_Pa_m, or solver.model = "rigid"'
    )


def stepping_failure(model: Model, residual: float) -> str:
    """Where and why the stepping gave up, and what to try; `residual` is that of the contact forces [N]."""
    control, clock = model.run.control, model.run.clock[0]
    if clock.steps + clock.rejected >= most_attempts(control, float(clock.time)):
        smallest = min(float(clock.smallest_step), control.largest_step)
        return (
            f"t = {float(clock.time):.6g} s: no headway after {int(clock.steps)} steps and {int(clock.rejected)} "
            f"rejected ones, the smallest of {smallest:.1g} s; try a softer "
            "contact.normal_penalty_Pa_m, contact.weakening_m > 0, or a larger solver.energy_tolerance"
        )
    place = f"step {int(clock.steps) + 1}, t = {float(clock.time):.6g} s: "
    smallest_tried = f"at the smallest step ({control.smallest_step:.1g} s)"
    if not math.isfinite(residual):
        return (
            f"{place}the motion tried grew beyond all numbers, even {smallest_tried}; try a smaller solver.step_s, "
            "a larger container.youngs_modulus_Pa, or a weaker motion"
        )
    if residual <= BALANCED * control.mass * control.gravity:
        return (
            f"{place}the iteration between container and floor did not settle {smallest_tried}, though the contact "
            f"forces balance within {residual:.2g} N; try a smaller solver.step_s, a larger "
            "container.youngs_modulus_Pa, or a softer contact.normal_penalty_Pa_m"
        )
    return (
        f"{place}the contact forces are out of balance by {residual:.2g} N after the last iteration {smallest_tried}; "
        "try a softer contact.normal_penalty_Pa_m, contact.weakening_m > 0, or a smaller solver.step_s"
    )
