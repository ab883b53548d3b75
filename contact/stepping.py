"""Adaptive time stepping of one body on a moving floor.

One step: predict, then free motion -> contact forces -> response until the points stand where the forces were
computed (`attempt`). Around it the step control: steps are a ladder h = largest / 2^(level/3); a step is redone
smaller when an iteration fails, when the support breaks loose late in a large step, or when the energy
ledger shows that the step lost or won more than its share; it grows by 2^(1/3) when it lost little.

`advance` is written once. `advance_compiled` steps a `ModalBody`, `fem.full_body.advance_full` a finite-element body;
`advance` itself, as plain Python, any object with the methods of `contact.body`. All call the same compiled laws,
contact solver and ledger.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numba.extending import register_jitable

from contact.body import (
    ANGULAR_VELOCITY,
    CENTRE_X,
    CENTRE_Z,
    KINETIC,
    POTENTIAL,
    ROTATION,
    STRAIN,
    VELOCITY_X,
    VELOCITY_Z,
    State,
    complete,
    observe,
    predict,
    prepared,
    release,
    respond,
    shift_velocity,
    sizes_hold,
)
from contact.compiled import compiled
from contact.floor_motion import FloorMotion, floor_motion
from contact.interface import Contact, FloatArray, Workspace, solve_contact
from contact.laws import ELASTIC_STICK, relaxed_stick, weakened_mu
from contact.ledger import (
    BASE_WORK,
    CONTACT_DAMPING,
    FRICTION,
    GAIN_LIMIT,
    IMBALANCE,
    LOSS_LIMIT,
    LOSS_SHARE_LIMIT,
    MATERIAL_DAMPING,
    contact_losses,
    spring_energy,
)
from contact.ledger import (
    ROWS as LEDGER_ROWS,
)
from contact.scheme import Scheme
from contact.tracking import FALLEN, NEVER, follow, make_track

ITERATION_LIMIT = 12  #: of free motion, contact, response within one step
WEAKENING_LIMIT = 8  #: repetitions of a step for friction that falls with its slip
WEAKENING_TOLERANCE = 1e-9  #: change of the coefficient at which they end
STEPS_PER_OCTAVE = 3  #: of the ladder of step sizes
OCTAVE = tuple(2.0 ** (-level / STEPS_PER_OCTAVE) for level in range(STEPS_PER_OCTAVE))  #: its first steps
NEIGHBOUR = 0.25  #: base points nearer than this, over the width, close as one
HELD_STEPS = 6  #: after a rejection
#: the ledger as a whole keeps below these shares of what may be won and lost in the end, for which it holds the steps
#: small from that share of them on ..
GAIN_AIM, LOSS_AIM, NEAR_AIM = 0.3, 0.9, 0.4
#: .. by the share of what is left that one step may use, and of what any step may have that it may use always
ROOM_SHARE, LEAST_ROOM = 0.1, 1e-4
SAME_INSTANT = 1e-12  #: difference of two times, over their size, that is rounding
FADING = 0.8  #: of the memory for the imbalance, a step

UNLIMITED = 2**62
#: a run that tries more steps than so many each 1/p, and each largest step, makes no headway
ATTEMPTS_OF_ROCKING, ATTEMPTS_OF_STEP, ATTEMPTS_SPARE = 1e6, 100.0, 1e6

#: what `advance` returns
REACHED, OVERTURNED, FAILED, UNPREPARED = 0, 1, 2, 3
OVERTURNING_ROTATION = 0.5 * np.pi
#: a container that is to lie on its side counts as overturned so much before: there its side meets the floor [rad]
LYING_DOWN = 2e-3

#: columns of `Run.rows`
(
    ROW_ROTATION,
    ROW_ANGULAR_VELOCITY,
    ROW_SLIP,
    ROW_UPLIFT,
    ROW_CENTRE_X,
    ROW_CENTRE_Z,
    ROW_NORMAL,
    ROW_SHEAR,
    ROW_KINETIC,
    ROW_STRAIN,
    ROW_POTENTIAL,
    ROW_BASE_WORK,  # this and the following in the order of the ledger
    ROW_FRICTION,
    ROW_CONTACT_DAMPING,
    ROW_MATERIAL_DAMPING,
    ROW_IMBALANCE,
) = range(16)
ROW_COLUMNS = 16


class Control(NamedTuple):
    """Limits of the stepping: constants of one run."""

    largest_step: float  #: [s]
    smallest_step: float  #: [s]
    event_step: float  #: largest step in which the support may break loose [s]
    closing_step: float  #: largest step that may begin at the first touch of a point [s]
    closing_speed: float  #: slower closings are left to the energy ledger [m/s]
    reference_energy: float  #: what it takes to overturn the container [J]
    energy_rate: float  #: imbalance allowed per second, over the reference energy [1/s]
    energy_floor: float  #: imbalance allowed in any step, over the reference energy [-]
    energy_share: float  #: imbalance allowed over what a step dissipates [-]
    trail_share: float  #: imbalance allowed over what was dissipated shortly before [-]
    trail_time: float  #: how long that counts [s]
    closing_share: (
        float  #: imbalance allowed when a gap closes, over the kinetic energy relative to the floor [-]
    )
    mass: float  #: [kg]
    gravity: float  #: [m/s2]
    frequency_parameter: float  #: of rocking [1/s]
    resting_energy: float  #: gravity potential of the container at rest [J]
    slenderness_angle: float  #: [rad]
    width: float  #: [m]
    stop_when_overturned: bool
    top_monitors: int  #: of the monitored points, so many first ones lie at the top
    base_points: int  #: of the contact points, so many first ones make up the base


CLOCK = np.dtype(
    [
        ("time", "f8"),
        ("level", "i8"),
        ("sliding", "i8"),  # 1 while every loaded point slides: kinetic friction
        ("slid", "f8"),  # since the support broke loose
        ("slip", "f8"),  # force-weighted sliding of the container, signed
        ("steps", "i8"),
        ("rejected", "i8"),
        ("failed", "i8"),  # of these: iterations that did not converge
        ("iterations", "i8"),
        ("contact_iterations", "i8"),
        ("smallest_step", "f8"),
        ("utilisation", "f8"),  # support's tangential force over mu_s times its normal force
        ("utilisation_rate", "f8"),
        ("slip_velocity", "f8"),  # force-weighted
        ("slip_acceleration", "f8"),
        ("used", "f8"),  # share of the imbalance allowed, lately
        ("trail", "f8"),  # dissipated shortly before [J]
        ("held", "i8"),  # accepted steps until the step may grow freely again
        ("basis_step", "f8"),  # that the old acceleration's lag belongs to
        ("due_step", "f8"),  # that the body was not prepared for
        ("samples", "i8"),  # of the history, so far
        ("samples_gone", "i8"),  # of these no longer in the arrays
        ("frames", "i8"),
        ("frames_gone", "i8"),
        ("next_break", "i8"),
        ("least_imbalance", "f8"),
        ("most_imbalance", "f8"),
        ("dissipated", "f8"),  # when these were taken
        ("attempt_limit", "i8"),  # of steps, accepted and rejected, at which `advance` returns
    ],
    align=True,
)


class Samples(NamedTuple):
    """What is kept on an exact grid of times, as much of it as the arrays hold: n_s samples."""

    interval: float  #: [s]
    columns: FloatArray  #: (n_s, 16 or 0) of a history, see ROW_...
    mode: npt.NDArray[np.int64]  #: (n_s,)
    position: FloatArray  #: (n_s, n_d or 0) coordinates of the body
    velocity: FloatArray  #: (n_s, n_d or 0)
    force: FloatArray  #: (n_s, n, 2) contact forces [N]


def make_samples(
    interval: float, count: int, points: int, *, columns: bool = False, position: int = 0, velocity: int = 0
) -> Samples:
    """Room for `count` samples; `position` and `velocity` say how many coordinates are kept."""
    return Samples(
        interval=float(interval),
        columns=np.zeros((count, ROW_COLUMNS if columns else 0)),
        mode=np.zeros(count, dtype=np.int64),
        position=np.zeros((count, position)),
        velocity=np.zeros((count, velocity)),
        force=np.zeros((count, points, 2)),
    )


class Run(NamedTuple):
    """Everything a run consists of besides the body: constants, and what changes in place."""

    scheme: Scheme
    contact: Contact
    motion: FloorMotion
    breaks: FloatArray  #: instants at which a step must end [s], rising, the last one infinite
    control: Control
    old: State
    new: State
    work: Workspace
    floor: FloatArray  #: (2, 3) displacement, velocity, acceleration of the floor before and after the step
    slip: FloatArray  #: (n,) sliding of the points in the step attempted [m]
    change: FloatArray  #: (5,) what the step attempted adds to the ledger [J]
    ledger: FloatArray  #: (5,) [J]
    clock: Any  #: (1,) of CLOCK
    track: Any  #: (1,) of tracking.TRACK
    watched: FloatArray  #: (n_m, 2) velocities of the monitored points at the last sample [m/s]
    history: Samples
    frames: Samples


def make_run(
    *,
    scheme: Scheme,
    contact: Contact,
    motion: FloorMotion,
    breaks: FloatArray,
    control: Control,
    old: State,
    new: State,
    work: Workspace,
    history: Samples,
    frames: Samples,
) -> Run:
    """Put a run together at t = 0; `old` holds the initial state, completed."""
    n = old.point.shape[0]
    clock = np.zeros(1, CLOCK).view(np.recarray)
    clock["smallest_step"] = NEVER
    clock["attempt_limit"] = UNLIMITED
    return Run(
        scheme=scheme,
        contact=contact,
        motion=motion,
        breaks=np.append(np.asarray(breaks, dtype=float), NEVER),
        control=control,
        old=old,
        new=new,
        work=work,
        floor=np.tile(floor_motion(motion, 0.0), (2, 1)),
        slip=np.zeros(n),
        change=np.zeros(LEDGER_ROWS),
        ledger=np.zeros(LEDGER_ROWS),
        clock=clock,
        track=make_track(),
        watched=np.zeros((old.monitor.shape[0], 2)),
        history=history,
        frames=frames,
    )


def _copy_vector(target: FloatArray, source: FloatArray) -> None:
    for i in range(target.size):
        target[i] = source[i]


copy_vector = compiled(_copy_vector, inline=True)


def _copy_rows(target: FloatArray, source: FloatArray) -> None:
    for i in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[i, k] = source[i, k]


copy_rows = compiled(_copy_rows, inline=True)


def _rebase_acceleration(scheme: Scheme, old: State, shortened: float) -> None:
    """Shift the scheme's acceleration to the lag that belongs to a step shorter by `shortened` [s].

    The averaged equation puts it (alpha_f - alpha_m) steps before the end of its step. Left as it is when the
    step changes, it would cost the scheme its second order.
    """
    shift = (scheme.alpha_f - scheme.alpha_m) * shortened
    if shift != 0.0:
        for j in range(old.acceleration.size):
            old.acceleration[j] += shift * old.jerk[j]


rebase_acceleration = compiled(_rebase_acceleration, inline=True)


def _note_rates(step: float, old: State, new: State, work: Workspace) -> None:
    """Velocities of the base points and rates of change over the step, for the step control."""
    per_second = 1.0 / step
    for i in range(new.descent.shape[0]):
        new.descent[i, 0] = -work.velocity[i, 1]
        new.descent[i, 1] = (new.descent[i, 0] - old.descent[i, 0]) * per_second
    for j in range(new.jerk.size):
        new.jerk[j] = (new.acceleration[j] - old.acceleration[j]) * per_second


note_rates = compiled(_note_rates, inline=True)


@register_jitable(forceinline=True)
def _attempt(body: Any, run: Run, step: float, mu: float) -> int:
    """Try one step; the result stands in `run.new`. Returns the iterations taken, or -1."""
    old, new, work, scheme = run.old, run.new, run.work, run.scheme
    clock = run.clock[0]
    floor, floor_velocity, floor_acceleration = floor_motion(run.motion, clock.time + step)
    run.floor[1, 0], run.floor[1, 1], run.floor[1, 2] = floor, floor_velocity, floor_acceleration
    slope = scheme.newmark_gamma / (scheme.newmark_beta * step)
    rebase_acceleration(scheme, old, clock.basis_step - step)
    clock.basis_step = step
    predict(body, scheme, step, old, new)
    copy_rows(work.force, old.force)
    for iteration in range(ITERATION_LIMIT):
        release(body, scheme, step, old, new, work, floor, floor_velocity)
        solved = solve_contact(run.contact, step, slope, mu, old.point, old.stick, work)
        if solved < 0:
            return -1
        clock.contact_iterations += solved
        if respond(body, scheme, step, old, new, work) <= 1.0:
            copy_rows(new.force, work.force)
            note_rates(step, old, new, work)
            complete(body, new, floor)
            return iteration + 1
    return -1


def _slide(run: Run, step: float) -> tuple[bool, float, float]:
    """Sliding of the base points and elongation of their springs after a converged step.

    Returns whether every loaded point slides, all in one direction, the force-weighted sliding [m], and the
    force-weighted velocity of the loaded points at the end of the step [m/s].
    """
    contact, old, new, work = run.contact, run.old, run.new, run.work
    every, direction, weighted, total, velocity = True, 0.0, 0.0, 0.0, 0.0
    for i in range(new.point.shape[0]):
        normal, tangential = new.force[i, 1], new.force[i, 0]
        moved = new.point[i, 0] - old.point[i, 0]
        stick = old.stick[i]
        if old.point[i, 1] >= 0.0:  # open at the beginning: only the closed part of the step slides
            below = max(0.0, -new.point[i, 1])
            moved *= below / (below + old.point[i, 1]) if below > 0.0 else 0.0
        run.slip[i] = 0.0
        if new.point[i, 1] >= 0.0:
            new.stick[i] = 0.0
            continue
        if contact.friction != ELASTIC_STICK:
            new.stick[i] = 0.0
            run.slip[i] = moved
        elif normal <= 0.0 or work.slope[i, 0] == 0.0:
            new.stick[i] = relaxed_stick(
                stick, -tangential, contact.tangential_stiffness[i], contact.relaxation_time, step
            )
            run.slip[i] = moved - (new.stick[i] - stick)
        elif old.point[i, 1] >= 0.0:
            new.stick[i] = 0.0
        else:
            new.stick[i] = stick + moved
        if normal > 0.0:
            weighted += normal * run.slip[i]
            velocity += normal * work.velocity[i, 0]
            total += normal
            if contact.friction != ELASTIC_STICK:
                every = every and abs(work.velocity[i, 0]) > contact.regularisation_velocity
            elif work.slope[i, 0] != 0.0 or direction * work.law[i, 0] < 0.0:
                every = False
            direction = work.law[i, 0]
    if total <= 0.0:  # in flight nothing tells sticking from sliding: as before
        return run.clock[0].sliding == 1, 0.0, 0.0
    return every, weighted / total, velocity / total


slide = compiled(_slide, inline=True)


def _account(run: Run) -> float:
    """What the step attempted adds to the ledger, into `run.change`; returns what it dissipated [J]."""
    old, new, change = run.old, run.new, run.change
    shear = 0.0
    for i in range(new.force.shape[0]):
        shear += 0.5 * (old.force[i, 0] + new.force[i, 0])
    friction, damping = contact_losses(
        run.contact, old.point, new.point, old.force, new.force, old.stick, new.stick, run.slip
    )
    material = 0.0
    for j in range(new.damping.size):
        material += 0.5 * (old.damping[j] + new.damping[j]) * (new.position[j] - old.position[j])
    stored = spring_energy(run.contact, new.point, new.stick) - spring_energy(
        run.contact, old.point, old.stick
    )
    for row in (KINETIC, STRAIN, POTENTIAL):
        stored += new.energy[row] - old.energy[row]
    change[BASE_WORK] = shear * (run.floor[1, 0] - run.floor[0, 0])
    change[FRICTION] = friction
    change[CONTACT_DAMPING] = damping
    change[MATERIAL_DAMPING] = material
    change[IMBALANCE] = change[BASE_WORK] - friction - damping - material - stored
    return friction + damping + material


account = compiled(_account, inline=True)


def _copy_state(old: State, new: State) -> None:
    copy_vector(old.numbers, new.numbers)


copy_state = compiled(_copy_state, inline=True)


def _hermite(
    share: float, step: float, value: float, rate: float, value_new: float, rate_new: float
) -> float:
    """Cubic through values and rates at both ends of a step, at `share` of it."""
    s = share
    return (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * value
        + s * (1.0 - s) ** 2 * step * rate
        + s * s * (3.0 - 2.0 * s) * value_new
        - s * s * (1.0 - s) * step * rate_new
    )


hermite = compiled(_hermite)


def _write_columns(
    run: Run, row: FloatArray, force: FloatArray, time: float, s: float, step: float, slip_step: float
) -> None:
    """One row of a history at the share `s` of the step; `force` (n, 2) is that of this instant."""
    old, new = run.old, run.new
    a, b = old.pose, new.pose
    floor, _, _ = floor_motion(run.motion, time)
    row[ROW_ROTATION] = hermite(s, step, a[ROTATION], a[ANGULAR_VELOCITY], b[ROTATION], b[ANGULAR_VELOCITY])
    row[ROW_ANGULAR_VELOCITY] = (1.0 - s) * a[ANGULAR_VELOCITY] + s * b[ANGULAR_VELOCITY]
    row[ROW_SLIP] = run.clock[0].slip + s * slip_step
    row[ROW_CENTRE_X] = hermite(s, step, a[CENTRE_X], a[VELOCITY_X], b[CENTRE_X], b[VELOCITY_X]) - floor
    row[ROW_CENTRE_Z] = hermite(s, step, a[CENTRE_Z], a[VELOCITY_Z], b[CENTRE_Z], b[VELOCITY_Z])
    row[ROW_UPLIFT], row[ROW_NORMAL], row[ROW_SHEAR] = 0.0, 0.0, 0.0
    for i in range(new.point.shape[0]):
        if i < run.control.base_points:
            row[ROW_UPLIFT] = max(row[ROW_UPLIFT], (1.0 - s) * old.point[i, 1] + s * new.point[i, 1])
        row[ROW_SHEAR] += force[i, 0]
        row[ROW_NORMAL] += force[i, 1]
    for k in range(3):
        row[ROW_KINETIC + k] = (1.0 - s) * old.energy[k] + s * new.energy[k]
    for k in range(LEDGER_ROWS):
        row[ROW_BASE_WORK + k] = run.ledger[k] + s * run.change[k]


write_columns = compiled(_write_columns, inline=True)


def _watch_contents(run: Run, s: float, interval: float) -> None:
    """Largest mean acceleration of the monitored contents over an interval of the history.

    The instantaneous one means nothing under a dashpot that acts at a point: it grows without bound as the step
    falls. What an accelerometer of the history's band would show does not.
    """
    old, new, watched = run.old.monitor, run.new.monitor, run.watched
    for i in range(watched.shape[0]):
        x = (1.0 - s) * old[i, 2] + s * new[i, 2]
        z = (1.0 - s) * old[i, 3] + s * new[i, 3]
        if i < run.control.top_monitors:
            sway = abs((1.0 - s) * old[i, 0] + s * new[i, 0])
            run.track[0].max_top_displacement = max(run.track[0].max_top_displacement, sway)
        else:
            size = np.hypot(x - watched[i, 0], z - watched[i, 1]) / interval
            run.track[0].max_acceleration = max(run.track[0].max_acceleration, size)
        watched[i, 0], watched[i, 1] = x, z


watch_contents = compiled(_watch_contents, inline=True)


def _write_coordinates(samples: Samples, at: int, old: State, new: State, s: float, step: float) -> None:
    """Coordinates of the body and their rates at the share `s` of the step, where they are kept."""
    for j in range(samples.position.shape[1]):
        samples.position[at, j] = hermite(
            s, step, old.position[j], old.velocity[j], new.position[j], new.velocity[j]
        )
    for j in range(samples.velocity.shape[1]):
        samples.velocity[at, j] = (1.0 - s) * old.velocity[j] + s * new.velocity[j]


write_coordinates = compiled(_write_coordinates, inline=True)


@register_jitable(forceinline=True)
def sample(
    body: Any, run: Run, samples: Samples, written: int, origin: int, step: float, slip_step: float
) -> int:
    """Write the samples that fall into the step just attempted, from the old time up to and with the new one.

    `written` samples exist so far, the first `origin` of them are no longer in the arrays; returns how many exist now.
    Positions by cubics through both ends' positions and velocities, everything else linear.
    """
    old, new, clock = run.old, run.new, run.clock[0]
    observed, end = False, clock.time + step
    while written - origin < samples.mode.size:
        time = written * samples.interval if written > 0 else 0.0
        if time - end > SAME_INSTANT * end:  # 12 x 0.1 s is more than 1.2 s by rounding
            break
        s = min((time - clock.time) / step, 1.0)
        at = written - origin
        for i in range(new.point.shape[0]):
            for k in range(2):
                samples.force[at, i, k] = (1.0 - s) * old.force[i, k] + s * new.force[i, k]
        write_coordinates(samples, at, old, new, s, step)
        samples.mode[at] = run.track[0].mode
        if samples.columns.shape[1] > 0:
            write_columns(run, samples.columns[at], samples.force[at], time, s, step, slip_step)
            if not observed:
                observe(body, old, run.floor[0, 0])
                observe(body, new, run.floor[1, 0])
                observed = True
            watch_contents(run, s, samples.interval if written > 0 else np.inf)
        written += 1
    return written


@register_jitable(forceinline=True)
def _rests_beside(state: State, other: int, point: int, width: float) -> bool:
    """Another base point, if there is one, is closed and near."""
    if other < 0 or other >= state.point.shape[0]:
        return False
    near = abs(state.point[other, 0] - state.point[point, 0]) < NEIGHBOUR * width
    return near and state.point[other, 1] < 0.0


def _closing_time(control: Control, state: State, horizon: float) -> float:
    """Time until a base point touches the floor with more than the closing speed [s], or the horizon.

    By its present velocity and acceleration; 0 for a point that has touched just now. A point beside one that is
    closed (a wide base zips up) brings no mass of its own and is left to the ledger.
    """
    first = horizon
    n = state.point.shape[0]
    for i in range(n):
        if _rests_beside(state, i - 1, i, control.width) or _rests_beside(state, i + 1, i, control.width):
            continue
        gap, speed, rate = state.point[i, 1], state.descent[i, 0], state.descent[i, 1]
        if gap > 0.0 and speed * first + 0.5 * max(rate, 0.0) * first * first > gap:
            root = speed * speed + 2.0 * rate * gap
            if root > control.closing_speed**2:
                first = min(first, 2.0 * gap / (speed + np.sqrt(root)))
        elif speed > control.closing_speed and -0.5 * control.closing_step * speed < gap <= 0.0:
            first = 0.0
    return first


closing_time = compiled(_closing_time, inline=True)


def _switching_time(clock: Any, horizon: float) -> float:
    """Time until the stuck support reaches its limit, or the sliding one comes to a halt [s], or the horizon."""
    if clock.sliding == 0:
        left, rate = 1.0 - clock.utilisation, clock.utilisation_rate
    else:
        left, rate = abs(clock.slip_velocity), -clock.slip_acceleration
        if clock.slip_velocity < 0.0:
            rate = -rate
    return left / rate if rate * horizon > left > 0.0 else horizon


switching_time = compiled(_switching_time, inline=True)


def _next_step(run: Run) -> float:
    """The next step [s]: the ladder's at the present level, unless something is due before.

    A gap about to close: the step ends where it closes, and the next one, on which the dashpot works, is small.
    An instant that a step must end on: the step ends there.
    """
    clock, control = run.clock[0], run.control
    step = ladder_step(control.largest_step, clock.level)
    if step > control.closing_step:
        due = max(closing_time(control, run.old, step), control.closing_step)
        if (
            due < step
        ):  # on the ladder, just short of it: a new step size is dear to a body that factors a matrix
            due_level = ladder_level(control.largest_step, due)
            step = ladder_step(control.largest_step, due_level)
            if due == control.closing_step:
                clock.level = due_level
    if step > control.event_step:
        due = max(switching_time(clock, step), control.event_step)
        if due < step:
            step = ladder_step(control.largest_step, ladder_level(control.largest_step, due))
    while run.breaks[clock.next_break] <= clock.time:
        clock.next_break += 1
    left = run.breaks[clock.next_break] - clock.time
    if step >= left:
        return left
    if 2.0 * step > left:  # two equal steps instead of a whole one and a sliver
        return 0.5 * left
    return step


next_step = compiled(_next_step, inline=True)


def _allowed_imbalance(run: Run, step: float, dissipated: float) -> float:
    """Energy that the step attempted may lose or win [J].

    A share of what it dissipates, and of what was dissipated shortly before: while an impact rings down, the
    ringing is resolved as well as the impact deserves.
    A first touch switches a dashpot on: what the scheme loses there falls with the step itself only, so it is held
    against the energy that meets the floor.
    """
    control, old, new = run.control, run.old, run.new
    allowed = control.reference_energy * (control.energy_floor + control.energy_rate * step)
    allowed += control.energy_share * abs(dissipated)
    allowed += control.trail_share * run.clock[0].trail * step / control.trail_time
    closing, closing_beside = False, False
    for i in range(new.point.shape[0]):
        if old.point[i, 1] >= 0.0 and new.point[i, 1] < 0.0:
            beside = _rests_beside(old, i - 1, i, control.width) or _rests_beside(
                old, i + 1, i, control.width
            )
            closing = closing or not beside
            closing_beside = closing_beside or beside
    if closing or closing_beside:  # a base that zips up shares the allowance among its points
        floor_velocity = run.floor[0, 1]
        relative = floor_velocity * (0.5 * floor_velocity - old.pose[VELOCITY_X])
        share = control.closing_share if closing else control.closing_share / control.base_points
        allowed += share * (old.energy[KINETIC] + control.mass * relative)
    return allowed


allowed_imbalance = compiled(_allowed_imbalance, inline=True)


def _room_of_ledger(run: Run, step: float) -> float:
    """Imbalance that the ledger as a whole has room for in the step attempted [J]; infinite far from its limits.

    What one step may lose or win adds up: a share of what it dissipates may be much against the energy to overturn, as
    when a low container slides far. From `NEAR_AIM` on a step may use a share of what is left only, so that the
    ledger comes to rest where it aims. What is left to a step always lies above its rounding, and would take 1e5 of
    them to reach the limit. A gain is worse than a loss: it drives what it should only follow.
    """
    control, ledger, change = run.control, run.ledger, run.change
    if change[IMBALANCE] < 0.0:
        aim, used = GAIN_AIM * GAIN_LIMIT * control.reference_energy, -ledger[IMBALANCE]
    else:
        dissipated = ledger[FRICTION] + ledger[CONTACT_DAMPING] + ledger[MATERIAL_DAMPING]
        dissipated += change[FRICTION] + change[CONTACT_DAMPING] + change[MATERIAL_DAMPING]
        aim = LOSS_AIM * max(LOSS_LIMIT * control.reference_energy, LOSS_SHARE_LIMIT * dissipated)
        used = ledger[IMBALANCE]
    if used + abs(change[IMBALANCE]) < NEAR_AIM * aim:
        return np.inf
    least = control.energy_floor + control.energy_rate * step
    return max(ROOM_SHARE * (aim - used), LEAST_ROOM * control.reference_energy * least)


room_of_ledger = compiled(_room_of_ledger, inline=True)


def _change_level(level: int, used: float, not_held: bool) -> int:
    """Level of the next step, when the last one used that share of the imbalance allowed to it.

    The imbalance of a step is of third order: half the step has an eighth of it. Shortly after a rejection
    (`not_held` false) the step grows only where almost nothing was lost.
    """
    if used > 8.0:
        return level + 2 * STEPS_PER_OCTAVE
    if used > 1.0:
        return level + STEPS_PER_OCTAVE
    if used > 0.7:
        return level + 1
    if used < 0.02:
        return max(level - 3, 0)
    if used < 0.05 and not_held:
        return max(level - 2, 0)
    if used < 0.15 and not_held:
        return max(level - 1, 0)
    return level


change_level = compiled(_change_level)


def _ladder_level(largest_step: float, step: float) -> int:
    """Level of the largest step of the ladder that is not above `step`."""
    return max(0, int(np.ceil(STEPS_PER_OCTAVE * np.log2(largest_step / step) - 1e-9)))


ladder_level = compiled(_ladder_level)


def _ladder_step(largest_step: float, level: int) -> float:
    """Step of that level of the ladder; as a product, for a power costs as much as the contact of a corner."""
    octave = level // STEPS_PER_OCTAVE
    return math.ldexp(largest_step * OCTAVE[level - octave * STEPS_PER_OCTAVE], -octave)


ladder_step = compiled(_ladder_step, inline=True)


def _note_step(run: Run, step: float, slip_step: float, slip_velocity: float, every: bool) -> None:
    """Friction's state and the record of the run, from the step about to be accepted."""
    clock = run.clock[0]
    clock.slid = clock.slid + abs(slip_step) if clock.sliding == 1 or every else 0.0
    clock.sliding = 1 if every else 0
    tangential, normal = 0.0, 0.0
    for i in range(run.new.force.shape[0]):
        tangential += run.new.force[i, 0]
        normal += run.new.force[i, 1]
    limit = run.contact.mu_static * normal
    utilisation = abs(tangential) / limit if limit > 0.0 else 0.0
    clock.utilisation_rate = (utilisation - clock.utilisation) / step
    clock.utilisation = utilisation
    clock.slip_acceleration = (slip_velocity - clock.slip_velocity) / step
    clock.slip_velocity = slip_velocity
    follow(
        run.track[0],
        run.control,
        run.old,
        run.new,
        clock.time + step,
        step,
        every,
        clock.slip + slip_step,
        slip_step,
        run.floor[1, 2],
    )


note_step = compiled(_note_step, inline=True)


def _close_step(run: Run, step: float, slip_step: float, iterations: int) -> None:
    """Make the step the state of the run, and enter it in the ledger."""
    clock = run.clock[0]
    for row in range(LEDGER_ROWS):
        run.ledger[row] += run.change[row]
    if run.track[0].overturned_at == NEVER:  # how it slams down afterwards is not the question
        clock.least_imbalance = min(clock.least_imbalance, run.ledger[IMBALANCE])
        clock.most_imbalance = max(clock.most_imbalance, run.ledger[IMBALANCE])
        clock.dissipated = run.ledger[FRICTION] + run.ledger[CONTACT_DAMPING] + run.ledger[MATERIAL_DAMPING]
    clock.slip += slip_step
    clock.time += step
    clock.steps += 1
    clock.iterations += iterations
    clock.smallest_step = min(clock.smallest_step, step)
    copy_state(run.old, run.new)
    for k in range(3):
        run.floor[0, k] = run.floor[1, k]


close_step = compiled(_close_step, inline=True)


@register_jitable(forceinline=True)
def _accept(
    body: Any, run: Run, step: float, slip_step: float, slip_velocity: float, every: bool, iterations: int
) -> None:
    """Make the step attempted the state of the run; samples, ledger and record follow."""
    clock = run.clock[0]
    note_step(run, step, slip_step, slip_velocity, every)
    clock.samples = sample(body, run, run.history, clock.samples, clock.samples_gone, step, slip_step)
    clock.frames = sample(body, run, run.frames, clock.frames, clock.frames_gone, step, slip_step)
    close_step(run, step, slip_step, iterations)


@register_jitable(forceinline=True)
def _kinetic_friction(contact: Contact, slid: float) -> float:
    """Coefficient of friction of a support that slides, `slid` [m] since it broke loose."""
    return weakened_mu(contact.mu_static, contact.mu_kinetic, contact.weakening, slid)


@register_jitable(forceinline=True)
def _is_full(run: Run) -> bool:
    """No room for the samples of another largest step."""
    ahead = run.control.largest_step
    clock = run.clock[0]
    room = run.history.mode.size - (clock.samples - clock.samples_gone)
    room_of_frames = run.frames.mode.size - (clock.frames - clock.frames_gone)
    return (room - 1) * run.history.interval < ahead or (room_of_frames - 1) * run.frames.interval < ahead


@register_jitable(forceinline=True)
def leave_alone(body: Any, run: Run, floor_velocity: float) -> None:
    """Go over to the frame in which the floor, undriven from now on, stands still (Galilei): no kick, no journey.

    Args:
        body: what is stepped; run: at the end of its motion, whose `floor` rows are brought to rest.
        floor_velocity: that it had [m/s].
    """
    shift_velocity(body, run.old, floor_velocity)
    complete(body, run.old, run.floor[0, 0])
    for side in range(2):
        run.floor[side, 1], run.floor[side, 2] = 0.0, 0.0
    run.clock[0].next_break = 0


def most_attempts(control: Control, time: float) -> int:
    """Steps, accepted and rejected, that a run may have tried in `time` [s]; beyond, it is stuck."""
    rate = max(ATTEMPTS_OF_ROCKING * control.frequency_parameter, ATTEMPTS_OF_STEP / control.largest_step)
    return int(ATTEMPTS_SPARE + rate * time)


AFTERMATH_SLICE = 0.05  #: how often a container left alone is looked at [s]


def advance(body: Any, run: Run, until: float) -> int:
    """Step the body to the time `until` [s] or, as no step is cut for it, just beyond; changes `run` in place.

    It also returns when the arrays of samples are full, so that no sample is lost, and at `clock.attempt_limit`, so
    that whoever called can look up.

    Returns:
        REACHED, OVERTURNED (90 degrees, where `control.stop_when_overturned`), FAILED: no convergence at
        the smallest step, the last good state stands in `run.old`; or UNPREPARED: the body needs something made for
        steps of `clock.due_step`, after which the call is repeated.
    """
    control, clock, track = run.control, run.clock[0], run.track[0]
    if not sizes_hold(body, run):
        return FAILED
    while clock.time < until and clock.steps + clock.rejected < clock.attempt_limit and not _is_full(run):
        step = next_step(run)
        if not prepared(body, step):
            clock.due_step = step
            return UNPREPARED
        mu = run.contact.mu_static
        if clock.sliding == 1:
            mu = _kinetic_friction(run.contact, clock.slid)
        iterations, every, slip_step, slip_velocity = 0, False, 0.0, 0.0
        for _ in range(WEAKENING_LIMIT):  # friction that falls with the slip of this very step
            iterations = _attempt(body, run, step, mu)
            if iterations < 0:
                break
            every, slip_step, slip_velocity = slide(run, step)
            if clock.sliding == 0 or run.contact.weakening <= 0.0:
                break
            weakened = _kinetic_friction(run.contact, clock.slid + abs(slip_step))
            if abs(weakened - mu) <= WEAKENING_TOLERANCE:
                break
            mu = weakened
        if iterations < 0:
            clock.rejected += 1
            clock.failed += 1
            if step <= control.smallest_step:
                return FAILED
            clock.level += STEPS_PER_OCTAVE
            continue
        dissipated = account(run)
        allowed = allowed_imbalance(run, step, dissipated)
        allowed = min(allowed, room_of_ledger(run, step))
        used = abs(run.change[IMBALANCE]) / allowed
        switches = (clock.sliding == 1) != every and run.contact.mu_static > 0.0
        if switches and step > 1.01 * control.event_step:
            used = max(used, 9.0 if step > 4.0 * control.event_step else 2.0)
        if used > 1.0 and step > control.smallest_step:
            clock.rejected += 1
            clock.level = change_level(clock.level, used, False)
            clock.held = HELD_STEPS
            continue
        if switches:  # what follows has the time scale of the contact again
            clock.level = max(clock.level, ladder_level(control.largest_step, control.event_step))
        late = step / control.trail_time
        clock.trail = clock.trail / (1.0 + late * (1.0 + 0.5 * late)) + max(dissipated, 0.0)
        _accept(body, run, step, slip_step, slip_velocity, every, iterations)
        # One step's imbalance may vanish by chance while it changes sign: look at three.
        recent = max(min(used, 1.0), FADING * clock.used)
        level = change_level(clock.level, recent, clock.held == 0)
        if level < clock.level or step > control.smallest_step:
            clock.level = level
        clock.used = recent
        clock.held = max(clock.held - 1, 0)
        fallen = OVERTURNING_ROTATION if control.stop_when_overturned else OVERTURNING_ROTATION - LYING_DOWN
        if abs(run.old.pose[ROTATION]) >= fallen and track.overturned_at == NEVER:
            track.overturned_at = clock.time
            track.mode = FALLEN
            track.modes |= 1 << FALLEN
            if control.stop_when_overturned:
                return OVERTURNED
    return REACHED


advance_compiled = compiled(advance)
leave_alone_compiled = compiled(leave_alone)
