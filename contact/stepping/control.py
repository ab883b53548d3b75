"""Size of the next step, and its energy error tolerance.

Step sizes are h = largest / 2^(level/3). A step ends where a gap closes or the floor motion has a break. Closing, the
onset of sliding and the end of sliding get small steps. Otherwise the energy balance error decides.
"""

import math

import numpy as np

from contact.jit import compiled, inlined
from contact.stepping.body import KINETIC, VELOCITY_X, State
from contact.stepping.ledger import GAIN_LIMIT, IMBALANCE, LOSS_LIMIT, LOSS_SHARE_LIMIT, dissipation
from contact.stepping.state import Control, RunState

STEPS_PER_OCTAVE = 3  #: sizes per factor of two
OCTAVE = tuple(2.0 ** (-level / STEPS_PER_OCTAVE) for level in range(STEPS_PER_OCTAVE))  #: the first of them
#: levels by which a step may grow at once; of a loose stack, whose corners rattle
GROWTH, GROWTH_OF_STACK = 3, 6
#: levels where steps are eager, and the share of the allowed imbalance up to which they then grow
EAGER_GROWTH, EAGER_SHARE = 6, 0.5
AT_LIMIT = 1e-6  #: share of static friction that is left, below which the support has reached its limit
#: the whole ledger aims at these shares of the final limits of gain and loss; above `AIM_SHARE` of the aim, a step uses
GAIN_AIM, LOSS_AIM, AIM_SHARE = 0.3, 0.9, 0.4
#: at most this share of the remainder, and always this share of the allowance of any step
REMAINDER_SHARE, LEAST_ALLOWANCE = 0.1, 1e-4
#: a run that tries more steps than this per 1/p, and per largest step, makes no progress
ATTEMPTS_OF_ROCKING, ATTEMPTS_OF_STEP, ATTEMPTS_SPARE = 1e6, 100.0, 1e6


@inlined
def _rests_beside(state: State, other: int, point: int, distance: float) -> bool:
    """Whether the other base point exists, is closed and nearer than a distance [m]."""
    if other < 0 or other >= state.point.shape[0]:
        return False
    near = abs(state.point[other, 0] - state.point[point, 0]) < distance
    return near and state.point[other, 1] < 0.0


@compiled(inline=True)
def next_step(run: RunState) -> float:
    """The next step [s]: that of the present level, or shorter.

    If a base point is about to touch the floor with more than the closing speed, the step ends where it does, and the
    next one, in which the dashpot acts, is small. A point beside a closed one (a wide base closes point by point) adds
    no mass of its own and is left to the ledger. A step also ends where a sticking joint reaches its limit or a sliding
    one stops, and at each instant of `run.problem.breaks`.
    """
    clock, control, old = run.clock[0], run.problem.control, run.old
    step = step_of_level(control.largest_step, clock.level)
    if step > control.closing_step:
        closes = step  # time until a point touches [s], at most the step
        for i in range(old.point.shape[0]):
            if _rests_beside(old, i - 1, i, control.near) or _rests_beside(old, i + 1, i, control.near):
                continue
            gap, speed, rate = old.point[i, 1], old.descent[i, 0], old.descent[i, 1]
            if gap > 0.0 and speed * closes + 0.5 * max(rate, 0.0) * closes * closes > gap:
                root = speed * speed + 2.0 * rate * gap
                if root > control.closing_speed**2:
                    closes = min(closes, 2.0 * gap / (speed + np.sqrt(root)))
            elif speed > control.closing_speed and -0.5 * control.closing_step * speed < gap <= 0.0:
                closes = 0.0
        due = max(closes, control.closing_step)
        if due < step:  # use a size of the sequence: a body that factors a matrix needs few different sizes
            due_level = step_level(control.largest_step, due)
            step = step_of_level(control.largest_step, due_level)
            if due == control.closing_step:
                clock.level = due_level
    if step > control.event_step:
        switches = step  # time until a joint reaches its limit or stops [s], at most the step
        for j in range(run.joints.shape[0]):
            joint = run.joints[j]
            if joint.sliding == 0:
                left, rate = 1.0 - joint.utilisation, joint.utilisation_rate
                if left < AT_LIMIT:  # it slides at its limit, without having broken loose
                    continue
            else:
                left, rate = abs(joint.slip_velocity), -joint.slip_acceleration
                if joint.slip_velocity < 0.0:
                    rate = -rate
            if rate * switches > left > 0.0:
                switches = left / rate
        due = max(switches, control.event_step)
        if due < step:
            step = step_of_level(control.largest_step, step_level(control.largest_step, due))
    while run.problem.breaks[clock.next_break] <= clock.time:
        clock.next_break += 1
    left = run.problem.breaks[clock.next_break] - clock.time
    if step >= left:
        return left
    if 2.0 * step > left:  # two equal steps instead of a whole one and a sliver
        return 0.5 * left
    return step


@compiled(inline=True)
def allowed_imbalance(run: RunState, step: float, dissipated: float) -> float:
    """Allowed energy error of the attempted step [J].

    It includes a share of the dissipation of this step and of the recent dissipation, so that the ringing after an
    impact is resolved in proportion to the impact; crushing does not ring and is left out. A step that gains energy by
    damping is in error, and excuses nothing. A first touch switches a dashpot on: the error there is of first order in
    the step, so it is compared with the energy that meets the floor.
    """
    control, old, new = run.problem.control, run.old, run.attempt.new
    allowed = control.reference_energy * (control.energy_floor + control.energy_rate * step)
    allowed += control.energy_share * max(dissipated, 0.0)
    allowed += control.recent_share * run.clock[0].recent_dissipation * step / control.recent_time
    closing, closing_beside = False, False
    for i in range(new.point.shape[0]):
        if old.point[i, 1] >= 0.0 and new.point[i, 1] < 0.0:
            beside = _rests_beside(old, i - 1, i, control.near) or _rests_beside(old, i + 1, i, control.near)
            closing = closing or not beside
            closing_beside = closing_beside or beside
    if closing or closing_beside:  # a base that closes point by point shares the allowance
        floor_velocity = run.floor[0, 1]
        relative = floor_velocity * (0.5 * floor_velocity - old.pose[VELOCITY_X])
        share = control.closing_share if closing else control.closing_share / control.base_points
        allowed += share * (old.energy[KINETIC] + control.mass * relative)
    return allowed


@compiled(inline=True)
def ledger_allowance(run: RunState, step: float) -> float:
    """Allowed imbalance of the attempted step in view of the whole ledger [J]; infinite far from its limits.

    Errors of single steps add up: a share of the dissipation may be large compared with the energy to overturn, for
    example when a low container slides far. Above `AIM_SHARE` of the aim a step may use only a share of the remainder,
    so that the ledger converges to its aim. The allowance stays above rounding; 1e5 such steps would reach the limit.
    A gain is worse than a loss, because it drives the motion.
    """
    control, ledger, change = run.problem.control, run.ledger, run.attempt.change
    if change[IMBALANCE] < 0.0:
        aim, used = GAIN_AIM * GAIN_LIMIT * control.reference_energy, -ledger[IMBALANCE]
    else:
        dissipated = dissipation(ledger) + dissipation(change)
        aim = LOSS_AIM * max(LOSS_LIMIT * control.reference_energy, LOSS_SHARE_LIMIT * dissipated)
        used = ledger[IMBALANCE]
    if used + abs(change[IMBALANCE]) < AIM_SHARE * aim:
        return np.inf
    least = control.energy_floor + control.energy_rate * step
    return max(REMAINDER_SHARE * (aim - used), LEAST_ALLOWANCE * control.reference_energy * least)


@compiled
def change_level(level: int, used: float, not_held: bool, most: int = GROWTH) -> int:
    """Level of the next step, given the used share of the allowed imbalance, of third order in the step.

    Shortly after a rejection (`not_held` false) the step grows only if almost nothing was used.
    """
    if used > 8.0:
        return level + 2 * STEPS_PER_OCTAVE
    if used > 1.0:
        return level + STEPS_PER_OCTAVE
    if used > 0.7:
        return level + 1
    if used < 0.002:
        return max(level - most, 0)
    if used < 0.02:
        return max(level - GROWTH, 0)
    if used < 0.05 and not_held:
        return max(level - 2, 0)
    if used < 0.15 and not_held:
        return max(level - 1, 0)
    return level


@compiled(inline=True)
def grown_level(level: int, used: float, not_held: bool) -> int:
    """`change_level` after an accepted step where steps are eager: the imbalance doubles from level to level.

    The step grows until it would be about half the allowed one; soon after a rejection, by one level.
    """
    if used > 0.7:
        return level + 1
    most = EAGER_GROWTH if not_held else 1
    room = most if used <= 0.0 else math.frexp(EAGER_SHARE / used)[1] - 1
    return max(level - max(min(room, most), 0), 0)


@compiled
def step_level(largest_step: float, step: float) -> int:
    """Level of the largest step size that is not above `step`."""
    return max(0, int(np.ceil(STEPS_PER_OCTAVE * np.log2(largest_step / step) - 1e-9)))


@compiled(inline=True)
def step_of_level(largest_step: float, level: int) -> float:
    """Step size of a level; a product, because a power costs as much as the contact of a corner."""
    octave = level // STEPS_PER_OCTAVE
    return math.ldexp(largest_step * OCTAVE[level - octave * STEPS_PER_OCTAVE], -octave)


def most_attempts(control: Control, time: float) -> int:
    """Largest number of attempted steps of a run in `time` [s]; above it, the run makes no progress."""
    rate = max(ATTEMPTS_OF_ROCKING * control.frequency_parameter, ATTEMPTS_OF_STEP / control.largest_step)
    return int(ATTEMPTS_SPARE + rate * time)
