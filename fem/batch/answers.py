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
from fem.batch.labels import in_words
from fem.results.outcome import NOT_STANDING, Ending
from fem.runtime.units import MILLIMETRES, plain_number

#: axes of the floor's strength, that first along which an answer is given where a study does not say
STRENGTHS = (
    "motion.peak_acceleration_m_s2",
    "motion.scale_to_m_s2",
    "motion.scale",
    "motion.amplitude_m",
)
GAPS = ("stop.gap_m", "tie.slack_m", "neighbour.gap_m")  #: axes of an answer where none is a strength
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


def answer_axis(axes: Sequence[Axis]) -> Axis | None:
    """The axis along which a study answers: a strength, else a gap, else the only one whose values are rising numbers.

    An axis of two opposite signs is not a strength.
    """
    numeric = {
        axis.key: axis for axis in axes if axis.is_numeric and len({abs(value) for value in axis.values}) > 1
    }
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
    return not (Ending.OVERTURNED in kinds[axis.values[0]] and kinds[axis.values[-1]] == {Ending.STANDING})


def answer_of(trials: Sequence[Trial], *, rising: bool, limit_slip: float | None = None) -> Answer:
    """The answer of some lines together.

    Args:
        trials: of all these lines, in any order.
        rising: the smaller values are the safe ones.
        limit_slip: beyond which a run does not stand [m]; None: none.
    """

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
    upright = stands.index(False) if False in stands else len(values)
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
    every = f"stood in every {'motion' if axis.key.startswith('motion.') else 'case'} tried"
    limit = "" if answer.limit_slip is None else slip_in_words(answer.limit_slip)
    overturned = (
        f"slid beyond {limit}" if answer.slid else "destroyed a corner" if answer.invalid else "overturned"
    )
    stood, fell = ends_in_words(answer, axis)
    if stood and answer.stood_slip is not None and answer.stood_slip >= MILLIMETRES.least:
        there = f" (slid up to {slip_in_words(answer.stood_slip)})"
    else:
        there = ""
    slip = ""
    if fell and answer.slip is not None:
        slip = (
            f"slip there {slip_in_words(answer.slip)}"
            if answer.slip >= MILLIMETRES.least
            else "no slip there"
        )
    fell_first = f"first to overturn: {answer.fell}" if answer.fell else ""
    noted = ", ".join(filter(None, (fell_first, slip, f"with {where}" if fell and where else "")))
    noted = f" ({noted})" if noted else ""
    at_once = fell and not stood and not answer.failed
    if rising:
        parts = [
            f"{every} up to {stood}{there}" if stood else "",
            f"{f'{overturned} at the least tried,' if at_once else f'first {overturned} at'} {fell}{noted}"
            if fell
            else "",
        ]
    else:
        parts = [
            f"{overturned} {'even at the largest tried,' if at_once else 'up to'} {fell}{noted}"
            if fell
            else "",
            f"{every} from {stood} on{there}" if stood else "",
        ]
    none = f"none overturned or slid beyond {limit}" if limit else "none overturned"
    parts.append(none if stood and not fell else "")
    ranges = {
        "stood again at" if rising else "stood below that at": answer.stood_again,
        "no outcome at": answer.failed,
        "unsure at": answer.unsure,
    }
    parts += [
        f"{words} {ranges_in_words(stretches, axis)}" for words, stretches in ranges.items() if stretches
    ]
    return "; ".join(filter(None, parts))


def ends_in_words(answer: Answer, axis: Axis, *, bare: bool = False) -> tuple[str, str]:
    """Up to where it stood and where it first overturned, with enough figures to differ; empty for none.

    Args:
        answer, axis: what to say.
        bare: without the unit.
    """
    ends = (answer.stood_to, answer.overturned_from)
    words = ("", "")
    for figures in range(3, MOST_FIGURES + 1):
        stood, fell = ("" if end is None else in_words(axis, [end], figures, bare=bare) for end in ends)
        words = stood, fell
        if stood != fell:
            break
    return words


def ranges_in_words(ranges: Sequence[Range], axis: Axis, *, bare: bool = False) -> str:
    """Ranges of values: "0.5 to 0.55 g, 0.61 g"; those after the fourth are counted."""
    texts = [in_words(axis, sorted({*span}), bare=bare) for span in ranges[:MOST_RANGES]]
    more = len(ranges) - len(texts)
    return ", ".join(texts) + (f" and {more} more" if more else "")


def table_lines(rows: Iterable[tuple[str, str]], file: str = "") -> Iterator[str]:
    """Lines for a screen, each a place and its answer; after the first forty, the number left and the file of all."""
    listed = list(rows)
    widest = max((len(where) for where, _ in listed), default=0)
    yield from (f"  {where:{widest}}  {sentence}" for where, sentence in listed[:MOST_ROWS])
    if more := len(listed[MOST_ROWS:]):
        yield f"  {more} more rows" + (f" in {file}" if file else "")


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
