"""The answer of a response curve in one sentence: overturning, largest rotation, coexisting motions."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fem.response.branches import Coexistence, DropOut, Jump
from fem.response.records import PointRow
from fem.response.result import ResponseResult
from fem.results.figures import TURNED
from fem.results.outcome import Outcome
from fem.runtime.units import MILLIMETRES, RATIO
from fem.study.answers import slip_in_words

MOST_RANGES = 3  #: of frequencies that are named


@dataclass(frozen=True, kw_only=True)
class Fates:
    """The points of a curve that have an outcome, by what became of the container."""

    overturned: list[PointRow]
    destroyed: list[PointRow]  #: one of its corners
    slid: list[PointRow]  #: beyond the limit
    standing: list[PointRow]

    @property
    def overturned_share(self) -> float | None:
        """Of the points that do not stand; None where there is none."""
        count = sum(map(len, (self.overturned, self.destroyed, self.slid, self.standing)))
        return 1.0 - len(self.standing) / count if count else None


def fates_of(result: ResponseResult) -> Fates:
    """What became of the container at each point."""
    fates = Fates(overturned=[], destroyed=[], slid=[], standing=[])
    limit = math.inf if result.limit_slip is None else result.limit_slip
    for point in result.points:
        if point.motion == Outcome.INVALID:
            fates.destroyed.append(point)
        elif point.fell:
            fates.overturned.append(point)
        elif point.status != "failed":
            (fates.slid if result.slid(point) > limit else fates.standing).append(point)
    return fates


def response_answer(result: ResponseResult) -> str | None:
    """The answer of a response curve; None of an unfinished one and one without an outcome."""
    points = [point for point in result.points if point.status != "failed"]
    if result.state != "finished" or not points:
        return None
    fates = fates_of(result)
    limit = f"{slip_in_words(result.limit_slip or 0.0)} within {result.request.get('observe')} periods"
    frequencies = [point.frequency_Hz for point in points]
    failed = len(result.points) - len(points)
    every = f"every frequency {'with an outcome' if failed else 'tried'}, {_range(min(frequencies), max(frequencies))}"
    if len(fates.standing) == len(points):
        parts = [f"stood at {every}, up and down"]
        parts += [f"none slid beyond {limit}"] if result.limit_slip is not None else []
    elif len(fates.overturned) == len(points):
        parts = [f"overturned at {every}"]
    else:
        fallen = [f"{range_of(fall)} going {fall.direction}" for fall in result.drop_outs]
        parts = [f"overturned at {_listed(fallen)}"] if fallen else []
        if fates.destroyed:
            parts.append(f"not valid at {_counted(fates.destroyed)}: a corner is destroyed")
        if fates.slid:
            there = slip_in_words(result.slid(fates.slid[0]))
            parts.append(f"slid beyond {limit} at {_counted(fates.slid)} (slip there {there})")
        if count := len(fates.standing):
            parts.append(f"stood at the other {f'{count} points' if count > 1 else 'point'}")
    if fates.standing:
        most = max(fates.standing, key=lambda point: point.turned)
        turned = f"{most.turned:.2g} of the slenderness angle, at {most.frequency_Hz:.4g} Hz"
        resting = all(point.long_time == "rest" for point in fates.standing)
        parts.append("at rest there" if resting else f"largest rotation {turned} going {most.direction}")
        slid = max(fates.standing, key=lambda point: point.slip_stroke_m or 0.0)
        if (slid.slip_stroke_m or 0.0) >= MILLIMETRES.least:
            stroke = slip_in_words(slid.slip_stroke_m or 0.0)
            parts.append(
                f"slid by up to {stroke} a period, at {slid.frequency_Hz:.4g} Hz going {slid.direction}"
            )
    if result.coexisting:
        parts.append(f"two motions coexist at {_listed([range_of(pair) for pair in result.coexisting])}")
    if failed:
        parts.append(f"no outcome at {failed} of {len(result.points)} points")
    return "frequency: " + "; ".join(parts)


def _counted(points: list[PointRow]) -> str:
    count = f"{len(points)} point{'s' * (len(points) != 1)}"
    return f"{count}, the first at {points[0].frequency_Hz:.4g} Hz going {points[0].direction}"


def branches_in_words(result: ResponseResult) -> Iterator[tuple[str, str, str, str]]:
    """Where the curve changes: what happens there, on which sweep, at which frequencies, and how."""
    for fall in result.drop_outs:
        how = "a motion that was carried there" if fall.carried else "from its start"
        yield "overturns", fall.direction, range_of(fall), how
    for pair in result.coexisting:
        words = f"{' or '.join(pair.up)} going up, {' or '.join(pair.down)} going down"
        if pair.largest_difference is not None:
            words += f", rotation ratios up to {RATIO.text(pair.largest_difference)} apart"
        yield "coexist", "up and down", range_of(pair), words
    for jump in result.jumps:
        before, after = map(RATIO.text, jump[TURNED])
        yield "jump", jump.direction, range_of(jump), f"{jump.what}, rotation ratio {before} to {after}"


def range_of(change: Coexistence | Jump | DropOut) -> str:
    """The frequencies of a coexistence, a jump or a drop-out, in the order of its sweep."""
    return _range(change.from_Hz, change.to_Hz)


def _range(low: float, high: float) -> str:
    return f"{low:.4g} Hz" if low == high else f"{low:.4g} to {high:.4g} Hz"


def _listed(ranges: list[str]) -> str:
    more = len(ranges) - MOST_RANGES
    return ", ".join(ranges[:MOST_RANGES]) + (f" and {more} more ranges" if more > 0 else "")
