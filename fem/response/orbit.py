"""The motion, period by period: a section at the end of each, and the extremes within it.

The stepping ends a step at each section, the floor's turning point at +A.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.motion.kernel import floor_motion
from contact.stepping.body import ANGULAR_VELOCITY, ROTATION, VELOCITY_X
from contact.stepping.integrator import FAILED, OVERTURNED, REACHED
from contact.stepping.outcome import advance_compiled
from contact.stepping.state import ROW_ANGULAR_VELOCITY, ROW_ROTATION, ROW_SLIP
from fem.response.model import DrivenModel, with_sections
from fem.run.verdict import audit, softer_contact
from fem.runtime.arrays import FloatArray

#: called with the time [s], the rotation [rad] and the mode
Progress = Callable[[float, float, int], None]

#: periods after which the energy balance is checked as that of a run
AUDITED = 10
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


def no_progress(time: float, rotation: float, mode: int) -> None:
    """A `Progress` that ignores it."""


def follow_periods(
    driven: DrivenModel, count: int, *, portrayed: int = 0, progress: Progress = no_progress
) -> tuple[DrivenModel, Orbit]:
    """Step through `count` periods from a section.

    Args:
        driven: at a section, which is its t = 0.
        count: periods.
        portrayed: of how many last periods the phase portrait is kept.
        progress: called after each period.

    Returns:
        The model at the end, and its motion; fewer periods where it overturned or failed.
    """
    driven = with_sections(driven, count)
    run, track, clock = driven.run, driven.run.track[0], driven.run.clock[0]
    sections, extremes, portraits = [], [], []
    code, slipped, reason = REACHED, float(driven.run.joints[0].slip), None
    before = slipped
    _open_ledger(driven)
    for k, end in enumerate(driven.period * np.arange(1, count + 1)):
        impacts = int(track.impacts)
        track.max_rotation, track.max_rocking = 0.0, 0.0
        code, samples = _step_to(driven, end)
        if code != REACHED:
            break
        _, floor_velocity, _ = floor_motion(run.problem.motion, end)
        pose, slip = run.old.pose, float(driven.run.joints[0].slip)
        rotation = np.append(samples[:, ROW_ROTATION], pose[ROTATION])
        sliding = np.append(samples[:, ROW_SLIP], slip)
        sections.append(
            [pose[ROTATION], pose[ANGULAR_VELOCITY], pose[VELOCITY_X] - floor_velocity, slip - slipped]
        )
        extremes.append(
            [
                float(track.max_rotation),
                rotation.min(),
                rotation.max(),
                float(track.max_rocking),
                np.ptp(sliding),
                int(track.impacts) - impacts,
                float(np.abs(sliding - before).max()),
            ]
        )
        slipped = slip
        if k >= count - portrayed:
            portraits.append(samples[:, [ROW_ROTATION, ROW_ANGULAR_VELOCITY]])
        progress(float(clock.time), float(pose[ROTATION]), int(track.mode))
        if k % AUDITED == AUDITED - 1:
            reason = audit(driven.model)
            if reason is not None:
                break
            _open_ledger(driven)
    status = STATUSES[code]
    if code == FAILED:
        reason = (
            f"after {clock.time / driven.period:.6g} periods: the contact forces do not converge at the smallest "
            f"step ({run.problem.control.smallest_step:.1g} s); try {softer_contact(driven.model.case)}, "
            "contact.weakening_m > 0, or a smaller solver.step_s"
        )
    else:
        reason = reason or audit(driven.model)
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


def step_until(driven: DrivenModel, end: float) -> str:
    """Step to an instant [s] that is a break of the run, or to the fall; returns the status."""
    code, _ = _step_to(driven, end)
    return STATUSES[code]


def _open_ledger(driven: DrivenModel) -> None:
    """Reset the energy balance."""
    driven.run.ledger[:] = 0.0
    for name in ("least_imbalance", "most_imbalance", "dissipated"):
        driven.run.clock[name] = 0.0


def _step_to(driven: DrivenModel, end: float) -> tuple[int, FloatArray]:
    """Step to an instant; returns the code of the stepping and the samples on the way."""
    run, clock = driven.run, driven.run.clock[0]
    drained = []
    while True:
        code = advance_compiled(driven.body, run, end)
        count = int(clock.samples - clock.samples_drained)
        drained.append(run.buffers.history.columns[:count].copy())
        clock.samples_drained = clock.samples
        if code != REACHED or clock.time >= end or math.isinf(end):
            return code, np.concatenate(drained)
