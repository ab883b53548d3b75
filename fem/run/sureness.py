"""How sure a verdict is: what its band shows, and which inputs decide; and where along an axis the outcome changes.

A member behaves as the run does if its outcome is the same and neither rotation nor slip differs by an order of
magnitude: a container that rocks and slips 2 mm at its impacts does not move like one that slips 200 mm. Of a loose
stack this holds for every box and every joint, and a fall is the same if the same box falls.

Along an axis the outcome changes at some values: a scan finds them, refinement locates them. An island narrower than
the step of the scan may be missed.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any

import numpy as np

from fem.case.tables.input_ranges import TOLERANCE
from fem.case.tables.unknown_inputs import INPUTS
from fem.case.uncertainty import InputChange
from fem.results.figures import BOX_FIGURES, FELL_FIRST, Place, RunFigures, keys_of
from fem.results.json_block import JsonBlock
from fem.results.level import LARGE_ROTATION, REGIME_UNSURE, SURE, UNSURE, ending, numerical, stands
from fem.results.outcome import ROCKING, Outcome
from fem.results.run_result import Band, BoxReach, ChangedRun, HeldReach, RunResult, StaticResult, Verdict
from fem.runtime.units import Reach

ANOTHER_SIZE = 10.0
#: slip over the width from which another size is another way to stand
LARGE_SLIP = 0.01
#: how a member differs from the run
SAME, OTHER_REGIME, OTHER_END = 0, 1, 2
ORDER = {key: k for k, key in enumerate(INPUTS)}
MOST_DRAWN = 3  #: inputs named where only draws differ


def judged(
    verdict: Verdict,
    members: Sequence[ChangedRun],
    changes: Sequence[InputChange],
    left_out: Sequence[InputChange],
    *,
    width: float,
) -> Verdict:
    """The verdict of a run with its band.

    Args:
        members: of the band, the run itself first, then one for each change.
        left_out: changes that there was no time for.
        width: of the container [m].
    """
    own, others = members[0], members[1:]
    levels = [difference(own, other, width) for other in others]
    pairs = zip(levels, changes, strict=True)
    numerically = OTHER_END in (level for level, change in pairs if numerical(change))
    missing = [run for run in left_out if run.kind != "draw"]
    no_outcome = any(other.outcome is None for other in others)
    unknown = no_outcome or missing or below_uplift(members) or own.outcome == Outcome.INVALID
    sure = UNSURE if unknown else how_sure(levels)
    outcomes = {member.outcome for member in members}
    alike = [member for member in members if ending(member) == ending(own) and member.outcome is not None]
    draws = [other for other in others if other.kind == "draw"]
    ranges: dict[str, Any] = {}
    for key in keys_of(Place.BAND):
        ranges[key] = _reach(alike, key)
    fell, boxes = Counter(member.fell_box for member in members), []  # by which box fell first
    for number, same in enumerate(zip(*(member.boxes for member in alike if member.boxes), strict=True), 1):
        values = {name: [box[name] for box in same] for name in BOX_FIGURES}
        reach = {name: (min(numbers), max(numbers)) for name, numbers in values.items()}
        boxes.append(BoxReach(fell=fell[number], **reach))
    each = zip(*(member.links for member in alike if member.links), strict=True)
    links = [HeldReach(**{one.name: _reach(same, one.name) for one in fields(HeldReach)}) for same in each]
    band = Band(
        outcomes=tuple(outcome for outcome in Outcome if outcome in outcomes),
        unsure=sure == UNSURE,
        draws=len(draws),
        draws_overturned=sum(draw.outcome == Outcome.OVERTURNED for draw in draws),
        draws_invalid=sum(draw.outcome == Outcome.INVALID for draw in draws),
        left_out=tuple(run.label for run in missing),
        draws_left_out=len(left_out) - len(missing),
        members=tuple(members),
        boxes=tuple(boxes) or None,
        links=tuple(links) or None,
        **ranges,
    )
    stiff = [key for change in changes if change.kind == "floor" for key in change.inputs]
    deciding = [*deciding_inputs(levels, changes), *(stiff if below_uplift(members) else [])]
    return replace(
        verdict,
        sure=sure,
        numerically_unsure=numerically,
        decided_by=tuple(key for key in dict.fromkeys(deciding) if key != TOLERANCE),
        band=band,
    )


def _reach(runs: Sequence[JsonBlock], key: str) -> Reach | None:
    """Least and largest value of those that have one."""
    known = [value for run in runs if (value := run[key]) is not None]
    return (min(known), max(known)) if known else None


def how_sure(levels: Iterable[int]) -> str:
    """The word for an outcome whose variations differ from it by these levels: the worst decides."""
    return (SURE, REGIME_UNSURE, UNSURE)[max(levels, default=SAME)]


def below_uplift(members: Sequence[ChangedRun]) -> bool:
    """True if the run rocks although a rigid block on a rigid floor would rest; a member has a stiff floor."""
    on_stiff_floor = any(member.kind == "floor" for member in members)
    return on_stiff_floor and members[0].outcome in ROCKING


def rests_on_stiff_floor(members: Sequence[ChangedRun]) -> bool:
    """True if on a practically rigid floor the container rests, or slides without rocking."""
    still = (Outcome.REST, Outcome.SLIDE)
    return any(member.kind == "floor" and member.outcome in still for member in members)


def static_use(result: RunResult) -> float | None:
    """The larger utilisation of the static rule under the peaks of this run; None where it is not known."""
    own = (result.static or StaticResult()).ruling
    if own.utilisation_sliding is None or own.utilisation_overturning is None:
        return None
    return max(own.utilisation_sliding, own.utilisation_overturning)


def difference(own: RunFigures, other: RunFigures, width: float) -> int:
    """How another run differs from a run, of SAME, OTHER_REGIME, OTHER_END; a failed one does not say.

    `width` is that of the container [m].
    """
    if other.outcome is None:
        return SAME
    if ending(own) != ending(other):
        return OTHER_END
    if not stands(own):
        return SAME if all(own[key] == other[key] for key in FELL_FIRST) else OTHER_REGIME
    pairs = zip(_sizes(own, width), _sizes(other, width), strict=True)
    another = any(high > 1.0 and high > ANOTHER_SIZE * low for low, high in map(sorted, pairs))
    return OTHER_REGIME if own.outcome != other.outcome or another else SAME


def _sizes(run: RunFigures, width: float) -> Iterator[float]:
    """Slips, rotations and openings, each over the size from which it is large."""
    ratio, boxes = run.turned, run.boxes or ()
    yield run.slipped / (LARGE_SLIP * width)
    yield ratio / LARGE_ROTATION
    most = max((box.max_rotation_rad for box in boxes), default=0.0)
    large = LARGE_ROTATION * most / ratio if ratio else math.inf  #: rotation [rad]
    for box in boxes:
        yield box.max_slip_m / (LARGE_SLIP * width)
        yield box.max_rotation_rad / large
        yield box.max_opening_m / (large * width)


def deciding_inputs(levels: Sequence[int], changes: Sequence[InputChange]) -> Iterator[str]:
    """Inputs that change the outcome: overturning before the regime, then the smallest change first.

    Where no change of one input does, those of the pair that does; where only draws do, those that differ most between
    the draws that do and those that do not.
    """
    named: list[str] = []
    for level in (OTHER_END, OTHER_REGIME):
        differing = [change for change, reached in zip(changes, levels, strict=True) if reached == level]
        smallest: dict[str, float] = {}
        for kind in (("one", "floor"), ("pair",)):
            for change in differing if not smallest else ():
                if change.kind in kind:
                    smallest |= {key: min(change.share, smallest.get(key, 1.0)) for key in change.inputs}
        keys = sorted(smallest, key=lambda key: (smallest[key], ORDER.get(key, -1)))
        named += keys or _drawn_together(changes, [own == level for own in levels])
    yield from dict.fromkeys(named)


def _drawn_together(changes: Sequence[InputChange], differs: Sequence[bool]) -> list[str]:
    """Inputs whose places in their ranges differ most between draws that differ from the run and the others."""
    draws = [(change, other) for change, other in zip(changes, differs, strict=True) if change.kind == "draw"]
    if not any(differ for _, differ in draws):
        return []
    places = np.array([draw.place for draw, _ in draws])
    differ = np.array([other for _, other in draws])
    rest = places[~differ].mean(axis=0) if not differ.all() else 0.5
    apart = np.abs(places[differ].mean(axis=0) - rest)
    inputs = draws[0][0].inputs
    strongest = np.argsort(-apart)[:MOST_DRAWN]
    return [inputs[k] for k in strongest if apart[k] >= 0.5 * apart.max()]


@dataclass(frozen=True, kw_only=True)
class Change:
    """A bracket within which the outcome changes."""

    low: float
    high: float
    below: str  #: outcome at the lower end: standing | overturned | failed
    above: str

    @property
    def value(self) -> float:
        """The middle of the bracket."""
        return 0.5 * (self.low + self.high)


def least_width(values: Sequence[float], resolution: float) -> float:
    """Largest width of a bracket around zero, where no share of its value is meaningful."""
    steps = [high - low for low, high in pairwise(values)]
    return resolution * min([*steps, *(abs(value) for value in values if value)])


def values_to_try(
    known: Mapping[float, str], *, resolution: float, inner: int, least: float = 0.0
) -> list[float]:
    """Values within the brackets that are too wide; empty if all are narrow enough.

    Args:
        known: outcome by value.
        resolution: largest width of a bracket, relative to its larger end (in magnitude).
        inner: values tried within a bracket at a time.
        least: width at which any bracket is narrow enough, from `least_width`.
    """
    return [
        float(value)
        for change in changes_of(known)
        if change.high - change.low > max(resolution * max(abs(change.low), abs(change.high)), least)
        for value in np.linspace(change.low, change.high, inner + 2)[1:-1]
        if change.low < value < change.high  # not between two neighbouring floating-point numbers
    ]


def rounds_left(known: Mapping[float, str], *, resolution: float, inner: int) -> float:
    """How often `values_to_try` will give values, roughly: by the widest bracket."""
    wide = (
        (one.high - one.low) / (resolution * max(abs(one.low), abs(one.high))) for one in changes_of(known)
    )
    return max(0.0, math.log(max(wide, default=1.0)) / math.log(inner + 1))


def changes_of(known: Mapping[float, str]) -> list[Change]:
    """Neighbouring values of different outcome."""
    values = sorted(known)
    return [
        Change(low=low, high=high, below=known[low], above=known[high])
        for low, high in pairwise(values)
        if known[low] != known[high]
    ]
