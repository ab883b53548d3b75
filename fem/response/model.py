"""A container on a harmonic floor whose frequency is changed while it moves, at a turning point of the floor.

A level floor is the same everywhere: every motion is x = A cos(Omega t) from t = 0, and the container is moved along x
in place of the mean position of the floor.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.motion.kernel import HARMONIC, UNIFORM, FloorMotion, as_floor_motion, floor_motion
from contact.stepping.body import CENTRE_X, CENTRE_Z
from contact.stepping.control import step_level, step_of_level
from contact.stepping.modal_body import ModalBody
from contact.stepping.state import Buffers, RunState, make_samples
from fem.case.case import Case
from fem.model.container import Container
from fem.model.model import Model, build_model
from fem.response.request import SAMPLES_PER_PERIOD

#: state of the step control that is carried from one motion to the next
CARRIED = ("allowance_used", "recent_dissipation", "growth_hold", "lag_step")


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenModel:
    """A model on a driven floor, at t = 0."""

    model: Model  #: its `run` is the one below
    body: ModalBody
    run: RunState
    period: float  #: of the drive [s]


def begin_drive(case: Case, container: Container) -> tuple[DrivenModel, float]:
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
    return _on_floor(model, floor, np.array([ramp, until]), period), until


def driven_model(case: Case, container: Container) -> DrivenModel:
    """The container on x = A cos(Omega t), without the motion that it has."""
    model = build_model(case, container)
    omega = case.motion.angular_frequency
    floor = as_floor_motion(HARMONIC, (case.motion.amplitude, omega, 0.5 * math.pi, 0.0, math.inf))
    return _on_floor(model, floor, np.empty(0), 2.0 * math.pi / omega)


def carry_drive(case: Case, container: Container, before: DrivenModel) -> DrivenModel:
    """The container, moving as `before` left it at a turning point of its floor, on x = A cos(Omega t).

    The motion is carried, the damage is not: the floor is whole again.
    """
    driven = driven_model(case, container)
    _carry_state(before.run, driven.run)
    _mend_floor(driven.run)
    return driven


def stop_drive(case: Case, container: Container, before: DrivenModel) -> DrivenModel:
    """The container, moving as `before` left it at a turning point of its floor; the floor stays there."""
    floor = as_floor_motion(UNIFORM, (0.0, case.motion.amplitude, 0.0))
    driven = _on_floor(build_model(case, container), floor, np.empty(0), before.period)
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


def _mend_floor(run: RunState) -> None:
    """Raise the container by its deepest indentation: there it bears as before, a corner less deep is off the floor."""
    state, control = run.old, run.problem.control
    raised = float(state.crushed[: control.base_points].max())
    if raised == 0.0:
        return
    state.point[:, 1] += raised - state.crushed
    state.crushed[:] = 0.0
    state.position[1] += raised
    state.pose[CENTRE_Z] += raised
    state.corner[:, 1] += raised
    state.monitor[:, 1] += raised
    state.energy[2] += control.mass * control.gravity * raised
    state.force[state.point[:, 1] > 0.0] = 0.0


def with_sections(driven: DrivenModel, count: int) -> DrivenModel:
    """The same at t = 0 again, with steps that end on each of the next `count` sections.

    It is at a section, so a whole number of periods is subtracted from its time: the phase of the drive is as exact in
    the last period as in the first.
    """
    clock = driven.run.clock
    clock.time, clock.samples, clock.samples_drained, clock.next_break = 0.0, 0, 0, 0
    breaks = np.append(driven.period * np.arange(1, count + 1), np.inf)
    return replace(driven, run=driven.run.with_problem(breaks=breaks))


def _on_floor(model: Model, floor: FloorMotion, breaks: np.ndarray, period: float) -> DrivenModel:
    body, run = model.body, model.run
    if not isinstance(body, ModalBody):
        raise TypeError("a response curve is followed with the compiled models")  # the request excludes it
    points = run.old.point.shape[0]
    motion = floor_motion(floor, 0.0)
    run.floor[:] = motion
    run = run.with_problem(motion=floor, breaks=np.append(breaks[breaks > 0.0], np.inf))
    history = make_samples(period / SAMPLES_PER_PERIOD, 4 * SAMPLES_PER_PERIOD, points, columns=True)
    run = run._replace(buffers=Buffers(history=history, frames=make_samples(math.inf, 4, points)))
    return DrivenModel(model=replace(model, run=run), body=body, run=run, period=period)
