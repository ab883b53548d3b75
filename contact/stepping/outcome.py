"""A run to its end where only the outcome is wanted, as for maps: no history is kept, no Python runs within a slice.

Of the samples that a history would have, the stepper follows the largest acceleration and the sway of the contents.
The slip of the last cycle is kept, and the coordinates of the samples with the largest strain energy, from which
stresses can be computed.
"""

import math
from typing import NamedTuple

import numpy as np

from contact.arrays import FloatArray
from contact.jit import compiled
from contact.motion.kernel import UNIFORM, as_floor_motion, floor_motion
from contact.stepping.body import ROTATION
from contact.stepping.control import most_attempts
from contact.stepping.integrator import (
    AFTERMATH_SLICE,
    FAILED,
    OVERTURNED,
    REACHED,
    advance_compiled,
    enter_floor_frame_compiled,
)
from contact.stepping.modal_body import ModalBody, with_own_scratch
from contact.stepping.state import ROW_SLIP, ROW_STRAIN, RunState

SLICE, MOST_STRAINED = 0.25, 4  #: so many of the most strained samples are kept of each slice [s]


class KeptSamples(NamedTuple):
    """What is kept of the samples of a run with n_d coordinates."""

    slip_until: float  #: [s]
    slip: FloatArray  #: (n_k,) sample i up to `slip_until` is in column i modulo n_k [m]
    strain: FloatArray  #: (n_s,) strain energy of the most strained samples; -1 where there is none [J]
    position: FloatArray  #: (n_s, n_d or 0) their coordinates


class Outcome(NamedTuple):
    """Result of a run, besides its final state and records."""

    status: int  #: REACHED, OVERTURNED or FAILED (also at the limit of attempts)
    samples: KeptSamples


def run_to_end(
    body: ModalBody,
    run: RunState,
    duration: float,
    *,
    aftermath: float = 0.0,
    slip_until: float = 0.0,
    cycle: float = 0.0,
    strained: bool = False,
) -> Outcome:
    """Step a run from t = 0 to its end, in place; the result does not depend on other runs or threads.

    Args:
        body: its container, which runs may share: the scratch arrays are not touched.
        run: with samples at the interval of its history, if that has columns.
        duration: [s].
        aftermath: how long a container beyond its slenderness angle is followed afterwards on a resting floor [s].
        slip_until, cycle: the slip is kept of the last `cycle` before `slip_until` [s].
        strained: keep the most strained samples of every slice.
    """
    own = with_own_scratch(body)
    clock, samples = run.clock[0], run.history
    clock["attempt_limit"] = most_attempts(run.control, duration + aftermath)
    room = MOST_STRAINED * (math.ceil(duration / SLICE) + 2) if strained else 0
    coordinates = samples.position.shape[1] if strained else 0
    kept = KeptSamples(
        slip_until=float(slip_until),
        slip=np.zeros(math.ceil(cycle / samples.interval) + 2),
        strain=np.full(room, -1.0),
        position=np.zeros((room, coordinates)),
    )
    run = run._replace(
        history=samples._replace(
            position=samples.position[:, :coordinates], velocity=samples.velocity[:, :0]
        ),
        frames=run.frames._replace(interval=math.inf),
    )
    ahead = SLICE if strained else math.inf  # without slices the stepping returns where the samples are full
    status = advance_in_slices(own, run, kept, ahead, duration, False)
    if status == REACHED and is_undecided.py_func(run):
        displacement, velocity, _ = floor_motion(run.motion, clock["time"])
        enter_floor_frame_compiled(own, run, velocity)
        still = as_floor_motion(UNIFORM, (float(clock["time"]), displacement, 0.0))
        run = run._replace(motion=still, breaks=np.full(1, np.inf))
        status = advance_in_slices(own, run, kept, AFTERMATH_SLICE, duration + aftermath, True)
    if status == REACHED and run.track["overturned_at"][0] < np.inf:
        status = OVERTURNED
    return Outcome(status, kept)


@compiled
def is_undecided(run: RunState) -> bool:
    """The container is beyond its slenderness angle and has not overturned yet."""
    beyond = abs(run.old.pose[ROTATION]) > run.control.slenderness_angle
    return beyond and not run.track[0].overturned_at < np.inf


@compiled
def advance_in_slices(
    body: ModalBody, run: RunState, kept: KeptSamples, ahead: float, until: float, undecided_only: bool
) -> int:
    """Step to `until`, looking at the samples every `ahead` [s] or sooner; `undecided_only`: until it is decided."""
    clock = run.clock[0]
    while clock.time < until:
        status = advance_compiled(body, run, min(clock.time + ahead, until))
        if run.history.columns.shape[1] > 0:
            keep_slip(run, kept)
            keep_most_strained(run, kept)
        clock.samples_drained = clock.samples
        if status != REACHED or (undecided_only and not is_undecided(run)):
            return status
        if clock.time < until and clock.steps + clock.rejected >= clock.attempt_limit:
            return FAILED
    return REACHED


@compiled
def keep_slip(run: RunState, kept: KeptSamples) -> None:
    """Write the slip of the new samples into the ring."""
    clock, samples = run.clock[0], run.history
    for i in range(clock.samples - clock.samples_drained):
        index = clock.samples_drained + i
        if index * samples.interval <= kept.slip_until + 1e-9:
            kept.slip[index % kept.slip.size] = samples.columns[i, ROW_SLIP]


@compiled
def keep_most_strained(run: RunState, kept: KeptSamples) -> None:
    """Keep the most strained of the new samples, each in place of the least strained one kept."""
    clock, samples = run.clock[0], run.history
    count = clock.samples - clock.samples_drained
    for _ in range(min(count, MOST_STRAINED) if kept.strain.size > 0 else 0):
        best = 0
        for i in range(count):
            if samples.columns[i, ROW_STRAIN] > samples.columns[best, ROW_STRAIN]:
                best = i
        place = 0
        for i in range(kept.strain.size):
            if kept.strain[i] < kept.strain[place]:
                place = i
        if samples.columns[best, ROW_STRAIN] <= kept.strain[place]:
            return
        kept.strain[place] = samples.columns[best, ROW_STRAIN]
        for j in range(kept.position.shape[1]):
            kept.position[place, j] = samples.position[best, j]
        samples.columns[best, ROW_STRAIN] = -1.0  # taken
