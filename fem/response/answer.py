"""The answer of a response curve in one sentence: overturning, largest rotation, coexisting motions."""

from fem.batch.answers import slip_in_words
from fem.response.branches import Coexistence, DropOut, Jump
from fem.response.result import ResponseResult
from fem.results.outcome import Outcome
from fem.runtime.units import MILLIMETRES

MOST_RANGES = 3  #: of frequencies that are named


def response_answer(result: ResponseResult) -> str | None:
    """The answer of a response curve; None of an unfinished one and one without an outcome."""
    points = [point for point in result.points if point.status != "failed"]
    if result.state != "finished" or not points:
        return None
    destroyed = [point for point in points if point.motion == Outcome.INVALID]
    standing = [point for point in points if point.rotation_ratio is not None and point not in destroyed]
    frequencies = [point.frequency_Hz for point in points]
    failed = len(result.points) - len(points)
    every = f"every frequency {'with an outcome' if failed else 'tried'}, {_range(min(frequencies), max(frequencies))}"
    fallen = [f"{found_at(found)} going {found.direction}" for found in result.drop_outs]
    if not fallen and not destroyed:
        parts = [f"stood at {every}, up and down"]
    elif not standing and not destroyed:
        parts = [f"overturned at {every}"]
    else:
        parts = [f"overturned at {_listed(fallen)}"] if fallen else []
        if destroyed:
            where = f"{destroyed[0].frequency_Hz:.4g} Hz going {destroyed[0].direction}"
            count = f"{len(destroyed)} point{'s' * (len(destroyed) != 1)}"
            parts.append(f"not valid at {count}, the first at {where}: a corner is destroyed")
        parts += [f"stood at the other {len(standing)} points"] if standing else []
    if standing:
        most = max(standing, key=lambda point: point.rotation_ratio or 0.0)
        turned = f"{most.rotation_ratio:.2g} of the slenderness angle, at {most.frequency_Hz:.4g} Hz"
        resting = all(point.long_time == "rest" for point in standing)
        parts.append("at rest there" if resting else f"largest rotation {turned} going {most.direction}")
        slid = max(standing, key=lambda point: point.slip_stroke_m or 0.0)
        if (slid.slip_stroke_m or 0.0) >= MILLIMETRES.least:
            stroke = slip_in_words(slid.slip_stroke_m or 0.0)
            parts.append(
                f"slid by up to {stroke} a period, at {slid.frequency_Hz:.4g} Hz going {slid.direction}"
            )
    if result.coexisting:
        parts.append(f"two motions coexist at {_listed([found_at(found) for found in result.coexisting])}")
    if failed:
        parts.append(f"no outcome at {failed} of {len(result.points)} points")
    return "frequency: " + "; ".join(parts)


def found_at(found: Coexistence | Jump | DropOut) -> str:
    """The frequencies of a coexistence, a jump or a drop-out, in the order of its sweep."""
    return _range(found.from_Hz, found.to_Hz)


def _range(low: float, high: float) -> str:
    return f"{low:.4g} Hz" if low == high else f"{low:.4g} to {high:.4g} Hz"


def _listed(ranges: list[str]) -> str:
    more = len(ranges) - MOST_RANGES
    return ", ".join(ranges[:MOST_RANGES]) + (f" and {more} more ranges" if more > 0 else "")
