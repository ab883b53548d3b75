"""Timed parts of a suite: a part that cannot be computed gives its reason, and the others go on."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

from evidence.findings import Finding

ResultT = TypeVar("ResultT")


@dataclass(frozen=True, kw_only=True)
class Attempt(Generic[ResultT]):
    """The result of some work, or why there is none."""

    result: ResultT | None
    reason: str
    seconds: float


def attempted(work: Callable[[], ResultT]) -> Attempt[ResultT]:
    """Do some work, and measure its time."""
    began = time.perf_counter()
    result, reason = None, ""
    try:
        result = work()
    except (ArithmeticError, ValueError, RuntimeError, LookupError, TypeError) as error:
        reason = f"{type(error).__name__}: {error}"
    return Attempt(result=result, reason=reason, seconds=time.perf_counter() - began)


def failures(findings: Iterable[Finding]) -> int:
    """Number of findings that do not hold."""
    return sum(finding.holds is False for finding in findings)
