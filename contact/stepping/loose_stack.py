"""Boxes that stand on one another without bolts, as one body: corners of any body over `contact.interface.faces`.

So do stacks beside one another, each a "box" that stands on the floor; the first is the one that a run is about.
The body beneath has the corners of all boxes as its base points, four of each from the floor up, and no compliance
between boxes; in `complete` it writes `State.boxes`. This layer gives the stepping the contact points in their place.
"""

from typing import Any, NamedTuple

from contact.arrays import FloatArray
from contact.interface.faces import (
    Faces,
    condense_points,
    is_of_one_box,
    linearise_points,
    move_corners,
    place_points,
    share_forces,
    weigh_points,
)
from contact.interface.workspace import Contact, Workspace
from contact.layout import exchanging
from contact.stepping import body as interface
from contact.stepping.body import (
    ANGULAR_VELOCITY,
    CENTRE_X,
    CENTRE_Z,
    ROTATION,
    VELOCITY_X,
    VELOCITY_Z,
    Ground,
    State,
    implements,
    passes_on,
)
from contact.stepping.scheme import Scheme
from contact.structs import struct

with_points = exchanging(State, "point", "force")


@struct
class LooseStack(NamedTuple):
    """N boxes on one another, or beside one another."""

    body: Any  #: of all boxes; its base points are their corners
    faces: Faces
    mass: FloatArray  #: (N,) of the boxes [kg]
    tolerance: float  #: error of a contact point at which an iteration stops [m]
    in_a_row: bool  #: the boxes are stacks beside one another
    corners: Workspace  #: scratch, of the corners


passes_on(LooseStack, interface.observe, interface.shift_velocity, interface.prepared)


@implements(interface.weigh, LooseStack, inline=True)
def weigh(stack: LooseStack, contact: Contact, old: State) -> None:
    """Stiffness of the contact points: less where a corner is about to leave its face."""
    weigh_points(stack.faces, old.corner, old.point, contact)


@implements(interface.predict, LooseStack, inline=True)
def predict(stack: LooseStack, scheme: Scheme, step: float, old: State, new: State) -> None:
    """Coordinates after `step`, with derivatives at the old corners: those of an attempt a resumed run has not."""
    interface.predict(stack.body, scheme, step, old, new)
    linearise_points(stack.faces, old.corner, stack.faces.placed)


@implements(interface.release, LooseStack, inline=True)
def release(
    stack: LooseStack, scheme: Scheme, step: float, old: State, new: State, work: Workspace, ground: Ground
) -> None:
    """Contact points at the end of the step without contact force, and their compliance.

    Linearised about the corners under the present forces, not about the free ones: at the last iteration these are
    the forces that are found.
    """
    corners = stack.corners
    interface.release(stack.body, scheme, step, old, new, corners, ground)
    share_forces(stack.faces, work.force, corners.force)
    move_corners(corners)
    linearise_points(stack.faces, corners.point, work.free)
    condense_points(stack.faces, corners, work)


@implements(interface.respond, LooseStack, inline=True)
def respond(stack: LooseStack, scheme: Scheme, step: float, old: State, new: State, work: Workspace) -> float:
    """Apply `work.force` to the iterate; returns the remaining error over its tolerance."""
    corners = stack.corners
    share_forces(stack.faces, work.force, corners.force)
    error = interface.respond(stack.body, scheme, step, old, new, corners)
    move_corners(corners)
    place_points(stack.faces, corners.point, work.trial)
    for i in range(work.trial.shape[0]):
        if is_of_one_box(stack.faces, i) or stack.faces.weight[i] == 0.0:
            continue
        apart = stack.in_a_row and work.trial[i, 1] > 0.0 and work.point[i, 1] > 0.0
        if not apart:  # the sides of a row are seldom where it matters how far they are from each other
            for k in range(2):
                error = max(error, abs(work.trial[i, k] - work.point[i, k]) / stack.tolerance)
    return error


@implements(interface.complete, LooseStack, inline=True)
def complete(stack: LooseStack, new: State, floor: float, lift: float, lift_velocity: float) -> None:
    """Internal forces, contact points, poses and energy at the converged coordinates."""
    share_forces(stack.faces, new.force, stack.corners.force)
    # the body beneath has the corners, and the forces on them, in place of the contact points
    over_corners = with_points(new, point=new.corner, force=stack.corners.force)
    interface.complete(stack.body, over_corners, floor, lift, lift_velocity)
    place_points(stack.faces, new.corner, new.point)
    for i in range(stack.faces.weight.size):
        if stack.faces.weight[i] == 0.0:
            new.point[i, 1] = stack.faces.length[i]
    total = 0.0
    for row in range(6):
        new.pose[row] = 0.0
    for b in range(stack.mass.size):
        total += stack.mass[b]
    for b in range(stack.mass.size):
        for row in (CENTRE_X, CENTRE_Z, VELOCITY_X, VELOCITY_Z):
            new.pose[row] += stack.mass[b] / total * new.boxes[b, row]
    new.pose[ROTATION] = new.boxes[0, ROTATION]
    new.pose[ANGULAR_VELOCITY] = new.boxes[0, ANGULAR_VELOCITY]
