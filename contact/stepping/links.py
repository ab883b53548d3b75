"""Stops and ties: unilateral links between points of a container and its floor, as further contact points of a body.

A link acts along a fixed line. Seen from it, its point has the coordinates of a contact point: the gap along the line,
and a place across it. A stop is a wall that moves with the floor; its line is horizontal and leads away from the wall.
A tie pulls down, so its line leads down: its gap is the slack that is left, and it holds the point from above as a wall
would. All laws, the solver and the ledger are then those of the floor: spring and dashpot that never pull, and Coulomb
friction across the line. The points of the links are the last of a body; of a loose stack or a row each is on a side
of one box (`contact.interface.faces.SidePoint`).

The cap of a link is its strength. A link that reaches it breaks at the end of the step: its point gets the indentation
`BROKEN`, and never touches again. What its springs held is part of the contact damping.

This layer turns the points for the stepping; bodies without links are stepped without it.
"""

from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload

from contact.arrays import FloatArray, IntArray
from contact.interface.workspace import Workspace
from contact.jit import compiled, inlined, options_of_piece
from contact.stepping import body as interface
from contact.stepping.body import CENTRE_X, CENTRE_Z, Ground, State, implements
from contact.stepping.ledger import CONTACT_DAMPING, CRUSHING
from contact.stepping.observables import NEVER
from contact.stepping.scheme import Scheme
from contact.stepping.state import RunState
from contact.structs import struct

#: columns of `LinkedBody.line`: direction along x and z in which the point may go, what is added to its places, and the
#: box of a loose stack or the body of a row that has it
ALONG_X, ALONG_Z, ACROSS, GAP, BOX = 0, 1, 2, 3, 4
BROKEN = 1e6  #: indentation of the point of a broken link [m]
#: distance of the points of links from those of the base, and from those before and behind, in widths of the container:
#: near ones close as one (`contact.stepping.control`), further ones would be less precise
APART = 4.0


@struct
class LinkedBody(NamedTuple):
    """A body whose last k contact points are those of links."""

    body: Any
    line: FloatArray  #: (k, 5), see `ALONG_X`


def _leave_to_the_body(operation: Any) -> None:
    @implements(operation, LinkedBody, inline=True)
    def beneath(links: Any, *arguments: Any) -> Any:
        return operation(links.body, *arguments)


for shared in (
    interface.weigh,
    interface.predict,
    interface.observe,
    interface.shift_velocity,
    interface.prepared,
    interface.stands_loose,
):
    _leave_to_the_body(shared)


def make_lines(
    direction: FloatArray, place: FloatArray, gap: FloatArray, width: float, box: IntArray | None = None
) -> FloatArray:
    """The lines of k links, (k, 5).

    Args:
        direction: (k, 2) unit vectors that lead away from what holds the point.
        place: (k, 2) of the points where the gaps are these [m]; gap: (k,) [m].
        width: of the container [m]; points across their lines are told from those of the base by it.
        box: (k,) that has the point, of a loose stack or a row.
    """
    across = direction[:, 1] * place[:, 0] - direction[:, 0] * place[:, 1]
    # a mirror image turns the sign
    apart = APART * width * (1.0 + np.arange(len(place)) % 2) * np.where(direction[:, 0] > 0.0, -1.0, 1.0)
    along = np.einsum("kc,kc->k", direction, place)
    return np.column_stack(
        [direction, apart - across, gap - along, np.zeros(len(place)) if box is None else box]
    )


def links_of(body: Any) -> Any:
    """A body with links; None for one without: what is not for None is not compiled for it."""
    return body if getattr(body, "line", None) is not None else None


@overload(links_of, strict=False, jit_options=options_of_piece(True))
def _links_of(body: Any) -> Any:
    return (lambda body: body) if "line" in getattr(body, "fields", ()) else (lambda body: None)


@inlined
def turn_in(line: FloatArray, pairs: FloatArray) -> None:
    """Turn the vectors at the links, the last rows of (n, 2), from x and z to across and along their lines."""
    first = pairs.shape[0] - line.shape[0]
    for k in range(line.shape[0]):
        x, z = pairs[first + k, 0], pairs[first + k, 1]
        along_x, along_z = line[k, ALONG_X], line[k, ALONG_Z]
        pairs[first + k, 0] = along_z * x - along_x * z
        pairs[first + k, 1] = along_x * x + along_z * z


@inlined
def turn_out(line: FloatArray, pairs: FloatArray) -> None:
    """The reverse of `turn_in`."""
    first = pairs.shape[0] - line.shape[0]
    for k in range(line.shape[0]):
        across, along = pairs[first + k, 0], pairs[first + k, 1]
        along_x, along_z = line[k, ALONG_X], line[k, ALONG_Z]
        pairs[first + k, 0] = along_z * across + along_x * along
        pairs[first + k, 1] = along_z * along - along_x * across


@inlined
def place_in(line: FloatArray, point: FloatArray) -> None:
    """Turn points (n, 2) over the floor as `turn_in`, and measure them from where the links begin to hold."""
    turn_in(line, point)
    first = point.shape[0] - line.shape[0]
    for k in range(line.shape[0]):
        point[first + k, 0] += line[k, ACROSS]
        point[first + k, 1] += line[k, GAP]


place_links = compiled(place_in)


@implements(interface.release, LinkedBody, inline=True)
def release(
    links: LinkedBody, scheme: Scheme, step: float, old: State, new: State, work: Workspace, ground: Ground
) -> None:
    """Points at the end of the step without contact force, and their compliance."""
    turn_out(links.line, work.force)
    interface.release(links.body, scheme, step, old, new, work, ground)
    turn_in(links.line, work.force)
    place_in(links.line, work.free)
    turn_in(links.line, work.free_velocity)
    first = work.free.shape[0] - links.line.shape[0]
    for k in range(links.line.shape[0]):
        row, along_x, along_z = 2 * (first + k), links.line[k, ALONG_X], links.line[k, ALONG_Z]
        for j in range(work.compliance.shape[1]):
            x, z = work.compliance[row, j], work.compliance[row + 1, j]
            work.compliance[row, j] = along_z * x - along_x * z
            work.compliance[row + 1, j] = along_x * x + along_z * z
    for k in range(links.line.shape[0]):
        column, along_x, along_z = 2 * (first + k), links.line[k, ALONG_X], links.line[k, ALONG_Z]
        for j in range(work.compliance.shape[0]):
            x, z = work.compliance[j, column], work.compliance[j, column + 1]
            work.compliance[j, column] = along_z * x - along_x * z
            work.compliance[j, column + 1] = along_x * x + along_z * z


@implements(interface.respond, LinkedBody, inline=True)
def respond(links: LinkedBody, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
    """Apply `work.force` to the iterate; returns the remaining error over its tolerance."""
    turn_out(links.line, work.force)
    error = interface.respond(links.body, scheme, step, old, new, work)
    turn_in(links.line, work.force)
    return error


@implements(interface.complete, LinkedBody, inline=True)
def complete(links: LinkedBody, new: State, floor: float, lift: float, lift_velocity: float) -> None:
    """Internal forces, points, pose and energy at the converged coordinates."""
    turn_out(links.line, new.force)
    interface.complete(links.body, new, floor, lift, lift_velocity)
    turn_in(links.line, new.force)
    place_in(links.line, new.point)


@inlined
def push_of_links(run: RunState, links: LinkedBody | None) -> float:
    """Force of all links along x, mean over the attempted step [N]."""
    push = 0.0
    if links is not None:
        line = links.line
        old, new = run.old.force, run.attempt.new.force
        first = new.shape[0] - line.shape[0]
        for k in range(line.shape[0]):
            across = 0.5 * (old[first + k, 0] + new[first + k, 0])
            along = 0.5 * (old[first + k, 1] + new[first + k, 1])
            push += line[k, ALONG_Z] * across + line[k, ALONG_X] * along
    return push


@inlined
def load_of_links(
    run: RunState, links: LinkedBody | None, box: int, pose: FloatArray
) -> tuple[float, float, float]:
    """Force of the links of a box with this pose, x and z [N], and its moment about its centre [Nm]."""
    x, z, moment = 0.0, 0.0, 0.0
    if links is not None:
        line = links.line
        new = run.attempt.new
        first = new.point.shape[0] - line.shape[0]
        for k in range(line.shape[0]):
            i, own = first + k, line[k]
            if own[BOX] == box and new.force[i, 1] != 0.0:
                across, along = new.force[i, 0], new.force[i, 1]
                place, gap = new.point[i, 0] - own[ACROSS], new.point[i, 1] - new.crushed[i] - own[GAP]
                force_x = own[ALONG_Z] * across + own[ALONG_X] * along
                force_z = own[ALONG_Z] * along - own[ALONG_X] * across
                arm_x = own[ALONG_Z] * place + own[ALONG_X] * gap + run.floor[1, 0] - pose[CENTRE_X]
                arm_z = own[ALONG_Z] * gap - own[ALONG_X] * place + run.lift[1, 0] - pose[CENTRE_Z]
                x += force_x
                z += force_z
                moment += arm_z * force_x - arm_x * force_z
    return x, z, moment


@inlined
def shift_links(
    run: RunState, links: LinkedBody | None, turn: float, x: float, z: float, begin: int, end: int
) -> None:
    """Subtract the velocity of a turn [rad/s] about a place over the floor from the points of some boxes.

    Called between `complete` and `indent`, where points have no indentation; `end` is behind the last box.
    """
    if links is not None:
        line = links.line
        new = run.attempt.new
        first = new.point.shape[0] - line.shape[0]
        for k in range(line.shape[0]):
            i, own = first + k, line[k]
            if own[BOX] < begin or own[BOX] >= end:
                continue
            place, gap = new.point[i, 0] - own[ACROSS], new.point[i, 1] - own[GAP]
            speed_x = turn * (own[ALONG_Z] * gap - own[ALONG_X] * place - z)
            speed_z = -turn * (own[ALONG_Z] * place + own[ALONG_X] * gap - x)
            new.drift[i, 0] -= own[ALONG_Z] * speed_x - own[ALONG_X] * speed_z
            new.descent[i, 0] += own[ALONG_X] * speed_x + own[ALONG_Z] * speed_z


@inlined
def reach_strength(run: RunState, links: LinkedBody | None) -> bool:
    """Whether a link is at its strength at the end of the attempted step."""
    reached = False
    if links is not None:
        line = links.line
        n = run.attempt.new.point.shape[0]
        for i in range(n - line.shape[0], n):
            reached = reached or run.work.law[i, 1] >= run.problem.contact.cap[i]
    return reached


@inlined
def follow_touch(record: Any, force: float, gaps: tuple[float, float], speed: float, apart: float) -> None:
    """Update the record of a link or a gap from its force [N] and its gaps before and after the step [m].

    A touch with this closing speed [m/s] is another hit where the gap has been more than `apart` [m] since the last.
    """
    before, gap = gaps
    record.max_force = max(record.max_force, force)
    if record.broken_at == NEVER:
        record.least_gap = min(record.least_gap, max(gap, 0.0))
        if gap > 0.0 and record.away < NEVER:
            record.away = max(record.away, gap)
    # what begins without a gap may begin a rounding error closed
    if gap < 0.0 and (before >= 0.0 or record.away == NEVER):
        record.largest_closing_velocity = max(record.largest_closing_velocity, speed)
        if record.away > apart:
            record.hits += 1
        record.away = 0.0


@inlined
def follow_links(run: RunState, step: float, links: LinkedBody | None, apart: float) -> None:
    """Update the records of the links from the step about to be accepted, and break those at their strength."""
    if links is not None:
        line, contact = links.line, run.problem.contact
        old, new, change = run.old, run.attempt.new, run.attempt.change
        first, before = new.point.shape[0] - line.shape[0], run.links.shape[0] - line.shape[0]
        for k in range(line.shape[0]):
            i, record = first + k, run.links[before + k]
            gaps = old.point[i, 1], new.point[i, 1]
            # the velocity of a touch at t = 0 follows from the step alone
            speed = max(old.descent[i, 0], (gaps[0] - gaps[1]) / step)
            follow_touch(record, new.force[i, 1], gaps, speed, apart)
            # what its springs held, and yielded in this step, is damping
            if run.work.law[i, 1] >= contact.cap[i]:
                yielded = 0.5 * (old.force[i, 1] + new.force[i, 1]) * (new.crushed[i] - old.crushed[i])
                held = 0.5 * contact.normal_stiffness[i] * new.point[i, 1] ** 2
                held += 0.5 * contact.tangential_stiffness[i] * new.stick[i] ** 2
                change[CRUSHING] -= yielded
                change[CONTACT_DAMPING] += yielded + held
                new.crushed[i] += BROKEN
                new.point[i, 1] += BROKEN
                new.stick[i] = 0.0
                record.broken_at = run.clock[0].time + step
