"""What lasts at each frequency, whatever led to it, and where it overturns: from all points of a response curve."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import numpy as np

from contact.stepping.modes import ROCKING
from fem.response.records import PointRecord, PointRow
from fem.results.figures import TURNED
from fem.results.json_block import JsonBlock
from fem.study.driver import StudyResult

APART = 0.02  #: difference of rotation ratios that counts at least
APART_STROKE = 0.05  #: of slip strokes, over the floor's amplitude


@dataclass(frozen=True, kw_only=True)
class Lasting(JsonBlock):
    """A motion that lasts at a frequency."""

    motion: str  #: in words
    period_n: int | None = None
    rotation_ratio: float
    ways: tuple[str, ...] = ()  #: up, down: the sweeps that it lies on
    starts: int = 0  #: random states that lead to it


@dataclass(frozen=True, kw_only=True)
class AtFrequency(JsonBlock):
    """What random states and both sweeps led to at one frequency."""

    frequency_Hz: float
    eta: float
    starts: int  #: random states with an outcome
    fell: int  #: of them
    destroyed: int  #: a corner
    motions: tuple[Lasting, ...]  #: the largest first


@dataclass(frozen=True, kw_only=True)
class Coexistence(JsonBlock):
    """Neighbouring frequencies at which more than one motion lasts."""

    from_Hz: float
    to_Hz: float
    frequencies: int
    motions: tuple[str, ...]  #: in words
    largest_difference: float  #: of rotation ratios


@dataclass(frozen=True, kw_only=True)
class DropOut(JsonBlock):
    """Neighbouring frequencies at which the container overturned."""

    direction: str
    from_Hz: float
    to_Hz: float
    frequencies: int
    carried: bool  #: the first of them overturned a motion that had been carried there


def differ(one: PointRecord, other: PointRecord) -> bool:
    """Whether two points that stand at one frequency are different motions."""
    if (one.row.long_time == "rest") != (other.row.long_time == "rest"):
        return True
    spread = max(record.row.turned - record.number("median_rotation_ratio") for record in (one, other))
    if abs(one.number(TURNED) - other.number(TURNED)) > max(APART, spread):
        return True
    strokes = [record.extremes[:, 4] for record in (one, other)]
    spread = max(float(stroke.max() - np.median(stroke)) for stroke in strokes)
    apart = abs(one.number("slip_stroke_m") - other.number("slip_stroke_m"))
    return apart > max(APART_STROKE * one.row.amplitude_m, spread)


def of_first_model(records: Sequence[PointRecord]) -> list[PointRecord]:
    """The points of the model that the case asks for, without those of the shell beside it."""
    return [record for record in records if record.row.model == records[0].row.model]


def shell_over_rigid(records: Sequence[PointRecord]) -> tuple[float, ...]:
    """Least and largest rotation of the shell over that of the case's model, where both rock; empty without any."""
    own = of_first_model(records)
    turned = {(one.row.direction, one.row.number): one.row.turned for one in own if one.stands}
    shell = [record.row for record in records[len(own) :] if record.stands]
    pairs = [(row.turned, turned.get((row.direction, row.number), 0.0)) for row in shell]
    shares = [of_shell / rigid for of_shell, rigid in pairs if rigid > ROCKING]
    return (min(shares), max(shares)) if shares else ()


def lasting_at(records: Sequence[PointRecord], number: int) -> list[list[PointRecord]]:
    """Points of one frequency that stand, by motion; of each the sweeps first, then the one that repeats best."""
    groups: list[list[PointRecord]] = []
    for record in records:
        if record.row.number == number and record.stands:
            same = [group for group in groups if not differ(group[0], record)]
            if same:
                same[0].append(record)
            else:
                groups.append([record])

    def roughness(record: PointRecord) -> tuple[bool, float, float]:
        return record.row.direction == "start", record.row.period_n or math.inf, record.number("scatter")

    return [sorted(group, key=roughness) for group in groups]


def shown(records: Sequence[PointRecord]) -> list[PointRecord]:
    """The points of both sweeps, and one of each motion that they do not meet."""
    swept = [record for record in records if record.row.direction != "start"]
    groups = [group for number in _numbers(records) for group in lasting_at(records, number)]
    away = [group[0] for group in groups if all(record.row.direction == "start" for record in group)]
    return swept + away


def _numbers(records: Sequence[PointRecord]) -> list[int]:
    return sorted({record.row.number for record in records})


def frequencies_of(records: Sequence[PointRecord]) -> Iterator[AtFrequency]:
    """What lasts at each frequency, rising."""
    for number in _numbers(records):
        rows = [record.row for record in records if record.row.number == number]
        random = [row for row in rows if row.began == "random" and row.status != "failed"]
        motions = [
            Lasting(
                motion=group[0].row.words,
                period_n=group[0].row.period_n,
                rotation_ratio=group[0].row.turned,
                ways=tuple(
                    way for way in ("up", "down") if any(record.row.direction == way for record in group)
                ),
                starts=sum(record.row.began == "random" for record in group),
            )
            for group in lasting_at(records, number)
        ]
        yield AtFrequency(
            frequency_Hz=rows[0].frequency_Hz,
            eta=rows[0].eta or 0.0,
            starts=len(random),
            fell=sum(row.fell for row in random),
            destroyed=sum(row.says_nothing for row in random),
            motions=tuple(sorted(motions, key=lambda motion: -motion.rotation_ratio)),
        )


def coexistences(frequencies: Sequence[AtFrequency]) -> Iterator[Coexistence]:
    """Ranges of frequencies at which more than one motion lasts."""
    for several, run in groupby(frequencies, lambda at: len(at.motions) > 1):
        if several:
            found = list(run)
            yield Coexistence(
                from_Hz=found[0].frequency_Hz,
                to_Hz=found[-1].frequency_Hz,
                frequencies=len(found),
                motions=tuple(dict.fromkeys(motion.motion for at in found for motion in at.motions)),
                largest_difference=max(
                    at.motions[0].rotation_ratio - at.motions[-1].rotation_ratio for at in found
                ),
            )


def drop_outs(records: Sequence[PointRecord]) -> Iterator[DropOut]:
    """Ranges of neighbouring frequencies, along each sweep, at which the container overturned."""
    swept = [record.row for record in records if record.row.direction != "start"]
    for (direction, fell), run in groupby(swept, lambda row: (row.direction, row.fell)):
        if fell:
            rows = list(run)
            yield DropOut(
                direction=direction,
                from_Hz=rows[0].frequency_Hz,
                to_Hz=rows[-1].frequency_Hz,
                frequencies=len(rows),
                carried=rows[0].began == "carried",
            )


@dataclass(frozen=True, kw_only=True)
class ResponseResult(StudyResult):
    """All results of a response curve."""

    asked: str  #: hash of the request
    case: str = ""  #: its name
    title: str = ""
    request: dict[str, Any] = field(default_factory=dict)  #: without the case
    points: tuple[PointRow, ...] = ()  #: up and down, in the order in which they were swept
    frequencies: tuple[AtFrequency, ...] = ()  #: what lasts at each, whatever led to it
    coexisting: tuple[Coexistence, ...] = ()
    drop_outs: tuple[DropOut, ...] = ()
    #: of the points with an outcome that do not stand: overturned, a corner destroyed
    overturned_share: float | None = None
    starts_fell_share: float | None = None  #: of the random states, all frequencies; None without any
    #: of the shell's rotations over those of the case's model, least and largest; empty without a shell
    shell_over_rigid: tuple[float, ...] = ()
