"""How large the next step is, and how much energy it may lose or win.

Steps are a ladder h = largest / 2^(level/3). A step ends where a gap closes or a motion breaks; what closes, breaks
loose or comes to a halt is met with small steps; beyond that the energy ledger decides.
"""

import math
from typing import Any

import numpy as np
from numba.extending import register_jitable

from contact.jit import compiled
from contact.stepping.body import KINETIC, VELOCITY_X, State
from contact.stepping.ledger import (
    CONTACT_DAMPING,
    FRICTION,
    GAIN_LIMIT,
    IMBALANCE,
    LOSS_LIMIT,
    LOSS_SHARE_LIMIT,
    MATERIAL_DAMPING,
)
from contact.stepping.state import Control, Run

STEPS_PER_OCTAVE = 3  #: of the ladder of step sizes
OCTAVE = tuple(2.0 ** (-level / STEPS_PER_OCTAVE) for level in range(STEPS_PER_OCTAVE))  #: its first steps
NEIGHBOUR = 0.25  #: base points nearer than this, over the width, close as one
#: the ledger as a whole keeps below these shares of what may be won and lost in the end, for which it holds the steps
#: small from that share of them on ..
GAIN_AIM, LOSS_AIM, AIM_SHARE = 0.3, 0.9, 0.4
#: .. by the share of what is left that one step may use, and of what any step may have that it may use always
REMAINDER_SHARE, LEAST_ALLOWANCE = 0.1, 1e-4
#: a run that tries more steps than so many each 1/p, and each largest step, makes no headway
ATTEMPTS_OF_ROCKING, ATTEMPTS_OF_STEP, ATTEMPTS_SPARE = 1e6, 100.0, 1e6


@register_jitable(forceinline=True)
def _rests_beside(state: State, other: int, point: int, width: float) -> bool:
    """Another base point, if there is one, is closed and near."""
    if other < 0 or other >= state.point.shape[0]:
        return False
    near = abs(state.point[other, 0] - state.point[point, 0]) < NEIGHBOUR * width
    return near and state.point[other, 1] < 0.0


@compiled(inline=True)
def closing_time(control: Control, state: State, horizon: float) -> float:
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


@compiled(inline=True)
def switching_time(clock: Any, horizon: float) -> float:
    """Time until the stuck support reaches its limit, or the sliding one comes to a halt [s], or the horizon."""
    if clock.sliding == 0:
        left, rate = 1.0 - clock.utilisation, clock.utilisation_rate
    else:
        left, rate = abs(clock.slip_velocity), -clock.slip_acceleration
        if clock.slip_velocity < 0.0:
            rate = -rate
    return left / rate if rate * horizon > left > 0.0 else horizon


@compiled(inline=True)
def next_step(run: Run) -> float:
    """The next step [s]: the ladder's at the present level, unless something is due before.

    A gap about to close: the step ends where it closes, and the next one, on which the dashpot works, is small.
    An instant that a step must end on: the step ends there.
    """
    clock, control = run.clock[0], run.control
    step = step_of_level(control.largest_step, clock.level)
    if step > control.closing_step:
        due = max(closing_time(control, run.old, step), control.closing_step)
        if (
            due < step
        ):  # on the ladder, just short of it: a new step size is dear to a body that factors a matrix
            due_level = step_level(control.largest_step, due)
            step = step_of_level(control.largest_step, due_level)
            if due == control.closing_step:
                clock.level = due_level
    if step > control.event_step:
        due = max(switching_time(clock, step), control.event_step)
        if due < step:
            step = step_of_level(control.largest_step, step_level(control.largest_step, due))
    while run.breaks[clock.next_break] <= clock.time:
        clock.next_break += 1
    left = run.breaks[clock.next_break] - clock.time
    if step >= left:
        return left
    if 2.0 * step > left:  # two equal steps instead of a whole one and a sliver
        return 0.5 * left
    return step


@compiled(inline=True)
def allowed_imbalance(run: Run, step: float, dissipated: float) -> float:
    """Energy that the step attempted may lose or win [J].

    A share of what it dissipates, and of what was dissipated shortly before: while an impact rings down, the
    ringing is resolved as well as the impact deserves.
    A first touch switches a dashpot on: what the scheme loses there falls with the step itself only, so it is held
    against the energy that meets the floor.
    """
    control, old, new = run.control, run.old, run.new
    allowed = control.reference_energy * (control.energy_floor + control.energy_rate * step)
    allowed += control.energy_share * abs(dissipated)
    allowed += control.recent_share * run.clock[0].recent_dissipation * step / control.recent_time
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


@compiled(inline=True)
def ledger_allowance(run: Run, step: float) -> float:
    """Imbalance that the ledger as a whole has room for in the step attempted [J]; infinite far from its limits.

    What one step may lose or win adds up: a share of what it dissipates may be much against the energy to overturn, as
    when a low container slides far. From `AIM_SHARE` on a step may use a share of what is left only, so that the
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
    if used + abs(change[IMBALANCE]) < AIM_SHARE * aim:
        return np.inf
    least = control.energy_floor + control.energy_rate * step
    return max(REMAINDER_SHARE * (aim - used), LEAST_ALLOWANCE * control.reference_energy * least)


@compiled
def change_level(level: int, used: float, not_held: bool) -> int:
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


@compiled
def step_level(largest_step: float, step: float) -> int:
    """Level of the largest step of the ladder that is not above `step`."""
    return max(0, int(np.ceil(STEPS_PER_OCTAVE * np.log2(largest_step / step) - 1e-9)))


@compiled(inline=True)
def step_of_level(largest_step: float, level: int) -> float:
    """Step of that level of the ladder; as a product, for a power costs as much as the contact of a corner."""
    octave = level // STEPS_PER_OCTAVE
    return math.ldexp(largest_step * OCTAVE[level - octave * STEPS_PER_OCTAVE], -octave)


def most_attempts(control: Control, time: float) -> int:
    """Steps, accepted and rejected, that a run may have tried in `time` [s]; beyond, it is stuck."""
    rate = max(ATTEMPTS_OF_ROCKING * control.frequency_parameter, ATTEMPTS_OF_STEP / control.largest_step)
    return int(ATTEMPTS_SPARE + rate * time)
