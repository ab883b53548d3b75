"""The points of a response curve as they are kept: a row of figures each, its sections and its phase portrait."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.response.curve import PORTRAYED, Point
from fem.response.model import SAMPLES_PER_PERIOD
from fem.response.orbit import EXTREME_COLUMNS, SECTION_COLUMNS
from fem.runtime.arrays import FloatArray

PORTRAIT_COLUMNS = ("rotation_rad", "angular_velocity_rad_s")
ARRAYS = {"sections": SECTION_COLUMNS, "extremes": EXTREME_COLUMNS, "portrait": PORTRAIT_COLUMNS}
#: columns of `response.csv`
ROW_COLUMNS = (
    "direction",
    "number",
    "frequency_Hz",
    "amplitude_m",
    "peak_acceleration_m_s2",
    "began",
    "status",
    "motion",
    "long_time",
    "period_n",
    "scatter",
    "settling",
    "pairs_compared",
    "periods",
    "rotation_ratio",
    "median_rotation_ratio",
    "max_rotation_rad",
    "least_rotation_rad",
    "most_rotation_rad",
    "slip_stroke_m",
    "slip_walk_m",
    "impacts_per_period",
    "growth",
    "bounded",
    "undriven",
    "undriven_s",
    "stable",
    "reason",
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """One point: its row, by `ROW_COLUMNS`, None where it does not apply, and its arrays, by `ARRAYS`."""

    row: Mapping[str, Any]
    sections: FloatArray  #: (n, 4)
    extremes: FloatArray  #: (n, 6)
    portrait: FloatArray  #: (n_samples, 2), of whole periods

    @property
    def stands(self) -> bool:
        """It has a long-time motion."""
        return self.row["long_time"] is not None


def record_of(point: Point) -> Record:
    """What is kept of a point."""
    case, orbit, long_time = point.case, point.orbit, point.long_time
    extremes = orbit.extremes
    row: dict[str, Any] = dict.fromkeys(ROW_COLUMNS)
    row |= {
        "direction": point.direction,
        "number": point.number,
        "frequency_Hz": case.angular_frequency / (2.0 * math.pi),
        "amplitude_m": case.amplitude,
        "peak_acceleration_m_s2": case.amplitude * case.angular_frequency**2,
        "began": point.began,
        "status": point.status,
        "motion": point.motion,
        "periods": point.periods,
        "bounded": point.bounded,
        "stable": point.stable,
        "reason": point.reason,
    }
    if long_time is not None:
        row |= {
            "long_time": long_time.kind,
            "period_n": long_time.period,
            "scatter": long_time.scatter,
            "settling": long_time.settling,
            "pairs_compared": long_time.compared,
            "rotation_ratio": point.rotation_ratio,
            "median_rotation_ratio": float(np.median(point.amplitudes)),
            "max_rotation_rad": float(extremes[:, 0].max()),
            "least_rotation_rad": float(extremes[:, 1].min()),
            "most_rotation_rad": float(extremes[:, 2].max()),
            "slip_stroke_m": float(extremes[:, 4].max()),
            "slip_walk_m": float(orbit.sections[:, 3].mean()),
            "impacts_per_period": float(extremes[:, 5].mean()),
            "growth": point.growth,
        }
    if point.decay is not None:
        row |= {"undriven": point.decay.fate, "undriven_s": point.decay.time}
    kept = PORTRAYED if long_time is None else {"rest": 1}.get(long_time.kind, long_time.period or PORTRAYED)
    return Record(
        row=row,
        sections=orbit.sections,
        extremes=extremes,
        portrait=orbit.portrait[-kept * SAMPLES_PER_PERIOD :],
    )


def csv_of_rows(records: Sequence[Record]) -> str:
    """`response.csv`: a row a point, in the order in which they were swept."""
    lines = [",".join(ROW_COLUMNS)]
    lines += [",".join(_written(record.row[name]) for name in ROW_COLUMNS) for record in records]
    return "\n".join(lines) + "\n"


def csv_of_sections(records: Sequence[Record]) -> str:
    """`sections.csv`: a row a period of the window observed, sections and extremes."""
    names = ("direction", "frequency_Hz", "period", *SECTION_COLUMNS, *EXTREME_COLUMNS)
    lines = [",".join(names)]
    for record in records:
        head = f"{record.row['direction']},{_written(record.row['frequency_Hz'])}"
        for period, (section, extreme) in enumerate(
            zip(record.sections, record.extremes, strict=True), start=1
        ):
            numbers = [_written(float(value)) for value in (*section, *extreme)]
            lines.append(",".join([head, str(period), *numbers]))
    return "\n".join(lines) + "\n"


def csv_of_portraits(records: Sequence[Record]) -> str:
    """`portraits.csv`: rotation and angular velocity over the last periods, evenly in time."""
    lines = [",".join(("direction", "frequency_Hz", "periods", *PORTRAIT_COLUMNS))]
    for record in records:
        head = f"{record.row['direction']},{_written(record.row['frequency_Hz'])}"
        for k, (rotation, rate) in enumerate(record.portrait):
            # to a millionth of a degree: pictures are made of these
            lines.append(f"{head},{k / SAMPLES_PER_PERIOD:.6g},{rotation:.8g},{rate:.8g}")
    return "\n".join(lines) + "\n"


def _written(value: Any) -> str:
    """One cell: words as they are (quoted where they hold a comma), numbers to the last bit, nothing for None."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value)
    text = str(value)
    return '"' + text.replace('"', '""') + '"' if any(sign in text for sign in ',"\n') else text
