"""Other containers beside that of a case: tables [[neighbour]], their rules, and what stands in the row.

They stand under the same motion of the floor, each on the floor for itself; where two face each other their sides touch
once the gap is used up. The tables of a side go outward: the first stands next to the container, the second behind it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Annotated, Any, Literal

from pydantic import Strict

from fem.case.tables import quantities as q
from fem.case.tables.boxes import centroid_at
from fem.case.tables.problem import Rule, left_out
from fem.case.tables.table import CaseTable, case_key, optional_key

MOST_NEIGHBOURS = 5
USUAL_DAMPING = 2.0  #: damping ratio of what is struck, where nothing is said: it does not bounce
#: of the case that a neighbour names, what is taken of it; all else is that of the row
ITS_TABLES = ("container", "support", "joints")
CORNER_PATCH = "corner_patch_m"
#: of [contact], the law of friction, which the row has in common
LAW = ("friction", "regularisation_velocity_m_s", "stribeck_velocity_m_s")
#: keys that a neighbour may have other than the container; mass_kg replaces what gives the mass there
OWN = ("boxes", "width_m", "height_m", "mass_kg", "centroid_m", "wall_m")


class StruckTable(CaseTable):
    """What stands beside the container and may be struck: another container, or a stop (`fem.case.tables.links`)."""

    side: Literal["left", "right"] = case_key("of the container at which it stands", example="right")
    gap_m: Annotated[float, q.GAP] = case_key("between it and what it stands beside, at rest", example=0.05)
    stiffness_N_m: Annotated[float, q.LINK_STIFFNESS] = case_key("where it is struck", example=1e8)
    damping_ratio: Annotated[float, q.CONTACT_DAMPING] | None = optional_key(
        "c/(2 sqrt(k m)), m the mass that strikes, of two containers the reduced one, on this stiffness k; default: 2",
        0.5,
    )
    restitution: Annotated[float, q.STOP_RESTITUTION] | None = optional_key(
        "in place of damping_ratio: of what strikes it without turning", 0.5
    )
    mu: Annotated[float, q.FRICTION] = case_key("of friction along its face", 0.0)

    rules = (
        Rule(
            ".restitution",
            lambda struck: struck.restitution is None or struck.damping_ratio is None,
            "and damping_ratio say the same; keep one of them",
        ),
    )


class NeighbourTable(StruckTable):
    """Another container beside it, on the same floor; equal, or that of another case, but for what is given here.

    The stiffness is that of the two sides, over all their height: half of it at their top, half at their foot.
    """

    case: str | None = optional_key(
        "file beside this one, or shipped case, whose container it is; default: as [container]", "other.toml"
    )
    boxes: Annotated[int, Strict(), q.BOXES] | None = optional_key(
        "as all below by default as the container", 4
    )
    width_m: Annotated[float, q.LENGTH] | None = optional_key("of one box", 1.1)
    height_m: Annotated[float, q.LENGTH] | None = optional_key("of one box", 1.0)
    mass_kg: Annotated[float, q.MASS] | None = optional_key("of one box with its fill", 2500.0)
    centroid_m: Annotated[float, q.LENGTH] | None = optional_key("height of the mass centre in its box", 0.5)
    wall_m: Annotated[float, q.WALL] | None = optional_key("of the shell", 0.008)


def case_of(case: Any, neighbour: NeighbourTable | None) -> dict[str, Any]:
    """What to set in a case so that it is that of one stack of its row alone; None: of the container itself."""
    alone: dict[str, Any] = {"neighbour": [], "stop": [], "tie": []}
    if neighbour is None:
        return alone
    given = {name: getattr(neighbour, name) for name in OWN}
    alone |= {f"initial.{name}": 0.0 for name in type(case.initial).model_fields}
    if neighbour.width_m is not None:  # the mass lies as unevenly in it
        share = neighbour.width_m / case.container.width_m
        alone["container.eccentricity_m"] = case.container.eccentricity_m * share
    if neighbour.height_m is not None:
        alone["container.centroid_m"] = centroid_at(case.container, neighbour.height_m)
    return alone | {f"container.{name}": value for name, value in given.items() if value is not None}


def beside(row: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """What a case of a row would hold if its container were that of another case on the same floor.

    Args:
        row: what the case of the row holds.
        own: what the other one holds.
    """
    kept = {name: row[name] for name in row.keys() - {"uncertainty", "document", "stop", "tie", "title"}}
    laws = {key: value for key, value in row["contact"].items() if key in LAW}
    contact = {key: value for key, value in own["contact"].items() if key not in LAW}
    floor = {key: value for key, value in row.get("floor", {}).items() if key != CORNER_PATCH}
    patch = {key: value for key, value in own.get("floor", {}).items() if key == CORNER_PATCH}
    others = [{key: value for key, value in table.items() if key != "case"} for table in row["neighbour"]]
    its = {name: own.get(name, {}) for name in ITS_TABLES}
    return kept | its | {"contact": contact | laws, "floor": floor | patch, "neighbour": others}


@dataclass(frozen=True, kw_only=True)
class Places:
    """Where the N containers of a row stand, that of the case first, and which face each other at each gap."""

    x: tuple[float, ...]  #: (N,) of their axes, from that of the first [m]
    pairs: tuple[tuple[int, int], ...]  #: (N - 1,) left and right one
    distance: tuple[float, ...]  #: (N - 1,) of their axes [m]

    def struck(self, size: Sequence[tuple[float, float]]) -> list[list[tuple[float, float]]]:
        """Points at which the sides of each container are struck, left and right, where it stands on x = 0 [m].

        The upper edge of the lower of two meets the side of the higher one.

        Args:
            size: width and height of each container [m].

        Returns:
            Shape (N, 2, 2).
        """
        points = [[(-0.5 * width, height), (0.5 * width, height)] for width, height in size]
        for left, right in self.pairs:
            lower = min(size[left][1], size[right][1])
            points[left][1], points[right][0] = (0.5 * size[left][0], lower), (-0.5 * size[right][0], lower)
        return points


def places_of(case: Any, widths: Sequence[float]) -> Places:
    """The row of a case, of whose containers these are the widths [m]."""
    x, pairs, distance = [0.0], [], []
    last = {"left": 0, "right": 0}
    for number, neighbour in enumerate(case.neighbour, 1):
        before = last[neighbour.side]
        apart = 0.5 * (widths[before] + widths[number]) + neighbour.gap_m
        x.append(x[before] + (apart if neighbour.side == "right" else -apart))
        pairs.append((before, number) if neighbour.side == "right" else (number, before))
        distance.append(apart)
        last[neighbour.side] = number
    return Places(x=tuple(x), pairs=tuple(pairs), distance=tuple(distance))


def _order(case: Any) -> list[int]:
    """Numbers of the containers of a row from left to right; 0: that of the case itself."""
    row = [0]
    for number, neighbour in enumerate(case.neighbour, 1):
        row.insert(len(row) if neighbour.side == "right" else 0, number)
    return row


def outermost(case: Any, side: str) -> int:
    """Number of the last neighbour on a side of a case; 0, the container itself, where it has none there."""
    return _order(case)[-1 if side == "right" else 0]


def beside_of(case: Any, number: int, side: str) -> int | None:
    """Number of the container of a row beside another one, on a side of that; None where there is none."""
    row = [None, *_order(case), None]
    return row[row.index(number) + (1 if side == "right" else -1)]


def top_of(case: Any, number: int) -> float:
    """Height of a container of the row of a case above the floor, of 0 that of its own [m]."""
    own, neighbour = case.container, case.neighbour[number - 1] if number else None
    if neighbour is not None and neighbour.case is not None:
        return float(case.row[number].stack[-1].top)
    if neighbour is None or (neighbour.boxes is None and neighbour.height_m is None):
        return float(case.stack[-1].top)
    return float((neighbour.boxes or own.boxes) * (neighbour.height_m or own.height_m))


NEIGHBOUR_RULES = (
    Rule(
        "neighbour.",
        lambda case: len(case.neighbour) <= MOST_NEIGHBOURS,
        lambda case: (
            f"stands {len(case.neighbour)} times; a row has six containers at most, so five neighbours"
        ),
    ),
    Rule(
        "solver.model",
        lambda case: not case.neighbour or case.solver.model == "rigid",
        'must be "rigid" with [[neighbour]]: containers in a row are rigid; an elastic one is computed alone',
    ),
    *left_out(
        attrgetter("neighbour"),
        {
            "container.joints": 'must be "bolted" with [[neighbour]]: a side of loose boxes is no straight face',
            "container.mesh_file": "cannot stand beside [[neighbour]]: the sides of a mesh are not known",
            "output.stop_when_overturned": "must be true with [[neighbour]]: what a fallen container strikes is not "
            "modelled; leave it out",
        },
    ),
    Rule(
        "container.box",
        lambda case: not case.neighbour or len({(box.width, box.axis) for box in case.stack}) == 1,
        "cannot stand beside [[neighbour]] unless all boxes have one width and no offset_m: a side must be straight",
    ),
    Rule(
        "support.kind",
        lambda case: not case.neighbour or (case.support.kind == "corners" and case.support.camber_m == 0.0),
        'must be "corners" without camber_m with [[neighbour]]: each container of a row touches the floor with its '
        "corners",
    ),
)
