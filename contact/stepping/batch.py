"""Many runs of one container in one call: for maps, where only outcomes are wanted.

The container (points, modes, masses) is shared; floor, motion, friction, initial state and control differ from row
to row. Each row starts from its own initial state on scratch arrays of its thread, so that a row's result is the same
bytes whatever the number of threads and whichever rows run beside it. There is no Python object within a step.

No history is kept. Where samples are asked for, as many as a history would have, the largest acceleration and the
sway of the contents are followed in them; the slip of the last cycle is kept, and the coordinates of the most
strained samples, for whoever wants their stresses.
"""

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np

from contact.arrays import FloatArray, IntArray
from contact.interface.solver import Contact, Workspace, make_workspace
from contact.jit import compiled
from contact.motion.kernel import UNIFORM, FloorMotion, floor_motion
from contact.stepping.body import ROTATION, State, make_state
from contact.stepping.control import most_attempts
from contact.stepping.integrator import (
    AFTERMATH_SLICE,
    FAILED,
    OVERTURNED,
    REACHED,
    advance_compiled,
    leave_alone,
)
from contact.stepping.ledger import ROWS as LEDGER_ROWS
from contact.stepping.modal_body import ModalBody, with_own_scratch
from contact.stepping.observables import TRACK
from contact.stepping.scheme import Scheme
from contact.stepping.state import CLOCK, ROW_SLIP, ROW_STRAIN, Control, Run, Samples, make_samples
from contact.stepping.step import copy_vector

CONTACT_NUMBERS = tuple(
    name for name in Contact._fields if name not in ("normal_stiffness", "tangential_stiffness")
)
ROWS_AT_A_TIME = 8  #: handed to a thread: small enough to share the work evenly and to report progress
MOST_STRAINED = 4  #: samples kept of each slice between two looks at them


class Rows(NamedTuple):
    """Inputs of k runs of one container with n contact points and n_d coordinates."""

    normal_stiffness: FloatArray  #: (k, n)
    tangential_stiffness: FloatArray  #: (k, n)
    contact: FloatArray  #: (k, 8) the other numbers of `Contact`
    control: FloatArray  #: (k, 21) numbers of `Control`
    motion_kind: IntArray  #: (k,)
    motion_parameters: FloatArray  #: (k, ..) padded
    motion_breaks: FloatArray  #: (k, ..) padded with infinity
    motion_coefficients: FloatArray  #: (k, .., 4) padded
    breaks: FloatArray  #: (k, ..) instants that a step must end on, padded with infinity
    duration: FloatArray  #: (k,) [s]
    aftermath: (
        FloatArray  #: (k,) how long a container beyond its slenderness angle is followed afterwards [s]
    )
    attempt_limit: IntArray  #: (k,) steps that may be tried
    state: FloatArray  #: (k, ..) `State.numbers` at t = 0
    interval: FloatArray  #: (k,) of the samples; infinite for none [s]
    slip_until: FloatArray  #: (k,) the slip is kept of the samples up to this time [s]


class Outcomes(NamedTuple):
    """Results of k runs."""

    status: IntArray  #: (k,) REACHED, OVERTURNED or FAILED (a stuck one too: its clock stands at its limit)
    track: Any  #: (k,) of tracking.TRACK
    clock: Any  #: (k,) of run.CLOCK
    ledger: FloatArray  #: (k, 5) [J]
    rotation: FloatArray  #: (k,) at the end [rad]
    residual: FloatArray  #: (k,) of the contact forces in the last iteration [N]
    slip: FloatArray  #: (k, n_k) sample i up to `slip_until` stands in column i modulo n_k [m]
    strain: FloatArray  #: (k, n_s) strain energy of the most strained samples; -1 where there is none [J]
    strained: FloatArray  #: (k, n_s, n_d) their coordinates


class Sampling(NamedTuple):
    """What of the samples is kept."""

    cycle: float = 0.0  #: the slip of so long before `slip_until` [s]
    strained: bool = False  #: the most strained samples of every slice
    slice: float = 0.25  #: the stepping goes so far before it looks at its samples [s]
    room: int = 1024  #: samples held at a time, at the least


class Scratch(NamedTuple):
    """What one thread works on."""

    body: ModalBody
    old: State
    new: State
    work: Workspace
    slip: FloatArray
    floor: FloatArray
    change: FloatArray
    watched: FloatArray
    uniform: FloatArray  #: (3,) parameters of the floor left alone
    never: FloatArray  #: (1,) infinite
    history: Samples
    frames: Samples


def pack_rows(
    runs: Sequence[Run],
    durations: Sequence[float],
    aftermaths: Sequence[float],
    *,
    slip_until: Sequence[float] | None = None,
) -> Rows:
    """Rows from runs at t = 0 that share one body (see `contact.stepping.state.make_run`).

    With `slip_until` the rows have samples, at the intervals of the runs' histories.
    """
    motions = [run.motion for run in runs]

    return Rows(
        normal_stiffness=np.stack([run.contact.normal_stiffness for run in runs]),
        tangential_stiffness=np.stack([run.contact.tangential_stiffness for run in runs]),
        contact=np.array(
            [[getattr(run.contact, name) for name in CONTACT_NUMBERS] for run in runs], dtype=float
        ),
        control=np.array([tuple(run.control) for run in runs], dtype=float),
        motion_kind=np.array([motion.kind for motion in motions], dtype=np.int64),
        motion_parameters=_padded([motion.parameters for motion in motions], 0.0),
        motion_breaks=_padded([motion.breaks for motion in motions], np.inf),
        motion_coefficients=_padded([motion.coefficients for motion in motions], 0.0),
        breaks=_padded([run.breaks for run in runs], np.inf),
        duration=np.array(durations, dtype=float),
        aftermath=np.array(aftermaths, dtype=float),
        attempt_limit=np.array(
            [
                most_attempts(run.control, duration + aftermath)
                for run, duration, aftermath in zip(runs, durations, aftermaths, strict=True)
            ],
            dtype=np.int64,
        ),
        state=np.stack([run.old.numbers for run in runs]),
        interval=np.array([np.inf if slip_until is None else run.history.interval for run in runs]),
        slip_until=np.array(np.zeros(len(runs)) if slip_until is None else slip_until, dtype=float),
    )


def run_rows(
    body: ModalBody,
    scheme: Scheme,
    rows: Rows,
    tracks: Any,
    *,
    threads: int = 1,
    sampling: Sampling | None = None,
) -> Outcomes:
    """Step every row to its end.

    Args:
        body: the shared container; its scratch arrays are not touched.
        scheme: of the time stepping, shared.
        rows: the inputs.
        tracks: records (k,) of TRACK as the runs have them at t = 0; copied.
        threads: to share the rows among; it does not change a bit of the results.
        sampling: what is kept of the samples; None follows none.
    """
    count = rows.duration.size
    kept = sampling or Sampling()
    cycle = 1 if sampling is None else math.ceil(kept.cycle / float(rows.interval.min())) + 2
    room = 0
    if sampling is not None and kept.strained:
        room = MOST_STRAINED * (math.ceil(float(rows.duration.max()) / kept.slice) + 2)
    outcomes = Outcomes(
        status=np.zeros(count, dtype=np.int64),
        track=np.array(tracks).view(np.recarray),
        clock=np.zeros(count, CLOCK).view(np.recarray),
        ledger=np.zeros((count, LEDGER_ROWS)),
        rotation=np.zeros(count),
        residual=np.zeros(count),
        slip=np.zeros((count, cycle)),
        strain=np.full((count, room), -1.0),
        strained=np.zeros((count, room, 3 + body.stiffness.size)),
    )
    outcomes.clock["smallest_step"] = np.inf
    outcomes.clock["attempt_limit"] = rows.attempt_limit
    firsts = range(0, count, ROWS_AT_A_TIME)

    def work(thread: int) -> None:
        scratch = _make_scratch(body, rows, None if sampling is None else kept)
        ahead = math.inf if sampling is None else kept.slice
        for first in firsts[thread::threads]:
            last = min(first + ROWS_AT_A_TIME, count)
            advance_rows(scheme, rows, scratch, outcomes, ahead, first, last)

    if threads <= 1:
        work(0)
    else:
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(work, range(threads)))
    return outcomes


def _make_scratch(body: ModalBody, rows: Rows, sampling: Sampling | None) -> Scratch:
    points, coordinates = body.point.shape[0], 3 + body.stiffness.size
    own = with_own_scratch(body)
    history = make_samples(math.inf, 4, points)
    if sampling is not None:
        own = own._replace(monitor=body.monitor, monitor_shape=body.monitor_shape)
        in_two_steps = 2 * math.ceil(float(rows.control[:, 0].max() / rows.interval.min())) + 4
        history = make_samples(
            math.inf,
            max(sampling.room, in_two_steps),
            points,
            columns=True,
            position=coordinates if sampling.strained else 0,
        )
    monitors = own.monitor.shape[0]
    return Scratch(
        body=own,
        old=make_state(coordinates, points, monitors),
        new=make_state(coordinates, points, monitors),
        work=make_workspace(points),
        slip=np.zeros(points),
        floor=np.zeros((2, 3)),
        change=np.zeros(LEDGER_ROWS),
        watched=np.zeros((monitors, 2)),
        uniform=np.zeros(3),
        never=np.full(1, np.inf),
        history=history,
        frames=make_samples(math.inf, 4, points),
    )


def _padded(arrays: Sequence[FloatArray], value: float) -> FloatArray:
    """Stack arrays whose first axis differs in length, filling up with `value`."""
    longest = max(len(array) for array in arrays)
    out = np.full((len(arrays), longest, *arrays[0].shape[1:]), value)
    for row, array in zip(out, arrays, strict=True):
        row[: len(array)] = array
    return out


@compiled
def load_row(rows: Rows, k: int, scratch: Scratch) -> None:
    """Put the initial state of a row where its thread works, and forget the row before."""
    work, body = scratch.work, scratch.body
    copy_vector(scratch.old.numbers, rows.state[k])
    for i in range(scratch.watched.shape[0]):
        scratch.watched[i, 0], scratch.watched[i, 1] = 0.0, 0.0
    work.factored_step[0] = -1.0
    for slot in range(body.cached_step.size - 1):
        body.cached_step[slot] = -1.0
    body.cached_step[body.cached_step.size - 1] = 0.0


@compiled
def keep_slip(run: Run, until: float, kept: FloatArray) -> None:
    """Enter the slip of the new samples up to a time into a ring (n_k,)."""
    clock, samples = run.clock[0], run.history
    for i in range(clock.samples - clock.samples_gone):
        index = clock.samples_gone + i
        if index * samples.interval <= until + 1e-9:
            kept[index % kept.size] = samples.columns[i, ROW_SLIP]


@compiled
def keep_most_strained(run: Run, strain: FloatArray, strained: FloatArray) -> None:
    """Keep the most strained of the new samples: (n_s,) and (n_s, n_d), the least strained makes room."""
    clock, samples = run.clock[0], run.history
    count = clock.samples - clock.samples_gone
    for _ in range(min(count, MOST_STRAINED)):
        best = 0
        for i in range(count):
            if samples.columns[i, ROW_STRAIN] > samples.columns[best, ROW_STRAIN]:
                best = i
        place = 0
        for i in range(strain.size):
            if strain[i] < strain[place]:
                place = i
        if samples.columns[best, ROW_STRAIN] <= strain[place]:
            return
        strain[place] = samples.columns[best, ROW_STRAIN]
        for j in range(strained.shape[1]):
            strained[place, j] = samples.position[best, j]
        samples.columns[best, ROW_STRAIN] = -1.0  # taken


@compiled
def advance_in_slices(
    body: ModalBody, run: Run, rows: Rows, out: Outcomes, k: int, ahead: float, until: float
) -> int:
    """Step row k to `until`, looking at its samples every `ahead` [s]."""
    clock = run.clock[0]
    while clock.time < until:
        status = advance_compiled(body, run, min(clock.time + ahead, until))
        if run.history.columns.shape[1] > 0:
            keep_slip(run, rows.slip_until[k], out.slip[k])
            if out.strain.shape[1] > 0:
                keep_most_strained(run, out.strain[k], out.strained[k])
            clock.samples_gone = clock.samples
        if status != REACHED:
            return status
        if clock.time < until and clock.steps + clock.rejected >= clock.attempt_limit:
            return FAILED
    return REACHED


@compiled
def advance_rows(
    scheme: Scheme, rows: Rows, scratch: Scratch, out: Outcomes, ahead: float, first: int, last: int
) -> None:
    """Step the rows first .. last - 1 one after the other."""
    for k in range(first, last):
        load_row(rows, k, scratch)
        a, b = rows.contact[k], rows.control[k]
        contact = Contact(
            normal_stiffness=rows.normal_stiffness[k],
            tangential_stiffness=rows.tangential_stiffness[k],
            relaxation_time=a[0],
            mu_static=a[1],
            mu_kinetic=a[2],
            weakening=a[3],
            friction=int(a[4]),
            regularisation_velocity=a[5],
            force_scale=a[6],
            resolution=a[7],
        )
        control = Control(
            largest_step=b[0],
            smallest_step=b[1],
            event_step=b[2],
            closing_step=b[3],
            closing_speed=b[4],
            reference_energy=b[5],
            energy_rate=b[6],
            energy_floor=b[7],
            energy_share=b[8],
            trail_share=b[9],
            trail_time=b[10],
            closing_share=b[11],
            mass=b[12],
            gravity=b[13],
            frequency_parameter=b[14],
            resting_energy=b[15],
            slenderness_angle=b[16],
            width=b[17],
            stop_when_overturned=b[18] != 0.0,
            top_monitors=int(b[19]),
            base_points=int(b[20]),
        )
        motion = FloorMotion(
            int(rows.motion_kind[k]),
            rows.motion_parameters[k],
            rows.motion_breaks[k],
            rows.motion_coefficients[k],
        )
        x, v, acceleration = floor_motion(motion, 0.0)
        for side in range(2):
            scratch.floor[side, 0], scratch.floor[side, 1], scratch.floor[side, 2] = x, v, acceleration
        run = Run(
            scheme,
            contact,
            motion,
            rows.breaks[k],
            control,
            scratch.old,
            scratch.new,
            scratch.work,
            scratch.floor,
            scratch.slip,
            scratch.change,
            out.ledger[k],
            out.clock[k : k + 1],
            out.track[k : k + 1],
            scratch.watched,
            Samples(
                rows.interval[k],
                scratch.history.columns,
                scratch.history.mode,
                scratch.history.position,
                scratch.history.velocity,
                scratch.history.force,
            ),
            scratch.frames,
        )
        status = advance_in_slices(scratch.body, run, rows, out, k, ahead, rows.duration[k])
        rotation = abs(scratch.old.pose[ROTATION])
        undecided = rotation > control.slenderness_angle and not out.track[k].overturned_at < np.inf
        if status == REACHED and undecided:
            status = follow_aftermath(scratch, run, rows, out, k)
        if status == REACHED and out.track[k].overturned_at < np.inf:
            status = OVERTURNED
        out.status[k] = status
        out.rotation[k] = scratch.old.pose[ROTATION]
        for i in range(scratch.work.force.shape[0]):
            for c in range(2):
                residual = abs(scratch.work.law[i, c] - scratch.work.force[i, c])
                if residual > out.residual[k] or residual != residual:  # nan is kept, too
                    out.residual[k] = residual


@compiled
def follow_aftermath(scratch: Scratch, run: Run, rows: Rows, out: Outcomes, k: int) -> int:
    """Leave the floor alone until the container falls or is back below its slenderness angle."""
    clock = run.clock[0]
    until = rows.duration[k] + rows.aftermath[k]
    x, v, _ = floor_motion(run.motion, clock.time)
    leave_alone(scratch.body, run, v)
    scratch.uniform[0], scratch.uniform[1], scratch.uniform[2] = clock.time, x, 0.0
    motion = FloorMotion(UNIFORM, scratch.uniform, run.motion.breaks, run.motion.coefficients)
    clock.next_break = 0
    alone = Run(
        run.scheme,
        run.contact,
        motion,
        scratch.never,
        run.control,
        run.old,
        run.new,
        run.work,
        run.floor,
        run.slip,
        run.change,
        run.ledger,
        run.clock,
        run.track,
        run.watched,
        run.history,
        run.frames,
    )
    while clock.time < until:
        ahead = min(clock.time + AFTERMATH_SLICE, until)
        status = advance_in_slices(scratch.body, alone, rows, out, k, AFTERMATH_SLICE, ahead)
        rotation = abs(scratch.old.pose[ROTATION])
        decided = rotation <= run.control.slenderness_angle or run.track[0].overturned_at < np.inf
        if status != REACHED or decided:
            return status
    return REACHED


__all__ = ["CONTACT_NUMBERS", "TRACK", "Outcomes", "Rows", "Sampling", "pack_rows", "run_rows"]
