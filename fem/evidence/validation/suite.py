"""The suite of experiments."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from fem.evidence.validation import cube, impacts, pulses, rocks
from fem.evidence.validation.findings import Experiment, ValidationResult


def run_validation(
    data: Path | None, *, before: Callable[[str], None] = lambda name: None
) -> ValidationResult:
    """Compute every experiment; `before` each, call with its name.

    Args:
        data: folder of the rock motions; None leaves that experiment out.

    Raises:
        MotionFolderError: the folder is of another kind.
    """
    if data is not None:
        rocks.read_tests(data)  # refused before anything is computed
    found = []
    for name, compute in (
        ("rocks", lambda: rocks.compute(data)),
        ("cube", cube.compute),
        ("pulses", pulses.compute),
        ("impacts", impacts.compute),
    ):
        before(name)
        began = time.perf_counter()
        experiment: Experiment = compute()
        found.append(replace(experiment, seconds=time.perf_counter() - began))
    return ValidationResult(experiments=tuple(found))
