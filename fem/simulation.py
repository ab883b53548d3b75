"""Stepping a model to its end: in slices, so that samples are taken, progress is told and a stop is heard.

A container that the end of a run finds beyond its slenderness angle has neither fallen nor come back: it is
followed in the frame of its floor, undriven and so at rest there, until it has done one or the other.
"""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.body import ROTATION
from contact.compiled import is_compiled
from contact.floor_motion import UNIFORM, as_floor_motion, floor_motion
from contact.stepping import (
    AFTERMATH_SLICE,
    FAILED,
    OVERTURNED,
    Run,
    advance,
    advance_compiled,
    leave_alone,
    leave_alone_compiled,
)
from fem.full_body import FullBody
from fem.model import Model
from fem.progress import Reporter, SilentReporter
from fem.recorder import Recorder
from fem.verdict import MODE_NAMES, audit

#: how far the stepping goes before it looks up, in simulated seconds
SLICE_REDUCED, SLICE_FULL = 0.25, 0.01
#: a container left beyond its slenderness angle at the end falls or comes back within so many times 1/p
AFTERMATH = 50.0


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
) -> Ending:
    """Step a model to its end; the recorder takes the samples.

    A container that the end finds beyond its slenderness angle is followed in the frame of its floor, which
    stands still there, until it falls or has come back.
    """
    reporter = reporter or SilentReporter()
    full = isinstance(model.body, FullBody)
    step: Any = advance if full else advance_compiled
    if not full:
        if not is_compiled("advance"):
            reporter.message("compiling the stepping kernels, once after installation: about half a minute")
        advance_compiled(model.body, model.run, 0.0)
    duration, control = model.case.solver.duration_s, model.run.control
    angle = control.slenderness_angle
    reporter.start(duration)
    cpu, run, until = 0.0, model.run, duration
    clock, track = run.clock[0], run.track[0]
    status, ahead = "completed", SLICE_FULL if full else SLICE_REDUCED
    while clock.time < until:
        began = time.process_time()
        code = step(model.body, run, min(clock.time + ahead, until))
        cpu += time.process_time() - began
        recorder.drain(run)
        rotation = abs(float(run.old.pose[ROTATION]))
        reporter.update(float(clock.time), rotation / angle, MODE_NAMES[int(track.mode)])
        if code == FAILED:
            reporter.finish()
            return Ending(status="failed", stepping_cpu_s=cpu, error=_failure(model))
        if code == OVERTURNED:
            status = "overturned"
            break
        if stop():
            reporter.finish()
            return Ending(status="interrupted", stepping_cpu_s=cpu)
        if clock.time >= duration:
            undecided = angle < rotation and not np.isfinite(track.overturned_at)
            if not undecided:
                break
            if until == duration:
                run = _left_alone(model, run, recorder)
                until = duration + AFTERMATH / control.frequency_parameter
                ahead = AFTERMATH_SLICE
    if np.isfinite(track.overturned_at):
        status = "overturned"
    reporter.finish()
    error = audit(model)
    if error is not None:
        return Ending(status="failed", stepping_cpu_s=cpu, error=error)
    return Ending(status=status, stepping_cpu_s=cpu)


def cores() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)


def _left_alone(model: Model, run: Run, recorder: Recorder) -> Run:
    """The run in the frame of its floor, which from now on stands still."""
    clock = run.clock[0]
    displacement, velocity, _ = floor_motion(run.motion, float(clock.time))
    leave = leave_alone if isinstance(model.body, FullBody) else leave_alone_compiled
    leave(model.body, run, velocity)
    recorder.go_over_to_frame(velocity)
    still = as_floor_motion(UNIFORM, (float(clock.time), displacement, 0.0))
    return run._replace(motion=still, breaks=np.full(1, np.inf))


def _failure(model: Model) -> str:
    """Where and why the stepping gave up, and what to try."""
    clock, work = model.run.clock[0], model.run.work
    residual = float(np.abs(work.law - work.force).max())
    step = model.run.control.smallest_step
    return (
        f"step {int(clock.steps) + 1}, t = {float(clock.time):.6g} s: the contact forces are out of balance "
        f"by {residual:.2g} N after the last iteration at the smallest step ({step:.1g} s); try a softer "
        "contact.normal_penalty_Pa_m, contact.weakening_m > 0, or a smaller solver.step_s"
    )
