"""Outcomes of a body on a shake table and the motions of the table, read from a folder.

A folder holds either the motions of the granite rocks, whose outcomes are a table of this package, or tests of the
user's own: `outcomes.csv`, `body.toml` and the motions that they name (README.md has the format).
"""

import csv
import gzip
import io
import math
import tomllib
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from validation.experiments import measured_table

from fem.case.files import LARGEST_FILE
from fem.records import source as records
from fem.records.files import read_record
from fem.records.intensity import intensity
from fem.records.record import RecordError
from fem.records.table import UserTable
from fem.records.units import STANDARD_GRAVITY
from fem.runtime.arrays import FloatArray
from fem.runtime.user_files import read_regular, real_path

ROCK_MOTIONS = "granite_rock_motions.csv.gz"  #: the file of a folder of the rocks' motions
OUTCOMES, BODY = "outcomes.csv", "body.toml"  #: the files of a folder of one's own
OVERTURNED = {"0": False, "1": True}
SETS = ("fit", "predict")


class ShakeTestError(RecordError):
    """The folder does not hold tests that can be compared."""


@dataclass(frozen=True, kw_only=True)
class Body:
    """What was on the table, but for its slenderness angle."""

    mass: float  #: [kg]
    height: float  #: [m]
    centroid: float  #: height of the mass centre [m]
    inertia: float  #: about the mass centre, over the mass [m2]
    angles: tuple[float, float]  #: least and largest slenderness angle tried [rad]


@dataclass(frozen=True, kw_only=True, eq=False)
class ShakeTest:
    """One motion of the table, and what each specimen did."""

    name: str
    record: str  #: tests of one record are fitted or predicted together
    overturned: tuple[bool, ...]  #: by specimen
    simulated: tuple[bool, ...]  #: by the authors of the tests; empty where they did not
    fitted: bool  #: used in the fit that predicts the others; every test is where none is set apart
    times: FloatArray  #: (n,) [s]
    acceleration: FloatArray  #: (n,) [m/s2]

    @property
    def peak(self) -> float:
        """Peak acceleration [g]."""
        return float(np.abs(self.acceleration).max()) / STANDARD_GRAVITY

    @property
    def peak_velocity(self) -> float:
        """Peak velocity, the motion beginning at rest [m/s]."""
        return intensity(self.times, self.acceleration).peak_velocity_m_s


@dataclass(frozen=True, kw_only=True)
class Series:
    """Tests of one or several specimens of a body."""

    title: str
    source: str
    licence: str
    body: Body
    specimens: tuple[str, ...]
    tests: tuple[ShakeTest, ...]
    own: bool  #: the user's, without criteria

    @property
    def set_apart(self) -> bool:
        """Whether the table of outcomes says which tests are predicted; otherwise each record is, by all others."""
        return not all(test.fitted for test in self.tests)


ROCK = Body(mass=353.8, height=0.79, centroid=0.294, inertia=0.0526, angles=(0.04, 0.16))
ROCKS_TITLE = "Two rocks on a shake table"
ROCKS_SOURCE = (
    "github.com/ZhiangChen/virtual_shake_robot_pybullet, commit 9f239e7e, 2021; 35 of 582 tests, 0.1-25 Hz"
)
ROCKS_LICENCE = "outcomes as facts; the repository is GPL-3.0, none is stated for the data"


def read_series(folder: Path) -> Series:
    """The tests of a folder."""
    if (folder / ROCK_MOTIONS).exists():
        return _rocks(folder / ROCK_MOTIONS)
    if (folder / OUTCOMES).exists():
        return _own(folder)
    raise ShakeTestError(f"{folder}: neither {ROCK_MOTIONS} nor {OUTCOMES} is in this folder")


def _rocks(path: Path) -> Series:
    try:
        with gzip.open(io.BytesIO(read_regular(path, records.LARGEST_FILE))) as file:
            text = file.read(records.LARGEST_FILE + 1).decode()
            if len(text) > records.LARGEST_FILE:  # zeros take a thousandth of their size
                raise ValueError(f"unpacked, it is larger than {records.LARGEST_FILE} bytes")
        motions = {int(row["test"]): row for row in csv.DictReader(text.splitlines())}
        accelerations = {
            number: 1e-3 * np.array(row["acceleration_mm_per_s2_space_separated"].split(), dtype=float)
            for number, row in motions.items()
        }
        steps = {number: float(row["sample_interval_s"]) for number, row in motions.items()}
    except (OSError, EOFError, KeyError, TypeError, ValueError, csv.Error, zlib.error) as error:
        raise ShakeTestError(f"{path}: not a table of rock motions ({error})") from None
    rows = [row for row in measured_table("rocks.csv") if int(row["test"]) in motions]
    tests = []
    for row in rows:
        number = int(row["test"])
        tests.append(
            ShakeTest(
                name=f"test {number}",
                record=row["record"],
                overturned=tuple(row[f"specimen_{k}_overturned"] == "1" for k in (1, 2)),
                simulated=tuple(row[f"dem_{k}_overturned"] == "1" for k in (1, 2)),
                fitted=True,
                times=np.asarray(steps[number] * np.arange(accelerations[number].size), dtype=np.float64),
                acceleration=accelerations[number],
            )
        )
    words = {"title": ROCKS_TITLE, "source": ROCKS_SOURCE, "licence": ROCKS_LICENCE}
    specimens = ("rock 1", "rock 2")
    return _checked(path, Series(**words, body=ROCK, specimens=specimens, tests=tuple(tests), own=False))


def _own(folder: Path) -> Series:
    body, unit = _body(folder / BODY)
    path = folder / OUTCOMES
    try:
        lines = (records.decoded(read_regular(path, LARGEST_FILE)) or "").splitlines(keepends=True)
        table = UserTable(path.name, "".join(line for line in lines if not line.startswith("#")))
        columns = table.header
        rows = [{name: line.field(k) for k, name in enumerate(columns)} for line in table.lines]
    except ValueError as error:
        raise ShakeTestError(f"{path}: cannot be read ({error})") from None
    specimens = tuple(name for name in columns if name.startswith("overturned"))
    if not rows or "motion" not in columns or not specimens:
        raise ShakeTestError(f"{path}: its header needs the columns motion and overturned")
    tests = tuple(_own_test(path, number, row, specimens, unit) for number, row in enumerate(rows, start=2))
    titles = tuple(name.removeprefix("overturned").strip(" _") or "specimen" for name in specimens)
    words = {"title": f"Shake-table tests of {real_path(folder).name}", "source": str(path)}
    words["licence"] = "the user's own"
    return _checked(path, Series(**words, body=body, specimens=titles, tests=tests, own=True))


def _own_test(
    path: Path, number: int, row: Mapping[str, str], specimens: tuple[str, ...], unit: str | None
) -> ShakeTest:
    def refused(what: str) -> ShakeTestError:
        return ShakeTestError(f"{path}, row {number}: {what}")

    text = {name: row.get(name, "") for name in ("motion", "scale", "record", "set", *specimens)}
    if any(text[name] not in OVERTURNED for name in specimens):
        raise refused("overturned must be 0 or 1")
    if (chosen := text["set"] or "fit") not in SETS:
        raise refused(f"set must be {' or '.join(SETS)}, got {chosen!r}")
    try:
        scale = float(text["scale"] or "1")
    except ValueError:
        raise refused(f"scale must be a number, got {text['scale']!r}") from None
    if not (math.isfinite(scale) and scale != 0.0):
        raise refused(f"scale must be finite and not zero, got {text['scale']}")
    try:
        record = read_record(path.parent / text["motion"], unit=unit)
        component = record.component("horizontal", quantity="acceleration")
        component.require_no_gap(text["motion"])
    except RecordError as error:
        raise refused(str(error)) from None
    return ShakeTest(
        name=f"row {number}",
        record=text["record"] or text["motion"],
        overturned=tuple(OVERTURNED[text[name]] for name in specimens),
        simulated=(),
        fitted=chosen == "fit",
        times=component.times - component.times[0],
        acceleration=scale * component.values,
    )


def _body(path: Path) -> tuple[Body, str | None]:
    """The body of a user's tests, and the unit of their motions."""
    try:
        values: dict[str, Any] = tomllib.loads(read_regular(path, LARGEST_FILE).decode())
    except (ValueError, RecursionError) as error:
        raise ShakeTestError(f"{path}: cannot be read ({error})") from None

    def positive(value: object, name: str) -> float:
        if not isinstance(value, int | float) or isinstance(value, bool) or not 0.0 < value < math.inf:
            raise ShakeTestError(f"{path}: {name} must be a positive number, got {value!r}")
        return float(value)

    names = ("mass_kg", "height_m", "centroid_m", "inertia_m2", "slenderness_angle_rad")
    if unknown := set(values) - {*names, "unit"}:
        raise ShakeTestError(f"{path}: unknown key {sorted(unknown)[0]}; known: {', '.join(names)}, unit")
    if missing := set(names) - set(values):
        raise ShakeTestError(f"{path}: {sorted(missing)[0]} is missing")
    mass, height, centroid, inertia = (positive(values[name], name) for name in names[:4])
    angles = values["slenderness_angle_rad"]
    if not isinstance(angles, list) or len(angles) != 2:
        raise ShakeTestError(f"{path}: slenderness_angle_rad must be [least, largest], got {angles!r}")
    low, high = (positive(angle, "slenderness_angle_rad") for angle in angles)
    if not low < high < 0.5 * math.pi:
        raise ShakeTestError(
            f"{path}: slenderness_angle_rad must rise and end below 90 degrees, got {angles}"
        )
    unit = values.get("unit")
    if unit is not None and not isinstance(unit, str):
        raise ShakeTestError(f"{path}: unit must be text, got {unit!r}")
    return Body(mass=mass, height=height, centroid=centroid, inertia=inertia, angles=(low, high)), unit


def _checked(path: Path, series: Series) -> Series:
    fitted = {test.record for test in series.tests if test.fitted}
    if len(fitted) < (1 if series.set_apart else 2):
        raise ShakeTestError(f"{path}: there are too few tests to fit on and to predict")
    return series
