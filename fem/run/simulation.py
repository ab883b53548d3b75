"""Stepping a model to its end, in slices: samples are taken, progress is reported and a request to stop is heard.

A slice is a fixed simulated time or a fixed number of attempted steps, so what is done between slices (samples, the
decision to continue) falls on the same instants on any machine. A slice of a large mesh may take minutes; it is
interrupted by pauses, which depend on the wall clock and in which nothing is decided: the state may be saved, and a
request to stop is heard.

`contact.stepping.outcome` says when a run is over: at its duration; after a pulse or a record as soon as the container
is at rest or has fallen; and a container that is beyond its slenderness angle at the end is followed in the frame of
its floor, which stands still from then on, until it has fallen or come back.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.motion.kernel import floor_motion
from contact.stepping.body import ROTATION
from contact.stepping.control import most_attempts
from contact.stepping.integrator import AFTERMATH_SLICE, FAILED, OVERTURNED, REACHED
from contact.stepping.links import LinkedBody
from contact.stepping.loose_stack import LooseStack
from contact.stepping.modal_body import ModalBody
from contact.stepping.outcome import DRIVEN, FREE, UNDECIDED, is_over, on_resting_floor, run_to_end
from contact.stepping.state import RunState
from fem.model.model import Model
from fem.model.recovery import Recovery
from fem.results.outcome import MODES
from fem.results.run_result import Verdict
from fem.run.recorder import Recorder
from fem.run.verdict import audit, end_of_drive, softer_contact, verdict_from
from fem.run.words import sentence
from fem.runtime.progress import Reporter
from fem.solid.elasticity import least_volume_ratio
from fem.solid.nodal_body import FullBody, FullStack, advance_body, leave_body_alone

#: length of a slice in simulated seconds
SLICE_REDUCED, SLICE_FULL = 1.0, 0.01
#: length of a slice in attempted steps
LOOK_REDUCED, LOOK_FULL = 100_000, 2000
#: wall time between pauses [s]; attempted steps until the first one; how many times more until the next, at most
PAUSE_S, FIRST_PAUSE, LONGER = 5.0, 16, 8
#: imbalance of the contact forces, over the weight, that is not the reason why a step fails
BALANCED = 1e-6
#: time in which a container left beyond its slenderness angle falls or comes back [1/p]
AFTERMATH = 50.0


@dataclass(frozen=True, kw_only=True)
class Progress:
    """State of a simulation, besides what its model and recorder hold."""

    stepping_cpu_s: float = 0.0
    #: time since which the floor stands still [s], and its place along x and upward [m]; None while it is driven
    undriven: tuple[float, float, float] | None = None
    #: of an unfinished slice: the time at its end [s], and the attempted steps at which it ends before that
    slice: tuple[float, int] | None = None


BEGINNING = Progress()


class Pace:
    """How many steps are attempted until the next pause, from the wall time that the last ones took."""

    def __init__(self) -> None:
        self.attempts = FIRST_PAUSE

    def note(self, attempts: int, wall_s: float) -> None:
        """Note the wall time that so many attempted steps took."""
        if attempts > 0:
            affordable = int(PAUSE_S * attempts / max(wall_s, 1e-9))
            self.attempts = max(1, min(affordable, LONGER * self.attempts, LOOK_REDUCED))


@dataclass(frozen=True, kw_only=True)
class SimulationEnd:
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
    save: Callable[[Progress, bool], None] | None = None,
    progress: Progress = BEGINNING,
    slice_s: float | None = None,
) -> SimulationEnd:
    """Step a model to its end; the recorder takes the samples.

    Args:
        model: from its present state on.
        stop: called in pauses and between slices; true ends the simulation there.
        save: called there, too, and may save the state; its second argument is true where the simulation ends
            unfinished.
        progress: of the simulation that is resumed.
        slice_s: length of a slice of a modal model [s]; default: `SLICE_REDUCED`. What fills the arrays of samples ends
            it, too.
    """
    reporter = reporter or Reporter()
    full = model.case.solver.model == "full"
    advance_body(model.body, model.run, 0.0)
    duration, control, run = model.duration, model.run.problem.control, model.run
    clock, track = run.clock[0], run.track[0]

    def ended(status: str, error: str | None = None) -> SimulationEnd:
        reporter.finish()
        if status != "interrupted":
            recorder.finish(run)
        return SimulationEnd(status=status, stepping_cpu_s=progress.stepping_cpu_s, error=error)

    if progress.undriven is not None:
        run = on_resting_floor(run, progress.undriven[0], progress.undriven[1:])
    reporter.start(duration, float(clock.time))
    pace = Pace()
    while True:
        part, until = _part_of(model)
        if progress.slice is None and (clock.time >= until or is_over.py_func(model.run, part)):
            break
        stopped = stop()
        if save is not None:
            save(progress, stopped)
        if stopped:
            return ended("interrupted")
        if progress.slice is None:
            usual = SLICE_FULL if full else slice_s or SLICE_REDUCED
            ahead = usual if part == DRIVEN else AFTERMATH_SLICE
            target = float(clock.next_look) if part == FREE else float(clock.time) + ahead
            if part == UNDECIDED and progress.undriven is None:
                # change to the frame of the floor, which stands still from now on
                since = float(clock.time)
                x, velocity_x, _ = floor_motion(run.problem.motion, since)
                z, velocity_z, _ = floor_motion(run.problem.vertical, since)
                leave_body_alone(model.body, run, velocity_x, velocity_z)
                recorder.change_frame((velocity_x, velocity_z))
                progress = replace(progress, undriven=(since, float(x), float(z)))
                run = on_resting_floor(run, since, (float(x), float(z)))
            most = _attempts(run) + (LOOK_FULL if full else LOOK_REDUCED)
            progress = replace(progress, slice=(min(target, until), most))
        assert progress.slice is not None  # for the type checker
        slice_end, most = progress.slice
        before = _attempts(run)
        clock.attempt_limit = pause = min(most, before + pace.attempts)
        began, wall = time.thread_time(), time.perf_counter()  # others may step in other threads
        code = advance_body(model.body, run, slice_end)
        pace.note(_attempts(run) - before, time.perf_counter() - wall)
        # Where the arrays of samples are full as well, the next call makes no step, and the slice ends then.
        pausing = code == REACHED and clock.time < slice_end and _attempts(run) == pause < most
        spent = progress.stepping_cpu_s + time.thread_time() - began
        progress = replace(progress, stepping_cpu_s=spent, slice=progress.slice if pausing else None)
        if not pausing:
            recorder.drain(run)
        ratio = abs(float(run.old.pose[ROTATION])) / control.slenderness_angle
        reporter.update(float(clock.time), ratio, MODES[int(track.mode)])
        if pausing:
            continue
        stuck = _attempts(run) >= most_attempts(control, float(clock.time))
        failure = _crushed(model) if full else None
        if failure is None and (code == FAILED or (stuck and code != OVERTURNED)):
            residual = float(np.abs(run.work.law - run.work.force).max())
            failure = stepping_failure(model, residual)
        if failure is not None:
            return ended("failed", failure)
        if code == OVERTURNED:
            break
    error = audit(model)
    if error is not None:
        return ended("failed", error)
    return ended("overturned" if np.isfinite(track.overturned_at) else "completed")


def _attempts(run: RunState) -> int:
    """Attempted steps so far, accepted and rejected."""
    return int(run.clock[0].steps + run.clock[0].rejected)


def _part_of(model: Model) -> tuple[int, float]:
    """The present part of the run, and when it ends at the latest [s]."""
    time, duration = float(model.run.clock[0].time), model.duration
    if time < min(duration, model.rest_from):
        return DRIVEN, min(duration, model.rest_from)
    if time < duration:
        return FREE, duration
    return UNDECIDED, duration + AFTERMATH / model.run.problem.control.slowest_rocking


def _crushed(model: Model) -> str | None:
    """The message of a full model with an inverted element, or None; what follows is no motion of a container."""
    clock, positions, body = model.run.clock[0], model.run.old.position.reshape(-1, 2), model.body
    bodies = body.boxes if isinstance(body, FullStack) else (body,) if isinstance(body, FullBody) else ()
    ratio, first = math.inf, 0
    for box in bodies:
        elements = box.elements
        displacement = positions[first : first + len(elements.nodes)] - elements.nodes
        ratio = min(ratio, least_volume_ratio(elements.displacement_gradient(displacement)))
        first += len(elements.nodes)
    if ratio > 0.0:  # false for nan
        return None
    return (
        f"step {int(clock.steps)}, t = {float(clock.time):.6g} s: the container is crushed, an element is "
        f"inverted (det F = {ratio:.2g}); take a larger container.youngs_modulus_Pa, thicker walls, "
        f'{softer_contact(model.case)}, or solver.model = "rigid"'
    )


def stepping_failure(model: Model, residual: float) -> str:
    """Where and why the stepping failed, and what to try; `residual` is that of the contact forces [N]."""
    control, clock = model.run.problem.control, model.run.clock[0]
    return sentence(
        "failure.txt.j2",
        time=float(clock.time),
        steps=int(clock.steps),
        rejected=int(clock.rejected),
        smallest=min(float(clock.smallest_step), control.largest_step),
        smallest_tried=control.smallest_step,
        stuck=_attempts(model.run) >= most_attempts(control, float(clock.time)),
        finite=math.isfinite(residual),
        balanced=residual <= BALANCED * control.mass * control.gravity,
        residual=residual,
        softer=softer_contact(model.case),
    )


def run_without_history(model: Model, recovery: Recovery | None) -> tuple[Verdict, str | None]:
    """Step a rigid or reduced model to its end, in place.

    Args:
        model: at t = 0.
        recovery: of the stresses of its container; None leaves them out.

    Returns:
        Its verdict, and why it failed, if it did: a verdict that does not count then.
    """
    assert isinstance(model.body, ModalBody | LooseStack | LinkedBody)
    run, duration, until = model.run, model.duration, end_of_drive(model)
    if model.case.output.stop_when_still:  # its samples and contents are not wanted
        history = run.buffers.history
        samples = history._replace(columns=history.columns[:, :0].copy())
        run = run._replace(buffers=run.buffers._replace(history=samples))
    if recovery is None:  # nobody looks at the steps that strain it most
        run = run._replace(strained=run.strained[:, :0].copy())
    status, slip = run_to_end(
        model.body,
        run,
        duration,
        rest_from=model.rest_from,
        aftermath=AFTERMATH / run.problem.control.slowest_rocking,
        slip_until=until,
        cycle=min(model.case.motion.period, duration),
    )
    interval = run.buffers.history.interval
    count = int(run.clock[0].samples)
    last = min(count - 1, int((until + 1e-9) / interval))
    numbers = np.arange(max(0, last + 1 - slip.size), last + 1)
    stress = None if recovery is None else recovery.largest_of_steps(run.strained)
    end = (count - 1) * interval if count else None
    verdict = verdict_from(model, end, numbers * interval, slip[numbers % slip.size], stress)
    if status == FAILED:
        return verdict, stepping_failure(model, float(np.abs(run.work.law - run.work.force).max()))
    return verdict, audit(model)
