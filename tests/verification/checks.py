"""A verification check: findings that are computed together under the statement that they prove."""

import inspect
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from evidence.findings import Finding

Findings = Iterator[Finding]
#: what of the inputs of a reference comes from the program, one sentence a check
NOTHING = "No input of the reference comes from the program."
MESH = "Mass centre, inertia and base of the block come from the program's mesh; held by hand under statics."
PROGRAM = "The reference is another run of the program."


@dataclass(frozen=True, kw_only=True)
class Check:
    """Findings that are computed together; the title is the statement that they prove."""

    topic: str
    title: str
    findings: Callable[[], Iterable[Finding]]
    quick: bool = True  #: computed with `--quick` as well
    inputs: str = NOTHING  #: of the references, those that come from the program

    @property
    def requirement(self) -> str:
        """What must hold, in words: the first paragraph beside the check."""
        return " ".join((inspect.getdoc(self.findings) or "").partition("\n\n")[0].split())


def check(
    topic: str, title: str, *, quick: bool = True, inputs: str = NOTHING
) -> Callable[[Callable[[], Findings]], Check]:
    """Make a check of a generator; `verification.suite` collects the checks of a module."""
    return lambda findings: Check(topic=topic, title=title, findings=findings, quick=quick, inputs=inputs)
