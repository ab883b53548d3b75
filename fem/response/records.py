"""The points of a response curve as they are kept: a row of results each, its sections and its phase portrait."""

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass, fields
from typing import Any

import numpy as np

from contact.stepping.state import Control
from fem.case.case import Case
from fem.response.orbit import EXTREME_COLUMNS, SECTION_COLUMNS, Orbit
from fem.response.request import SAMPLES_PER_PERIOD
from fem.response.stability import Decay, LongTime, amplitude_growth, amplitudes_diverge
from fem.results.figures import TURNED
from fem.results.json_block import JsonBlock
from fem.results.outcome import Outcome
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import parsed_json
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
        case: with the drive, and the start of its own if it has one.
        orbit: of the window observed; where it overturned or failed, what there is of it.
        control: of its model.
        judged: None where it overturned, failed or destroyed a corner.
        decay: with the drive stopped.
        known: further columns.
    """
    extremes, omega = orbit.extremes, case.motion.angular_frequency
    ratios = abs(extremes[:, 0]) / control.slenderness_angle
    if judged is not None:
        known |= {
            "long_time": judged.kind,
            "period_n": judged.period,
            "scatter": judged.scatter,
            "settling": judged.settling,
            "pairs_compared": judged.compared,
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
        bounded = judged is not None and not amplitudes_diverge(ratios)
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
    periods = PORTRAYED if judged is None else {"rest": 1}.get(judged.kind, judged.period or PORTRAYED)
    portrait = orbit.portrait[-periods * SAMPLES_PER_PERIOD :]
    return PointRecord(row=row, sections=orbit.sections, extremes=extremes, portrait=portrait)


def csv_of_rows(records: Sequence[PointRecord]) -> str:
    """A row a point, in the order in which they were computed."""
    return table_text([field.name for field in fields(PointRow)], (astuple(record.row) for record in records))


def csv_of_sections(records: Sequence[PointRecord]) -> str:
    """`sections.csv`: a row a period of the window observed, sections and extremes."""
    columns = ("direction", "frequency_Hz", "period", *SECTION_COLUMNS, *EXTREME_COLUMNS)
    rows = (
        (record.row.direction, record.row.frequency_Hz, k, *section, *extreme)
        for record in records
        for k, (section, extreme) in enumerate(zip(record.sections, record.extremes, strict=True), start=1)
    )
    return table_text(columns, rows)


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
    """The points that `packed` made these arrays of."""
    ends = np.cumsum(arrays["counts"], axis=0)[:-1]
    parts = {name: np.split(arrays[name], ends[:, k]) for k, name in enumerate(ARRAYS)}
    return [
        PointRecord(row=PointRow(**row), **{name: parts[name][k] for name in ARRAYS})
        for k, row in enumerate(parsed_json(str(arrays["rows"])))
    ]
