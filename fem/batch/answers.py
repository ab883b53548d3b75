"""The answer of a study in one sentence: up to which value everything stood, and where something first overturned.

Along one axis the values are taken from the safe side: a strength from below, a width from above. Every statement is
about what was tried: nothing is known between the values.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple

from fem.batch.axes import Axis
from fem.batch.labels import in_words, plain_number
from fem.results.outcome import Ending
from fem.runtime.units import MILLIMETRES

#: axes of the floor's strength, that first along which an answer is given where a study does not say
STRENGTHS = (
    "motion.peak_acceleration_m_s2",
    "motion.scale_to_m_s2",
    "motion.scale",
    "motion.amplitude_m",
)
#: axes along which the larger value is the safer one
LARGER_IS_SAFER = frozenset({"container.width_m"})
MOST_RANGES = 4  #: of values that a sentence names
MOST_ROWS = 40  #: on a screen
MOST_FIGURES = 17  #: of a number in double precision

Range = tuple[float, float]  #: first and last of neighbouring values, from the safe side


class Trial(NamedTuple):
    """One run: where it is, and what it showed."""

    value: float  #: on the axis of the answer
    line: int  #: runs of one line differ in that value alone
    kind: Ending
    slip: float | None = None  #: largest |slip| [m]
    unsure: bool | None = (
        None  #: whether unknown inputs or small changes turn the outcome; None where not tried
    )


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The result of the runs of one or more lines, from the safe side on."""

    stood_to: float | None  #: up to here every run stood; None where one of the first value did not
    overturned_from: float | None  #: the first value at which a run overturned
    slip: float | None = None  #: of that run [m]
    line: int | None = None  #: of that run
    stood_again: tuple[Range, ...] = ()  #: beyond that value, where every line was tried and stood
    failed: tuple[Range, ...] = ()  #: where a run has no outcome
    unsure: tuple[Range, ...] = ()  #: where the outcome of a run is unsure


def answer_axis(axes: Sequence[Axis]) -> Axis | None:
    """The axis along which a study answers: a strength, else the only one whose values are rising numbers.

    An axis of two opposite signs is not a strength.
    """
    numeric = {
        axis.key: axis for axis in axes if axis.is_numeric and len({abs(value) for value in axis.values}) > 1
    }
    for key in STRENGTHS:
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
    for one in trials:
        kinds[one.value].add(one.kind)
    return not (Ending.OVERTURNED in kinds[axis.values[0]] and kinds[axis.values[-1]] == {Ending.STANDING})


def answer_of(trials: Sequence[Trial], *, rising: bool) -> Answer:
    """The answer of some lines together.

    Args:
        trials: of all these lines, in any order.
        rising: the smaller values are the safe ones.
    """
    lines = len({one.line for one in trials})
    at: dict[float, list[Trial]] = defaultdict(list)
    for one in trials:
        at[one.value].append(one)
    values = sorted(at, reverse=not rising)
    kinds = {value: {one.kind for one in at[value]} for value in values}
    stands = [kinds[value] == {Ending.STANDING} for value in values]
    fallen = [value for value in values if Ending.OVERTURNED in kinds[value]]
    first = values.index(fallen[0]) if fallen else len(values)
    upright = stands.index(False) if False in stands else len(values)
    fell = [one for one in at[fallen[0]] if one.kind == Ending.OVERTURNED] if fallen else []
    worst = max(fell, key=lambda one: (one.slip or 0.0, -one.line), default=None)
    # A value tried in some lines only is unknown for the others; where it did not stand, it ends a range.
    beyond = [
        (value, stood)
        for value, stood in zip(values[first:], stands[first:], strict=True)
        if not stood or len(at[value]) == lines
    ]
    sureness = [
        (value, marks)
        for value in values
        if (marks := [one.unsure for one in at[value] if one.unsure is not None])
    ]
    return Answer(
        stood_to=values[upright - 1] if upright else None,
        overturned_from=fallen[0] if fallen else None,
        slip=worst.slip if worst else None,
        line=worst.line if worst else None,
        stood_again=tuple(_ranges(beyond)),
        failed=tuple(_ranges((value, Ending.FAILED in kinds[value]) for value in values)),
        unsure=tuple(_ranges((value, any(marks)) for value, marks in sureness)),
    )


def sentence_of(answer: Answer, axis: Axis, *, rising: bool, where: str = "") -> str:
    """An answer in words: "stood in every motion tried up to 0.42 g; first overturned at 0.44 g (slip there 64 mm)"."""
    every = f"stood in every {'motion' if axis.key.startswith('motion.') else 'case'} tried"
    stood, fell = ends_in_words(answer, axis)
    slip = _slip_in_words(answer.slip) if fell and answer.slip is not None else ""
    noted = ", ".join(filter(None, (slip, f"with {where}" if fell and where else "")))
    noted = f" ({noted})" if noted else ""
    at_once = fell and not stood and not answer.failed
    if rising:
        parts = [
            f"{every} up to {stood}" if stood else "",
            f"{'overturned at the least tried,' if at_once else 'first overturned at'} {fell}{noted}"
            if fell
            else "",
        ]
    else:
        parts = [
            f"overturned {'even at the largest tried,' if at_once else 'up to'} {fell}{noted}"
            if fell
            else "",
            f"{every} from {stood} on" if stood else "",
        ]
    parts.append("none overturned" if stood and not fell else "")
    ranges = {
        "stood again at" if rising else "stood below that at": answer.stood_again,
        "no outcome at": answer.failed,
        "unsure at": answer.unsure,
    }
    parts += [f"{words} {ranges_in_words(found, axis)}" for words, found in ranges.items() if found]
    return "; ".join(filter(None, parts))


def ends_in_words(answer: Answer, axis: Axis) -> tuple[str, str]:
    """Up to where it stood and where it first overturned, with enough figures to differ; empty for none."""
    ends = (answer.stood_to, answer.overturned_from)
    words = ("", "")
    for figures in range(3, MOST_FIGURES + 1):
        stood, fell = ("" if one is None else in_words(axis, [one], figures) for one in ends)
        words = stood, fell
        if stood != fell:
            break
    return words


def ranges_in_words(ranges: Sequence[Range], axis: Axis) -> str:
    """Ranges of values: "0.5 to 0.55 g, 0.61 g"; those after the fourth are counted."""
    shown = [in_words(axis, sorted({*one})) for one in ranges[:MOST_RANGES]]
    more = len(ranges) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")


def table_lines(rows: Iterable[tuple[str, str]], file: str = "") -> Iterator[str]:
    """Lines for a screen, each a place and its answer; after the first forty, the number left and the file of all."""
    listed = list(rows)
    widest = max((len(where) for where, _ in listed), default=0)
    yield from (f"  {where:{widest}}  {sentence}" for where, sentence in listed[:MOST_ROWS])
    if more := len(listed[MOST_ROWS:]):
        yield f"  {more} more rows" + (f" in {file}" if file else "")


def _slip_in_words(slip: float) -> str:
    return f"slip there {plain_number(1e3 * slip)} mm" if slip >= MILLIMETRES.least else "no slip there"


def _ranges(marked: Iterable[tuple[float, bool]]) -> Iterator[Range]:
    """Neighbouring values that are marked."""
    for mark, group in groupby(marked, key=lambda pair: pair[1]):
        if mark:
            values = [value for value, _ in group]
            yield values[0], values[-1]
