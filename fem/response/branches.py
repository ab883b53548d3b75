"""What two sweeps over the same frequencies show: coexisting motions, jumps, drop-outs."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np

from fem.response.records import PointRecord
from fem.results.figures import TURNED
from fem.results.json_block import JsonBlock

APART = 0.02  #: difference of rotation ratios that counts at least
APART_STROKE = 0.05  #: of slip strokes, over the floor's amplitude
JUMP = 0.05  #: change of the rotation ratio from one frequency to the next that is a jump at least
JUMP_SHARE = 4.0  #: a jump is also so many times the changes before and after it: a steep curve does not jump


@dataclass(frozen=True, kw_only=True)
class Coexistence(JsonBlock):
    """Neighbouring frequencies at which the two sweeps found different motions."""

    from_Hz: float
    to_Hz: float
    frequencies: int
    up: tuple[str, ...]  #: motions found on the way up, in words
    down: tuple[str, ...]
    largest_difference: float | None = None  #: of rotation ratios; None where one of each pair overturned


@dataclass(frozen=True, kw_only=True)
class Jump(JsonBlock):
    """A change between neighbouring frequencies that the sweep went through."""

    direction: str
    from_Hz: float
    to_Hz: float
    what: str
    rotation_ratio: tuple[float, float]  #: before and after


@dataclass(frozen=True, kw_only=True)
class DropOut(JsonBlock):
    """Neighbouring frequencies at which the container overturned."""

    direction: str
    from_Hz: float
    to_Hz: float
    frequencies: int
    carried: bool  #: the first of them overturned a motion that had been carried there


def coexistences(records: Sequence[PointRecord]) -> list[Coexistence]:
    """Ranges of frequencies at which up and down differ."""
    up, down = (
        {record.row.number: record for record in records if record.row.direction == direction}
        for direction in ("up", "down")
    )
    pairs = [(up[number], down[number]) for number in sorted(up.keys() & down.keys())]
    return [_coexistence(list(run)) for apart, run in groupby(pairs, lambda pair: differ(*pair)) if apart]


def differ(up: PointRecord, down: PointRecord) -> bool:
    """Whether two points at one frequency are different motions; one that is not valid says nothing."""
    if up.row.says_nothing or down.row.says_nothing:
        return False
    if not (up.stands and down.stands):
        return up.stands != down.stands
    if (up.row.long_time == "rest") != (down.row.long_time == "rest"):
        return True
    spread = max(record.row.turned - record.number("median_rotation_ratio") for record in (up, down))
    if _apart(up, down, TURNED) > max(APART, spread):
        return True
    strokes = [record.extremes[:, 4] for record in (up, down)]
    spread = max(float(stroke.max() - np.median(stroke)) for stroke in strokes)
    return _apart(up, down, "slip_stroke_m") > max(APART_STROKE * up.row.amplitude_m, spread)


def jumps(records: Sequence[PointRecord]) -> list[Jump]:
    """Changes of kind or of size between neighbouring frequencies through which a motion was carried."""
    jumped = []
    for direction in ("up", "down"):
        swept = [record for record in records if record.row.direction == direction]
        carried = [
            (before, after)
            for before, after in pairwise(swept)
            if before.stands and after.stands and after.row.began == "carried"
        ]
        changes = [_apart(before, after, TURNED) for before, after in carried]
        for k, ((before, after), change) in enumerate(zip(carried, changes, strict=True)):
            kinds = before.row.words, after.row.words
            beside = max([*changes[max(k - 1, 0) : k], *changes[k + 1 : k + 2]], default=0.0)
            if kinds[0] == kinds[1] and change <= max(JUMP, JUMP_SHARE * beside):
                continue
            jumped.append(
                Jump(
                    direction=direction,
                    from_Hz=before.row.frequency_Hz,
                    to_Hz=after.row.frequency_Hz,
                    what=f"{kinds[0]} to {kinds[1]}" if kinds[0] != kinds[1] else "in size",
                    rotation_ratio=(before.row.turned, after.row.turned),
                )
            )
    return jumped


def drop_outs(records: Sequence[PointRecord]) -> list[DropOut]:
    """Ranges of neighbouring frequencies, along each sweep, at which the container overturned."""
    falls = []
    for (direction, fell), run in groupby(records, lambda record: (record.row.direction, record.row.fell)):
        if fell:
            rows = [record.row for record in run]
            falls.append(
                DropOut(
                    direction=direction,
                    from_Hz=rows[0].frequency_Hz,
                    to_Hz=rows[-1].frequency_Hz,
                    frequencies=len(rows),
                    carried=rows[0].began == "carried",
                )
            )
    return falls


def _coexistence(pairs: Sequence[tuple[PointRecord, PointRecord]]) -> Coexistence:
    apart = [_apart(up, down, TURNED) for up, down in pairs if up.stands and down.stands]
    return Coexistence(
        from_Hz=pairs[0][0].row.frequency_Hz,
        to_Hz=pairs[-1][0].row.frequency_Hz,
        frequencies=len(pairs),
        up=tuple(dict.fromkeys(up.row.words for up, _ in pairs)),
        down=tuple(dict.fromkeys(down.row.words for _, down in pairs)),
        largest_difference=max(apart) if apart else None,
    )


def _apart(first: PointRecord, second: PointRecord, column: str) -> float:
    return abs(first.number(column) - second.number(column))
