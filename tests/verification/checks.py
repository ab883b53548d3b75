"""A verification check: findings that are computed together under the statement that they prove."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from evidence.findings import Finding

Findings = Iterator[Finding]


@dataclass(frozen=True, kw_only=True)
class Check:
    """Findings that are computed together; the title is the statement that they prove."""

    topic: str
    title: str
    findings: Callable[[], Iterable[Finding]]
    quick: bool = True  #: computed with `--quick` as well


def check(topic: str, title: str, *, quick: bool = True) -> Callable[[Callable[[], Findings]], Check]:
    """Make a check of a generator; `verification.suite` collects the checks of a module."""
    return lambda findings: Check(topic=topic, title=title, findings=findings, quick=quick)
