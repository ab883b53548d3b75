"""The answer of a study in one sentence: up to which value everything stood, and where something first overturned.

Along one axis the values are taken from the safe side: a strength from below, a width from above. Every statement is
about what was tried: nothing is known between the values.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby, pairwise, takewhile
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from fem.html.page import text_of
from fem.results.figures import SLIPPED
from fem.results.outcome import NOT_STANDING, Ending, ending_of
from fem.runtime.units import MILLIMETRES, plain_number
from fem.study.axes import SIGNS, Axis, axis_name, in_words, lines_along, place_in_words, point_of, set_axis
from fem.study.driver import COMPLETED
from fem.study.fragility import EnsembleResult
from fem.study.sweep_table import TRIED, TRIED_COLUMNS, SweepTable
from fem.study.table import Columns, read_rows, table_of_rows

#: axes of the floor's strength, that first along which an answer is given where a study does not say
STRENGTHS = ("motion.peak_acceleration_m_s2", "motion.scale_to_m_s2", "motion.scale", "motion.amplitude_m")
GAPS = ("stop.gap_m", "tie.slack_m", "neighbour.gap_m")  #: axes of an answer where none is a strength
#: axes along which the larger value is the safer one
LARGER_IS_SAFER = frozenset({"container.width_m"})
MOST_RANGES = 4  #: of values that a sentence names
MOST_FIGURES = 17  #: of a number in double precision

FoundT = TypeVar("FoundT")
Range = tuple[float, float]  #: first and last of neighbouring values, from the safe side


class Trial(NamedTuple):
    """One run: where it is, and what it showed."""

    value: float  #: on the axis of the answer
    line: int  #: runs of one line differ in that value alone
    kind: Ending
    slip: float | None = None  #: largest |slip| [m]
    #: whether unknown inputs or small changes turn the outcome; None where not tried
    unsure: bool | None = None
    fell: str = ""  #: who overturned first, of a row of containers


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The result of the runs of one or more lines, from the safe side on.

    With a limit on the slip, what slides further does not stand, and counts as what overturns; so does what destroys a
    corner.
    """

    stood_to: float | None  #: up to here every run stood; None where one of the first value did not
    overturned_from: float | None  #: the first value at which a run overturned
    stood_slip: float | None = None  #: largest of the runs up to the first of these values [m]
    slip: float | None = None  #: of the run that overturned [m]
    line: int | None = None  #: of that run
    fell: str = ""  #: who overturned first in it, of a row of containers
    slid: bool = False  #: no run overturned at the second of these values: one slid beyond the limit
    invalid: bool = False  #: .. or one destroyed a corner
    limit_slip: float | None = None  #: [m]
    stood_again: tuple[Range, ...] = ()  #: beyond that value, where every line was tried and stood
    failed: tuple[Range, ...] = ()  #: where a run has no outcome
    unsure: tuple[Range, ...] = ()  #: where the outcome of a run is unsure


@dataclass(frozen=True, kw_only=True)
class AnswerRow(Generic[FoundT]):
    """The answer of the runs that have some values of the other axes in common."""

    #: these values; without the motion where the row is that of all motions of a set
    point: Mapping[str, Any]
    found: FoundT
    sentence: str


@dataclass(frozen=True, kw_only=True)
class StudyAnswer(Generic[FoundT]):
    """What a study found along one axis: an `Answer` of a sweep, a `HalfPoint` of an ensemble."""

    axis: Axis
    rising: bool  #: the smaller values are the safe ones
    sentence: str  #: of all rows together
    others: tuple[Axis, ...]  #: the axes that distinguish the rows
    rows: tuple[AnswerRow[FoundT], ...]  #: those of all motions of a set first

    def lines(self) -> Iterator[tuple[str, str]]:
        """Where, and the answer; of a set of motions the rows of all of them; nothing where there are no other axes."""
        of_sets = [row for row in self.rows if len(row.point) < len(self.others)]
        for row in of_sets or self.rows if self.others else ():
            yield self.where(row), row.sentence

    def where(self, row: AnswerRow[FoundT]) -> str:
        """The values of the other axes in words."""
        return place_in_words((axis for axis in self.others if axis.key in row.point), row.point)


def answer_axis(axes: Sequence[Axis]) -> Axis | None:
    """The axis along which a study answers: a strength, else a gap, else the only one whose values are rising numbers.

    An axis of two opposite signs is not a strength.
    """
    numeric = {axis.key: axis for axis in axes if axis.is_numeric and len({*map(abs, axis.numbers)}) > 1}
    for key in (*STRENGTHS, *GAPS):
        if key in numeric:
            return numeric[key]
    return next(iter(numeric.values())) if len(numeric) == 1 else None


def is_rising(axis: Axis, trials: Iterable[Trial]) -> bool:
    """Whether the smaller values are the safe ones: by the key, else by what the ends of the axis show."""
    if axis.key in LARGER_IS_SAFER:
        return False
    if axis.key in STRENGTHS:
        return True
    kinds: dict[float, set[Ending]] = defaultdict(set)
    for trial in trials:
        kinds[trial.value].add(trial.kind)
    return not (Ending.OVERTURNED in kinds[axis.numbers[0]] and kinds[axis.numbers[-1]] == {Ending.STANDING})


def answer_of(trials: Sequence[Trial], *, rising: bool, limit_slip: float | None = None) -> Answer:
    """The answer of all trials of some lines together; a run that slides beyond `limit_slip` [m] does not stand."""

    def falls(trial: Trial) -> bool:
        slid = limit_slip is not None and trial.kind == Ending.STANDING and (trial.slip or 0.0) > limit_slip
        return slid or trial.kind in NOT_STANDING

    lines = len({trial.line for trial in trials})
    at: dict[float, list[Trial]] = defaultdict(list)
    for trial in trials:
        at[trial.value].append(trial)
    values = sorted(at, reverse=not rising)
    kinds = {value: {trial.kind for trial in at[value]} for value in values}
    fallen = [value for value in values if any(map(falls, at[value]))]
    stands = [kinds[value] == {Ending.STANDING} and value not in fallen for value in values]
    first = values.index(fallen[0]) if fallen else len(values)
    upright = [*stands, False].index(False)
    fell = [trial for trial in at[fallen[0]] if falls(trial)] if fallen else []
    overturned = [trial for trial in fell if trial.kind == Ending.OVERTURNED]
    invalid = [trial for trial in fell if trial.kind == Ending.INVALID]
    worst = max(overturned or invalid or fell, key=lambda run: (run.slip or 0.0, -run.line), default=None)
    slips = [trial.slip for value in values[:upright] for trial in at[value] if trial.slip is not None]
    # A value tried in some lines only is unknown for the others; where it did not stand, it ends a range.
    beyond = [
        (value, stood)
        for value, stood in zip(values[first:], stands[first:], strict=True)
        if not stood or len(at[value]) == lines
    ]
    sureness = [
        (value, marks)
        for value in values
        if (marks := [trial.unsure for trial in at[value] if trial.unsure is not None])
    ]
    return Answer(
        stood_to=values[upright - 1] if upright else None,
        overturned_from=fallen[0] if fallen else None,
        stood_slip=max(slips, default=None),
        slip=worst.slip if worst else None,
        line=worst.line if worst else None,
        fell=worst.fell if worst else "",
        slid=bool(fell) and not overturned and not invalid,
        invalid=bool(invalid) and not overturned,
        limit_slip=limit_slip,
        stood_again=tuple(_ranges(beyond)),
        failed=tuple(_ranges((value, Ending.FAILED in kinds[value]) for value in values)),
        unsure=tuple(_ranges((value, any(marks)) for value, marks in sureness)),
    )


def sentence_of(answer: Answer, axis: Axis, *, rising: bool, where: str = "") -> str:
    """An answer in words: "stood in every motion tried up to 0.42 g (slid up to 50 mm); first overturned at 0.44 g"."""
    stood, fell = ends_in_words(answer, axis)
    return text_of(
        "sweep_answer.txt.j2",
        answer=answer,
        rising=rising,
        where=where,
        stood=stood,
        fell=fell,
        of_motion=axis.key.startswith("motion."),
        limit="" if answer.limit_slip is None else slip_in_words(answer.limit_slip),
        least=MILLIMETRES.least,
        slip=slip_in_words,
        ranges=partial(ranges_in_words, axis=axis),
    )


def ends_in_words(answer: Answer, axis: Axis, *, bare: bool = False) -> tuple[str, str]:
    """Up to where it stood and where it first overturned, with enough figures to differ; empty for none."""
    stood = fell = ""
    for figures in range(3, MOST_FIGURES + 1):
        ends = answer.stood_to, answer.overturned_from
        stood, fell = ("" if end is None else in_words(axis, [end], figures, bare=bare) for end in ends)
        if stood != fell:
            break
    return stood, fell


def ranges_in_words(ranges: Sequence[Range], axis: Axis, *, bare: bool = False) -> str:
    """Ranges of values: "0.5 to 0.55 g, 0.61 g"; those after the fourth are counted."""
    texts = [in_words(axis, sorted({*span}), bare=bare) for span in ranges[:MOST_RANGES]]
    more = len(ranges) - len(texts)
    return ", ".join(texts) + (f" and {more} more" if more else "")


def falling_in_words(limit_slip: float | None, *, past: bool = False) -> str:
    """What does not stand, with this limit of the slip [m]: "overturning or sliding beyond 100 mm"; or what it did."""
    fell, slid = ("overturned", "slid") if past else ("overturning", "sliding")
    return fell if limit_slip is None else f"{fell} or {slid} beyond {slip_in_words(limit_slip)}"


def slip_in_words(slip: float) -> str:
    """A slip [m]: "64 mm", "2.9 m"."""
    return f"{plain_number(slip)} m" if slip >= 1.0 else f"{plain_number(1e3 * slip)} mm"


def _ranges(marked: Iterable[tuple[float, bool]]) -> Iterator[Range]:
    """Neighbouring values that are marked."""
    for mark, group in groupby(marked, key=lambda pair: pair[1]):
        if mark:
            values = [value for value, _ in group]
            yield values[0], values[-1]


#: columns of `answers.csv` behind those of the other axes
ANSWER_COLUMNS: Columns = dict.fromkeys(("stood_to", f"stood_{SLIPPED}", "overturned_from", SLIPPED), float)
ANSWER_COLUMNS |= dict.fromkeys(("stood_again", "no_outcome", "unsure", "answer"), str)


def answers_csv(answer: StudyAnswer[Answer]) -> str:
    """`answers.csv`: one row for each combination of values of the other axes."""
    rows = []
    for row in answer.rows:
        found = row.found
        ranges = found.stood_again, found.failed, found.unsure
        words = ["; ".join(f"{a!r} to {b!r}" for a, b in spans) for spans in ranges]
        shown = found.stood_to, found.stood_slip, found.overturned_from, found.slip, *words, row.sentence
        rows.append({**row.point, **dict(zip(ANSWER_COLUMNS, shown, strict=True))})
    columns = dict.fromkeys((axis.key for axis in answer.others), str) | ANSWER_COLUMNS
    return table_of_rows(columns, rows)


def sweep_answer(table: SweepTable, folder: Path) -> StudyAnswer[Answer] | None:
    """The answer of a sweep in a folder; None where no axis asks for one, or cells are missing.

    The signs of a motion are no rows of their own: a motion stands where it stands with either sign.
    """
    wanted = (table.info.threshold or {}).get("axis")
    axis = next((axis for axis in table.axes if axis.key == wanted), None) or answer_axis(table.axes)
    if axis is None or not np.all(table["status"] != ""):
        return None
    empty = np.full(len(table["status"]), np.nan), np.full(len(table["status"]), "", dtype=object)
    slips, unsure = (table.columns.get(name, empty[0]) for name in (SLIPPED, "unsure"))
    fell, lines = table.columns.get("fell_in_row", empty[1]), defaultdict[int, list[Trial]](list)
    for line in lines_along(table.axes, axis):
        for cell, value in zip(line, axis.values, strict=True):
            kind = ending_of(table["status"][cell], table["outcome"][cell])
            slip = None if np.isnan(slips[cell]) else float(slips[cell])
            doubt = None if np.isnan(unsure[cell]) else bool(unsure[cell])
            lines[line[0]].append(Trial(float(value), line[0], kind, slip, doubt, str(fell[cell])))
    for row in read_rows(folder / TRIED, TRIED_COLUMNS):  # between the cells, for a threshold
        kind, fell_first = ending_of(row["status"], row["outcome"]), row["fell_in_row"] or ""
        lines[row["cell"]].append(Trial(row["value"], row["cell"], kind, row[SLIPPED], fell=fell_first))
    rising = is_rising(axis, [trial for line in lines.values() for trial in line])
    others = [other for other in table.axes if other is not axis and len(other.values) > 1]

    def rows_of(kept: Sequence[Axis]) -> Iterator[AnswerRow[Answer]]:
        """A row for each combination of values of some of the other axes."""
        groups: dict[tuple[Any, ...], list[Trial]] = defaultdict(list)
        for first, line in lines.items():
            point = point_of(table.axes, first)
            groups[tuple(point[other.key] for other in kept)] += line
        for values, trials in groups.items():
            answer = answer_of(trials, rising=rising, limit_slip=table.info.limit_slip_m)
            rest = [other for other in others if other not in kept]
            where = "" if answer.line is None else place_in_words(rest, point_of(table.axes, answer.line))
            at = dict(zip((other.key for other in kept), values, strict=True))
            sentence = sentence_of(answer, axis, rising=rising, where=where)
            yield AnswerRow(point=at, found=answer, sentence=sentence)

    motions = set_axis(others)
    opposite = [axis for axis in others if axis.key in SIGNS and len({*map(abs, axis.numbers)}) == 1]
    kept = [other for other in others if motions is None or other not in opposite]
    outer = [other for other in kept if other is not motions]
    rows = [*rows_of(outer), *rows_of(kept)] if motions and outer else list(rows_of(kept))
    (together,) = rows_of(())
    return StudyAnswer(
        axis=axis,
        rising=rising,
        sentence=f"{axis_name(axis)}: {together.sentence}",
        others=tuple(kept),
        rows=tuple(rows),
    )


def fallen_cells_in_words(table: SweepTable) -> str | None:
    """Which cells of a sweep fall, of one that has no axis of an answer; None where none or all do, or one is missing.

    Of each axis the values at which any cell falls, unless they are all, and the other values of those at its end.
    """
    limit = table.info.limit_slip_m
    kinds = np.array([*map(ending_of, table["status"], table["outcome"])])
    slid = table.columns.get(SLIPPED, np.nan) > (math.inf if limit is None else limit)
    cells = np.flatnonzero(np.isin(kinds, NOT_STANDING) | slid)
    if cells.size in (0, kinds.size) or not np.all(table["status"] != ""):
        return None
    points = [point_of(table.axes, cell) for cell in cells.tolist()]

    def listed(axis: Axis, some: Sequence[Mapping[str, Any]]) -> str:
        """The values of an axis at some points; empty for all of them."""
        known = {point[axis.key] for point in some}
        if known == {*axis.values}:
            return ""
        if axis.is_numeric:
            return ranges_in_words([*_ranges((value, value in known) for value in axis.numbers)], axis)
        return in_words(axis, [value for value in axis.values if value in known])

    parts = []
    for axis in table.axes:
        if not (values := listed(axis, points)):
            continue
        words, known = f"some at {values} alone", {point[axis.key] for point in points}
        changes = [pair for pair in pairwise(axis.values) if (pair[0] in known) != (pair[1] in known)]
        if axis.is_numeric and len(changes) == 1:
            end = [point for point in points if point[axis.key] in changes[0]]
            others = [(axis_name(other), listed(other, end)) for other in table.axes if other is not axis]
            there = ", ".join(f"{name} {values}" for name, values in others if values)
            before, behind = ("some", "none") if changes[0][0] in known else ("none", "some")
            low, high = (in_words(axis, [value], 4) for value in changes[0])
            words = f"{before} up to {low}, {behind} from {high} on" + f" (there with {there})" * bool(there)
        parts.append(f"{axis_name(axis)}: {words}")
    fell = falling_in_words(limit, past=True) + " or destroyed a corner" * (Ending.INVALID in kinds)
    return (
        f"{cells.size} of {kinds.size} cells {fell}: {'; '.join(parts) or 'some at every value of each axis'}"
    )


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


def ensemble_answer(result: EnsembleResult) -> StudyAnswer[HalfPoint] | None:
    """The answer along a strength, else along the axis with the most values.

    None of an unfinished ensemble, and where no axis has several numbers.
    """
    axes = result.axes
    numeric = (axis for axis in axes if axis.is_numeric)
    axis = answer_axis(axes) or max(numeric, key=lambda axis: len(axis.values), default=None)
    if axis is None or result.status != COMPLETED:
        return None
    others = tuple(other for other in axes if other is not axis and len(other.values) > 1)
    low, high = (
        sum(point["probability"] or 0.0 for point in result.points if point[axis.key] == axis.values[end])
        for end in (0, -1)
    )
    rising = axis.key not in LARGER_IS_SAFER and (axis.key in STRENGTHS or high >= low)
    lines: dict[tuple[Any, ...], list[Row]] = defaultdict(list)
    for point in sorted(result.points, key=lambda row: row[axis.key], reverse=not rising):
        lines[tuple(point[other.key] for other in others)].append(point)
    says = partial(
        text_of,
        "ensemble_answer.txt.j2",
        result=result,
        axis=axis,
        rising=rising,
        fell=falling_in_words(result.limit_slip_m, past=True),
        words=lambda value: in_words(axis, [value]),
        interval=partial(interval_in_words, axis, rising=rising),
    )
    rows, sorted_lines = [], [points for _, points in sorted(lines.items())]
    for points in sorted_lines:
        known = [point for point in points if point["probability"] is not None]
        few = list(takewhile(lambda point: point["region"] == "below", points))
        value, low, high = (_crossing(axis, known, name) for name in ("probability", "high", "low"))
        at_once = bool(known) and known[0]["probability"] >= HALF
        few_to = float(few[-1][axis.key]) if few else None
        found = HalfPoint(value=value, low=low, high=high, at_once=at_once, few_to=few_to)
        # how far the draws slid that stood, at the points at which fewer than half did not
        before = takewhile(lambda point: (point["probability"] or 0.0) < HALF, points)
        before_half = points if found.value is None else before
        slid = max((point.get(SLIPPED) or 0.0 for point in before_half), default=0.0)
        slip = slip_in_words(slid) if slid >= MILLIMETRES.least else ""
        sentence = says(points=points, found=found, few_to=found.few_to, where="", slip=slip)
        rows.append(AnswerRow(point=points[0], found=found, sentence=sentence))
    safest = min if rising else max
    reached = [(row.found.value, k) for k, row in enumerate(rows) if row.found.value is not None]
    ends = [row.found.few_to for row in rows if row.found.few_to is not None]
    sentence = rows[0].sentence
    if others:
        _, k = safest(reached) if reached else (None, 0)
        first, where = (rows[k].found, place_in_words(others, rows[k].point)) if reached else (None, "")
        end = safest(ends) if len(ends) == len(rows) else None
        sentence = says(points=sorted_lines[k], found=first, few_to=end, where=where, slip="")
    return StudyAnswer(
        axis=axis, rising=rising, sentence=f"{axis_name(axis)}: {sentence}", others=others, rows=tuple(rows)
    )


def _crossing(axis: Axis, known: Iterable[Row], name: str) -> float | None:
    """Where straight lines through points first pass one half; the first value where it lies above already."""
    pairs = [(float(point[axis.key]), float(point[name])) for point in known]
    for (before, less), (after, more) in pairwise([*pairs[:1], *pairs]):
        if less >= HALF:
            return before
        if more >= HALF:
            return before + (after - before) * (HALF - less) / (more - less)
    return None


def interval_in_words(axis: Axis, crossing: HalfPoint, *, rising: bool) -> str:
    """The interval of the value in words; an end outside the points lies "beyond" them."""
    ends = [axis.values[0], axis.values[-1]]
    first, last = (in_words(axis, [end]) for end in (ends if rising else reversed(ends)))
    before, after = ("below", "beyond") if rising else ("beyond", "below")
    low, high = ("" if end is None else in_words(axis, [end]) for end in (crossing.low, crossing.high))
    words = [f"{before} {first}" if low == first else low, high or f"{after} {last}"]
    return " to ".join(words if rising else reversed(words))
