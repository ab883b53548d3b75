"""Which values of one key fulfil the rule: a scan of a range, then every change is located."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from fem.run.bracket import least_width, values_to_try
from fem.site_check.result import FIGURE_OF, LIMITS, ByRule, SiteAnswer
from fem.study.driver import COMPLETED, StudyResult

RESOLUTION = 0.01  #: largest width of a bracket over the value
INNER = 3  #: values tried within a bracket at a time
#: which values a user looks for: the least, the largest, or all
Wanted = Literal["least", "largest", "window"]


@dataclass(frozen=True, kw_only=True)
class SizeAxis:
    """The key that is varied, and the values of the scan."""

    key: str
    words: str  #: such as "width"
    unit: str
    wanted: Wanted
    values: tuple[float, ...]  #: rising
    whole: bool = False  #: all values are tried, and there are none between them: boxes, floors of a building

    def __post_init__(self) -> None:
        if len(self.values) < 2 or any(b <= a for a, b in pairwise(self.values)):
            raise ValueError(f"{self.key}: at least two rising values are needed, got {self.values}")


@dataclass(frozen=True, kw_only=True)
class SizePoint(ByRule):
    """The answer at one value."""

    value: float
    answer: str | None = None  #: fulfilled | not fulfilled | not sure
    fulfilled: bool | None = None
    overturned: int
    invalid: int = 0  #: runs that destroyed a corner, which do not count as standing
    runs: int
    fails: str = ""  #: why it is not fulfilled, in words

    def __post_init__(self) -> None:
        if bool(self.fails) == bool(self.fulfilled):
            raise ValueError(
                f"{self.value}: a reason is given where, and only where, the rule is not fulfilled"
            )


@dataclass(frozen=True, kw_only=True)
class SizeResult(StudyResult):
    """Which values fulfil the rule: what `size.json` holds."""

    command: str = ""
    wall_s: float | None = None
    key: str
    followers: tuple[str, ...] = ()  #: keys that took the same values
    unit: str
    low: float  #: ends of the range that was tried
    high: float
    #: the least or the largest; None where there is none in the range, or a window is asked
    value: float | None = None
    #: of the values that fulfil it, by their outermost values tried
    intervals: tuple[tuple[float, ...], ...] = ()
    sentence: str = ""
    points: tuple[SizePoint, ...] = ()  #: by rising value


def next_values(axis: SizeAxis, answers: Mapping[float, SiteAnswer]) -> list[float]:
    """Values to be tried next: those of the scan, then values within every bracket wider than 1 % of the value.

    Args:
        answers: so far, by value. None is asked for again; empty: all is found.
    """
    missing = [value for value in axis.values if value not in answers]
    if missing or axis.whole:
        return missing
    outcomes = {value: str(bool(answer.fulfilled)) for value, answer in answers.items()}
    return values_to_try(
        outcomes, resolution=RESOLUTION, inner=INNER, least=least_width(axis.values, RESOLUTION)
    )


def size_asked(axis: SizeAxis, followers: tuple[str, ...] = (), command: str = "") -> SizeResult:
    """What is known before any value is tried."""
    return SizeResult(
        command=command,
        key=axis.key,
        followers=followers,
        unit=axis.unit,
        low=axis.values[0],
        high=axis.values[-1],
    )


def size_result(
    axis: SizeAxis, answers: Mapping[float, SiteAnswer], begun: SizeResult | None = None
) -> SizeResult:
    """Which values fulfil the rule, from the answers by value."""
    points = tuple(_point(value, answers[value]) for value in sorted(answers))
    intervals, words = fulfilled_intervals(points), sentence(axis, points)
    return replace(
        begun or size_asked(axis),
        status=COMPLETED,
        answer=words,
        value=wanted_value(axis, intervals),
        intervals=tuple(intervals),
        sentence=words,
        points=points,
    )


def fulfilled_intervals(points: Sequence[SizePoint]) -> list[tuple[float, float]]:
    """Stretches of neighbouring values tried that all fulfil the rule, by rising value."""
    stretches: list[list[float]] = []
    before = False
    for point in points:
        if point.fulfilled and before:
            stretches[-1][1] = point.value
        elif point.fulfilled:
            stretches.append([point.value, point.value])
        before = bool(point.fulfilled)
    return [(low, high) for low, high in stretches]


def wanted_value(axis: SizeAxis, intervals: Sequence[tuple[float, float]]) -> float | None:
    """The end of the stretch that reaches the good end of the range; an island elsewhere does not count."""
    if axis.wanted == "least" and intervals and intervals[-1][1] == axis.values[-1]:
        return intervals[-1][0]
    if axis.wanted == "largest" and intervals and intervals[0][0] == axis.values[0]:
        return intervals[0][1]
    return None


def sentence(axis: SizeAxis, points: Sequence[SizePoint]) -> str:
    """The answer in one sentence: the value, what fails beyond it, and the islands."""
    intervals = fulfilled_intervals(points)
    low, high = axis.values[0], axis.values[-1]
    tried = f"from {_value(low, axis)} to {_value(high, axis)}"
    if not intervals:
        reasons = " or ".join(dict.fromkeys(point.fails for point in points))
        return f"The rule is not fulfilled at any {axis.words} tried {tried}: {reasons}."
    if intervals == [(low, high)]:
        return f"The rule is fulfilled at every {axis.words} tried {tried}."
    value = wanted_value(axis, intervals)
    if value is None:
        return (
            f"The rule is fulfilled for a {axis.words} {_stretches(intervals, axis)}, of those tried {tried}."
        )
    others = intervals[:-1] if axis.wanted == "least" else intervals[1:]
    island = f"; also {_stretches(others, axis)}, an island that does not count" if others else ""
    if axis.wanted == "least":
        beyond = [point for point in points if point.value < value][-1]
        return (
            f"The least {axis.words} is {_value(value, axis, up=True)}: the rule is fulfilled from there to "
            f"{_value(high, axis)} (below: {beyond.fails}){island}."
        )
    beyond = next(point for point in points if point.value > value)
    return (
        f"The largest {axis.words} is {_value(value, axis, up=False)}: the rule is fulfilled from "
        f"{_value(low, axis)} to there (above: {beyond.fails}){island}."
    )


def _stretches(intervals: Sequence[tuple[float, float]], axis: SizeAxis) -> str:
    return " and ".join(_stretch(low, high, axis) for low, high in intervals)


def _stretch(low: float, high: float, axis: SizeAxis) -> str:
    """A stretch in words, with enough figures for its ends to differ."""
    if low == high:
        return f"of {_value(low, axis)}"
    figures = next((n for n in (3, 4, 5) if _inward(low, n, up=True) <= _inward(high, n, up=False)), 6)
    return f"from {_value(low, axis, figures, up=True)} to {_value(high, axis, figures, up=False)}"


def _value(value: float, axis: SizeAxis, figures: int = 3, *, up: bool | None = None) -> str:
    """A value with its unit, rounded toward what fulfils the rule."""
    if not axis.whole and up is not None:
        value = _inward(value, figures, up=up)
    return f"{value:.{figures}g} {axis.unit}".strip()


def _inward(value: float, figures: int, *, up: bool) -> float:
    """A value rounded up or down to a number of figures."""
    if value == 0.0:
        return value
    step = 10.0 ** (math.floor(math.log10(abs(value))) - figures + 1)
    steps = value / step
    return (math.ceil(steps - 1e-9) if up else math.floor(steps + 1e-9)) * step


def _point(value: float, answer: SiteAnswer) -> SizePoint:
    return SizePoint(
        value=value,
        answer=answer.answer,
        fulfilled=answer.fulfilled,
        overturned=answer.overturned,
        invalid=answer.invalid,
        runs=answer.runs,
        **{field.name: answer[field.name] for field in fields(ByRule)},
        fails=_reason(answer),
    )


def _reason(answer: SiteAnswer) -> str:
    if answer.fulfilled:
        return ""
    if answer.answer is None:
        return "there is no answer"
    if answer.fulfilled is None:
        return "it is not sure"
    if answer.overturned:
        return "it overturns"
    if answer.invalid:
        return "a corner is destroyed"
    names = [LIMITS[FIGURE_OF[key]].words for key in answer.exceeded]
    if not names:
        return "the wind moves it"
    return f"{' and '.join(names)} {'are' if len(names) > 1 else 'is'} beyond the limit"


def spaced(low: float, high: float, count: int) -> tuple[float, ...]:
    """Values of a scan, at equal ratios where the range spans more than a factor of four."""
    even = np.geomspace(low, high, count) if low > 0.0 and high > 4.0 * low else np.linspace(low, high, count)
    return tuple(float(f"{value:.6g}") for value in even)
