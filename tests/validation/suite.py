"""The suite of experiments."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from evidence.findings import attempted, prediction
from validation import contents, cube, impacts, pulses, rocks
from validation.experiments import Experiment, document_of
from validation.shake_tests import read_series

from fem.run.expected import say_expected
from fem.runtime.progress import ScreenReporter

__all__ = ["document_of", "require", "run_validation"]  # of the command
ALL_S, TABLE_S = 60.0, 240.0  #: without and with tests on a shake table


def require(data: Path | None) -> None:
    """Refuse a folder without shake-table tests."""
    if data is not None:
        read_series(data)


def run_validation(data: Path | None, *, reporter: ScreenReporter) -> list[Experiment]:
    """Compute every experiment; without a folder of shake-table tests all but those."""
    require(data)
    expected = ALL_S + (TABLE_S if data is not None else 0.0)
    say_expected(reporter, "the experiments, once kernels are compiled", expected)
    experiments = []
    for name, compute in (
        ("rocks", partial(rocks.compute, data)),
        ("cube", cube.compute),
        ("pulses", pulses.compute),
        ("impacts", impacts.compute),
        ("contents", contents.compute),
    ):
        reporter.message(name)
        experiment, reason, seconds = attempted(compute)
        experiments.append(replace(experiment or not_computed(name, reason), seconds=seconds))
    return experiments


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
