"""The answer of an ensemble: where half of the draws overturn, and up to where few enough do.

The shares counted at the points are joined by straight lines, and so are the ends of their intervals: half of the draws
overturn where the line of the shares first passes one half, from the side on which fewer do; the interval of that value
ends where the lines of the upper and of the lower ends pass it.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, takewhile
from typing import Any

from fem.batch.answers import LARGER_IS_SAFER, STRENGTHS, answer_axis, falling_in_words, slip_in_words
from fem.batch.axes import MOTION_FILE, Axis
from fem.batch.labels import axis_name, in_words, place_in_words
from fem.batch.study import COMPLETED
from fem.ensemble.result import EnsembleResult
from fem.results.figures import SLIPPED
from fem.runtime.units import MILLIMETRES

HALF = 0.5
Row = Mapping[str, Any]  #: of a point, as `ensemble.json` holds it


@dataclass(frozen=True, kw_only=True)
class HalfPoint:
    """Where half of the draws overturn along one line of points."""

    value: float | None  #: None where fewer do at every point
    low: float | None  #: end of its interval; None: not reached
    high: float | None
    at_once: bool  #: half or more do so at the first point already
    few_to: float | None  #: up to here the upper end of the interval is at most the given probability


@dataclass(frozen=True, kw_only=True)
class EnsembleAnswer:
    """The answer of an ensemble along one axis."""

    axis: Axis
    rising: bool  #: more overturn at larger values
    sentence: str  #: of the line of points on which half overturn first
    others: tuple[Axis, ...]  #: the axes that distinguish its lines
    rows: tuple[tuple[Row, HalfPoint, str], ...]  #: a point of each line, its answer, and that in words

    def lines(self) -> Iterator[tuple[str, str]]:
        """The values of the other axes in words, and the answer; nothing where there are no other axes."""
        for point, _, sentence in self.rows if self.others else ():
            yield place_in_words(self.others, point), sentence


def draws_in_words(result: EnsembleResult) -> str:
    """What is counted at a point: "128 draws", "7 motions", "70 draws of 7 motions"."""
    draws, motions = result.draws, len(result.random.get(MOTION_FILE, ()))
    if not motions:
        return f"{draws} draws"
    return f"{motions} motions" if motions == draws else f"{draws} draws of {motions} motions"


def ensemble_answer(result: EnsembleResult) -> EnsembleAnswer | None:
    """The answer along a strength, else along the axis with the most values.

    Returns:
        None of an unfinished ensemble, and where no axis has several numbers.
    """
    axes = result.point_axes
    numeric = sorted((axis for axis in axes if axis.is_numeric), key=lambda axis: -len(axis.values))
    axis = answer_axis(axes) or next(iter(numeric), None)
    if axis is None or result.status != COMPLETED:
        return None
    others = tuple(other for other in axes if other is not axis and len(other.values) > 1)
    rising = _is_rising(axis, result.points)
    lines: dict[tuple[Any, ...], list[Row]] = defaultdict(list)
    for point in sorted(result.points, key=lambda row: row[axis.key], reverse=not rising):
        lines[tuple(point[other.key] for other in others)].append(point)
    rows = []
    for values in sorted(lines):
        crossing = half_point(axis, lines[values])
        rows.append(
            (lines[values][0], crossing, _sentence(result, axis, lines[values], crossing, rising=rising))
        )
    safest = min if rising else max
    reached = [(crossing.value, k) for k, (_, crossing, _) in enumerate(rows) if crossing.value is not None]
    few = [crossing.few_to for _, crossing, _ in rows if crossing.few_to is not None]
    sentence = rows[0][2]
    if others and reached:
        point, crossing, _ = rows[safest(reached)[1]]
        half = _half(
            result, axis, lines[tuple(point[other.key] for other in others)], crossing, rising=rising
        )
        sentence = f"{half}, first with {place_in_words(others, point)}"
    elif others:
        fell = falling_in_words(result.limit_slip_m, past=True)
        sentence = f"fewer than half of {draws_in_words(result)} {fell} at every point"
    if others and len(few) == len(rows):
        sentence += _few(result, axis, safest(few), rising=rising)
    return EnsembleAnswer(
        axis=axis, rising=rising, sentence=f"{axis_name(axis)}: {sentence}", others=others, rows=tuple(rows)
    )


def half_point(axis: Axis, points: Sequence[Row]) -> HalfPoint:
    """Where half of the draws overturn along a line of points, sorted from the side where fewer do."""
    known = [point for point in points if point["probability"] is not None]
    values = [float(point[axis.key]) for point in known]
    value, low, high = (
        _crossing(values, [float(point[name]) for point in known]) for name in ("probability", "high", "low")
    )
    few = list(takewhile(lambda point: point["region"] == "below", points))
    return HalfPoint(
        value=value,
        low=low,
        high=high,
        at_once=bool(known) and known[0]["probability"] >= HALF,
        few_to=float(few[-1][axis.key]) if few else None,
    )


def _crossing(values: Sequence[float], shares: Sequence[float]) -> float | None:
    """Where straight lines through the points first pass one half; the first value where it lies above already."""
    if shares and shares[0] >= HALF:
        return values[0]
    for (before, less), (after, more) in pairwise(zip(values, shares, strict=True)):
        if less < HALF <= more:
            return before + (after - before) * (HALF - less) / (more - less)
    return None


def _is_rising(axis: Axis, points: Sequence[Row]) -> bool:
    """Whether more overturn at larger values: by the key, else by the shares at the ends of the axis."""
    if axis.key in LARGER_IS_SAFER:
        return False
    low, high = (
        [point["probability"] or 0.0 for point in points if point[axis.key] == end]
        for end in (axis.values[0], axis.values[-1])
    )
    return axis.key in STRENGTHS or sum(high) >= sum(low)


def interval_in_words(axis: Axis, crossing: HalfPoint, *, rising: bool) -> str:
    """The interval of the value in words; an end outside the points lies "beyond" them."""
    ends = [axis.values[0], axis.values[-1]]
    first, last = (in_words(axis, [end]) for end in (ends if rising else reversed(ends)))
    before, after = ("below", "beyond") if rising else ("beyond", "below")
    low, high = ("" if end is None else in_words(axis, [end]) for end in (crossing.low, crossing.high))
    words = [f"{before} {first}" if low == first else low, high or f"{after} {last}"]
    return " to ".join(words if rising else reversed(words))


def _sentence(
    result: EnsembleResult, axis: Axis, points: Sequence[Row], crossing: HalfPoint, *, rising: bool
) -> str:
    few = "" if crossing.few_to is None else _few(result, axis, crossing.few_to, rising=rising)
    return _half(result, axis, points, crossing, rising=rising) + few + _slips(points, crossing)


def _half(
    result: EnsembleResult, axis: Axis, points: Sequence[Row], crossing: HalfPoint, *, rising: bool
) -> str:
    half = f"half of {draws_in_words(result)} {falling_in_words(result.limit_slip_m, past=True)}"
    if crossing.at_once:
        end = "least" if rising else "largest"
        return f"{half} or more at the {end} tried, {in_words(axis, [points[0][axis.key]])}"
    if crossing.value is None:
        most = max(points, key=lambda point: point["probability"] or 0.0)
        share = f"{100.0 * (most['probability'] or 0.0):.2g} %"
        return (
            f"fewer than {half} at every value tried, at most {share} at {in_words(axis, [most[axis.key]])}"
        )
    interval = interval_in_words(axis, crossing, rising=rising)
    return (
        f"{half} at {in_words(axis, [crossing.value])} ({100.0 * result.confidence:g} % interval {interval})"
    )


def _slips(points: Sequence[Row], crossing: HalfPoint) -> str:
    """How far the draws slid that stood, at the points at which fewer than half did not."""
    before = takewhile(lambda point: crossing.value is None or (point["probability"] or 0.0) < HALF, points)
    slip = max((point.get(SLIPPED) or 0.0 for point in before), default=0.0)
    return f"; those that stood there slid up to {slip_in_words(slip)}" if slip >= MILLIMETRES.least else ""


def _few(result: EnsembleResult, axis: Axis, few_to: float, *, rising: bool) -> str:
    few = in_words(axis, [few_to])
    reach = f"up to {few}" if rising else f"from {few} on"
    return f"; at most {100.0 * result.probability:g} % {reach}, by the upper end of the interval"


def fragility_lines(result: EnsembleResult) -> Iterator[tuple[str, str]]:
    """Where the curve falls, and the lognormal curve: name and words; nothing where there is no curve."""
    fragility = result.fragility
    if fragility is None:
        return
    for fall in fragility.falls:
        yield (
            "falls",
            f"from {fall.probability_weaker:.3f} at {fall.weaker:g} to {fall.probability_stronger:.3f} at "
            f"{fall.stronger:g}: a stronger motion overturns less often",
        )
    fitted = fragility.lognormal
    if fitted is None:
        yield "lognormal", f"none: {fragility.no_lognormal}"
        return
    parts = []
    for name, unit in (("median", result.axes[0].unit), ("deviation", "")):
        ends = fitted[f"{name}_interval"]
        interval = f" ({ends[0]:.3g} to {ends[1]:.3g})" if ends else ""
        parts.append(f"{name} {fitted[name]:.3g}{interval} {unit}".rstrip())
    fit = "" if fitted.adequate else "; the lognormal curve does not describe the counts"
    yield (
        "lognormal",
        f"{', '.join(parts)}; misses {fitted.levels_missed} of {fitted.levels} intervals of "
        f"{100.0 * result.confidence:g} % ({fitted.missed_by_chance} by chance){fit}",
    )
