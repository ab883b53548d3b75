"""Stops, ties and neighbours of a case in words, without a model."""

from fem.case.case import Case
from fem.case.tables.links import StopTable, TieTable
from fem.case.tables.neighbours import NeighbourTable


def link_rows(case: Case) -> list[tuple[str, str]]:
    """Each stop, tie and neighbour of a case: name and what it is."""
    return [
        *(("stop", _stop(stop)) for stop in case.stop),
        *(("tie", _tie(tie)) for tie in case.tie),
        *(("neighbour", _beside(*pair)) for pair in zip(case.neighbour, case.row[1:], strict=True)),
    ]


def _stop(stop: StopTable) -> str:
    where = f"on the {stop.side} at {stop.height_m:g} m, gap {1e3 * stop.gap_m:g} mm"
    return where + _stiffness(stop) + _friction(stop) + _strength(stop)


def _tie(tie: TieTable) -> str:
    to = "level to a wall" if tie.to == "wall" else "down to the floor"
    of = f"of neighbour {tie.neighbour} " if tie.neighbour else ""
    damping = f", damping ratio {tie.damping_ratio:g}" if tie.damping_ratio else ""
    where = f"{of}on the {tie.side} from {tie.height_m:g} m {to}, slack {1e3 * tie.slack_m:g} mm"
    return where + _stiffness(tie) + damping + _strength(tie)


def _beside(table: NeighbourTable, alone: Case) -> str:
    """A neighbour, by its table and its case alone."""
    boxes = f"{alone.container.boxes} box{'es' * (alone.container.boxes > 1)}"
    size = f"{alone.stack[0].width:g} x {alone.stack[-1].top:g} m, {alone.mass:.6g} kg, {boxes}"
    which = "" if table.case is None else f"{table.case}, "
    return f"{which}on the {table.side}, gap {1e3 * table.gap_m:g} mm, {size}{_stiffness(table)}{_friction(table)}"


def _stiffness(link: StopTable | TieTable | NeighbourTable) -> str:
    return f", {1e-3 * link.stiffness_N_m:.6g} kN/m"


def _friction(link: StopTable | NeighbourTable) -> str:
    return f", friction {link.mu:g}" if link.mu else ""


def _strength(link: StopTable | TieTable) -> str:
    return "" if link.strength_N is None else f", breaks at {1e-3 * link.strength_N:.4g} kN"
