"""Where stops and ties hold a container at rest. No kernel is loaded here."""

import math

from fem.case.case import Case, CaseError
from fem.case.tables.boxes import Box
from fem.case.tables.links import StopTable, TieTable, holder_of
from fem.model.floor import pivot_share
from mesh.container import ContainerMesh

SURELY = 1e-3  #: overlap at the start that no indentation of the floor explains [m]


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
    """Refuse, as a CaseError, a tilt of an undeformed container that overlaps a link, before a model does."""
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
            if left < -SURELY:
                raise overlapped(case, number, -left)
