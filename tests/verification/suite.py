"""The verification suite: all checks by topic, from the elements to the limits of whole models.

A check that cannot be computed gives a finding that fails, with the reason; the others are still computed.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter
from typing import Any, NamedTuple

from evidence.findings import Finding, analytic
from evidence.suite import attempted, failures
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
from fem.runtime.identity import versions

MODULES = (
    statics,
    elasticity,
    time_stepping,
    contact_laws,
    sliding,
    rocking,
    restitution,
    overturning,
    vertical,
    floor,
    stacks,
    limits,
)
CHECKS = tuple(check for module in MODULES for check in vars(module).values() if isinstance(check, Check))
#: keys of a row in verify.json, with the attributes of the finding that they hold
KEYS = {"compared": "what", "passed": "holds"} | {
    name: name
    for name in ("case", "value", "reference", "kind", "source", "tolerance", "relative", "note", "error")
}


class UnknownTopicError(CaseError):
    """There is no such topic."""

    def __init__(self, name: str, known: Sequence[str]) -> None:
        hint = f"; {near}" if (near := did_you_mean(name, known)) else ""
        super().__init__(f"unknown topic {name!r}{hint} (known: {', '.join(known)})")


@dataclass(frozen=True, kw_only=True)
class ComputedCheck:
    """A check with its findings."""

    topic: str
    title: str
    findings: tuple[Finding, ...]
    seconds: float

    @property
    def names(self) -> dict[str, str]:
        """Its place in the suite, for JSON; `room` is the former name of `topic`."""
        return {"room": self.topic, "topic": self.topic, "check": self.title}


class Topic(NamedTuple):
    """The computed checks of a topic."""

    name: str
    checks: Sequence[ComputedCheck]

    @property
    def findings(self) -> list[Finding]:
        """Those of all its checks."""
        return [finding for check in self.checks for finding in check.findings]


@dataclass(frozen=True, kw_only=True)
class SuiteResult:
    """The computed checks."""

    quick: bool
    checks: tuple[ComputedCheck, ...]
    seconds: float

    @property
    def findings(self) -> Iterator[Finding]:
        """Every finding, in order."""
        return (finding for check in self.checks for finding in check.findings)

    @property
    def topics(self) -> list[Topic]:
        """The checks of each topic, in order."""
        return [Topic(name, list(checks)) for name, checks in groupby(self.checks, attrgetter("topic"))]

    @property
    def failures(self) -> int:
        """Number of findings that fail."""
        return failures(self.findings)

    @property
    def count(self) -> int:
        """Number of findings."""
        return len(list(self.findings))

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data, for JSON."""
        return {
            "quick": self.quick,
            "passed": self.failures == 0,
            "rows": [
                check.names
                | finding.document(KEYS)
                | {"convergence": finding.convergence and finding.convergence.document}
                for check in self.checks
                for finding in check.findings
            ],
            "checks": [
                check.names | {"rows": len(check.findings), "seconds": check.seconds} for check in self.checks
            ],
            "count": self.count,
            "failures": self.failures,
            "seconds": self.seconds,
            "versions": versions(),
        }


def chosen_checks(*, quick: bool, topics: Sequence[str] = ()) -> list[Check]:
    """Checks of some topics, or of all, in order; the quick ones or all.

    Raises:
        UnknownTopicError: a topic is not one of the suite's.
    """
    known = list(dict.fromkeys(check.topic for check in CHECKS))
    for name in topics:
        if name not in known:
            raise UnknownTopicError(name, known)
    wanted = topics or known
    return [check for check in CHECKS if check.topic in wanted and (check.quick or not quick)]


def run_suite(
    *,
    quick: bool,
    topics: Sequence[str] = (),
    before: Callable[[int, int, Check], None] = lambda number, count, check: None,
) -> SuiteResult:
    """Compute the chosen checks one after the other; `before` each, call with its number and their count.

    The stepping kernels are compiled first, outside the measured time.

    Raises:
        UnknownTopicError: as for `chosen_checks`.
    """
    checks = chosen_checks(quick=quick, topics=topics)
    run(STACK, {"solver.duration_s": 0.01})
    if any(check.topic == "stacks" for check in checks):
        run(STACK, {"container.boxes": 2, "container.joints": "loose", "solver.duration_s": 0.01})
    began = time.perf_counter()
    results = []
    for number, check in enumerate(checks, start=1):
        before(number, len(checks), check)
        results.append(_compute(check))
    return SuiteResult(quick=quick, checks=tuple(results), seconds=time.perf_counter() - began)


def _compute(check: Check) -> ComputedCheck:
    done = attempted(lambda: tuple(check.findings()))
    findings = done.result or (
        analytic(check.title, "computed at all", math.nan, source="", absolute=0.0, note=done.reason),
    )
    return ComputedCheck(topic=check.topic, title=check.title, findings=findings, seconds=done.seconds)
