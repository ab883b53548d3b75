"""What lasts at each frequency, whatever led to it, and where it overturns: from all points of a response curve."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, astuple, dataclass, fields, replace
from itertools import groupby
from typing import Any, ClassVar

import numpy as np

from contact.stepping.modes import ROCKING
from contact.stepping.state import Control
from fem.case.case import Case
from fem.html.page import text_of
from fem.response.orbit import (
    EXTREME_COLUMNS,
    GROWTH,
    SECTION_COLUMNS,
    Decay,
    LongTime,
    Orbit,
    amplitude_growth,
)
from fem.response.request import ASKED, SAMPLES_PER_PERIOD, ResponseRequest
from fem.results.figures import TURNED
from fem.results.json_block import JsonBlock
from fem.results.outcome import Outcome
from fem.runtime.arrays import FloatArray
from fem.runtime.units import MILLIMETRES
from fem.runtime.user_files import parsed_json
from fem.study.answers import slip_in_words
from fem.study.driver import COMPLETED, FAILED, INTERRUPTED, StudyResult
from fem.study.table import table_text

PORTRAYED = 16  #: last periods whose phase portrait is kept; of a periodic motion, one of its periods
PORTRAIT_COLUMNS = ("rotation_rad", "angular_velocity_rad_s")
ARRAYS = {"sections": SECTION_COLUMNS, "extremes": EXTREME_COLUMNS, "portrait": PORTRAIT_COLUMNS}


@dataclass(frozen=True, kw_only=True)
class PointRow(JsonBlock):
    """A row of `response.csv`; None where a column does not apply."""

    direction: str  #: up | down; start: from a state of its own
    number: int  #: of the frequency, from 0 for the lowest
    frequency_Hz: float
    amplitude_m: float
    peak_acceleration_m_s2: float
    #: carried | case; of a start: random | risen, sunk: from a motion at the frequency below, above
    began: str
    status: str  #: completed | overturned | failed
    motion: str | None = None
    #: rest | periodic | not settled | not periodic; None without a long-time motion
    long_time: str | None = None
    period_n: int | None = None
    scatter: float | None = None
    settling: float | None = None
    pairs_compared: int | None = None
    periods: int
    rotation_ratio: float | None = None
    median_rotation_ratio: float | None = None
    max_rotation_rad: float | None = None
    least_rotation_rad: float | None = None
    most_rotation_rad: float | None = None
    slip_stroke_m: float | None = None
    slip_walk_m: float | None = None
    slip_excursion_m: float | None = None  #: within the periods observed, from where it was at their start
    impacts_per_period: float | None = None
    growth: float | None = None
    bounded: bool | None = None
    undriven: str | None = None
    undriven_s: float | None = None
    stable: bool | None = None
    reason: str | None = None
    model: str = ""
    eta: float | None = None  #: angular frequency of the floor over the frequency parameter of the container
    start_rotation_rad: float | None = None
    start_angular_velocity_rad_s: float | None = None

    @property
    def says_nothing(self) -> bool:
        """Whether it failed, or is not valid: a corner was destroyed."""
        return self.status == "failed" or self.motion == Outcome.INVALID

    @property
    def fell(self) -> bool:
        """Whether it overturned, without a corner destroyed before."""
        return self.status == "overturned" and not self.says_nothing

    @property
    def turned(self) -> float:
        """Largest |rotation| over the slenderness angle; 0 where none is known."""
        return self.rotation_ratio or 0.0

    @property
    def words(self) -> str:
        """The long-time motion: `rest`, `rock of period 1`, `slide-rock, not periodic`, `a corner destroyed`."""
        if self.motion == Outcome.INVALID:
            return "a corner destroyed"
        if self.long_time == "periodic":
            return f"{self.motion} of period {self.period_n}"
        if self.long_time in (None, "rest"):
            return self.long_time or self.status
        return f"{self.motion}, {self.long_time}"


@dataclass(frozen=True, kw_only=True, eq=False)
class PointRecord:
    """One point: its row and its arrays, by `ARRAYS`."""

    row: PointRow
    sections: FloatArray  #: (n, 4)
    extremes: FloatArray  #: (n, 7)
    portrait: FloatArray  #: (n_samples, 2), of whole periods

    @property
    def stands(self) -> bool:
        """It has a long-time motion, and no corner was destroyed in it."""
        return self.row.long_time is not None and not self.row.says_nothing

    def number(self, column: str) -> float:
        """A number of the row; nan where it does not apply."""
        value = getattr(self.row, column)
        return math.nan if value is None else float(value)


def record_of(
    case: Case, orbit: Orbit, control: Control, judged: LongTime | None, decay: Decay | None, **known: Any
) -> PointRecord:
    """What is kept of a point.

    Args:
        orbit: of the window observed; where it overturned or failed, what there is of it.
        judged: None where it overturned, failed or destroyed a corner.
        decay: with the drive stopped.
        known: further columns.
    """
    extremes, omega = orbit.extremes, case.motion.angular_frequency
    ratios = abs(extremes[:, 0]) / control.slenderness_angle
    if judged is not None:
        known |= asdict(judged) | {
            TURNED: float(ratios.max()),
            "median_rotation_ratio": float(np.median(ratios)),
            "max_rotation_rad": float(extremes[:, 0].max()),
            "least_rotation_rad": float(extremes[:, 1].min()),
            "most_rotation_rad": float(extremes[:, 2].max()),
            "slip_stroke_m": float(extremes[:, 4].max()),
            "slip_walk_m": float(orbit.sections[:, 3].mean()),
            "slip_excursion_m": float(extremes[:, 6].max()),
            "impacts_per_period": float(extremes[:, 5].mean()),
            "growth": amplitude_growth(ratios),
        }
    if decay is not None:
        known |= {"undriven": decay[0], "undriven_s": decay[1]}
    if known["direction"] == "start":
        known["start_rotation_rad"] = case.initial.rotation_rad
        known["start_angular_velocity_rad_s"] = case.initial.angular_velocity_rad_s
    if orbit.status != "failed" and known["motion"] != Outcome.INVALID:
        bounded = judged is not None and amplitude_growth(ratios) <= GROWTH
        known["bounded"] = bounded
        if not bounded or (decay is not None and decay[0] != "failed"):
            known["stable"] = bounded and decay is not None and decay[0] == "dies out"
    row = PointRow(
        frequency_Hz=omega / (2.0 * math.pi),
        amplitude_m=case.motion.amplitude,
        peak_acceleration_m_s2=case.motion.amplitude * omega**2,
        status=orbit.status,
        model=case.solver.model,
        eta=omega / control.frequency_parameter,
        **known,
    )
    periods = PORTRAYED if judged is None else {"rest": 1}.get(judged.long_time, judged.period_n or PORTRAYED)
    portrait = orbit.portrait[-periods * SAMPLES_PER_PERIOD :]
    return PointRecord(row=row, sections=orbit.sections, extremes=extremes, portrait=portrait)


def tables_of(request: ResponseRequest, records: Sequence[PointRecord]) -> dict[str, str]:
    """The tables by name: a row a point, in the order in which they were computed; a row a period in `sections.csv`."""
    own = of_first_model(records)
    starts = [record for record in own if record.row.direction == "start"]
    points: dict[str, Sequence[PointRecord]] = {"response.csv": _swept(own)}
    points |= {"starts.csv": starts} if request.starts else {}
    points |= {"shell.csv": records[len(own) :]} if request.shell else {}
    names = [field.name for field in fields(PointRow)]
    tables = {
        name: table_text(names, (astuple(record.row) for record in rows)) for name, rows in points.items()
    }
    columns = ("direction", "frequency_Hz", "period", *SECTION_COLUMNS, *EXTREME_COLUMNS)
    periods = (
        (record.row.direction, record.row.frequency_Hz, k, *section, *extreme)
        for record in shown(own)
        for k, (section, extreme) in enumerate(zip(record.sections, record.extremes, strict=True), start=1)
    )
    return tables | {"sections.csv": table_text(columns, periods)}


def packed(records: Sequence[PointRecord]) -> dict[str, np.ndarray]:
    """Points as a few plain arrays, which `unpacked` reads."""
    rows = [asdict(record.row) for record in records]
    counts = np.array([[len(getattr(record, name)) for name in ARRAYS] for record in records], dtype=int)
    parts = {name: [getattr(record, name) for record in records] for name in ARRAYS}
    joined = {
        name: np.concatenate(parts[name]) if records else np.zeros((0, len(columns)))
        for name, columns in ARRAYS.items()
    }
    return {"rows": np.array(json.dumps(rows)), "counts": counts} | joined


def unpacked(arrays: dict[str, np.ndarray]) -> list[PointRecord]:
    """The points that `packed` made these arrays of; ValueError, LookupError or TypeError where it did not."""
    rows, counts = parsed_json(str(arrays["rows"])), arrays["counts"]
    parts = dict[str, list[np.ndarray]]()
    for (name, columns), lengths in zip(ARRAYS.items(), counts.T, strict=True):
        if arrays[name].shape != (lengths.sum(), len(columns)) or arrays[name].dtype != float:
            raise ValueError(f"{name} is no table of its points")
        parts[name] = np.split(arrays[name], np.cumsum(lengths)[:-1])
    return [
        PointRecord(row=PointRow.from_json(row), **dict(zip(ARRAYS, own, strict=True)))
        for row, *own in zip(rows, *parts.values(), strict=True)
    ]


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
    groups = [group for number in _numbers(records) for group in lasting_at(records, number)]
    return _swept(records) + [group[0] for group in groups if not _swept(group)]


def _swept(records: Sequence[PointRecord]) -> list[PointRecord]:
    return [record for record in records if record.row.direction != "start"]


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
            turned = [[motion.rotation_ratio for motion in at.motions] for at in found]
            yield Coexistence(
                **_range_of(found),
                motions=tuple(dict.fromkeys(motion.motion for at in found for motion in at.motions)),
                largest_difference=max(ratios[0] - ratios[-1] for ratios in turned),
            )


def drop_outs(records: Sequence[PointRecord]) -> Iterator[DropOut]:
    """Ranges of neighbouring frequencies, along each sweep, at which the container overturned."""
    swept = (record.row for record in _swept(records))
    for (direction, fell), run in groupby(swept, lambda row: (row.direction, row.fell)):
        if fell:
            rows = list(run)
            yield DropOut(direction=direction, **_range_of(rows), carried=rows[0].began == "carried")


def _range_of(found: Sequence[AtFrequency | PointRow]) -> dict[str, Any]:
    return {"from_Hz": found[0].frequency_Hz, "to_Hz": found[-1].frequency_Hz, "frequencies": len(found)}


@dataclass(frozen=True, kw_only=True)
class ResponseResult(StudyResult):
    """All results of a response curve."""

    asked: str  #: hash of the request
    case: str = ""  #: its name
    title: str = ""
    request: dict[str, Any]  #: without the case
    columns_of: ClassVar[Mapping[str, Mapping[str, Any]]] = {"request": ASKED}
    needed = frozenset(ASKED) - {"shell"}
    points: tuple[PointRow, ...] = ()  #: up and down, in the order in which they were swept
    frequencies: tuple[AtFrequency, ...] = ()  #: what lasts at each, whatever led to it
    coexisting: tuple[Coexistence, ...] = ()
    drop_outs: tuple[DropOut, ...] = ()
    #: of the points with an outcome that do not stand: overturned, a corner destroyed
    overturned_share: float | None = None
    starts_fell_share: float | None = None  #: of the random states, all frequencies; None without any
    #: of the shell's rotations over those of the case's model, least and largest; empty without a shell
    shell_over_rigid: tuple[float, ...] = ()


def result_of(
    begun: ResponseResult, records: Sequence[PointRecord], missing: str | None = None
) -> ResponseResult:
    """The result of the points that there are; `missing`: what an interrupted curve lacks, in words."""
    own = of_first_model(records)
    points, frequencies = tuple(record.row for record in _swept(own)), tuple(frequencies_of(own))
    failed = any(record.row.status == "failed" for record in own)
    starts, fell = sum(at.starts for at in frequencies), sum(at.fell + at.destroyed for at in frequencies)
    result = replace(
        begun,
        status=INTERRUPTED if missing else FAILED if failed else COMPLETED,
        missing=missing,
        points=points,
        frequencies=frequencies,
        coexisting=tuple(coexistences(frequencies)),
        drop_outs=tuple(drop_outs(own)),
        overturned_share=None if missing else overturned_share(points),
        starts_fell_share=fell / starts if starts else None,
        shell_over_rigid=shell_over_rigid(records),
    )
    return replace(result, answer=response_answer(result))


#: what stable means, as Knoedel and Hrabowski define Lyapunov stability
STABLE = "amplitudes do not diverge, and without drive the motion dies out"


def overturned_share(points: Sequence[PointRow]) -> float | None:
    """Of some points with an outcome, those that overturn or destroy a corner; None where there is none."""
    known = [point for point in points if point.status != "failed"]
    return sum(point.fell or point.says_nothing for point in known) / len(known) if known else None


def response_answer(result: ResponseResult) -> str | None:
    """The answer of a response curve, by its template; None of an unfinished one and one without an outcome."""
    points = [point for point in result.points if point.status != "failed"]
    if result.state != "finished" or not points:
        return None
    standing = [point for point in points if not point.fell and not point.says_nothing]
    slid = max(standing, key=lambda point: point.slip_stroke_m or 0.0, default=None)
    moved = slid if slid and (slid.slip_stroke_m or 0.0) >= MILLIMETRES.least else None
    return text_of("response_answer.txt.j2", result=result, slid=moved, slip=slip_in_words)


def stable_in_words(result: ResponseResult) -> str | None:
    """How many of the points judged are stable, behind what that means; None where none was judged."""
    judged = [point.stable for point in result.points if point.stable is not None]
    return f"{sum(judged)} of {len(judged)} points: {STABLE}" if judged else None
