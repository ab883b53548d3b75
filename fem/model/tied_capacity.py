"""Where stops and ties hold a container at rest, and what ties add to its static capacity. No kernel is loaded here."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.case.case import Case, CaseError
from fem.case.tables.boxes import Box
from fem.case.tables.links import StopTable, TieTable, faced_by, holder_of
from fem.case.tables.neighbours import gap_beside
from fem.model.floor import pivot_share
from fem.runtime.arrays import FloatArray
from mesh.container import ContainerMesh

MOST_TURNED, TURNS = 0.5 * math.pi, 2_001  #: rotations at which a capacity is sought [rad]
SURELY = 1e-3  #: overlap at the start that no indentation of the floor explains [m]
BISECTIONS = 40  #: of the rotation at which a tie reaches its strength


def box_at(case: Case, height: float) -> Box:
    """The lowest box whose side reaches to a height above the floor [m]."""
    return next((box for box in case.stack if height <= box.top * (1.0 + 1e-9)), case.stack[-1])


def side_of(case: Case, link: StopTable | TieTable) -> float:
    """x of the side where a link is, of a row from the axis of the container that it holds [m]."""
    held = holder_of(case, link)
    left, right = box_at(case.row[held] if held else case, link.height_m).sides
    return left if link.side == "left" else right


def direction_of(link: StopTable | TieTable) -> tuple[float, float]:
    """Direction in which the point of a link may go: away from a stop, to where a tie is held."""
    outward = -1.0 if link.side == "left" else 1.0
    if isinstance(link, StopTable):
        return -outward, 0.0
    return (outward, 0.0) if link.to == "wall" else (0.0, -1.0)


def overlapped(case: Case, number: int, overlap: float) -> CaseError:
    """What to say of a link, by its number from 1 among all of a case, that is overlapped at the start [m]."""
    link = case.links[number - 1]
    own = number if isinstance(link, StopTable) else number - len(case.stop)
    name, key = ("stop", "gap_m") if isinstance(link, StopTable) else ("tie", "slack_m")
    return CaseError(
        f"[{name}] {name} {own}: {key} = {link.slack:g} m is overlapped by {overlap:.3g} m at the start, as the "
        "container stands in its initial rotation; take a wider one, or another [initial]"
    )


def require_room(case: Case, mesh: ContainerMesh) -> None:
    """Refuse a tilt that overlaps a link, before a model does: of an undeformed container on its corner.

    Raises:
        CaseError: with the first that is overlapped.
    """
    turn = case.initial.rotation_rad
    corner = math.copysign(0.5 * pivot_share(case, mesh) * mesh.width, turn)
    for number, link in enumerate(case.links, 1):
        if turn and not case.container.is_loose and not holder_of(case, link):
            x, z = side_of(case, link) - corner, link.height_m
            moved = (
                x * (math.cos(turn) - 1.0) + z * math.sin(turn),
                z * (math.cos(turn) - 1.0) - x * math.sin(turn),
            )
            along_x, along_z = direction_of(link)
            left = link.slack + along_x * moved[0] + along_z * moved[1]
            other = faced_by(case, link)
            if isinstance(link, TieTable) and other is not None:
                ahead = math.copysign(gap_beside(case, 0, other), -1.0 if link.side == "left" else 1.0)
                up = link.other_height - link.height_m
                length = math.hypot(ahead - moved[0], up - moved[1])
                left = link.slack + math.hypot(ahead, up) - length
            if left < -SURELY:
                raise overlapped(case, number, -left)


@dataclass(frozen=True, kw_only=True)
class TiedCapacity:
    """The largest static moment about a corner that weight and ties resist, while the container turns slowly."""

    side: str  #: toward which it turns
    moment: float  #: [Nm]
    rotation: float  #: at which [rad]
    free: float  #: of the weight alone, at no rotation [Nm]
    broken: bool  #: whether a tie breaks there

    def to_json(self) -> dict[str, Any]:
        """Keys with units."""
        return {
            "side": self.side,
            "moment_Nm": self.moment,
            "rotation_rad": self.rotation,
            "moment_without_Nm": self.free,
            "tie_breaks": self.broken,
        }


def tied_capacities(case: Case, mesh: ContainerMesh) -> list[TiedCapacity]:
    """The capacity toward each side; none where the case has no such ties, or they need not hold all loose boxes.

    Ties to a neighbour are left out: it moves with the same floor, and what it can hold depends on how. A tie whose
    point moves away by u carries k (u - slack), up to its strength, and then no more.
    """
    capacities = []
    ties = [tie for tie in case.tie if tie.to != "neighbour" and not tie.neighbour]
    for side, sign in (("left", -1.0), ("right", 1.0)) if ties and not case.container.is_loose else ():
        corner = 0.5 * pivot_share(case, mesh) * mesh.width
        arm = corner - sign * mesh.centroid[0]
        weight = mesh.mass * case.gravity_toward_floor
        downhill = sign * mesh.mass * case.gravity_downhill  # x falls toward +x
        beside = [corner - sign * side_of(case, tie) for tie in ties]
        rotation = np.linspace(0.0, MOST_TURNED, TURNS)
        breaking = [_breaks_at(tie, side, at, rotation) for tie, at in zip(ties, beside, strict=True)]
        rotation = np.sort(np.concatenate([rotation, *breaking]))
        moment = weight * (arm * np.cos(rotation) - mesh.centroid[1] * np.sin(rotation))
        moment -= downhill * (mesh.centroid[1] * np.cos(rotation) + arm * np.sin(rotation))
        breaks = np.zeros(rotation.size, dtype=bool)
        for tie, distance in zip(ties, beside, strict=True):
            force, lever = _pull(tie, side, distance, rotation)
            if tie.strength_N is not None:
                broken = np.logical_or.accumulate(force > tie.strength_N)
                breaks |= np.append(broken[1:] & ~broken[:-1], False)
                force[broken] = 0.0
            moment += force * lever
        most = int(np.argmax(moment))
        capacities.append(
            TiedCapacity(
                side=side,
                moment=float(moment[most]),
                rotation=float(rotation[most]),
                free=float(weight * arm - downhill * mesh.centroid[1]),
                broken=bool(breaks[most]),
            )
        )
    return capacities


def _pull(tie: TieTable, side: str, beside: float, rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Force of a tie that does not break [N], and its lever about the corner [m].

    Args:
        tie: it; side: toward which the container turns.
        beside: of its point from the corner, against the turn [m].
        rotation: [rad].
    """
    up = beside * np.sin(rotation) + tie.height_m * np.cos(rotation)
    ahead = beside * (1.0 - np.cos(rotation)) + tie.height_m * np.sin(rotation)
    away, lever = up - tie.height_m, beside - ahead
    if tie.to == "wall":
        away, lever = (-ahead, -up) if tie.side == side else (ahead, up)
    return tie.stiffness_N_m * np.maximum(away - tie.slack_m, 0.0), lever


def _breaks_at(tie: TieTable, side: str, beside: float, rotation: FloatArray) -> FloatArray:
    """The rotation at which a tie reaches its strength, or none [rad]."""
    force, _ = _pull(tie, side, beside, rotation)
    if tie.strength_N is None or force.max() <= tie.strength_N:
        return rotation[:0]
    over = np.flatnonzero(force > tie.strength_N)
    low, high = rotation[over[0] - 1], rotation[over[0]]
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        strong = float(_pull(tie, side, beside, np.array([middle]))[0][0]) > tie.strength_N
        low, high = (low, middle) if strong else (middle, high)
    return np.array([low])
