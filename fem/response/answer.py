"""The answer of a response curve in one sentence, and what lasts at each frequency in words."""

from collections.abc import Iterator, Sequence

from fem.response.lasting import AtFrequency, Coexistence, DropOut, ResponseResult
from fem.response.records import PointRow
from fem.results.outcome import Outcome
from fem.runtime.units import MILLIMETRES
from fem.study.answers import slip_in_words

#: what stable means, as Knoedel and Hrabowski define Lyapunov stability
STABLE = "amplitudes do not diverge, and without drive the motion dies out"
MOST_RANGES = 3  #: of frequencies that are named


def overturned_share(points: Sequence[PointRow]) -> float | None:
    """Of some points with an outcome, those that overturn or destroy a corner; None where there is none."""
    known = [point for point in points if point.status != "failed"]
    return sum(point.fell or point.says_nothing for point in known) / len(known) if known else None


def fell_share(frequencies: tuple[AtFrequency, ...]) -> float | None:
    """The share of all random states that overturn or destroy a corner; None without any."""
    count = sum(at.starts for at in frequencies)
    return sum(at.fell + at.destroyed for at in frequencies) / count if count else None


def response_answer(result: ResponseResult) -> str | None:
    """The answer of a response curve; None of an unfinished one and one without an outcome."""
    points = [point for point in result.points if point.status != "failed"]
    if result.state != "finished" or not points:
        return None
    failed = len(result.points) - len(points)
    destroyed = [point for point in points if point.motion == Outcome.INVALID]
    overturned = [point for point in points if point.fell]
    standing = [point for point in points if not point.fell and not point.says_nothing]
    frequencies = [point.frequency_Hz for point in points]
    every = f"every frequency {'with an outcome' if failed else 'tried'}, {_range(min(frequencies), max(frequencies))}"
    parts = [_largest_in_words(result)]
    if result.starts_fell_share is not None:
        destroys = " or destroy a corner" if any(at.destroyed for at in result.frequencies) else ""
        count = sum(at.starts for at in result.frequencies)
        parts.append(f"{100.0 * result.starts_fell_share:.0f} % of {count} random starts overturn{destroys}")
    if len(standing) == len(points):
        parts.append(f"stood at {every}, up and down")
    elif len(overturned) == len(points):
        parts.append(f"overturned at {every}")
    elif len(destroyed) == len(points):
        parts.append(f"not valid at {every}: a corner is destroyed")
    else:
        fallen = [f"{range_of(fall)} going {fall.direction}" for fall in result.drop_outs]
        parts += [f"overturned at {_listed(fallen)}"] if fallen else []
        if destroyed:
            parts.append(f"not valid at {_counted(destroyed)}: a corner is destroyed")
        if count := len(standing):
            parts.append(f"stood at the other {f'{count} points' if count > 1 else 'point'}")
    if standing:
        slid = max(standing, key=lambda point: point.slip_stroke_m or 0.0)
        if (slid.slip_stroke_m or 0.0) >= MILLIMETRES.least:
            stroke = f"slid by up to {slip_in_words(slid.slip_stroke_m or 0.0)} a period"
            parts.append(f"{stroke}, at {slid.frequency_Hz:.4g} Hz going {slid.direction}")
    if result.coexisting:
        parts.append(f"motions coexist at {_listed([range_of(several) for several in result.coexisting])}")
    if result.shell_over_rigid:
        low, high = (f"{share:.2g}" for share in result.shell_over_rigid)
        parts.append(f"where both last, the shell turns by {low} to {high} of what the rigid body does")
    if failed:
        parts.append(f"no outcome at {failed} of {len(result.points)} points")
    return "frequency: " + "; ".join(filter(None, parts))


def stable_in_words(result: ResponseResult) -> str | None:
    """How many of the points judged are stable, behind what that means; None where none was judged."""
    judged = [point.stable for point in result.points if point.stable is not None]
    return f"{sum(judged)} of {len(judged)} points: {STABLE}" if judged else None


def _largest_in_words(result: ResponseResult) -> str:
    """The largest lasting motion, where it is, what leads to it and what the curve shows there; empty without one."""
    motions = [(at, motion) for at in result.frequencies for motion in at.motions]
    if not motions:
        return ""
    at, largest = max(motions, key=lambda pair: pair[1].rotation_ratio)
    if all(motion.motion == "rest" for _, motion in motions):
        return "at rest wherever it stands"
    led = [f"going {way}" for way in largest.ways]
    led += [f"{largest.starts} of {at.starts} starts"] * bool(at.starts)
    beside = "" if largest.ways else ", which neither sweep meets"
    return (
        f"largest lasting motion {largest.rotation_ratio:.2g} of the slenderness angle, {largest.motion} at "
        f"{at.frequency_Hz:.4g} Hz{beside} ({', '.join(led)})"
    )


def lasting_in_words(result: ResponseResult) -> Iterator[tuple[AtFrequency, str]]:
    """What lasts at each frequency, with the sweeps and the share of the starts that lead to it; what falls."""
    for at in result.frequencies:
        words = []
        for motion in at.motions:
            led = [*motion.ways, *([f"{motion.starts} of {at.starts} starts"] if motion.starts else [])]
            words.append(
                f"{motion.rotation_ratio:.3f} {motion.motion} ({', '.join(led) or 'followed from a neighbour'})"
            )
        words += [f"{at.fell} of {at.starts} starts overturn"] if at.fell else []
        words += [f"{at.destroyed} of {at.starts} destroy a corner"] if at.destroyed else []
        yield at, "; ".join(words) or "nothing lasts"


def range_of(change: Coexistence | DropOut) -> str:
    """The frequencies of a coexistence or a drop-out, in the order of its sweep."""
    return _range(change.from_Hz, change.to_Hz)


def _counted(points: list[PointRow]) -> str:
    count = f"{len(points)} point{'s' * (len(points) != 1)}"
    return f"{count}, the first at {points[0].frequency_Hz:.4g} Hz going {points[0].direction}"


def _range(low: float, high: float) -> str:
    return f"{low:.4g} Hz" if low == high else f"{low:.4g} to {high:.4g} Hz"


def _listed(ranges: list[str]) -> str:
    more = len(ranges) - MOST_RANGES
    return ", ".join(ranges[:MOST_RANGES]) + (f" and {more} more ranges" if more > 0 else "")
