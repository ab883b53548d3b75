"""The verification suite: all checks by topic, from the elements to the limits of whole models.

A check that cannot be computed gives a finding that fails, with the reason; the others are still computed.
"""

import math
import time
from collections.abc import Sequence
from functools import partial
from typing import Any

from evidence.findings import Finding, analytic, attempted
from runs import STACK, run
from verification import (
    contact_laws,
    elasticity,
    floor,
    limits,
    overturning,
    restitution,
    rocking,
    sliding,
    stacks,
    statics,
    time_stepping,
    vertical,
)
from verification.checks import Check

from fem.case.validation import CaseError, did_you_mean
from fem.run.expected import say_expected
from fem.runtime.identity import versions
from fem.runtime.progress import ScreenReporter

MODULES = [statics, elasticity, time_stepping, contact_laws, sliding, rocking, restitution, overturning]
MODULES += [vertical, floor, stacks, limits]
QUICK_S, ALL_S = 30.0, 100.0  #: on one core
CHECKS = tuple(check for module in MODULES for check in vars(module).values() if isinstance(check, Check))
#: keys of a row in verify.json, with the attributes of the finding that they hold
KEYS = {"compared": "what", "passed": "holds"} | {
    name: name
    for name in ("case", "value", "reference", "kind", "source", "tolerance", "relative", "note", "error")
}


def chosen_checks(*, quick: bool, topics: Sequence[str] = ()) -> list[Check]:
    """Checks of some topics, or of all, in order; the quick ones or all."""
    known = list(dict.fromkeys(check.topic for check in CHECKS))
    for name in topics:
        if name not in known:
            hint = did_you_mean(name, known)
            raise CaseError(f"unknown topic {name!r}{hint} (known: {', '.join(known)})")
    wanted = topics or known
    return [check for check in CHECKS if check.topic in wanted and (check.quick or not quick)]


def run_suite(checks: Sequence[Check], *, quick: bool, reporter: ScreenReporter) -> dict[str, Any]:
    """Compute checks one after the other; the content of verify.json.

    The stepping kernels are compiled first, outside the measured time.
    """
    seconds = (QUICK_S if quick else ALL_S) * len(checks) / len(chosen_checks(quick=quick))
    say_expected(reporter, "the checks, once kernels are compiled", seconds)
    run(STACK, {"solver.duration_s": 0.01})
    if any(check.topic == "stacks" for check in checks):
        run(STACK, {"container.boxes": 2, "container.joints": "loose", "solver.duration_s": 0.01})
    began = time.perf_counter()
    rows: list[dict[str, Any]] = []
    computed: list[dict[str, Any]] = []
    for number, check in enumerate(checks, start=1):
        reporter.message(f"[{number}/{len(checks)}] {check.topic}: {check.title}")
        # `room` is the former name of `topic`
        names = {"room": check.topic, "topic": check.topic, "check": check.title, "inputs": check.inputs}
        findings, taken = _compute(check)
        rows += [
            names
            | finding.document(KEYS)
            | {"convergence": finding.convergence and finding.convergence.document}
            for finding in findings
        ]
        computed.append(names | {"requirement": check.requirement, "rows": len(findings), "seconds": taken})
    failed = sum(row["passed"] is False for row in rows)
    return {
        "quick": quick,
        "passed": not failed,
        "rows": rows,
        "checks": computed,
        "count": len(rows),
        "failures": failed,
        "seconds": time.perf_counter() - began,
        "versions": versions(),
    }


def _compute(check: Check) -> tuple[Sequence[Finding], float]:
    """The findings, and the time that they took [s]."""
    findings, reason, seconds = attempted(lambda: tuple(check.findings()))
    failure = partial(analytic, check.title, "computed at all", math.nan, source="", absolute=0.0)
    return findings or (failure(note=reason),), seconds
