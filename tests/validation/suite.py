"""The suite of experiments."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from evidence.findings import prediction
from evidence.suite import attempted
from validation import contents, cube, impacts, pulses, rocks
from validation.experiments import Experiment, ValidationResult
from validation.shake_tests import read_series


def require(data: Path | None) -> None:
    """Refuse a folder without shake-table tests.

    Raises:
        ShakeTestError: the folder is of another kind.
    """
    if data is not None:
        read_series(data)


def run_validation(
    data: Path | None, *, before: Callable[[str], None] = lambda name: None
) -> ValidationResult:
    """Compute every experiment; `before` each, call with its name.

    Args:
        data: folder of shake-table tests; None leaves that experiment out.

    Raises:
        ShakeTestError: as for `require`.
    """
    require(data)
    experiments = []
    for name, compute in (
        ("rocks", partial(rocks.compute, data)),
        ("cube", cube.compute),
        ("pulses", pulses.compute),
        ("impacts", impacts.compute),
        ("contents", contents.compute),
    ):
        before(name)
        done = attempted(compute)
        experiment = done.result or not_computed(name, done.reason)
        experiments.append(replace(experiment, seconds=done.seconds))
    return ValidationResult(experiments=tuple(experiments))


def not_computed(name: str, reason: str) -> Experiment:
    """An experiment that failed, which is a criterion missed."""
    failure = prediction("computed at all", "no", reference="-", criterion="computed", met=False, note=reason)
    return Experiment(
        name=name,
        title=name,
        source="",
        licence="",
        tests=0,
        fitted="",
        findings=(failure,),
        not_computed=reason,
    )
