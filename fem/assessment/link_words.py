"""What stops, ties and neighbours did in a run: its records, and one sentence for each."""

import math

from fem.assessment.loose_boxes import leaning_in_words
from fem.case.tables.links import TieTable
from fem.model.links import heights_of_links
from fem.model.model import Model
from fem.results.outcome import SLIDING, Outcome
from fem.results.run_result import LinkResult, NeighbourResult, RunResult, Verdict
from fem.runtime.units import KILONEWTONS, SHORT_MILLIMETRES


def link_results(model: Model) -> tuple[tuple[LinkResult, ...] | None, tuple[LinkResult, ...] | None]:
    """What stops and ties did in a model that was stepped, in the order of the case; None where there are none."""
    case, container = model.case, model.container
    records = model.run.links[len(case.neighbour) :]
    heights = heights_of_links(case, container.elements.nodes[container.nodes])
    results = [
        LinkResult(
            side=link.side,
            height_m=height,
            neighbour=link.neighbour if isinstance(link, TieTable) else None,
            max_force_N=float(record.max_force),
            hits=int(record.hits),
            largest_closing_velocity_m_s=float(record.largest_closing_velocity),
            gap_left_m=float(record.least_gap)
            if math.isinf(record.broken_at) and math.isfinite(record.least_gap)
            else None,
            broken_at_s=None if math.isinf(record.broken_at) else float(record.broken_at),
        )
        for link, height, record in zip(case.links, heights, records, strict=True)
    ]
    stops = len(case.stop)
    return tuple(results[:stops]) or None, tuple(results[stops:]) or None


def links_in_words(result: RunResult) -> str:
    """What each stop, tie and neighbour did, without a full stop; empty where there are none."""
    stops, ties = result.stops or (), result.ties or ()
    beside = enumerate((result.verdict or Verdict()).neighbours or (), 1)
    return "; ".join(
        [
            *(_of_stop(stop) for stop in stops),
            *(_of_tie(tie) for tie in ties),
            *(_of_neighbour(number, neighbour) for number, neighbour in beside),
        ]
    )


def fall_in_row(verdict: Verdict) -> str:
    """Who overturned first in a row, and when; empty where there are no neighbours or none of them did."""
    fallen = [
        (neighbour.overturned_at_s, number, neighbour)
        for number, neighbour in enumerate(verdict.neighbours or (), 1)
        if neighbour.overturned_at_s is not None
    ]
    if not fallen:
        return ""
    at, number, neighbour = min(fallen)
    if verdict.leans:
        return leaning_in_words(_neighbour(number, neighbour), verdict)
    return f"{_neighbour(number, neighbour)} overturned at t = {at:.3f} s, where the run ends"


def _neighbour(number: int, neighbour: NeighbourResult) -> str:
    return f"neighbour {number} on the {neighbour.side}"


def _of_neighbour(number: int, neighbour: NeighbourResult) -> str:
    ratio = f", rotation ratio {neighbour.rotation_ratio:.3f}" if neighbour.overturned_at_s is None else ""
    slip = f", slip {1e3 * neighbour.max_slip_m:.3g} mm" if Outcome(neighbour.outcome) in SLIDING else ""
    did = Outcome(neighbour.outcome).verb.replace(", ", " and ")
    moved = f"{_neighbour(number, neighbour)} {did}{ratio}{slip}"
    if neighbour.hits == 0:
        return f"{moved}, not touched{_left(neighbour, 'gap')}"
    hits = "once" if neighbour.hits == 1 else f"{neighbour.hits} times"
    speed = f"{neighbour.largest_closing_velocity_m_s:.2g} m/s"
    return f"{moved}, hit {hits}, at {speed} at most, with up to {KILONEWTONS.text(neighbour.max_force_N, figures=3)}"


def _of_stop(stop: LinkResult) -> str:
    name = f"the stop on the {stop.side} at {stop.height_m:g} m"
    if stop.max_force_N == 0.0:
        return f"{name} was not touched{_left(stop, 'gap')}"
    hits = "once" if stop.hits == 1 else f"{stop.hits} times"
    words = f"{name} was hit {hits}, at {stop.largest_closing_velocity_m_s:.2g} m/s at most, with up to {_force(stop)}"
    return words + _broken(stop)


def _of_tie(tie: LinkResult) -> str:
    of = f" of neighbour {tie.neighbour}" if tie.neighbour else ""
    name = f"the tie{of} on the {tie.side} at {tie.height_m:g} m"
    if tie.max_force_N == 0.0:
        return f"{name} stayed slack{_left(tie, 'slack')}"
    return f"{name} carried up to {_force(tie)}{_broken(tie)}"


def _left(link: LinkResult | NeighbourResult, what: str) -> str:
    return (
        ""
        if link.gap_left_m is None
        else f", {SHORT_MILLIMETRES.text(link.gap_left_m)} of the {what} was left"
    )


def _force(link: LinkResult) -> str:
    return KILONEWTONS.text(link.max_force_N, figures=3)


def _broken(link: LinkResult) -> str:
    return "" if link.broken_at_s is None else f", and broke at t = {link.broken_at_s:.3f} s"
