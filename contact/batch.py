"""Many runs of one container in one call: for maps, where only outcomes are wanted.

The container (points, modes, masses) is shared; floor, motion, friction, initial state and control differ from row
to row. Each row starts from its own initial state on scratch arrays of its thread, so that a row's result is the same
bytes whatever the number of threads and whichever rows run beside it. There is no history and no Python
object within a step; accelerations of the contents, which need samples, are not followed.
"""

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np

from contact.body import ROTATION, State, make_state
from contact.compiled import compiled
from contact.floor_motion import UNIFORM, FloorMotion, floor_motion
from contact.interface import Contact, FloatArray, IntArray, Workspace, make_workspace
from contact.ledger import ROWS as LEDGER_ROWS
from contact.modal_body import ModalBody, with_own_scratch
from contact.scheme import Scheme
from contact.stepping import (
    AFTERMATH_SLICE,
    CLOCK,
    OVERTURNED,
    REACHED,
    Control,
    Run,
    Samples,
    advance_compiled,
    leave_alone,
    make_samples,
)
from contact.tracking import TRACK

CONTACT_NUMBERS = tuple(
    name for name in Contact._fields if name not in ("normal_stiffness", "tangential_stiffness")
)
ROWS_AT_A_TIME = 8  #: handed to a thread: small enough to share the work evenly and to report progress


class Rows(NamedTuple):
    """Inputs of k runs of one container with n contact points and n_d coordinates."""

    normal_stiffness: FloatArray  #: (k, n)
    tangential_stiffness: FloatArray  #: (k, n)
    contact: FloatArray  #: (k, 8) the other numbers of `Contact`
    control: FloatArray  #: (k, 23) numbers of `Control`
    motion_kind: IntArray  #: (k,)
    motion_parameters: FloatArray  #: (k, ..) padded
    motion_breaks: FloatArray  #: (k, ..) padded with infinity
    motion_coefficients: FloatArray  #: (k, .., 4) padded
    breaks: FloatArray  #: (k, ..) instants that a step must end on, padded with infinity
    duration: FloatArray  #: (k,) [s]
    aftermath: (
        FloatArray  #: (k,) how long a container beyond its slenderness angle is followed afterwards [s]
    )
    position: FloatArray  #: (k, n_d) initial state, and so on
    velocity: FloatArray
    acceleration: FloatArray
    internal: FloatArray
    external: FloatArray
    damping: FloatArray
    point: FloatArray  #: (k, n, 2)
    force: FloatArray  #: (k, n, 2)
    stick: FloatArray  #: (k, n)
    pose: FloatArray  #: (k, 6)
    energy: FloatArray  #: (k, 3)


class Outcomes(NamedTuple):
    """Results of k runs."""

    status: IntArray  #: (k,) REACHED, OVERTURNED or FAILED
    track: Any  #: (k,) of tracking.TRACK
    clock: Any  #: (k,) of stepping.CLOCK
    ledger: FloatArray  #: (k, 5) [J]
    rotation: FloatArray  #: (k,) at the end [rad]


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


def pack_rows(runs: Sequence[Run], durations: Sequence[float], aftermaths: Sequence[float]) -> Rows:
    """Rows from runs at t = 0 that share one body (see `contact.stepping.make_run`)."""
    motions = [run.motion for run in runs]
    olds = [run.old for run in runs]

    def stacked(name: str) -> FloatArray:
        return np.stack([getattr(old, name) for old in olds])

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
        position=stacked("position"),
        velocity=stacked("velocity"),
        acceleration=stacked("acceleration"),
        internal=stacked("internal"),
        external=stacked("external"),
        damping=stacked("damping"),
        point=stacked("point"),
        force=stacked("force"),
        stick=stacked("stick"),
        pose=stacked("pose"),
        energy=stacked("energy"),
    )


def run_rows(body: ModalBody, scheme: Scheme, rows: Rows, tracks: Any, *, threads: int = 1) -> Outcomes:
    """Step every row to its end.

    Args:
        body: the shared container; its scratch arrays are not touched.
        scheme: of the time stepping, shared.
        rows: the inputs.
        tracks: records (k,) of TRACK as the runs have them at t = 0; copied.
        threads: to share the rows among; it does not change a bit of the results.
    """
    count = rows.duration.size
    outcomes = Outcomes(
        status=np.zeros(count, dtype=np.int64),
        track=np.array(tracks).view(np.recarray),
        clock=np.zeros(count, CLOCK).view(np.recarray),
        ledger=np.zeros((count, LEDGER_ROWS)),
        rotation=np.zeros(count),
    )
    outcomes.clock["smallest_step"] = np.inf
    firsts = range(0, count, ROWS_AT_A_TIME)

    def work(thread: int) -> None:
        scratch = _make_scratch(body, rows)
        for first in firsts[thread::threads]:
            advance_rows(scheme, rows, scratch, outcomes, first, min(first + ROWS_AT_A_TIME, count))

    if threads <= 1:
        work(0)
    else:
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(work, range(threads)))
    return outcomes


def _make_scratch(body: ModalBody, rows: Rows) -> Scratch:
    points = body.point.shape[0]
    return Scratch(
        body=with_own_scratch(body),
        old=make_state(rows.position.shape[1], points, 0),
        new=make_state(rows.position.shape[1], points, 0),
        work=make_workspace(points),
        slip=np.zeros(points),
        floor=np.zeros((2, 3)),
        change=np.zeros(LEDGER_ROWS),
        watched=np.zeros((0, 2)),
        uniform=np.zeros(3),
        never=np.full(1, np.inf),
        history=make_samples(math.inf, 4, points),
        frames=make_samples(math.inf, 4, points),
    )


def _padded(arrays: Sequence[FloatArray], value: float) -> FloatArray:
    """Stack arrays whose first axis differs in length, filling up with `value`."""
    longest = max(len(array) for array in arrays)
    out = np.full((len(arrays), longest, *arrays[0].shape[1:]), value)
    for row, array in zip(out, arrays, strict=True):
        row[: len(array)] = array
    return out


def _load_row(rows: Rows, k: int, scratch: Scratch) -> None:
    """Put the initial state of a row where its thread works, and forget the row before."""
    old, work, body = scratch.old, scratch.work, scratch.body
    for j in range(old.position.size):
        old.position[j], old.velocity[j] = rows.position[k, j], rows.velocity[k, j]
        old.acceleration[j], old.jerk[j] = rows.acceleration[k, j], 0.0
        old.internal[j], old.external[j] = rows.internal[k, j], rows.external[k, j]
        old.damping[j] = rows.damping[k, j]
    for i in range(old.point.shape[0]):
        old.stick[i] = rows.stick[k, i]
        for c in range(2):
            old.point[i, c], old.force[i, c] = rows.point[k, i, c], rows.force[k, i, c]
            old.descent[i, c] = 0.0
    for c in range(old.pose.size):
        old.pose[c] = rows.pose[k, c]
    for c in range(old.energy.size):
        old.energy[c] = rows.energy[k, c]
    work.factored_step[0] = -1.0
    for slot in range(body.cached_step.size - 1):
        body.cached_step[slot] = -1.0
    body.cached_step[body.cached_step.size - 1] = 0.0


load_row = compiled(_load_row)


def _advance_rows(scheme: Scheme, rows: Rows, scratch: Scratch, out: Outcomes, first: int, last: int) -> None:
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
            gain_room=b[11],
            gain_share=b[12],
            closing_share=b[13],
            mass=b[14],
            gravity=b[15],
            frequency_parameter=b[16],
            resting_energy=b[17],
            slenderness_angle=b[18],
            width=b[19],
            stop_when_overturned=b[20] != 0.0,
            top_monitors=0,
            base_points=int(b[22]),
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
            scratch.history,
            scratch.frames,
        )
        status = advance_compiled(scratch.body, run, rows.duration[k])
        rotation = abs(scratch.old.pose[ROTATION])
        if status == REACHED and control.slenderness_angle < rotation < 0.5 * math.pi:
            status = follow_aftermath(scratch, run, rows.duration[k] + rows.aftermath[k])
        if status == REACHED and out.track[k].overturned_at < np.inf:
            status = OVERTURNED
        out.status[k] = status
        out.rotation[k] = scratch.old.pose[ROTATION]


def _follow_aftermath(scratch: Scratch, run: Run, until: float) -> int:
    """Leave the floor alone until the container falls or is back below its slenderness angle."""
    clock = run.clock[0]
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
        status = advance_compiled(scratch.body, alone, min(clock.time + AFTERMATH_SLICE, until))
        rotation = abs(scratch.old.pose[ROTATION])
        if status != REACHED or rotation < run.control.slenderness_angle or rotation >= 0.5 * math.pi:
            return status
    return REACHED


follow_aftermath = compiled(_follow_aftermath)
advance_rows = compiled(_advance_rows)

__all__ = ["CONTACT_NUMBERS", "TRACK", "Outcomes", "Rows", "pack_rows", "run_rows"]
