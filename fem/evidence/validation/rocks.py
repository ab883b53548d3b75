"""Two nearly identical granite rocks on a shake table: overturned or stood, under 35 recorded table motions.

The scan of a rock does not show where it stood on its pedestal, so one number is fitted, its slenderness angle; mass
centre and inertia are those of the scan. It is fitted on half of the motions, and the other half is predicted. The
motions come from a folder that the user names; the table of this package has outcomes and peaks.
"""

import csv
import gzip
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path

import numpy as np

from fem.batch.runner import Runner
from fem.batch.workers import LocalWorkers
from fem.case.case import Case
from fem.evidence.findings import Finding, prediction
from fem.evidence.validation.bodies import cross_validated, rigid_case, specimen
from fem.evidence.validation.experiments import Experiment, Predictor
from fem.evidence.validation.tables import measured_table
from fem.model.container import Container
from fem.model.model import build_model
from fem.results.outcome import Outcome
from fem.run.checks import WantedChecks
from fem.run.compute import compute_on
from fem.run.outcome import run_without_history
from fem.runtime.arrays import FloatArray
from fem.runtime.threads import cores

MOTIONS = "granite_rock_motions.csv.gz"  #: file of the folder
MASS, HEIGHT, CENTROID, INERTIA = 353.8, 0.79, 0.294, 0.0526  #: [kg], [m], [m], over the mass [m2]
ANGLES = tuple(np.round(np.arange(0.05, 0.1601, 0.005), 3).tolist())  #: of slenderness, tried [rad]
SPECIMENS = (1, 2)
LEAST_AGREEMENT, SHARE_WITHIN, UNSURE_SHARE = 0.82, 0.08, 0.5
DESCRIBED = Experiment(
    name="rocks",
    title="Two rocks on a shake table",
    source="github.com/ZhiangChen/virtual_shake_robot_pybullet, commit 9f239e7e, tests of 2021; 35 of 582 "
    "motions, 0.1 to 25 Hz",
    licence="outcomes as facts; the repository is GPL-3.0, none is stated for the data",
    tests=0,
    fitted="slenderness angle",
)
BINS = ((0.0, 0.12), (0.12, 0.27), (0.27, math.inf))  #: of the peak acceleration [g]


class MotionFolderError(ValueError):
    """The folder does not hold the table motions."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ShakeTest:
    """One motion of the table, and what both rocks did."""

    number: int
    peak: float  #: [g]
    overturned: tuple[bool, bool]
    simulated: tuple[bool, bool]  #: by the authors' discrete elements, tuned on the same tests
    times: FloatArray  #: (n,) [s]
    acceleration: FloatArray  #: (n,) [m/s2]


def read_tests(folder: Path) -> tuple[ShakeTest, ...]:
    """The tests whose motions are in the folder.

    Raises:
        MotionFolderError: there is no file of these motions, it cannot be read, or none of its tests is known.
    """
    path = folder / MOTIONS
    if not path.is_file():
        raise MotionFolderError(
            f"{folder}: no {MOTIONS} in this folder; --data names the folder of the rock motions"
        )
    try:
        with gzip.open(path, "rt", encoding="utf-8") as file:
            motions = {int(row["test"]): row for row in csv.DictReader(file)}
            accelerations = {
                number: 1e-3 * np.array(row["acceleration_mm_per_s2_space_separated"].split(), dtype=float)
                for number, row in motions.items()
            }
            steps = {number: float(row["sample_interval_s"]) for number, row in motions.items()}
    except (OSError, EOFError, KeyError, TypeError, ValueError):
        raise MotionFolderError(f"{path}: not a table of rock motions") from None
    rows = [row for row in measured_table("rocks.csv") if int(row["test"]) in motions]
    if len(rows) < 2:
        raise MotionFolderError(f"{path}: holds none of the tests of the table of outcomes")
    return tuple(_test(row, accelerations[int(row["test"])], steps[int(row["test"])]) for row in rows)


def _test(row: dict[str, str], acceleration: FloatArray, step: float) -> ShakeTest:
    def both(name: str) -> tuple[bool, bool]:
        return row[name.format(1)] == "1", row[name.format(2)] == "1"

    return ShakeTest(
        number=int(row["test"]),
        peak=float(row["peak_g"]),
        overturned=both("specimen_{}_overturned"),
        simulated=both("dem_{}_overturned"),
        times=np.asarray(step * np.arange(acceleration.size), dtype=np.float64),
        acceleration=acceleration,
    )


def compute(folder: Path | None) -> Experiment:
    """Fit on half of the motions and predict the other half, and the reverse, for both rocks.

    Raises:
        MotionFolderError: as for `read_tests`.
    """
    if folder is None:
        return replace(
            DESCRIBED, not_computed="the motions are not part of the program: name their folder with --data"
        )
    tests = read_tests(folder)
    with LocalWorkers(cores()) as workers_of:
        runner = Runner(workers_of=workers_of)
        tried = predictions(runner, [(test, angle) for angle in ANGLES for test in tests])
        fits, findings = [], []
        for rock in SPECIMENS:
            halves = cross_validated(tests, partial(fitted_angle, tried=tried, rock=rock))
            fits.append(" and ".join(f"{angle:.3f}" for angle, _ in halves))
            pairs = [(test, angle) for angle, others in halves for test in others]
            findings += _findings(rock, pairs, list(predictions(runner, pairs).values()))
    return replace(
        DESCRIBED,
        tests=len(tests),
        fitted=f"slenderness angle [rad], on each half: {'; '.join(fits)} (rock 1; rock 2)",
        findings=tuple(findings),
        others=_others(tests),
    )


def predictions(
    runner: Runner, pairs: Sequence[tuple[ShakeTest, float]]
) -> dict[tuple[ShakeTest, float], bool]:
    """Whether the program's rigid block overturns in each test at an angle, on all cores."""
    return dict(zip(pairs, runner.each("rocks", pairs, _unpacked), strict=True))


def _unpacked(pair: tuple[ShakeTest, float]) -> bool:
    return overturns(*pair)


def fitted_angle(
    tests: Sequence[ShakeTest], tried: Mapping[tuple[ShakeTest, float], bool], rock: int
) -> float:
    """The angle with the most outcomes right; the mean where several are as good [rad]."""
    scores = {
        angle: sum(tried[test, angle] == test.overturned[rock - 1] for test in tests) for angle in ANGLES
    }
    return float(np.mean([angle for angle, score in scores.items() if score == max(scores.values())]))


def overturns(test: ShakeTest, angle: float) -> bool:
    """Whether the program's rigid block overturns."""
    case, container = _rock(angle)
    verdict, error = run_without_history(
        build_model(case.with_motion(test.times, test.acceleration), container), None
    )
    if error is not None:
        raise ArithmeticError(f"test {test.number}, {angle:g} rad: {error}")
    return verdict.outcome == Outcome.OVERTURNED


def _is_unsure(test: ShakeTest, angle: float) -> bool:
    """Whether the program calls its prediction unsure: another outcome within the ranges of its unknown inputs."""
    case, container = _rock(angle)
    motion = case.with_motion(test.times, test.acceleration)
    return compute_on(container, motion, WantedChecks(band=True)).verdict.sure == "unsure"


@cache
def _rock(angle: float) -> tuple[Case, Container]:
    """A block on two corners with the mass centre and inertia of the rock, which does not slide."""
    case = rigid_case(
        width=2.0 * CENTROID * math.tan(angle),
        height=HEIGHT,
        element_size=0.3,
        container__depth_m=0.7,
        container__mass_kg=MASS,
        container__centroid_m=CENTROID,
        solver__duration_s="auto",
    )
    return case, specimen(case, centroid=CENTROID, inertia_ratio=INERTIA)


def _findings(
    rock: int, pairs: Sequence[tuple[ShakeTest, float]], predicted: Sequence[bool]
) -> list[Finding]:
    """Measured and predicted outcomes of a rock, each test predicted by the fit on the others."""
    count = len(pairs)
    measured = [test.overturned[rock - 1] for test, _ in pairs]
    wrong = [one for one, a, b in zip(pairs, predicted, measured, strict=True) if a != b]
    agreement = 1.0 - len(wrong) / count
    share, seen = sum(predicted) / count, sum(measured) / count
    unsure = sum(_is_unsure(test, angle) for test, angle in wrong)
    findings = [
        prediction(
            f"rock {rock}: share of outcomes predicted, fitted on the other half",
            round(agreement, 3),
            reference="1",
            criterion=f"at least {LEAST_AGREEMENT}",
            met=agreement >= LEAST_AGREEMENT,
            note="the other rock on the same table agrees with this one in 0.87 of 582 tests",
        ),
        prediction(
            f"rock {rock}: share overturned",
            round(share, 3),
            reference=round(seen, 3),
            criterion=f"within {SHARE_WITHIN}",
            met=abs(share - seen) <= SHARE_WITHIN,
        ),
        prediction(
            f"rock {rock}: wrong predictions that the program itself calls unsure",
            unsure,
            reference=len(wrong),
            criterion="at least half",
            met=unsure >= UNSURE_SHARE * len(wrong),
        ),
    ]
    for low, high in BINS:
        some = [k for k, (test, _) in enumerate(pairs) if low <= test.peak < high]
        if some:
            to = f"to {high:g} g" if math.isfinite(high) else "g and more"
            findings.append(
                prediction(
                    f"rock {rock}: overturned of {len(some)} with a peak from {low:g} {to}",
                    sum(predicted[k] for k in some),
                    reference=sum(measured[k] for k in some),
                )
            )
    return findings


def _others(tests: Sequence[ShakeTest]) -> tuple[Predictor, ...]:
    """The scores of other predictors on these tests."""

    def agreement(says: Callable[[ShakeTest], tuple[bool, bool]]) -> str:
        return ", ".join(
            f"{np.mean([says(test)[k] == test.overturned[k] for test in tests]):.2f}" for k in range(2)
        )

    return (
        Predictor(
            name="always stands", agreement=agreement(lambda _: (False, False)), source="the same tests"
        ),
        Predictor(
            name="the other rock",
            agreement=agreement(lambda test: (test.overturned[1], test.overturned[0])),
            source="the same tests; 0.87 of all 582",
        ),
        Predictor(
            name="discrete elements in three dimensions, contact stiffness tuned on these tests",
            agreement=agreement(lambda test: test.simulated),
            source="the authors; 0.87 and 0.90 of all 582",
        ),
    )
